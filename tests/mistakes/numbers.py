"""Typical mistakes with numbers and units, and with what a block can do."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator

from lrp_jupyter import programs

from .inside import ACTIONS, CONDITIONS, Place, in_worlds, places, words
from .planting import Slip, kind, slip
from .sources import Form, Source

NUMBER = r"\d+\.\d+|\d+"


def _numbers(
    name: str, pattern: str, change: Callable[[float], str | None], *keywords: str, in_world: bool = True
) -> None:
    """Register a kind that replaces the number of a match: its group `n`, or the whole group `all`."""

    @kind(name)
    def _(source: Source) -> Iterator[Slip]:
        if in_world and programs.heading(source.text).world in (None, "none"):
            return
        for found in places(source, pattern, *keywords):
            new = change(float(found.match["n"]))
            group = "all" if "all" in found.match.groupdict() else "n"
            if new is not None:
                yield slip(*_group(found, group), new)


def _group(found: Place, group: str) -> tuple[int, int]:
    start = found.start - found.match.start()
    return start + found.match.start(group), start + found.match.end(group)


def _short(number: float) -> str:
    return f"{number:g}"


# Units

_numbers(
    "robot: distance in centimetres",
    rf"(?:\.distance|\bdistance\.data) [<>]=? (?P<n>{NUMBER})(?! *[*/])",
    lambda metres: _short(metres * 100) if 0.03 <= metres <= 2 else None,
)
_numbers(
    "robot: speed in centimetres per second",
    rf"\blinear=-?(?P<n>{NUMBER})\b(?! *\*)",
    lambda metres: _short(metres * 100) if metres >= 0.05 else None,
)
_numbers(
    "robot: turning speed in degrees",
    rf"\bangular=-?(?P<all>(?:degrees\()?(?P<n>{NUMBER})\)?)(?=[,)])",
    lambda angle: _short(angle if angle >= 5 else round(math.degrees(angle))) if angle >= 0.1 else None,
)
_numbers(
    "robot: brightness as a share",
    rf"(?:\.light|\blight\.data) [<>] (?P<n>{NUMBER})\b",
    lambda grey: f"{grey / 255:.2f}",
)
_numbers(
    "robot: angle passed in degrees", rf"\bturn_by\((?P<all>degrees\((?P<n>{NUMBER})\))", _short
)  # fmt: skip
_numbers(
    "robot: angle compared in degrees",
    rf"\b(?:gyro\.data|odom\.theta)\)? [<>]=? (?P<all>degrees\((?P<n>{NUMBER})\))",
    _short,
)
in_worlds(
    "reading converted by `degrees`",
    rf"\brobot\.(gyro\.data|odom\.theta) ([<>]=?) degrees\(({NUMBER})\)",
    r"degrees(robot.\1) \2 \3",
)
in_worlds(
    "measured value compared by `==`", rf"((?:\.distance|\bdistance\.data) )[<>]=?( {NUMBER})", r"\1==\2"
)
_numbers(
    "inside: `elapsed` in milliseconds",
    rf"\belapsed [<>]=? (?P<n>{NUMBER})\b",
    lambda seconds: _short(seconds * 1000) if seconds >= 0.5 else None,
    in_world=False,
)


@kind("delay: in seconds")
def _(source: Source) -> Iterator[Slip]:
    for form in source.all("ontime", "on", "exit"):
        for token in form.of("INTEGER"):
            if (number := int(source.word(token))) >= 1000 and not number % 1000:
                yield slip(*token[1:], f"{number // 1000}")


@kind("delay: variable in seconds")
def _(source: Source) -> Iterator[Slip]:
    used = {source.word(form.tokens[1]) for form in source.all("ontime") if form.types[1] == "NAME"}
    for name, start, end, value in _variables(source):
        if name in used and re.fullmatch(r"\d+000", value) and not _is_set(source, name):
            yield slip(start, end, value[:-3])


@kind("delay: decimal comma and unit")
def _(source: Source) -> Iterator[Slip]:
    for form in source.all("ontime"):
        for token in form.of("INTEGER"):
            number = int(source.word(token))
            if number >= 100:
                seconds = f"{number / 1000:.1f}".replace(".", ",")
                right = source.text[: token[1]] + f"{round(number / 100) * 100}" + source.text[token[2] :]
                end = token[1] + len(f"{round(number / 100) * 100}")
                yield Slip(((token[1], end, f"{seconds} s"),), (), right)


# Numbers as they are written

words("number without its point", r"(?<![\w.])0\.([1-9]\d)\b", r"0\1", *ACTIONS)
_numbers(
    "robot: speed in percent",
    rf"\blinear=(?P<n>{NUMBER})(?=[,)])",
    lambda share: f"{share * 100:g}%",
)


def _variables(source: Source) -> Iterator[tuple[str, int, int, str]]:
    """The variables with one line as their value: name, place and text of that."""
    for form in source.all("var"):
        for _, start, end in form.of("BLOCK"):
            yield source.word(form.tokens[1]), start + 1, end - 1, source.text[start + 1 : end - 1]


def _is_set(source: Source, name: str) -> bool:
    return re.search(rf"\b{name} = |\(var {name} [^)]*\).*\(var {name} ", source.text, re.DOTALL) is not None


def _is_used_as_a_number(source: Source, name: str) -> bool:
    use = rf"\b(linear|angular)=-?{name}[,)]|\.data [<>]=? {name}\b|\b{name} [-+/] \d|{name} [+-]= \d"
    return re.search(use, source.text) is not None


def _in_variables(name: str, pattern: str, new: str, condition: Callable[[Source, str], bool]) -> None:
    @kind(f"variable: {name}")
    def _(source: Source) -> Iterator[Slip]:
        for variable, start, end, value in _variables(source):
            found = re.fullmatch(pattern, value)
            if found and condition(source, variable):
                yield slip(start, end, found.expand(new))


def _is_number_for_ever(source: Source, name: str) -> bool:
    return _is_used_as_a_number(source, name) and not _is_set(source, name)


_in_variables("decimal comma", r"(\d+)\.(\d+)", r"\1,\2", _is_number_for_ever)
_in_variables("number in quotes", rf"({NUMBER})", r'"\1"', _is_number_for_ever)
_in_variables("truth value in quotes", r"(True|False)", r'"\1"', lambda source, name: True)

# What a block can do

MOVE = r"robot\.move\(linear=[^,()]+"
ALONE = r"^( *)(robot\.\w+\([^()\n]*\))$"
in_worlds("two commands for one", rf"\b({MOVE}), (angular=[^,()]+\))", r"\1); robot.move(\2")
in_worlds("command without its arguments", r"^( *robot\.(?:move|turn_by|drive_by))\(.*\)$", r"\1", *ACTIONS)
in_worlds("`None` for `inf`", r'(\.data [!=]=) float\("inf"\)', r"\1 None")
in_worlds("other word for a command", r"\brobot\.move\(linear=(?=\d)[^()]*\)", "robot.forward()", *ACTIONS)
in_worlds("other word for a sensor", r"\brobot\.light\.data\b", "robot.colour")
words("`inf` alone", r'float\("inf"\)', "inf")
words("function of a module alone", r"\bmath\.(?=[a-z])", "", *ACTIONS)
words("`sleep`", ALONE, r"\1\2; sleep(2)", *ACTIONS)


@kind("inside: `time.sleep`")
def _(source: Source) -> Iterator[Slip]:
    if all(name != "time" for name, *_ in _variables(source)):
        for found in places(source, ALONE, *ACTIONS):
            yield slip(found.end, found.end, "; time.sleep(2)")


@kind("inside: a state is assigned")
def _(source: Source) -> Iterator[Slip]:
    variables = {name for name, *_ in _variables(source)}
    for form in source.all("state"):
        for inner in form.forms:
            state = source.word(form.tokens[1])
            if inner.keyword == "running" and state not in variables:
                for _, _, end in inner.of("BLOCK"):
                    yield slip(end - 1, end - 1, f"; state = {state}")


@kind("inside: text without its `f`")
def _(source: Source) -> Iterator[Slip]:
    for found in places(source, r"\brobot\.(stop|lamp)\([^()]*\)$", *ACTIONS):
        right = f'{source.text[: found.start]}print(f"{{robot.gyro.data}}"){source.text[found.end :]}'
        at = found.start + len("print(")
        yield Slip(((at, at + 1, ""),), (), right)


_numbers(
    "robot: bounds that exclude each other",
    rf"\b(?P<all>robot\.(?:light|distance)\.data < (?P<n>{NUMBER}))$",
    lambda number: (
        f"robot.light.data < {number / 4:g} and robot.light.data > {number:g}" if number > 9 else None
    ),
    *CONDITIONS,
)


@kind("inside: a counter that begins again")
def _(source: Source) -> Iterator[Slip]:
    for found in places(source, r"(?:^|\A)( *)(\w+) \+= 1$", "running"):
        yield slip(found.start, found.start, f"{found.match[1]}{found.match[2]} = 0; ".lstrip())


# Names of states


def _names_of(source: Source, *keywords: str) -> Iterator[Form]:
    return (form for form in source.all(*keywords) if form.types[1:2] == ("NAME",))


@kind("name: of two words")
def _(source: Source) -> Iterator[Slip]:
    uses = {
        (start, end)
        for form in source.forms
        for _, start, end in form.of("NAME")
    }  # fmt: skip
    for form in _names_of(source, "state", "machine"):
        name = source.word(form.tokens[1])
        if form.forms and "_" in name.strip("_") and name not in _in_blocks(source):
            places_of = [place for place in uses if source.text[slice(*place)] == name]
            yield Slip(tuple((start, end, name.replace("_", " ", 1)) for start, end in sorted(places_of)))


def _in_blocks(source: Source) -> set[str]:
    texts = (source.text[start:end] for form in source.forms for _, start, end in form.of("BLOCK"))
    return {word for text in texts for word in re.findall(r"\w+", text)}


@kind("name: a start state by its stem")
def _(source: Source) -> Iterator[Slip]:
    for form in _names_of(source, "spawn"):
        _, start, end = form.of("NAME")[1]
        name = source.text[start:end]
        stem = re.sub(r"(ing|ed)$", "e", name)
        others = [source.word(each.tokens[1]) for each in _names_of(source, "state")]
        alike = [other for other in others if other[:4] == name[:4]]
        if name.endswith(("ving", "ching", "ting")) and len(alike) == 1 and len(name) > 6:
            yield slip(start, end, stem)
