import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.tables import every

from lrp_jupyter.sim import BUNDLED, Simulation, World, WorldError, load
from lrp_jupyter.sim.world import (
    ArcStroke,
    BoxSolid,
    BoxZone,
    CircleStroke,
    CircleZone,
    DiscSolid,
    FloorSpec,
    Noise,
    PathStroke,
    RobotSpec,
)
from lrp_jupyter.sim.world_reading import read_world
from lrp_jupyter.sim.worlds import DESCRIPTIONS

SMALLEST = {"version": 1, "size": [3, 2], "robots": [{"pose": [1, 1, 0]}]}
COMPLETE = {
    "version": 1,
    "size": [3, 2],
    "seed": 0,
    "floor": {"grey": 255, "strokes": [{"path": [[0.4, 1], [2.6, 1]], "width": 0.03, "grey": 0}]},
    "solids": [{"box": [2.63, 1, 0.06, 0.3], "angle": 0}, {"box": [1, 0.5, 0.1, 0.1], "push": 0.3}],
    "robots": [
        {"pose": [0.7, 1, 0], "radius": 0.08, "light": [[0.06, 0]], "bumper": True, "distance": [[0, 2.0]]}
    ],
    "zones": {"goal": {"circle": [2.4, 1, 0.1]}},
}

number = st.floats(-5, 5)
positive = st.floats(0.01, 5)
angle = st.floats(-3, 3)
point = st.tuples(number, number)
grey = st.floats(0, 255)
strokes = st.one_of(
    st.builds(PathStroke, st.lists(point, min_size=1, max_size=4).map(tuple), positive, grey),
    st.builds(
        ArcStroke, st.tuples(number, number, positive, st.floats(-3, 3), st.floats(-3, 3)), positive, grey
    ),
    st.builds(CircleStroke, st.tuples(number, number, positive), positive, grey),
)
push = st.none() | st.floats(0, 2)
solids = st.one_of(
    st.builds(BoxSolid, st.tuples(number, number, positive, positive), number, push, st.text(max_size=3)),
    st.builds(DiscSolid, st.tuples(number, number, positive), number, push),
)
zones = st.one_of(
    st.builds(BoxZone, st.tuples(number, number, positive, positive)),
    st.builds(CircleZone, st.tuples(number, number, positive)),
)
robots = st.builds(
    RobotSpec,
    st.tuples(st.floats(0, 1), st.floats(0, 1), number),
    radius=st.floats(0.01, 1),
    light=st.lists(point, max_size=2).map(tuple),
    bumper=st.booleans(),
    distance=st.lists(st.tuples(number, positive), max_size=2).map(tuple),
    limits=st.tuples(positive, positive),
    wheels=st.tuples(st.floats(0.1, 2), st.floats(0.1, 2)),
    noise=st.builds(
        Noise, motor=st.floats(0, 1), light=st.floats(0, 50), odom=st.floats(0, 1), dropout=st.floats(0, 1)
    ),
)
worlds = st.builds(
    World,
    size=st.tuples(st.floats(1, 9), st.floats(1, 9)),
    robots=st.lists(robots, min_size=1, max_size=2).map(tuple),
    floor=st.builds(FloorSpec, grey, st.lists(strokes, max_size=3).map(tuple)),
    solids=st.lists(solids, max_size=3).map(tuple),
    zones=st.dictionaries(st.text(max_size=3), zones, max_size=2),
    seed=st.integers(),
    open=st.booleans(),
    name=st.text(max_size=3),
)


@given(worlds)
def test_json_loses_nothing(world):
    assert read_world(json.loads(world.to_json())) == world


def test_the_documented_form_is_read():
    world = load(COMPLETE)
    assert world.solids == (BoxSolid((2.63, 1, 0.06, 0.3)), BoxSolid((1, 0.5, 0.1, 0.1), push=0.3))
    assert world.zones["goal"].contains(2.45, 1.05)
    assert load(world.to_dict()) == world


@every("name", BUNDLED)
def test_a_bundled_world_has_a_small_json_form_and_runs(name):
    world = load(name)
    assert world.name == name
    assert DESCRIPTIONS[name].endswith(".")
    assert load(world.to_dict()) == world
    assert len(world.to_json()) < 2000
    simulation = Simulation(name)
    simulation.step(10)
    assert simulation.robot.pose == pytest.approx(world.robots[0].pose)  # nothing stands in its way


def test_a_world_is_loaded_from_a_file(tmp_path):
    path = tmp_path / "mine.json"
    path.write_text(load("line").to_json(indent=2))
    assert load(path) == load(str(path)) == load("line")


def test_an_existing_world_is_used_as_it_is():
    world = load("oval")
    assert load(world) is world


