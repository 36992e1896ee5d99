"""How fast it is, as ratios within one run: ``python tests/benchmarks/speed.py``.

Machines differ and are shared, so nothing here is a test of time, and time is that of the processor.
Every row of a table is measured in turns with the others, many times, and the best time of each
counts. What is written by hand has the structure of the program: a function for every state, condition
and action, and variables in a closure. Peers that are not installed are left out
(``pip install ".[bench]"`` brings them).
"""

from __future__ import annotations

import argparse
import statistics
import sys
from collections.abc import Callable
from functools import _lru_cache_wrapper
from pathlib import Path
from time import process_time

sys.path.insert(0, str(Path(__file__).parent))

import peers
import texts

from lrp_jupyter import Interpreter, check, parse
from lrp_jupyter.graph.layout import layout
from lrp_jupyter.interpreter.linker import link
from lrp_jupyter.language import program as program_module
from lrp_jupyter.language.blocks import block as blocks
from lrp_jupyter.language.checks import block_facts as facts

Run = Callable[[int], object]
SHARE = 0.004  # seconds of a turn


def measure(runs: dict[str, Run], size: int, turns: int) -> dict[str, float]:
    """Best time of each per unit, in seconds; slow ones do fewer units in their turns.

    Every run is warm before it counts: `size` units, or a second's worth of them.
    """
    sizes = {}
    for name, run in runs.items():
        begin = process_time()
        run(10)
        run(max(0, min(size, int(10 / (process_time() - begin)))))
        begin = process_time()
        run(10)
        sizes[name] = max(10, min(size, int(SHARE * 10 / (process_time() - begin))))
    best = dict.fromkeys(runs, float("inf"))
    for _ in range(turns):
        for name, run in runs.items():
            begin = process_time()
            run(sizes[name])
            best[name] = min(best[name], (process_time() - begin) / sizes[name])
    return best


def interpreter(text: str, *, journal: int = 0, observed: bool = False) -> Run:
    i = Interpreter(parse(text), journal=journal)
    if observed:
        i.observe(lambda event: None)
    step = i.step

    def run(ticks: int) -> None:
        for _ in range(ticks):
            step(0.0)

    return run


def table(title: str, times: dict[str, float], unit: str = "µs", scale: float = 1e6) -> None:
    base = next(iter(times.values()))
    print(f"\n**{title}**\n\n| | {unit} | ratio |\n|---|---:|---:|")
    for name, time in times.items():
        print(f"| {name} | {time * scale:.2f} | {time / base:.2f} |")


def state_changes(size: int, turns: int) -> None:
    text = texts.table1()
    runs = {
        "hand-written functions": peers.hand_written(),
        "lrp": interpreter(text),
        "lrp, journal": interpreter(text, journal=10_000),
        "lrp, observer": interpreter(text, observed=True),
        **peers.libraries(),
    }
    table("A state change of the paper's Table 1 program", measure(runs, size, turns))


def blocks_of_their_own(size: int, turns: int) -> None:
    """A ring of states with conditions and actions of their own, few states and many."""
    runs = {}
    for states in (5, 1000):
        text = texts.blocks(states)
        runs |= {
            f"hand-written functions, {states} states": peers.hand_written_blocks(states),
            f"lrp, {states} states": interpreter(text),
            f"lrp, journal, {states} states": interpreter(text, journal=10_000),
            f"lrp, observer, {states} states": interpreter(text, observed=True),
        }
    size = max(size, 4_000)  # twice around
    times = measure(runs, size, turns)
    table("A tick in a ring of states, each with blocks of its own", times)
    growth = {
        name: times[f"{name}, 1000 states"] / times[f"{name}, 5 states"]
        for name in ("hand-written functions", "lrp", "lrp, journal", "lrp, observer")
    }
    by_hand = growth["hand-written functions"]
    print("\n| | 1000 states : 5 states | as much as by hand |\n|---|---:|---:|")
    for name, ratio in growth.items():
        print(f"| {name} | {ratio:.2f} | {ratio / by_hand:.2f} |")


def depth_and_width(size: int, turns: int) -> None:
    runs = {}
    for depth in (1, 16):
        runs[f"hand-written, depth {depth}"] = peers.hand_written_nest(depth)
        runs[f"lrp, depth {depth}"] = interpreter(texts.nest(depth))
    times = measure(runs, size, turns)
    table("A tick in which nothing fires, nested machines", times)
    print(f"\ndepth 16: {times['lrp, depth 16'] / times['hand-written, depth 16']:.2f} x hand-written")
    runs = {f"lrp, {n} states": interpreter(texts.ring(n)) for n in (5, 1000)}
    table("A state change, few and many states", measure(runs, size, turns))


