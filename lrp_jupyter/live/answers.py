"""Answer why a transition did not fire, why a state is active, and why the robot does what it does.

Everything here reads what is recorded and changes nothing: the journal says what happened in a tick, the
bridge what was read and commanded, and a condition is evaluated again over those values, part by part. Where
a value is not recorded (it was changed in place, or a function was called), the answer says so, unless the
tick can be run again in a fork.
"""

from __future__ import annotations

import ast
import builtins
import time as wall
from bisect import bisect_right
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from types import BuiltinFunctionType, CellType, FunctionType, ModuleType
from typing import Any

from lrp_jupyter.bridges.nodes import RobotMethod
from lrp_jupyter.errors import UnknownElementError, did_you_mean, ended, sentence_of
from lrp_jupyter.interpreter.events import UNSET
from lrp_jupyter.interpreter.facts import Commanded, Discarded, Entered, Fact, Fired, Spawned
from lrp_jupyter.interpreter.history import PastMachine, PastState
from lrp_jupyter.interpreter.reasons import Cause, cause_of, transition_of
from lrp_jupyter.interpreter.rendering import short
from lrp_jupyter.interpreter.watching import Shown, items
from lrp_jupyter.language.expressions import (
    Evaluation,
    UnknownValueError,
    evaluate,
    expression_of,
    names_in,
)
from lrp_jupyter.language.names import as_path
from lrp_jupyter.language.program import Block, Element, Path, Program, path_text
from lrp_jupyter.language.python import parse_python
from lrp_jupyter.language.resolution import Arrow, resolve
from lrp_jupyter.language.triggers import Delay, Epsilon
from lrp_jupyter.live.loop import Loop
from lrp_jupyter.live.reason import Reason
from lrp_jupyter.live.recorded_robot import RecordedRobot

__all__ = ["Again", "Answers", "call_text", "condition_of", "tick_of"]

Again = Callable[[int, Element], "Evaluation | Exception | None"]
"""Runs a tick again in a fork and returns how a transition was tested there; None if that is impossible."""

_SEARCH = 0.03  # wall seconds for which the last time that a condition was true is searched
_IMMUTABLE = (int, float, complex, str, bytes, bool, type(None))


@dataclass(frozen=True, slots=True)
class Test:
    """What a transition tests.

    Parameters
    ----------
    block : Block or None
        The block of its condition, event or delay.
    line : int
    machine : path
        The machine in whose scope that is evaluated, by path of definition; empty for the top level.
    """

    block: Block | None
    line: int
    machine: Path


def condition_of(program: Program, element: Element) -> Test | None:
    """Return what a transition tests; None if it tests nothing, or refers to nothing that exists."""
    arrow = _arrow(program, element)
    if arrow is None:
        return None
    trigger = arrow.noun.trigger
    if trigger.block is not None:
        block = trigger.block[1]
        return Test(block, program.place(block.span.start)[0], arrow.scope.path)
    reference = trigger.reference
    if reference is None or arrow.owner is None:
        return None
    kind, name = reference
    if kind == "variable":
        return None
    event = arrow.owner.events[name]
    return Test(event.condition, program.place(event.condition.span.start)[0], arrow.owner.path)


def _arrow(program: Program, element: Element) -> Arrow | None:
    scope = resolve(program).by_path.get(element.path[:-1])
    if scope is None:
        return None
    return next((arrow for arrow in resolve(program).arrows[scope] if arrow.element == element), None)


@dataclass(slots=True)
class _Draft:
    """An answer that is being written: its sentences, the lines that it mentions, and its facts."""

    sentences: list[str] = field(default_factory=list)
    lines: list[int] = field(default_factory=list)
    facts: dict[str, Any] = field(default_factory=dict)

    def say(self, sentence: str, *lines: int) -> None:
        self.sentences.append(sentence)
        self.lines += [line for line in lines if line]

    def reason(self, code: str, tick: int, time: float) -> Reason:
        lines = tuple(dict.fromkeys(line for line in self.lines if line))
        facts = {**self.facts, "lines": lines}
        return Reason(code, tick, time, lines[0] if lines else 0, " ".join(self.sentences), facts)


