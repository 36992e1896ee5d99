"""Messages from a page: their types, and the decoder that checks what arrives against them.

A message is a frozen dataclass, registered under its ``type``; a request is a function, registered under its
name: an act (a command of the user) or a question. :func:`decode_message` checks every message against their
annotations. The page's TypeScript types are generated from the same definitions.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from concurrent.futures import Future
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, ClassVar, Literal, Protocol, TypeVar

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.live.session import Session
from lrp_jupyter.widgets.text.saver import Saver
from lrp_jupyter.widgets.text.texts import Texts
from lrp_jupyter.widgets.views.goal import Goal
from lrp_jupyter.widgets.views.layouts import Layouts
from lrp_jupyter.widgets.views.shown_moment import Looking
from lrp_jupyter.widgets.views.shown_runs import ShownRuns
from lrp_jupyter.widgets.views.shown_search import ShownSearch
from lrp_jupyter.widgets.wire.changes import Sections
from lrp_jupyter.widgets.wire.codec import DecodeError, Fields, decode, fields_of
from lrp_jupyter.widgets.wire.protocol import ElementKind, ViewState

PartName = Literal["lab", "goal", "controls", "editor", "tree", "graph", "variables", "issues", "world"]
Looked = Literal["why", "hover", "inspect", "explain", "panel", "redraw", "page"]


class OpenProgram(Protocol):
    """The interface for commands and requests: a session with its texts, layouts and views."""

    texts: Texts
    saver: Saver
    layouts: Layouts
    looking: Looking
    runs: ShownRuns
    search: ShownSearch

    @property
    def session(self) -> Session:
        """The session that the views show."""

    @property
    def goal(self) -> Goal | None:
        """The challenge that the program is written for."""

    def view_state(self) -> ViewState:
        """Return everything that a view may show now."""

    def work(self, job: Callable[[], Any]) -> Future[Any]:
        """Queue a job that may have to wait, for the worker's thread."""

    def change_bridge(self, bridge: str | Bridge, **options: Any) -> None:
        """Continue with another bridge."""

    def load(self, name: str, text: str) -> None:
        """Continue with another program under its name."""


@dataclass(frozen=True)
class PageMessage:
    """Base class of the messages of a page. `view` is the sending view's own name."""

    view: str
    frame: int = field(default=0, kw_only=True)
    """The newest frame that has arrived, acknowledged with all before it. 0: none since the last message."""

    types: ClassVar[dict[str, type[PageMessage]]] = {}

    def __init_subclass__(cls, **tag: str) -> None:
        PageMessage.types[tag["type"]] = cls


@dataclass(frozen=True)
class HelloMessage(PageMessage, type="hello"):
    """A view opens, shows this part, and needs a snapshot. Sent again after a lost connection.

    In that case the view knows a `revision` of a `document`, and has sent texts up to the number `seq`: the
    kernel ignores any that have not arrived yet, and the view sends their contents again.
    """

    part: PartName
    document: str = ""
    revision: int = 0
    seq: int = 0


@dataclass(frozen=True)
class ByeMessage(PageMessage, type="bye"):
    """A view closes; best effort, so a view that sends no credit for a long time also counts as closed."""


@dataclass(frozen=True)
class TextMessage(PageMessage, type="text"):
    """What was typed: changes, one after the other, to the text of the revision `base`."""

    seq: int  # a view sends the next one when this one is answered
    base: int
    updates: list[Sections]
    selection: tuple[int, int] | None = None  # where its anchor and head are then, in UTF-16 units
    meant: bool = True  # the word at the head is finished, not still being typed
    rename: tuple[ElementKind, str, str] | None = None  # kind and path of what these changes rename, and how
    cursors: list[int] = field(default_factory=list)  # the heads of its other selections


@dataclass(frozen=True)
class CursorMessage(PageMessage, type="cursor"):
    """The cursor moved, the editor was left, or the word at the cursor is finished. Not answered."""

    seq: int  # of the last text of the view
    revision: int  # that the selection refers to
    selection: tuple[int, int] | None
    meant: bool
    cursors: list[int] = field(default_factory=list)


@dataclass(frozen=True)
class LookedMessage(PageMessage, type="looked"):
    """A person begins, or ends, to look at something; sent only while that is recorded. Not answered."""

    what: Looked
    about: str  # the element, the panel; empty: the page itself, which may be in the background
    on: bool


@dataclass(frozen=True)
class CreditMessage(PageMessage, type="credit"):
    """Frames have arrived, and there is nothing else to say."""


# -- requests of a page ----------------------------------------------------------------------------


@dataclass(frozen=True)
class Handler:
    """A function that carries out a request of a page; its parameters are the fields of the message.

    It runs on the thread that delivers messages, and returns a future if the session or the worker does it
    later; an exception, raised or in the future, is the error of the reply.
    """

    name: str
    function: Callable[..., Any]
    patience: float  # wall seconds after which an unanswered message is answered with the reason
    answer: str = ""
    """The field of the reply with the result of a question, which may wait, on the worker's thread."""
    is_present: bool = False
    """Whether it changes the run or the world as it is now: views that show the past return from it first."""
    changes_world: bool = False
    """Whether a page shows its effect before the world is described; the reply follows the description."""
    is_noted: bool = True  # in the recording of a person's actions
    only_looks: bool = False
    """Whether it changes neither program, robot nor file, and runs no text that the page has sent."""

    @cached_property
    def fields(self) -> Fields:
        """The fields of its message."""
        _, *own = fields_of(self.function).items()
        return dict(own)


Function = TypeVar("Function", bound=Callable[..., Any])
ACTS: dict[str, Handler] = {}
QUESTIONS: dict[str, Handler] = {}


def act(patience: float = 1.0, **flags: bool) -> Callable[[Function], Function]:
    """Return the decorator of what a page can do; for the `flags` see `Handler`."""

    def register(function: Function) -> Function:
        name = function.__name__
        ACTS[name] = Handler(name, function, patience, "", **flags)
        return function

    return register


def question(answer: str, patience: float = 1.0, only_looks: bool = True) -> Callable[[Function], Function]:
    """Return the decorator of what answers a question of a page; see `Handler`."""

    def register(function: Function) -> Function:
        name = function.__name__.rstrip("_")  # which would differ from its name in Python
        QUESTIONS[name] = Handler(name, function, patience, answer, is_noted=False, only_looks=only_looks)
        return function

    return register


@dataclass(frozen=True)
class AskedMessage(PageMessage, type="command"):
    """An act or a question, with its fields; with `id` 0 no reply is sent."""

    id: int
    handler: Handler
    given: Mapping[str, Any]


_ENVELOPE: Fields = {**fields_of(PageMessage), "id": (int, True)}


def decode_message(content: object) -> PageMessage:
    """Check a JSON value against the types of messages, or raise a DecodeError."""
    if not isinstance(content, dict):
        raise DecodeError("A message must be an object.")
    name = content.get("type")
    kind = _known("message", {**PageMessage.types, **QUESTIONS}, name)
    if kind is AskedMessage:
        name = content.get("do")
        kind = _known("act", ACTS, name)
    if isinstance(kind, Handler):
        envelope = decode(_ENVELOPE, kind.name, content)
        return AskedMessage(handler=kind, given=decode(kind.fields, kind.name, content), **envelope)
    message: PageMessage = kind(**decode(fields_of(kind), str(name), content))
    return message


def _known(noun: str, known: Mapping[str, Any], name: object) -> Any:
    if not isinstance(name, str) or name not in known:
        raise DecodeError(f"There is no {noun} `{str(name)[:40]}`.")
    return known[name]
