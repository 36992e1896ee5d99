"""``robot``: the only object of a bridge that a program sees.

It is stable: bridges come and go, members come and go, the object stays. It offers what the bridge
added and nothing else, so that completion and errors name only members of the robot.

Paper: §3.2 (the pseudo-variable ``robot``), §7.
"""

from __future__ import annotations

from collections.abc import Iterable
from operator import attrgetter
from typing import Any, NoReturn

from lrp_jupyter.bridges.member_tree import MemberOwner, RobotMethod, RobotVariable
from lrp_jupyter.bridges.members import MemberError
from lrp_jupyter.errors import NotAValue, did_you_mean


class Robot(NotAValue):
    """The robot of a program, or a part of it (``robot.light``).

    Attributes are the members that the bridge added. A name that does not exist raises
    :class:`MemberError`, which lists those that do; a reading that has not arrived yet raises
    :class:`~lrp_jupyter.errors.NoDataYet`.
    """

    __slots__ = ("_bridge", "_prefix")
    _bridge: MemberOwner
    _prefix: str

    def __init__(self, bridge: MemberOwner, prefix: str = "") -> None:
        object.__setattr__(self, "_bridge", bridge)
        object.__setattr__(self, "_prefix", prefix)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):  # copy, pickle and notebooks ask for these; no list of members
            raise MemberError(f"`robot` has no `{name}`.")
        node = self._bridge.nodes.table.get(self._prefix + name)
        if node is None:
            if "." in name:  # asked for at once, see `language.blocks.companions`
                return attrgetter(name)(self)
            raise self._unknown(name)
        return node.read() if type(node) is RobotVariable else node

    def __setattr__(self, name: str, value: object) -> None:
        node = self._bridge.nodes.table.get(self._prefix + name)
        if node is None:
            raise self._unknown(name)
        path = f"robot.{self._prefix}{name}"
        if isinstance(node, Robot):
            members = ", ".join(f"`{path}.{member}`" for member in node._listed())
            raise MemberError(f"`{path}` is a part of the robot and cannot be assigned. It has {members}.")
        if isinstance(node, RobotMethod):
            raise MemberError(f"`{path}` cannot be assigned. Call it as `{path}{node.signature}`.")
        raise MemberError(
            f"`{path}` is read from the robot and cannot be assigned. Keep values in a `var` of the program."
        )

    def __delattr__(self, name: str) -> None:
        raise MemberError(f"`robot.{self._prefix}{name}` cannot be deleted; its bridge provides it.")

    def __bool__(self) -> bool:
        return not self._prefix or self._refuse()

    def __call__(self, *_: object, **__: object) -> NoReturn:
        """Raise: a part of the robot cannot be called."""
        self._refuse()

    def _not_a_value(self) -> str:
        what, names = self._in_text(), self._listed()
        table = self._bridge.nodes.table
        readings = [name for name in names if isinstance(table[self._prefix + name], RobotVariable)]
        if "data" in readings or len(readings) == 1:
            value = "data" if "data" in readings else readings[0]
            return f"`{what}` is the sensor; its value is `{what}.{value}`."
        listed = ", ".join(f"`{what}.{name}`" for name in names) or "no members"
        return f"`{what}` is a part of the robot, not a value. It has {listed}."

    def __dir__(self) -> list[str]:
        return self._names(self._bridge.nodes.table)

    def _listed(self) -> list[str]:
        """Return the names of the members without what accompanies every reading."""
        table = self._bridge.nodes.table.items()
        return self._names(path for path, node in table if not (type(node) is RobotVariable and node.of))

    def _names(self, paths: Iterable[str]) -> list[str]:
        prefix = self._prefix
        return sorted({path[len(prefix) :].partition(".")[0] for path in paths if path.startswith(prefix)})

    def __copy__(self) -> Robot:
        return self

    def __deepcopy__(self, memo: object) -> Robot:
        return self  # there is one robot, however often a value that holds it is copied

    def __repr__(self) -> str:
        return f"<{self._in_text()}: {', '.join(self._listed()) or 'no members'}>"

    def _in_text(self) -> str:
        return f"robot.{self._prefix}".rstrip(".")

    def _unknown(self, name: str) -> MemberError:
        what, names = self._in_text(), self._listed()
        sentence = f": the bridge `{self._bridge.name}` offers no members. Open it, or choose another bridge."
        if names:
            listed = ", ".join(f"`{member}`" for member in names)
            sentence = f"; it has {listed}.{did_you_mean(name, dir(self))}"
        error = MemberError(f"`{what}` has no `{name}`{sentence}")
        error.missing = self._prefix + name
        return error


def part_name(value: object) -> str | None:
    """Return the dotted name of a part of a robot (``light``); None for anything else."""
    return object.__getattribute__(value, "_prefix")[:-1] or None if isinstance(value, Robot) else None


def attach(robot: Robot, bridge: MemberOwner) -> None:
    """Attach an existing `robot` to another bridge; programs keep the same object."""
    object.__setattr__(robot, "_bridge", bridge)