class Answers:
    """Answers questions about a session. Used on the thread that ticks, between two ticks.

    Parameters
    ----------
    loop : Loop
    again : callable
        See :data:`Again`.
    """

    def __init__(self, loop: Loop, again: Again = lambda tick, element: None) -> None:
        self._loop = loop
        self._again = again
        self._interpreter = loop.interpreter
        self._history = loop.interpreter.history

    # -- transitions -----------------------------------------------------------------------------

    def why_not(self, wanted: str | Path, at: int | None = None) -> Reason:
        """Return why a transition did not fire in a tick, or that it did.

        Raises
        ------
        UnknownElementError
            There is no such transition, or there are several.
        ValueError
            The tick is not recorded.
        """
        tick = self._tick(at)
        element, program = self._transition(wanted, tick)
        reason = self._transition_reason(element, tick, program)
        if at is None and self._interpreter.paused:
            now = self._loop.now
            paused = f"The session has been paused since {now:g} s, so nothing is tested."
            sentence = f"{paused} In the last tick: {reason}"
            return Reason(
                "paused", tick, now, reason.line, sentence, {**reason.facts, "otherwise": reason.code}
            )
        return reason

    def _tick(self, at: int | None) -> int:
        ticks = self._history.ticks
        tick = ticks.stop - 1 if at is None else at
        if not len(ticks):
            raise ValueError("No tick is recorded yet. Run the program first.")
        if tick not in ticks:
            raise ValueError(f"Tick {tick} is not recorded: only {ticks.start} to {ticks.stop - 1} are.")
        return tick

    def _transition(self, wanted: str | Path, tick: int) -> tuple[Element, Program]:
        """Find a transition by name, label, id or path, in the program of the tick or in the present one."""
        there = self._history.state(tick, before=True).program
        names: list[str] = []
        for program in (there, self._interpreter.program):
            found = []
            for element in resolve(program).elements():
                if element.kind != "transition":
                    continue
                machine, own = element.path[:-1], element.path[-1]
                texts = {own, element.shown[-1], path_text(element.path), path_text(element.shown)}
                texts |= {f"{path_text(machine)}:{own}"}
                names += [element.shown[-1]]
                if wanted in texts or as_path(wanted) == element.path:
                    found.append(element)
            if len(found) == 1:
                return found[0], program
            if found:
                listed = ", ".join(f"`{path_text(each.path)}`" for each in found)
                raise UnknownElementError(f"Several transitions are called `{wanted}`. Use one of {listed}.")
        text = path_text(as_path(wanted))
        raise UnknownElementError(f"There is no transition `{text}`.{did_you_mean(text, names)}")

    def _transition_reason(self, element: Element, tick: int, known: Program) -> Reason:
        cause = cause_of(self._history, element, tick)
        state = self._history.state(tick, before=True)
        program, time = state.program, self._history.facts(tick).now
        draft, at = _Draft(), f"at {time:g} s"
        name = _shown(known, element)
        own = _line(program if cause.code != "not-in-program" else known, element)
        subject = f"`{name}` (line {own}) did not fire {at}:" if own else f"`{name}` did not fire {at}:"
        draft.facts |= {"transition": element.path, "state": cause.machine and cause.machine.full_path}
        writer = _WRITERS.get(cause.code)
        if writer is not None:
            writer(self, draft, subject, cause, state, element, tick)
        elif cause.code == "not-in-program":
            draft.say(f"The program of tick {tick} ({at}) had no transition `{name}`.", own)
        else:  # the fault says it
            assert cause.fault is not None
            test = condition_of(program, element)
            what = f"{subject.removesuffix(':')}."
            if cause.code == "unknown-destination":
                what = f"{subject} it was enabled, but leads nowhere."
            elif test is not None and test.block is not None:
                where = f" (line {test.line})" if test.line != own else ""
                what = f"{subject} its condition is `{test.block.text.strip()}`{where}."
            draft.say(f"{what} {ended(cause.fault.message)}", test.line if test else own)
            draft.facts["message"] = cause.fault.message
        draft.lines.append(own)
        return draft.reason(cause.code, tick, time)

    def _fired(
        self, draft: _Draft, subject: str, cause: Cause, state: PastState, element: Element, tick: int
    ) -> None:
        assert cause.fired is not None
        fired = cause.fired
        draft.say(
            f"{subject.replace('did not fire', 'fired').rstrip(':')}, from `{fired.source[-1]}` to "
            f"`{fired.state[-1]}`{self._since(draft, cause, state, element, tick)}.",
            _line(state.program, element),
        )

    def _since(self, draft: _Draft, cause: Cause, state: PastState, element: Element, tick: int) -> str:
        """Say what made a transition fire."""
        noun = transition_of(state.program, element)
        if noun is None or cause.machine is None or isinstance(noun.trigger, Epsilon):
            return ""
        if isinstance(noun.trigger, Delay):
            elapsed = (self._history.facts(tick).now - cause.machine.entered) * 1000
            return f", {elapsed:g} ms after `{cause.machine.state[-1]}` was entered"
        evaluation = self._evaluation(state, cause.machine, element, tick)
        if not isinstance(evaluation, Evaluation):
            return ""
        self._keep(draft, evaluation)
        return f", because `{evaluation.decides}` was True{_values(evaluation)}"

    def _condition_false(
        self, draft: _Draft, subject: str, cause: Cause, state: PastState, element: Element, tick: int
    ) -> None:
        test = condition_of(state.program, element)
        assert test is not None
        assert cause.machine is not None
        evaluation = self._evaluation(state, cause.machine, element, tick)
        text = test.block.text.strip() if test.block is not None else ""
        where = f" (line {test.line})" if test.line != _line(state.program, element) else ""
        if isinstance(evaluation, Evaluation):
            self._keep(draft, evaluation)
            whole = f", so `{text}` was" if evaluation.decides != text and len(text) < 80 else ""
            draft.say(
                f"{subject} `{evaluation.decides}`{where} was False{_values(evaluation)}{whole and ''}.",
                test.line,
            )
        else:
            draft.say(f"{subject} `{text}`{where} was False.", test.line)
            draft.say(f"The values of its parts are not known: {_unknown(evaluation)}")
            draft.facts["unknown"] = _unknown(evaluation)
        self._last_true(draft, state, cause.machine, element, tick)

    def _keep(self, draft: _Draft, evaluation: Evaluation) -> None:
        draft.facts["values"] = {text: _plain(value) for text, value in items(evaluation)}
        draft.facts["decides"] = evaluation.decides

    def _delay_not_over(
        self, draft: _Draft, subject: str, cause: Cause, state: PastState, element: Element, tick: int
    ) -> None:
        machine = cause.machine
        noun = transition_of(state.program, element)
        assert machine is not None
        assert noun is not None
        elapsed = (self._history.facts(tick).now - machine.entered) * 1000
        delay = self._delay(state, machine, element, tick)
        of = "" if delay is None else f" of {_number(delay)}"
        how, line = self._entry(machine, tick)
        draft.facts |= {"elapsed": elapsed, "delay": delay}
        draft.say(
            f"{subject} {_number(elapsed)}{of} ms had passed since `{machine.state[-1]}` was entered at "
            f"{machine.entered:g} s{how}.",
            _line(state.program, element),
            line,
        )

    def _delay(self, state: PastState, machine: PastMachine, element: Element, tick: int) -> float | None:
        noun = transition_of(state.program, element)
        amount = noun.trigger.amount if noun and isinstance(noun.trigger, Delay) else None
        if isinstance(amount, int):
            return amount
        value: object
        if isinstance(amount, str):
            cell = machine.cells.get(str(amount))
            value = state.value(cell) if cell is not None else None
        else:
            evaluation = self._evaluation(state, machine, element, tick)
            value = evaluation.value if isinstance(evaluation, Evaluation) else None
        return float(value) if isinstance(value, (int, float)) and value is not True else None

    def _source_inactive(
        self, draft: _Draft, subject: str, cause: Cause, state: PastState, element: Element, tick: int
    ) -> None:
        machine, noun = cause.machine, transition_of(state.program, element)
        assert machine is not None
        assert noun is not None
        how, line = self._entry(machine, tick)
        wanted = "a state other than " if noun.wildcard else ""
        names = noun.sources if not noun.wildcard else (*noun.sources, noun.destination)
        listed = " or ".join(f"`{name}`" for name in names)
        draft.say(
            f"{subject} it leaves {wanted}{listed}, but `{machine.path[-1]}` was in `{machine.state[-1]}`, "
            f"entered at {machine.entered:g} s{how}.",
            line,
        )
        scope = resolve(state.program).by_path.get(element.path[:-1])
        missing = [name for name in noun.sources if scope is not None and name not in scope.states]
        for name in missing if not noun.wildcard else ():
            hint = did_you_mean(str(name), scope.states if scope is not None else ())
            draft.say(f"There is no state `{name}`.{hint}", _line(state.program, element))

    def _machine_not_running(
        self, draft: _Draft, subject: str, cause: Cause, state: PastState, element: Element, tick: int
    ) -> None:
        path = element.path[:-1]
        name = path[-1]
        facts = self._history.facts(tick)
        started = [fact for fact in facts.facts if isinstance(fact, Spawned) and fact.machine[-1] == name]
        spawns = [
            (spawning, state.program.place(spawning.noun.span.start)[0])
            for spawning in resolve(state.program).spawns
            if spawning.machine is not None and spawning.machine.path == path
        ]
        if started:
            by, lines = "when the program started", [line for _, line in spawns]
            if started[0].by:
                by = f"when `{started[0].by[-1]}` was entered"
                lines += [
                    _line(state.program, fact.transition)
                    for fact in facts.fired
                    if fact.path == started[0].by
                ]
            draft.say(f"{subject} `{name}` was only spawned in this tick, {by}.", *lines)
            draft.say("It is tested from the next tick on.")
            return
        restart = [fact for fact in facts.before if isinstance(fact, Commanded) and fact.kind == "restarted"]
        if restart:
            draft.say(f"{subject} the program was restarted before this tick ({restart[-1].text}).")
        for earlier, fact in self._backward(tick):
            if isinstance(fact, Discarded) and fact.machine[-1] == name:
                fired = [
                    each for each in self._history.facts(int(earlier)).fired if _within(fact.machine, each)
                ]
                by, line = "", 0
                if fired:
                    line = _line(self._program_at(int(earlier)), fired[-1].transition)
                    by = f", because `{fired[-1].label}` (line {line}) left `{fired[-1].source[-1]}`"
                draft.say(
                    f"{subject} `{name}` did not run. It ended at {self._time(earlier):g} s{by}.",
                    line,
                )
                break
        else:
            draft.say(f"{subject} `{name}` was not running; it had not been spawned.")
        for spawning, line in spawns:
            spawner = (
                f"when `{spawning.spawner[-1]}` is entered" if spawning.spawner else "when the program starts"
            )
            draft.say(f"It is spawned {spawner} (line {line}).", line)
        if not spawns:
            draft.say(f"No `(spawn {name} …)` starts it.")

    def _other_fired(
        self, draft: _Draft, subject: str, cause: Cause, state: PastState, element: Element, tick: int
    ) -> None:
        fired = cause.fired
        assert fired is not None
        line = _line(state.program, fired.transition)
        what = f"`{fired.label}` (line {line})"
        way = f"from `{fired.source[-1]}` to `{fired.state[-1]}`"
        if cause.code == "earlier-fired":
            text = f"{what} stands before it and fired first, {way}."
        elif cause.code == "outer-fired":
            outer = f"of the outer machine `{fired.machine[-1]}`"
            text = f"{what} {outer} fired first, {way}, and ended this machine."
        else:
            beside = f"the `exit` of `{fired.machine[-1]}` beside it"
            text = f"{what}, {beside}, fired first and took the outer machine to `{fired.state[-1]}`."
        draft.facts["fired"] = fired.transition.path
        draft.say(f"{subject} {text}", line)

    # -- values ----------------------------------------------------------------------------------

    def _evaluation(
        self, state: PastState, machine: PastMachine, element: Element, tick: int
    ) -> Evaluation | Exception | None:
        """Return the test of a transition with its parts: from what is recorded, else by running it again."""
        test = condition_of(state.program, element)
        expression = expression_of(test.block.text) if test is not None and test.block is not None else None
        if test is None:
            return None
        problem: Exception | None = None
        if expression is not None:
            facts = self._history.facts(tick)
            cells = _cells(state, test.machine)
            try:
                return evaluate(
                    expression, self._lookup(cells, state.value, facts.written, self._readings(tick))
                )
            except Exception as error:  # of the expression itself, or a value is not known
                problem = error
        again = self._again(tick, element)
        return problem if again is None else again

    def _readings(self, tick: int) -> Mapping[str, object]:
        moments = self._loop.moments
        return self._loop.bridge.readings_of(moments[tick - self._interpreter.tick - 1][2])

    def _lookup(
        self,
        cells: Mapping[str, CellType],
        value_of: Callable[[CellType], object],
        written: frozenset[int],
        readings: Mapping[str, object],
    ) -> Callable[[str], Any]:
        namespace, nodes = self._interpreter.namespace, self._loop.bridge.nodes.table

        def lookup(name: str) -> Any:
            if name == "robot":
                return RecordedRobot(readings, nodes)
            if name in cells:
                if id(cells[name]) in written:
                    raise UnknownValueError(f"`{name}` was also assigned in this tick.")
                value = value_of(cells[name])
                if value is UNSET:
                    raise NameError(f"`{name}` had no value.")
                if not _is_immutable(value):
                    raise UnknownValueError(f"`{name}` may have been changed in place.")
                return value
            if name in namespace:
                value = namespace[name]
                known = _is_immutable(value) or isinstance(
                    value, (FunctionType, BuiltinFunctionType, ModuleType, type)
                )
                if not known:
                    raise UnknownValueError(f"`{name}` may have been changed since.")
                return value
            if hasattr(builtins, name):
                return getattr(builtins, name)
            raise NameError(f"`{name}` is not defined.")

        return lookup

    def _last_true(
        self, draft: _Draft, state: PastState, machine: PastMachine, element: Element, tick: int
    ) -> None:
        """Say when a condition was true before, whether it was tested then or not."""
        test = condition_of(state.program, element)
        expression = expression_of(test.block.text) if test is not None and test.block is not None else None
        if test is None or expression is None:
            return
        cells = _cells(state, test.machine)
        used = {name: cell for name, cell in cells.items() if name in names_in(expression)}
        end = wall.perf_counter() + _SEARCH
        for earlier, value_of in self._history.values_before(tick):
            if wall.perf_counter() > end:
                return
            try:
                lookup = self._lookup(used, value_of, frozenset(), self._readings(earlier))
                holds = evaluate(expression, lookup).value is True
            except UnknownValueError:
                return
            except Exception:
                continue
            if holds:
                time = self._history.facts(earlier).now
                there = self._history.state(earlier, before=True)
                where = next((each for each in there.walk() if each.state[:-1] == machine.state[:-1]), None)
                draft.facts["last_true"] = earlier
                if where is not None and where.state != machine.state:
                    draft.say(f"It was last true at {time:g} s, when `{where.state[-1]}` was active.")
                else:
                    draft.say(f"It was last true at {time:g} s.")
                return
        if self._history.ticks.start == 1:
            draft.facts["last_true"] = None
            draft.say("It was never true before.")

    def explain(self, name: str | Path, at: int | None = None) -> Reason:
        """Return why a transition did not fire or, if there is no such transition, why a state is active."""
        try:
            return self.why_not(name, at)
        except UnknownElementError as error:
            if "Several" in str(error):
                raise
            try:
                return self.why(name, at)
            except UnknownElementError as other:
                if "Several" in str(other) or path_text(as_path(name)).startswith("robot."):
                    raise
                text = path_text(as_path(name))
                names = [
                    each.shown[-1] for each in resolve(self._interpreter.program).elements() if each.path
                ]
                raise UnknownElementError(
                    f"There is no transition, state or command `{text}`.{did_you_mean(text, names)}"
                ) from None

    # -- states ----------------------------------------------------------------------------------

    def why(self, what: str | Path, at: int | None = None) -> Reason:
        """Return why a state was entered last, or why the robot got its last command (`robot.move`).

        Raises
        ------
        UnknownElementError
            There is no such state or command, or there are several.
        ValueError
            The tick is not recorded.
        """
        text = path_text(as_path(what))
        if text.startswith("robot."):
            return self._command_reason(text.removeprefix("robot."), at)
        tick = self._tick(at)
        path = self._state(what, tick)
        program = self._program_at(tick)
        moments = self._forward(tick, now=at is None)
        for number in range(len(moments) - 1, -1, -1):
            when, fact = moments[number]
            if isinstance(fact, Fired) and fact.state == path:
                return self._entered_by(fact, int(when))
            if isinstance(fact, Entered) and fact.state == path:
                return self._entered_otherwise(fact, when, moments, number)
        del program
        draft, time = _Draft(), self._history.facts(tick).now
        first = self._history.ticks.start
        since = "" if first == 1 else f" since tick {first}, as far as is recorded"
        draft.say(f"`{path[-1]}` has not been entered{since}.", _line_of_state(self._program_at(tick), path))
        for element, noun in _leading_to(self._program_at(tick), path):
            draft.say(str(self._transition_reason(element, tick, self._program_at(tick))), 0)
            draft.lines.append(_line(self._program_at(tick), element))
            del noun
        return draft.reason("never", tick, time)

    def _state(self, wanted: str | Path, tick: int) -> Path:
        paths: list[Path] = []
        for program in (self._program_at(tick), self._interpreter.program):
            known = [
                (*where, str(state.name)) for where, machine in program.walk() for state in machine.states
            ]
            path = as_path(wanted)
            found = [each for each in dict.fromkeys(known) if each == path or each[-1:] == path]
            if len(path) > 1 and not found:
                defined = (*resolve(program).defined(path[:-1]), path[-1])
                found = [each for each in dict.fromkeys(known) if each == defined]
            if len(found) == 1:
                return found[0]
            if found:
                listed = ", ".join(f"`{path_text(each)}`" for each in found)
                raise UnknownElementError(
                    f"Several states are called `{path_text(path)}`. Use one of {listed}."
                )
            paths += known
        text = path_text(as_path(wanted))
        raise UnknownElementError(
            f"There is no state `{text}`.{did_you_mean(text, [each[-1] for each in paths])}"
        )

    def _entered_by(self, fired: Fired, tick: int) -> Reason:
        state = self._history.state(tick, before=True)
        draft, time = _Draft(), self._history.facts(tick).now
        line = _line(state.program, fired.transition)
        machine = next((each for each in state.walk() if each.path == fired.machine), None)
        cause = Cause("fired", machine, fired)
        because = self._since(draft, cause, state, fired.transition, tick)
        draft.say(
            f"`{fired.state[-1]}` was entered at {time:g} s by `{fired.label}` (line {line}), from "
            f"`{fired.source[-1]}`{because}.",
            line,
        )
        test = condition_of(state.program, fired.transition)
        draft.lines.append(test.line if test is not None else 0)
        draft.facts["transition"] = fired.transition.path
        return draft.reason("fired", tick, time)

    def _entered_otherwise(
        self, entered: Entered, when: float, moments: list[tuple[float, Fact]], number: int
    ) -> Reason:
        """Explain an entry without a transition: forced, spawned, or at a restart."""
        name = entered.state[-1]
        tick = max(int(when), 1)
        time = self._time(when)
        program = self._program_at(int(when + 0.5))
        draft = _Draft()
        line = _line_of_state(program, entered.state)
        later = [fact for at, fact in moments[number:] if at == when and when != int(when)]
        forced = next((each for each in later if isinstance(each, Commanded) and each.kind == "forced"), None)
        spawned = next(
            (
                fact
                for at, fact in reversed(moments[:number])
                if at == when and isinstance(fact, Spawned) and fact.machine == entered.path[:-1]
            ),
            None,
        )
        if forced is not None:
            how = "a forced transition" if forced.text == "transition" else "a teleport"
            draft.say(f"`{name}` was entered at {time:g} s by {how}, not by the program.", line)
            return draft.reason("forced", tick, time)
        by = spawned.by if spawned is not None else ()
        spawns = [
            program.place(spawning.noun.span.start)[0]
            for spawning in resolve(program).spawns
            if spawning.machine is not None
            and spawning.machine.path == entered.state[:-1]
            and spawning.noun.state == name
            and (not by or spawning.spawner[-1:] == by[-1:])
            and bool(spawning.spawner) == bool(by)
        ]
        restarted = [
            (at, fact)
            for at, fact in moments[:number]
            if isinstance(fact, Commanded) and fact.kind == "restarted" and int(at) == int(when) - 1
        ]
        at = f"at {time:g} s"
        where = f" (line {spawns[0]})" if spawns else ""
        if restarted and not by:
            why = restarted[-1][1]
            assert isinstance(why, Commanded)
            text = "it was reset" if why.text == "reset" else why.text.rstrip(".")
            starts = f"its `spawn`{where} starts `{entered.state[-2]}` there"
            draft.say(
                f"`{name}` was entered {at} because the program restarted ({text}): {starts}.", *spawns, line
            )
            return draft.reason("restarted", tick, time)
        if by:
            draft.say(
                f"`{name}` was entered {at} because `{by[-1]}` was entered, which spawns "
                f"`{entered.state[-2]}`{where} in this state.",
                *spawns,
                line,
            )
        else:
            draft.say(
                f"`{name}` was entered {at} when the program started: its `spawn`{where} starts "
                f"`{entered.state[-2]}` there.",
                *spawns,
                line,
            )
        return draft.reason("spawned", tick, time)

    def _entry(self, machine: PastMachine, tick: int) -> tuple[str, int]:
        """Return in words how the active state of a machine was entered, and the line."""
        for when, fact in self._backward(tick):
            if isinstance(fact, Fired) and fact.path == machine.full_path:
                line = _line(self._program_at(int(when)), fact.transition)
                return f" by `{fact.label}` (line {line})", line
            if isinstance(fact, Entered) and fact.path == machine.full_path:
                reason = self._entered_otherwise(fact, when, *self._at(when, fact))
                words = {"forced": " by force", "restarted": " at the restart"}
                return words.get(reason.code, f", when `{machine.path[-1]}` started"), reason.line
        return "", 0

    def _at(self, when: float, fact: Fact) -> tuple[list[tuple[float, Fact]], int]:
        moments = self._forward(int(when + 1), now=True)
        number = max(index for index, (at, each) in enumerate(moments) if at == when and each is fact)
        return moments, number

    def _forward(self, tick: int, now: bool) -> list[tuple[float, Fact]]:
        """Return the facts up to a tick in order, each with its tick, plus a half if it came after that."""
        moments: list[tuple[float, Fact]] = []
        for each in self._history.all():
            if each.tick > tick:
                break
            moments += [(each.tick - 0.5, fact) for fact in each.before]
            moments += [(each.tick, fact) for fact in each.facts]
        if now or tick >= self._interpreter.tick:
            moments += [(self._interpreter.tick + 0.5, fact) for fact in self._history.since()]
        return moments

    def _backward(self, tick: int) -> Iterator[tuple[float, Fact]]:
        """Yield the facts before the beginning of a tick, the last one first."""
        for number in range(tick, self._history.ticks.start - 1, -1):
            each = self._history.facts(number)
            if number < tick:
                for fact in reversed(each.facts):
                    yield number, fact
            for fact in reversed(each.before):
                yield number - 0.5, fact

    def _time(self, when: float) -> float:
        """Return the time of a tick, or of the one before what happened between two."""
        return self._history.facts(int(when)).now if int(when) in self._history.ticks else 0.0

    def _program_at(self, tick: int) -> Program:
        return (
            self._history.state(tick, before=True).program
            if tick in self._history.ticks
            else self._interpreter.program
        )

    # -- commands of the robot -------------------------------------------------------------------

    def _command_reason(self, name: str, at: int | None) -> Reason:
        loop, bridge = self._loop, self._loop.bridge
        tick = self._tick(at)
        node = bridge.nodes.table.get(name)
        if not isinstance(node, RobotMethod):
            methods = [each.path for each in bridge.nodes.members() if isinstance(each, RobotMethod)]
            raise UnknownElementError(f"`robot` has no command `{name}`.{did_you_mean(name, methods)}")
        alike = {
            each.path for each in bridge.nodes.members() if isinstance(each, RobotMethod) and each.velocity
        }
        names = alike if node.velocity and name != "stop" else {name}
        records = [each for each in bridge.safety.commands if each.name in names and each.first.tick <= tick]
        time = self._history.facts(tick).now
        draft = _Draft()
        if not records:
            program = self._program_at(tick)
            lines = [
                number
                for number, line in enumerate(program.text.splitlines(), 1)
                if f"robot.{name}" in line.partition(";")[0]
            ]
            text = f" It stands in line {lines[0]}." if lines else " No line of the program has it."
            draft.say(f"`robot.{name}` has not been called.{text}", *lines)
            return draft.reason("never", tick, time)
        last = records[-1]
        origin = last.origin if last.origin.tick <= tick else last.first
        call = call_text(last.name, last.arguments)
        state = origin.block.partition(".")[0]
        where = f"`{origin.block}` (line {origin.line})" if origin.block else "a command given by hand"
        since = f", repeated since {self._time(last.first.tick):g} s" if last.first.tick < origin.tick else ""
        draft.facts |= {
            "command": last.name,
            "arguments": dict(_flat(last.arguments)),
            "block": origin.block,
            "state": state,
            "since": last.first.tick,
            "limited": last.limited,
        }
        draft.say(
            f"The last command was {call}, given by {where} at {self._time(origin.tick):g} s{since}.",
            origin.line,
        )
        code = "limited" if last.limited else "commanded"
        for sentence in last.limited:
            draft.say(sentence)
        stopped = self._stopped_after(origin.tick, tick, at is None)
        watchdog = [
            each
            for each in bridge.safety.notices
            if each.kind == "command watchdog" and last.now < each.now <= loop.now
        ]
        if not last.sent:
            code = "disarmed" if not bridge.safety.armed else "stopped"
            draft.say(
                "It was not sent, because the robot is disarmed."
                if code == "disarmed"
                else "It was not sent."
            )
        elif watchdog and (at is None or watchdog[-1].now <= time + 1e-9):
            code = "watchdog"
            draft.say(f"The robot was stopped at {watchdog[-1].now:g} s: {watchdog[-1].text}")
        elif stopped:
            code = "stopped"
            draft.say(stopped)
        return draft.reason(code, tick, time)

    def _stopped_after(self, origin: int, tick: int, now: bool) -> str:
        """Say what stopped the robot after a command of a tick; empty if nothing did."""
        for when, fact in reversed(self._forward(tick, now)):
            if when <= origin:
                break
            if isinstance(fact, Commanded) and fact.kind == "paused":
                why = self._loop.reason if now else ""
                return f"Then the program was paused, which stops the robot. {why}".strip()
            if isinstance(fact, Commanded) and fact.kind == "restarted":
                why = "it was reset" if fact.text == "reset" else fact.text.rstrip(".")
                return f"Then the program was restarted ({why}), which stops the robot."
        return ""


