"""The world on its way to a view: its description when it changes, poses and new ink in between."""

from __future__ import annotations

from typing import Any

from lrp_jupyter.bridges.sim import SimBridge, SimPicture
from lrp_jupyter.live.session import Session
from lrp_jupyter.widgets.scene import poses, strokes_of, world_view
from lrp_jupyter.widgets.view import View

__all__ = ["has_moved", "movement", "scene_of", "send_world"]

_WORLD = 0.1  # s between two descriptions, at least


def scene_of(session: Session) -> object:
    """Give what tells whether the world is to be drawn anew; None where there is no world."""
    bridge = session.bridge
    if not isinstance(bridge, SimBridge):
        return None
    return id(bridge.simulation), getattr(session.frame.robot, "revision", 0)


def send_world(view: View, session: Session, now: float) -> None:
    """Send a view the description of the world, if it shows one and knows another."""
    scene = scene_of(session)
    if not view.shows_world or not view.has_credit or scene == view.scene or now - view.drawn < _WORLD:
        return
    view.scene, view.drawn = scene, now
    view.forget_world()
    view.send({"type": "world", "world": world_view(session.bridge, session.frame.robot)})


def has_moved(view: View, session: Session) -> bool:
    """Whether something moved in the world that the view shows, since it was told last."""
    picture = session.frame.robot
    return view.shows_world and isinstance(picture, SimPicture) and picture != view.picture


def movement(view: View, session: Session) -> tuple[dict[str, Any], list[bytes]]:
    """Give what a frame tells of the world: the field of new ink, and the buffer of the poses."""
    bridge, picture = session.bridge, session.frame.robot
    assert isinstance(bridge, SimBridge)
    assert isinstance(picture, SimPicture)
    view.picture = picture
    if picture.marks == view.marks:
        return {}, [poses(bridge, picture)]
    strokes = strokes_of(bridge.simulation.floor.marks[view.marks : picture.marks])
    ink = {"first": view.strokes, "strokes": strokes}
    view.marks, view.strokes = picture.marks, view.strokes + len(strokes)
    return {"ink": ink}, [poses(bridge, picture)]
