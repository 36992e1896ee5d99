"""What is drawn on a state graph, as edits of the editor's text.

The page sends its present text with the act, so the answer fits it, and applies the edits like typed ones:
as one step of its own history.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

from lrp_jupyter.errors import Edit, LRPError, LRPSyntaxError
from lrp_jupyter.language import drawing, nesting
from lrp_jupyter.language.forms import article
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Path
from lrp_jupyter.language.rename import rename_edits
from lrp_jupyter.widgets.messages import OpenProgram, PageRequest
from lrp_jupyter.widgets.places import edits_view, path_of
from lrp_jupyter.widgets.protocol import ElementKind

DrawingAct = Literal[
    "state",
    "transition",
    "form",
    "rename",
    "delete",
    "change",
    "source",
    "destination",
    "reverse",
    "start",
    "nest",
    "unnest",
]
"""What is done to an element; `to` names the other state, `form` holds what was written."""


@dataclass(frozen=True)
class DrawRequest(PageRequest, type="draw"):
    """Draw on the state graph of a text. Answered by the `edits` of that text.

    `kind` and `path` name the element acted on: for a new state and a new form the one around it (empty for
    the program), for a new transition its source (``m/*`` for every state). `old` is the source to replace.
    """

    text: str
    act: DrawingAct
    kind: ElementKind
    path: str
    to: str = ""
    form: str = ""
    old: str = ""

    def answer(self, opened: OpenProgram) -> Mapping[str, Any]:
        """Return the edits; their places are those of the text sent."""
        try:
            edits = _ACTS[self.act](self, path_of(self.kind, self.path))
        except LRPSyntaxError:
            raise LRPError(
                "The text is not a valid program at the moment, so nothing can be drawn. Correct it first."
            ) from None
        except ValueError as error:
            raise LRPError(str(error)) from None
        return {"edits": edits_view(self.text, edits)}


def _deleted(request: DrawRequest, path: Path) -> list[Edit]:
    delete = {
        "state": drawing.delete_state,
        "transition": drawing.delete_transition,
        "machine": drawing.delete_machine,
    }.get(request.kind)
    if delete is None:
        what = f"{article(request.kind).title()} {request.kind}"
        raise ValueError(f"{what} cannot be deleted in the graph. Delete it in the text.")
    return delete(request.text, path)


_ACTS: dict[str, Callable[[DrawRequest, Path], list[Edit]]] = {
    "state": lambda each, path: drawing.new_state(each.text, path, each.to),
    "transition": lambda each, path: drawing.new_transition(
        each.text, path[:-1], path[-1], each.to, each.form
    ),
    "form": lambda each, path: drawing.new_form(each.text, path, each.form),
    "rename": lambda each, path: rename_edits(parse(each.text), each.kind, path, each.to),
    "delete": _deleted,
    "change": lambda each, path: drawing.change_transition(each.text, path, each.form),
    "source": lambda each, path: drawing.retarget(each.text, path, "source", each.to, each.old),
    "destination": lambda each, path: drawing.retarget(each.text, path, "destination", each.to),
    "reverse": lambda each, path: drawing.reverse(each.text, path),
    "start": lambda each, path: drawing.start_in(each.text, path),
    "nest": lambda each, path: nesting.nest(each.text, path, each.to),
    "unnest": lambda each, path: nesting.unnest(each.text, path),
}
