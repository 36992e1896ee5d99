"""How a state was entered other than by a transition: by force, at a restart, or because it was spawned."""

from __future__ import annotations

from collections.abc import Iterable

from lrp_jupyter.interpreter.facts import Commanded, Enabled, Entered, Fact, Fired, Spawned
from lrp_jupyter.interpreter.history import PastMachine
from lrp_jupyter.language.lookup import line_of_element
from lrp_jupyter.language.resolution import resolve
from lrp_jupyter.live.reason import Reason, StateCode
from lrp_jupyter.live.why.answer_draft import AnswerDraft
from lrp_jupyter.live.why.elements import line_of, line_of_state, spawns_of
from lrp_jupyter.live.why.recorded_run import RecordedRun
from lrp_jupyter.live.why.wording import restart_text, time_text


def entered_otherwise(run: RecordedRun, entered: Entered, called: str, when: float) -> Reason:
    """Return why a state was entered without a transition; `called` is its name in the answer."""
    *_, machine, name = entered.state
    tick, program = max(int(when), 1), run.program(int(when + 0.5))
    time = run.entered(entered.path, when)
    draft = AnswerDraft()
    line = line_of_state(program, entered.state)
    was_entered = f"{called} was entered at {time_text(time)}"
    facts = run.history.facts(when)
    place = max(index for index, fact in enumerate(facts) if fact is entered)
    command = next((fact for fact in facts[place:] if isinstance(fact, Commanded)), None)
    if command is not None and command.kind == "forced":
        draft.say(f"{was_entered} by hand ({command.text}), not by the program.", line)
        return draft.reason("forced", tick, time)
    spawned = [
        fact for fact in facts[:place] if isinstance(fact, Spawned) and fact.machine == entered.path[:-1]
    ]
    by = spawned[-1].by if spawned else ()
    spawner = (*resolve(program).defined(by[:-1]), by[-1]) if by else ()
    lines = [
        line_of(program, spawning.noun)
        for spawning in spawns_of(program, entered.state[:-1])
        if spawning.noun.state == name and spawning.spawner == spawner
    ]
    where = f" (line {lines[0]})" if lines else ""
    spawn = f"`(spawn {machine} {name})`{where}"
    starts = f"{spawn} starts it there"
    if not by and run.loop.interpreter.start is not None:
        lines, starts = [], f"`{machine}` is started alone"
    restart = restart_of(run.history.facts(when - 0.5))
    code: StateCode = "spawned"
    if command is not None:
        why = f"because an edit added {spawn}"
    elif by:
        why = f"because `{by[-1]}` was entered, and its {starts}"
    elif restart is not None:
        code = "restarted"
        why = f"because the program restarted ({restart_text(restart)}): {starts}"
    elif tick == 1:
        why = f"when the program started: {starts}"
    else:
        why = f"because {starts}"
    draft.say(f"{was_entered} {why}.", *lines, line)
    say_whether_it_acted(draft, run, entered, when)
    return draft.reason(code, tick, time)


def restart_of(before: Iterable[Fact]) -> Commanded | None:
    """Return the last restart among the facts before a tick; None if there was none."""
    restarts = [fact for fact in before if isinstance(fact, Commanded) and fact.kind == "restarted"]
    return restarts[-1] if restarts else None


def entry_text(run: RecordedRun, machine: PastMachine, tick: int) -> tuple[str, int]:
    """Return a description of how the active state of a machine was entered before a tick, and the line."""
    names = run.names(tick)
    for when, fact in run.backward(tick, before=True):
        if (
            isinstance(fact, (Fired, Entered))
            and names.of("state", fact.state, when) == machine.state
            and run.is_same(machine.path, tick, fact.path[:-1], when)
        ):
            return how_entered(run, fact, when)
    return "", 0


def how_entered(run: RecordedRun, entered: Fired | Entered, when: float) -> tuple[str, int]:
    """Return a description of how a state was entered, and the line."""
    if isinstance(entered, Fired):
        line = line_of_element(run.program(int(when)), entered.transition)
        return f" by `{entered.label}` (line {line})", line
    reason = entered_otherwise(run, entered, "", when)
    words = {"forced": " by hand", "restarted": " at the restart"}
    return words.get(reason.code, f", when `{entered.path[-2]}` started"), reason.line


def enabled_in(run: RecordedRun, entered: Fired | Entered, tick: int) -> list[Enabled]:
    """Return the transition, if any, that kept a state from acting in the tick in which it was entered.

    It leaves the state, or an enclosing one that was entered in the same tick.
    """
    enabled = [fact for fact in run.history.facts(tick) if isinstance(fact, Enabled)]
    way = entered.path
    return [each for each in enabled if way[: len(each.machine) + 1] == (*each.machine, each.state[-1])]


def say_whether_it_acted(draft: AnswerDraft, run: RecordedRun, entered: Fired | Entered, when: float) -> None:
    """Say that a state did not act in the tick of its entry, if a transition could leave it at once."""
    tick = int(when)
    for enabled in enabled_in(run, entered, tick) if tick == when else ():
        line = line_of_element(run.program(tick), enabled.transition)
        left, is_own = f"`{enabled.state[-1]}`", enabled.state == entered.state
        what = "it at once, so it did not act" if is_own else f"{left} at once, so nothing in {left} acted"
        draft.say(f"`{enabled.label}` (line {line}) could leave {what}.", line)
