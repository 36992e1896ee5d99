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
    touches_nothing,
    visits,
)
from lrp_jupyter.grading.grade import grade
from lrp_jupyter.language.blocks.block import words_of
from lrp_jupyter.language.blocks.builtin_names import TIMES
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.printer import to_source
from lrp_jupyter.language.program import Block, Spawn
from lrp_jupyter.language.resolution import resolve
from lrp_jupyter.live.running.checking import check
from lrp_jupyter.live.running.frame import is_active
from lrp_jupyter.live.session import Session
from lrp_jupyter.sim.worlds import load as load_world

NAMES = (
    "box-pusher",
    "convoy",
    "courier",
    "edge-guard",
    "escapement",
    "exit",
    "follower",
    "follower-paper",
    "garage-door",
    "guide",
    "hand-over",
    "paper-listing",
    "patrol",
    "stopwatch",
    "sweeper",
    "transport",
    "two-machines",
    "waiter",
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


def enters_often(state, times):
    """A state is entered this often."""

    def look(run):
        active = [is_active(state, sample.active) for sample in run.samples]
        entered = sum(now and not before for before, now in zip([False, *active], active, strict=False))
        return entered >= times, f"`{state}` was entered {entered} times"

    return Criterion(f"enters `{state}` {times} times", look)


def sees_every_cell(run):
    """The middle of the robot comes into all cells of the maze."""
    cells = {(int(sample.x / 0.5), int(sample.y / 0.5)) for sample in run.samples}
    return len(cells) == 20, f"it was in {len(cells)} cells"


cloudpickle.register_pickle_by_value(sys.modules[__name__])  # a process that grades cannot import a test
NOISE = {"motor": 0.02, "light": 5}
GOALS = {
    "box-pusher": (30, pushes("box", "goal"), enters("done"), ends_still(1)),
    "convoy": (60, Criterion("keeps its distance", keeps_its_distance), drives(6), enters("back")),
    "courier": (75, enters_often("handing", 3), enters("sorry"), enters("backing"), drives(5)),
    "edge-guard": (90, stays_in("inside"), drives(5), enters("waiting"), enters("turning")),
    "escapement": (5, enters("turning"), enters("right")),
    "exit": (60, enters("finished"), drives(2)),
    "follower": (70, touches("far wall", "near wall"), enters("end"), ends_still(1)),
    "follower-paper": (300, touches("far wall", "near wall"), enters("end"), ends_still(1)),
    "garage-door": (20, enters_often("opening", 3), enters("stuck"), touches_nothing(), ends_still(1)),
    "guide": (30, enters_often("showing", 3), enters("over"), touches_nothing(), ends_still(1)),
    "hand-over": (60, Criterion("keeps its distance", keeps_its_distance), enters_often("handing", 3)),
    "paper-listing": (400, touches("far wall", "near wall"), enters("end"), ends_still(1)),
    "patrol": (260, drives(20), enters_often("charging", 3), visits("right", "left", "right")),
    "sweeper": (150, Criterion("sees every cell", sees_every_cell), touches_nothing(), enters("done")),
    "transport": (40, pushes("box", "goal"), enters("done"), ends_still(1)),
    "two-machines": (30, drives(2), enters("resting"), ends_still(1)),
    "waiter": (150, enters_often("loading", 5), drives(10), touches_nothing()),
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
    assert not [line for line in programs.load(name).splitlines() if line.startswith(";") and "**" in line]


@every("name", NAMES)
def test_a_bundled_program_survives_printing(name):
    program = parse(programs.load(name))
    assert parse(to_source(program)) == program


@pytest.mark.slow
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


def _driving(name):
    text = programs.load(name)
    return Session(text, "sim", world=programs.heading(text).world, seed=1, noise=NOISE)


@pytest.mark.parametrize("name", ["patrol", "waiter"])
def test_the_trail_shows_the_machine_that_drives_and_not_one_beside_it(name):
    """It has the colours of the machine that is spawned first."""
    with _driving(name) as session:
        session.run(40)
        first = session.frame.active[0][0]
        assert len([state for machine, *state in session.frame.visits if machine == first]) > 1


def test_the_transporter_begins_again_and_asks_for_help_when_its_box_is_gone():
    with _driving("transport") as session:
        session.run(6)
        session.bridge.place_solid(0, (1.8, 1, 0))
        session.run(2)
        assert session.frame.variables["mission/working/deliver/pushing/push/again"] == "1"
        session.bridge.place_solid(0, (1.2, 1.75, 0))
        assert session.run(60, until="backing")
        assert session.frame.variables["mission/working/deliver/starts"] == "2"
        assert session.run(90, until="waiting")
        assert session.call(lambda: session.bridge.simulation.robot.memory.lamp)
        session.bridge.place_solid(0, (1.1, 1, 0))
        assert session.run(60, until="done")
        assert "delivered at start 1" in str(session.output)
        assert not session.issues


def test_the_garage_door_closes_when_it_is_freed_and_bears_a_nervous_finger():
    with _driving("garage-door") as session:
        session.run(30, until="stuck")
        session.bridge.place_solid(0, (1.2, 1.5, 0))
        session.set_variable("button", True)
        assert session.run(20, until="closed")
        session.set_variable("button", True)
        session.run(0.5)
        assert session.frame.is_active("closed")
        session.run(1)
        assert session.frame.is_active("opening")
        session.set_variable("button", True)
        session.run(5)
        assert session.frame.is_active("opening")
        assert not session.issues


def test_the_waiter_loses_no_order_when_the_way_is_blocked():
    with _driving("waiter") as session:
        session.run(10)
        session.bridge.place_robot((0.3, 0.2, 0))  # so that every table is behind the edge of the world
        assert session.run(40, until="backing")
        assert session.variables["queue"][0] == session.variables["table"] == "A"
        assert session.variables["served"] == []
        assert not session.issues


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("garage-door", "[200]", "[500]"),
        ("hand-over", "[0.35]", "[0.2]"),
        ("patrol", "[95]", "[60]"),
        ("sweeper", "[0.3])              ; m/s", "[0.2])"),
        ("transport", "[3]", "[5]"),
        ("waiter", '"A": (1.1, 0.6)', '"A": (1.1, 0.1)'),
    ],
)
def test_what_the_programs_with_patterns_say_to_change_restarts_nothing(name, old, new):
    with _driving(name) as session:
        session.run(16)
        assert session.text.count(old) == 1
        session.edit(session.text.replace(old, new))
        session.run(30)
        assert session.frame.restarts == 0
        assert not session.issues


