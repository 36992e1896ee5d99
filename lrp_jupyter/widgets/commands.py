"""The commands of a page: one class for each act, with its own fields.

`apply` runs on the thread that delivers messages. It queues a command of the session and returns its future,
does at once what any thread may do, or hands to the worker what has to wait.
"""

from __future__ import annotations

import math
from abc import ABC
from concurrent.futures import Future
from dataclasses import dataclass, field
from functools import partial
from typing import Annotated, Any, ClassVar

from lrp_jupyter import programs
from lrp_jupyter.bridges.safety import OF_COMMANDS
from lrp_jupyter.errors import LRPError, UnknownElementError
from lrp_jupyter.live import commands as do
from lrp_jupyter.widgets.messages import Between, OpenProgram, PageCommand
from lrp_jupyter.widgets.places import path_of
from lrp_jupyter.widgets.protocol import GraphMode, OnActiveEdit

Applied = Future[Any] | None
Ticks = Annotated[int, Between(1, 10_000)]
PastTicks = Annotated[int, Between(1, 1_000_000)]
Positive = Annotated[float, Between(0, 1e6)]


class InterruptingCommand(PageCommand, ABC):
    """Base class of commands that are applied between two ticks, if need be by interrupting a block."""

    patience: ClassVar[float] = 5.0  # longer than it takes to interrupt a block that does not return


class ConnectingCommand(PageCommand, ABC):
    """Base class of commands that may have to connect to a robot."""

    patience: ClassVar[float] = 20.0


# -- control -----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class RunCommand(ConnectingCommand, do="run"):
    """Start or resume the program; after a stop, or if the session itself failed, from the beginning."""

    def apply(self, opened: OpenProgram) -> Applied:
        session = opened.session
        if session.status in ("ready", "stopped", "broken"):
            return opened.work(session.start)
        return session.ask(do.Resume())


@dataclass(frozen=True)
class PauseCommand(InterruptingCommand, do="pause"):
    """Pause the program."""

    def apply(self, opened: OpenProgram) -> Applied:
        return opened.session.ask(do.Pause())


@dataclass(frozen=True)
class StepCommand(InterruptingCommand, do="step"):
    """Run this number of ticks."""

    value: Ticks = 1

    def apply(self, opened: OpenProgram) -> Applied:
        if not opened.session.bridge.is_open:
            return opened.work(opened.session.step)
        *_, last = [opened.session.ask(do.Step()) for _ in range(self.value)]
        return last


@dataclass(frozen=True)
class StepBackCommand(InterruptingCommand, do="step_back"):
    """Step back by this number of ticks."""

    value: PastTicks = 1

    def apply(self, opened: OpenProgram) -> Applied:
        return opened.work(partial(opened.session.rewind, self.value))


@dataclass(frozen=True)
class ResetCommand(InterruptingCommand, do="reset"):
    """Start the program from scratch."""

    is_present: ClassVar[bool] = True

    def apply(self, opened: OpenProgram) -> Applied:
        session = opened.session
        if session.status == "broken":
            return opened.work(session.reset)
        return session.ask(do.Reset())


@dataclass(frozen=True)
class StopCommand(PageCommand, do="stop"):
    """Stop the robot now, whatever the program does, then pause; never waits for a tick."""

    def apply(self, opened: OpenProgram) -> Applied:
        opened.session.stop_robot()
        return None


@dataclass(frozen=True)
class InterruptCommand(PageCommand, do="interrupt"):
    """Interrupt the block that does not return."""

    def apply(self, opened: OpenProgram) -> Applied:
        if not opened.session.interrupt():
            raise LRPError("No block is running now, so there is nothing to interrupt.")
        return None


@dataclass(frozen=True)
class RateCommand(PageCommand, do="rate"):
    """Set the ticks per second; 0 is as many as possible."""

    value: Positive

    def apply(self, opened: OpenProgram) -> Applied:
        return opened.session.ask(do.SetRate(self.value))


@dataclass(frozen=True)
class SpeedCommand(PageCommand, do="speed"):
    """Set the simulated seconds per second; 0 is as many as possible."""

    value: Positive

    def apply(self, opened: OpenProgram) -> Applied:
        return opened.session.ask(do.SetSpeed(self.value or math.inf))


