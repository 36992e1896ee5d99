"""What becomes of the issues when the text of a running program changes.

Issues are charged to elements and stand at places of the text. Where the text is another one they
move along with their elements; those of what is gone, changed or repaired are over. Paper: §6.2.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from lrp_jupyter.interpreter.issues import Issue, Issues
from lrp_jupyter.interpreter.linker import Plan
from lrp_jupyter.language.program import Element

__all__ = ["carry_issues"]


def carry_issues(
    issues: Issues,
    old: Plan,
    plan: Plan,
    gone: tuple[Element, ...] = (),
    names: Mapping[Element, Element] = MappingProxyType({}),
) -> None:
    """Resolve the issues of what is gone, changed or repaired; move the others with the text.

    Parameters
    ----------
    issues : Issues
    old, plan : Plan
        Of the text in which the issues stand, and of the one in which they are to stand.
    gone : tuple of Element
        What was removed or changed.
    names : mapping of Element to Element
        Those that an explicit rename gives.
    """
    twice = {site.element: site.offset for site in plan.duplicates}

    def over(issue: Issue) -> bool:
        element = names.get(issue.element, issue.element)
        dangled = (issue.element, issue.kind) in old.dangling
        repaired = (dangled and (element, issue.kind) not in plan.dangling) or (
            issue.kind == "defined twice" and element not in twice
        )
        return any(_inside(element, other) for other in gone) or repaired or element not in plan.places

    def place(issue: Issue) -> tuple[int, int]:
        element = names.get(issue.element, issue.element)
        if issue.kind == "defined twice" and element in twice:
            return plan.program.place(twice[element])
        before, after = old.places.get(issue.element), plan.places.get(element)
        if before is None or after is None:
            return issue.line, issue.column
        (line, column), (new_line, new_column) = old.program.place(before), plan.program.place(after)
        same_line = issue.line == line
        return issue.line + new_line - line, issue.column + (new_column - column if same_line else 0)

    issues.resolve(lambda _, issue: over(issue))
    issues.move(place, names)


def _inside(element: Element, other: Element) -> bool:
    """Whether an element is the other one, or stands in it."""
    return element == other or (
        other.kind in ("machine", "state") and element.path[: len(other.path)] == other.path
    )
