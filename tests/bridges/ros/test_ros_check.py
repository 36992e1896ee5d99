"""``lrp check --bridge ros -o setup=…``: a program against what a set-up gives, without a robot."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from bridges.ros.follower import SETUP
from typer.testing import CliRunner

from lrp_jupyter.bridges.ros import RosBridge
from lrp_jupyter.cli import app
from lrp_jupyter.live.running.checking import members_of
from lrp_jupyter.live.session import Session

ROBOT = {
    "subscriptions": {
        "odom": {"topic": "/odom", "type": "nav_msgs/Odometry"},
        "order": {"topic": "/order", "type": "std_msgs/Int32"},
        "thing": {"topic": "/thing"},
        "own": {"topic": "/own", "type": "own_msgs/Own"},
    },
    "publishers": {
        "move": {"topic": "/cmd_vel", "type": "geometry_msgs/Twist"},
        "horn": {"topic": "/horn"},
    },
    "actions": {"drive_to": {"action": "/move_base", "type": "move_base_msgs/MoveBase"}},
}
PROGRAMS = sorted((Path(__file__).parents[3] / "notebooks" / "ros").glob("*.lrp"))
Check = Callable[..., Any]


@pytest.fixture
def check(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Check:
    """Check a program whose only state does and tests what is given, with options of the bridge."""
    monkeypatch.chdir(tmp_path)
    for name in ("ROS_MASTER_URI", "ROS_VERSION", "ROS_DOMAIN_ID"):
        monkeypatch.delenv(name, raising=False)
    (tmp_path / "robot.json").write_text(json.dumps(ROBOT))

    def check(does: str = "pass", tests: str = "True", *options: str) -> dict[str, str]:
        Path("p.lrp").write_text(
            f"(machine m (state a (running [{does}])) (state b) (on [{tests}] a -> b)) (spawn m a)"
        )
        words = [word for option in ("setup=robot.json", *options) for word in ("-o", option)]
        done = CliRunner().invoke(app, ["check", "p.lrp", "--bridge", "ros", *words, "--format", "json"])
        found = {each["code"]: each["message"] for each in json.loads(done.stdout)}
        assert done.exit_code == int(bool(found))
        return found

    return check


@pytest.mark.parametrize(
    ("does", "tests", "code", "message"),
    [
        ("pass", "robot.odm.x > 1", "LRP520", "`robot` has no `odm`. Did you mean `odom`?"),
        ("robot.hrn(data=1)", "True", "LRP520", "`robot` has no `hrn`. Did you mean `horn`?"),
        ("robot.move(lineer=1)", "True", "LRP521", "no argument `lineer`. Did you mean `linear`?"),
        ("pass", "robot.odom.pos.x > 1", "LRP520", "`robot.odom` has no `pos`. Did you mean `pose`?"),
        ("pass", "robot.odom.pose.pose.position.q > 1", "LRP520", "It has `x`, `y`, `z`."),
        ("pass", "robot.odom.header.frame == 'a'", "LRP520", "Did you mean `frame_id`?"),
        ("pass", "robot.drive_to.succeded", "LRP520", "Did you mean `succeeded`?"),
        ("pass", "robot.odom() > 1", "LRP524", "is a value and cannot be called"),
    ],
)
def test_what_a_set_up_does_not_give_is_a_finding(
    check: Check, does: str, tests: str, code: str, message: str
) -> None:
    found = check(does, tests)
    assert list(found) == [code]
    assert message in found[code]


@pytest.mark.parametrize(
    "tests",
    [
        "robot.odom.x > 1 and robot.odom.pose.pose.position.x > 1 and robot.odom.pose.covariance[7] > 1",
        "robot.odom.age < 1 and robot.odom.new and robot.order.data > 1 and 3 in robot.order.new",
        # of a type that is left out, or not known here, only the name is known
        "robot.thing.foo.bar > 1 and robot.thing.new and robot.own.foo > 1 and robot.own.age < 1",
        # whether it is ROS 1 or ROS 2 is not known
        "robot.odom.header.seq > 1 or robot.odom.header.stamp.secs > 1 or robot.odom.header.stamp.sec > 1",
        "robot.drive_to.succeeded and robot.drive_to.result.foo and robot.drive_to.feedback.bar > 1",
    ],
)
def test_what_it_may_give_is_none(check: Check, tests: str) -> None:
    assert check("robot.horn(robot.thing.what, foo=1); robot.drive_to(anything=1)", tests) == {}
    assert check("robot.move(linear=0.1, angular_z=1)") == {}
    assert check("with robot.drive_to as goal: goal.anything.x = 1") == {}


@pytest.mark.parametrize("program", PROGRAMS, ids=lambda path: path.stem)
def test_the_programs_for_a_robot_have_no_findings(monkeypatch: pytest.MonkeyPatch, program: Path) -> None:
    monkeypatch.chdir(program.parent)
    own = program.with_suffix(".json")
    setup = own if own.exists() else program.with_name("robot.json")
    done = CliRunner().invoke(app, ["check", program.name, "--bridge", "ros", "-o", f"setup={setup.name}"])
    assert (done.exit_code, done.stdout) == (0, f"{program.name}: no findings\n")


def test_the_fields_are_those_of_the_back_end_and_of_the_folders_that_are_named(
    check: Check, tmp_path: Path
) -> None:
    pytest.importorskip("rosbags")
    pytest.importorskip("cyclonedds")
    folder = tmp_path / "own_msgs" / "msg"
    folder.mkdir(parents=True)
    (folder / "Own.msg").write_text("std_msgs/Header header\nfloat64 width\n")
    options = "backend=dds", f"messages={tmp_path}"
    assert check("pass", "robot.own.width > 1 and robot.own.header.stamp.sec > 1", *options) == {}
    found = check("pass", "robot.own.widht > 1", *options)
    assert found == {"LRP520": "`robot.own` has no `widht`. Did you mean `width`?"}
    found = check("pass", "robot.odom.header.seq > 1", *options)
    assert found == {"LRP520": "`robot.odom.header` has no `seq`. It has `stamp`, `frame_id`."}


@pytest.mark.ros
def test_the_fields_are_those_of_the_installed_packages_of_ros_1(ros_home: Any, check: Check) -> None:
    assert check("robot.drive_to(target_pose_pose_position_x=1.0)", "True", "backend=rospy") == {}
    found = check("robot.drive_to(x=1.0)", "True", "backend=rospy")
    assert found == {"LRP521": "`robot.drive_to` has no argument `x`. It takes `target_pose`."}
    assert check("pass", "robot.odom.header.seq > 1", "backend=rospy") == {}
    assert list(check("pass", "robot.odom.header.stamp.sec > 1", "backend=rospy")) == ["LRP520"]


@pytest.mark.ros
@pytest.mark.usefixtures("ros_home")
def test_packages_of_ros_1_say_nothing_of_ros_2(check: Check) -> None:
    assert check("robot.drive_to(x=1.0)", "robot.odom.header.stamp.sec > 1", "backend=rclpy") == {}


@pytest.mark.parametrize(
    ("setup", "message"),
    [
        (
            '{"subscriptions": {"odom": {"topc": "/odom"}}}',
            "bad.json, `subscriptions.odom`: A `topic` is miss",
        ),
        ('{"publisher": {}}', "bad.json: There is no `publisher`"),
        ("{", "The set-up bad.json is not JSON"),
        (
            '{"publishers": {"go": {"topic": "/g", "type": "geometry_msgs/Twist", "limits": {"lineer": 1}}}}',
            "bad.json, `publishers.go`: `geometry_msgs/Twist` has no number `lineer`",
        ),
        (
            '{"publishers": {"on": {"topic": "/on", "type": "std_msgs/Bool"}}, "stop": {"on": {"dta": 0}}}',
            "bad.json, `publishers.on`: What is to be sent at a stop:",
        ),
    ],
)
def test_a_wrong_set_up_is_a_sentence_with_its_place_and_exit_code_2(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, setup: str, message: str
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("bad.json").write_text(setup)
    done = CliRunner().invoke(app, ["check", "follower", "--bridge", "ros", "-o", "setup=bad.json"])
    assert done.exit_code == 2
    assert done.stderr.startswith(f"lrp: {message}")


def test_the_follower_fits_its_set_up_and_an_option_needs_a_robot() -> None:
    done = CliRunner().invoke(app, ["check", "follower", "--bridge", "ros", "-o", f"setup={SETUP}"])
    assert (done.exit_code, done.stdout) == (0, "follower: no findings\n")
    done = CliRunner().invoke(app, ["check", "follower", "-o", f"setup={SETUP}"])
    assert done.exit_code == 2
    assert "Name it, as in `--bridge ros`." in " ".join(done.stderr.replace("│", " ").split())


def test_a_session_knows_the_commands_before_it_is_opened_but_a_person_may_add_members() -> None:
    text = "(machine m (state a (running [robot.move(lineer=1); robot.honk()]))) (spawn m a)"
    ros = RosBridge(setup=ROBOT)
    with Session(text, ros) as session:
        assert [finding.code for finding in session.check(text)] == ["LRP521"]
    assert not members_of(ros).complete
    bare = RosBridge()
    ros.alone = bare.alone = True
    assert members_of(ros).complete
    assert not members_of(bare).complete
