"""How many runs the answers to the challenges pass: all solutions in every one, cheats and wrong answers not.

    python tests/benchmarks/answers.py [--seeds 50] [--kind KIND] [CHALLENGE …]

A run is one world with one seed; the worlds share the seeds. A challenge with its own seeds takes those.
"""

from __future__ import annotations

import argparse
import sys
from math import ceil
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from grading.answers import ANSWERS, SOLUTIONS, Answer, of_series

from lrp_jupyter.grading.batch import grade_all
from lrp_jupyter.grading.challenges import BUNDLED, challenge


def main() -> None:
    """Print a table: the runs that each answer passes, and the first reason why one does not."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("challenges", nargs="*")
    parser.add_argument("--seeds", type=int, default=50)
    parser.add_argument("--kind", choices=("solution", "cheat", "wrong"))
    options = parser.parse_args()
    for task in map(challenge, options.challenges) if options.challenges else BUNDLED:
        answers = [each for each in (*ANSWERS, *of_series()) if each.challenge == task.name]
        if task.series:
            text = (SOLUTIONS / f"{task.name.replace(' ', '-')}.lrp").read_text(encoding="utf-8")
            answers.insert(0, Answer(task.name, "solution", "", text))
        if options.kind:
            answers = [each for each in answers if each.kind == options.kind]
        seeds = ceil(options.seeds / len(task.worlds)) if isinstance(task.seeds, int) else None
        print(f"\n## {task.name}\n", flush=True)
        print("| answer | runs passed | of | passes | the first that does not |\n|---|---|---|---|---|")
        grades = grade_all([each.text for each in answers], task, seeds)
        for answer, grade in zip(answers, grades, strict=True):
            first = grade.first_failed
            why = f"{first.world}, seed {first.seed}: {first.reason.partition(chr(10))[0]}" if first else ""
            about = f": {answer.about}" if answer.about else ""
            mark = "yes" if grade.passed else "no"
            print(
                f"| {answer.kind}{about} | {grade.runs_passed} | {grade.runs} | {mark} | {why} |", flush=True
            )


if __name__ == "__main__":
    main()
