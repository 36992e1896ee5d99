"""What a page can do to a program, its text, its robot and its graph.

An act runs on the thread that delivers messages. It queues a command of the session and returns its future,
does at once what any thread may do, or passes to the worker whatever has to wait. Then the views are updated.
"""

from __future__ import annotations

import math
from concurrent.futures import Future
from functools import partial
from typing import Annotated, Any

from lrp_jupyter import programs
from lrp_jupyter.errors import LRPError, UnknownElementError
from lrp_jupyter.live.running import commands as do
from lrp_jupyter.widgets.acts.messages import OpenProgram, act
from lrp_jupyter.widgets.wire.codec import Between
from lrp_jupyter.widgets.wire.page_places import path_of
from lrp_jupyter.widgets.wire.protocol import GraphMode, OnActiveEdit

Applied = Future[Any] | None
Ticks = Annotated[int, Between(1, 10_000)]
PastTicks = Annotated[int, Between(1, 1_000_000)]
Positive = Annotated[float, Between(0, 1e6)]

INTERRUPTING = 5.0
"""Wall seconds: longer than it takes to interrupt a block that does not return."""
CONNECTING = 20.0
"""Wall seconds in which a robot, or its guard, is reached."""


# -- control -----------------------------------------------------------------------------------------


@act(CONNECTING)
def run(opened: OpenProgram) -> Applied:
    """Start or resume the program; after a stop, or if the session itself failed, from the beginning."""
    session = opened.session
    if session.status in ("ready", "stopped", "broken"):
        return opened.work(session.start)
    return session.ask(do.Resume())


@act(INTERRUPTING)
def pause(opened: OpenProgram) -> Applied:
    """Pause the program."""
    return opened.session.ask(do.Pause())


@act(INTERRUPTING)
def step(opened: OpenProgram, value: Ticks = 1) -> Applied:
    """Run this number of ticks."""
    if not opened.session.bridge.is_open:
        return opened.work(opened.session.step)
    *_, last = [opened.session.ask(do.Step()) for _ in range(value)]
    return last


@act(INTERRUPTING)
def step_back(opened: OpenProgram, value: PastTicks = 1) -> Applied:
    """Step back by this number of ticks."""
    return opened.work(partial(opened.session.rewind, value))


@act(INTERRUPTING, is_present=True)
def reset(opened: OpenProgram) -> Applied:
    """Start the program from scratch."""
    session = opened.session
    if session.status == "broken":
        return opened.work(session.reset)
    return session.ask(do.Reset())


@act()
def stop(opened: OpenProgram) -> None:
    """Stop the robot now, whatever the program does, then pause, without waiting for a tick."""
    opened.session.stop_robot()


@act()
def interrupt(opened: OpenProgram) -> None:
    """Interrupt the block that does not return."""
    if not opened.session.interrupt():
        raise LRPError("No block is running now, so there is nothing to interrupt.")


@act()
def rate(opened: OpenProgram, value: Positive) -> Applied:
    """Set the ticks per second; 0 is as many as possible."""
    return opened.session.ask(do.SetRate(value))


@act()
def speed(opened: OpenProgram, value: Positive) -> Applied:
    """Set the simulated seconds per second; 0 is as many as possible."""
    return opened.session.ask(do.SetSpeed(value or math.inf))


@act(CONNECTING)
def armed(opened: OpenProgram, on: bool) -> Applied:
    """Arm or disarm the robot."""
    bridge = opened.session.bridge
    if on:
        return opened.work(bridge.arm)
    bridge.disarm()
    return None


@act(CONNECTING)
def bridge(opened: OpenProgram, name: str) -> Applied:
    """Continue with another bridge: a new session of the same program."""
    return opened.work(partial(opened.change_bridge, name))


@act(CONNECTING)
def panel(opened: OpenProgram, key: str, row: str = "", values: dict[str, str] | None = None) -> Applied:
    """Press a button of the bridge's panel, or answer its question.

    `row` is the key of the row of a table that holds the button, `values` are those of all fields.
    """
    session, bridge, values = opened.session, opened.session.bridge, values or {}
    if key == "stop":
        session.stop_robot()
        return None
    panel = bridge.panel()
    if panel is not None and any(question.key == key for question in panel.questions):
        return session.ask(do.Call(partial(bridge.answer, key, values.get(key, ""))))
    return session.ask(do.Call(partial(bridge.press, key, row, values)))


# -- text --------------------------------------------------------------------------------------------


