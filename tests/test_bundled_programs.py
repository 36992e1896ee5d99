import math
import sys
from pathlib import Path

import cloudpickle
import pytest
from support.tables import every

from lrp_jupyter import programs
from lrp_jupyter.errors import LRPError
from lrp_jupyter.grading.challenges import Challenge
from lrp_jupyter.grading.criteria import (
    Criterion,
    drives,
    ends_still,
    enters,
    no_faults,
    pushes,
    stays_in,
    touches,
)
from lrp_jupyter.grading.grade import grade
from lrp_jupyter.language.checks import check
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.printer import to_source
from lrp_jupyter.language.program import Block, Spawn
from lrp_jupyter.live.session import Session
from lrp_jupyter.sim.worlds import load as load_world

NAMES = (
    "box-pusher",
    "convoy",
    "edge-guard",
    "escapement",
    "exit",
    "follower",
    "follower-paper",
    "paper-listing",
    "stopwatch",
    "two-machines",
    "wall-follower",
)


def goes_around(size):
    """All four corners of a room are approached."""

    def look(run):
        corners = {
            (round(s.x / size[0]), round(s.y / size[1]))
            for s in run.samples
            if min(s.x, size[0] - s.x) < 0.6 and min(s.y, size[1] - s.y) < 0.6
        }
        return len(corners) == 4, f"it came near {len(corners)} corners"

    return Criterion("goes around the room", look)


def keeps_its_distance(run):
    """The second robot follows the first, near it and without touching it, wherever it goes."""
    names = {name for sample in run.samples for name in sample.touched}
    return "follower" not in names, f"the leader touched {names}"


cloudpickle.register_pickle_by_value(sys.modules[__name__])  # a process that grades cannot import a test
NOISE = {"motor": 0.02, "light": 5}
GOALS = {
    "box-pusher": (30, pushes("box", "goal"), enters("done"), ends_still(1)),
    "convoy": (60, Criterion("keeps its distance", keeps_its_distance), drives(6), enters("back")),
    "edge-guard": (90, stays_in("inside"), drives(5), enters("waiting"), enters("turning")),
    "escapement": (5, enters("turning"), enters("right")),
    "exit": (60, enters("finished"), drives(2)),
    "follower": (70, touches("far wall", "near wall"), enters("end"), ends_still(1)),
    "follower-paper": (300, touches("far wall", "near wall"), enters("end"), ends_still(1)),
    "paper-listing": (400, touches("far wall", "near wall"), enters("end"), ends_still(1)),
    "two-machines": (30, drives(2), enters("resting"), ends_still(1)),
    "wall-follower": (120, drives(8), goes_around((3, 2)), enters("veering")),
}


def test_the_bundled_programs_are_known_by_name():
    assert programs.names() == NAMES


@every("name", NAMES)
def test_a_bundled_program_has_no_findings(name):
    assert check(programs.load(name)) == ()


@every("name", NAMES)
def test_a_bundled_program_describes_what_it_does_and_where(name):
    heading = programs.heading(programs.load(name))
    assert heading.description.endswith(".")
    assert len(heading.description) <= 100
    assert heading.world == "none" or load_world(heading.world)


@every("name", NAMES)
def test_a_bundled_program_survives_printing(name):
    program = parse(programs.load(name))
    assert parse(to_source(program)) == program


@pytest.mark.parametrize(
    ("name", "seeds"),
    [
        pytest.param(name, seeds, marks=pytest.mark.slow if seeds > 1 or goal[0] > 100 else ())
        for name, goal in GOALS.items()
        for seeds in (1, 3)
    ],
)
def test_a_bundled_program_reaches_its_goal_with_every_seed(name, seeds):
    seconds, *criteria = GOALS[name]
    text = programs.load(name)
    task = Challenge(
        name, "", (programs.heading(text).world,), (*criteria, no_faults()), seconds, noise=NOISE
    )
    result = grade(text, task, seeds=seeds)
    assert result.passed, str(result)


def test_the_second_hand_goes_round_in_a_minute():
    with Session(programs.load("escapement"), "sim", world="empty", seed=1, noise=NOISE) as session:
        session.run(60.9)
        turned = -session.call(lambda: session.bridge.robot.gyro.data)
        assert session.frame.variables["wheel", "teeth"] == "60"
        assert turned == pytest.approx(2 * math.pi, abs=0.1)


