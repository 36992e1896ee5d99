"""What each command does: pausing, stepping, forcing, going back.

Everything here happens between two ticks, as a whole, on the thread that turns the loop, and
consumes no tick of its own. Paper: §6.3, §6.4.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from lrp_jupyter.errors import BridgeError, UnknownElementError
from lrp_jupyter.interpreter.issues import Issue
from lrp_jupyter.language.program import Element, Path, Program
from lrp_jupyter.live import commands as do

if TYPE_CHECKING:
    from lrp_jupyter.live.loop import Loop

__all__ = ["carry_out", "stand_still"]


def carry_out(loop: Loop, command: do.Command) -> Any:
    """Carry out one command on a loop; return what it has to say. Misuse raises."""
    interpreter = loop.interpreter
    match command:
        case do.Edit(program):
            return _stop_if_restarted(loop, lambda: interpreter.patch(program, loop.now))
        case do.Force(path, teleport):
            return _force(loop, path, teleport)
        case do.SetVariable(path, expression):
            return interpreter.set_variable(path, expression, loop.now)
        case do.Rename(kind, path, new_name):
            return interpreter.rename(kind, path, new_name, loop.now)
        case do.Rewind(ticks):
            return _rewind(loop, ticks)
        case do.Reset():
            return _stop_if_restarted(loop, lambda: interpreter.reset(loop.now))
        case do.Pause(reason):
            return _pause(loop, reason)
        case do.Resume():
            return _resume(loop)
        case do.Step():
            return _step(loop)
        case do.SetRate(rate):
            loop.set_rate(rate)
        case do.SetSpeed(speed):
            if loop.bridge.hardware and speed != 1:
                raise ValueError(f"`{loop.bridge.name}` is a real robot: its time passes at speed 1")
            loop.clock.speed = speed
        case do.SetPolicy(name, value):
            setattr(interpreter, name, value)
        case do.Call(function):
            return function()
    return None


def stand_still(loop: Loop, reason: str) -> None:
    """Be paused: time and robot. The interpreter has paused already."""
    loop.status, loop.reason = "paused", reason
    loop.clock.pause()
    _tell(loop, loop.bridge.on_pause)


def _resume(loop: Loop) -> None:
    """Run, or run on."""
    if loop.status == "running":
        return
    first = loop.status == "ready"
    loop.status, loop.reason = "running", ""
    loop.clock.resume()
    loop.clock.rebase(loop.now)
    loop.due = max(loop.due, loop.now)
    loop.measure()
    _tell(loop, loop.bridge.on_start if first else loop.bridge.on_resume)
    loop.interpreter.resume(loop.now)


def _pause(loop: Loop, reason: str) -> None:
    if loop.status == "running":
        loop.interpreter.pause(loop.now)
        stand_still(loop, reason)
    elif loop.status == "paused" and reason:
        loop.reason = reason


def _step(loop: Loop) -> None:
    """One tick, and one period of time; paused before and after."""
    _pause(loop, "")
    if loop.status == "ready":
        _tell(loop, loop.bridge.on_start)
    loop.status, loop.reason = "paused", ""
    loop.clock.pause()
    loop.due = loop.now
    loop.tick()
    loop.advance(loop.period)
    loop.clock.rebase(loop.now)


def _rewind(loop: Loop, ticks: int) -> None:
    """Go back by so many ticks: program, world, time.

    The world goes to the moment before the first tick undone, so that the next step repeats it.
    """
    bridge, interpreter = loop.bridge, loop.interpreter
    if bridge.hardware and bridge.safety.armed:
        raise BridgeError(f"`{bridge.name}` is armed: a real robot cannot go back. Disarm it first.")
    if not 0 <= ticks <= min(interpreter.journal, len(loop.moments)):
        have = min(interpreter.journal, len(loop.moments))
        raise ValueError(f"cannot go back {ticks} ticks: {have} are remembered")
    if ticks:
        first = loop.moments[-ticks]
        loop.go_back(first)  # the world may refuse, and then nothing has changed
        for _ in range(ticks):
            loop.moments.pop()
    interpreter.rewind(ticks)
    loop.tally.revision += 1


def _force(loop: Loop, path: Path, teleport: bool) -> None:
    """Force a state; one that does not exist is an issue, as it is in a transition."""
    interpreter = loop.interpreter
    force = interpreter.teleport_to if teleport else interpreter.transition_to
    try:
        force(_full_path(interpreter.program, path), loop.now)
    except UnknownElementError as error:
        element, tick, message = Element("state", path), interpreter.tick, str(error)
        issue = Issue("unknown state", element, message, 1, 1, first_tick=tick, last_tick=tick)
        interpreter.issues.report((element, 0, "unknown state"), lambda: issue, message, tick)


def _full_path(program: Program, path: Path) -> Path:
    """Complete a bare name to the path of the only state called so."""
    if len(path) != 1:
        return path
    found = [
        (*machine, str(state.name))
        for machine, noun in program.walk()
        for state in noun.states
        if state.name == path[0]
    ]
    return found[0] if len(found) == 1 else path


def _stop_if_restarted(loop: Loop, change: Callable[[], Any]) -> Any:
    before = loop.tally.restarts
    result = change()
    if loop.tally.restarts != before:  # no onexit has run: nothing may keep moving
        loop.bridge.stop_all()
    return result


def _tell(loop: Loop, hook: Callable[[], None]) -> None:
    """Call a hook of the bridge: a stranger's code, and if it fails its robot is stopped."""
    try:
        hook()
    except Exception as error:
        loop.bridge.set_status("lost", f"{type(error).__name__}: {error}")
        loop.bridge.stop_all()
