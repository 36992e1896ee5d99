"""Why a transition fired in a tick, or did not, in sentences: one function for each kind of cause."""

from __future__ import annotations

from lrp_jupyter.errors import did_you_mean, ended
from lrp_jupyter.interpreter.facts import Enabled, Entered, Faulted, Fired
from lrp_jupyter.interpreter.history import PastState
from lrp_jupyter.interpreter.tick_reasons import cause_in
from lrp_jupyter.language.blocks.expressions import Evaluation
from lrp_jupyter.language.lookup import line_of_element
from lrp_jupyter.language.program import Element, Path, Program
from lrp_jupyter.language.resolution import resolve
from lrp_jupyter.language.triggers import Delay, Epsilon, InState
from lrp_jupyter.live.reason import Reason
from lrp_jupyter.live.why.answer_draft import AnswerDraft
from lrp_jupyter.live.why.case import Case
from lrp_jupyter.live.why.elements import line_of
from lrp_jupyter.live.why.entries import enabled_in, entry_text, how_entered
from lrp_jupyter.live.why.evaluation import delay_of, evaluate_again, last_true, watched_machine
from lrp_jupyter.live.why.machines import not_running
from lrp_jupyter.live.why.recorded_run import RecordedRun
from lrp_jupyter.live.why.task_states import tell_of_tasks
from lrp_jupyter.live.why.wording import (
    block_text,
    decided_text,
    listed,
    number_text,
    plain_values,
    time_text,
    unknown_text,
    values_text,
)


def transition_reason(run: RecordedRun, element: Element, known: Program, tick: int) -> Reason:
    """Return why a transition, which the `known` program has, fired in a tick, or did not."""
    state = run.state(tick)
    instance = run.instance and run.instance[0]
    since = _since(run, state, element, instance, tick)
    facts = run.history.facts(tick)
    cause = cause_in(state, facts, element, instance, holds=since is not None)
    arrow = resolve(known).arrow(element)
    label = arrow.label if arrow is not None else element.shown[-1]
    line = line_of_element(known if cause.code == "not-in-program" else state.program, element)
    case = Case(run, element, label, line, tick, cause, since)
    draft = AnswerDraft({"transition": element.path, "state": cause.machine and cause.machine.full_path})
    match cause.code:
        case "fired":
            _fired(draft, case)
        case "condition-false":
            _condition_false(draft, case)
        case "delay-not-over":
            _delay_not_over(draft, case)
        case "source-inactive":
            _source_inactive(draft, case)
        case "just-entered":
            _just_entered(draft, case)
        case "machine-not-running":
            not_running(draft, run, case.element.path[:-1], tick, case.did_not_fire)
        case "earlier-fired" | "outer-fired" | "exit-took-parent":
            _other_fired(draft, case)
        case "not-in-program":
            draft.say(f"The program of tick {tick} (at {time_text(case.time)}) had no transition `{label}`.")
        case _:
            _failed(draft, case)
    draft.lines.append(line)
    return draft.reason(cause.code, tick, case.time)


def _since(
    run: RecordedRun, state: PastState, element: Element, instance: Path | None, tick: int
) -> float | None:
    """Return since when a trigger that has to hold for some time held at the end of a tick; None if not."""
    arrow = resolve(state.program).arrow(element)
    machine = state.machine(element.path[:-1], instance)
    if arrow is None or arrow.noun.hold is None or machine is None:
        return None
    after = run.history.state(tick).machine(element.path[:-1], machine.path)
    return None if after is None else after.holding.get(element.path[-1])


def because(draft: AnswerDraft, case: Case) -> str:
    """Say what made a transition fire, as the end of a sentence, and add the values to the draft."""
    trigger = case.noun.trigger
    if case.cause.machine is None or isinstance(trigger, Epsilon):
        return ""
    if isinstance(trigger, Delay):
        return f", {number_text(case.elapsed)} ms after `{case.machine.state[-1]}` was entered"
    hold = case.noun.hold
    long = f" for {number_text(delay)} ms" if hold and (delay := delay_of(case, hold)) is not None else ""
    if isinstance(trigger, InState):
        return f", because `{trigger.machine}` was in `{trigger.state}`{long}"
    evaluation = evaluate_again(case)
    if not isinstance(evaluation, Evaluation):
        return f", because it had been True{long}" if long else ""
    _keep(draft, evaluation)
    return f", because `{evaluation.decides}` was {decided_text(evaluation)}{values_text(evaluation)}{long}"


def _keep(draft: AnswerDraft, evaluation: Evaluation) -> None:
    draft.facts |= {
        "values": plain_values(evaluation),
        "decides": evaluation.decides,
        "decided": decided_text(evaluation),
    }


