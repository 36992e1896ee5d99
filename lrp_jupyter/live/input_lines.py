"""The inputs of a recording, each as a line of it: a mapping that JSON can hold."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable
from typing import Any

from lrp_jupyter.bridges.outside import CommandsHeld, RobotArmed, RobotCommanded, RobotStopped, WorldLoaded
from lrp_jupyter.errors import FileError
from lrp_jupyter.interpreter.rendering import render, short
from lrp_jupyter.language.program import Element, Program
from lrp_jupyter.language.unmeant import Unmeant
from lrp_jupyter.live import commands as do
from lrp_jupyter.live.inputs import Paused, Resumed, RunEnded
from lrp_jupyter.live.loop import Loop
from lrp_jupyter.live.names import ChangeNames
from lrp_jupyter.live.plain import plain, unplain
from lrp_jupyter.sim.edits import Become, Draw, WorldEdit
from lrp_jupyter.sim.inputs import PlaceRobot, PlaceSolid, ResetWorld
from lrp_jupyter.sim.worlds import load

Line = dict[str, Any]


def input_line(what: object, loop: Loop) -> Line:
    """Return the line of an input."""
    match what:
        case Paused(reason):
            return {"input": "pause", "reason": reason}
        case Resumed():
            return {"input": "resume"}
        case RunEnded():
            return {"input": "rest"}
        case do.ReplaceProgram(program, unmeant):
            return {
                "input": "edit",
                "text": program.text,
                **({} if unmeant is None else {"unmeant": _unmeant(unmeant)}),
            }
        case do.Rename(kind, path, new_name):
            return {"input": "rename", "kind": kind, "path": path, "name": new_name}
        case do.Force(path, teleport):
            return {"input": "force", "path": path, "teleport": teleport}
        case do.Fire(path):
            return {"input": "fire", "path": path}
        case do.SetVariable(path, expression):
            return {"input": "set", "path": path, "expression": expression}
        case do.Assign(path, value) if (text := literal(value)) is not None:
            return {"input": "assign", "path": path, "value": text}
        case ChangeNames(_, after):
            values = {name: literal(value) for name, value in after.items()}
            return {"input": "names", "values": values, "deleted": sorted(set(what.names) - after.keys())}
        case do.Rewind(ticks):
            return {"input": "rewind", "ticks": ticks}
        case do.Reset():
            return {"input": "reset"}
        case do.Renew(program):
            return {"input": "renew", "text": program.text}
        case do.SetRate(rate):
            return {"input": "rate", "rate": rate}
        case do.SetPolicy(name, value):
            return {"input": "policy", "name": name, "value": value}
        case RobotStopped():
            return {"input": "stop"}
        case RobotArmed(armed):
            return {"input": "arm", "armed": armed}
        case CommandsHeld(sent, blind, lost):
            why = {"blind": blind, "lost": lost}
            return {"input": "hold", "sent": sent} | {name: text for name, text in why.items() if text}
        case RobotCommanded(name, arguments):
            return {"input": "command", "name": name, "arguments": plain(arguments)}
        case WorldLoaded(world):
            return {"input": "world", "world": world}
        case PlaceRobot(pose, robot):
            return {"input": "place", "pose": pose, "robot": robot}
        case PlaceSolid(pose, solid):
            return {"input": "place solid", "pose": pose, "solid": solid}
        case ResetWorld():
            return {"input": "reset world"}
        case Draw(path, width, grey):
            return {"input": "draw", "path": path, "width": width, "grey": grey}
        case WorldEdit() if (simulated := loop.bridge.simulated) is not None:
            return {"input": "edit world", "world": simulated.world_form()}
    return {"input": "beyond", "what": render(what)}


def input_of(line: Line, program: Callable[[str], Program]) -> object:
    """Return the input of a line.

    `program`: returns the program of a text.
    Raises FileError: there is no such input.
    """
    match line["input"]:
        case "pause":
            return Paused(line["reason"])
        case "resume":
            return Resumed()
        case "rest":
            return RunEnded()
        case "edit":
            found = line.get("unmeant")
            unmeant = found and Unmeant(
                program(found["instead"]),
                found["reason"],
                found["always"],
                found["element"] and Element(found["element"][0], tuple(found["element"][1])),
            )
            return do.ReplaceProgram(program(line["text"]), unmeant)
        case "rename":
            return do.Rename(line["kind"], tuple(line["path"]), line["name"])
        case "force":
            return do.Force(tuple(line["path"]), line["teleport"])
        case "fire":
            return do.Fire(tuple(line["path"]))
        case "set":
            return do.SetVariable(tuple(line["path"]), line["expression"])
        case "assign":
            return do.Assign(tuple(line["path"]), ast.literal_eval(line["value"]))
        case "names":
            texts = {str(name): text for name, text in line["values"].items() if text is not None}
            after = {name: ast.literal_eval(text) for name, text in texts.items()}
            return ChangeNames({str(name): None for name in line["deleted"]}, after)
        case "rewind":
            return do.Rewind(line["ticks"])
        case "reset":
            return do.Reset()
        case "renew":
            return do.Renew(program(line["text"]))
        case "rate":
            return do.SetRate(line["rate"])
        case "policy":
            return do.SetPolicy(line["name"], line["value"])
        case "stop":
            return RobotStopped()
        case "arm":
            return RobotArmed(bool(line["armed"]))
        case "hold":
            return CommandsHeld(int(line["sent"]), str(line.get("blind", "")), str(line.get("lost", "")))
        case "command":
            return RobotCommanded(line["name"], unplain(line["arguments"]))
        case "world":
            return WorldLoaded(line["world"])
        case "place":
            x, y, angle = line["pose"]
            return PlaceRobot((x, y, angle), line["robot"])
        case "place solid":
            x, y, angle = line["pose"]
            return PlaceSolid((x, y, angle), line["solid"])
        case "reset world":
            return ResetWorld()
        case "draw":
            return Draw(tuple((x, y) for x, y in line["path"]), line["width"], line["grey"])
        case "edit world":
            return Become(load(line["world"]))
        case "beyond":
            raise FileError("This input cannot be stored in a file, so the recording cannot be replayed.")
    raise FileError(f"There is no input {short(line['input'])}.")


def _unmeant(unmeant: Unmeant) -> Line:
    element = unmeant.element
    return {
        "instead": unmeant.instead.text,
        "reason": unmeant.reason,
        "always": unmeant.always,
        "element": None if element is None else [element.kind, element.path],
    }


class _Infinite(ast.NodeTransformer):
    """Turns the name `inf` into a number."""

    def visit_Name(self, node: ast.Name) -> ast.expr:
        """See `ast.NodeTransformer`."""
        return ast.Constant(math.inf) if node.id == "inf" else node


def literal(value: object) -> str | None:
    """Return a value as an expression of Python; None where that is not possible."""
    try:
        text = ast.unparse(_Infinite().visit(ast.parse(repr(value), mode="eval")))
        return text if ast.literal_eval(text) == value else None
    except Exception:  # `repr` and `==` may run code of anyone
        return None
