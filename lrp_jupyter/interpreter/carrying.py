"""What becomes of the issues when the text of a running program changes.

Issues are charged to elements and stand at places of the text. Where the text is another one they
move along with their elements; those of what is gone, changed or repaired are over. Paper: §6.2.
"""

from __future__ import annotations

from lrp_jupyter.interpreter.issues import Issue, Issues
from lrp_jupyter.interpreter.linker import Plan
from lrp_jupyter.language.identity import Successors, is_inside
from lrp_jupyter.language.program import Element

__all__ = ["carry_issues"]


def carry_issues(
    issues: Issues,
    old: Plan,
    plan: Plan,
    successors: Successors = Successors(),  # noqa: B008  (a frozen value)
    changed: tuple[Element, ...] = (),
) -> None:
    """Resolve the issues of what is gone, changed or repaired; move the others with the text.

    Parameters
    ----------
    issues : Issues
    old, plan : Plan
        Of the text in which the issues stand, and of the one in which they are to stand.
    successors : Successors
        What became of the elements of the old one.
    changed : tuple of Element
        What has another content in the new one.
    """
    twice = {site.element: site.offset for site in plan.duplicates}

    def over(issue: Issue) -> bool:
        element = successors.of(issue.element)
        if element is None or element not in plan.places or any(is_inside(element, c) for c in changed):
            return True
        dangled = (issue.element, issue.kind) in old.dangling
        return (dangled and (element, issue.kind) not in plan.dangling) or (
            issue.kind == "defined twice" and element not in twice
        )

    def place(issue: Issue) -> tuple[int, int]:
        element = successors.of(issue.element)
        if element is None:
            return issue.line, issue.column
        if issue.kind == "defined twice" and element in twice:
            return plan.program.place(twice[element])
        before, after = old.places.get(issue.element), plan.places.get(element)
        if before is None or after is None:
            return issue.line, issue.column
        (line, column), (new_line, new_column) = old.program.place(before), plan.program.place(after)
        same_line = issue.line == line
        return issue.line + new_line - line, issue.column + (new_column - column if same_line else 0)

    issues.resolve(lambda _, issue: over(issue))
    issues.move(place, successors)
