"""The known members of the robot that a program is written for, as plain data, made from its bridge."""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import Any, NamedTuple

from lrp_jupyter.language.python.python_parser import parse_python

Limits = tuple[float, float]


class Parameters(NamedTuple):
    """What a method accepts.

    `text`: as written in a definition: ``(down=True)``.
    `names`: names under which arguments can be passed, those that can also be passed by position first.
    `positional`: how many can be passed by position; None for any number.
    `required`: those without a default.
    `fields`: names of fields of a message, which can only be passed by name; empty without a message.
    `unlike`: those of the fields that are no numbers.
    `is_open`: whether other names are accepted, too.
    `limits`: the least and the greatest number for an argument, to which others are limited.
    `likely`: between which numbers an argument probably is.
    `units`: of the arguments that are numbers.
    """

    text: str
    names: tuple[str, ...] = ()
    positional: int | None = 0
    required: tuple[str, ...] = ()
    fields: frozenset[str] = frozenset()
    unlike: frozenset[str] = frozenset()
    is_open: bool = False
    limits: Mapping[str, Limits] = MappingProxyType({})
    likely: Mapping[str, Limits] = MappingProxyType({})
    units: Mapping[str, str] = MappingProxyType({})


Fields = Mapping[str, Any]
"""The names in a value, each with the fields of that, or None if these are not known."""


class RobotMember(NamedTuple):
    """A member of the robot.

    `path`: below ``robot``: ``light.data``.
    `type`: name of the type of a reading; empty where it is unknown.
    `parameters`: of a method; None for a reading.
    `acts`: whether it is a method that makes the robot do something, and returns nothing.
    `values`: all texts that a reading can be; empty if they are not known.
    `accompanies`: whether it is known of another reading, as ``light.new`` is of ``light.data``.
    `fields`: of the values of a reading; None if they may have others.
    `limits`: the least and the greatest value of a reading, besides ``inf``; None if they are not known.
    `unit`: of a reading.
    `mover`: of a method that moves the robot: which of several robots or motors; None for any other.
    """

    path: str
    type: str = ""
    parameters: Parameters | None = None
    acts: bool = False
    values: tuple[str, ...] = ()
    accompanies: bool = False
    fields: Fields | None = None
    limits: Limits | None = None
    unit: str = ""
    mover: str | None = None


@dataclass(frozen=True, eq=False)
class RobotMembers:
    """The members of a robot; it equals only itself, so that results for it can be cached.

    `members`: by their paths.
    `complete`: whether the robot has no other members and never will.
    """

    members: Mapping[str, RobotMember]
    complete: bool = False

    @cached_property
    def _inside(self) -> dict[str, dict[str, None]]:
        found: dict[str, dict[str, None]] = {"": {}}
        for path, member in self.members.items():
            if member.accompanies:
                continue
            parent = ""
            for name in path.split("."):
                found.setdefault(parent, {})[name] = None
                parent = f"{parent}.{name}" if parent else name
        return found

    def inside(self, path: str) -> tuple[str, ...]:
        """Return the names directly below a part of the robot; below the robot itself for an empty path.

        Without those that accompany a reading.
        """
        return tuple(self._inside.get(path, ()))

    @cached_property
    def tasks(self) -> tuple[str, ...]:
        """The paths of the tasks: methods of which something can be read."""
        return tuple(path for path in self.members if path in self._inside)

    def named(self, name: str) -> Iterator[str]:
        """Yield the paths of the members with a last name."""
        known = self.members.items()
        return (path for path, each in known if path.rpartition(".")[2] == name and not each.accompanies)


def parameters_of(text: str, fields: Collection[str] = (), unlike: Collection[str] = ()) -> Parameters:
    """Return the parameters that a signature such as ``(speed, seconds=1)`` describes."""
    names = [argument.partition("=")[0] for argument in text.strip("()").split(", ")]
    if fields:
        return Parameters(text, tuple(names), 1, fields=frozenset(fields), unlike=frozenset(unlike))
    try:
        function = parse_python(f"def f{text}: pass").body[0]
    except SyntaxError:  # a default that cannot be written
        return Parameters(text, positional=None, is_open=True)
    assert isinstance(function, ast.FunctionDef)
    arguments = function.args
    plain = [argument.arg for argument in [*arguments.posonlyargs, *arguments.args]]
    without = len(plain) - len(arguments.defaults)
    by_name = [argument.arg for argument in arguments.kwonlyargs]
    defaults = zip(by_name, arguments.kw_defaults, strict=True)
    required = plain[:without] + [name for name, default in defaults if default is None]
    return Parameters(
        text,
        (*plain[len(arguments.posonlyargs) :], *by_name),
        None if arguments.vararg else len(plain),
        tuple(required),
        is_open=arguments.kwarg is not None,
    )