@dataclass(frozen=True)
class ArmedCommand(PageCommand, do="armed"):
    """Arm or disarm the robot."""

    on: bool
    patience: ClassVar[float] = 20.0  # the guard of the robot has to reach it

    def apply(self, opened: OpenProgram) -> Applied:
        bridge = opened.session.bridge
        if self.on:
            return opened.work(bridge.arm)
        bridge.disarm()
        return None


@dataclass(frozen=True)
class BridgeCommand(ConnectingCommand, do="bridge"):
    """Continue with another bridge: a new session of the same program."""

    name: str

    def apply(self, opened: OpenProgram) -> Applied:
        return opened.work(partial(opened.change_bridge, self.name))


@dataclass(frozen=True)
class PanelCommand(ConnectingCommand, do="panel"):
    """Press a button of the bridge's panel, or answer its question.

    `row` is the key of the row of a table that holds the button, `values` are those of all fields.
    """

    key: str
    row: str = ""
    values: dict[str, str] = field(default_factory=dict)

    def apply(self, opened: OpenProgram) -> Applied:
        key, values, session = self.key, self.values, opened.session
        bridge = session.bridge
        if key == "stop":
            session.stop_robot()
            return None
        panel = bridge.panel()
        if panel is not None and any(question.key == key for question in panel.questions):
            return session.ask(do.Call(partial(bridge.answer, key, values.get(key, "")), "answer"))
        return session.ask(do.Call(partial(bridge.press, key, self.row, values), "press"))


# -- text --------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class HoldCommand(PageCommand, do="hold"):
    """Switch holding of edits on or off; a held text is applied when it is switched off."""

    on: bool

    def apply(self, opened: OpenProgram) -> Applied:
        opened.study.switch(edits="hold" if self.on else "live")
        opened.wake()
        return None


@dataclass(frozen=True)
class GraphCommand(PageCommand, do="graph"):
    """Set when the state graph is redrawn, and whether it is shown."""

    mode: GraphMode

    def apply(self, opened: OpenProgram) -> Applied:
        opened.study.switch(graph=self.mode)
        opened.wake()
        return None


@dataclass(frozen=True)
class ApplyCommand(PageCommand, do="apply"):
    """Apply the held text."""

    def apply(self, opened: OpenProgram) -> Applied:
        opened.texts.apply()
        return None


@dataclass(frozen=True)
class RevertCommand(PageCommand, do="revert"):
    """Return to the text of the running program."""

    def apply(self, opened: OpenProgram) -> Applied:
        opened.texts.write(opened.session.program.text)
        return None


@dataclass(frozen=True)
class LoadCommand(PageCommand, do="load"):
    """Replace the text and the name by those of a bundled program."""

    name: str

    def apply(self, opened: OpenProgram) -> Applied:
        opened.load(self.name, programs.load(self.name))
        return None


@dataclass(frozen=True)
class TakeCommand(PageCommand, do="take"):
    """End a conflict with its text. Without a number, the present one."""

    number: int | None = None

    def apply(self, opened: OpenProgram) -> Applied:
        opened.texts.end_conflict(self.number, use=True)
        opened.wake()
        return None


@dataclass(frozen=True)
class KeepCommand(PageCommand, do="keep"):
    """End a conflict with the present text. Without a number, the present one."""

    number: int | None = None

    def apply(self, opened: OpenProgram) -> Applied:
        opened.texts.end_conflict(self.number, use=False)
        opened.wake()
        return None


@dataclass(frozen=True)
class RecoverCommand(PageCommand, do="recover"):
    """Ask about a text that was typed in a view whose kernel had ended."""

    is_automatic: ClassVar[bool] = True

    text: str

    def apply(self, opened: OpenProgram) -> Applied:
        opened.texts.recover(self.text)
        opened.wake()
        return None


@dataclass(frozen=True)
class VersionCommand(PageCommand, do="version"):
    """Return to an earlier text."""

    key: str

    def apply(self, opened: OpenProgram) -> Applied:
        return opened.work(partial(_return_to, opened, self.key))


