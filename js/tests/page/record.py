"""Record what a kernel would send while the follower drives, for the page that shows the lab without one.

``python js/tests/page/record.py [PROGRAM OUT]`` writes ``recording.json`` beside itself: a snapshot,
then frames and poses at 10 Hz, made by a real session in virtual time.
"""

from __future__ import annotations

import base64
import json
import sys
from importlib.resources import files
from pathlib import Path
from typing import Any

from lrp_jupyter.graph.layout import layout
from lrp_jupyter.language.program import Program, path_text
from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.session import Session
from lrp_jupyter.widgets.protocol import ProgramView, pack_poses

HERE = Path(__file__).parent
TICKS = 300
SKIP = 20


def program_view(program: Program) -> ProgramView:
    """Describe a program as the page wants it."""
    machines: list[Any] = []
    for path, machine in program.walk():
        where = path_text(path)
        machines.append(
            {
                "path": where,
                "parent": path_text(path[:-1]) or None,
                "states": [
                    {
                        "path": f"{where}/{state.name}",
                        "machines": [f"{where}/{state.name}/{m.name}" for m in state.machines],
                    }
                    for state in machine.states
                ],
                "transitions": [
                    {
                        "id": f"{where}:{label}",
                        "kind": transition.kind,
                        "trigger": transition.trigger_text,
                        "source": transition.source_text,
                        "destination": str(transition.destination),
                    }
                    for label, transition in zip(machine.labels, machine.transitions, strict=True)
                ],
                "variables": [f"{where}/{v.name}" for v in machine.variables],
                "events": [f"{where}/{e.name}" for e in machine.events],
            }
        )
    return {
        "variables": [str(v.name) for v in program.variables],
        "events": [str(e.name) for e in program.events],
        "machines": machines,
    }


def changed(new: dict[Any, Any], old: dict[Any, Any]) -> dict[Any, Any]:
    """Tell what is new or different, None for what is gone."""
    return {key: new.get(key) for key in {**old, **new} if new.get(key) != old.get(key)}


def main(program_file: Path | None = None, out_file: Path = HERE / "recording.json") -> None:
    """Write the recording."""
    source = program_file or files("lrp_jupyter") / "programs" / "follower.lrp"
    text = source.read_text(encoding="utf-8")
    session = Session(text, bridge="sim", clock=VirtualClock(), world="line")
    frames: list[Any] = []
    program = session.program
    last: dict[str, dict[Any, Any]] = {"variables": {}, "visits": {}, "fired": {}, "members": {}}
    for number in range(1, TICKS + 1):
        session.run(seconds=0.1)
        frame = session.frame
        fired = {
            f"{path_text(path[:-1])}:{path[-1]}": {"count": count, "tick": frame.fired_at[path]}
            for path, count in frame.fired.items()
        }
        visits = {
            path_text(path): {"count": count, "tick": frame.tick} for path, count in frame.visits.items()
        }
        variables = {
            path_text(path): {"text": value, "number": frame.numbers.get(path)}
            for path, value in frame.variables.items()
        }
        members = {
            member.name: str(member.value)
            for member in session.bridge.members()
            if member.kind == "variable" and member.value is not None
        }
        lit = [path_text(path[:end]) for path in frame.active for end in range(2, len(path) + 1, 2)]
        message = {
            "type": "frame",
            "frame": number,
            "status": "running",
            "tick": frame.tick,
            "time": round(frame.time, 3),
            "rate": {"wanted": 10, "achieved": 10},
            "speed": {"wanted": 1, "achieved": 1},
            "revision": 1,
            "active": [path_text(path) for path in frame.active],
            "lit": lit,
            "entered": {
                k: v for k, v in visits.items() if last["visits"].get(k, {}).get("count") != v["count"]
            },
            "fired": changed(fired, last["fired"]),
            "variables": changed(variables, last["variables"]),
            "members": changed(members, last["members"]),
        }
        last = {"variables": variables, "visits": visits, "fired": fired, "members": members}
        robots = [
            (*r.pose, bool(r.bumper), r.pen, r.command[0], [float(v) for v in r.lights], list(r.distances))
            for r in frame.robot.robots
        ]
        world = session.bridge.world
        pushed = [
            pose
            for pose, solid in zip(frame.robot.solids, world.solids, strict=True)
            if solid.push is not None
        ]
        buffer = pack_poses(frame.robot.time, robots, pushed)
        if number > SKIP or number == 1:
            frames.append({"frame": message, "poses": base64.b64encode(buffer).decode()})
    layouts = {
        path_text(path): layout(machine, program=program, path=path) for path, machine in program.walk()
    }
    snapshot = {
        "type": "snapshot",
        "name": "follower",
        "text": text,
        "revision": 1,
        "running": text,
        "findings": [],
        "program": program_view(program),
        "layouts": layouts,
        "pending": None,
        "choices": {
            "bridges": ["sim", "none", "ros", "ev3"],
            "worlds": ["empty", "line", "oval", "maze", "arena", "boxes", "walls"],
            "programs": ["template", "follower", "wall-follower", "stopwatch"],
        },
        "world": session.bridge.world.to_dict(),
        "frame": {
            **frames[0]["frame"],
            "bridge": {
                "name": "sim",
                "status": "connected",
                "sentence": "the simulated world `line`",
                "hardware": False,
                "armed": True,
                "members": [
                    {
                        "name": m.name,
                        "kind": m.kind,
                        "type": m.type,
                        "unit": m.unit,
                        "doc": m.doc,
                        "insert": f"robot.{m.name}" + ("()" if m.kind == "method" else ""),
                    }
                    for m in session.bridge.members()
                ],
            },
            "settings": {"hold": False, "on_active_edit": "restart", "pause_on_issue": False},
        },
    }
    session.close()
    out = {"snapshot": snapshot, "frames": frames[1:]}
    out_file.write_text(json.dumps(out, separators=(",", ":"), allow_nan=False), encoding="utf-8")


main(*map(Path, sys.argv[1:]))
