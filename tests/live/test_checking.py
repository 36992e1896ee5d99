"""Checks of programs for the robot that they are written for."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.robots import Bare, Courier

import lrp_jupyter
from lrp_jupyter.bridges.ros.definitions import HEADERS
from lrp_jupyter.bridges.ros.types import Types
from lrp_jupyter.bridges.sim import SimBridge
from lrp_jupyter.language import checks
from lrp_jupyter.live.running.checking import check
from lrp_jupyter.live.session import Session

PROGRAM = """; world: line
(var speed := [0.2])
(machine m (state a (running [ACTION])) (state b) (on [CONDITION] a -> b))
(spawn m a)"""


def action(block: str) -> str:
    return PROGRAM.replace("ACTION", block).replace("CONDITION", "True")


def condition(block: str) -> str:
    return PROGRAM.replace("ACTION", "robot.stop()").replace("CONDITION", block)


def fixed(text: str) -> str:
    """Apply the fix of the only finding of a text."""
    (finding,) = check(text)
    assert finding.fix
    for start, end, new in sorted(finding.fix.edits, reverse=True):
        text = text[:start] + new + text[end:]
    return text


@pytest.mark.parametrize(
    "block",
    [
        "robot.move(linear=0.2, angular=-1)",
        "robot.move(linear_x=0.2, angular_z=speed)",
        "robot.move(lambda msg: msg.linear(x=speed))",
        "with robot.move as msg: msg.linear.x = speed",
        "robot.move(**{'linear': 0.2})",
        "def twist(msg): msg.linear.x = 1\nrobot.move(twist)",
        "robot.pen(True); robot.pen(down=False); robot.pen()",
        "sensor = robot.distance\nprint(sensor.data, robot)",
        "go = robot.move\ngo(linear=robot.light.data / 255)",
        "if robot.bumper.data == 1 or robot.bumper.data: robot.stop()",
        "if robot.light.data.real > 1: robot.stop()",
        "robot = speed\nprint(robot.nothing)",
        "print([robot for robot in 'ab'])",
        "print(dir(robot), robot.odom)",
        "f'{robot.nothing}'",
    ],
)
def test_uses_of_the_robot_that_work_have_no_findings(block: str) -> None:
    assert check(action(block)) == ()


@pytest.mark.parametrize(
    ("block", "code", "message"),
    [
        ("robot.moove(linear=1)", "LRP520", "`robot` has no `moove`. Did you mean `move`?"),
        ("print(robot.motor)", "LRP520", "`robot` has no `motor`. It has `light`, `bumper`, `distance`, "),
        ("print(robot.sonar)", "LRP520", "`robot` has no `sonar`. Write `robot.distance.data`."),
        ("robot.forward(0.2)", "LRP520", "`robot` has no `forward`. Write `robot.move(linear=0.2)`."),
        ("robot.move", "LRP507", "This only names `robot.move` and does nothing. Write `robot.move(lin"),
        ("robot.turn_by", "LRP507", "This only names `robot.turn_by` and does nothing. Write `robot.turn"),
        ("robot.lamp('off')", "LRP521", "`robot.lamp` takes `True` or `False`, and every text counts as"),
        ("robot.turn_by('90')", "LRP521", "`radians` must be a number, not a text. Write `90` without"),
        ("print(robot.distance.data is None)", "LRP526", "`robot.distance.data` is never `None`. If nothing"),
        ("print(robot.odom.z)", "LRP520", "`robot.odom` has no `z`. It has `x`, `y`, `theta`."),
        ("print(robot.light.data.x)", "LRP520", "`robot.light.data` is a number and has no `x`."),
        ("robot.move.linear = 1", "LRP520", "`robot.move` is a method and has no `linear`. Call it as"),
        ("robot.move(fast=1)", "LRP521", "`robot.move` has no argument `fast`. It takes `linear`"),
        ("robot.move(1, 2, 3)", "LRP521", "The arguments of `robot.move` need names."),
        ("robot.move(linear='x')", "LRP521", "`linear` must be a number, not a text. Write a number."),
        ("robot.pen(True, 1)", "LRP521", "`robot.pen` takes `(down=True)`. Remove the extra arguments."),
        ("print(robot.odom + 1)", "LRP522", "`robot.odom` is a part of the robot, not a value. It has"),
        ("robot.move = 0.2", "LRP523", "`robot.move` is a method and cannot be assigned. Call it as"),
        ("robot.light.data = 3", "LRP523", "`robot.light.data` is read from the robot and cannot"),
        ("robot.light = 3", "LRP523", "`robot.light` is a part of the robot and cannot be assigned."),
        ("if robot.light.data < 'x': speed = 1", "LRP525", "`robot.light.data` is a number, not a text."),
        ("if robot.light.data == 'x': speed = 1", "LRP526", "`robot.light.data` is a number, never equal"),
        ("if robot.bumper.data == '1': speed = 1", "LRP526", "`robot.bumper.data` is `True` or"),
        ("if robot.bumper.data == 2: speed = 1", "LRP526", "`robot.bumper.data` is `True` or `False`"),
        ("robot.light.data", "LRP507", "This only reads `robot.light.data` and does nothing with it."),
    ],
)  # fmt: skip
def test_a_wrong_use_of_the_robot_is_one_finding(block: str, code: str, message: str) -> None:
    (finding,) = check(action(block))
    assert finding.code == code
    assert finding.message.startswith(message)
    assert finding.line == 3


@pytest.mark.parametrize(
    ("block", "repaired"),
    [
        ("robot.move(lienar=1)", "robot.move(linear=1)"),
        ("robot.drive(linear=1)", "robot.move(linear=1)"),
        ("robot.pne(True)", "robot.pen(True)"),
        ("print(robot.light.value)", "print(robot.light.data)"),
        ("robot.move(linear := 1)", "robot.move(linear=1)"),
        ("robot.move(speed, 1)", "robot.move(linear=speed, angular=1)"),
        ("robot.move(linear='0.2')", "robot.move(linear=0.2)"),
        ("robot.stop", "robot.stop()"),
        ("robot.stop(0)", "robot.stop()"),
        ("print(robot.light.data())", "print(robot.light.data)"),
        ("print(robot.light())", "print(robot.light.data)"),
        ("print(robot.light - 1)", "print(robot.light.data - 1)"),
        ("print(robot.theta)", "print(robot.odom.theta)"),
        ("print(robot.light.data.data)", "print(robot.light.data)"),
        ("if not robot.bumper: robot.stop()", "if not robot.bumper.data: robot.stop()"),
        ("if robot.light.data < '100': robot.stop()", "if robot.light.data < 100: robot.stop()"),
        ("if robot.bumper.data == '1': robot.stop()", "if robot.bumper.data == 1: robot.stop()"),
    ],
)
def test_certain_remedies_are_fixes(block: str, repaired: str) -> None:
    assert fixed(action(block)) == action(repaired)


@pytest.mark.parametrize(
    ("block", "repaired"),
    [
        ("robot.distance < 0.3", "robot.distance.data < 0.3"),
        ("robot.bumper", "robot.bumper.data"),
        ("robot.bumper() == 1", "robot.bumper.data == 1"),
        ("robot.distanse.data < 0.3", "robot.distance.data < 0.3"),
        ("robot.bumper.data = 1", "robot.bumper.data == 1"),
    ],
)
def test_wrong_uses_in_a_condition_have_fixes(block: str, repaired: str) -> None:
    assert fixed(condition(block)) == condition(repaired)


def test_a_number_is_not_a_condition() -> None:
    (finding,) = check(condition("robot.light.data"))
    assert finding.code == "LRP508"
    assert finding.message == (
        "A condition is `True` or `False`, but `robot.light.data` is a number. Compare it with a number."
    )
    assert check(condition("robot.bumper.data")) == ()


def test_a_sensor_is_called_by_its_name() -> None:
    (finding,) = check(condition("robot.distance < 0.3"))
    assert finding.message == "`robot.distance` is the sensor; its value is `robot.distance.data`."


def test_the_directions_of_a_robots_sensors_are_known() -> None:
    def found(block: str, world: str) -> list[tuple[str, str]]:
        text = f"; world: {world}\n(machine m (state a (running [{block}]))) (spawn m a)"
        return [(each.code, each.message) for each in check(text)]

    everywhere = "print(robot.left.distance + robot.front.distance + robot.right.distance)"
    assert found(everywhere, "maze") == found(everywhere, "walls") == []
    (first, second) = found(everywhere, "line")
    assert first[0] == second[0] == "LRP520"
    assert first[1].startswith("`robot` has no `left`. It has `light`, `bumper`, `distance`, `front`, ")
    assert found("print(robot.rigt.distance)", "maze") == [
        ("LRP520", "`robot` has no `rigt`. Did you mean `right`?")
    ]
    sensor = "`robot.left` is the sensor; its value is `robot.left.distance`."
    assert found("print(robot.left + 1)", "maze") == [("LRP522", sensor)]
    text = "(machine m (state a (running [print(robot.left + 1)]))) (spawn m a)"
    with Session(text, SimBridge("maze")) as session:
        session.run(seconds=1)
        assert session.issues[0].message == sensor


def test_another_robot_is_a_value_and_neither_its_sensors_nor_a_condition_are() -> None:
    program = "; world: convoy\n(machine m (var me := [{}]) (state a) (state b) (on [{}] a -> b)) (spawn m a)"

    def found(value: str, condition: str) -> list[str]:
        return [each.code for each in check(program.format(value, condition))]

    assert found("robot.follower", "me.bumper.data == 1") == []
    assert found("robot.follower.odom", "me.x > 1") == ["LRP522"]
    assert found("robot", "robot.follower") == ["LRP522"]
    assert found("robot", "robot.follower < 1") == ["LRP522"]


# For which robot?


WRONG = "(machine m (state a (running [robot.moove(); robot.motorA.stop()])))(spawn m a)"


def codes(*args: object) -> list[str]:
    return [finding.code for finding in check(*args)]  # type: ignore[arg-type]


def test_without_a_world_nothing_is_assumed_about_the_robot() -> None:
    assert codes(WRONG) == codes(f"; world: none\n{WRONG}") == codes(f"; world: nowhere\n{WRONG}") == []
    assert codes(f"; world: line\n{WRONG}") == ["LRP520", "LRP520"]


def test_the_bridge_can_be_named_and_is_not_connected() -> None:
    assert codes(WRONG, (), "sim") == ["LRP520", "LRP520"]
    assert codes(WRONG, (), "ev3") == ["LRP520"]
    assert codes(WRONG, (), "ros") == codes(WRONG, (), "none") == []


def test_a_world_of_ones_own_has_the_members_of_its_robot(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    path = Path("mine.json")
    path.write_text('{"version": 1, "robots": [{"pose": [0.5, 0.5, 0], "bumper": false}], "size": [2, 2]}')
    text = f"; world: {path}\n(machine m (state a) (state b) (on [robot.bumper.data] a -> b))(spawn m a)"
    assert codes(text) == ["LRP520"]


def test_a_bridge_that_may_add_members_gives_no_false_alarm() -> None:
    def members(robot: Bare) -> None:
        robot.add_variable("light.data", lambda: 1, type=int)
        robot.add_method("go", lambda speed, turn=0: None)

    bridge = Bare(members)
    text = "(machine m (state a (running [{}])))(spawn m a)"
    assert codes(text.format("robot.later(); print(robot.light < 'x')"), (), bridge) == []
    bridge.open()
    assert codes(text.format("robot.later(); print(robot.light.data < 'x')"), (), bridge) == []
    assert codes(text.format("robot.go(1, speedy=1)"), (), bridge) == ["LRP521"]
    assert codes(text.format("robot.go(turn=1)"), (), bridge) == ["LRP521"]
    assert codes(text.format("robot.go(1, turn=1)"), (), bridge) == []


def test_a_session_checks_for_its_robot_before_and_after_it_is_opened() -> None:
    with Session("", "sim") as session:
        session.edit(WRONG)
        assert [finding.code for finding in session.findings] == ["LRP520", "LRP520"]
        session.open()
        session.edit(WRONG.replace("moove", "move"))
        assert [finding.code for finding in session.findings] == ["LRP520"]


def test_another_world_has_the_members_of_its_own_robot() -> None:
    text = "(machine m (state a (running [print(robot.distance.all)]))) (spawn m a)"
    bridge = SimBridge("line")
    assert codes(text, (), bridge) == ["LRP520"]
    bridge.load_world("maze")
    assert codes(text, (), bridge) == []
    with Session(text, bridge) as session:
        session.open()
        session.call(lambda: bridge.load_world("line"))
        assert [finding.code for finding in session.edit(text)] == ["LRP520"]


def test_the_public_check_knows_the_world_and_that_of_the_language_does_not() -> None:
    assert lrp_jupyter.check is check
    assert checks.check(f"; world: line\n{WRONG}") == ()


@pytest.mark.parametrize("block", ["robot.distance < 0.3", "robot.distance", "not robot.distance"])
def test_a_running_program_says_it_in_the_same_words(block: str) -> None:
    text = f"(machine m (state a) (state b) (on [{block}] a -> b))(spawn m a)"
    with Session(text, "sim") as session:
        session.run(seconds=1)
        (issue,) = session.issues
    assert issue.message == "`robot.distance` is the sensor; its value is `robot.distance.data`."


def test_a_command_is_not_a_condition() -> None:
    (finding,) = check(condition("robot.stop()"))
    assert (finding.code, finding.message) == (
        "LRP505",
        "`robot.stop` does something and has no value. Call it in an action, and write a test here.",
    )


def test_a_member_without_robot_is_recognized() -> None:
    assert fixed(action("stop()")) == action("robot.stop()")
    assert fixed(condition("distance.data < 1")) == condition("robot.distance.data < 1")


def test_a_module_that_is_not_imported_is_named() -> None:
    (finding,) = check(action("print(random.random())"))
    assert finding.message == "`random` is not imported. Write `import random` before it."


@pytest.mark.parametrize(
    ("action", "condition", "found"),
    [
        ("robot.go(1)", "robot.go.succeeded and robot.go.since > 1 or robot.go.status == 'lost'", []),
        ("robot.go(plac=1)", "True", [("LRP521", "Did you mean `place`?")]),
        ("robot.go(1)", "robot.go.sttaus == 'lost'", [("LRP520", "Did you mean `status`?")]),
        (
            "robot.go(1)",
            "robot.go(2)",
            [("LRP505", "Call it in an action, and test `robot.go.succeeded` here.")],
        ),
        (
            "robot.go(1)",
            "robot.go(2).succeeded",
            [("LRP505", "Call it in an action, and test `robot.go.succeeded` here.")],
        ),
        *[
            (block, "True", [("LRP505", "in a statement of its own, and read `robot.go.succeeded`.")])
            for block in (
                "print(robot.go(1).failed)",
                "if robot.go(1): pass",
                "done = robot.go(1); print(done)",
            )
        ],
        (
            "robot.go(1)",
            "robot.go",
            [("LRP524", "Its outcome is `robot.go.succeeded`")],
        ),
        ("robot.go(1)", "robot.go.status == 'failed'", [("LRP526", "`robot.go.status` is never 'failed'.")]),
        ("robot.go(1)", "robot.go.status", [("LRP508", "but `robot.go.status` is a text.")]),
        ("robot.go.status = 'lost'", "True", [("LRP523", "is read from the robot and cannot be assigned.")]),
    ],
)
def test_uses_of_a_task_are_checked_also_where_other_members_may_come(action, condition, found) -> None:
    text = f"(machine m (state a (running [{action}])) (state b) (on [{condition}] a -> b)) (spawn m a)"
    findings = check(text, bridge=Courier())
    assert [finding.code for finding in findings] == [code for code, _ in found]
    assert all(part in finding.message for finding, (_, part) in zip(findings, found, strict=True))


@pytest.mark.parametrize(
    ("form", "is_forgotten"),
    [
        ("(on [robot.go.succeeded] b -> c)", True),
        ("(on done b -> c)", False),  # an event is tested in all states in which it is used
        ("(on [robot.go.succeeded] {a b} -> c)", False),
        ("(on [robot.go.succeeded] * -> c)", False),
        ("(on [robot.go.active] b -> c)", False),
        ("(ontime 1 a -> b (effect [robot.go(2)])) (on [robot.go.succeeded] b -> c)", False),
        ("(ontime 1 a -> b (effect [with robot.go as go: pass])) (on [robot.go.succeeded] b -> c)", False),
        ("(state b (machine inner (state x (running [robot.go(2)]))) (onentry (spawn inner x)))", False),
    ],
)
def test_an_outcome_is_tested_where_the_task_is_asked_for(form, is_forgotten) -> None:
    states = "" if "(state b" in form else "(state b)"
    other = "(on [robot.go.succeeded] b -> c)" if not states else ""
    text = f"""(event done [robot.go.succeeded])
    (machine m (state a (running [robot.go(1)])) (state c) {states}
      (on [robot.go.failed] a -> b) {form} {other})
    (spawn m a)"""
    assert ("LRP560" in {finding.code for finding in check(text, bridge=Courier())}) is is_forgotten


def test_fields_of_a_message_are_arguments_however_deep_they_are_and_need_not_be_numbers() -> None:
    types = Types()
    types.add(HEADERS[1])
    stamped = types.message("geometry_msgs/PoseStamped")
    bridge = Bare(lambda robot: robot.add_task("go", lambda task, message: None, message=stamped))
    text = "(machine m (state a (running [robot.go({})]))) (spawn m a)"
    fine = "header_frame_id='map', pose_position_x=1.0, pose_orientation_w=1"
    assert check(text.format(fine), bridge=bridge) == ()
    (found,) = check(text.format("pose_positon_x=1.0"), bridge=bridge)
    assert "Did you mean `pose_position_x`?" in found.message
    (found,) = check(text.format("pose_position_x='1'"), bridge=bridge)
    assert "must be a number" in found.message
