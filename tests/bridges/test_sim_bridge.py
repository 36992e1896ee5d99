"""The simulated robot as a bridge: one clock, exact repetition, a world that a person can change."""

from __future__ import annotations

import json
import math
import subprocess
import sys
import threading
from collections.abc import Callable

import pytest

from lrp_jupyter.bridges.bridge import ConnectionState, MemberError, Robot
from lrp_jupyter.bridges.sim import SimBridge
from lrp_jupyter.errors import BridgeError
from lrp_jupyter.sim import PutSolid
from lrp_jupyter.sim.world import BoxSolid

PERIOD = 0.1


@pytest.fixture
def sim() -> SimBridge:
    sim = SimBridge("empty", seed=1)
    sim.open()
    return sim


def drive(sim: SimBridge, ticks: int, linear: float = 0.1, angular: float = 0.0, first: int = 0) -> None:
    """Drive as a session does: tick, then the world's period."""
    for tick in range(first, first + ticks):
        now = tick * PERIOD
        sim.begin_tick(now, PERIOD)
        sim.robot.move(linear=linear, angular=angular)
        sim.end_tick(now)
        sim.advance(PERIOD)


def pose(sim: SimBridge) -> tuple[float, float, float]:
    return sim.picture.robots[0].pose


def test_it_is_armed_and_no_hardware(sim: SimBridge) -> None:
    assert sim.safety.armed
    assert not sim.hardware
    assert sim.status.state is ConnectionState.CONNECTED
    assert sim.time_step == 0.01


def test_the_robot_of_the_papers_program_is_there(sim: SimBridge) -> None:
    assert dir(sim.robot) == [
        "bumper",
        "distance",
        "drive_by",
        "drive_to",
        "front",
        "gyro",
        "lamp",
        "light",
        "move",
        "odom",
        "pen",
        "say",
        "scan",
        "stop",
        "turn_by",
    ]
    assert sim.robot.light.data == 255
    assert sim.robot.bumper.data == 0
    assert sim.robot.distance.data > 0
    assert (sim.robot.odom.x, sim.robot.odom.y, sim.robot.odom.theta, sim.robot.gyro.data) == (0, 0, 0, 0)


def test_a_robot_without_sensors_offers_none() -> None:
    bare = {"pose": [1, 1, 0], "light": [], "distance": [], "bumper": False}
    sim = SimBridge({"version": 1, "size": [2, 2], "robots": [bare]})
    sim.open()
    assert dir(sim.robot) == [
        *("drive_by", "drive_to", "gyro", "lamp", "move", "odom", "pen", "say", "stop", "turn_by")
    ]
    with pytest.raises(MemberError, match="`robot` has no `light`"):
        sim.robot.light  # noqa: B018


def test_a_robot_with_several_sensors_of_a_kind_offers_all_in_their_order() -> None:
    rich = {
        "pose": [0.5, 1, 0],
        "light": [[0.06, 0.02], [0.06, -0.02]],
        "distance": [[0, 3], [math.pi / 2, 3]],
    }
    floor = {"grey": 255, "strokes": [{"path": [[0.4, 0.98], [1, 0.98]], "width": 0.02}]}
    sim = SimBridge({"version": 1, "size": [2, 2], "floor": floor, "robots": [rich]})
    sim.open()
    assert sim.robot.light.all == (255, 0)
    assert sim.robot.distance.all == pytest.approx((1.42, 0.92))
    assert sim.robot.distance.data == sim.robot.distance.all[0]
    assert sim.describe("distance.all").doc == "to the next solid along each ray: ahead, 90° left"


def robot_with(**sensors: object) -> SimBridge:
    sim = SimBridge(
        {"version": 1, "size": [4, 2], "robots": [{"pose": [1, 0.5, 0], "radius": 0.1, **sensors}]}
    )
    sim.open()
    return sim


def test_distance_sensors_have_the_names_of_their_directions() -> None:
    for world in ("maze", "walls"):
        sim = SimBridge(world)
        sim.open()
        front, left, right = sim.robot.front, sim.robot.left, sim.robot.right
        assert dir(left) == dir(front) == dir(right) == ["distance"]
        assert (front.distance, left.distance, right.distance) == sim.robot.distance.all
        assert sim.describe("left.distance").doc == "to the next solid 90° left; inf: nothing in reach"
        assert sim.describe("left.distance").unit == "m"


def test_a_direction_that_no_sensor_faces_is_answered_with_what_there_is() -> None:
    sim = SimBridge("line")
    sim.open()
    with pytest.raises(MemberError) as caught:
        sim.robot.right.distance  # noqa: B018
    assert str(caught.value).startswith("`robot` has no `right`; it has `bumper`, `distance`, ")


