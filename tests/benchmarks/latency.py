"""How soon a person sees what they did: ``python tests/benchmarks/latency.py``.

A real JupyterLab and a headless Chromium. Times are from the moment the browser stamps the key or the click
until the picture that shows its effect is painted. A code cell of JupyterLab's own, with the same text and in
the same page, is measured in the same run: machines differ and are shared, so the ratio to it says more than
the milliseconds. It needs what the browser tests need.
"""

from __future__ import annotations

import argparse
import json
import random
import re
import statistics
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parent.parent))
sys.path.insert(0, str(Path(__file__).parent))

import texts
from e2e.jupyter import FLAGS, chromium, jupyter, lacking
from e2e.pages import LabPage, NotebookPage
from runs import record
from wire import Wire

from lrp_jupyter import programs

# Conditions that are true or false: the counts of faults would be most of the traffic.
CALM = re.sub(r"and (left\d+)\]", r"and \1 > 0]", texts.long(190))
PROGRAM = f"""{CALM}
(machine blink (state off) (state on) (ontime 300 off -> on) (ontime 300 on -> off))
(spawn blink off)
(machine probe (state here) (state q))
(spawn probe here)
"""
SLOW_CELL = "import time\nprint(0)\nfor _ in range({}):\n    time.sleep(0.1)\n"
STANDING = "(machine m (state a)) (spawn m a)"
PROBE = (Path(__file__).parent / "probe.js").read_text()
WATCH = (Path(__file__).parent / "watch.py").read_text()


class Table:
    """Rows of p50 and p95 in milliseconds, each with its ratio to JupyterLab's own cell."""

    def __init__(self) -> None:
        self.own: tuple[float, float] | None = None

    def row(self, name: str, times: list[float], target: str = "") -> None:
        if len(times) < 2:
            print(f"| {name} | – | – | – | {len(times)} | {target} |", flush=True)
            return
        p50, p95 = statistics.median(times), statistics.quantiles(times, n=20, method="inclusive")[-1]
        if self.own is None:
            print("\n| | p50 ms | p95 ms | p95 : own cell | n | to reach |\n|---|---:|---:|---:|---:|---|")
            self.own = p50, p95
        ratio = p95 / self.own[1]
        print(f"| {name} | {p50:.0f} | {p95:.0f} | {ratio:.1f} | {len(times)} | {target} |", flush=True)