def _return_to(opened: OpenProgram, key: str) -> None:
    found = next((version for version in opened.saver.versions if version.key == key), None)
    if found is None:
        raise UnknownElementError("This version is no longer kept. Open the list of versions again.")
    opened.texts.write(found.text)


# -- forcing -----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class TransitionCommand(InterruptingCommand, do="transition"):
    """Go to a state as if a transition led there."""

    is_present: ClassVar[bool] = True

    path: str

    def apply(self, opened: OpenProgram) -> Applied:
        return opened.session.ask(do.Force(path_of("state", self.path)))


@dataclass(frozen=True)
class TeleportCommand(InterruptingCommand, do="teleport"):
    """Make a state active without running any action."""

    is_present: ClassVar[bool] = True

    path: str

    def apply(self, opened: OpenProgram) -> Applied:
        return opened.session.ask(do.Force(path_of("state", self.path), teleport=True))


@dataclass(frozen=True)
class FireCommand(InterruptingCommand, do="fire"):
    """Fire a transition now: its source must be active."""

    is_present: ClassVar[bool] = True

    path: str

    def apply(self, opened: OpenProgram) -> Applied:
        return opened.session.ask(do.Fire(path_of("transition", self.path)))


@dataclass(frozen=True)
class SetVariableCommand(PageCommand, do="set_variable"):
    """Assign the value of an expression."""

    is_present: ClassVar[bool] = True

    path: str
    expression: str

    def apply(self, opened: OpenProgram) -> Applied:
        return opened.session.ask(do.SetVariable(path_of("variable", self.path), self.expression))


# -- policies and issues -----------------------------------------------------------------------------


@dataclass(frozen=True)
class OnActiveEditCommand(PageCommand, do="on_active_edit"):
    """Set whether an edit of the active state restarts the program."""

    name: OnActiveEdit

    def apply(self, opened: OpenProgram) -> Applied:
        return _set(opened, do.SetPolicy("on_active_edit", self.name))


@dataclass(frozen=True)
class PauseOnIssueCommand(PageCommand, do="pause_on_issue"):
    """Set whether an issue pauses the program, whenever it occurs."""

    on: bool

    def apply(self, opened: OpenProgram) -> Applied:
        return _set(opened, do.SetPolicy("on_issue", "pause" if self.on else "record"))


def _set(opened: OpenProgram, policy: do.SetPolicy) -> Applied:
    answer = opened.session.ask(policy)
    answer.add_done_callback(lambda _: opened.wake())
    return answer


@dataclass(frozen=True)
class ClearIssuesCommand(PageCommand, do="clear_issues"):
    """Clear the issues of the run."""

    def apply(self, opened: OpenProgram) -> Applied:
        session = opened.session

        def clear() -> None:
            session.interpreter.issues.clear()
            session.bridge.safety.forget_notices(*OF_COMMANDS)

        return session.ask(do.Call(clear))


# -- the graph ---------------------------------------------------------------------------------------


@dataclass(frozen=True)
class PinCommand(PageCommand, do="pin"):
    """Pin a node of a machine's graph to the place where it was dragged, in px."""

    path: str
    name: str
    x: float
    y: float

    def apply(self, opened: OpenProgram) -> Applied:
        opened.layouts.pin(self.path, self.name, self.x, self.y)
        opened.wake()
        return None


@dataclass(frozen=True)
class FitCommand(PageCommand, do="fit"):
    """Choose places for new states so that the graph fits into a panel of this size, in px."""

    is_automatic: ClassVar[bool] = True

    width: float
    height: float

    def apply(self, opened: OpenProgram) -> Applied:
        if self.width > 0 and self.height > 0:
            opened.layouts.fit((self.width, self.height))
            opened.wake()
        return None


@dataclass(frozen=True)
class NestCommand(PageCommand, do="nest"):
    """Draw nested machines inside their states, or each machine by itself."""

    on: bool

    def apply(self, opened: OpenProgram) -> Applied:
        opened.layouts.nest(self.on)
        opened.wake()
        return None


@dataclass(frozen=True)
class ArrangeCommand(PageCommand, do="arrange"):
    """Lay out a machine as if for the first time."""

    path: str

    def apply(self, opened: OpenProgram) -> Applied:
        opened.layouts.arrange(self.path)
        opened.wake()
        return None