@act()
def hold(opened: OpenProgram, on: bool) -> None:
    """Switch holding of edits on or off; a held text is applied when it is switched off."""
    opened.texts.set_conditions(opened.texts.conditions.switched(edits="hold" if on else "live"))


@act()
def graph(opened: OpenProgram, mode: GraphMode) -> None:
    """Set when the state graph is redrawn, and whether it is shown."""
    opened.texts.set_conditions(opened.texts.conditions.switched(graph=mode))


@act()
def apply(opened: OpenProgram) -> None:
    """Apply the held text."""
    opened.texts.apply()


@act()
def revert(opened: OpenProgram) -> None:
    """Return to the text of the running program."""
    opened.texts.write(opened.session.program.text)


@act()
def load(opened: OpenProgram, name: str) -> None:
    """Replace the text and the name by those of a bundled program."""
    opened.load(name, programs.load(name))


@act()
def take(opened: OpenProgram, number: int | None = None) -> None:
    """End a conflict with its text. Without a number, the present one."""
    opened.texts.end_conflict(number, use=True)


@act()
def keep(opened: OpenProgram, number: int | None = None) -> None:
    """End a conflict with the present text. Without a number, the present one."""
    opened.texts.end_conflict(number, use=False)


@act(is_noted=False)  # the page sends it unasked
def recover(opened: OpenProgram, text: str) -> None:
    """Ask about a text that was typed in a view whose kernel had ended."""
    opened.texts.recover(text)


@act(is_noted=False)
def put_into_cell(opened: OpenProgram, text: str) -> None:
    """Note that the page has written this text into the cell, or has found it there."""
    opened.texts.put_into_cell(text)


@act()
def version(opened: OpenProgram, key: str) -> Applied:
    """Return to an earlier text."""
    return opened.work(partial(_return_to, opened, key))


def _return_to(opened: OpenProgram, key: str) -> None:
    found = next((version for version in opened.texts.versions if version.key == key), None)
    if found is None:
        raise UnknownElementError("This version is no longer kept. Open the list of versions again.")
    opened.texts.write(found.text)


# -- forcing -----------------------------------------------------------------------------------------


@act(INTERRUPTING, is_present=True)
def transition(opened: OpenProgram, path: str) -> Applied:
    """Go to a state as if a transition led there."""
    return opened.session.ask(do.Force(path_of("state", path)))


@act(INTERRUPTING, is_present=True)
def teleport(opened: OpenProgram, path: str) -> Applied:
    """Make a state active without running any action."""
    return opened.session.ask(do.Force(path_of("state", path), teleport=True))


@act(INTERRUPTING, is_present=True)
def fire(opened: OpenProgram, path: str) -> Applied:
    """Fire a transition now: its source must be active."""
    return opened.session.ask(do.Fire(path_of("transition", path)))


@act(is_present=True)
def set_variable(opened: OpenProgram, path: str, expression: str) -> Applied:
    """Assign the value of an expression."""
    return opened.session.ask(do.SetVariable(path_of("variable", path), expression))


# -- policies and issues -----------------------------------------------------------------------------


@act()
def on_active_edit(opened: OpenProgram, name: OnActiveEdit) -> Applied:
    """Set whether an edit of the active state restarts the program."""
    return opened.session.ask(do.SetPolicy("on_active_edit", name))


@act()
def pause_on_issue(opened: OpenProgram, on: bool) -> Applied:
    """Set whether an issue pauses the program, whenever it occurs."""
    return opened.session.ask(do.SetPolicy("on_issue", "pause" if on else "record"))


@act()
def clear_issues(opened: OpenProgram) -> Applied:
    """Clear the issues of the run."""
    return opened.session.ask(do.ClearIssues())


# -- the graph ---------------------------------------------------------------------------------------


@act()
def pin(opened: OpenProgram, path: str, name: str, x: float, y: float) -> None:
    """Pin a node of a machine's graph to the place where it was dragged, in px."""
    opened.layouts.pin(path, name, x, y)


@act(is_noted=False, only_looks=True)  # the page sends it unasked
def fit(opened: OpenProgram, width: float, height: float) -> None:
    """Choose places for new states so that the graph fits into a panel of this size, in px."""
    if width > 0 and height > 0:
        opened.layouts.fit((width, height))


@act()
def nest(opened: OpenProgram, on: bool) -> None:
    """Draw nested machines inside their states, or each machine by itself."""
    opened.layouts.nest(on)


@act()
def arrange(opened: OpenProgram, path: str) -> None:
    """Lay out a machine as if for the first time."""
    opened.layouts.arrange(path)