def test_a_table_that_is_moved_is_found_and_a_low_battery_leads_home():
    with _driving("waiter") as session:
        session.run(60, until="serving")
        session.edit(session.text.replace('"A": (1.1, 0.6)', '"A": (1.1, -0.1)'))
        place = session.bridge.robot.odom
        session.run(60, until="idle")
        assert session.call(lambda: (place.x, place.y)) == pytest.approx((1.1, -0.1), abs=0.1)
    with _driving("patrol") as session:
        session.run(10)
        session.set_variable("battery", 30)
        session.run(0.4)
        assert session.frame.is_active("patrolling")
        session.run(0.3)
        assert session.frame.is_active("homing")


# -- every form of the language


def _forms(program):
    for name in ("variables", "events", "spawns", "onpause", "onresume", "onend"):
        if getattr(program, name):
            yield f"{name} of the program"
    if len(program.spawns) > 1:
        yield "several spawns"
    for placed in resolve(program).all_blocks:
        for word in words_of(placed.block):
            if word in TIMES:
                yield f"{word} in a block"
            elif placed.event(word):
                yield "an event in a block"
            elif placed.machines(word):
                yield "a machine in a block"
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
            for item in state.onentry:
                if isinstance(item, Spawn):
                    yield "spawn with settings in onentry" if item.settings else "spawn in onentry"
            yield from ("block in onentry" for item in state.onentry if isinstance(item, Block))
            if len([item for item in state.onentry if isinstance(item, Spawn)]) > 1:
                yield "several spawns in onentry"
            if len(state.onexit) > 1:
                yield "several blocks"


def _forms_of_transition(transition):
    trigger = transition.trigger
    what = type(getattr(trigger, "amount", trigger)).__name__
    yield f"{transition.kind} with {what}"
    if transition.hold:
        yield f"for {type(transition.hold.amount).__name__} after {what}"
    if transition.effect:
        yield "several effects" if len(transition.effect) > 1 else "effect"
    if transition.wildcard:
        yield "from every state but these" if transition.sources else "from every state"
    else:
        yield "from one of several states" if len(transition.sources) > 1 else "from one state"
        if len(transition.sources) > 1 and transition.destination in transition.sources:
            yield "into one of its sources"
    yield "named" if transition.name else "unnamed"


FORMS = {
    "variables of the program", "events of the program", "spawns of the program",
    "onpause of the program", "onresume of the program", "onend of the program", "several spawns",
    "machine at depth 0", "machine at depth 1", "variables of a machine", "events of a machine",
    "empty state", "state",
    "running of a state", "onexit of a state", "spawn in onentry", "spawn with settings in onentry",
    "block in onentry", "several spawns in onentry", "several blocks", "elapsed in a block",
    "dt in a block", "an event in a block", "a machine in a block", "on with Occurrence",
    "on with Condition", "on with InState", "for int after Occurrence", "for int after Condition",
    "for Name after Occurrence", "ontime with int", "ontime with Name", "ontime with Block",
    "eps with Epsilon", "exit with Occurrence", "exit with Condition", "effect", "several effects",
    "from one state", "from one of several states", "from every state", "from every state but these",
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
