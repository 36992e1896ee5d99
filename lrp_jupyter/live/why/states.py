"""Why a state is active: how it was last entered."""

from __future__ import annotations

from lrp_jupyter.interpreter.facts import Entered, Fired
from lrp_jupyter.interpreter.tick_reasons import Cause
from lrp_jupyter.language.lookup import line_of_element
from lrp_jupyter.language.program import Path
from lrp_jupyter.live.reason import Reason
from lrp_jupyter.live.why.answer_draft import AnswerDraft
from lrp_jupyter.live.why.case import Case
from lrp_jupyter.live.why.elements import arrows_to, line_of, line_of_state
from lrp_jupyter.live.why.entries import entered_otherwise, say_whether_it_acted
from lrp_jupyter.live.why.machines import not_running
from lrp_jupyter.live.why.recorded_run import RecordedRun
from lrp_jupyter.live.why.task_states import tell_of_tasks
from lrp_jupyter.live.why.transitions import because, transition_reason
from lrp_jupyter.live.why.wording import time_text


def state_reason(run: RecordedRun, state: Path, name: str, tick: int) -> Reason:
    """Return why a state, as defined in a tick and asked for by a name, was last entered before its end."""
    names = run.names(tick)
    for when, fact in run.backward(tick):
        if (
            isinstance(fact, (Fired, Entered))
            and names.of("state", fact.state, when) == state
            and run.means(fact.path[:-1], when)
        ):
            then = fact.state[-1]
            called = f"`{name}`" if name == then else f"`{name}` (then called `{then}`)"
            called += run.where(fact.path[:-1], when)
            if isinstance(fact, Fired):
                return _entered_by(run, fact, called, int(when))
            return entered_otherwise(run, fact, called, when)
    return _never_entered(run, state, name, tick)


def _entered_by(run: RecordedRun, fired: Fired, called: str, tick: int) -> Reason:
    before = run.state(tick)
    machine = next((each for each in before.walk() if each.path == fired.machine), None)
    line = line_of_element(before.program, fired.transition)
    case = Case(run, fired.transition, fired.label, line, tick, Cause("fired", machine, fired))
    draft = AnswerDraft({"transition": fired.transition.path})
    by = f"`{fired.label}` (line {line}), from `{fired.source}`{because(draft, case)}"
    block = case.tested[0] if case.tested is not None else None
    draft.say(
        f"{called} was entered at {time_text(case.time)} by {by}.", line, line_of(before.program, block)
    )
    tell_of_tasks(draft, case)
    say_whether_it_acted(draft, run, fired, tick)
    return draft.reason("fired", tick, case.time)


def _never_entered(run: RecordedRun, state: Path, name: str, tick: int) -> Reason:
    """Say so, and why its machine was not running or the transitions to the state did not fire."""
    program, ticks, time = run.program(tick), run.history.ticks, run.time(tick)
    line = line_of_state(program, state)
    draft = AnswerDraft()
    instance = run.instance and run.instance[0]
    machine = run.state(tick).machine(state[:-1], instance)
    called = f"`{name}`{run.where(instance or (), tick)}"
    if machine is not None and machine.state == state:
        entered = f"{called} was entered at {time_text(machine.entered)}."
        draft.say(f"{entered} How is unknown: only ticks from {ticks.start} onward are remembered.", line)
        return draft.reason("never", tick, time)
    so = f"{called} has not been entered"
    if tick != ticks[-1]:
        so = f"{called} had not been entered by {time_text(time)}"
    if ticks.start > 1:
        so += f" (only ticks from {ticks.start} onward are remembered)"
    if not line:
        draft.say(f"{so}. The program of tick {tick} had no such state.")
    elif machine is None:
        not_running(draft, run, state[:-1], tick, so)
        draft.lines.append(line)
    else:
        draft.say(f"{so}.", line)
        arrows = [*arrows_to(program, state)]
        for arrow in arrows:
            reason = transition_reason(run, arrow.element, program, tick)
            draft.say(str(reason), line_of(program, arrow.noun))
        if not arrows:
            draft.say("No transition leads to it.")
    return draft.reason("never", tick, time)
