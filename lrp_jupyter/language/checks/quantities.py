"""526, 537: numbers that are in another unit than the robot's, or beyond what it reads or does.

The ranges and units are those of the robot's own members; where it has none, nothing is reported.
"""

from __future__ import annotations

import ast
import math
from functools import lru_cache
from typing import NamedTuple

from lrp_jupyter.language.checks.block_facts import Remark, facts_of
from lrp_jupyter.language.checks.computed_uses import means
from lrp_jupyter.language.checks.constants import Constants, WrittenValue
from lrp_jupyter.language.checks.report import Reporter, replace
from lrp_jupyter.language.checks.scanned import scanned
from lrp_jupyter.language.checks.uses import Argument, Beside, NameUse, RobotCall, number_of, uses_of
from lrp_jupyter.language.program import Edit, Fix, Span
from lrp_jupyter.language.resolution import PlacedBlock, Resolution
from lrp_jupyter.language.robot_members import Limits, Parameters, RobotMember, RobotMembers

_TURNS = 4 * math.pi
"""Radians beyond which a number is rather one of degrees: two turns."""
_EIGHTH = math.pi / 4
_LONG = 500
"""Seconds from which on a number is rather one of milliseconds."""
_COARSE = 100
"""The length of a range from which on a number up to 1 is rather a share of it."""
_BETWEEN = "Compare it with a number in between"
_ANGLES = frozenset({"sin", "cos", "tan", "degrees"})


def check_quantities(report: Reporter, names: Resolution, robot: RobotMembers | None) -> None:
    """Report numbers that cannot be meant in the unit of what they are compared with or passed to."""
    _Quantities(report, names, robot).check()


class _Number(NamedTuple):
    """A number that is used.

    `span`: where it is written; in a variable, `name` is that of the variable.
    `text`: how it is written where it is used.
    """

    value: float
    span: Span
    name: str
    text: str

    @property
    def shown(self) -> str:
        """Its value, after the name of the variable that has it."""
        return f"`{self.name}` is {self.value:g}, and " if self.name else ""


