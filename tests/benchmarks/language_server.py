"""How long it takes from a key to the findings, in an editor with a program of 1,000 lines.

    python tests/benchmarks/language_server.py [LINES]

Prints the median and the 95th percentile over the pipes of a real server, one key after the other: of a
number in a block, of a line that is no program until its last bracket, and of a name; then of completion.
"""

from __future__ import annotations

import random
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median, quantiles
from tempfile import TemporaryDirectory

sys.path.insert(0, str(Path(__file__).parents[1]))
sys.path.insert(0, str(Path(__file__).parent))

import texts
from support.editor_client import EditorClient

KEYS = 200
LINE = "\n  (event far [robot.distance.data > 1])"


class Typist(EditorClient):
    """An editor that measures until the findings of the present text are there."""

    def __init__(self, path: Path) -> None:
        self.is_told = threading.Event()
        super().__init__(path)

    def _marked(self, told):
        super()._marked(told)
        if told.version == self.version:
            self.is_told.set()

    def typed(self, start: int, end: int, new: str) -> float:
        """Return the milliseconds until the findings are there."""
        self.is_told.clear()
        began = time.perf_counter()
        self.change((start, end, new))
        self.is_told.wait(60)
        return (time.perf_counter() - began) * 1000


def keys(lrp: Typist, place: Callable[[], int], word: str) -> list[float]:
    """Type a word letter by letter, and take it away again, until there are enough."""
    found: list[float] = []
    while len(found) < KEYS:
        start = place()
        for at, letter in enumerate(word, start):
            found.append(lrp.typed(at, at, letter))
        lrp.typed(start, start + len(word), "")
    return found


def tell(what: str, found: list[float]) -> None:
    print(f"{what:48} median {median(found):6.1f} ms   95 % {quantiles(found, n=20)[-1]:6.1f} ms")


def main(lines: int) -> None:
    choose = random.Random(1)
    with TemporaryDirectory() as folder:
        lrp = Typist(Path(folder) / "long.lrp")
        began = time.perf_counter()
        lrp.open(texts.long(lines))
        lrp.is_told.wait(60)
        print(f"{lrp.text.count(chr(10)) + 1} lines; opened in {(time.perf_counter() - began) * 1000:.0f} ms")

        def after(word: str) -> Callable[[], int]:
            places = [at for at in range(len(lrp.text)) if lrp.text.startswith(word, at)]
            return lambda: choose.choice(places) + len(word)

        tell("a number in a block", keys(lrp, after("robot.light.data > "), "12"))
        tell("a line that is no program until its end", keys(lrp, after("of the program"), LINE))
        tell("a name that does not exist until its end", keys(lrp, after("robot.move(linear=s"), "wifter"))
        asked = []
        for _ in range(KEYS):
            at = after("robot.")()
            began = time.perf_counter()
            assert lrp.complete(lrp.position(at))
            asked.append((time.perf_counter() - began) * 1000)
        tell("completion after `robot.`", asked)
        lrp.close()


if __name__ == "__main__":
    main(int(sys.argv[1]) if sys.argv[1:] else 1000)
