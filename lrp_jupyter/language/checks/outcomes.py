"""560: outcomes of tasks that are tested where the task is not asked for, so that they are never known."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from lrp_jupyter.language.checks.report import Reporter
from lrp_jupyter.language.checks.uses import NameUse, uses_of
from lrp_jupyter.language.program import Element, Path
from lrp_jupyter.language.resolution import Arrow, PlacedBlock, Resolution
from lrp_jupyter.language.robot_members import RobotMembers

_OUTCOMES = frozenset({"succeeded", "failed", "result"})
_OF_STATES = ("onentry", "running")


def check_tasks(report: Reporter, names: Resolution, robot: RobotMembers | None) -> None:
    """Report transitions that test the outcome of a task that only other states of the machine ask for."""
    for name in () if robot is None else robot.tasks:
        uses = [(place, use) for place in names.all_blocks for use in _uses(place, name)]
        asked = [place for place, use in uses if use.role in ("called", "with")]
        arrows = {arrow.element: arrow for scope in names.scopes for arrow in names.arrows[scope]}
        asking = {state for place in asked for state in _states(place, arrows)}
        machines = {state[:-1] for state in asking}
        if not asking or len(machines) > 1 or any(place.scope.path not in machines for place in asked):
            continue  # others, inside or outside, may ask for it while the state is active
        for place in names.all_blocks:
            arrow = arrows.get(place.element)
            tested = [use for use in _uses(place, name) if use.names[-1] in _OUTCOMES]
            if arrow is None or not tested or place.purpose == "action" or arrow.noun.wildcard:
                continue
            sources = {(*arrow.scope.path, str(source)) for source in arrow.noun.sources}
            if arrow.scope.path in machines and not sources & asking:
                where = ", ".join(f"`{path[-1]}`" for path in sorted(sources))
                who = ", ".join(f"`{path[-1]}`" for path in sorted(asking))
                message = (
                    f"`robot.{name}` is asked for in {who}, and its outcome is forgotten when that state is"
                    f" left. Test it there, or ask for it in {where}."
                )
                report.add("LRP560", place.block.at(tested[0].span), message)


def _uses(place: PlacedBlock, name: str) -> Iterator[NameUse]:
    path = tuple(name.split("."))
    if "robot" not in place.visible:
        yield from (use for use in uses_of("robot", place.block.text) if use.names[: len(path)] == path)


def _states(place: PlacedBlock, arrows: Mapping[Element, Arrow]) -> Iterator[Path]:
    """Yield the states that a block asks for: its own, or the one to which its transition leads."""
    element = place.element
    if element.kind in _OF_STATES:
        yield element.path
    elif element.kind == "effect":
        for arrow in arrows.values():
            if arrow.element.path == element.path and not arrow.noun.outward:
                yield (*arrow.scope.path, str(arrow.noun.destination))
