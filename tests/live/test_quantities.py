"""Numbers that the robot cannot mean: found where they are written, for this robot, with what to write."""

from __future__ import annotations

import pytest
from support.robots import Bare

from lrp_jupyter.bridges.message import Twist
from lrp_jupyter.live.running.checking import check
from lrp_jupyter.live.session import Session

PROGRAM = """; world: line
(var number := [VALUE])
(machine m (state a (running [ACTION])) (state b (running [robot.stop()])) (on [CONDITION] a -> b))
(spawn m a)"""


def program(action: str = "robot.move(linear=0.2)", condition: str = "True", value: str = "1") -> str:
    return PROGRAM.replace("ACTION", action).replace("CONDITION", condition).replace("VALUE", value)


def repaired(text: str, code: str, **names: object) -> str:
    """Apply the fix of the only finding of a text."""
    (finding,) = check(text, **names)
    assert finding.code == code
    assert finding.fix is not None
    fixed = finding.fix.apply(text)
    assert check(fixed, **names) == ()
    return fixed


@pytest.mark.parametrize(
    ("code", "wrong", "right"),
    [
        ("LRP537", "robot.move(linear=20)", "robot.move(linear=0.2)"),
        ("LRP537", "robot.move(linear=-20, angular=1)", "robot.move(linear=-0.2, angular=1)"),
        ("LRP537", "robot.move(angular=90)", "robot.move(angular=degrees(90))"),
        ("LRP537", "robot.turn_by(90)", "robot.turn_by(degrees(90))"),
        ("LRP537", "robot.turn_by(radians=-90)", "robot.turn_by(radians=degrees(-90))"),
        ("LRP537", "robot.turn_by(1.5, speed=90)", "robot.turn_by(1.5, speed=degrees(90))"),
        ("LRP537", "robot.drive_by(50)", "robot.drive_by(0.5)"),
        ("LRP537", "robot.drive_to(120, 0)", "robot.drive_to(1.2, 0)"),
        ("LRP537", "import math; print(degrees(math.pi / 2))", "import math; print(math.pi / 2)"),
        ("LRP537", "import math; print(math.sin(90))", "import math; print(math.sin(degrees(90)))"),
        ("LRP537", "robot.turn_by(degrees(1.57))", "robot.turn_by(1.57)"),
        ("LRP537", "import math; robot.turn_by(math.degrees(90))", "import math; robot.turn_by(degrees(90))"),
        ("LRP518", "robot.turn_by(0,5)", "robot.turn_by(0.5)"),
        ("LRP518", "robot.say('{robot.light.data}')", "robot.say(f'{robot.light.data}')"),
        ("LRP539", "robot.move(linear=0.2); robot.move(angular=1)", "robot.move(linear=0.2, angular=1)"),
    ],
)  # fmt: skip
def test_what_is_passed_to_the_robot_is_in_its_units(code: str, wrong: str, right: str) -> None:
    assert repaired(program(action=wrong), code) == program(action=right)


@pytest.mark.parametrize(
    ("code", "wrong", "right"),
    [
        ("LRP526", "robot.distance.data < 20", "robot.distance.data < 0.2"),
        ("LRP526", "20 > robot.front.distance", "0.2 > robot.front.distance"),
        ("LRP537", "robot.light.data < 0.2", "robot.light.data < 51"),
        ("LRP537", "robot.gyro.data > 90", "robot.gyro.data > degrees(90)"),
        ("LRP537", "abs(robot.gyro.data) > 90", "abs(robot.gyro.data) > degrees(90)"),
        ("LRP537", "robot.odom.theta < -45", "robot.odom.theta < degrees(-45)"),
        ("LRP537", "degrees(robot.gyro.data) > 90", "robot.gyro.data > degrees(90)"),
        ("LRP537", "elapsed > 2000", "elapsed > 2"),
    ],
)
def test_what_is_compared_is_in_the_units_of_the_robot(code: str, wrong: str, right: str) -> None:
    assert repaired(program(condition=wrong), code) == program(condition=right)


