"""How often `repair` undoes a planted mistake: one number of a teacher's solution, changed by a factor.

    python tests/benchmarks/repairs.py [--plants 60] [--seeds 3] [--limit 60] [--sample 0] [CHALLENGE …]

A plant counts if the challenge fails with it. It is undone by an answer that changes the same number, so that
as many runs pass as of the solution; and closely if the number is then within a quarter of the original. The
six robots of lesson 08 come last: is the first answer about what was broken?
"""

from __future__ import annotations

import argparse
import random
import sys
from collections.abc import Iterator
from pathlib import Path
from time import perf_counter
from typing import NamedTuple

sys.path.insert(0, str(Path(__file__).parents[1]))

from grading.answers import SOLUTIONS

from lrp_jupyter.grading.batch import grade_all
from lrp_jupyter.grading.bundled.starters import starter
from lrp_jupyter.grading.challenges import BUNDLED, Challenge, challenge
from lrp_jupyter.grading.workers import HowRun
from lrp_jupyter.language.parser import scan
from lrp_jupyter.repairs.answer import Repairs
from lrp_jupyter.repairs.numbers import Numbers
from lrp_jupyter.repairs.other_numbers import written
from lrp_jupyter.repairs.repair import repaired

FACTORS = (0.1, 0.5, 2, 10, -1)
BROKEN = {
    1: "robot.distance.data <",
    2: "pulse == 7",
    3: "Swapping `tsave` and `talarm`",
    4: "`tmove` after",
    5: "in `running` instead of `onentry`",
    6: "lap_time",
}
"""What was broken in each of the six robots, in words of an answer that names it."""


class Plant(NamedTuple):
    """A solution with one number changed: which one by its index, from what to what."""

    task: Challenge
    text: str
    index: int
    shown: str
    old: float
    new: float


def solutions() -> Iterator[tuple[Challenge, str]]:
    """Yield the challenges, each with its solution."""
    for task in BUNDLED:
        path = SOLUTIONS / f"{task.name.replace(' ', '-').replace(',', '')}.lrp"
        if path.is_file():
            yield task, path.read_text(encoding="utf-8")


def plants(task: Challenge, text: str) -> list[Plant]:
    """Return all plants of a solution."""
    numbers, found = Numbers(text), []
    for index, number in enumerate(numbers.found):
        for factor in FACTORS:
            new = float(f"{number.value * factor:.6g}")
            start, end = number.span
            planted = text[:start] + written(new) + text[end:]
            if new == number.value or scan(planted)[0] is None:  # a delay with a sign or a fraction
                continue
            shown = f"{number.name or numbers.shown(number, written(number.value))}"
            found.append(Plant(task, planted, index, shown, number.value, new))
    return found


def sampled(names: list[str], count: int, sample: int, seeds: int) -> Iterator[Plant]:
    """Yield plants with which the challenge fails, one of each challenge in turn, in a random order."""
    chance = random.Random(sample)
    piles = [plants(task, text) for task, text in solutions() if not names or task.name in names]
    for pile in (piles, *piles):
        chance.shuffle(pile)
    while piles and count:
        for pile in list(piles):
            while pile and grade_all([pile[-1].text], pile[-1].task, seeds)[0].passed:
                pile.pop()
            if not pile:
                piles.remove(pile)
            elif count:
                count -= 1
                yield pile.pop()


def place_of(plant: Plant, answer: Repairs) -> tuple[int | None, bool]:
    """Return which answer undoes a plant, counted from 0, and whether it does so closely."""
    start, end = Numbers(plant.text).found[plant.index].span
    for place, each in enumerate(answer.repairs):
        edit = each.changes[0]
        if (edit.start, edit.end) == (start, end):
            value = float(edit.text)
            return place, abs(value - plant.old) <= 0.25 * abs(plant.old)
    return None, False


def main() -> None:
    """Print a row for each plant and each robot, and the shares."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("challenges", nargs="*")
    parser.add_argument("--plants", type=int, default=60)
    parser.add_argument("--sample", type=int, default=0, help="another one for each number")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--limit", type=float, default=60)
    options = parser.parse_args()
    how = HowRun(20)
    print("| challenge | planted | undone by answer | closely | first answer | runs | s |\n|-|-|-|-|-|-|-|")
    places: list[int | None] = []
    close = 0
    for plant in sampled(options.challenges, options.plants, options.sample, options.seeds):
        begin = perf_counter()
        answer = repaired(plant.text, plant.task, options.seeds, how, options.limit)
        place, is_close = place_of(plant, answer)
        places.append(place)
        close += is_close and place == 0
        first = answer.repairs[0].sentence if answer else "none"
        number = "none" if place is None else str(place + 1)
        planted = f"{plant.shown}: {written(plant.old)} → {written(plant.new)}"
        took = perf_counter() - begin
        cut = "" if answer.complete else " (cut)"
        print(
            f"| {plant.task.name} | {planted} | {number} | {'yes' if is_close else ''} | {first} "
            f"| {answer.made}{cut} | {took:.0f} |",
            flush=True,
        )
    if places:
        first, three = places.count(0), sum(place is not None and place < 3 for place in places)
        of = len(places)
        print(f"\nfirst: {first} of {of} ({first / of:.0%}), {close} of them closely; ", end="")
        print(f"one of the first three: {three} of {of} ({three / of:.0%})\n")
    print("| robot | first answer | is what was broken |\n|-|-|-|")
    for number, words in BROKEN.items() if not options.challenges else ():
        answer = repaired(
            starter(f"robot {number}"), challenge(f"robot {number}"), options.seeds, how, options.limit
        )
        said = answer.repairs[0].sentence if answer else "none"
        print(f"| {number} | {said} | {'yes' if words in said else 'no'} |", flush=True)


if __name__ == "__main__":
    main()
