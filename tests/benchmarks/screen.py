"""What can be seen of a lab without scrolling: ``python -m tests.benchmarks.screen --screenshots DIR``.

A real JupyterLab and a headless Chromium, with nothing kept of earlier runs: the sizes are those that are
found at first. A line of the program counts by the part of it that can be seen, so that 12.5 lines are 12 and
a half; a message, a button, and a state only if they are whole, and nothing lies over them.

*Empty* is what lies in a square of 48 px of one colour in a picture of the lab, except for the floor of the
world, which is white, too, and is what one looks at. It is counted for the innermost panel it lies in.
"""

from __future__ import annotations

import argparse
import base64
import json
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

sys.path.insert(0, str(Path(__file__).parent.parent))

from e2e.axe import choose_theme
from e2e.jupyter import FLAGS, chromium, jupyter, lacking
from e2e.pages import APP, LabPage, NotebookPage
from e2e.programs import FOLLOWER

import lrp_jupyter

PAPER = (Path(lrp_jupyter.__file__).parent / "programs" / "paper-listing.lrp").read_text(encoding="utf-8")
LOOKALGO = "follower/looking/lookalgo"
UNUSED = "(state lost) (event dark [robot.light.data < 20])"
FAULTY = FOLLOWER.replace("(state looking\n", f"{UNUSED}\n  (state looking\n")
STOPPER = """\
(machine stopper
  (state driving (running [robot.move(linear=0.2)]))
  (state lost)
)
(spawn stopper driving)
"""
SIDE = 48  # px
BENCH = (Path(__file__).parent / "screen.js").read_text(encoding="utf-8")
SIMULATED = "[*registry.running()][-1].session.bridge.simulated.world"
SIZES = f"""\
import json
from lrp_jupyter.widgets import registry
world = {SIMULATED}
print(json.dumps([world.size, world.robots[0].radius]))
"""


class Window(NamedTuple):
    width: int
    height: int
    has_files: bool

    def __str__(self) -> str:
        return f"{self.width}×{self.height}{'' if self.has_files else ', files closed'}"


LAPTOP = Window(1280, 800, True)
LARGE = Window(1920, 1080, True)
WINDOWS = [LAPTOP, Window(1280, 800, False), Window(1440, 900, True), LARGE, Window(1000, 700, True)]


class Sight(NamedTuple):
    """What is seen of a lab in a window."""

    world: float  # share of the lab
    is_whole: bool
    robot: float  # px
    lines: float
    empty: float  # share of the lab
    places: list[tuple[str, float]]


class Bench:
    def __init__(self, page: Any, server: Any, pictures: Path | None) -> None:
        self.page, self.server, self.pictures = page, server, pictures
        self.opened = 0

    @contextmanager
    def lab(self, line: str, program: str, window: Window = LAPTOP) -> Iterator[LabPage]:
        """Open a lab in a notebook of its own, and scroll to it; close it at the end."""
        self.opened += 1
        notebook = NotebookPage(self.page, self.server, f"screen/notebook{self.opened}.ipynb")
        self.server.write(notebook.name, ["%load_ext lrp_jupyter", f"%%lrp {line}\n{program}"])
        self.page.set_viewport_size({"width": window.width, "height": window.height})
        notebook.show()
        notebook.run_cell(0)
        notebook.begin_cell(1)
        lab: LabPage = notebook.lab().ready()
        self.page.evaluate(BENCH)
        self.take(lab, window)
        yield lab
        self.page.evaluate(f"{APP}.context.save().then(() => {APP}.dispose())")
        self.server.end_kernels()

    def take(self, lab: LabPage, window: Window) -> None:
        """Give the page the size of a window, and JupyterLab its files or none."""
        self.page.set_viewport_size({"width": window.width, "height": window.height})
        if self.page.evaluate("!jupyterapp.shell.leftCollapsed") != window.has_files:
            lab.notebook.command("application:toggle-left-area")
        self.rest(lab)

    def rest(self, lab: LabPage) -> None:
        lab.root.evaluate("root => root.scrollIntoView({ block: 'start' })")
        lab.at_rest(".lrp-canvas")
        lab.at_rest(".lrp-graph > g")

    def see(self, lab: LabPage, world: str, window: Window) -> Sight:
        """Measure everything in a window."""
        self.take(lab, window)
        size, radius = json.loads(lab.notebook.kernel(SIZES))
        found = lab.root.evaluate("(root, size) => screenBench.world(root, size)", size)
        lines = lab.root.evaluate("root => screenBench.lines(root)")
        picture = base64.b64encode(self.picture(lab, f"{world} {window}")).decode()
        empty, places = lab.root.evaluate(
            "(root, [picture, floor, side]) => screenBench.white(root, picture, floor, side)",
            [picture, found["floor"], SIDE],
        )
        return Sight(
            found["share"], found["whole"], 2 * radius * found["scale"], lines, empty, sorted_by_share(places)
        )

    def shares(self, lab: LabPage, selector: str) -> list[float]:
        found: list[float] = lab.root.evaluate(
            "(root, selector) => screenBench.shares(root, selector)", selector
        )
        return found

    def whole(self, lab: LabPage, selector: str) -> int:
        return sum(share > 0.99 for share in self.shares(lab, selector))

    def picture(self, lab: LabPage, name: str) -> bytes:
        """Take a picture of the lab in the present theme; save the page in both if that is wanted."""
        box = lab.box()
        taken: bytes = self.page.screenshot(clip=box, animations="disabled")
        if self.pictures:
            for theme in ("dark", "light"):
                choose_theme(lab, theme)
                file = self.pictures / f"{name.replace(' ', '-').replace(',', '')}-{theme}.png"
                self.page.screenshot(path=file, animations="disabled")
        return taken

    # -- rows --------------------------------------------------------------------------------------

    def sights(self, world: str) -> dict[Window, Sight]:
        with self.lab(f"follower --world {world}", FOLLOWER) as lab:
            return {window: self.see(lab, world, window) for window in WINDOWS}

    def issues(self) -> str:
        """Make a mistake in a program that has findings already."""
        with self.lab("follower --world line", FAULTY) as lab:
            lab.until("list => list.children.length === 2", ".lrp-issues")
            lab.replace("linear=forward", "linear=forwards")
            return self.messages(lab, 3, "issues")

    def challenge(self) -> str:
        """Fail a check, then make a mistake."""
        with self.lab('mine --challenge "stop at the line"', STOPPER) as lab:
            lab.sees("[data-lrp-issue]")
            lab.do("check")
            lab.sees(".lrp-result[data-state='failed']")
            actions = ("check", "hint", "show-attempt")
            buttons = [name for name in actions if self.whole(lab, f'[data-lrp-action="{name}"]')]
            self.picture(lab, "challenge checked")
            lab.replace("0.2", "pace")
            found = self.messages(lab, 2, "challenge issues")
            return f"{found}; of Check, Hint, Show after Check: {', '.join(buttons) or 'none'}"

    def messages(self, lab: LabPage, number: int, name: str) -> str:
        lab.until("(list, number) => list.children.length === number", ".lrp-issues", number)
        lab.page.keyboard.press("Home")  # away from the word, and no card over anything
        lab.page.keyboard.press("Escape")
        self.rest(lab)
        self.picture(lab, name)
        shares = self.shares(lab, ".lrp-issues > li")
        whole = sum(share > 0.99 for share in shares)
        return f"{whole} of {number} messages whole ({sum(shares):.1f} in parts)"

    def lookalgo(self) -> str:
        """Look at the inner machine of the paper's program."""
        with self.lab("follower --world line", PAPER) as lab:
            lab.sees(f'[data-lrp-machine="{LOOKALGO}"]').evaluate("element => element.click()")
            lab.sees(f'[data-lrp-state="{LOOKALGO}/lookleft"] .lrp-box')
            self.rest(lab)
            self.picture(lab, "lookalgo")
            states = self.whole(lab, f'[data-lrp-state^="{LOOKALGO}/"] .lrp-box')
            return f"{states} states"