def _fired(draft: AnswerDraft, case: Case) -> None:
    fired = case.cause.fact
    assert isinstance(fired, Fired)
    way = f"from `{fired.source}` to `{fired.destination}`"
    draft.say(f"{case.did_fire}, {way}{because(draft, case)}.")
    tell_of_tasks(draft, case)


def _condition_false(draft: AnswerDraft, case: Case) -> None:
    if isinstance(case.noun.trigger, InState):
        _in_another_state(draft, case, case.noun.trigger)
        return
    assert case.tested is not None
    line, where = _line_and_place(case)
    evaluation = evaluate_again(case)
    if isinstance(evaluation, Evaluation):
        _keep(draft, evaluation)
        was = f"was {decided_text(evaluation)}{values_text(evaluation)}"
        draft.say(f"{case.did_not_fire}: `{evaluation.decides}`{where} {was}.", line)
        tell_of_tasks(draft, case)
        _last_true(draft, case, "It" if evaluation.is_whole else "The whole condition")
    else:
        unknown = draft.facts["unknown"] = unknown_text(evaluation)
        draft.say(f"{case.did_not_fire}: {block_text(case.tested[0])}{where} was False.", line)
        draft.say(f"The values of its parts are not known: {unknown}")
        _last_true(draft, case, "It")


def _in_another_state(draft: AnswerDraft, case: Case, trigger: InState) -> None:
    """Say in which state the machine was, for whose state a transition waits, and how it came there."""
    machine = watched_machine(case)
    if machine is None:
        draft.facts["values"] = {f"{trigger.machine}.state": None}
        draft.say(f"{case.did_not_fire}: `{trigger.machine}` was not running.")
        return
    state = machine.state[-1]
    how, line = entry_text(case.run, machine, case.tick)
    draft.facts["values"] = {f"{trigger.machine}.state": state}
    draft.say(
        f"{case.did_not_fire}: `{trigger.machine}` was in `{state}`, not in `{trigger.state}`. It entered "
        f"`{state}` at {time_text(machine.entered)}{how}.",
        line,
    )


def _line_and_place(case: Case) -> tuple[int, str]:
    """Return the line of the test, and a description of it if the transition is in another line."""
    line = line_of(case.program, case.tested[0] if case.tested is not None else None)
    return line, f" (line {line})" if line != case.line else ""


def _last_true(draft: AnswerDraft, case: Case, what: str) -> None:
    """Say when a condition, called `what`, was last true before."""
    run, (tick, first) = case.run, last_true(case)
    entry = _last_enabled(case, first if tick is None else tick + 1)
    if entry is not None:
        draft.facts["last_true"], state = entry
        draft.say(f"{what} was last true at {time_text(run.time(entry[0]))}, when `{state}` was entered.")
        return
    if tick is None:
        if first == 1:
            draft.facts["last_true"] = None
            draft.say(f"{what} was never true before.")
        elif first < case.tick:
            draft.facts["false_since"] = first
            draft.say(f"{what} was not true at any time still recorded (since {time_text(run.time(first))}).")
        return
    draft.facts["last_true"] = tick
    here = run.names(tick).of("state", case.machine.state, case.tick)
    machines = run.state(tick).walk()
    same = [each.state for each in machines if run.is_same(case.machine.path, case.tick, each.path, tick)]
    other = [each for each in same if each[:-1] == here[:-1] and each != here]
    elsewhere = f", when `{other[0][-1]}` was active" if other else ""
    edited = ", before an edit made it the condition" if _had_another(case, tick) else ""
    draft.say(f"{what} was last true at {time_text(run.time(tick))}{elsewhere}{edited}.")


def _last_enabled(case: Case, first: int) -> tuple[int, str] | None:
    """Return the last tick since `first` in which it was enabled on entry of its state, and that state.

    Its condition was tested then with values in the middle of a tick.
    """
    run, condition = case.run, _condition(case.program, case.element)
    for when, fact in run.backward(case.tick, before=True):
        if when < first:
            break
        if isinstance(fact, Enabled):
            tick = int(when)
            then = run.names(tick).of("transition", case.element.path, case.tick)
            if (
                fact.transition.path == then
                and run.is_same(case.machine.path, case.tick, fact.machine, when)
                and _condition(run.program(tick), fact.transition) == condition
            ):
                return tick, fact.state[-1]
    return None


def _condition(program: Program, transition: Element) -> str | None:
    arrow = resolve(program).arrow(transition)
    return None if arrow is None or arrow.tested is None else arrow.tested[0].text.strip()