@pytest.mark.parametrize(
    ("code", "message", "condition"),
    [
        ("LRP526", "so `> 300` is never true. Compare it", "robot.light.data > 300"),
        ("LRP526", "so `>= -1` is always true. Compare it", "robot.light.data >= -1"),
        ("LRP526", "so `> 300` is false for everything in reach. Compare it", "robot.distance.data > 300"),
        ("LRP537", "so `< 1` is hardly ever true. Compare it", "robot.light.data < 1"),
        ("LRP526", "almost never exactly `0.2`. Compare with `<` or `>`.", "robot.distance.data == 0.2"),
        ("LRP526", "almost never exactly `degrees(90)`.", "robot.gyro.data == degrees(90)"),
        (
            "LRP526",
            "cannot be above 100 and below 50, so",
            "robot.light.data < 50 and robot.light.data > 100",
        ),
        ("LRP526", "cannot be above 50 and below 40, so", "50 < robot.light.data < 40"),
        (
            "LRP526",
            "above 50 or below 100, so this is always",
            "robot.light.data < 100 or robot.light.data > 50",
        ),
        ("LRP527", "any number but 0 counts as true.", "not robot.light.data"),
        ("LRP526", "`elapsed` is measured, so it is almost never exactly `2`.", "elapsed == 2"),
    ],
)
def test_a_comparison_that_tells_nothing_is_a_warning(code: str, message: str, condition: str) -> None:
    (finding,) = check(program(condition=condition))
    assert (finding.code, finding.severity) == (code, "warning")
    assert message in finding.message


@pytest.mark.parametrize(
    ("code", "value", "right", "use"),
    [
        ("LRP537", "20", "0.2", {"action": "robot.move(linear=number)"}),
        ("LRP537", "90", "degrees(90)", {"action": "robot.move(angular=number)"}),
        ("LRP526", "30", "0.3", {"condition": "robot.distance.data < number"}),
        ("LRP518", "0,15", "0.15", {"action": "robot.move(linear=number)"}),
        ("LRP518", "(0,15)", "0.15", {"action": "robot.move(linear=number)"}),
        ("LRP538", '"0.2"', "0.2", {"action": "robot.move(linear=number)"}),
        ("LRP538", '"0,2"', "0.2", {"action": "robot.drive_by(number)"}),
        ("LRP538", '"50"', "50", {"condition": "robot.light.data < number"}),
        ("LRP538", '"0"', "0", {"action": "number += 1"}),
        ("LRP538", '"0"', "0", {"action": "number = number + 1"}),
        ("LRP538", '"False"', "False", {"condition": "number"}),
        ("LRP538", '"True"', "True", {"action": "number = False"}),
    ],
)
def test_a_variable_is_mended_where_it_gets_its_value(
    code: str, value: str, right: str, use: dict[str, str]
) -> None:
    assert repaired(program(value=value, **use), code) == program(value=right, **use)


@pytest.mark.parametrize(
    "use",
    [
        {"action": "robot.move(linear=-0.5, angular=4)"},
        {"action": "robot.turn_by(6.3); number = 50"},
        {"action": "robot.drive_by(5)"},
        {"action": "robot.turn_by(degrees(360))"},
        {"action": "robot.say(number)", "value": '"0,5"'},
        {"action": "print(number[0] + number[1])", "value": "0,5"},
        {"action": "number = 0.2; robot.move(linear=number)", "value": '"20"'},
        {"action": "number = 0.2; robot.move(linear=number)", "value": "20"},
        {"action": "if robot.light.data < 50: robot.move(linear=0.1)\nelse: robot.move(linear=0.2)"},
        {"action": "robot.move(linear=0.1)\nif robot.bumper.data: robot.stop()"},
        {"action": "robot.stop(); robot.move(linear=0.1)"},
        {"action": "robot.move(linear=0.1); robot.say('hello'); robot.lamp()"},
        {"action": "for speed in 1, 2:\n  if speed > number:\n    robot.move(linear=speed / 10)\n    break"},
        {"condition": "robot.distance.data < 2 or robot.distance.data > 2"},
        {"condition": "robot.distance.data == float('inf')"},
        {"condition": "robot.light.data == 255 or robot.light.data < 1.5"},
        {"condition": "robot.gyro.data > degrees(1000)"},
        {"condition": "robot.odom.x > 20"},
        {"condition": "40 < robot.light.data < 50 or robot.light.data > 200"},
        {"condition": "robot.light.data < 50 or robot.light.data > 100"},
        {"condition": "robot.light.data > 50 and robot.light.data < 100"},
        {"condition": "robot.light.data < 50 and (robot.light.data > 100 or robot.bumper.data)"},
        {"action": "robot.say('{robot.light.data}'.format(robot=robot) + '{number}')"},
        {"action": "number = 0.2\nif robot.bumper.data: number += 1\nrobot.move(linear=number)"},
        {"condition": "elapsed > 30"},
        {"condition": "elapsed * 1000 > 2000"},
    ],
)
def test_numbers_that_can_be_meant_have_no_findings(use: dict[str, str]) -> None:
    assert check(program(**use)) == ()


