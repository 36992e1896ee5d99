"""The inputs of a recording, each written as a line: a mapping that can be stored as JSON."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable
from dataclasses import MISSING, fields
from typing import Any

from lrp_jupyter.bridges.interventions import (
    CommandsHeld,
    MembersChanged,
    RobotArmed,
    RobotCommanded,
    RobotStopped,
    WorldLoaded,
)
from lrp_jupyter.errors import FileError
from lrp_jupyter.interpreter.rendering import render, short
from lrp_jupyter.language.half_typed import Unmeant
from lrp_jupyter.language.program import Element, Program
from lrp_jupyter.live.running import commands as do
from lrp_jupyter.live.running.inputs import EndRun
from lrp_jupyter.live.running.loop import Loop
from lrp_jupyter.live.running.notebook_names import ChangeNames
from lrp_jupyter.live.stored.json_values import plain, unplain
from lrp_jupyter.sim.world_edits import Become, Draw, WorldEdit
from lrp_jupyter.sim.world_inputs import PlaceRobot, PlaceSolid, ResetWorld
from lrp_jupyter.sim.worlds import load

Line = dict[str, Any]

INPUTS: dict[str, type] = {
    "pause": do.Pause,
    "resume": do.Resume,
    "rest": EndRun,
    "end": do.EndProgram,
    "edit": do.ReplaceProgram,
    "rename": do.Rename,
    "force": do.Force,
    "fire": do.Fire,
    "set": do.SetVariable,
    "assign": do.Assign,
    "names": ChangeNames,
    "rewind": do.Rewind,
    "reset": do.Reset,
    "renew": do.Renew,
    "rate": do.SetRate,
    "policy": do.SetPolicy,
    "clear issues": do.ClearIssues,
    "stop": RobotStopped,
    "arm": RobotArmed,
    "hold": CommandsHeld,
    "members": MembersChanged,
    "command": RobotCommanded,
    "world": WorldLoaded,
    "place": PlaceRobot,
    "place solid": PlaceSolid,
    "reset world": ResetWorld,
    "draw": Draw,
    "edit world": Become,
}
"""The inputs by their names in a line; :func:`_fields_of` writes those whose fields need another form."""
_NAMES = {kind: name for name, kind in INPUTS.items()}


def input_line(what: object, loop: Loop) -> Line:
    """Return the line of an input; one that cannot be stored in a file is ``beyond``."""
    name = _NAMES.get(type(what), "edit world" if isinstance(what, WorldEdit) else "beyond")
    written = None if name == "beyond" else _fields_of(what, loop)
    return {"input": "beyond", "what": render(what)} if written is None else {"input": name, **written}


def _fields_of(what: Any, loop: Loop) -> Line | None:
    """Return the fields of the line of an input; None if it cannot be written."""
    match what:
        case do.ReplaceProgram(program, unmeant):
            waits = {} if unmeant is None else {"unmeant": _unmeant_line(unmeant)}
            return {"text": program.text, **waits}
        case do.Renew(program):
            return {"text": program.text}
        case do.Assign(path, value):
            text = literal(loop.record.restored(value))
            return None if text is None else {"path": path, "value": text}
        case ChangeNames(_, after):
            values = {name: literal(loop.record.restored(value)) for name, value in after.items()}
            return {"values": values, "deleted": sorted(set(what.names) - after.keys())}
        case RobotCommanded(name, arguments):
            return {"name": name, "arguments": plain(arguments)}
        case WorldEdit() if not isinstance(what, Draw):
            world = loop.bridge.simulated
            return None if world is None else {"world": world.world_form()}
    return {field.name: getattr(what, field.name) for field in fields(what)}


def input_of(line: Line, program: Callable[[str], Program]) -> object:
    """Return the input of a line, or raise FileError; its fields are not checked before it is repeated."""
    match line["input"]:
        case "edit":
            unmeant = line.get("unmeant")
            return do.ReplaceProgram(program(line["text"]), unmeant and _unmeant_of(unmeant, program))
        case "renew":
            return do.Renew(program(line["text"]))
        case "assign":
            return do.Assign(tuple(line["path"]), ast.literal_eval(line["value"]))
        case "names":
            texts = {str(name): text for name, text in line["values"].items() if text is not None}
            after = {name: ast.literal_eval(text) for name, text in texts.items()}
            return ChangeNames({str(name): None for name in line["deleted"]}, after)
        case "command":
            return RobotCommanded(line["name"], unplain(line["arguments"]))
        case "edit world":
            return Become(load(line["world"]))
        case "beyond":
            raise FileError("This input cannot be stored in a file, so the recording cannot be replayed.")
        case str(name) if name in INPUTS:
            kind = INPUTS[name]
            given = [each.name for each in fields(kind) if each.name in line or each.default is MISSING]
            return kind(**{name: _immutable(line[name]) for name in given})
    raise FileError(f"There is no input {short(line['input'])}.")


def _immutable(value: object) -> object:
    """Return a list as the tuple that it was before it was written."""
    return tuple(_immutable(part) for part in value) if isinstance(value, list) else value


def _unmeant_line(unmeant: Unmeant) -> Line:
    element = unmeant.element
    return {
        "instead": unmeant.instead.text,
        "reason": unmeant.reason,
        "always": unmeant.always,
        "element": None if element is None else [element.kind, element.path],
    }


def _unmeant_of(line: Line, program: Callable[[str], Program]) -> Unmeant:
    element = line["element"] and Element(line["element"][0], tuple(line["element"][1]))
    return Unmeant(program(line["instead"]), line["reason"], line["always"], element)


class _Infinite(ast.NodeTransformer):
    """Turns the name `inf` into a number."""

    def visit_Name(self, node: ast.Name) -> ast.expr:
        """See `ast.NodeTransformer`."""
        return ast.Constant(math.inf) if node.id == "inf" else node


def literal(value: object) -> str | None:
    """Return a value as a Python expression; None if that is not possible."""
    try:
        text = ast.unparse(_Infinite().visit(ast.parse(repr(value), mode="eval")))
        return text if ast.literal_eval(text) == value else None
    except Exception:  # `repr` and `==` may run foreign code
        return None