def _had_another(case: Case, tick: int) -> bool:
    """Return whether a transition had another condition in a tick, which was tested there and was false."""
    run = case.run
    state = run.state(tick)
    then = Element("transition", run.names(tick).of("transition", case.element.path, case.tick))
    facts = run.history.facts(tick)
    instance = None if run.instance is None else case.machine.path
    if cause_in(state, facts, then, instance).code != "condition-false":
        return False
    return _condition(state.program, then) not in (None, _condition(case.program, case.element))


def _delay_not_over(draft: AnswerDraft, case: Case) -> None:
    noun, machine = case.noun, case.machine
    trigger = noun.trigger if isinstance(noun.trigger, Delay) else noun.hold
    assert trigger is not None
    delay = delay_of(case, trigger)
    of = "" if delay is None else f" of {number_text(delay)}"
    if case.since is not None:
        draft.facts |= {"elapsed": case.elapsed, "delay": delay}
        draft.say(
            f"{case.did_not_fire}: its condition has to be True for some time, and only "
            f"{number_text(case.elapsed)}{of} ms had passed since it became True at {time_text(case.since)}.",
            case.line,
        )
        return
    how, line = entry_text(case.run, machine, case.tick)
    draft.facts |= {"elapsed": case.elapsed, "delay": delay}
    draft.say(
        f"{case.did_not_fire}: only {number_text(case.elapsed)}{of} ms had passed since "
        f"`{machine.state[-1]}` was entered at {time_text(machine.entered)}{how}.",
        case.line,
        line,
    )


def _source_inactive(draft: AnswerDraft, case: Case) -> None:
    machine, noun = case.machine, case.noun
    how, line = entry_text(case.run, machine, case.tick)
    other = "a state other than " if noun.wildcard else ""
    names = (*noun.sources, noun.destination) if noun.wildcard else noun.sources
    sources = listed([f"`{name}`" for name in dict.fromkeys(names)], "or")
    draft.say(
        f"{case.did_not_fire}: it leaves {other}{sources}, but `{machine.path[-1]}` was in "
        f"`{machine.state[-1]}`, entered at {time_text(machine.entered)}{how}.",
        line,
    )
    scope = resolve(case.program).by_path.get(case.element.path[:-1])
    if scope is None or noun.wildcard:
        return
    for name in noun.sources:
        if name not in scope.states:
            draft.say(f"There is no state `{name}`.{did_you_mean(str(name), scope.states)}", case.line)


def _just_entered(draft: AnswerDraft, case: Case) -> None:
    entered = case.cause.fact
    assert isinstance(entered, (Fired, Entered))
    how, line = how_entered(case.run, entered, case.tick)
    name = entered.state[-1]
    draft.say(f"{case.did_not_fire}: `{name}` was entered in this very tick{how}.", line)
    draft.say("A state is left in the tick after its entry at the earliest.")
    if any(each.transition == case.element for each in enabled_in(case.run, entered, case.tick)):
        draft.facts["enabled"] = True
        draft.say(f"`{case.label}` was enabled, so `{name}` did not act.")


def _other_fired(draft: AnswerDraft, case: Case) -> None:
    fired = case.cause.fact
    assert isinstance(fired, Fired)
    line = line_of_element(case.program, fired.transition)
    what, way = f"`{fired.label}` (line {line})", f"from `{fired.source}` to `{fired.destination}`"
    match case.cause.code:
        case "earlier-fired":
            text = f"{what} comes first in the text and fired, {way}"
        case "outer-fired":
            outer = f"of the outer machine `{fired.machine[-1]}`"
            text = f"{what} {outer} fired first, {way}, and ended this machine"
        case _:
            beside = f"the `exit` of the sibling machine `{fired.machine[-1]}`"
            text = f"{what}, {beside}, fired first and took the outer machine to `{fired.state[-1]}`"
    draft.facts["fired"] = fired.transition.path
    draft.say(f"{case.did_not_fire}: {text}.", line)


def _failed(draft: AnswerDraft, case: Case) -> None:
    """Say that a fault prevented the transition, and what the fault says."""
    fault = case.cause.fact
    assert isinstance(fault, Faulted)
    what, line = case.did_not_fire, case.line
    if case.tested is not None:
        line, where = _line_and_place(case)
        noun = "delay" if isinstance(case.noun.trigger, Delay) else "condition"
        what += f": its {noun} is {block_text(case.tested[0])}{where}"
    if case.cause.code == "unknown-destination":
        what = f"{case.did_not_fire}: it was enabled, but leads nowhere"
    draft.facts["message"] = fault.message
    draft.say(f"{what}. {ended(fault.message)}", line)