def tick_of(loop: Loop, time: float) -> int:
    """Return the last recorded tick that was not after a time, in seconds of the run."""
    times = [moment[0] for moment in loop.moments]
    tick = loop.interpreter.tick - len(times) + bisect_right(times, time + 1e-9)
    return max(tick, loop.interpreter.history.ticks.start)


_WRITERS: dict[str, Callable[..., None]] = {
    "fired": Answers._fired,
    "condition-false": Answers._condition_false,
    "delay-not-over": Answers._delay_not_over,
    "source-inactive": Answers._source_inactive,
    "machine-not-running": Answers._machine_not_running,
    "earlier-fired": Answers._other_fired,
    "outer-fired": Answers._other_fired,
    "exit-took-parent": Answers._other_fired,
}


def _cells(state: PastState, machine: Path) -> Mapping[str, CellType]:
    """Return the variables in the scope of a machine that ran, or of the top level."""
    found = next((each for each in state.walk() if each.state[:-1] == machine), None)
    return state.cells if found is None else found.cells


def _is_immutable(value: object) -> bool:
    if isinstance(value, tuple):
        return all(map(_is_immutable, value))
    return isinstance(value, _IMMUTABLE)


def _within(machine: Path, fired: Fired) -> bool:
    """Return whether a machine was inside the state that a transition left."""
    home = fired.path[:-1]
    return machine[: len(home)] == home