def test_the_ranges_are_those_of_the_robot_and_without_any_nothing_is_said() -> None:
    def members(robot: Bare) -> None:
        robot.add_variable("sonar.data", lambda: 0, "", "cm", type=float)
        robot.add_variable("grey.data", lambda: 0, type=int, limits=(0, 1023))
        robot.add_method("move", lambda message: None, message=Twist)
        robot.add_method("cruise", lambda speed=1: None, limits={"speed": 30})
        robot.add_task("lift", lambda task, height: None, likely={"height": (0, 2)}, units={"height": "m"})

    class Whole(Bare):
        complete = True

    def found(block: str) -> list[tuple[str, str]]:
        text = f"(machine m (state a (running [{block}]))) (spawn m a)"
        return [(each.code, each.message) for each in check(text, bridge=Whole(members))]

    assert found("if robot.sonar.data < 20: robot.move(linear=20, angular=90)") == []
    assert found("if robot.grey.data < 300: robot.cruise(30)") == []
    assert found("robot.cruise(speed=-31)") == [
        ("LRP537", "`speed` is limited to -30. Write at least `-30`.")
    ]
    assert found("robot.lift(150)") == [
        ("LRP537", "150 m is too far for `robot.lift`. For 150 cm, write `1.5`.")
    ]
    ((code, message),) = found("if robot.grey.data > 2000: robot.cruise(1)")
    assert code == "LRP526"
    assert message.startswith("`robot.grey.data` is a number from 0 to 1023, so `> 2000` is never true.")


def test_a_delay_of_less_than_a_tick_is_rather_in_seconds() -> None:
    text = "(var pause := [{}]) (machine m (state a) (state b) ({} b -> a) (eps a -> b)) (spawn m a)"
    for before, after in (("2", "2000"), ("0.5", "500"), ("30", "30000")):
        variable = text.format(before, "ontime pause")
        assert repaired(variable, "LRP411") == text.format(after, "ontime pause")
        block = text.format(1, f"ontime [{before}]")
        assert repaired(block, "LRP411") == text.format(1, f"ontime [{after}]")
    assert repaired(text.format(1, "ontime 2"), "LRP411") == text.format(1, "ontime 2000")
    assert repaired(text.format(1, "on [dt > 0] for 2"), "LRP411") == text.format(1, "on [dt > 0] for 2000")
    for right in ("ontime 0", "ontime 100", "ontime [pause * 1000]"):
        assert check(text.format(1, right)) == ()


def test_a_delay_is_compared_with_the_ticks_of_the_session() -> None:
    text = "(machine m (state a) (state b) (ontime 30 b -> a) (eps a -> b)) (spawn m a)"
    for rate, codes in ((10, ["LRP411"]), (50, []), (0, [])):
        with Session(text, rate=rate) as session:
            assert [finding.code for finding in session.check(text)] == codes


def test_a_loop_of_commands_is_one_command() -> None:
    (finding,) = check(program(action="for i in range(9):\n  robot.move(linear=0.2)"))
    assert finding.code == "LRP539"
    assert "only its last `robot.move` counts" in finding.message
    (finding,) = check(program(action="robot.drive_by(1)\nrobot.turn_by(1)"))
    assert finding.code == "LRP539"
    assert "`robot.turn_by` in line 4 replaces it" in finding.message
    assert finding.message.endswith("with a transition `(on [robot.drive_by.succeeded] …)` between them.")
    (finding,) = check(program(action="robot.move(linear=0.2)] [robot.stop()"))
    assert (finding.code, finding.fix) == ("LRP539", None)


def test_what_counts_from_the_same_number_at_every_tick_is_no_counter() -> None:
    (finding,) = check(program(action="number = 0; number += 1"))
    assert finding.code == "LRP544"
    assert finding.message.endswith("Move this line into `onentry`.")
    (finding,) = check(program(action="laps = 0\nlaps = laps + 1\nprint(laps)"))
    assert finding.code == "LRP544"
    assert finding.message.endswith("Declare `(var laps := [0])`, and remove this line.")
