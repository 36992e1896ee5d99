"""What can go wrong when the API is used: misuse raises, faults of a user's program do not.

A fault of a program (an exception in a block, an unknown state) is an
:class:`~lrp_jupyter.interpreter.issues.Issue`, a value; it never raises.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from lrp_jupyter.language.program import Finding

__all__ = [
    "BridgeError",
    "LRPError",
    "LRPSyntaxError",
    "NoDataYet",
    "SessionClosedError",
    "SessionTimeoutError",
    "UnknownElementError",
]


class LRPError(Exception):
    """Base of every error that this package raises on purpose."""


class LRPSyntaxError(LRPError):
    """A text is not a program.

    Parameters
    ----------
    findings : tuple of Finding
        Every error of the text, in order of place; at least one.
    """

    def __init__(self, findings: tuple[Finding, ...]) -> None:
        self.findings = findings
        super().__init__("\n".join(str(finding) for finding in findings))


class UnknownElementError(LRPError, KeyError):
    """A path names no element of the program (or none that lives now)."""

    def __str__(self) -> str:  # a KeyError shows the repr of its argument; a sentence needs no quotes
        return str(self.args[0]) if self.args else ""


class SessionClosedError(LRPError):
    """A closed session was asked to do something."""


class SessionTimeoutError(LRPError, TimeoutError):
    """A session did not carry out a command in time; the message says what blocks it."""


class BridgeError(LRPError):
    """A bridge cannot reach its robot, or refuses a command."""


class NoDataYet(LRPError):  # noqa: N818  (it is no fault: the reading has simply not arrived)
    """A reading has not arrived yet: an event that needs it does not occur."""
