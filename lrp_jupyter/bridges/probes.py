"""Probes of the conformance tests: calls with a time limit, spies, and commands that are caught.

Only `drive_a_little` moves the robot.
"""

from __future__ import annotations

import threading
import unittest
from collections.abc import Callable
from typing import Any

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.member_tree import RobotMethod, RobotVariable, companion_path
from lrp_jupyter.bridges.message import Message
from lrp_jupyter.bridges.tasks import RobotTask
from lrp_jupyter.errors import BridgeError, NoDataYet, ended

_SLICE = 0.01  # s
_SLOW = 0.05  # m/s, where the limits of a command do not say what is slow


class ConformanceError(AssertionError):
    """A bridge violates a rule that holds for every bridge."""


class NotChecked(unittest.SkipTest):
    """A rule could not be checked, and the message says what is missing; pytest reports it as skipped."""


def require(holds: bool, otherwise: str) -> None:
    """Raise a ConformanceError with a sentence where a condition does not hold."""
    if not holds:
        raise ConformanceError(otherwise)


def within(seconds: float, what: str, function: Callable[[], Any]) -> Any:
    """Call on another thread, so that what hangs is reported; raise what it raised.

    The time is counted in slices, so that it stands still while the machine runs something else.
    """
    results: list[Any] = []
    errors: list[BaseException] = []

    def call() -> None:
        try:
            results.append(function())
        except BaseException as error:
            errors.append(error)

    thread = threading.Thread(target=call, name=f"check {what}", daemon=True)
    thread.start()
    for _ in range(round(seconds / _SLICE)):
        thread.join(_SLICE)
    require(not thread.is_alive(), f"{what} took more than {seconds:g} s.")
    if errors:
        error = errors[0]
        raise ConformanceError(ended(f"{what} raised {type(error).__name__}: {error}")) from error
    return results[0]


def spy(what: object, *names: str) -> list[str]:
    """Record the calls of the methods of a bridge, or of a task, in their order, and pass them on."""
    calls: list[str] = []

    def noting(name: str, function: Callable[..., Any]) -> Callable[..., Any]:
        def note(*args: Any, **kwargs: Any) -> Any:
            calls.append(name)
            return function(*args, **kwargs)

        return note

    for name in names:
        setattr(what, name, noting(name, getattr(what, name)))
    return calls


def catch(method: RobotMethod) -> list[object]:
    """Redirect a method's commands to a list; return the list."""
    sent: list[object] = []
    method.redirect(sent.append)
    return sent


def listen(method: RobotMethod) -> list[object]:
    """Record what a method's function returns when it is called; return the list."""
    results: list[object] = []
    function = method._function

    def noting(*args: object, **kwargs: object) -> object:
        results.append(function(*args, **kwargs))
        return results[-1]

    method._function = noting
    return results


def drive(bridge: Bridge, method: RobotMethod) -> None:
    """Give a command that moves the robot a little, as a program would."""
    command = method.standstill()
    name = next(iter(method.limits), "") or _first_number(method)
    low, high = method.limits.get(name, (0.0, 10 * _SLOW))
    speed = (high if high > 0 else low) / 10
    if isinstance(command, Message):
        command.set(name, speed)
    elif name:
        command.arguments[name] = speed
    bridge.send(method, command)


def drive_a_little(bridge: Bridge) -> None:
    """Give the first velocity command of a robot, as slow as is sensible."""
    moving = [method for method in commands(bridge) if method.velocity and _first_number(method)]
    if not moving:
        raise NotChecked("It has no velocity command such as `move`. Define `move_a_little` in a subclass.")
    drive(bridge, moving[0])


def ask_a_little(bridge: Bridge) -> None:
    """Ask for the first task of a robot that can be cancelled and takes one number, a small one."""
    for task in commands(bridge):
        if isinstance(task, RobotTask) and task.work.cancel is not None and task.message is None:
            needed = [each.name for each in task.parameters if each.default is each.empty]
            if len(needed) == 1:
                task(_SLOW)
                return
    raise NotChecked("It has no task that takes one number. Define `ask_a_little` in a subclass.")


def _first_number(method: RobotMethod) -> str:
    """Return the name of the first number that a method takes, empty if it takes none."""
    if method.message is not None:
        return next((path for path in (*method.message.WORDS, *method.message.paths())), "")
    return next((each.name for each in method.parameters if each.kind is not each.VAR_KEYWORD), "")


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
    return [node for node in bridge.nodes.members() if isinstance(node, RobotVariable) and not node.of]


def messages(bridge: Bridge) -> list[tuple[RobotVariable, RobotVariable]]:
    """Return the variables of a bridge that are fed, with those of their messages."""
    found = []
    for each in variables(bridge):
        new = bridge.nodes.table.get(companion_path(each.path, "new"))
        if each.getter is bridge.fed.getter(each.path) and isinstance(new, RobotVariable) and new.of:
            found.append((each, new))
    return found


def methods(bridge: Bridge) -> list[RobotMethod]:
    """Return the methods of a bridge."""
    return [node for node in bridge.nodes.members() if isinstance(node, RobotMethod)]


def commands(bridge: Bridge) -> list[RobotMethod]:
    """Return those methods of a bridge that are commands."""
    return [method for method in methods(bridge) if method.command]