class Bench:
    def __init__(self, page: Any, server: Any, wire: Wire, times: int, seconds: float) -> None:
        self.page, self.wire, self.times = page, wire, times
        self.notebook = NotebookPage(page, server, "bench/notebook.ipynb")
        cells = [
            "%load_ext lrp_jupyter",
            f"%%lrp m --world line\n{PROGRAM}",
            WATCH,
            SLOW_CELL.format(max(20, 10 * seconds)),
            PROGRAM,
        ]
        server.write(self.notebook.name, cells)
        self.notebook.show()
        for cell in (0, 1, 2):
            self.notebook.run_cell(cell)
        self.lab = self.notebook.lab().ready()
        self.page.evaluate(PROBE)
        self.lab.root.scroll_into_view_if_needed()
        self.table, self.notes = Table(), []

    def kernel(self, expression: str) -> Any:
        """Evaluate an expression in the kernel."""
        return json.loads(
            self.page.evaluate(
                """async code => {
                  const kernel = jupyterapp.shell.currentWidget.sessionContext.session.kernel;
                  const future = kernel.requestExecute({ code, store_history: false });
                  let text = "";
                  future.onIOPub = ({ header, content }) => {
                    if (header.msg_type === "stream") text += content.text;
                  };
                  await future.done;
                  return text;
                }""",
                f"import json; print(json.dumps({expression}))",
            )
        )

    def timed(
        self, kind: str, condition: str, act: Callable[[], object], lab: LabPage | None = None
    ) -> list[float]:
        """Seconds on the wall: of the event, and of the picture that shows that the condition holds."""
        root = (lab or self.lab).root.element_handle()
        self.page.evaluate(f"([kind, root]) => probe.arm(kind, root, {condition})", [kind, root])
        act()
        event, picture = self.page.evaluate(
            "Promise.race([probe.outcome, new Promise((_, no) => setTimeout(() => no(Error('never')), 2e4))])"
        )
        return [event / 1e3, picture / 1e3]

    def look_at(self, machine: str) -> None:
        self.lab.sees(f'[data-lrp-machine="{machine}"]').click()

    # -- rows --------------------------------------------------------------------------------------

    def type_in_a_cell(self) -> None:
        cell = self.page.locator(".jp-CodeCell").last.locator(".cm-content")
        cell.scroll_into_view_if_needed()
        cell.click()
        self.table.row(
            "typed character painted, JupyterLab's own cell", keys(self.page, self.times, "Control+Home")
        )
        self.lab.root.scroll_into_view_if_needed()

    def type(self) -> None:
        self.lab.select("[0.1")
        self.page.keyboard.press("ArrowRight")
        times = keys(self.page, self.times)
        self.table.row("typed character painted, everything runs", times, "≤ 33, ≤ 1.5 x")

    def complete(self) -> None:
        self.look_at("probe")
        self.lab.select("(state q")
        self.page.keyboard.press("ArrowRight")
        self.page.keyboard.press("Escape")
        runs, shows, name = [], [], "q"
        for turn in range(self.times):
            letter = "abcdefgh"[turn % 8]
            name = name + letter
            condition = f"root => root.querySelector('[data-lrp-state=\"probe/{name}\"]')"
            event, picture = self.timed(
                "keydown", condition, lambda key=letter: self.page.keyboard.press(key)
            )
            patched = [when for kind, _, when in self.kernel("stamps") if kind == "patched"]
            runs.append((next(when for when in patched if when > event) - event) * 1e3)
            shows.append((picture - event) * 1e3)
            if len(name) > 8 or turn == self.times - 1:
                for _ in name[1:]:
                    self.page.keyboard.press("Backspace")
                name = "q"
                self.lab.sees('[data-lrp-state="probe/q"]')
        self.table.row("completing keystroke → interpreter runs it", runs, "≤ 75")
        self.table.row("completing keystroke → graph shows it", shows, "≤ 100")

    def repair(self) -> None:
        self.lab.select("(state off)")
        self.page.keyboard.press("ArrowRight")
        times = []
        for _ in range(self.times // 2):
            self.page.keyboard.press("Backspace")
            self.lab.sees('[data-lrp-issue^="LRP1"]')
            self.lab.sees(".cm-lintRange-error")
            condition = "root => !root.querySelector('[data-lrp-issue^=LRP1], .cm-lintRange-error')"
            event, picture = self.timed("keydown", condition, lambda: self.page.keyboard.press(")"))
            times.append((picture - event) * 1e3)
        self.table.row("repaired → the error's mark is gone", times, "≤ 100")

    def highlight(self, seconds: float) -> None:
        self.look_at("blink")
        self.lab.sees('[data-lrp-state="blink/on"]')
        self.page.evaluate("root => probe.watchStates(root, 'blink/')", self.lab.root.element_handle())
        begin = time.time()
        self.page.wait_for_timeout(seconds * 1e3)
        entered = [
            (path, when)
            for kind, path, when in self.kernel("stamps")
            if kind == "entered" and path.startswith("blink/") and when > begin
        ]
        painted = [(path, when / 1e3) for path, when in self.page.evaluate("probe.states")]
        times = []
        for path, when in entered:
            after = [shown for name, shown in painted if name == path and when <= shown < when + 0.5]
            if after:
                times.append((min(after) - when) * 1e3)
        name = f"state change → highlight painted ({len(entered) - len(times)} of {len(entered)} not seen)"
        self.table.row(name, times, "≤ 50")

    def obey(self, name: str, times: int) -> None:
        """Stop, run, pause by the buttons."""
        found: dict[str, list[float]] = {"stop": [], "pause": []}
        for _ in range(times):
            for action, times_of in found.items():
                event, picture = self.timed(
                    "click",
                    "root => root.dataset.lrpStatus === 'paused'",
                    lambda act=action: self.lab.do(act),
                )
                times_of.append((picture - event) * 1e3)
                self.lab.do("run")
                self.lab.ready("running")
        for action, times_of in found.items():
            self.table.row(f"{action}{name}", times_of, "≤ 150")

    def look_back(self, times: int) -> None:
        """Move the playhead by its keys: all panels show another moment."""
        self.lab.pause()
        tick = self.lab.tick
        self.lab.find(".lrp-playhead").focus()
        found = []
        for turn in range(times):
            tick -= 1 if turn % 2 else 10
            condition = f"root => 'looking' in root.dataset && Number(root.dataset.lrpTick) === {tick}"
            key = "ArrowLeft" if turn % 2 else "Shift+ArrowLeft"
            event, picture = self.timed("keydown", condition, lambda key=key: self.page.keyboard.press(key))
            found.append((picture - event) * 1e3)
        self.table.row("playhead moved → everything shows the moment", found, "≤ 100")
        self.page.keyboard.press("Escape")
        self.lab.sees("css=:scope:not([data-looking])")
        self.lab.do("run")
        self.lab.ready()

    def obey_while_a_cell_runs(self) -> None:
        self.notebook.begin_cell(3)
        self.notebook.prints(3)
        self.obey(", a cell runs for long", few(self.times))
        self.look_at("probe")
        self.lab.select("(state q")
        self.page.keyboard.press("ArrowRight")
        times, name = [], "q"
        for letter in "abcde":
            name += letter
            condition = f"root => root.querySelector('[data-lrp-state=\"probe/{name}\"]')"
            event, picture = self.timed(
                "keydown", condition, lambda key=letter: self.page.keyboard.press(key)
            )
            times.append((picture - event) * 1e3)
        self.table.row("edit, a cell runs for long", times, "≤ 150")
        self.kernel("1")  # waits for the cell's end

    def count_at_full_speed(self, seconds: float) -> None:
        """Nothing is lost at 1,000 ticks/s: the counts sent to the page add up to what happened."""
        with self.rate(100):  # as often as the simulator moves on; its time runs ten times as fast
            self.kernel("setattr(session, 'speed', 10)")
            self.page.wait_for_timeout(seconds * 1e3)
            achieved = self.kernel("session.frame.achieved_rate")
            self.lab.pause()
            happened, tick = self.kernel("(fired(), session.frame.tick)")
            self.lab.until("(root, tick) => Number(root.dataset.lrpTick) >= tick", argument=tick)
            self.kernel("setattr(session, 'speed', 1)")
            told = sum(count for count, _ in self.wire.fired.values())
            self.lab.do("run")
            self.lab.ready()
        self.notes.append(
            f"At {achieved:.0f} ticks/s {happened} transitions fired; the page was told of {told}."
        )

    @contextmanager
    def rate(self, hertz: float) -> Iterator[None]:
        self.kernel(f"setattr(session, 'rate', {hertz})")
        yield
        self.kernel("setattr(session, 'rate', 10)")

    def traffic(self, seconds: float) -> None:
        """Count the messages of one view while nothing is typed."""
        print("\n| messages per second | to the kernel | to the page | of these, busy and idle | kB |")
        print("|---|---:|---:|---:|---:|")
        self.lab = self.notebook.open(programs.load("follower"), "m --world oval")
        self.traffic_row("the follower drives", seconds)
        self.lab.pause()
        self.traffic_row("it is paused", seconds)
        self.lab = self.notebook.open(STANDING, "m --world oval")
        self.traffic_row("only the time goes on", seconds)
        self.notebook.run_cell(2)
        with self.rate(100):
            self.traffic_row("the same at 100 Hz", seconds)

    def traffic_row(self, name: str, seconds: float) -> None:
        self.page.wait_for_timeout(seconds * 300)  # what came before is over
        sent, received, size = self.wire.measure(lambda: self.page.wait_for_timeout(seconds * 1e3))
        counts = (sent.total(), received.total(), received["status"], size / 1e3)
        print(f"| {name} | {' | '.join(f'{each / seconds:.1f}' for each in counts)} |", flush=True)

    def disturbed(self, context: Any, server: Any, seconds: float) -> None:
        """A second tab on the same lab that does not listen: blocked, then frozen."""
        self.notebook.save()
        other = context.new_page()
        second = NotebookPage(other, server, self.notebook.name)
        other.goto(f"{server.url}/lab/workspaces/other/tree/{self.notebook.name}?reset")
        second.ready()
        second.lab().ready()
        self.page.bring_to_front()
        ends = f"const end = Date.now() + {seconds * 1000}; while (Date.now() < end);"
        other.evaluate(f"setTimeout(() => {{ {ends} }}, 0)")
        self.obey(", another tab is blocked", few(self.times))
        other.wait_for_function("true")
        caught_up = time.time()
        tick = self.lab.tick
        second.lab().until("(root, tick) => Number(root.dataset.lrpTick) >= tick", argument=tick)
        self.notes.append(
            f"The blocked tab shows the present {time.time() - caught_up:.1f} s after it wakes."
        )
        session = context.new_cdp_session(other)
        session.send("Page.setWebLifecycleState", {"state": "frozen"})
        self.obey(", another tab is hidden and frozen", few(self.times))
        session.send("Page.setWebLifecycleState", {"state": "active"})
        other.close()

    def reload(self, times: int) -> None:
        self.notebook.save()
        found = []
        for _ in range(times):
            self.page.reload()
            self.page.wait_for_selector('[data-lrp="lab"]', state="attached")
            begin = time.time()
            self.page.wait_for_selector('[data-lrp="lab"] [data-lrp-state][data-active]', state="attached")
            found.append((time.time() - begin) * 1e3)
        self.notebook.ready()
        self.page.evaluate(PROBE)
        self.lab = self.notebook.lab().ready()
        self.table.row("reload: lab in the page → running program", found, "≤ 1000")

    def soak(self, seconds: float) -> None:
        """A hundred ticks a second for long; nothing may grow."""
        print(f"\n**{seconds:.0f} s at 100 Hz**\n")
        print("| s | ticks/s | threads | kernel MB | page MB | queued | frames on their way |")
        print("|---:|---:|---:|---:|---:|---:|---:|")
        session = self.page.context.new_cdp_session(self.page)
        begin = time.time()
        with self.rate(100):
            self.page.wait_for_timeout(1000)
            for turn in range(7):
                self.page.wait_for_timeout(max(0.0, begin + 1 + turn * (seconds - 1) / 6 - time.time()) * 1e3)
                session.send("HeapProfiler.collectGarbage")
                heap = self.page.evaluate("performance.memory.usedJSHeapSize") / 1e6
                rate, threads, memory, queued, way = self.kernel("load()")
                past = time.time() - begin
                print(
                    f"| {past:.0f} | {rate:.0f} | {threads} | {memory:.1f} | {heap:.1f} | {queued} | {way} |",
                    flush=True,
                )


def few(times: int) -> int:
    """The number of repetitions for something slow."""
    return max(2, times // 12)


def keys(page: Any, times: int, first: str = "") -> list[float]:
    """Type digits where the cursor is; milliseconds until each is painted."""
    if first:
        page.keyboard.press(first)
    page.evaluate("probe.watchKeys(document.activeElement)")
    for _ in range(times):
        page.keyboard.press(random.choice("123456789"))
        page.wait_for_timeout(random.uniform(40, 120))
    found: list[float] = page.evaluate("(probe.watching.abort(), probe.keys.splice(0))")
    for _ in range(times):
        page.keyboard.press("Backspace")
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="see that it runs; the figures mean nothing")
    parser.add_argument("--traffic", action="store_true", help="only count messages")
    parser.add_argument("--runs", type=int, default=0, help="recorded minutes kept beside the program")
    parser.add_argument("--soak", type=float, default=60, help="seconds at 100 Hz, 600 at most")
    options = parser.parse_args()
    if lacking():
        sys.exit(f"There is no {lacking()}.")
    times, seconds = (4, 0.5) if options.quick else (60, 10)
    from playwright.sync_api import sync_playwright

    with (
        tempfile.TemporaryDirectory() as home,
        jupyter(Path(home)) as server,
        sync_playwright() as playwright,
    ):
        record(server.root / "bench" / "m.runs", PROGRAM, options.runs)
        browser = playwright.chromium.launch(executable_path=chromium(), args=FLAGS)
        context = browser.new_context(viewport={"width": 1600, "height": 1000})
        page = context.new_page()
        bench = Bench(page, server, Wire(page), times, seconds)
        if not options.traffic:
            bench.type_in_a_cell()
            bench.type()
            bench.complete()
            bench.repair()
            bench.highlight(seconds)
            bench.obey("", times // 4)
            bench.look_back(times)
            bench.obey_while_a_cell_runs()
            bench.reload(2 if options.quick else 5)
            bench.disturbed(context, server, seconds / 2)
            bench.count_at_full_speed(seconds)
            print("\n" + "\n".join(bench.notes))
            bench.soak(min(600.0, 1 if options.quick else options.soak))
        bench.traffic(seconds)
        browser.close()


if __name__ == "__main__":
    main()