@every(
    ("change", "message"),
    [
        (
            {"solids": [{"box": [1, 1, 1, 1]}, {}]},
            "`solids[1]`: Expected one of `box` or `circle`, not none.",
        ),
        ({"solids": [{"box": [1, 1, 1]}]}, "`solids[0].box`: Expected 4 numbers, not 3."),
        (
            {"solids": [{"box": [1, 1, 1, 0]}]},
            "`solids[0].box[3]`: Expected a number from 0.0001 to",
        ),
        ({"solids": [{"box": [1, 1, 1, "2"]}]}, "`solids[0].box[3]`: Expected a number, not '2'."),
        ({"solids": [{"circle": [1, 1, math.nan]}]}, "`solids[0].circle[2]`: Expected a number"),
        ({"solids": [{"circle": 1}]}, "`solids[0].circle`: Expected 3 numbers, not 1."),
        ({"solids": [{"circle": [1, 1, 1], "push": -1}]}, "`solids[0].push`: Expected a number from 0 to 10"),
        (
            {"solids": [{"circle": [1, 1, 1], "puch": 1}]},
            "`solids[0].puch`: Unknown key. Did you mean `push`?",
        ),
        (
            {"solids": [{"circle": [1, 1, 1], "box": [1, 1, 1, 1]}]},
            "`solids[0]`: Expected one of `box`",
        ),
        (
            {"solids": [{"box": [1, 1, 0.1, 0.1], "patrol": {"path": [[0, 0.5]], "spead": 1}}]},
            "`solids[0].patrol.spead`: Unknown key. Did you mean `speed`?",
        ),
        (
            {"solids": [{"box": [1, 1, 0.1, 0.1], "patrol": {"speed": 1}}]},
            "`solids[0].patrol`: The key `path` is missing.",
        ),
        (
            {"solids": [{"box": [1, 1, 0.1, 0.1], "patrol": {"path": []}}]},
            "`solids[0].patrol.path`: Expected at least one point, in metres from where the solid starts.",
        ),
        (
            {"solids": [{"box": [1, 1, 0.1, 0.1], "patrol": {"path": [[0, 0.5], [0, 0.5]]}}]},
            "`solids[0].patrol.path[1]`: The solid is there already. Remove this point.",
        ),
        (
            {"solids": [{"box": [1, 1, 0.1, 0.1], "patrol": {"path": [[0, 0.5], [0, 1.5]]}}]},
            "`solids[0].patrol.path[1]`: The point (1, 2.5) is outside the world of 3 x 2 m.",
        ),
        (
            {"solids": [{"box": [1, 1, 0.1, 0.1], "patrol": {"path": [[0, 0.5]], "speed": 0}}]},
            "`solids[0].patrol.speed`: Expected a number from 0.001 to 10, not 0.",
        ),
        (
            {"solids": [{"box": [1, 1, 0.1, 0.1], "push": 1, "patrol": {"path": [[0, 0.5]]}}]},
            "`solids[0]`: It moves by itself and cannot be pushed. Remove `patrol` or `push`.",
        ),
        ({"solids": {}}, "`solids`: Expected a list, not an object."),
        ({"floor": {"stroks": []}}, "`floor.stroks`: Unknown key. Did you mean `strokes`?"),
        ({"floor": {"grey": 256}}, "`floor.grey`: Expected a number from 0 to 255, not 256."),
        ({"floor": {"strokes": [{"path": []}]}}, "`floor.strokes[0].path`: Expected at least one point"),
        ({"floor": {"strokes": [{"path": [[1]]}]}}, "`floor.strokes[0].path[0]`: Expected 2 numbers, not 1."),
        (
            {"floor": {"strokes": [{"arc": [1, 1, 1, 0, 90]}]}},
            "`floor.strokes[0].arc`: The arc is longer than a full",
        ),
        (
            {"floor": {"strokes": [{"circle": [1, 1, -1]}]}},
            "`floor.strokes[0].circle[2]`: Expected a number",
        ),
        (
            {"floor": {"strokes": [{"circle": [1, 1, 1], "width": True}]}},
            "`floor.strokes[0].width`: Expected a",
        ),
        ({"floor": None}, "`floor`: Expected an object, not null."),
        ({"zones": {"goal": {"disc": [1, 1, 1]}}}, "`zones.goal.disc`: Unknown key"),
        ({"zones": {"goal": {"box": [1, 1]}}}, "`zones.goal.box`: Expected 4 numbers, not 2."),
        ({"zones": {3: {"box": [1, 1, 1, 1]}}}, "`zones`: Keys must be strings, not 3."),
        ({"robots": []}, "`robots`: Expected at least one"),
        ({"robots": [{}]}, "`robots[0]`: The key `pose` is missing."),
        (
            {"robots": [{"pose": [4, 1, 0]}]},
            "`robots[0].pose`: The point (4, 1) is outside the world of 3 x 2 m",
        ),
        (
            {"robots": [{"pose": [1, 1, 0], "bumper": 1}]},
            "`robots[0].bumper`: Expected true or false, not 1.",
        ),
        (
            {"robots": [{"pose": [1, 1, 0], "distance": [[0, 0]]}]},
            "`robots[0].distance[0][1]`: Expected a",
        ),
        (
            {"robots": [{"pose": [1, 1, 0], "noise": {"lite": 1}}]},
            "`robots[0].noise.lite`: Unknown key. Did",
        ),
        (
            {"robots": [{"pose": [1, 1, 0], "limits": [0, 1]}]},
            "`robots[0].limits[0]`: Expected a number from",
        ),
        ({"size": [3, 0]}, "`size[1]`: Expected a number from 0.1 to 1000, not 0."),
        ({"seed": 0.5}, "`seed`: Expected a whole number, not 0.5."),
        ({"open": "yes"}, "`open`: Expected true or false, not 'yes'."),
        ({"name": 3}, "`name`: Expected a string, not 3."),
        ({"version": 2}, "`version`: Expected 1, not 2."),
        ({"version": True}, "`version`: Expected 1, not true."),
        ({"robot": []}, "`robot`: Unknown key. Did you mean `robots`?"),
    ],
)
def test_a_bad_world_is_refused_with_the_place_of_the_mistake(change, message):
    with pytest.raises(WorldError) as caught:
        load({**SMALLEST, **change})
    assert str(caught.value).startswith(message)