class _Quantities:
    def __init__(self, report: Reporter, names: Resolution, robot: RobotMembers | None) -> None:
        self.report, self.names, self.robot = report, names, robot
        self.constants = Constants(names)
        self.outside = frozenset(report.names)
        self.told: set[Span] = set()
        self.stated: tuple[Remark, ...] = ()
        """Comparisons of the present block that are not used."""

    def check(self) -> None:
        for place in self.names.all_blocks:
            text = place.block.text
            self.stated = facts_of(text).comparisons if place.purpose == "action" else ()
            if "robot" not in place.visible and self.robot is not None:
                for use in uses_of("robot", text):
                    member = self.robot.members.get(".".join(use.names))
                    if member is not None:
                        self._member(place, use, member)
            if means(place, "elapsed", self.outside) and place.event("elapsed") is None:
                for use in uses_of("elapsed", text) if "elapsed" in text else ():
                    self._elapsed(place, use)
            self._angles(place)

    def _member(self, place: PlacedBlock, use: NameUse, member: RobotMember) -> None:
        if member.parameters is None:
            for beside in use.beside:
                number = self._beside(place, beside)
                if beside.text == "None" and member.limits is not None:
                    self._none(place, member, beside)
                elif number is not None:
                    self._compared(place, member, beside.sign, number)
        elif use.call is not None and not use.call.is_open:
            self._passed(place, f"robot.{member.path}", member.parameters, use.call)

    # -- numbers, perhaps by the name of a variable -------------------------------------------------

    def _beside(self, place: PlacedBlock, beside: Beside) -> _Number | None:
        if any(stated.span.start <= beside.span.start < stated.span.end for stated in self.stated):
            return None  # that it is only compared is a finding of its own
        if beside.number is not None:
            return _Number(beside.number, place.block.at(beside.span), "", beside.text)
        return self._named(place, beside.name)

    def _argument(self, place: PlacedBlock, argument: Argument) -> _Number | None:
        if argument.number is not None:
            written = place.block.text[slice(*argument.value)]
            return _Number(argument.number, place.block.at(argument.value), "", written)
        return self._named(place, argument.root)

    def _named(self, place: PlacedBlock, name: str) -> _Number | None:
        written: WrittenValue | None = self.constants.number(place.visible.get(name), name)
        if written is None or written.number is None:
            return None
        return _Number(written.number, written.block.at(written.span), name, name)

    def _add(self, code: str, number: _Number, message: str, meant: str | None = None) -> None:
        if number.span not in self.told:
            self.told.add(number.span)
            self.report.add(code, number.span, message, replace(number.span, meant) if meant else None)

    # -- what is compared -----------------------------------------------------------------------------

    def _compared(self, place: PlacedBlock, member: RobotMember, sign: str, number: _Number) -> None:
        value, path = number.value, f"robot.{member.path}"
        if member.limits is None:
            if member.unit == "rad" and abs(value) > _TURNS and not number.text.startswith("degrees"):
                self._add("LRP537", number, *_angle(f"`{path}` is in radians", number))
            elif member.type == "float" and sign in ("==", "!="):
                self._exactly(place, path, sign, number)
            return
        low, high = member.limits
        if value <= high and (low <= value or member.type == "float"):  # it may be a little below, by noise
            is_share = 0 < value <= 1 and high - low > _COARSE and sign not in ("==", "!=")
            if is_share and member.type == "int":
                self._share(path, member.limits, sign, number)
            elif member.type == "float" and sign in ("==", "!="):
                self._exactly(place, path, sign, number)
            return
        is_true = sign == "!=" or sign in (("<", "<=") if value > high else (">", ">="))
        test = f"`{sign} {number.text}`"
        if member.type == "float" and value > high:
            what = f"`{path}` is at most {high:g}{_short(member.unit)}, or `inf` if nothing is in reach"
            outcome = f"so {test} is {'true' if is_true else 'false'} for everything in reach"
        else:
            what = f"`{path}` is a number from {low:g} to {high:g}"
            outcome = f"so {test} is {'always' if is_true else 'never'} true"
        meant = _metres(value, member.unit, member.limits)
        remedy = f"For {value:g} cm, write `{meant}`" if meant else _BETWEEN
        self._add("LRP526", number, f"{number.shown}{what}, {outcome}. {remedy}.", meant)

    def _none(self, place: PlacedBlock, member: RobotMember, beside: Beside) -> None:
        message, at = f"`robot.{member.path}` is never `None`.", place.block.at(beside.span)
        if member.type == "float":
            inf = 'float("inf")'
            self.report.add(
                "LRP526", at, f"{message} If nothing is in reach, it is `{inf}`.", replace(at, inf)
            )
        else:
            self.report.add("LRP526", at, f"{message} Compare it with a number.")

    def _share(self, path: str, limits: Limits, sign: str, number: _Number) -> None:
        low, high = limits
        value = number.value
        meant = round(low + value * (high - low)) if value < 1 else None
        remedy = f"For {value:.0%} of that, write `{meant}`" if meant else _BETWEEN
        outcome = "hardly ever" if sign in ("<", "<=") else "nearly always"
        what = f"`{path}` is a whole number from {low:g} to {high:g}"
        message = f"{number.shown}{what}, so `{sign} {number.text}` is {outcome} true. {remedy}."
        self._add("LRP537", number, message, str(meant) if meant else None)

    def _exactly(self, place: PlacedBlock, what: str, sign: str, number: _Number) -> None:
        instead = "`<` or `>`" if sign == "==" else "`<` and `>`"
        outcome = "almost never exactly" if sign == "==" else "almost always different from"
        message = f"`{what}` is measured, so it is {outcome} `{number.text}`."
        self._add("LRP526", number, f"{message} Compare with {instead}.")

    def _elapsed(self, place: PlacedBlock, use: NameUse) -> None:
        for beside in use.beside:
            number = self._beside(place, beside)
            if number is None:
                continue
            if number.value >= _LONG:
                meant = f"{number.value / 1000:g}"
                minutes = f"{number.value:g} s is {number.value / 60:.0f} minutes"
                message = f"{number.shown}`elapsed` is in seconds: {minutes}."
                self._add("LRP537", number, f"{message} For {number.value:g} ms, write `{meant}`.", meant)
            elif beside.sign in ("==", "!="):
                self._exactly(place, "elapsed", beside.sign, number)

    # -- what is passed -------------------------------------------------------------------------------

    def _passed(self, place: PlacedBlock, path: str, parameters: Parameters, call: RobotCall) -> None:
        plain = [argument for argument in call.arguments if not argument.name]
        by_place = zip(parameters.names, plain, strict=False) if not parameters.fields else ()
        named = [(each.name, each) for each in call.arguments if each.name and not each.assigns]
        if self._halved(place, path, parameters, plain):
            return
        for name, argument in [*by_place, *named]:
            number = self._argument(place, argument)
            if number is not None:
                self._argued(path, name, parameters, number)

    def _argued(self, path: str, name: str, parameters: Parameters, number: _Number) -> None:
        unit = parameters.units.get(name, "")
        limits, likely = parameters.limits.get(name), parameters.likely.get(name)
        value = number.value
        if likely and not likely[0] <= value <= likely[1]:
            if unit == "rad":
                self._add("LRP537", number, *_angle(f"`{path}` takes radians", number))
                return
            meant = _metres(value, unit, likely)
            remedy = f"For {value:g} cm, write `{meant}`" if meant else "Write a smaller number"
            much = "far" if unit == "m" else "much"
            message = f"{number.shown}{value:g}{_short(unit)} is too {much} for `{path}`."
            self._add("LRP537", number, f"{message} {remedy}.", meant)
        elif limits and not limits[0] <= value <= limits[1]:
            low, high = limits
            most = high if value > high else low
            meant = _metres(value, unit.removesuffix("/s"), limits) if abs(value) >= 5 else None
            remedy = f"For {value:g} cm per second, write `{meant}`"
            if unit == "rad/s" and abs(math.radians(value)) <= high:
                meant = f"degrees({value:g})"
                remedy = f"For {value:g} degrees per second, write `{meant}`"
            elif meant is None:
                remedy = f"Write at {'most' if most == high else 'least'} `{most:g}`"
            message = f"{number.shown}`{name}` is limited to {most:g}{_short(unit)}. {remedy}."
            self._add("LRP537", number, message, meant)

    def _halved(self, place: PlacedBlock, path: str, parameters: Parameters, plain: list[Argument]) -> bool:
        """Report `turn_by(0,5)`, which has a decimal comma."""
        if len(plain) != 2 or len(parameters.required) != 1:
            return False
        span = Span(plain[0].span.start, plain[1].span.end)
        text = place.block.text[slice(*span)]
        if not text.replace(",", "", 1).isdigit():
            return False
        point = text.replace(",", ".")
        message = f"A decimal number has a point, and a comma begins another argument. Write `{point}`."
        self.report.add("LRP518", place.block.at(span), message, replace(place.block.at(span), point))
        return True

    # -- angles ---------------------------------------------------------------------------------------

    def _angles(self, place: PlacedBlock) -> None:
        known = self.robot.members if self.robot is not None and "robot" not in place.visible else {}
        radians = frozenset(path for path, member in known.items() if member.unit == "rad")
        is_ours = "degrees" not in place.visible and "degrees" not in self.outside
        for span, what, edits in _converted(place.block.text, radians) if is_ours else ():
            message = f"`degrees` converts an angle from degrees, and {what} is in radians already."
            remedy = "Remove `degrees`."
            if len(edits) > 2:
                other = place.block.text[slice(*edits[2][:2])]
                remedy = f"Convert the other side: `degrees({other})`."
            at = [Edit(*place.block.at(Span(start, end)), text) for start, end, text in edits]
            fix = Fix("Remove `degrees`" if len(edits) == 2 else "Convert the other side", tuple(at))
            self.report.add("LRP537", place.block.at(span), f"{message} {remedy}", fix)
        for name, number, span in _trigonometry(place.block.text):
            message = f"`{name}` takes an angle in radians, and {number:g} rad is {_turns(number)}."
            meant = f"degrees({number:g})"
            if name.endswith("degrees"):
                message = f"`{name}` converts radians into degrees, and robots turn by radians."
            at_number = _Number(number, place.block.at(span), "", f"{number:g}")
            self._add("LRP537", at_number, f"{message} For {number:g} degrees, write `{meant}`.", meant)