def keystrokes(turns: int) -> None:
    """Type a number into the middle of a program: text to a program that runs, checks included."""
    print("\n**From a keystroke to the patched program**\n")
    print("| lines | | p50 ms | p95 ms |\n|---:|---|---:|---:|")
    for lines in (100, 1000):
        whole, spent, stops = texts.long(lines), {"parse": [], "parse, check, patch": []}, []
        i = Interpreter(parse(whole))
        i.step(0.0)
        for turn in range(turns):
            text = whole.replace("speed := [0.1]", f"speed := [0.{turn + 2}]")
            begin = process_time()
            program = parse(text)
            parsed = process_time()
            check(program)
            link(program)  # as a session does, where the text is read
            ready = process_time()
            assert i.patch(program).applied
            done = process_time()
            spent["parse"].append(parsed - begin)
            spent["parse, check, patch"].append(done - begin)
            stops.append(done - ready)
        for name, times in {**spent, "the loop stands still": stops}.items():
            p50, p95 = statistics.median(times), statistics.quantiles(times, n=20)[-1]
            print(f"| {lines} | {name} | {p50 * 1e3:.2f} | {p95 * 1e3:.2f} |")


def sessions(size: int, turns: int) -> None:
    """What everybody gets: journal, counts, time, commands and frames around the interpreter's tick."""
    from lrp_jupyter import Session, VirtualClock

    session = Session(texts.blocks(5), bridge="none", clock=VirtualClock())
    runs = {
        "hand-written functions": peers.hand_written_blocks(5),
        "lrp, journal": interpreter(texts.blocks(5), journal=10_000),
        "lrp, a whole session in virtual time": lambda ticks: session.run(seconds=ticks / 10),
    }
    table("A tick of a whole session without a robot", measure(runs, size, turns))
    session.close()


def first_and_warm(turns: int) -> None:
    """Read a program none of whose blocks was seen before, and again after a keystroke.

    The caches of everything that is computed once per text of a block are emptied before each first time;
    those of the grammar (shapes of forms) stay.
    """
    whole = texts.varied(500)
    caches = [
        value
        for module in (blocks, facts, program_module)
        for value in vars(module).values()
        if isinstance(value, _lru_cache_wrapper)
    ]
    link(parse(whole))
    spent: dict[str, list[float]] = {}
    for turn in range(turns):
        for cache in caches:
            cache.cache_clear()
        for name, text in (("first", whole), ("warm", whole.replace("[0.1]", f"[0.{turn + 2}]"))):
            begin = process_time()
            program = parse(text)
            parsed = process_time()
            check(program)
            link(program)
            spent.setdefault(f"{name} parse", []).append(parsed - begin)
            spent.setdefault(f"{name} parse, check, link", []).append(process_time() - begin)
    print(f"\n**{len(whole.splitlines())} lines with {whole.count('[')} different blocks, first and warm**\n")
    print("| | best ms | p50 ms |\n|---|---:|---:|")
    for name, times in spent.items():
        print(f"| {name} | {min(times) * 1e3:.1f} | {statistics.median(times) * 1e3:.1f} |")


def layouts(turns: int, states: int) -> None:
    """Lay out large machines for the first time, and again with a state more."""
    print("\n**Layouts of large machines**\n\n| | first ms | after an edit ms |\n|---|---:|---:|")
    for title, text in {
        f"{states} states in a ring": texts.linked(states, 0),
        f"{states} states in a ring, {states // 10} cross transitions": texts.linked(states, states // 10),
        f"{2 * states} states in a ring": texts.linked(2 * states, 0),
        f"{4 * states} states in a ring": texts.linked(4 * states, 0),
        "30 states, 870 transitions": texts.complete(30),
    }.items():
        first, again = float("inf"), float("inf")
        before, after = (
            parse(text),
            parse(text.replace("(state s0)", "(state s0) (state new) (eps s3 -> new)")),
        )
        for _ in range(turns):
            begin = process_time()
            drawing = layout(before.machines[0], program=before)
            middle = process_time()
            layout(after.machines[0], drawing, program=after)
            first, again = min(first, middle - begin), min(again, process_time() - middle)
        print(f"| {title} | {first * 1e3:.0f} | {again * 1e3:.0f} |")


def simulator(seconds: float, turns: int) -> None:
    from lrp_jupyter import Session, VirtualClock
    from lrp_jupyter.programs import load

    spent = float("inf")
    for _ in range(turns):
        with Session(load("follower"), bridge="sim", world="line", clock=VirtualClock()) as with_robot:
            begin = process_time()
            with_robot.run(seconds=seconds)
            spent = min(spent, process_time() - begin)
    print("\n**The line follower in the simulator**\n")
    print(f"{seconds:.0f} s of the robot's time in {spent:.2f} s: {seconds / spent:.0f} times real time")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="see that it runs; the figures mean nothing")
    quick = parser.parse_args().quick
    size, turns = (100, 2) if quick else (1000, 300)
    state_changes(size, turns)
    blocks_of_their_own(size, turns)
    depth_and_width(size, turns)
    keystrokes(3 if quick else 200)
    sessions(size, turns)
    first_and_warm(2 if quick else 20)
    layouts(1 if quick else 5, 50 if quick else 1000)
    simulator(5 if quick else 200, 1 if quick else 5)


if __name__ == "__main__":
    main()