@pytest.mark.parametrize(
    ("degrees", "names"),
    [
        ([0, 90, -90], ["front", "left", "right"]),
        ([-90, 180], ["right", "back"]),
        ([45, -45, 135, -135], ["front_left", "front_right", "back_left", "back_right"]),
        ([20, 5, 275], [None, "front", "right"]),
        ([10, -10], ["front", None]),
    ],
)
def test_of_several_rays_in_one_direction_the_nearest_has_its_name(
    degrees: list[float], names: list[str | None]
) -> None:
    sim = robot_with(distance=[[math.radians(each), 5] for each in degrees])
    for name, seen in zip(names, sim.robot.distance.all, strict=True):
        if name is not None:
            assert getattr(sim.robot, name).distance == seen
    parts = {name for name in dir(sim.robot) if "distance" in dir(getattr(sim.robot, name))}
    assert parts == {name for name in names if name}


def test_light_sensors_on_both_sides_have_names() -> None:
    sim = robot_with(light=[[0.06, 0.02], [0.06, 0.0], [0.06, -0.02], [0.06, -0.04]])
    sim.draw(((1.0, 0.46), (1.2, 0.46)), width=0.01)
    sim.simulation.step(0)
    sim.begin_tick(0.0, PERIOD)
    assert sim.robot.light.all == (255, 255, 255, 0)
    assert (sim.robot.left.light, sim.robot.front.light, sim.robot.right.light) == (255, 255, 0)
    assert (
        sim.describe("right.light").doc == "brightness of the floor at (0.06, -0.04): 0 black ... 255 white"
    )


def test_a_single_light_sensor_has_no_side(sim: SimBridge) -> None:
    assert dir(sim.robot.front) == ["distance"]


def test_driving_for_a_second_covers_the_way(sim: SimBridge) -> None:
    drive(sim, 10, linear=0.1)
    sim.begin_tick(1.0, PERIOD)
    assert sim.robot.odom.x == pytest.approx(0.1, abs=0.01)
    assert sim.picture.time == pytest.approx(1.0)


def fill(robot: Robot) -> None:
    with robot.move as msg:
        msg.linear.x = 0.1
        msg.angular.z = 0.5


@pytest.mark.parametrize(
    "how",
    [
        lambda robot: robot.move(linear=0.1, angular=0.5),
        lambda robot: robot.move(linear_x=0.1, angular_z=0.5),
        lambda robot: robot.move(lambda msg: (msg.linear(x=0.1), msg.angular(z=0.5))),
        lambda robot: fill(robot),
    ],
)
def test_every_spelling_of_move_moves_alike(sim: SimBridge, how: Callable[[Robot], object]) -> None:
    sim.begin_tick(0.0, PERIOD)
    how(sim.robot)
    assert sim.picture.robots[0].command == (0.1, 0.5)


def test_the_world_stands_still_without_advance(sim: SimBridge) -> None:
    sim.begin_tick(0.0, PERIOD)
    sim.robot.move(linear=0.2)
    sim.end_tick(0.0)
    before = pose(sim)
    assert pose(sim) == before
    sim.advance(PERIOD)
    assert pose(sim) != before


def test_readings_are_latched_for_the_tick() -> None:
    sim = SimBridge("empty", seed=3, noise={"light": 20})
    sim.open()
    sim.begin_tick(0.0, PERIOD)
    sim.draw(((0, 0), (3, 2)), width=5, grey=0)
    assert sim.robot.light.data == sim.robot.light.data
    seen = sim.robot.light.data
    sim.end_tick(0.0)
    sim.advance(PERIOD)
    sim.begin_tick(0.1, PERIOD)
    assert sim.robot.light.data < seen


def test_a_two_wheeled_robot_does_not_move_sideways(sim: SimBridge) -> None:
    with pytest.raises(BridgeError, match="two wheels"):
        sim.robot.move(linear_y=0.1)


def test_stop_all_acts_before_the_world_moves_on(sim: SimBridge) -> None:
    drive(sim, 3, linear=0.3)
    moving = pose(sim)
    thread = threading.Thread(target=sim.stop_all)
    thread.start()
    thread.join()
    assert sim.picture.robots[0].command == (0.3, 0.0), "the flag alone must not touch the world"
    sim.advance(1.0)
    assert sim.picture.robots[0].command == (0.0, 0.0)
    assert pose(sim)[0] - moving[0] < 0.02


def test_the_program_can_stop_and_lower_the_pen(sim: SimBridge) -> None:
    sim.robot.pen(True)
    drive(sim, 10)
    assert sim.picture.robots[0].pen
    assert sim.picture.marks > 0
    sim.begin_tick(1.0, PERIOD)
    sim.robot.stop()
    sim.robot.pen(False)
    assert sim.picture.robots[0].command == (0.0, 0.0)
    assert not sim.picture.robots[0].pen


