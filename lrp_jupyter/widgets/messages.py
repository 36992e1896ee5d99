"""Messages from a page: their types, and the decoder that checks what arrives against them.

A message is a frozen dataclass, registered under its ``type`` (a command under its ``do``). Whatever
arrives is decoded by :func:`decode`, field by field, from the annotations alone: no handler has to
expect a field that is missing, a text where a number belongs, or a number that JSON should not have. The
page's TypeScript types are generated from the same classes.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from dataclasses import MISSING, dataclass, field, fields
from functools import cache
from types import NoneType, UnionType
from typing import Annotated, Any, ClassVar, Literal, Protocol, get_args, get_origin, get_type_hints

from lrp_jupyter.errors import LRPError
from lrp_jupyter.live.session import Session
from lrp_jupyter.widgets.changes import Sections
from lrp_jupyter.widgets.conditions import Study
from lrp_jupyter.widgets.goal import Goal
from lrp_jupyter.widgets.layouts import Layouts
from lrp_jupyter.widgets.looking import Looking
from lrp_jupyter.widgets.protocol import ElementKind, Looked, PartName, ViewState
from lrp_jupyter.widgets.saver import Saver
from lrp_jupyter.widgets.texts import Texts


class MessageError(LRPError):
    """A message of a page does not match its type."""


class OpenProgram(Protocol):
    """The interface for commands and requests: a session with its texts, layouts and views."""

    texts: Texts
    saver: Saver
    layouts: Layouts
    looking: Looking
    study: Study

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

    def change_bridge(self, bridge: str, **options: Any) -> None:
        """Continue with another bridge."""

    def load(self, name: str, text: str) -> None:
        """Continue with another program under its name."""

    def wake(self) -> None:
        """Update the views at once."""


@dataclass(frozen=True)
class PageMessage:
    """Base class of the messages of a page. `view` is the sending view's own name.

    `frame`: the number of the newest frame that has arrived; it acknowledges that and all before it. 0: none
    since the last message.
    """

    view: str
    frame: int = field(default=0, kw_only=True)

    types: ClassVar[dict[str, type[PageMessage]]] = {}
    acts: ClassVar[dict[str, type[PageMessage]]] = {}
    named: ClassVar[str] = ""

    def __init_subclass__(cls, **tag: str) -> None:
        for kind, name in tag.items():
            cls.named = name
            (PageMessage.acts if kind == "do" else PageMessage.types)[name] = cls


@dataclass(frozen=True)
class HelloMessage(PageMessage, type="hello"):
    """A view opens, shows this part, and needs a snapshot. Sent again after a lost connection.

    Then the view knows a `revision` of a `document`, and has sent texts up to the number `seq`: the kernel
    ignores those that it has not got by now, and the view sends what they contained again.
    """

    part: PartName
    document: str = ""
    revision: int = 0
    seq: int = 0


@dataclass(frozen=True)
class ByeMessage(PageMessage, type="bye"):
    """A view closes; best effort, so a view without credit for long counts as gone too."""


@dataclass(frozen=True)
class TextMessage(PageMessage, type="text"):
    """What was typed: changes, one after the other, to the text of the revision `base`.

    `seq` is its number; a view sends the next one when this one is answered. `selection` is where its anchor
    and head are then, in UTF-16 units. Unless it is `meant`, the word at the head is still being typed.
    `rename`: the changes are the rename of an element of this kind and path.
    """

    seq: int
    base: int
    updates: list[Sections]
    selection: tuple[int, int] | None = None
    meant: bool = True
    rename: tuple[ElementKind, str, str] | None = None


@dataclass(frozen=True)
class CursorMessage(PageMessage, type="cursor"):
    """The cursor moved, the editor was left, or the word at the cursor is meant by now. Not answered.

    `seq` is the number of the last text of the view, and `revision` what `selection` refers to.
    """

    seq: int
    revision: int
    selection: tuple[int, int] | None
    meant: bool


@dataclass(frozen=True)
class LookedMessage(PageMessage, type="looked"):
    """A person begins, or ends, to look at something; sent only while that is recorded. Not answered.

    `about`: the element, the panel; empty: the page itself, which may be in the background.
    """

    what: Looked
    about: str
    on: bool


@dataclass(frozen=True)
class CreditMessage(PageMessage, type="credit"):
    """Frames have arrived, and there is nothing else to say."""


@dataclass(frozen=True)
class PageRequest(PageMessage, ABC):
    """A question; `id` is that of the reply."""

    id: int

    patience: ClassVar[float] = 1.0
    """Wall seconds after which a question that is not answered yet is answered with the reason."""

    @abstractmethod
    def answer(self, opened: OpenProgram) -> Mapping[str, Any]:
        """Return the fields of the reply. Runs on the worker's thread and may wait."""