def _angle(what: str, number: _Number) -> tuple[str, str]:
    value = f"{number.value:g}"
    meant = f"degrees({value})"
    message = f"{number.shown}{what}: {value} rad is {_turns(number.value)}."
    return f"{message} For {value} degrees, write `{meant}`.", meant


def _turns(angle: float) -> str:
    return f"{abs(angle) / math.tau:.0f} turns"


def _short(unit: str) -> str:
    return f" {unit}" if unit else ""


def _metres(value: float, unit: str, limits: Limits) -> str | None:
    """Return a number of centimetres in metres, if it is in a range then."""
    metres = value / 100
    return f"{metres:g}" if unit == "m" and limits[0] <= metres <= limits[1] else None


_Edits = tuple[Edit, ...]


@lru_cache(maxsize=20_000)
def _converted(text: str, radians: frozenset[str]) -> tuple[tuple[Span, str, _Edits], ...]:
    """Return the calls of `degrees` with an angle in radians: the call, what is in radians, and the edits."""
    block = scanned(text, ("degrees(", "degrees ("))
    if block is None or "degrees" in block.stored or "degrees" in block.imported:
        return ()
    found = []
    compared = {}
    for node in block.nodes:
        if isinstance(node, ast.Compare) and len(node.ops) == 1:
            compared[node.left], compared[node.comparators[0]] = node.comparators[0], node.left
    for node in block.nodes:
        is_call = isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "degrees"
        if not is_call or not isinstance(node, ast.Call) or len(node.args) != 1 or node.keywords:
            continue
        number = number_of(node.args[0])
        what = _in_radians(node.args[0], radians)
        if number is not None and number % 1 and abs(number / _EIGHTH - round(number / _EIGHTH)) < 0.01:
            what = f"`{number:g}`"
        if what:
            whole, inner = block.span(node), block.span(node.args[0])
            edits = [Edit(whole.start, inner.start, ""), Edit(inner.end, whole.end, "")]
            other = compared.get(node)
            if other is not None and number_of(other) is not None:
                around = block.span(other)
                edits.append(Edit(*around, f"degrees({text[slice(*around)]})"))
            found.append((whole, what, tuple(edits)))
    return tuple(found)


def _in_radians(node: ast.expr, radians: frozenset[str]) -> str:
    """Return what of an expression is in radians: a reading of the robot, `pi`; empty if nothing is."""
    for each in ast.walk(node):
        if isinstance(each, ast.Attribute | ast.Name):
            name = ast.unparse(each)
            if name.removeprefix("robot.") in radians or name in ("pi", "math.pi"):
                return f"`{name}`"
    return ""


@lru_cache(maxsize=20_000)
def _trigonometry(text: str) -> tuple[tuple[str, float, Span], ...]:
    """Return the calls of `math.sin` and the like with a number that is rather one of degrees."""
    block = scanned(text, _ANGLES)
    if block is None or "degrees" in block.stored:
        return ()
    found = []
    for node in block.nodes:
        if isinstance(node, ast.Call) and len(node.args) == 1:
            whole, _ = block.whole(node.func)
            module, _, name = whole.rpartition(".")
            number = number_of(node.args[0])
            if module == "math" and name in _ANGLES and number is not None and abs(number) > _TURNS:
                place = node if name == "degrees" else node.args[0]
                found.append((ast.unparse(node.func), number, block.span(place)))
    return tuple(found)
