"""Answers to questions about a session: *why* and *why not*."""

from __future__ import annotations

import math
from dataclasses import replace

from lrp_jupyter.errors import UnknownElementError
from lrp_jupyter.interpreter.reasons import transition_of
from lrp_jupyter.language.names import as_path
from lrp_jupyter.language.program import Element, Path, Program, path_text
from lrp_jupyter.live.loop import Loop
from lrp_jupyter.live.reason import Reason
from lrp_jupyter.live.unknown import unknown
from lrp_jupyter.live.why.finding import find_state, find_transition
from lrp_jupyter.live.why.recorded_run import Again, RecordedRun
from lrp_jupyter.live.why.robot_commands import command_reason, commands_of
from lrp_jupyter.live.why.states import state_reason
from lrp_jupyter.live.why.transitions import transition_reason
from lrp_jupyter.live.why.wording import time_text

_ROBOT = "robot."
_INSTEAD = {
    "transition": "Ask `why_not` about it.",
    "state": "Ask `why` about it.",
    "event": "Ask about a transition that waits for it.",
}
"""What to do where a name is that of another kind of element."""


class Answers:
    """Answers a question about a session. Used on the thread that ticks, between two ticks.

    `again`: see :data:`Again`.
    """

    def __init__(self, loop: Loop, again: Again) -> None:
        self._run = RecordedRun(loop, again)

    def why_not(self, transition: str | Path, at: int | None = None) -> Reason:
        """Return why a transition did not fire in a tick, or that it did.

        Raises UnknownElementError: there is no such transition, or there are several.
        Raises ValueError: the tick is not recorded.
        """
        reason = self._of_transition(transition, at)
        if reason is None:
            if path_text(as_path(transition)) in self._commands:
                raise UnknownElementError(
                    f"`{path_text(as_path(transition))}` is a command, not a transition. Ask `why` about it."
                )
            raise unknown("transition", ["transition"], transition, self._programs(at), _INSTEAD)
        return reason

    def why(self, what: str | Path, at: int | None = None) -> Reason:
        """Return why a state was entered last, or why the robot got its last command (`robot.move`).

        Raises UnknownElementError: there is no such state or command, or there are several.
        Raises ValueError: the tick is not recorded.
        """
        reason = self._of_state_or_command(what, at)
        if reason is None:
            raise unknown("state", ["state"], what, self._programs(at), _INSTEAD, self._commands)
        return reason

    def explain(self, name: str | Path, at: int | None = None) -> Reason:
        """Return why a transition did not fire or, if there is no such transition, what `why` returns.

        Raises UnknownElementError: there is no such transition, state or command, or there are several.
        Raises ValueError: the tick is not recorded.
        """
        reason = self._of_transition(name, at) or self._of_state_or_command(name, at)
        if reason is None:
            noun, kinds = "transition, state or command", ["transition", "state"]
            raise unknown(noun, kinds, name, self._programs(at), _INSTEAD, self._commands)
        return reason

    def _of_transition(self, wanted: str | Path, at: int | None) -> Reason | None:
        """Return the answer about a transition; None if there is no such transition."""
        tick = self._run.tick(at)
        found = find_transition(wanted, self._programs(at))
        if found is None:
            return None
        element, program = found
        then = self._then(element, program, tick)
        if transition_of(self._run.program(tick), then) is not None:
            element, program = then, self._run.program(tick)
        reason = transition_reason(self._run, element, program, tick)
        if at is not None or not self._run.loop.interpreter.paused:
            return reason
        time = self._run.loop.timing.now
        paused = f"The session has been paused since {time_text(time)}, so nothing is tested."
        sentence = f"{paused} In the last tick: {reason}"
        facts = {**reason.facts, "otherwise": reason.code}
        return replace(reason, code="paused", time=time, sentence=sentence, facts=facts)

    def _of_state_or_command(self, wanted: str | Path, at: int | None) -> Reason | None:
        """Return the answer about a state or a command of the robot; None if there is no such state."""
        text = path_text(as_path(wanted))
        tick = self._run.tick(at)
        if text.startswith(_ROBOT):
            name = text.removeprefix(_ROBOT)
            return command_reason(self._run, name, tick, now=at is None)
        found = find_state(wanted, self._programs(at))
        if found is None:
            return None
        path, program = found
        then = self._then(Element("state", path), program, tick)
        return state_reason(self._run, then.path, path[-1], tick)

    def _then(self, element: Element, program: Program, tick: int) -> Element:
        """Return an element of a program by the path that it had in a tick."""
        if program is self._run.program(tick):
            return element
        return Element(element.kind, self._run.names(tick).of(element.kind, element.path, math.inf))

    @property
    def _commands(self) -> list[str]:
        return [_ROBOT + name for name in commands_of(self._run.loop.bridge)]

    def _programs(self, at: int | None) -> tuple[Program, Program]:
        """Return the programs in which a name is looked up: that of the tick, then the present one."""
        return self._run.program(self._run.tick(at)), self._run.present_program
