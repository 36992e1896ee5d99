"""Laws: whatever the program, the edits, the commands and the inputs."""

from types import SimpleNamespace

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from support.reference import Reference
from support.story import ORDINARY, no_label
from support.wild import command, moment, obey, program

from lrp_jupyter.errors import UnknownElementError
from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.interpreter.trace_events import EVENT_KINDS
from lrp_jupyter.language.edits.rename import symbols
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.resolution import resolve

slow = settings(suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])


@pytest.mark.slow
@slow
@given(program, st.lists(st.sampled_from([0, 1]), max_size=30))
def test_production_does_what_the_reference_does(text, lights):
    p = parse(text)
    robots = [SimpleNamespace(light=0) for _ in range(4)]
    production, reference, seen = Interpreter(p, robots[0]), Reference(p, robots[1]), []
    quiet, bare = Interpreter(p, robots[2]), Interpreter(p, robots[3], journal=0)
    production.observe(
        lambda event: seen.append((event.kind, event.path)) if event.kind in ORDINARY else None
    )
    for tick, light in enumerate(lights):
        for robot, i in zip(robots, (production, reference, quiet, bare), strict=True):
            robot.light = light
            i.step(tick / 10)
        assert production.active == reference.active, f"after tick {tick + 1}"
        assert moment(production)[1] == reference.variables, f"after tick {tick + 1}"
        assert list(map(no_label, seen)) == list(map(no_label, reference.events)), f"in tick {tick + 1}"
        assert moment(production) == moment(quiet) == moment(bare), "when nobody watches"
        seen.clear()
        reference.events.clear()


def active_exists(i):
    for root in i._run.roots:
        for act in root.walk():
            assert i._run.plan.machines[act.machine.path].states[act.state.name] is act.state
            assert act.row.state is act.state


@slow
@example("(var n := [0])(machine m (state a))(spawn m a)", [("step", 0), ("teleport_to", ("m", "a"))], True)
@given(program, st.lists(command, max_size=40), st.booleans())
def test_no_command_and_no_edit_stops_it(text, orders, keep):
    robot, seen = SimpleNamespace(light=0), []
    i = Interpreter(parse(text), robot, on_active_edit="keep" if keep else "restart")
    i.observe(seen.append)
    for order in orders:
        before = moment(i)
        try:
            obey(i, robot, order)
        except (UnknownElementError, SyntaxError, NameError, ValueError):
            if order[0] not in ("transition_to", "teleport_to", "fire", "set_variable", "rewind", "rename"):
                raise
            assert moment(i) == before, "what failed changed nothing"
        active_exists(i)
    assert {event.kind for event in seen} <= set(EVENT_KINDS)


@pytest.mark.slow
@slow
@given(program, st.lists(command, max_size=25), st.integers(1, 5))
def test_going_back_restores_the_moment_after_every_tick(text, orders, back):
    robot = SimpleNamespace(light=0)
    i = Interpreter(parse(text), robot)
    moments = [((), {}, text)]
    for order in orders:
        if order[0] == "rewind":
            continue
        try:
            obey(i, robot, order)
        except (UnknownElementError, SyntaxError, NameError, ValueError):
            continue
        if order[0] == "step":
            moments.append((*moment(i), i.program.text))
    back = min(back, len(moments) - 1)
    i.rewind(back)
    assert (*moment(i), i.program.text) == moments[-1 - back]
    active_exists(i)


@slow
@given(program, st.integers(1, 8), st.integers(1, 8))
def test_going_back_and_on_again_is_the_straight_run(text, first, more):
    straight, winding = (
        Interpreter(parse(text), SimpleNamespace(light=1)),
        Interpreter(parse(text), SimpleNamespace(light=1)),
    )
    for tick in range(first + more):
        straight.step(tick / 10)
        winding.step(tick / 10)
    winding.rewind(more)
    for tick in range(first, first + more):
        winding.step(tick / 10)
    assert moment(winding) == moment(straight)


@pytest.mark.slow
@slow
@given(program, st.integers(0, 8), st.integers(1, 8), st.integers(0, 99))
def test_a_rename_changes_nothing_but_a_name(text, first, more, number):
    runs = [Interpreter(parse(text), SimpleNamespace(light=1)) for _ in range(2)]
    steps(runs, 0, first)
    kinds = ("state", "machine", "event", "variable")
    found = [each.element for each in symbols(parse(text))[0] if each.element.kind in kinds]
    element = found[number % len(found)]
    if element.kind == "state" and ".state" in text:
        return  # a block may compare its name
    try:
        runs[1].rename(element.kind, element.path, "fresh")
    except ValueError:
        return
    for tick in range(first, first + more):
        (active, values), new = moment(runs[0]), moment(runs[1])
        old = [tuple(element.path[-1] if part == "fresh" else part for part in path) for path in new[0]]
        assert tuple(old) == active
        assert {
            tuple(element.path[-1] if part == "fresh" else part for part in path): value
            for path, value in new[1].items()
        } == values
        steps(runs, tick, tick + 1)


def steps(runs, first, last):
    for i in runs:
        for tick in range(first, last):
            i.step(tick / 10)


@slow
@given(program, st.integers(1, 12))
def test_watching_every_test_changes_nothing(text, ticks):
    plain, watched = runs = [Interpreter(parse(text), SimpleNamespace(light=1)) for _ in range(2)]
    elements = [arrow.element for arrows in resolve(plain.program).arrows.values() for arrow in arrows]
    for tick in range(ticks):
        for element in elements:
            for machine in [act.path for act in watched._run.walk()]:
                watched.watch_test(element, machine, lambda _: None)
        steps(runs, tick, tick + 1)
        assert moment(watched) == moment(plain)


@pytest.mark.slow
@slow
@given(program, program, st.integers(0, 5))
def test_an_edit_and_its_inverse_keep_what_was_not_touched(one, other, ticks):
    i = Interpreter(parse(one), SimpleNamespace(light=0))
    for tick in range(ticks):
        i.step(tick / 10)
    before = moment(i)
    same = i.patch(parse(one + "\n; a comment"))
    assert (same.applied, same.restarted, moment(i)) == (True, False, before)
    patch = i.patch(parse(other))
    if not patch.applied:
        assert moment(i) == before
    elif not patch.restarted:
        assert i.active[: len(before[0])] == before[0] or len(i.active) != len(before[0])
