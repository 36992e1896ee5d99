"""The options of a bridge: the parameters of its constructor, whose annotations say how a text is read.

On the command line and in magics an option is a text. ``port: int`` makes ``--option port=7`` the number 7,
for every bridge in the same way, and refuses ``port=fast`` in a sentence. Known are int, float, bool, str,
paths, enumerations, `Literal` and unions of these; a text for anything else is passed as it is. A value that
is not a text is not touched.
"""

from __future__ import annotations

import inspect
import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import Enum
from pathlib import Path, PurePath
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

from lrp_jupyter.bridges.interface import Interface
from lrp_jupyter.errors import BridgeError, did_you_mean

_TRUE, _FALSE = ("true", "yes", "on", "1"), ("false", "no", "off", "0")
_PLAIN: Mapping[object, str] = {
    int: "a whole number",
    float: "a number",
    bool: "`true` or `false`",
    str: "a text",
}


@dataclass(frozen=True, slots=True)
class BridgeOption:
    """One option."""

    name: str
    kind: object  # its annotation or, without one, the type of its default value
    default: object = inspect.Parameter.empty
    doc: str = ""  # the first sentence about it in the docstring of the class

    @property
    def is_needed(self) -> bool:
        """Whether it has no default value."""
        return self.default is inspect.Parameter.empty

    @property
    def words(self) -> str:
        """What it takes, in words: ``"a whole number"``."""
        words = []
        for each in _members(self.kind):
            if choices := _choices(each):
                words += [f"`{text}`" for text in choices]
            elif _is_path(each):
                words.append("a path")
            elif each in _PLAIN:
                words.append(_PLAIN[each])
            elif each is not NoneType:
                words.append("a text")
        unique = [*dict.fromkeys(words)]
        if "a number" in unique and "a whole number" in unique:
            unique.remove("a whole number")
        return " or ".join((", ".join(unique[:-1]), unique[-1]) if unique[1:] else unique)

    def convert(self, text: str) -> object:
        """Return the value of a text; ValueError, with a hint or an empty text, if it is not of this type."""
        members = [each for each in _members(self.kind) if each is not NoneType]
        if NoneType in _members(self.kind) and str not in members and text.casefold() == "none":
            return None
        known = [each for each in members if each in _PLAIN or _choices(each) or _is_path(each)]
        if len(known) < len(members) and str not in members:
            known.append(object)
        hint = ""
        for each in known:
            try:
                return _plain(each, text)
            except ValueError as error:
                hint = str(error) or hint
        raise ValueError(hint)


def options_of(bridge: type[Interface]) -> dict[str, BridgeOption] | None:
    """Return the options of a bridge by name; None if it takes any."""
    if bridge.__init__ is object.__init__:
        return {}
    parameters = inspect.signature(bridge).parameters.values()
    if any(parameter.kind is parameter.VAR_KEYWORD for parameter in parameters):
        return None
    try:
        hints = get_type_hints(bridge.__init__)
    except Exception:  # a name in an annotation may be known to a type checker only
        hints = {}
    docs = _parameter_docs(bridge)
    return {
        each.name: BridgeOption(
            each.name, hints.get(each.name, _kind_of(each.default)), each.default, docs.get(each.name, "")
        )
        for each in parameters
        if each.kind is not each.VAR_POSITIONAL
    }


def convert_options(bridge: type[Interface], options: Mapping[str, Any]) -> dict[str, Any]:
    """Return options with the values of those that are texts; a BridgeError names one of another type."""
    known, read = options_of(bridge) or {}, dict(options)
    for name, text in options.items():
        if isinstance(text, str) and name in known:
            try:
                read[name] = known[name].convert(text)
            except ValueError as error:
                raise BridgeError(
                    f"The bridge `{bridge.name}`: `{name}` takes {known[name].words}, not `{text}`.{error}"
                ) from None
    return read


def no_option(
    bridge: type[Interface], option: str, questions: Iterable[str], others: Iterable[str] = ()
) -> str:
    """Return the sentence about an option that a bridge does not take, nor asks as a question."""
    known = [*dict.fromkeys((*(options_of(bridge) or ()), *questions))]
    listed = ", ".join(f"`{name}`" for name in known) or "no options"
    hint = did_you_mean(option, [*known, *others], 0.7)
    if not hint and bridge.name == "none":
        hint = ' Name the robot that takes it, as in `bridge="sim"`.'
    return f"The bridge `{bridge.name}` has no option `{option}`; it takes {listed}.{hint}"


def refuse_options(bridge: type[Interface], options: Iterable[str], others: Iterable[str] = ()) -> None:
    """Raise a BridgeError for an option that a bridge does not take, or lacks.

    `others`: further keywords of the caller, one of which may be meant.
    """
    known, given = options_of(bridge), set(options)
    if known is None:
        return
    for option in options:
        if option not in known:
            raise BridgeError(no_option(bridge, option, (), others))
    for name, each in known.items():
        if each.is_needed and name not in given:
            raise BridgeError(f"The bridge `{bridge.name}` needs the option `{name}`: {each.words}.")


# -- types ----------------------------------------------------------------------------------------


def _kind_of(default: object) -> object:
    """Return the type of an option without an annotation."""
    if default is None or default is inspect.Parameter.empty:
        return object
    return int | float if type(default) in (int, float) else type(default)


def _members(kind: object) -> tuple[object, ...]:
    """Return the types of a union in the order in which a text is tried: as a text last."""
    if get_origin(kind) not in (Union, UnionType):
        return (kind,)
    return tuple(sorted(get_args(kind), key=lambda each: (each is str, each is float)))


def _choices(kind: object) -> Mapping[str, object]:
    """Return the values among which a type lets choose, by their texts."""
    if get_origin(kind) is Literal:
        return {str(value): value for value in get_args(kind)}
    if isinstance(kind, type) and issubclass(kind, Enum):
        return {str(each.value): each for each in kind} | {each.name: each for each in kind}
    return {}


def _plain(kind: object, text: str) -> object:
    if choices := _choices(kind):
        if text in choices:
            return choices[text]
        raise ValueError(did_you_mean(text, choices))
    if kind is bool:
        if text.casefold() in (*_TRUE, *_FALSE):
            return text.casefold() in _TRUE
        raise ValueError
    try:
        if kind is int:
            return int(text)
        if kind is float and math.isfinite(number := float(text)):
            return number
    except ValueError:
        raise ValueError from None
    if kind is float:
        raise ValueError
    return Path(text) if _is_path(kind) else text


def _is_path(kind: object) -> bool:
    return isinstance(kind, type) and issubclass(kind, PurePath)


# -- docstrings -----------------------------------------------------------------------------------


def _parameter_docs(bridge: type[Interface]) -> dict[str, str]:
    """Return the first sentence about each parameter in the numpydoc text of a class."""
    text = inspect.getdoc(bridge) or ""
    section = re.search(r"^Parameters\n-+\n(.*?)(?=^\S[^\n]*\n-+$|\Z)", text, re.MULTILINE | re.DOTALL)
    docs = {}
    entries = r"^(\S[^:\n]*).*\n((?:[ \t]+.*(?:\n|\Z)|\n)*)"  # the line with the name, and those below it
    for entry in re.finditer(entries, section[1] if section else "", re.MULTILINE):
        words = " ".join(entry[2].split()).replace("``", "`")
        sentence = re.match(r".*?\.(?= |$)|.*", words)
        for name in entry[1].split(","):
            docs[name.strip()] = sentence[0] if sentence else ""
    return docs
