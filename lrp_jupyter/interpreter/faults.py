"""Turn an exception of a block into an issue: its kind, its message, its location.

This depends only on the exception and the program's text: no code runs, and the run decides the consequences
of an issue. Paper: §6.2.
"""

from __future__ import annotations

import re
import traceback as tracebacks
from itertools import islice
from types import TracebackType

from lrp_jupyter.errors import LRPError, NoDataYet, name_of
from lrp_jupyter.interpreter.issues import IssueKind
from lrp_jupyter.interpreter.linker import Site, show_in_tracebacks
from lrp_jupyter.language.program import Program

_LONGEST, _LONGEST_TRACE = 1_000, 20_000  # maximum number of characters of a message and of a traceback


class Fault(Exception):  # noqa: N818  (raised and caught inside the interpreter only)
    """A fault that Python does not raise itself; carries its kind."""

    def __init__(self, kind: IssueKind, message: str) -> None:
        self.kind = kind
        super().__init__(message)


class Interrupted(BaseException):
    """A block did not return and was interrupted from outside; becomes an issue of that block."""

    def __str__(self) -> str:
        return (
            "The block did not return and was interrupted. A block must end at once: use a state with "
            "`ontime`, or a transition that tests the sensor, instead of waiting in a block."
        )


def kind_and_message(program: Program, error: BaseException) -> tuple[IssueKind, str]:
    """Return the kind of a fault, and a sentence for the author of the program; never raises."""
    try:
        kind, message = _kind_and_message(program, error)
    except BaseException:  # an exception may have any attributes
        kind, message = "exception", name_of(type(error))
    message = str.__getitem__(message, slice(None))  # even for a subclass of str
    return kind, message if len(message) <= _LONGEST else message[: _LONGEST - 1] + "…"


def _kind_and_message(program: Program, error: BaseException) -> tuple[IssueKind, str]:
    if isinstance(error, Fault):
        return error.kind, str(error)
    if isinstance(error, NoDataYet):
        return "no data yet", str(error)
    if isinstance(error, Interrupted):
        return "did not return", str(error)
    sentence = _name_error(program, error) if isinstance(error, NameError) else ""
    return ("unknown variable", sentence) if sentence else ("exception", _first_line(error))


def line_of(program: Program, error: BaseException | None) -> int:
    """Return the line of the program in which an exception was raised, from 1; 0 if unknown."""
    trace = _innermost(program, error)
    return trace.tb_lineno if trace is not None else 0


def place_of(program: Program, site: Site, error: BaseException | None) -> tuple[int, int]:
    """Return the line and column of a fault, or those of its element if they are unknown."""
    trace, place = _innermost(program, error), None
    if trace is not None:
        positions = trace.tb_frame.f_code.co_positions()
        _, _, column, _ = next(islice(positions, trace.tb_lasti // 2, None))
        place = program.place_of_bytes(trace.tb_lineno, column or 0)
    return place or program.place(site.offset)


def traceback_of(program: Program, error: BaseException | None) -> str:
    """Return the traceback of a fault, starting at its block; empty without an exception."""
    if error is None:
        return ""
    show_in_tracebacks(program)  # another program may have the same name
    trace = error.__traceback__
    while trace is not None and trace.tb_frame.f_code.co_filename != program.filename:
        trace = trace.tb_next
    try:
        text = "".join(tracebacks.TracebackException(type(error), error, trace, compact=True).format())
    except BaseException:  # an exception may have any attributes
        text = "".join(tracebacks.format_tb(trace))
    return text if len(text) <= _LONGEST_TRACE else f"{text[:_LONGEST_TRACE]}…\n"


def _first_line(error: BaseException) -> str:
    """Return the type and the first line of an exception, without notes or the source of a SyntaxError.

    Messages raised by this package are sentences, so their type is left out.
    """
    lines = tracebacks.format_exception_only(error)
    first = next(line for line in lines if not line.startswith(" ")).splitlines()[0]
    sentence = first.partition(": ")[2] if isinstance(error, LRPError) else ""
    return sentence or first


def _name_error(program: Program, error: NameError) -> str:
    """Return a hint about a name without a value in a block; empty if it is in code of another file."""
    codes = [frame.f_code for frame, _ in tracebacks.walk_tb(error.__traceback__)]
    unbound = isinstance(error, UnboundLocalError) and re.search(r"local variable '(.+?)'", str(error))
    name = unbound[1] if unbound else error.name
    if not codes or not name or codes[-1].co_filename not in (program.filename, "<string>"):
        return ""
    code = codes[-1]
    if name in code.co_freevars:
        return f"`{name}` has no value. Assign one first."
    if code.co_filename == "<string>":
        return f"`{name}` is not known to `eval` or `exec`, which see no variable of the program."
    if unbound:
        return f"`{name}` has no value here. Assign one first, or declare `(var {name} := [value])`."
    return f"`{name}` is not defined here. Correct the name, or declare `(var {name} := [value])`."


def _innermost(program: Program, error: BaseException | None) -> TracebackType | None:
    """Return the innermost traceback entry that is in the program's text."""
    found = None
    trace = error.__traceback__ if error is not None else None
    while trace is not None:
        if trace.tb_frame.f_code.co_filename == program.filename:
            found = trace
        trace = trace.tb_next
    return found
