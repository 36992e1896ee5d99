"""The page about tests is true: its tests pass, and fail as it shows where its program is changed."""

import re
from contextlib import suppress
from pathlib import Path

import pytest

from lrp_jupyter import Session, VirtualClock
from lrp_jupyter.bridges import MemberError
from lrp_jupyter.cli.runs_command import decide_runs
from lrp_jupyter.errors import StaleData
from lrp_jupyter.grading.workers import HowRun
from lrp_jupyter.testing import RobotStub

pytest_plugins = ["pytester"]

PAGE = (Path(__file__).parents[2] / "notebooks" / "test-a-behaviour.md").read_text(encoding="utf-8")
(PROGRAM,) = re.findall(r"^```lrp\n(.*?)^```", PAGE, re.M | re.S)
TEST, SHOWN = re.findall(r"^```python\n(.*?)^```", PAGE, re.M | re.S)
(EXPECTED,) = re.findall(r"^```toml\n(.*?)^```", PAGE, re.M | re.S)
PRINTED, DECIDED = re.findall(r"^```text\n(.*?)^```", PAGE, re.M | re.S)


@pytest.fixture
def tested(pytester):
    """Run the tests of the page on a program; return their result."""

    def run(program):
        (pytester.path / "guard.lrp").write_text(program, encoding="utf-8")
        (pytester.path / "test_guard.py").write_text(TEST, encoding="utf-8")
        return pytester.runpytest_inprocess("-p", "no:cacheprovider")

    return run


def test_the_tests_of_the_page_pass(tested):
    tested(PROGRAM).assert_outcomes(passed=3)


def test_a_test_that_fails_prints_what_the_page_shows(tested):
    assert "changes `near` to `0.25`" in PAGE
    result = tested(PROGRAM.replace("[0.4]", "[0.25]"))
    result.assert_outcomes(passed=2, failed=1)
    assert PRINTED in f"{result.stdout}\n"


@pytest.mark.slow
def test_the_runs_are_decided_about_as_the_page_shows(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for name in ("close call", "corridor", "first wall"):
        with Session(PROGRAM, "sim", VirtualClock(), world="maze", name="guard") as session:
            session.run(20)
            session.keep(name)
    Path("guard.runs", "expected.toml").write_text(EXPECTED, encoding="utf-8")
    Path("guard.lrp").write_text(PROGRAM.replace("[0.4]", "[0.7]"), encoding="utf-8")
    assert decide_runs("guard.lrp", [], HowRun(), coverage=False, junit=None, trusted=False) == 1
    assert capsys.readouterr().out == DECIDED


def test_the_commands_are_those_that_the_page_shows():
    robot = RobotStub.of("sim", world="maze")
    robot.table({"distance.data": [(0, 2.0), (1.5, 0.3)]})
    with Session(PROGRAM, robot) as session:
        session.run(until="blocked", seconds=5)
    assert f">>> robot.commands\n{robot.commands!r}\n" == SHOWN


def test_every_line_of_the_table_can_be_written():
    rows = re.findall(r"^\| `(robot.*?)` \|", PAGE, re.M)
    assert len(rows) == 7
    setup = Path(__file__).parents[2] / "notebooks" / "ros" / "robot.json"
    robots = [RobotStub.of("sim"), RobotStub.of("ros", setup=setup), RobotStub.of("ev3")]
    for row in rows:
        done = []
        for robot in robots:
            with suppress(MemberError):  # of a robot without that member
                exec(row, {"robot": robot, "StaleData": StaleData})
                done.append(robot)
        assert done, row
