"""Probes of the conformance tests: calls with a time limit, spies, and commands that are caught.

No probe moves the robot.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.nodes import RobotMethod, RobotVariable
from lrp_jupyter.errors import BridgeError, NoDataYet, ended

__all__ = [
    "ConformanceError",
    "catch",
    "commands",
    "give",
    "methods",
    "read",
    "require",
    "spy",
    "variables",
    "within",
]


class ConformanceError(AssertionError):
    """A bridge violates a rule that holds for every bridge."""


def require(holds: bool, otherwise: str) -> None:
    """Raise a ConformanceError with a sentence where a condition does not hold."""
    if not holds:
        raise ConformanceError(otherwise)


def within(seconds: float, what: str, function: Callable[[], Any]) -> Any:
    """Call on another thread, so that what hangs is reported; raise what it raised."""
    results: list[Any] = []
    errors: list[BaseException] = []

    def call() -> None:
        try:
            results.append(function())
        except BaseException as error:
            errors.append(error)

    thread = threading.Thread(target=call, name=f"check {what}", daemon=True)
    thread.start()
    thread.join(seconds)
    require(not thread.is_alive(), f"{what} took more than {seconds:g} s.")
    if errors:
        error = errors[0]
        raise ConformanceError(ended(f"{what} raised {type(error).__name__}: {error}")) from error
    return results[0]


def spy(bridge: Bridge, *names: str) -> list[str]:
    """Record the calls of a bridge's methods, in their order, and pass them on."""
    calls: list[str] = []

    def noting(name: str, function: Callable[..., Any]) -> Callable[..., Any]:
        def note(*args: Any, **kwargs: Any) -> Any:
            calls.append(name)
            return function(*args, **kwargs)

        return note

    for name in names:
        setattr(bridge, name, noting(name, getattr(bridge, name)))
    return calls


def catch(method: RobotMethod) -> list[object]:
    """Redirect a method's commands to a list; return the list."""
    sent: list[object] = []
    method.redirect(sent.append)
    return sent


def give(bridge: Bridge, method: RobotMethod) -> None:
    """Send a command of zeros, as a program would."""
    bridge.send(method, method.standstill())


def read(variable: RobotVariable) -> object:
    """Read a variable; None where it cannot be read now."""
    try:
        return variable.read()
    except (NoDataYet, BridgeError):
        return None


def variables(bridge: Bridge) -> list[RobotVariable]:
    """Return the variables of a bridge."""
    return [node for node in bridge.nodes.members() if isinstance(node, RobotVariable)]


def methods(bridge: Bridge) -> list[RobotMethod]:
    """Return the methods of a bridge."""
    return [node for node in bridge.nodes.members() if isinstance(node, RobotMethod)]


def commands(bridge: Bridge) -> list[RobotMethod]:
    """Return those methods of a bridge that are commands."""
    return [method for method in methods(bridge) if method.command]
