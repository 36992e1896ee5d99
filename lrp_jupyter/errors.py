"""The exceptions of the API, raised for misuse of it, and the findings of the static checks.

A fault of a program (an exception in a block, an unknown state) is recorded as an
:class:`~lrp_jupyter.interpreter.issues.Issue` and never raises.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Literal, NamedTuple, NoReturn, Self

__all__ = [
    "BridgeError",
    "Edit",
    "FileError",
    "Finding",
    "Fix",
    "LRPError",
    "LRPSyntaxError",
    "NoDataYet",
    "NotAValue",
    "SessionClosedError",
    "SessionTimeoutError",
    "Severity",
    "StaleData",
    "UnknownElementError",
]

Severity = Literal["error", "warning", "hint"]


class Edit(NamedTuple):
    """A replacement of ``text[start:end]`` (in characters) by `text`."""

    start: int
    end: int
    text: str


class Fix(NamedTuple):
    """A safe remedy: its title, and the edits that apply it."""

    title: str
    edits: tuple[Edit, ...]

    def apply(self, text: str) -> str:
        """Return the text after the edits."""
        return edited(text, self.edits)


def edited(text: str, edits: Iterable[Edit]) -> str:
    """Return a text after edits that do not overlap; their offsets are those of the text before."""
    for start, end, new in sorted(edits, reverse=True):
        text = text[:start] + new + text[end:]
    return text


@dataclass(frozen=True, slots=True)
class Finding:
    """One error, warning or hint about a text.

    Parameters
    ----------
    code : str
        Never changes: ``LRP301``.
    severity : {"error", "warning", "hint"}
    message : str
        What is wrong, then what to do; names in backticks.
    line, column, end_line, end_column : int
        From 1; columns in characters; the end is after the last character.
    fix : Fix or None
        None unless the remedy is certain.
    prefix : bool
        Whether the name at this range only begins a known one: perhaps it is half typed.
    creates : Fix or None
        Creates what is missing; offered, because only the user knows whether that is meant.
    """

    code: str
    severity: Severity
    message: str
    line: int
    column: int
    end_line: int
    end_column: int
    fix: Fix | None = None
    prefix: bool = False
    creates: Fix | None = None

    def __str__(self) -> str:
        return f"{self.line}:{self.column}: {self.code} {self.severity}: {self.message}"


MOST_FINDINGS = 200
"""How many findings of a text are listed: more would help no reader, and slow down every view."""


def listed(findings: Sequence[Finding], count: int) -> tuple[Finding, ...]:
    """Return the findings that a list begins with and, if there are more than these, how many."""
    if count <= len(findings):
        return tuple(findings)
    last = findings[-1]
    message = f"There are {count - len(findings):,} more findings. Correct these first."
    place = (last.line, last.column, last.end_line, last.end_column)
    return (*findings, Finding("LRP698", "hint", message, *place))


class LRPError(Exception):
    """Base class of the errors that this package raises deliberately."""

    exit_code = 2  # of the command line


class LRPSyntaxError(LRPError):
    """A text is not a valid program.

    Parameters
    ----------
    findings : tuple of Finding
        Every error of the text, in the order of their locations; at least one.
    """

    def __init__(self, findings: tuple[Finding, ...]) -> None:
        self.findings = findings
        super().__init__(findings)  # all that pickle and copy pass to this function again

    def __str__(self) -> str:
        return "\n".join(map(str, self.findings))


class UnknownElementError(LRPError, KeyError):
    """A path does not name an element of the program, or not one that exists at the moment.

    Parameters
    ----------
    message : str
    candidates : iterable of str, optional
        What can have been meant, each as it can be written instead: the paths of all elements that have an
        ambiguous name; or the most similar name, if there is one. So there are several only if the name is
        ambiguous.
    """

    def __init__(self, message: str = "", candidates: Iterable[str] = ()) -> None:
        super().__init__(message)
        self.candidates = tuple(candidates)

    @classmethod
    def ambiguous(cls, nouns: str, name: str, paths: Iterable[str]) -> Self:
        """Return the error that several elements, which `nouns` says in the plural, have a name."""
        found = tuple(paths)
        listed = ", ".join(f"`{path}`" for path in found)
        return cls(f"Several {nouns} are called `{name}`. Use one of {listed}.", found)

    @classmethod
    def missing(cls, message: str, name: str, known: Iterable[str], otherwise: str = "") -> Self:
        """Return the error with a hint at the most similar known name or, without one, another hint."""
        close = most_similar(name, known)
        hint = f"Did you mean `{close[0]}`?" if close else otherwise
        return cls(f"{message} {hint}".rstrip(), close)

    def __str__(self) -> str:  # KeyError shows the repr of its argument, in quotes
        return str(self.args[0]) if self.args else ""


class SessionClosedError(LRPError):
    """A command was sent to a closed session."""


class SessionTimeoutError(LRPError, TimeoutError):
    """A session did not execute a command in time; the message says what blocks it."""


class BridgeError(LRPError):
    """A bridge cannot reach its robot, or rejects a command."""


class NoAnswerError(BridgeError):
    """No robot answers where one is looked for; it may come later."""

    exit_code = 4


class FileError(LRPError, OSError):
    """A file cannot be read or written; the message gives the reason."""


class NotAValue:
    """A part or a method of a robot: it cannot be compared, computed with or tested, and says what can be.

    Equality stays identity, because values are compared everywhere, and not only by programs.
    """

    __slots__ = ()

    def _not_a_value(self) -> str:
        """Return a sentence: what this is, and what to write instead."""
        raise NotImplementedError

    def _in_text(self) -> str:
        """Return how it is shown as a value, or in one."""
        return repr(self)

    def _refuse(self, *_: object) -> NoReturn:
        raise BridgeError(self._not_a_value())

    __lt__ = __le__ = __gt__ = __ge__ = _refuse
    __add__ = __radd__ = __sub__ = __rsub__ = __mul__ = __rmul__ = __pow__ = __rpow__ = _refuse
    __truediv__ = __rtruediv__ = __floordiv__ = __rfloordiv__ = __mod__ = __rmod__ = _refuse
    __and__ = __rand__ = __or__ = __ror__ = __xor__ = __rxor__ = __invert__ = _refuse
    __neg__ = __pos__ = __abs__ = __round__ = __int__ = __float__ = __index__ = __getitem__ = _refuse


class NoDataYet(LRPError):  # noqa: N818  (not an error: the reading has not arrived yet)
    """A reading has not arrived yet: an event that needs it does not occur."""


class StaleData(NoDataYet):
    """The last reading is too old to act on, as if it had not arrived; the message contains its age."""


def ended(text: str) -> str:
    """Return a text, such as that of an exception, with a full stop at its end unless it has a mark there."""
    return text if text.endswith((".", "?", "!", "…")) else f"{text}."


def name_of(kind: type) -> str:
    """Return the name of a class; runs no code of its metaclass."""
    name: str = _NAME.__get__(kind)
    return name


_NAME = type.__dict__["__name__"]


def did_you_mean(name: str, names: Iterable[str], likeness: float = 0.55) -> str:
    """Return `` Did you mean `light`?`` for the closest name, with a space before it, or nothing.

    `likeness` is the least that counts, from 0 to 1; of names of different things, close ones are rarer.
    """
    close = most_similar(name, names, likeness)
    return f" Did you mean `{close[0]}`?" if close else ""


def most_similar(name: str, names: Iterable[str], likeness: float = 0.55) -> tuple[str, ...]:
    """Return another name that is most similar, if there is one; `likeness` as for :func:`did_you_mean`."""
    known = [each for each in names if each != name]
    same = [each for each in known if each.casefold() == name.casefold()]
    return tuple(same[:1] or get_close_matches(name, known, n=1, cutoff=likeness))


def printable(text: str, kept: str = "") -> str:
    """Return a stranger's text as it may be shown: what a terminal obeys, or no file holds, by its number.

    `kept`: characters that stay as they are.
    """
    return "".join(each if each.isprintable() or each in kept else f"<U+{ord(each):04X}>" for each in text)


def lacks_simulator(error: BaseException) -> str:
    """Return how to get the simulator's engine if that is what could not be imported, else nothing."""
    if isinstance(error, ModuleNotFoundError) and error.name == "pymunk":
        return "Simulated worlds need `pymunk`: install it with `pip install pymunk`."
    return ""


def sentence_of(error: BaseException) -> str:
    """Return an exception as a sentence; that of an LRPError is its message. Never raises."""
    name = name_of(type(error))
    try:
        text = str(error)
    except BaseException:
        text = ""
    if isinstance(error, LRPError) and text:
        return text
    return ended(f"{name}: {text}" if text else name)