def test_the_stopwatch_shows_a_lap_and_the_whole_time():
    with Session(programs.load("stopwatch")) as session:
        session.run(40)
        lines = str(session.output).splitlines()
        assert lines[:4] == ["lap 5.1", "lap 7.2", "stopped at 11.6", "lap 5.1"]
        assert not session.issues
        session.start()
        session.pause()
        session.resume()
        paused, resumed = str(session.output).splitlines()[-2:]
        assert paused.startswith("paused at ")
        assert resumed == "running on"


def test_a_changed_stroke_of_the_pen_is_live_and_restarts_nothing():
    text = programs.load("two-machines")
    with Session(text, "sim", world="empty") as session:
        session.run(3)
        session.edit(text.replace("[400]", "[800]"))
        assert session.frame.restarts == 0
        assert session.run(60, until="resting")
        assert session.frame.time > 30


# -- every form of the language


def _forms(program):
    for name in ("variables", "events", "spawns", "onpause", "onresume"):
        if getattr(program, name):
            yield f"{name} of the program"
    if len(program.spawns) > 1:
        yield "several spawns"
    for path, machine in program.walk():
        yield f"machine at depth {min(len(path) // 2, 1)}"
        for name in ("variables", "events"):
            if getattr(machine, name):
                yield f"{name} of a machine"
        for transition in machine.transitions:
            yield from _forms_of_transition(transition)
        for state in machine.states:
            yield "empty state" if not (state.onentry or state.running or state.onexit) else "state"
            yield from (f"{part} of a state" for part in ("running", "onexit") if getattr(state, part))
            yield from ("spawn in onentry" for item in state.onentry if isinstance(item, Spawn))
            yield from ("block in onentry" for item in state.onentry if isinstance(item, Block))
            if len([item for item in state.onentry if isinstance(item, Spawn)]) > 1:
                yield "several spawns in onentry"
            if len(state.onexit) > 1:
                yield "several blocks"


def _forms_of_transition(transition):
    trigger = transition.trigger
    what = type(getattr(trigger, "amount", trigger)).__name__
    yield f"{transition.kind} with {what}"
    if transition.wildcard:
        yield "from every state but these" if transition.sources else "from every state"
    else:
        yield "from one of several states" if len(transition.sources) > 1 else "from one state"
        if len(transition.sources) > 1 and transition.destination in transition.sources:
            yield "into one of its sources"
    yield "named" if transition.name else "unnamed"


FORMS = {
    "variables of the program", "events of the program", "spawns of the program", "onpause of the program",
    "onresume of the program", "several spawns", "machine at depth 0", "machine at depth 1",
    "variables of a machine", "events of a machine", "empty state", "state", "running of a state",
    "onexit of a state", "spawn in onentry", "block in onentry", "several spawns in onentry",
    "several blocks", "on with Occurrence", "on with Condition", "ontime with int", "ontime with Name",
    "ontime with Block", "eps with Epsilon", "exit with Occurrence", "exit with Condition", "from one state",
    "from one of several states", "from every state", "from every state but these",
    "into one of its sources", "named", "unnamed",
}  # fmt: skip


def test_the_bundled_programs_together_use_every_form_of_the_language():
    used = {form for name in NAMES for form in _forms(parse(programs.load(name)))}
    assert used == FORMS


# -- headings


def test_a_heading_ends_where_the_program_begins():
    text = "\n;; Waits.\n#\n; World: oval\n; more\n(machine m (state a)) ; world: line"
    assert programs.heading(text) == ("Waits.", "oval", None)
    assert programs.heading("; world: line\n; Challenge:  there and back\n").challenge == "there and back"
    assert programs.heading("; world: mine.json") == ("", "mine.json", None)
    assert programs.heading("(machine m (state a))") == ("", None, None)
    assert programs.heading("\ufeff; Waits.") == ("Waits.", None, None)


@pytest.mark.parametrize("world", ["a.json", "b/a.json", "oval"])
def test_a_heading_names_a_world_or_a_file_of_the_folder(world):
    read = programs.world_of(f"; world: {world}", Path("at"))
    assert read == (f"at/{world}" if world.endswith("json") else world)


OTHERS = ("//host/x.json", "/etc/x.json", "C:x.json", "c:/x.json", "../x.json", "a/../../x.json", "a/b")


@pytest.mark.parametrize("world", [*OTHERS, r"\\host\x.json"])
def test_a_heading_opens_no_other_file(world):
    for folder in (Path("at"), None):
        with pytest.raises(LRPError, match="Line 2 names the world"):
            programs.world_of(f"; Waits.\n; world: {world}", folder)


def test_an_unknown_program_is_answered_with_the_nearest():
    with pytest.raises(LRPError, match=r"Did you mean `follower`\?"):
        programs.load("folower")
