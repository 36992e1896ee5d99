"""A machine started alone: it runs as ever, and the machines around it only have their variables."""

import re
from dataclasses import replace

import pytest
from support.story import HERE, PERIOD, active, no_label, read, robot, started
from support.tables import every

from lrp_jupyter.errors import LRPError, UnknownElementError
from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Name, Spawn, path_text
from lrp_jupyter.language.resolution import resolve

STORIES = [read(path.read_text(encoding="utf-8")) for path in sorted((HERE / "programs").glob("*.lrp"))]
NESTED = """
(var n := [0])
(machine m
  (var k := [n + 2])
  (event much [n > 6])
  (state a
    (onentry [n = 100] (spawn t x))
    (running [n = 200])
    (onexit [n = 300])
    (machine t
      (state x (running [n += k]))
      (state y (onexit [n = -n]))
      (on much x -> y)
      (exit much y -> b out)))
  (state b (onentry [n = 400]))
  (ontime 100 a -> b)
  (ontime 0 b -> a))
(spawn m a)
"""


def bare(machine, path, names):
    """A machine without actions and transitions, which only spawns what is next on a path of names."""
    states = []
    for state in machine.states:
        machines, spawns = state.machines, ()
        if path and state.name == path[0]:
            inner, first, *rest = path[1:]
            spawns = (Spawn(Name(inner), Name(first)),)
            for each in names.spawns:
                if each.spawner[-2:] == (machine.name, state.name) and each.noun.machine == inner:
                    spawns = (replace(each.noun, state=Name(first)),)
            machines = tuple(
                bare(each, [first, *rest], names) if rest and each.name == inner else each
                for each in machines
            )
        states.append(replace(state, onentry=spawns, running=(), onexit=(), machines=machines))
    return replace(machine, states=tuple(states), transitions=())


def by_hand(program, place, state):
    """The program in which the machines around one machine are bare, and which spawns nothing else."""
    root, *path = *place, state
    spawn = next(each for each in program.spawns if each.machine == root)
    machines = tuple(
        bare(each, path, resolve(program)) if len(place) > 1 and each.name == root else each
        for each in program.machines
    )
    return replace(program, machines=machines, spawns=(replace(spawn, state=Name(path[0])),))


def values(i):
    return re.sub(r" at 0x\w+", "", str(dict(i.variables)))


def cases():
    for story in STORIES:
        program = parse(story.text)
        names, roots = resolve(program), {str(each.machine) for each in program.spawns}
        for scope in names.scopes:
            if scope.noun and (place := names.places(scope.path)[0])[0] in roots:
                ways = [names.defined(place[:end]) for end in range(1, len(place), 2)]
                if all(
                    place[: len(way)] == way for way in ways
                ):  # those around it are where they are defined
                    yield from ((story, program, place, state) for state in scope.states)


def test_a_machine_alone_runs_as_one_among_machines_that_do_nothing():
    count = 0
    for story, program, place, state in cases():
        bots, count = (robot(), robot()), count + 1
        alone = Interpreter(program, bots[0], start=(*place, state))
        other = Interpreter(by_hand(program, place, state), bots[1])
        events = [], []
        for i, seen in zip((alone, other), events, strict=True):
            i.observe(
                lambda e, seen=seen: seen.append((e.kind, e.path)) if e.kind in ("fired", "entered") else None
            )
        for tick in range(1, story.last_tick + 10):
            for i, bot in zip((alone, other), bots, strict=True):
                for name, value in story.inputs.get(tick, ()):
                    setattr(bot, name, value)
                i.step((tick - 1) * PERIOD)
            if alone.active and all(each[: len(place)] != place for each in alone.active):
                break  # it has left by its `exit`, and the one among bare machines may be spawned again
            where = f"{path_text(place)}/{state}, tick {tick}, in\n{story.text}"
            assert alone.active == other.active, where
            assert values(alone) == values(other), where
        kept = [[no_label(each) for each in seen if each[1][: len(place)] == place] for seen in events]
        assert kept[0] == kept[1][: len(kept[0])]
    assert count > 100


def test_the_machines_around_it_have_their_variables_and_do_nothing():
    i = started(NESTED, 5, start="t")
    assert (active(i), dict(i.variables)) == (["m/a/t/y"], {("n",): 8, ("m", "k"): 2})
    assert set(i.visits) == {("m", "a", "t", "x"), ("m", "a", "t", "y")}
    assert not i.countdowns


def test_its_exit_leads_the_machine_around_it_to_a_state_where_nothing_happens():
    i = started(NESTED, 20, start="m/a/t")
    assert (active(i), dict(i.variables), [*i.issues]) == (["m/b"], {("n",): -8, ("m", "k"): 2}, [])
    assert i.firings[("m", "a", "t", "out")].times == 1


@every(
    ("start", "begins", "at"),
    [
        ("m", "m/a/t/x", "m"),
        ("m/b", "m/b", "m/b"),
        ("b", "m/b", "m/b"),
        ("t", "m/a/t/x", "m/a/t"),
        ("m/a/t", "m/a/t/x", "m/a/t"),
        (("m", "a", "t"), "m/a/t/x", "m/a/t"),
        ("m/a/t/y", "m/a/t/y", "m/a/t/y"),
        ("y", "m/a/t/y", "m/a/t/y"),
    ],
)
def test_it_is_named_as_elements_are_everywhere(start, begins, at):
    i = started(NESTED, start=start)
    assert (active(i), i.start) == ([begins], tuple(at.split("/")))


