"""The world on its way to a view: its description when it changes, poses and new ink in between."""

from __future__ import annotations

from typing import Any

from lrp_jupyter.bridges.sim import SimBridge, SimPicture
from lrp_jupyter.live.session import Session
from lrp_jupyter.widgets.scene import poses, strokes_of, world_view
from lrp_jupyter.widgets.view import View

__all__ = ["scene_of", "send_world"]

_POSES, _WORLD = 0.040, 0.1  # s between two of a kind, at least


def scene_of(session: Session) -> object:
    """Give what tells whether the world is to be drawn anew; None where there is no world."""
    bridge = session.bridge
    if not isinstance(bridge, SimBridge):
        return None
    return id(bridge.simulation), getattr(session.frame.robot, "revision", 0)


def send_world(view: View, session: Session, now: float) -> None:
    """Send a view what of the world it does not know yet, if it shows one and may be sent something."""
    if not view.shows_world:
        return
    bridge, picture, scene = session.bridge, session.frame.robot, scene_of(session)
    if scene != view.scene:
        if now - view.drawn < _WORLD:
            return
        view.scene, view.drawn = scene, now
        view.forget_world()
        view.send({"type": "world", "world": world_view(bridge, picture)})
    if not isinstance(bridge, SimBridge) or not isinstance(picture, SimPicture):
        return
    if picture == view.picture or now - view.posed < _POSES or not view.may(now):
        return
    view.picture, view.posed = picture, now
    message: dict[str, Any] = {"type": "poses", "frame": view.number()}
    if picture.marks != view.marks:
        strokes = strokes_of(bridge.simulation.floor.marks[view.marks : picture.marks])
        message["ink"] = {"first": view.strokes, "strokes": strokes}
        view.marks, view.strokes = picture.marks, view.strokes + len(strokes)
    view.send(message, [poses(bridge, picture)])