@every("key", ["version", "size", "robots"])
def test_what_a_world_needs_must_be_there(key):
    with pytest.raises(WorldError, match=f"`world`: The key `{key}` is missing"):
        load({other: value for other, value in SMALLEST.items() if other != key})


def test_long_values_are_cut_in_messages():
    with pytest.raises(WorldError, match=r"`name`: Expected a string, not 1{37}\.\.\."):
        load({**SMALLEST, "name": int("1" * 50)})


def test_an_unknown_name_is_answered_with_a_suggestion():
    words = r"no world `lime`\. Did you mean `line`\? Choose one of `empty`, `line`, "
    with pytest.raises(WorldError, match=words):
        load("lime")


def test_what_is_not_a_world_at_all_is_refused():
    with pytest.raises(WorldError, match="A world is a name, a file, a dict or a World, not int"):
        load(7)  # type: ignore[arg-type]
    with pytest.raises(WorldError, match="`world`: Expected an object, not a list"):
        read_world([])


@every(
    ("text", "message"),
    [
        ("{", " is not valid JSON: line 1, column 2: Expecting property name"),
        ('{"version": NaN}', ": `NaN` is not a valid number here."),
        ("[" * 100_000, " is nested too deeply."),
        ('{"version": 1, "size": [3, 2], "robots": []}', ": `robots`: Expected at least one"),
    ],
)
def test_a_bad_file_is_named_in_the_message(tmp_path, text, message):
    path = tmp_path / "bad.json"
    path.write_text(text)
    with pytest.raises(WorldError) as caught:
        load(path)
    assert str(caught.value).startswith(f"{path}{message}")


def test_a_missing_file_is_named_in_the_message(tmp_path):
    with pytest.raises(WorldError, match=r"none\.json cannot be read: No such file"):
        load(str(tmp_path / "none.json"))


def test_the_maze_leads_to_its_goal():
    """A search over free places for the whole robot, 5 cm apart."""
    world = load("maze")
    radius, grid = world.robots[0].radius, 0.05
    columns, rows = round(world.size[0] / grid), round(world.size[1] / grid)

    def free(column, row):
        x, y = column * grid, row * grid
        return (
            radius < x < world.size[0] - radius
            and radius < y < world.size[1] - radius
            and all(
                abs(x - box.box[0]) > box.box[2] / 2 + radius or abs(y - box.box[1]) > box.box[3] / 2 + radius
                for box in world.solids
            )
        )

    start = (round(world.robots[0].pose[0] / grid), round(world.robots[0].pose[1] / grid))
    reached, edge = {start}, [start]
    while edge:
        column, row = edge.pop()
        for place in ((column + 1, row), (column - 1, row), (column, row + 1), (column, row - 1)):
            if place not in reached and 0 <= place[0] <= columns and 0 <= place[1] <= rows and free(*place):
                reached.add(place)
                edge.append(place)
    assert any(world.zones["goal"].contains(column * grid, row * grid) for column, row in reached)