def _leading_to(program: Program, state: Path) -> Iterator[tuple[Element, object]]:
    scope = resolve(program).by_path.get(state[:-1])
    for arrow in resolve(program).arrows[scope] if scope is not None else ():
        if arrow.noun.destination == state[-1] and not arrow.noun.outward:
            yield arrow.element, arrow.noun


def _shown(program: Program, element: Element) -> str:
    arrow = _arrow(program, element)
    return arrow.label if arrow is not None else element.shown[-1]


def _line(program: Program, element: Element) -> int:
    noun = transition_of(program, element)
    return program.place(noun.span.start)[0] if noun is not None else 0


def _line_of_state(program: Program, path: Path) -> int:
    scope = resolve(program).by_path.get(path[:-1])
    noun = scope.states.get(path[-1]) if scope is not None else None
    return program.place(noun.span.start)[0] if noun is not None else 0


def _values(evaluation: Evaluation) -> str:
    """Say the values of the parts of what decides."""
    tree = parse_python(evaluation.decides, mode="eval").body
    parts = [ast.unparse(node) for node in ast.walk(tree) if isinstance(node, ast.expr)]
    shown = [
        f"`{text}` was {_rounded(value, tree)}"
        for text, value in items(evaluation)
        if text in parts and text != evaluation.decides
    ]
    return f", since {_and(shown)}" if shown else ""