def test_the_lamp_is_a_part_of_the_picture_and_goes_back_with_the_world() -> None:
    sim = SimBridge("empty")
    sim.open()
    drive(sim, 1)
    before = sim.moment()
    sim.robot.lamp(True)
    assert sim.picture.robots[0].lamp
    lit = sim.moment()
    sim.robot.lamp(False)
    assert not sim.picture.robots[0].lamp
    assert sim.fork(lit).picture.robots[0].lamp
    sim.rewind(lit)
    assert sim.picture.robots[0].lamp
    sim.rewind(before)
    assert not sim.picture.robots[0].lamp
    sim.robot.lamp()
    sim.reset_world()
    assert not sim.picture.robots[0].lamp


def test_rewinding_repeats_bit_for_bit() -> None:
    def run(sim: SimBridge, first: int, ticks: int) -> list[object]:
        seen: list[object] = []
        for tick in range(first, first + ticks):
            sim.begin_tick(tick * PERIOD, PERIOD)
            if tick % 7 < 3:
                sim.robot.move(linear=0.2, angular=0.5 if sim.robot.light.data > 128 else -0.5)
            sim.end_tick(tick * PERIOD)
            sim.advance(PERIOD)
            seen.append((sim.robot.light.data, sim.picture.robots, sim.picture.time))
        return seen

    sim = SimBridge("line", seed=5, noise={"motor": 0.1, "light": 10})
    sim.open()
    run(sim, 0, 40)
    moment = sim.moment()
    first = run(sim, 40, 60)
    sim.rewind(moment)
    assert run(sim, 40, 60) == first


def test_rewinding_forgets_a_stop_that_came_later(sim: SimBridge) -> None:
    drive(sim, 3, linear=0.2)
    moment = sim.moment()
    sim.stop_all()
    sim.rewind(moment)
    sim.advance(PERIOD)
    assert sim.picture.robots[0].command == (0.2, 0.0)


def test_rewinding_to_nowhere_is_refused(sim: SimBridge) -> None:
    other = SimBridge("empty")
    other.open()
    drive(other, 5)
    with pytest.raises(BridgeError, match="belongs to another world"):
        sim.rewind(other.moment())
    with pytest.raises(BridgeError, match="is not a moment"):
        sim.rewind(7)


def test_a_person_changes_the_world_from_another_thread(sim: SimBridge) -> None:
    def by_hand() -> None:
        sim.place_robot((0.5, 0.6, math.pi / 2))
        sim.draw(((0.5, 0.6), (0.5, 1.0)), width=0.3, grey=0)

    thread = threading.Thread(target=by_hand)
    thread.start()
    thread.join()
    assert pose(sim) == (0.5, 0.6, math.pi / 2)
    sim.begin_tick(0.0, PERIOD)
    assert sim.robot.light.data == 0
    sim.erase(((0.5, 0.6), (0.5, 1.0)), width=0.5)
    sim.begin_tick(0.1, PERIOD)
    assert sim.robot.light.data == 255


def test_a_solid_can_be_moved_by_hand() -> None:
    sim = SimBridge("line")
    sim.open()
    sim.place_solid(0, (1.0, 0.2, 0.5))
    assert sim.picture.solids[0] == pytest.approx((1.0, 0.2, 0.5))


def test_resetting_the_world_puts_the_robot_back(sim: SimBridge) -> None:
    start = pose(sim)
    sim.robot.pen()
    drive(sim, 10)
    sim.reset_world()
    assert pose(sim) == start
    assert sim.picture.marks == 0


def test_what_cannot_be_done_by_hand_is_refused_at_once(sim: SimBridge) -> None:
    with pytest.raises(BridgeError, match="There is no robot 3"):
        sim.place_robot((0, 0, 0), robot=3)
    with pytest.raises(BridgeError, match="There is no solid 9"):
        sim.place_solid(9, (0, 0, 0))
    with pytest.raises(BridgeError, match="needs at least one point"):
        sim.draw(())
    with pytest.raises(BridgeError, match="finite"):
        sim.erase(((math.nan, 0),))


def test_another_world_can_be_loaded_while_a_program_holds_robot(sim: SimBridge) -> None:
    robot = sim.robot
    drive(sim, 3)
    sim.load_world("line")
    assert sim.picture.time == 0
    assert robot.light.data in range(256)
    with pytest.raises(BridgeError, match="There is no world `lime`"):
        sim.load_world("lime")
    assert robot.light.data in range(256)


def test_another_world_can_be_chosen_before_it_is_opened() -> None:
    sim = SimBridge("line")
    sim.load_world("empty")
    sim.open()
    assert sim.robot.light.data == 255


