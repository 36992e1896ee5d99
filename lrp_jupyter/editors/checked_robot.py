"""The robot that a text is checked for: of the world that its heading names, else of its challenge."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import Any

from lrp_jupyter import programs
from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.discovery import make_bridge
from lrp_jupyter.errors import LRPError
from lrp_jupyter.language.robot_members import RobotMembers
from lrp_jupyter.live.running.checking import DEFAULT_WORLD, members_of, members_of_world


def members_for(text: str, folder: Path | None) -> RobotMembers | None:
    """Return the members of the robot with which `lrp run` runs a text of a folder, if they are known.

    Raises LRPError: the heading names a file outside the folder.
    """
    world = _world_of(text, folder)
    return members_of_world(world) if isinstance(world, str) else members_of(make_bridge("sim", world=world))


def bridge_for(text: str, folder: Path | None) -> Bridge | None:
    """Return that robot, which is not opened, with all members; None if there is none."""
    with suppress(LRPError, ModuleNotFoundError):
        return described(make_bridge("sim", world=_world_of(text, folder)))
    return None


def described(bridge: Bridge) -> Bridge:
    """Return a bridge with the members that it has without a connection."""
    bridge.add_members()
    bridge.offer_stop()
    return bridge


def _world_of(text: str, folder: Path | None) -> Any:
    world = programs.world_of(text, folder)
    named = programs.heading(text).challenge
    if world is None and named is not None:
        with suppress(LRPError, ModuleNotFoundError):  # a challenge of a file that is not run; no simulator
            from lrp_jupyter.grading.challenges import challenge

            found = challenge(named).worlds[0]
            make_bridge("sim", world=found)
            return found
    return world or DEFAULT_WORLD
