"""Why a machine was not running: what ended it, and what starts it."""

from __future__ import annotations

from lrp_jupyter.interpreter.facts import Commanded, Discarded, Entered, Fired, Spawned
from lrp_jupyter.language.lookup import line_of_element
from lrp_jupyter.language.program import Path, path_text
from lrp_jupyter.language.resolution import resolve
from lrp_jupyter.live.why.answer_draft import AnswerDraft
from lrp_jupyter.live.why.elements import line_of, spawns_of
from lrp_jupyter.live.why.entries import restart_of
from lrp_jupyter.live.why.recorded_run import RecordedRun
from lrp_jupyter.live.why.wording import listed, restart_text, time_text


def not_running(draft: AnswerDraft, run: RecordedRun, path: Path, tick: int, so: str) -> None:
    """Say why a machine, by path of definition, was not running when a tick began, after the words `so`."""
    name, program = path[-1], run.program(tick)
    facts = run.history.facts(tick)
    spawns = spawns_of(program, path)
    if run.instance is not None:
        around = resolve(program).around(run.instance[0])
        spawns = [spawning for spawning in spawns if spawning.spawner in around[-1:]]
    for fact in facts:
        if isinstance(fact, Spawned) and fact.defined == path and run.means(fact.machine, tick):
            lines = [line_of(program, spawning.noun) for spawning in spawns]
            if fact.by:
                by = f"when `{fact.by[-1]}` was entered"
                entering = [each for each in facts if isinstance(each, Fired) and each.path == fact.by]
                lines += [line_of_element(program, each.transition) for each in entering]
            else:
                restart = restart_of(run.history.facts(tick - 0.5))
                by = f"when the program {'restarted' if restart else 'started'}"
            entered = [each for each in facts if isinstance(each, Entered)]
            starts = [each.state[-1] for each in entered if each.path[:-1] == fact.machine]
            where = f" in `{starts[0]}`" if starts else ""
            draft.say(f"{so}: `{name}` was spawned{where} in this very tick, {by}.", *lines)
            return
    draft.say(f"{so}: `{name}` was not running.")
    start = run.loop.interpreter.start or ()
    if path in (resolve(program).defined(start[:end]) for end in range(1, len(start) - 1, 2)):
        draft.say(f"Only `{path_text(start)}`, which is inside it, was started.")
        return
    _how_it_ended(draft, run, path, tick)
    lines = [line_of(program, spawning.noun) for spawning in spawns]
    names = [spawning.state for spawning in spawns]
    whens = [
        f"when `{name if names.count(name) == 1 else path_text(spawning.spawner)}` is entered (line {line})"
        if name
        else f"when the program starts (line {line})"
        for spawning, name, line in zip(spawns, names, lines, strict=True)
    ]
    if whens:
        draft.say(f"It is spawned {listed(whens, 'or')}.", *lines)
    else:
        draft.say(f"No `(spawn {name} …)` starts it.")


def _how_it_ended(draft: AnswerDraft, run: RecordedRun, path: Path, tick: int) -> None:
    """Say how a machine that was not running had ended, or that it had never run."""
    names = run.names(tick)
    restart: tuple[float, Commanded] | None = None  # the first one after the current fact
    for when, fact in run.backward(tick, before=True):
        if isinstance(fact, Commanded) and fact.kind == "restarted":
            restart = when, fact
        elif isinstance(fact, (Discarded, Spawned)) and (
            names.of("machine", fact.defined, when) != path or not run.means(fact.machine, when)
        ):
            continue
        elif isinstance(fact, Discarded):
            by, line = _what_discarded(run, fact, when)
            draft.say(f"It ended at {time_text(run.time(when))}{by}.", line)
            return
        elif isinstance(fact, Spawned):
            if restart is not None:  # otherwise it was removed from the program
                at, command = restart
                why = restart_text(command)
                draft.say(f"It ended at {time_text(run.time(at))}, when the program restarted ({why}).")
            return
    first = run.history.ticks.start
    draft.say("It had never been spawned." if first == 1 else f"It has not been spawned since tick {first}.")


def _what_discarded(run: RecordedRun, discarded: Discarded, when: float) -> tuple[str, int]:
    """Return a description of what ended a machine, and the line if it was a transition."""
    if int(when) != when:
        return ", by hand", 0
    for fired in [fact for fact in reversed(run.history.facts(when)) if isinstance(fact, Fired)]:
        home = fired.path[:-1]
        if discarded.machine[: len(home)] == home != discarded.machine:
            line = line_of_element(run.program(int(when)), fired.transition)
            return f", because `{fired.label}` (line {line}) left `{discarded.machine[len(home)]}`", line
    return "", 0
