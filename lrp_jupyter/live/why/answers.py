"""Answers to questions about a session: *why* and *why not*."""

from __future__ import annotations

import math
from dataclasses import replace

from lrp_jupyter.errors import UnknownElementError
from lrp_jupyter.language.blocks.names_in_blocks import as_path
from lrp_jupyter.language.lookup import find_first
from lrp_jupyter.language.program import Element, Path, Program, path_text
from lrp_jupyter.language.resolution import resolve
from lrp_jupyter.live.reason import Reason
from lrp_jupyter.live.running.loop import Loop
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
"""What to do if a name belongs to another kind of element."""


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
        text = path_text(as_path(transition))
        if text in self._commands:
            raise UnknownElementError(f"`{text}` is a command, not a transition. Ask `why` about it.")
        return self._answer(("transition",), transition, at)

    def why(self, what: str | Path, at: int | None = None) -> Reason:
        """Return why a state was last entered, or why the robot received its last command (`robot.move`).

        Raises UnknownElementError: there is no such state or command, or there are several.
        Raises ValueError: the tick is not recorded.
        """
        return self._answer(("state", "command"), what, at)

    def explain(self, name: str | Path, at: int | None = None) -> Reason:
        """Return why a transition did not fire or, if there is no such transition, the result of :meth:`why`.

        Raises UnknownElementError: there is no such transition, state or command, or there are several.
        Raises ValueError: the tick is not recorded.
        """
        return self._answer(("transition", "state", "command"), name, at)

    def _answer(self, kinds: tuple[str, ...], wanted: str | Path, at: int | None) -> Reason:
        """Return the answer about an element of one of these kinds; a command counts as a state."""
        tick = self._run.tick(at)
        text = path_text(as_path(wanted))
        if "state" in kinds and text.startswith(_ROBOT):
            name = text.removeprefix(_ROBOT)
            return command_reason(self._run, name, tick, now=at is None)
        programs = self._run.program(tick), self._run.loop.interpreter.program
        commands = self._commands if "state" in kinds else ()
        element, program = find_first(programs, kinds, wanted, _INSTEAD, commands)
        then = self._then(element, program, tick)
        if element.kind == "state":
            return state_reason(self._run, then.path, element.path[-1], tick)
        if resolve(self._run.program(tick)).arrow(then) is not None:
            element, program = then, self._run.program(tick)
        reason = transition_reason(self._run, element, program, tick)
        if at is not None or not self._run.loop.interpreter.paused:
            return reason
        time = self._run.loop.timing.now
        paused = f"The session has been paused since {time_text(time)}, so nothing is tested."
        sentence = f"{paused} In the last tick: {reason}"
        facts = {**reason.facts, "otherwise": reason.code}
        return replace(reason, code="paused", time=time, sentence=sentence, facts=facts)

    def _then(self, element: Element, program: Program, tick: int) -> Element:
        """Return an element of a program with the path that it had in a tick."""
        if program is self._run.program(tick):
            return element
        return Element(element.kind, self._run.names(tick).of(element.kind, element.path, math.inf))

    @property
    def _commands(self) -> list[str]:
        return [_ROBOT + name for name in commands_of(self._run.loop.bridge)]
