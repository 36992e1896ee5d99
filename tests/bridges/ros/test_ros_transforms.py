"""`robot.tf("map", "base_link")`: the transforms of real broadcasters, and those of tf2's own library."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from support.waiting import until

from lrp_jupyter import check
from lrp_jupyter.bridges.bridge import ConnectionState
from lrp_jupyter.bridges.member_tree import AgeLimit
from lrp_jupyter.bridges.ros import RosBridge
from lrp_jupyter.bridges.ros.channel import Channel
from lrp_jupyter.bridges.ros.setup import Wire
from lrp_jupyter.bridges.ros.transforms import TransformTree
from lrp_jupyter.errors import BridgeError, NoDataYet, StaleData
from lrp_jupyter.live.recording import read_recording
from lrp_jupyter.live.reproduction import reproduce
from lrp_jupyter.live.session import Session

Connect = Callable[..., RosBridge]
NODE = str(Path(__file__).parent / "transforms_node.py")
FAR = """(machine m
  (state near)
  (state far)
  (on [robot.tf("map", "base_link").x > 2] near -> far left))
(spawn m near)"""


def message(*transforms: tuple[Any, ...]) -> Any:
    """A message of transforms: parent, child, translation and rotation of each."""
    return SimpleNamespace(
        transforms=[
            SimpleNamespace(
                header=SimpleNamespace(frame_id=parent, stamp=None),
                child_frame_id=child,
                transform=SimpleNamespace(
                    translation=SimpleNamespace(**dict(zip("xyz", way, strict=True))),
                    rotation=SimpleNamespace(**dict(zip("xyzw", turn, strict=True))),
                ),
            )
            for parent, child, way, turn in transforms
        ]
    )


PLAIN = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)


def tree(*pairs: tuple[str, str], at: float = 0.0, is_static: bool = False) -> TransformTree:
    made = TransformTree()
    made.put(message(*((*pair, *PLAIN) for pair in pairs)), at, is_static)
    return made


numbers = st.floats(-100, 100)
turns = st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda turn: math.hypot(*turn) > 0.1)
links = st.lists(st.tuples(st.tuples(numbers, numbers, numbers), turns), min_size=1, max_size=12)


@pytest.mark.ros
@pytest.mark.usefixtures("ros_home")
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(links, st.data())
def test_a_frame_is_where_tf2_says(found: list[Any], data: st.DataObject) -> None:
    import rospy
    import tf2_py
    from geometry_msgs.msg import TransformStamped

    ours, theirs = TransformTree(), tf2_py.BufferCore()
    for number, (way, turn) in enumerate(found, 1):
        parent = f"frame{data.draw(st.integers(0, number - 1), f'parent of {number}')}"
        turn = tuple(each / math.hypot(*turn) for each in turn)
        ours.put(message((parent, f"/frame{number}", way, turn)), 0.0, False)
        stamped = TransformStamped()
        stamped.header.frame_id, stamped.child_frame_id = parent, f"frame{number}"
        stamped.header.stamp = rospy.Time(1)
        at = stamped.transform
        at.translation.x, at.translation.y, at.translation.z = way
        at.rotation.x, at.rotation.y, at.rotation.z, at.rotation.w = turn
        theirs.set_transform(stamped, "test")
    frames = st.integers(0, len(found)).map("frame{}".format)
    target, source = data.draw(frames, "target"), data.draw(frames, "source")
    expected = theirs.lookup_transform_core(target, source, rospy.Time(0)).transform
    seen = ours.lookup(target, source, 0.0, False)
    way, turn = expected.translation, expected.rotation
    assert seen.translation == pytest.approx((way.x, way.y, way.z), abs=1e-6)
    same = sum(one * two for one, two in zip(seen.rotation, (turn.x, turn.y, turn.z, turn.w), strict=True))
    assert abs(same) == pytest.approx(1, abs=1e-9), "q and -q are one rotation"
    forward = seen.rotation.turned((1.0, 0.0, 0.0))
    if math.hypot(*forward[:2]) > 0.01:  # else the heading of what points up is anything
        assert math.remainder(math.atan2(forward[1], forward[0]) - seen.yaw, math.tau) == pytest.approx(
            0, abs=1e-6
        )


@pytest.mark.parametrize(
    ("pairs", "asked", "sentence"),
    [
        ((), ("map", "odom"), "No transform has arrived yet"),
        ((("map", "odom"),), ("map", "odm"), "no frame `odm`; there are `map`, `odom`. Did you mean `odom`?"),
        (
            (("map", "start"), ("odom", "base"), ("base", "laser")),
            ("map", "laser"),
            "No transform connects `map` and `laser`: one between `map` and `odom` is missing, known are "
            "`laser` in `base` in `odom`; `map`.",
        ),
        ((("a", "b"), ("b", "a")), ("a", "b"), "go round in a circle: `b` in `a` in `b`."),
    ],
)
def test_a_frame_that_is_not_there_is_told_with_those_that_are(
    pairs: tuple[tuple[str, str], ...], asked: tuple[str, str], sentence: str
) -> None:
    with pytest.raises((NoDataYet, BridgeError)) as caught:
        tree(*pairs).lookup(*asked, 0.0, False)
    assert sentence in str(caught.value)


def test_what_is_no_transform_is_named_and_the_others_of_its_message_are_taken() -> None:
    for way, turn in (
        ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0)),
        ((math.nan, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)),
    ):
        ours = TransformTree()
        with pytest.raises(ValueError, match="that of `b` in `a` is not a transform"):
            ours.put(message(("a", "b", way, turn), ("a", "c", *PLAIN)), 0.0, False)
        assert ours.lookup("a", "c", 0.0, False).yaw == 0
        with pytest.raises(NoDataYet):
            ours.lookup("a", "b", 0.0, False)


def test_the_age_is_that_of_the_oldest_part_on_the_way_and_static_ones_have_none() -> None:
    ours = tree(("map", "odom"), ("map", "tower"), at=1.0)
    ours.put(message(("odom", "base", *PLAIN)), 4.0, False)
    ours.put(message(("base", "laser", *PLAIN), ("base", "arm", *PLAIN)), 0.0, True)
    ages = {("map", "laser"): 4.0, ("odom", "laser"): 1.0, ("laser", "arm"): 0.0, ("map", "map"): 0.0}
    assert {asked: ours.lookup(*asked, 5.0, False).age for asked in ages} == ages
    assert ours.lookup("odom", "laser", 5.0, False, lambda _: AgeLimit(2.0)).x == 0
    with pytest.raises(StaleData, match=r"That of `odom` in `map` is stale: it is 4\.0 s old\."):
        ours.lookup("map", "laser", 5.0, False, lambda _: AgeLimit(2.0))


def test_one_that_came_steadily_and_ceases_is_stale_unless_it_is_switched_off() -> None:
    ours = tree(("base", "laser"), is_static=True)
    for tenth in range(100):
        ours.put(message(("odom", "base", *PLAIN)), tenth / 10, False)
    ours.put(message(("map", "odom", *PLAIN)), 9.9, False)
    ours.latch()
    channel = Channel(Wire("tf", "subscription", "/tf"))
    assert ours.lookup("map", "laser", 11.0, True, channel.limit_of).age == pytest.approx(1.1)
    assert ours.oldest(11.0, channel.limit_of)[0] == pytest.approx(1.1)
    with pytest.raises(StaleData, match=r"That of `base` in `odom` is stale: .* one came every 0\.1 s"):
        ours.lookup("map", "laser", 11.3, True, channel.limit_of)
    age, limit = ours.oldest(11.4, channel.limit_of)
    assert (age, limit.seconds) == (pytest.approx(1.5), pytest.approx(1.2))
    assert ours.lookup("map", "odom", 20.0, True, channel.limit_of).age == pytest.approx(10.1), "it came once"
    assert ours.oldest(20.0, channel.limit_of)[1].seconds is None, "what is asked for no longer"
    never = Channel(Wire("tf", "subscription", "/tf", stale_after=None))
    assert ours.lookup("map", "laser", 20.0, True, never.limit_of).age == pytest.approx(10.1)


def test_a_silence_of_transforms_that_has_a_reason_is_no_pause() -> None:
    channel = Channel(Wire("tf", "subscription", "/tf"))
    ours, motion = channel.tree, channel.motion
    assert ours is not None

    def come(first: float, last: float) -> None:
        for tenth in range(round(first * 10), round(last * 10)):
            ours.put(message(("odom", "base", *PLAIN)), tenth / 10, False, motion)

    def limit(now: float) -> float | None:
        ours.latch()
        ours.lookup("odom", "base", now, True)
        return ours.oldest(now, channel.limit_of)[1].seconds

    motion.note(True, 0.0)
    come(0.0, 10.0)
    assert limit(10.0) == pytest.approx(1.2)
    motion.note(False, 10.0)
    motion.note(True, 70.0)
    come(70.1, 71.0)
    assert limit(71.0) == pytest.approx(1.2), "it had ceased with the robot"
    channel.interrupt()  # the robot cannot be reached
    come(131.0, 132.0)
    assert limit(132.0) == pytest.approx(1.2)


def test_a_program_that_asks_for_frames_is_checked_by_its_set_up() -> None:
    ros = RosBridge(setup={"subscriptions": {"tf": {"topic": "/tf"}}})
    asked = FAR.replace(".x > 2", ".x > robot.tf.age")
    assert check(asked, bridge=ros) == ()
    (finding,) = check(FAR.replace(', "base_link"', ""), bridge=ros)
    assert "`robot.tf` needs `source_frame`" in finding.message


def publisher(real: Any, kind: str) -> Callable[..., None]:
    """Start a node that publishes transforms; return what has it publish some."""
    node = real.start(sys.executable, NODE, kind, ready=True)

    def publish(*transforms: tuple[Any, ...]) -> None:
        node.stdin.write(json.dumps(transforms) + "\n")
        node.stdin.flush()

    return publish


@pytest.mark.ros
def test_a_program_asks_where_its_robot_is_and_the_run_is_repeated(
    real: Any, connect: Connect, tmp_path: Path
) -> None:
    # two publishers keep a message of their own each, and two publish all the time
    publisher(real, "static")(["base_link", "laser", 0.2, 0.0, 0.0])
    publisher(real, "static")(["map", "odom", 1.0, 0.0, math.pi / 2], ["base_link", "arm", 0.0, 0.3, 0.0])
    wheels, joints = publisher(real, "moving"), publisher(real, "moving")
    ros = connect()
    ros.subscribe("tf", "/tf")

    def at(target: str, source: str) -> Any:
        try:
            seen = ros.robot.tf(target, source)
        except NoDataYet:
            return None
        return tuple(round(each, 6) for each in (seen.x, seen.y, seen.yaw))

    until(lambda: at("laser", "arm") and at("map", "odom"))
    assert (at("laser", "arm"), at("odom", "map")) == ((-0.2, 0.3, 0.0), (0.0, 1.0, -1.570796))
    with pytest.raises(
        NoDataYet, match=r"`robot\.tf`: No transform connects `map` and `laser`: .* `map` and"
    ):
        ros.robot.tf("map", "laser")

    def drive(x: float) -> None:
        def has_come() -> bool:
            joints(["arm", "hand", 0.0, 0.1, 0.0])
            wheels(["odom", "base_link", x, 0.0, 0.0], ["base_link", "wheel", 0.0, 0.1, 0.0])
            return bool(at("odom", "base_link") == (x, 0.0, 0.0) and at("base_link", "hand"))

        until(has_come)

    drive(0.5)
    assert at("map", "base_link") == (1.0, 0.5, 1.570796)
    assert at("map", "hand") == (0.6, 0.5, 1.570796)
    assert ros.setup["subscriptions"] == {"tf": {"topic": "/tf", "type": "tf2_msgs/TFMessage"}}
    assert [row[0] for row in ros.panel().tables[0].rows] == ["tf"]

    path = tmp_path / "run.lrplog"
    with Session(FAR.replace("map", "odom"), bridge=ros, rate=20) as session:
        with session.record(path):
            session.start()
            until(lambda: session.frame.tick > 5)
            values = session.why_not("left").facts["values"]
            assert values == {"robot.tf('odom', 'base_link').x": 0.5}
            drive(2.5)
            until(lambda: session.frame.active == (("m", "far"),))
            session.pause()
        assert not session.issues
        tick = session.frame.tick
    again = reproduce(read_recording(path))
    with again.session as session:
        assert again.difference is None
        assert (session.frame.tick, session.frame.active) == (tick, (("m", "far"),))

    ros.subscribe("tf", "/tf", stale_after=0.001)
    ros.open()
    until(lambda: at("laser", "arm"))  # what is kept comes again, and is never old

    def has_come() -> bool:
        wheels(["odom", "base_link", 0.0, 0.0, 0.0])  # the first ones may be lost
        try:
            ros.robot.tf("odom", "base_link")
        except StaleData:
            return True
        except NoDataYet:
            return False
        return True

    until(has_come)

    def is_stale() -> bool:
        """Whether nothing moves the robot in the tick after one in which the program has asked."""
        why = ""
        for _ in range(2):
            ros.begin_tick(0.0, 0.1)
            sentence = ros.safety.blind
            try:
                ros.robot.tf("odom", "base_link")
            except NoDataYet as error:
                why = str(error)
            ros.end_tick(0.0)
        return "`robot.tf`: That of `base_link` in `odom` is stale" in why and "`robot.tf.age`" in sentence

    until(is_stale)
    assert ros.status.state is ConnectionState.STALE
