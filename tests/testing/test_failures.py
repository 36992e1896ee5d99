"""A failed test says what the sessions did that it used: where they went, and why not elsewhere."""

import importlib
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from lrp_jupyter import Session
from lrp_jupyter.testing import RobotStub, report

pytest_plugins = ["pytester"]

DARK = """
(machine m
  (state driving (running [robot.move(linear=0.2)]))
  (state waiting
    (onentry [robot.stop()] (spawn inner one))
    (machine inner (state one) (state two (onentry [1 / 0])) (ontime 300 one -> two)))
  (on [robot.light.data < 128] driving -> waiting dark)
  (on [robot.light.data >= 128] waiting -> driving light))
(spawn m driving)
"""
SESSION = f"""
from lrp_jupyter import Session
from lrp_jupyter.testing import RobotStub

def used(name="dark", seconds=1.0):
    robot = RobotStub.of("sim")
    robot.table({{"light.data": [(0, 255), (0.5, 20)]}})
    session = Session({DARK!r}, robot, name=name)
    session.run(seconds)
    return session
"""
REPORT = """\
At 1 s, after 10 ticks, `m/waiting/inner/two` was active.
The last transitions:
   0.5 s  m: driving → waiting  (on [robot.light.data < 128] driving -> waiting dark)
   0.8 s  m/waiting/inner: one → two  (ontime 300 one -> two)
In the last tick:
  `light` (line 8) did not fire at 0.9 s: `robot.light.data >= 128` was False (`robot.light.data` was 20). \
It was last true at 0.4 s, when `driving` was active.
LRP601 in line 6: ZeroDivisionError: division by zero"""


@pytest.fixture
def failed(pytester):
    """Run a test file with the plugin; return the output."""

    def run(text):
        pytester.makepyfile(sessions=SESSION)
        pytester.makepyfile(text)
        return pytester.runpytest_inprocess("-p", "no:cacheprovider").stdout

    return run


@pytest.mark.parametrize("how", ["open", "closed", "a fixture's"])
def test_a_failed_test_says_where_its_sessions_went_and_why_not_elsewhere(failed, how):
    texts = {
        "open": "session = used(); assert session.frame.is_active('driving')",
        "closed": "with used() as session: assert session.frame.is_active('driving')",
        "a fixture's": "assert session.frame.is_active('driving')",
    }
    output = failed(f"""
        import pytest
        from sessions import used
        @pytest.fixture
        def session():
            with used() as session: yield session
        def test_it({"session" if how == "a fixture's" else ""}):
            {texts[how]}
    """)
    output.fnmatch_lines_random(["*- lrp: dark -*"])
    output.fnmatch_lines([each.replace("[", "[[]") for each in REPORT.splitlines()], consecutive=True)
    assert str(output).count("lrp: dark") == 1


def test_only_the_sessions_that_the_failed_test_has_used_are_reported(failed):
    output = failed("""
        from sessions import used
        first = used("first")
        second = used("second")
        def test_that_passes():
            used("third")
        def test_that_fails():
            second.run(1)
            assert not second.frame.is_active("waiting")
    """)
    assert [name for name in ("first", "second", "third") if f"lrp: {name}" in str(output)] == ["second"]


def test_a_session_that_cannot_be_asked_hides_nothing(failed):
    output = failed("""
        from lrp_jupyter import Session
        def test_it():
            session = Session("(machine m (state a)) (spawn m a)", name="past", journal=0)
            session.run(1)
            assert not session.frame.is_active("a")
    """)
    output.fnmatch_lines(
        ["*assert not True*", "*- lrp: past -*", "At 1 s, after 10 ticks, `m/a` was active."]
    )


def test_the_same_can_be_asked_for():
    robot = RobotStub.of("sim")
    robot.table({"light.data": [(0, 255), (0.5, 20)]})
    with Session(DARK, robot) as session:
        assert report(session) == "At 0 s, after 0 ticks, nothing was active.\nNo transition has fired."
        session.run(1)
        assert report(session) == REPORT
    assert report(session) == REPORT


def test_a_closed_session_of_a_simulated_robot_can_still_evaluate_conditions():
    with Session(DARK, "sim", world="line") as session:
        session.run(0.5)
        before = report(session)
    assert "`robot.light.data` was" in before
    assert report(session) == before


def test_a_machine_that_was_started_alone_is_reported_without_those_around_it():
    with Session(DARK, RobotStub.of("sim"), start="inner") as session:
        session.run(0.2)
        assert report(session).splitlines() == [
            "At 0.2 s, after 2 ticks, `m/waiting/inner/one` was active.",
            "No transition has fired.",
            "In the last tick:",
            "  `300:one->two` (line 6) did not fire at 0.1 s: only 100 of 300 ms had passed since `one` was "
            "entered at 0 s, when `inner` started.",
        ]


def test_the_plugin_is_installed_with_the_package():
    project = Path(__file__).parents[2]
    about = tomllib.loads((project / "pyproject.toml").read_text(encoding="utf-8"))
    (name,) = about["project"]["entry-points"]["pytest11"].values()
    assert importlib.import_module(name).pytest_runtest_makereport


@pytest.mark.slow
def test_the_plugin_costs_nothing_where_no_test_uses_the_package(tmp_path):
    (tmp_path / "test_other.py").write_text(
        "import sys\n"
        "def test_it():\n"
        "    assert not [name for name in sys.modules if name == 'lrp_jupyter.live']\n"
        "    assert 0, 'this far'\n"
    )
    command = [
        sys.executable,
        "-m",
        "pytest",
        "-p",
        "no:cacheprovider",
        "--rootdir=.",
        ".",
    ]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert "AssertionError: this far" in done.stdout
    assert "- lrp: " not in done.stdout
