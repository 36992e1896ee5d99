"""539: commands that another one of the same block replaces before the robot does anything."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import lru_cache
from typing import NamedTuple

from lrp_jupyter.language.checks.report import Reporter, replace
from lrp_jupyter.language.checks.scanned import ScannedBlock, scanned
from lrp_jupyter.language.program import Element, Span
from lrp_jupyter.language.resolution import PlacedBlock, Resolution
from lrp_jupyter.language.robot_members import RobotMembers


class _LoneCall(NamedTuple):
    """A call of a method of the robot that stands alone in a line; `arguments`: by name, as they are written.

    `row`: the number of the statements that follow each other in which it is; 0 for those of the block.
    `is_repeated`: whether a loop repeats it and nothing else decides about it.
    """

    path: str
    span: Span
    row: int
    arguments: tuple[tuple[str, str], ...] | None
    is_repeated: bool


def check_commands(report: Reporter, names: Resolution, robot: RobotMembers | None) -> None:
    """Report commands that are replaced at once: a robot does only what it was told last."""
    by_element: dict[Element, list[tuple[PlacedBlock, _LoneCall]]] = {}
    movers = {} if robot is None else {path: each.mover for path, each in robot.members.items()}
    for place in names.all_blocks:
        if place.purpose != "action" or "robot" in place.visible:
            continue
        before: dict[tuple[int, str], _LoneCall] = {}
        first = by_element.setdefault(place.element, [])
        for command in _commands(place.block.text):
            mover = movers.get(command.path)
            if mover is None:
                continue
            earlier = before.get((command.row, mover))
            if earlier is not None and not earlier.path.endswith("stop"):
                _replaced(report, place, earlier, place, command)
            elif earlier is None and command.row == 0:
                outer = next((each for each in first if movers.get(each[1].path) == mover), None)
                if outer is not None and not outer[1].path.endswith("stop"):
                    _replaced(report, outer[0], outer[1], place, command)
            if command.is_repeated:
                message = (
                    f"The whole loop runs within one tick, so only its last `robot.{command.path}` counts. "
                    "Remove the loop: `running` is repeated at every tick anyway."
                )
                report.add("LRP539", place.block.at(command.span), message)
            before[command.row, mover] = command
        first += [(place, each) for (row, _), each in before.items() if row == 0]


def _replaced(
    report: Reporter, place: PlacedBlock, first: _LoneCall, other: PlacedBlock, second: _LoneCall
) -> None:
    line = report.line(other.block.at(second.span))
    same = "another one" if first.path == second.path else f"`robot.{second.path}`"
    message = f"This never takes effect, because {same} in line {line} replaces it within the same tick."
    fix, remedy = None, _remedy(first.path)
    ours, theirs = first.arguments, second.arguments
    if first.path == second.path and ours and theirs and not dict(ours).keys() & dict(theirs).keys():
        arguments = ", ".join(f"{name}={text}" for name, text in (*ours, *theirs))
        merged = f"robot.{first.path}({arguments})"
        remedy = f"Write both into one: `{merged}`."
        if place is other and _are_next(place, first, second):
            whole = place.block.at(Span(first.span.start, second.span.end))
            fix = replace(whole, merged, "Write both into one")
    report.add("LRP539", place.block.at(first.span), f"{message} {remedy}", fix)


def _are_next(place: PlacedBlock, first: _LoneCall, second: _LoneCall) -> bool:
    """Return whether nothing stands between two commands."""
    between = place.block.text[first.span.end : second.span.start]
    return first.row == second.row and not between.replace(";", "").strip()


def _remedy(path: str) -> str:
    if path.rpartition(".")[2] in ("move", "stop"):
        return "Write a state for each, with an `ontime` or another transition between them."
    return f"Write a state for each, with a transition `(on [robot.{path}.succeeded] …)` between them."


@lru_cache(maxsize=20_000)
def _commands(text: str) -> tuple[_LoneCall, ...]:
    block = scanned(text, ("robot.",))
    return () if block is None else tuple(_found(block, text))


def _found(block: ScannedBlock, text: str) -> Iterator[_LoneCall]:
    rows: list[tuple[list[ast.stmt], bool]] = [(block.tree.body, False)]
    for number, (row, is_loop) in enumerate(rows):
        for statement in row:
            if isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Call):
                call = statement.value
                whole, _ = block.whole(call.func)
                if whole.startswith("robot."):
                    path, arguments = whole.removeprefix("robot."), _arguments(call, block, text)
                    yield _LoneCall(path, block.span(call), number, arguments, is_loop)
            elif isinstance(statement, ast.For):
                leaves = any(isinstance(each, ast.Break | ast.Return) for each in ast.walk(statement))
                rows.append((statement.body, not leaves))
            elif isinstance(statement, ast.If | ast.While):
                rows += [(statement.body, False), (statement.orelse, False)]
            elif isinstance(statement, ast.With | ast.Try):
                rows.append((statement.body, False))


def _arguments(call: ast.Call, block: ScannedBlock, text: str) -> tuple[tuple[str, str], ...] | None:
    if call.args or any(keyword.arg is None for keyword in call.keywords):
        return None
    return tuple((str(each.arg), text[slice(*block.span(each.value))]) for each in call.keywords)