@dataclass(frozen=True)
class PageCommand(PageMessage, ABC, type="command"):
    """A command of the user; with `id` 0 no reply is sent."""

    id: int

    patience: ClassVar[float] = 1.0
    """Wall seconds after which a command that is not applied yet is answered with the reason."""

    is_present: ClassVar[bool] = False
    """Whether it changes the run or the world as it is now: views that show the past return from it first."""

    changes_world: ClassVar[bool] = False
    """Whether a page shows what it does until the world is described; the reply follows the description."""

    is_automatic: ClassVar[bool] = False
    """Whether the page sends it by itself."""

    @property
    def look(self) -> tuple[str, str]:
        """What the recording of what a person does says about it: a kind and a subject."""
        return "command", self.named

    @abstractmethod
    def apply(self, opened: OpenProgram) -> Future[Any] | None:
        """Apply the command, on the thread that delivers messages.

        A future if the session or the worker applies it later, None if it is done. An exception, raised here
            or by the future, is the error of the reply.
        """


# -- decoding ----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Between:
    """The bounds of a number, both included."""

    low: float
    high: float


_COUNT = Between(0, 2**53)  # an int counts something; JavaScript cannot count further
_NUMBER = Between(-1e6, 1e6)
_LONGEST = 10_000  # items of a list


def decode(content: object) -> PageMessage:
    """Check a JSON value against the types of messages.

    Raises MessageError: it is not a message, lacks a field, or a field has a wrong value; the message names
        it.
    """
    if not isinstance(content, dict):
        raise MessageError("A message must be an object.")
    kind: Any = _kind(PageMessage.types, "type", "message", content)
    if kind is PageCommand:
        kind = _kind(PageMessage.acts, "do", "act", content)
    values = {}
    for name, (hint, required) in _hints(kind).items():
        if name in content:
            values[name] = _checked(hint, content[name], f"`{name}` of `{kind.named}`")
        elif required:
            raise MessageError(f"`{kind.named}` needs `{name}`.")
    message: PageMessage = kind(**values)
    return message


def _kind(
    known: Mapping[str, type[PageMessage]], field: str, noun: str, content: Mapping[str, object]
) -> type[PageMessage]:
    name = content.get(field)
    found = known.get(name) if isinstance(name, str) else None
    if found is None:
        raise MessageError(f"There is no {noun} `{str(name)[:40]}`.")
    return found


@cache
def _hints(kind: Any) -> dict[str, tuple[Any, bool]]:
    """Return the type of each field, and whether it is required."""
    hints = get_type_hints(kind, include_extras=True)
    return {
        field.name: (hints[field.name], field.default is MISSING and field.default_factory is MISSING)
        for field in fields(kind)
    }


def _checked(hint: Any, value: object, where: str) -> Any:
    """Return the value if it has the type, else raise."""
    origin, arguments = get_origin(hint), get_args(hint)
    if origin is Annotated:
        return _number(arguments[0], arguments[1], value, where)
    if origin is Literal:
        if value in arguments:
            return value
        words = " or ".join(f"`{word}`" for word in arguments)
        raise MessageError(f"{where} must be {words}, not {_shown(value)}.")
    if origin is UnionType and NoneType in arguments:
        return None if value is None else _checked(arguments[0], value, where)
    if origin is UnionType:
        first, second = arguments
        return _checked(second if isinstance(value, get_origin(second) or second) else first, value, where)
    if hint in (int, float):
        return _number(hint, _COUNT if hint is int else _NUMBER, value, where)
    if origin is list and isinstance(value, list) and len(value) <= _LONGEST:
        return [_checked(arguments[0], item, f"An item in {where}") for item in value]
    if origin is tuple and isinstance(value, (list, tuple)) and len(value) == len(arguments):
        return tuple(
            _checked(part, item, f"An item in {where}") for part, item in zip(arguments, value, strict=True)
        )
    if origin is dict and isinstance(value, dict) and all(isinstance(key, str) for key in value):
        return {key: _checked(arguments[1], item, f"An item in {where}") for key, item in value.items()}
    if hint in (str, bool) and isinstance(value, hint):
        return value
    raise MessageError(f"{where} must be {_WORDS[origin or hint]}, not {_shown(value)}.")


_WORDS = {str: "a string", bool: "true or false", list: "a list", tuple: "a point", dict: "an object"}


def _number(kind: type, bounds: Between, value: object, where: str) -> int | float:
    whole = "a whole number" if kind is int else "a number"
    is_number = isinstance(value, int if kind is int else (int, float)) and not isinstance(value, bool)
    if is_number and not math.isnan(value) and bounds.low <= value <= bounds.high:  # type: ignore[arg-type,operator]
        return value  # type: ignore[return-value]
    limits = f"from {bounds.low:.16g} to {bounds.high:.16g}"
    raise MessageError(f"{where} must be {whole} {limits}, not {_shown(value)}.")


def _shown(value: object) -> str:
    return f"`{str(value)[:40]}`"