USED_TWICE = """
(machine m
  (var v := [2])
  (state left (onentry (spawn go slow (var speed := [v * 10]))))
  (state right (onentry (spawn go fast (var speed := [7])) (spawn rest r)))
)
(machine go (var speed := [1]) (state slow) (state fast))
(machine rest (state r))
(machine lone (state l1) (state l2))
(spawn m left)
"""


@every(
    ("start", "begins", "speed"),
    [
        ("m/left/go", "m/left/go/slow", 20),
        ("m/right/go", "m/right/go/fast", 7),
        ("m/right/go/slow", "m/right/go/slow", 7),
        ("go/slow", "go/slow", 1),
    ],
)
def test_a_machine_that_is_used_twice_has_what_is_set_at_its_place(start, begins, speed):
    i = started(USED_TWICE, start=start)
    assert active(i) == [begins]
    assert i.variables["speed"] == speed


@every(
    ("start", "error", "message"),
    [
        (
            "xyz",
            UnknownElementError,
            "There is no machine or state `xyz`. There are: `m`, `go`, `rest`, `lone`,",
        ),
        ("m/left/goo", UnknownElementError, "no machine or state `m/left/goo`."),
        (
            "slow",
            UnknownElementError,
            "Several states are called `slow`. Use one of `m/left/go/slow`, `m/right/go/slow`.",
        ),
        (
            "go",
            LRPError,
            "`go` (line 7) is spawned in several states. To start it alone, name one of `go/slow`, `go/fast`",
        ),
        (
            "lone",
            LRPError,
            "`lone` (line 9) is never spawned. To start it alone, name one of `lone/l1`, `lone/l2`.",
        ),
        (3, TypeError, "start"),
    ],
)
def test_what_cannot_be_started_alone_is_an_error_that_says_what_can(start, error, message):
    with pytest.raises(error) as raised:
        Interpreter(parse(USED_TWICE), start=start)
    assert message in str(raised.value)


def test_a_reset_starts_it_again_in_the_same_way():
    i = started(NESTED, 20, start="m/a/t/y")
    i.reset()
    assert active(i) == []
    i.step(3)
    assert (active(i), i.variables["n"]) == (["m/a/t/y"], 0)


def test_edits_and_renames_keep_it():
    i = started(NESTED, 2, start="m/a/t")
    i.rename("machine", "m/a/t", "tool")
    i.rename("state", "m/a", "busy")
    assert (i.start, active(i)) == (("m", "busy", "tool"), ["m/busy/tool/x"])
    patch = i.patch(parse(i.program.text.replace("[n = 200]", "[n = 201]").replace("[n = 100]", "")))
    assert (patch.applied, patch.restarted, active(i)) == (True, False, ["m/busy/tool/x"])  # they do not run
    patch = i.patch(parse(i.program.text.replace("(running [n += k])", "(running [n += 2 * k])")))
    assert (patch.restarted, patch.reason) == (True, "`x` is active and its `running` changed.")
    i.step(1)
    assert (active(i), i.variables["n"]) == (["m/busy/tool/x"], 4)
    i.renew(i.program, 3)
    i.step(3)
    assert active(i) == ["m/busy/tool/x"]


def test_an_undone_rename_is_undone_for_it_too():
    i = started(NESTED, 2, start="m/a/t")
    i.rename("machine", "m/a/t", "tool")
    i.step(0.2)
    i.rewind(2)
    assert i.start == ("m", "a", "t")
    i.reset()
    i.step(0.3)
    assert active(i) == ["m/a/t/x"]


def test_an_edit_that_removes_it_waits_and_says_why():
    i = started(NESTED, 2, start="m/a/t")
    other = NESTED.replace("(machine t", "(machine tt")
    patch = i.patch(parse(other))
    assert not patch.applied
    assert patch.reason == (
        "The machine `t` is active but missing from the new text, where `m/a/t` cannot start. "
        "The old program keeps running."
    )
    i.reset()
    i.patch(parse(other))  # now nothing is active
    i.step(1)
    assert active(i) == []
    assert [(each.code, each.message) for each in i.issues if not each.resolved] == [
        ("LRP605", "There is no machine `m/a/t` to start alone.")
    ]
    i.patch(parse(NESTED))
    i.step(2)
    assert active(i) == ["m/a/t/x"]
    assert all(each.resolved for each in i.issues)


def test_a_state_can_be_forced_before_and_while_it_runs():
    i = Interpreter(parse(NESTED), robot(), start="m/a/t")
    i.teleport_to("m/a/t/y")
    i.step(0)
    assert (active(i), i.variables["n"]) == (["m/a/t/y"], 0)
    i.transition_to("m/b")
    i.step(1)
    assert (active(i), i.variables["n"]) == (["m/b"], 0)  # `y` was left, and `b` was not entered
    i.transition_to("m/a/t/x")
    i.step(2)
    assert (active(i), i.variables["n"]) == (["m/a/t/x"], 2)


def test_a_snapshot_continues_it():
    i = started(NESTED, 2, start="m/a/t")
    other = Interpreter(parse(""), robot())
    other.begin(i.snapshot())
    for tick in range(2, 20):
        i.step(tick * PERIOD)
        other.step(tick * PERIOD)
        assert (i.active, dict(i.variables)) == (other.active, dict(other.variables))
    assert other.start == ("m", "a", "t")
    assert active(other) == ["m/b"]
