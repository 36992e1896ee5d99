"""Prints the four figures by kind of mistake: ``python -m tests.mistakes [KIND …]``.

With a kind, prints every mistake of it that is not explained perfectly.
"""

from __future__ import annotations

import argparse
from difflib import unified_diff

from . import inside, numbers, outside  # noqa: F401  (register their kinds)
from .measure import new_findings, score, shares
from .planting import KINDS, PER_KIND, Mistake, plant


def _shown(mistake: Mistake) -> None:
    print(f"\n== {mistake.kind}, {mistake.program}, line {sorted(mistake.lines)}")
    lines = unified_diff(mistake.right.splitlines(), mistake.wrong.splitlines(), n=0, lineterm="")
    print("\n".join(list(lines)[2:]))
    for finding in new_findings(mistake):
        print(f"  {finding}")
        if finding.fix:
            print(f"      fix: {finding.fix.title}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("kinds", nargs="*", help="parts of the names of kinds")
    parser.add_argument("--count", type=int, default=PER_KIND, help="mistakes of each kind")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--all", action="store_true", help="print also what is explained perfectly")
    options = parser.parse_args()
    print(f"{'kind':44} {'n':>4} {'told':>6} {'placed':>6} {'once':>6} {'fixed':>6}")
    scores = []
    for name in KINDS:
        if options.kinds and not any(part in name for part in options.kinds):
            continue
        mistakes = plant(name, options.count, options.seed)
        rows = [score(mistake) for mistake in mistakes]
        scores += rows
        print(f"{name:44} {len(rows):4} " + " ".join(f"{share:6.0f}" for share in shares(rows)))
        if options.kinds:
            for mistake, row in zip(mistakes, rows, strict=True):
                if options.all or not all(row):
                    _shown(mistake)
    print(f"{'all':44} {len(scores):4} " + " ".join(f"{share:6.1f}" for share in shares(scores)))


if __name__ == "__main__":
    main()