def sorted_by_share(places: list[tuple[str, float]]) -> list[tuple[str, float]]:
    return sorted(places, key=lambda place: -place[1])


def percent(share: float) -> str:
    return f"{100 * share:.1f}"


def print_sights(found: dict[str, dict[Window, Sight]]) -> None:
    print("| window | world | canvas % | whole world | robot px | lines | empty % | where |")
    print("|---|---|---:|---|---:|---:|---:|---|")
    for window in WINDOWS:
        for world, sights in found.items():
            sight = sights[window]
            where = ", ".join(f"{name} {percent(share)}" for name, share in sight.places[:5])
            print(
                f"| {window} | {world} | {percent(sight.world)} | {'yes' if sight.is_whole else 'no'} |"
                f" {sight.robot:.0f} | {sight.lines:.1f} | {percent(sight.empty)} | {where} |"
            )


def print_wanted(found: dict[str, dict[Window, Sight]], issues: str, challenge: str, lookalgo: str) -> None:
    def each(text: Any, windows: list[Window]) -> str:
        return "; ".join(
            f"{world}: {', '.join(text(sights[window]) for window in windows)}"
            for world, sights in found.items()
        )

    canvas = each(lambda sight: percent(sight.world), WINDOWS)
    whole = each(lambda sight: "yes" if sight.is_whole else "no", WINDOWS)
    robot = each(lambda sight: f"{sight.robot:.0f}", WINDOWS)
    rows = [
        (
            "world canvas / lab at 1280×800 with files open, closed; 1440×900; 1920×1080; 1000×700",
            f"{canvas} %",
            "≥ 25, 28, 28, 30, 22 %, the whole world in sight, robot ≥ 30 px",
        ),
        ("… the whole world in sight", whole, "yes"),
        ("… robot, px", robot, "≥ 30"),
        (
            "lines of program at 1280×800, files open",
            each(lambda sight: f"{sight.lines:.1f}", [LAPTOP]),
            "≥ 14",
        ),
        ("Issues in sight at 1280×800", issues, "3 messages, whole"),
        ("… in a challenge", challenge, "2, and Check, Hint, Show"),
        ("the paper's `lookalgo` (4 states) at 1280×800", lookalgo, "all"),
        ("white at 1920×1080", each(lambda sight: percent(sight.empty), [LARGE]) + " %", "< 20 %"),
    ]
    print("\n| | now | to reach |\n|---|---|---|")
    for row in rows:
        print(f"| {' | '.join(row)} |", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--screenshots", type=Path, metavar="DIR", help="save pictures, light and dark")
    pictures = parser.parse_args().screenshots
    if lacking():
        sys.exit(f"There is no {lacking()}.")
    if pictures:
        pictures.mkdir(parents=True, exist_ok=True)
    from playwright.sync_api import sync_playwright

    with (
        tempfile.TemporaryDirectory() as home,
        jupyter(Path(home)) as server,
        sync_playwright() as playwright,
    ):
        browser = playwright.chromium.launch(executable_path=chromium(), args=FLAGS)
        bench = Bench(browser.new_context().new_page(), server, pictures)
        found = {world: bench.sights(world) for world in ("line", "oval")}
        print_sights(found)
        print_wanted(found, bench.issues(), bench.challenge(), bench.lookalgo())
        browser.close()


if __name__ == "__main__":
    main()
