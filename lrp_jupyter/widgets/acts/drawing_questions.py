"""Drawing on a state graph, as edits of the editor's text.

The page sends its present text with the act, so that the answer fits it, and applies the edits like typed
ones, as one step of its history.
"""

from __future__ import annotations

from typing import Literal

from lrp_jupyter.errors import Edit, LRPError, LRPSyntaxError
from lrp_jupyter.language.edits import drawing, nesting
from lrp_jupyter.language.edits.rename import rename_edits
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Path
from lrp_jupyter.language.reading.forms import article
from lrp_jupyter.widgets.acts.messages import OpenProgram, question
from lrp_jupyter.widgets.wire.page_places import edits_view, path_of
from lrp_jupyter.widgets.wire.protocol import ElementKind, TextEdit

DrawingAct = Literal[
    "state",
    "transition",
    "form",
    "rename",
    "delete",
    "change",
    "trigger",
    "hold",
    "effect",
    "setting",
    "source",
    "destination",
    "reverse",
    "start",
    "nest",
    "unnest",
]
"""The changes that can be made to an element; `to` names the other state, `form` holds what was written."""


@question("edits")
def draw(
    opened: OpenProgram,
    text: str,
    act: DrawingAct,
    kind: ElementKind,
    path: str,
    to: str = "",
    form: str = "",
    old: str = "",
) -> list[TextEdit]:
    """Draw on the state graph of a text: return the edits of that text.

    `kind` and `path` name the element acted on: for a new state and a new form the one around it (empty for
    the program), for a new transition its source (``m/*`` for every state), for a setting the state that
    spawns the machine `to`. `old` is the source to replace, or the variable that is set.
    """
    try:
        edits = _drawn(text, act, kind, path_of(kind, path), to, form, old)
    except LRPSyntaxError:
        raise LRPError(
            "The text is not a valid program at the moment, so nothing can be drawn. Correct it first."
        ) from None
    except ValueError as error:
        raise LRPError(str(error)) from None
    return edits_view(text, edits)


def _drawn(
    text: str, act: DrawingAct, kind: ElementKind, path: Path, to: str, form: str, old: str
) -> list[Edit]:
    match act:
        case "state":
            return drawing.new_state(text, path, to)
        case "transition":
            return drawing.new_transition(text, path[:-1], path[-1], to, form)
        case "form":
            return drawing.new_form(text, path, form)
        case "rename":
            return rename_edits(parse(text), kind, path, to)
        case "delete":
            return _deleted(text, kind, path)
        case "change":
            return drawing.change_transition(text, path, form)
        case "trigger":
            return drawing.set_trigger(text, path, form)
        case "hold":
            return drawing.set_hold(text, path, form)
        case "effect":
            return drawing.set_effect(text, path, form)
        case "setting":
            return drawing.set_setting(text, path, to, old, form)
        case "source":
            return drawing.retarget(text, path, "source", to, old)
        case "destination":
            return drawing.retarget(text, path, "destination", to)
        case "reverse":
            return drawing.reverse(text, path)
        case "start":
            return drawing.start_in(text, path)
        case "nest":
            return nesting.nest(text, path, to)
        case "unnest":
            return nesting.unnest(text, path)


def _deleted(text: str, kind: ElementKind, path: Path) -> list[Edit]:
    delete = {
        "state": drawing.delete_state,
        "transition": drawing.delete_transition,
        "machine": drawing.delete_machine,
    }.get(kind)
    if delete is None:
        what = f"{article(kind).title()} {kind}"
        raise ValueError(f"{what} cannot be deleted in the graph. Delete it in the text.")
    return delete(text, path)
