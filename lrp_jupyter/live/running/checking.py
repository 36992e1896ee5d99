"""Checks of a program against the robot that it is written for."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from functools import lru_cache

from lrp_jupyter import programs
from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.discovery import make_bridge
from lrp_jupyter.bridges.member_tree import RobotMethod, RobotVariable
from lrp_jupyter.bridges.members import Member
from lrp_jupyter.bridges.tasks import STATUSES, RobotTask
from lrp_jupyter.errors import BridgeError
from lrp_jupyter.language import checks
from lrp_jupyter.language.program import Finding, Program
from lrp_jupyter.language.robot_members import Fields, RobotMember, RobotMembers, parameters_of

DEFAULT_WORLD = "line"
"""The world in which a program runs that names none."""
_NUMBERS = ("number", "int", "uint", "float", "byte", "char")  # how the types of numbers begin


def check(
    text_or_program: str | Program, names: Collection[str] = (), bridge: Bridge | str | None = None
) -> tuple[Finding, ...]:
    """Return the findings about a program, without running it.

    Parameters
    ----------
    text_or_program : str or Program
        A text that is not a valid program has only the parser's findings.
    names : collection of str
        Names in the session's namespace, such as a notebook's functions and imports.
    bridge : Bridge or str, optional
        The robot that the program is for: a bridge (which need not be open), or the name of one. By default
        the simulated robot of the world that the text names, as in ``; world: line``; without that line,
        nothing is assumed about the robot.

    Returns
    -------
    tuple of Finding
        In order of position; :data:`~lrp_jupyter.language.checks.CODES` explains their codes. An error
        certainly cannot work; a correct program has no findings.

    Raises
    ------
    BridgeError
        There is no such bridge.
    LRPError
        The text names a world outside the current folder.

    Examples
    --------
    >>> for finding in check("(machine m (state moving) (state b) (eps b -> movin)) (spawn m b)"):
    ...     print(finding)
    1:47: LRP303 error: `m` has no state `movin`. Did you mean `moving`?
    """
    robot: RobotMembers | None
    if bridge is not None:
        robot = members_of(make_bridge(bridge))
    else:
        text = text_or_program.text if isinstance(text_or_program, Program) else text_or_program
        world = programs.world_of(text, None) if isinstance(text, str) else None
        robot = members_of_world(world) if world is not None else None
    return checks.check(text_or_program, names, robot)


def members_of(bridge: Bridge) -> RobotMembers:
    """Return the members of a bridge's robot for the checks; the bridge need not be open.

    If its members are incomplete, the readings are left out because their types may change.
    """
    complete = bridge.complete or (bridge.alone and bridge.check_set_up())
    is_known = bridge.is_open or bool(bridge.nodes.table)
    if not is_known:
        bridge.add_members()
        bridge.offer_stop()
    nodes = [node for node in bridge.nodes.members() if complete or _is_of_method(bridge, node)]
    members = [member for node in nodes for member in _described(node)]
    if not is_known:
        bridge.nodes.clear()
    return RobotMembers({member.path: member for member in members}, complete and bool(members))


def _is_of_method(bridge: Bridge, node: RobotVariable | RobotMethod) -> bool:
    return isinstance(node, RobotMethod) or isinstance(bridge.nodes.table.get(node.of), RobotMethod)


def _described(node: RobotVariable | RobotMethod) -> Iterator[RobotMember]:
    member = node.describe()
    if isinstance(node, RobotMethod):
        fields = dict(_names_in(member.arguments))
        unlike = {name for name, kind in fields.items() if not kind.startswith(_NUMBERS)}
        parameters = parameters_of(member.signature, fields, unlike)
        parameters = parameters._replace(limits=node.limits, likely=node.likely, units=node.units)
        mover = node.work.mover if isinstance(node, RobotTask) else node.mover if node.velocity else None
        yield RobotMember(node.path, parameters=parameters, acts=node.command, mover=mover)
    else:
        yield RobotMember(
            member.name,
            member.type,
            accompanies=bool(node.of),
            fields=_fields_of(node.type),
            limits=node.limits,
            unit=node.unit,
        )
    if member.kind == "task":
        for field in member.fields:
            yield RobotMember(
                field.name, field.type, values=STATUSES if field.name.endswith(".status") else ()
            )


def _fields_of(kind: object) -> Fields | None:
    """Return the names in the values of a class, each with those in it; None if others are possible."""
    if not isinstance(kind, type) or "__slots__" not in vars(kind) or kind.__dictoffset__:
        return None
    hints = vars(kind).get("__annotations__", {})
    names = dict.fromkeys((*hints, *dir(kind)))
    return {name: _fields_of(hints.get(name)) for name in names if not name.startswith("_")}


def _names_in(fields: Iterable[Member], prefix: str = "") -> Iterator[tuple[str, str]]:
    """Yield the names under which the fields of a message are arguments, with the types."""
    for field in fields:
        name = prefix + field.name.rpartition(".")[2]
        yield name, _NUMBERS[0] if field.fields else field.type  # a part may have a number's short form
        yield from _names_in(field.fields, f"{name}_")


def members_of_world(world: str) -> RobotMembers | None:
    """Return the members of the robot of a simulated world.

    None if there is no such world, or no robot, or if the packages of the simulator are not installed.
    """
    return _simulated(world) if world.endswith(".json") else _bundled(world)


def _simulated(world: str) -> RobotMembers | None:
    try:
        return members_of(make_bridge("sim", world=world))
    except (BridgeError, ModuleNotFoundError):
        return None


_bundled = lru_cache(maxsize=32)(_simulated)
