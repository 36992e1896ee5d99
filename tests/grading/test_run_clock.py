"""A clock that a block reads in a graded run is that of the run."""

import datetime
import random
import time
from types import ModuleType

import pytest
from support.tables import every

from lrp_jupyter.grading.challenges import Challenge
from lrp_jupyter.grading.criteria import drives
from lrp_jupyter.grading.grade import grade
from lrp_jupyter.grading.run_clock import with_run_clock

WAY = Challenge("way", "Drive 1 m.", "empty", drives(1), 7, hold=0)


def two_seconds(now):
    """Return a program that drives when it reads a clock for the first time, and stops two seconds later."""
    return f"""(var since := [None])
        (machine m
          (state driving (running [if since is None: since = {now}
                                   robot.move(linear=0.2)]))
          (state stopped (onentry [robot.stop()]))
          (on [{now} - since >= 2] driving -> stopped))
        (spawn m driving)"""


CLOCKS = [
    "__import__('time').time()",
    "__import__('time').monotonic_ns() / 1e9",
    "__import__('datetime').datetime.now().timestamp()",
]


@every("clock", CLOCKS)
def test_a_program_that_waits_by_a_clock_drives_as_far_in_every_run(clock):
    driven = [each.verdicts[0].reason for each in grade(two_seconds(clock), WAY, 2).attempts]
    assert driven == ["it drove 0.40 m"] * 2


@pytest.mark.parametrize("block", ["import time; time.sleep(2)", "from time import sleep as nap; nap(2)"])
def test_a_graded_run_does_not_sleep(block):
    text = two_seconds("elapsed").replace("robot.stop()", block)
    result = grade(text, WAY, 1)
    assert not result.points
    assert "line 5: `sleep` holds up the whole program" in str(result)
    assert "Use a state with `ontime` instead." in str(result)


def read(name, seconds=90.0):
    """Return what a block that imports `time` and `datetime` reads."""
    names = with_run_clock({}, lambda: seconds)
    return eval(f"[time, datetime, {name}][-1]", with_imports(names))


def with_imports(names):
    exec("import time, datetime, random", names)
    return names


READ = {
    "time.time()": 946684890.0,
    "time.perf_counter_ns()": 90_000_000_000,
    "time.gmtime()[:6]": (2000, 1, 1, 0, 1, 30),
    "time.gmtime(0)[0]": 1970,
    "str(datetime.datetime.now())": "2000-01-01 00:01:30",
    "str(datetime.datetime.now(datetime.UTC))": "2000-01-01 00:01:30+00:00",
    "datetime.datetime.utcnow() - datetime.datetime(2000, 1, 1)": datetime.timedelta(seconds=90),
    "str(datetime.date.today())": "2000-01-01",
    "time.strftime is time.strftime": True,
}


def test_every_clock_of_python_reads_the_time_of_the_run():
    assert {name: read(name) for name in READ} == READ


def test_a_clock_that_the_notebook_has_imported_is_that_of_the_run_too():
    names = with_run_clock({"time": time, "now": time.time, "date": datetime.date, "n": 0}, lambda: 1.0)
    assert isinstance(names["time"], ModuleType)
    assert names["time"].time() == names["now"]() == 946684801
    assert names["date"].today().year == 2000
    assert names["n"] == 0


def test_other_modules_and_other_code_are_left_alone():
    names = with_imports(with_run_clock({}, lambda: 0.0))
    assert names["random"] is random
    assert time.time() > 1e9
    assert datetime.date.today().year > 2000