def test_an_unknown_world_or_noise_is_reported_in_a_sentence() -> None:
    with pytest.raises(BridgeError, match=r"There is no world `lin`.*Did you mean `line`"):
        SimBridge("lin")
    with pytest.raises(BridgeError, match=r"no noise `engine`\. Choose one of `motor`"):
        SimBridge(noise={"engine": 1})


def test_noise_is_that_of_the_seed() -> None:
    def run(seed: int) -> list[int]:
        sim = SimBridge("line", seed=seed, noise={"light": 20})
        sim.open()
        seen = []
        for tick in range(20):
            sim.begin_tick(tick * PERIOD, PERIOD)
            seen.append(sim.robot.light.data)
            sim.advance(PERIOD)
        return seen

    assert run(1) == run(1)
    assert run(1) != run(2)


def test_members_have_unit_doc_and_value(sim: SimBridge) -> None:
    sim.begin_tick(2.0, PERIOD)
    sim.refresh()
    member = sim.describe("robot.distance.data")
    assert (member.type, member.unit, member.age) == ("float", "m", 0.0)
    assert member.value == sim.robot.distance.data
    assert sim.describe("move").arguments[0].name == "move.linear"
    assert [field.name for field in sim.describe("odom").fields] == ["odom.x", "odom.y", "odom.theta"]
    json.dumps([member.as_dict() for member in sim.members()], allow_nan=False)


@pytest.mark.parametrize(
    "use",
    [
        "robot.distance < 0.3",
        "0.3 > robot.distance",
        "robot.distance - 1",
        "2 * robot.distance",
        "abs(robot.distance)",
        "float(robot.distance)",
        "bool(robot.distance)",
        "not robot.distance",
        "robot.distance()",
        "robot.distance[0]",
        "max(robot.distance, 1)",
        "sum([robot.distance])",
    ],
)
def test_a_sensor_used_as_a_value_says_where_its_value_is(use: str) -> None:
    bridge = SimBridge("line")
    bridge.open()
    with pytest.raises(BridgeError) as caught:
        eval(use, {"robot": bridge.robot})
    assert str(caught.value) == "`robot.distance` is the sensor; its value is `robot.distance.data`."


def test_a_part_and_a_method_used_as_values_say_what_to_write() -> None:
    bridge = SimBridge("line")
    bridge.open()
    robot = bridge.robot
    assert bool(robot)
    assert robot.distance == robot.distance != 3
    assert len({robot.distance, robot.odom}) == 2
    with pytest.raises(
        BridgeError, match=r"`robot.odom` is a part of the robot, not a value. It has `robot.odom"
    ):
        robot.odom + 1
    with pytest.raises(
        BridgeError, match=r"`robot.stop` is a method, not a value. Call it as `robot.stop\(\)`."
    ):
        max(robot.stop, 1)


def test_the_bumper_is_a_truth_value() -> None:
    bridge = SimBridge("line")
    bridge.open()
    assert bridge.robot.bumper.data is False


FREED_IN_ANY_ORDER = """
import gc, sys
from lrp_jupyter.bridges.sim import SimBridge

def interrupt(frame, event, _):
    if frame.f_code.co_name == finalizer:
        raise KeyboardInterrupt

gc.disable()
for finalizer in ("ext_cpSpaceShapeIteratorFunc", "ext_cpSpaceBodyIteratorFunc"):
    for _ in range(20):
        bridge = SimBridge()
        bridge.open()
        bridge.advance(25)
        bridge.load_world("maze")
        bridge.advance(1)
        bridge.close()
    del bridge
    sys.settrace(interrupt)
    gc.collect()
    sys.settrace(None)
print("done")
"""


@pytest.mark.slow
def test_the_process_survives_an_interruption_while_python_frees_old_worlds() -> None:
    python = subprocess.run([sys.executable, "-c", FREED_IN_ANY_ORDER], capture_output=True, timeout=120)
    assert (python.returncode, python.stdout.split()) == (0, [b"done"])


def test_an_edited_world_can_be_reset_to_what_was_loaded_after_another_world_and_a_new_start(
    sim: SimBridge,
) -> None:
    loaded = sim.world
    sim.edit_world(PutSolid(BoxSolid((1.0, 1.0, 0.2, 0.2))))
    sim.load_world("maze")
    assert not sim.is_edited
    sim.undo_world()
    assert sim.is_edited
    sim.close()
    sim.open()
    assert sim.is_edited
    sim.reset_world(drawings=True)
    assert sim.picture.world == loaded


def test_a_closed_world_can_still_be_read_and_starts_again_when_it_is_opened(sim: SimBridge) -> None:
    start = pose(sim)
    drive(sim, 10)
    end = pose(sim)
    sim.close()
    assert pose(sim) == end != start
    sim.open()
    assert (pose(sim), sim.simulation.world.seed) == (start, 1)