def _rounded(value: object, tree: ast.expr) -> str:
    """Return a value as text; a number with six digits, unless it is compared for equality."""
    exact = any(isinstance(node, (ast.Eq, ast.NotEq)) for node in ast.walk(tree))
    if isinstance(value, Shown):
        return str(value)
    return f"{value:.6g}" if type(value) is float and not exact else short(value)


def _and(texts: list[str]) -> str:
    return " and ".join([", ".join(texts[:-1]), texts[-1]] if len(texts) > 1 else texts)


def _unknown(evaluation: Evaluation | Exception | None) -> str:
    if isinstance(evaluation, UnknownValueError):
        return str(evaluation)
    return (
        sentence_of(evaluation)
        if isinstance(evaluation, Exception)
        else "the block is more than one expression."
    )


def _plain(value: object) -> object:
    if isinstance(value, Shown):
        return str(value)
    return value if isinstance(value, (bool, int, float, str, type(None))) else short(value)


def _number(value: float) -> str:
    return f"{round(value, 3):g}" if abs(value) < 1e6 else f"{value:.0f}"


def call_text(name: str, arguments: Mapping[str, Any]) -> str:
    """Return a command of the robot as a program writes it."""
    return f"`robot.{name}({', '.join(f'{key}={_plain(value)}' for key, value in _flat(arguments))})`"


def _flat(arguments: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the arguments of a command that are not zero, with dotted names."""
    for name, value in arguments.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{prefix}{name}.")
        elif value != 0:
            yield f"{prefix}{name}", value
