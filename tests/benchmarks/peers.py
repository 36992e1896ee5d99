"""The same state changes by hand and by other libraries."""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec

Run = Callable[[int], object]
NAMES = ["one", "two", "three", "four", "five"]


def hand_written() -> Run:
    """Write the Table 1 program as functions: one per state, condition and action.

    Like the interpreter, it tests in the tick of an entry whether the state that was entered acts.
    """
    loops = 0

    def never() -> bool:
        return False

    def always() -> bool:
        return True

    def count() -> int:
        nonlocal loops
        loops = loops + 1
        return 1

    def nothing() -> int:
        return 1

    def leaving() -> int:
        if never():
            return 0
        if never():
            return 1
        if never():
            return 2
        if never():
            return 3
        if always():
            return 4
        return -1

    def state(entry: Callable[[], int], following: int) -> Callable[[], int]:
        def tick() -> int:
            if never():
                return 0
            if never():
                return 1
            if never():
                return 2
            if never():
                return 3
            if always():
                nothing()
                entry()
                if leaving() < 0:
                    nothing()
            return following

        return tick

    states = [state(nothing, 1), state(nothing, 2), state(nothing, 3), state(nothing, 4), state(count, 0)]

    def run(ticks: int) -> None:
        now = 0
        for _ in range(ticks):
            now = states[now]()

    return run


def hand_written_blocks(states: int) -> Run:
    """Write `texts.blocks` as functions: one per state, condition and action.

    They are written out for each state, as the program's blocks are, and not made by one function: a
    thousand states have a thousand bodies, which no cache of the processor holds.
    """
    body = "".join(
        f"""
    def left_{n}():
        return left < 0 and seen >= {n}

    def enter_{n}():
        nonlocal left
        left = {n}

    def run_{n}():
        nonlocal left
        left = left - {n + 1}

    def leave_{n}():
        nonlocal seen
        seen = seen + 1

    def state_{n}():
        if left_{n}():
            leave_{n}()
            enter_{(n + 1) % states}()
            if not left_{(n + 1) % states}():
                run_{(n + 1) % states}()
            return state_{(n + 1) % states}
        run_{n}()
        return state_{n}
"""
        for n in range(states)
    )
    text = f"""
def ring():
    seen = left = 0
{body}
    enter_0()
    run_0()
    now = state_0

    def run(ticks):
        nonlocal now
        state = now
        for _ in range(ticks):
            state = state()
        now = state

    return run
"""
    made: dict[str, Callable[[], Run]] = {}
    exec(text, made)
    return made["ring"]()


def hand_written_nest(depth: int) -> Run:
    """Machines inside each other: each tests its condition, acts, and ticks the one inside."""

    def never() -> bool:
        return False

    def act() -> int:
        return 1

    def level(inner: Callable[[], None] | None) -> Callable[[], None]:
        def tick() -> None:
            if never():
                return
            act()
            if inner is not None:
                inner()

        return tick

    tick: Callable[[], None] | None = None
    for _ in range(depth):
        tick = level(tick)
    assert tick is not None
    outermost = tick

    def run(ticks: int) -> None:
        for _ in range(ticks):
            outermost()

    return run


def libraries() -> dict[str, Run]:
    """Those of the peers that are installed."""
    peers = {"transitions": _transitions, "statemachine": _statemachine, "sismic": _sismic}
    titles = {"statemachine": "python-statemachine"}
    return {titles.get(name, name): make() for name, make in peers.items() if find_spec(name)}


def _edges() -> list[tuple[str, str, bool]]:
    never = [(a, b, False) for a in NAMES for b in NAMES if a != b]
    return never + [(a, NAMES[(n + 1) % 5], True) for n, a in enumerate(NAMES)]


def _transitions() -> Run:
    from transitions import Machine

    class Bench:
        loops = 0

        def never(self) -> bool:
            return False

        def always(self) -> bool:
            return True

        def nothing(self) -> int:
            return 1

        def count(self) -> None:
            self.loops += 1

    bench = Bench()
    states = [
        {"name": n, "on_enter": "count" if n == "one" else "nothing", "on_exit": "nothing"} for n in NAMES
    ]
    machine = Machine(bench, states=states, initial="one", auto_transitions=False)
    for a, b, fires in _edges():
        machine.add_transition("tick", a, b, conditions="always" if fires else "never")

    def run(ticks: int) -> None:
        for _ in range(ticks):
            bench.tick()  # type: ignore[attr-defined]

    return run


def _statemachine() -> Run:
    from statemachine import State, StateMachine

    states = {n: State(n, initial=n == "one") for n in NAMES}
    tick = None
    for a, b, fires in _edges():
        edge = states[a].to(states[b], cond="always" if fires else "never")
        tick = edge if tick is None else tick | edge
    body = {
        **states,
        "tick": tick,
        "loops": 0,
        "never": lambda self: False,
        "always": lambda self: True,
        **{f"on_exit_{n}": lambda self: 1 for n in NAMES},
        **{f"on_enter_{n}": lambda self: 1 for n in NAMES},
    }
    machine = type(StateMachine)("Bench", (StateMachine,), body)()

    def run(ticks: int) -> None:
        for _ in range(ticks):
            machine.tick()

    return run


def _sismic() -> Run:
    from sismic.interpreter import Interpreter
    from sismic.model import BasicState, CompoundState, Statechart, Transition

    chart = Statechart("bench", preamble="loops = 0")
    chart.add_state(CompoundState("root", initial="one"), None)
    for n in NAMES:
        entry = "loops = loops + 1" if n == "one" else "1"
        chart.add_state(BasicState(n, on_entry=entry, on_exit="1"), "root")
    for a, b, fires in _edges():
        chart.add_transition(Transition(a, b, event="tick", guard=str(fires)))
    interpreter = Interpreter(chart)
    interpreter.execute_once()

    def run(ticks: int) -> None:
        for _ in range(ticks):
            interpreter.queue("tick").execute_once()

    return run
