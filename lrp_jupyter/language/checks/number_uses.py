"""518, 538: variables that are used as numbers, and begin as a text or a tuple.

What a variable is at first fails only later, at the line of its use: the place to mend is here.
"""

from __future__ import annotations

import ast
import re
from functools import lru_cache

from lrp_jupyter.language.checks.constants import Constants, WrittenValue
from lrp_jupyter.language.checks.report import Reporter, replace
from lrp_jupyter.language.checks.scanned import ScannedBlock, scanned
from lrp_jupyter.language.checks.uses import names_and_parents, number_of
from lrp_jupyter.language.program import Span
from lrp_jupyter.language.resolution import Resolution, Scope
from lrp_jupyter.language.robot_members import RobotMembers

_VELOCITY = frozenset({"linear", "angular"})
_NUMBER = re.compile(r"\s*([+-]?\d+(?:[.,]\d+)?)\s*")
_TRUTHS = {"True": "True", "true": "True", "False": "False", "false": "False"}
_ORDER = ast.Lt | ast.LtE | ast.Gt | ast.GtE
_ARITHMETIC = ast.Sub | ast.Div | ast.Pow | ast.FloorDiv


def check_number_uses(report: Reporter, names: Resolution, robot: RobotMembers | None) -> None:
    """Report variables that begin as a text or a tuple where they are used as numbers."""
    used = _used_as_numbers(names, robot)
    constants = Constants(names)
    for scope, name, written in constants.begun():
        line = None if constants.is_replaced(scope, name) else used.get((scope, name))
        text = written.block.text[slice(*written.span)]
        place, value = written.block.at(written.span), written.value
        if isinstance(value, str) and value in _TRUTHS:
            meant = _TRUTHS[value]
            message = (
                f"`{text}` is a text, and counts as true whatever it says. Write `{meant}` without quotes."
            )
            report.add("LRP538", place, message, replace(place, meant))
        elif line is not None and isinstance(value, str):
            number = _NUMBER.fullmatch(value)
            shown = report.line(Span(line, line))
            message = f"`{name}` is used as a number in line {shown}, and this is a text."
            meant = number[1].replace(",", ".") if number else ""
            remedy = f"Write `{meant}` without quotes." if meant else "Write a number."
            report.add("LRP538", place, f"{message} {remedy}", replace(place, meant) if meant else None)
        elif line is not None and isinstance(value, tuple) and _is_decimal(written):
            meant = re.sub(r"\s*,\s*", ".", text.strip("() "))
            message = f"A decimal number has a point. Write `{meant}`."
            report.add("LRP518", place, message, replace(place, meant))
        elif line is not None and isinstance(value, tuple | list):
            shown = report.line(Span(line, line))
            what = "tuple" if isinstance(value, tuple) else "list"
            message = f"`{name}` is used as a number in line {shown}, and this is a {what}. Write one number."
            report.add("LRP538", place, message)


def _is_decimal(written: WrittenValue) -> bool:
    text = written.block.text[slice(*written.span)]
    return re.fullmatch(r"\(?\s*[+-]?\d+\s*,\s*\d+\s*\)?", text) is not None


def _used_as_numbers(names: Resolution, robot: RobotMembers | None) -> dict[tuple[Scope, str], int]:
    """Return the variables that are certainly used as numbers, each with the first place of that."""
    numbers = _arguments_that_are_numbers(robot)
    found: dict[tuple[Scope, str], int] = {}
    for place in names.all_blocks:
        for name, span in numeric_uses(place.block.text, numbers):
            if name in place.visible:
                at = place.block.at(span).start
                key = place.visible[name], name
                found[key] = min(found.get(key, at), at)
    for scope in names.scopes:
        for arrow in names.arrows[scope]:
            for delay in (arrow.noun.trigger, arrow.noun.hold):
                reference = delay.reference if delay is not None else None
                owner = scope.owner("variable", reference[1]) if reference else None
                if reference and reference[0] == "variable" and owner is not None:
                    found.setdefault((owner, str(reference[1])), reference[1].span.start)
    return found


def _arguments_that_are_numbers(robot: RobotMembers | None) -> frozenset[tuple[str, str | int]]:
    """Return the methods of the robot, each with the names and places of arguments that are numbers."""
    found: set[tuple[str, str | int]] = set()
    for path, member in robot.members.items() if robot is not None else ():
        if (parameters := member.parameters) is not None:
            numbers = parameters.fields - parameters.unlike if parameters.fields else set(parameters.limits)
            found |= {(path, name) for name in numbers}
            found |= {(path, at) for at, name in enumerate(parameters.names) if name in parameters.limits}
    return frozenset(found)


@lru_cache(maxsize=20_000)
def numeric_uses(text: str, numbers: frozenset[tuple[str, str | int]]) -> tuple[tuple[str, Span], ...]:
    """Return the names that a block certainly uses as numbers, with their places."""
    block = scanned(text)
    if block is None:
        return ()
    found, parents = names_and_parents(block.tree)
    return tuple(
        (name.id, block.span(name))
        for name in found
        if not isinstance(name.ctx, ast.Del) and _is_numeric(name, parents, block, numbers)
    )


def _is_numeric(
    name: ast.Name,
    parents: dict[ast.AST, ast.AST],
    block: ScannedBlock,
    numbers: frozenset[tuple[str, str | int]],
) -> bool:
    parent = parents[name]
    if isinstance(parent, ast.AugAssign):
        return parent.target is name and number_of(parent.value) is not None
    if isinstance(parent, ast.UnaryOp):
        return isinstance(parent.op, ast.USub)
    if isinstance(parent, ast.BinOp):
        other = parent.right if parent.left is name else parent.left
        is_number = number_of(other) is not None
        return isinstance(parent.op, _ARITHMETIC) or (is_number and isinstance(parent.op, ast.Add | ast.Mult))
    if isinstance(parent, ast.Compare) and len(parent.ops) == 1:
        other = parent.comparators[0] if parent.left is name else parent.left
        is_number = number_of(other) is not None or _is_reading(other)
        return is_number and isinstance(parent.ops[0], _ORDER)
    call = parents.get(parent) if isinstance(parent, ast.keyword) else parent
    if isinstance(call, ast.Call) and name is not call.func:
        path, _ = block.whole(call.func)
        if isinstance(parent, ast.keyword):
            key: str | int = parent.arg or ""
            if path.endswith(".move") and path.startswith("robot.") and key in _VELOCITY:
                return True
        else:
            key = next((at for at, each in enumerate(call.args) if each is name), -1)
        return path.startswith("robot.") and (path.removeprefix("robot."), key) in numbers
    return False


def _is_reading(node: ast.expr) -> bool:
    """Return whether an expression is one reading of the robot, which is compared in order as a number."""
    return isinstance(node, ast.Attribute) and node.attr != "new" and ast.unparse(node).startswith("robot.")
