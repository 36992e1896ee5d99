"""The exceptions of the API: misuse raises, faults of a user's program do not.

A fault of a program (an exception in a block, an unknown state) is recorded as an
:class:`~lrp_jupyter.interpreter.issues.Issue` and never raises.
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
    """Base class of the errors that this package raises deliberately."""


class LRPSyntaxError(LRPError):
    """A text is not a valid program.

    Parameters
    ----------
    findings : tuple of Finding
        Every error of the text, in the order of their locations; at least one.
    """

    def __init__(self, findings: tuple[Finding, ...]) -> None:
        self.findings = findings
        super().__init__("\n".join(str(finding) for finding in findings))


class UnknownElementError(LRPError, KeyError):
    """A path does not name an element of the program, or not one that exists at the moment."""

    def __str__(self) -> str:  # KeyError shows the repr of its argument, in quotes
        return str(self.args[0]) if self.args else ""


class SessionClosedError(LRPError):
    """A command was sent to a closed session."""


class SessionTimeoutError(LRPError, TimeoutError):
    """A session did not execute a command in time; the message says what blocks it."""


class BridgeError(LRPError):
    """A bridge cannot reach its robot, or rejects a command."""


class NoDataYet(LRPError):  # noqa: N818  (not an error: the reading has not arrived yet)
    """A reading has not arrived yet: an event that needs it does not occur."""
