"""The bridge to a serial line: a pseudo-terminal with a simulated robot at its other end."""

from __future__ import annotations

import os
import subprocess
import time
import tty
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

import pytest
from bridges.own.conftest import EXAMPLES, WAYS, OfARobot, does_tasks, drives_and_senses
from support.waiting import until

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.discovery import make_bridge
from lrp_jupyter.errors import BridgeError, NoDataYet

pytest.importorskip("serial")

SERIAL = str(EXAMPLES / "serial_line.py")

Driving = Callable[..., "subprocess.Popen[str]"]


class Line:
    """The robot's end of a pseudo-terminal, in the hands of a test."""

    def __init__(self, link: Path) -> None:
        self.link = link
        self.plug_in()

    def plug_in(self) -> None:
        self._told = b""
        self.end, self._device = os.openpty()
        tty.setraw(self._device)
        os.set_blocking(self.end, False)
        self.link.unlink(missing_ok=True)
        self.link.symlink_to(os.ttyname(self._device))

    def unplug(self) -> None:
        self.link.unlink(missing_ok=True)
        os.close(self.end)
        os.close(self._device)

    def say(self, text: str) -> None:
        os.write(self.end, text.encode())

    def told(self) -> list[str]:
        with suppress(BlockingIOError):
            self._told += os.read(self.end, 4096)  # maybe half a line
        return self._told.decode().splitlines()


@pytest.fixture
def line(tmp_path: Path) -> Iterator[Line]:
    line = Line(tmp_path / "robot")
    yield line
    line.unplug()


@pytest.fixture
def bridge(line: Line, monkeypatch: pytest.MonkeyPatch) -> Iterator[Bridge]:
    """Open and armed; what it was told is not old, however long a test is held up."""
    monkeypatch.setattr("lrp_jupyter.bridges.link._CALM", 0.01)
    bridge = make_bridge(SERIAL, port=str(line.link))
    bridge.fed.clock = lambda: 0.0
    bridge.stopper = lambda: None  # type: ignore[method-assign]
    bridge.open()
    bridge.arm()
    yield bridge
    bridge.close()


def value_of(bridge: Bridge, name: str) -> object:
    bridge.refresh()
    return bridge.describe(name).value


@pytest.fixture
def link(tmp_path: Path) -> Iterator[Path]:
    """Where the line of a robot is; the guard of one test must not reach the robot of the next one."""
    yield tmp_path / "robot"
    (tmp_path / "robot").unlink()


@pytest.mark.slow
class TestSerialLine(OfARobot):
    link = Path()

    @classmethod
    def start(cls) -> None:
        cls.link = cls.processes.folder / "robot"
        cls.robot = cls.processes.robot("serial", cls.link, 1.0)
        cls.told = cls.processes.told(cls.robot)

    def make(self) -> Bridge:
        return make_bridge(SERIAL, port=str(self.link))


@pytest.mark.slow
def test_it_drives_as_it_is_told_and_says_what_it_senses(processes, link):
    told = processes.told(processes.robot("serial", link, 1.0))
    bridge = make_bridge(SERIAL, port=str(link))
    bridge.open()
    bridge.arm()
    drives_and_senses(bridge, lambda: told)
    bridge.close()


@pytest.mark.slow
def test_a_program_with_tasks_runs_as_in_the_simulator(processes, link):
    told = processes.told(processes.robot("serial", link, 4.0))
    does_tasks(SERIAL, lambda: told, port=str(link))


@pytest.mark.slow
@WAYS
def test_the_guard_stops_the_robot_when_this_process_is_killed(driven, processes, driving, link):
    told = processes.told(processes.robot("serial", link, 1.0))
    driving(told, "serial_line.py", driven, port=link).kill()
    until(lambda: told[-1] == "drives 0.000 0.000", "it was not stopped")


@pytest.mark.slow
def test_the_robot_itself_ends_a_task_of_which_it_hears_no_more(processes, link):
    told = processes.told(processes.robot("serial", link, 1.0, 0.5))
    bridge = make_bridge(SERIAL, port=str(link))
    bridge.open()
    bridge.arm()
    bridge.robot.turn_by(100)
    until(lambda: "turns by 100.000" in told, "it does not turn")
    until(lambda: told[-1] == "drives 0.000 0.000", "it turns on")

    def has_failed() -> bool:
        bridge.begin_tick(0.0, 0.1)
        bridge.end_tick(0.0)
        return bridge.robot.turn_by.failed

    until(has_failed, "the robot does not say that it has stopped")
    assert bridge.robot.turn_by.reason == "No line has reached the robot for half a second."
    bridge.close()


def test_a_line_that_is_lost_on_either_way_is_sent_again(line, bridge):
    def tick() -> None:
        bridge.begin_tick(0.0, 0.1)
        bridge.end_tick(0.0)

    line.say("light 7\nbumper 0\n")
    until(lambda: value_of(bridge, "bumper.data") == 0, "nothing arrives")
    bridge.robot.turn_by(1)
    until(lambda: "turn 1.000 1" in line.told(), "nothing was sent")
    before = line.told().count("turn 1.000 1")
    tick()
    until(lambda: line.told().count("turn 1.000 1") > before, "it was sent once")
    line.say("d?ne 1\ndone 2\ndone\n")
    line.say("light 8\n")
    until(lambda: value_of(bridge, "light.data") == 8, "nothing arrives")
    tick()
    assert bridge.robot.turn_by.active
    line.say("done 1\nlight 9\n")
    until(lambda: value_of(bridge, "light.data") == 9, "nothing arrives")
    tick()
    assert bridge.robot.turn_by.succeeded
    count = line.told().count("turn 1.000 1")
    tick()
    bridge.robot.move(linear=0.1)
    until(lambda: "move 0.100 0.000" in line.told(), "nothing was sent")
    assert line.told().count("turn 1.000 1") == count


def test_readings_arrive_though_their_lines_come_in_pieces(line, bridge):
    line.say("light 2")
    line.say("12\nbump")
    until(lambda: value_of(bridge, "light.data") == 212, "the first line did not arrive")
    line.say("er 1\n")
    until(lambda: value_of(bridge, "bumper.data") == 1, "the second line did not arrive")


def test_what_is_no_reading_is_told_and_the_others_come_on(line, bridge):
    line.say("Traceback (most recent call last):\nlight 7\n")
    until(lambda: value_of(bridge, "light.data") == 7, "the next line did not arrive")
    assert any("Traceback (most recent call last):" in notice.text for notice in bridge.safety.notices)


def test_what_the_robot_says_rarely_is_never_late(line, bridge):
    line.say("light 7\nbumper 0\nbattery 7.4\n")
    until(
        lambda: "battery" in dir(bridge.robot) and value_of(bridge, "battery.data") == 7.4, "nothing arrives"
    )
    bridge.fed.clock = lambda: time.monotonic() + 60
    with pytest.raises(NoDataYet, match="stale"):
        _ = bridge.robot.light.data
    assert bridge.robot.battery.data == 7.4


def test_a_command_is_a_line_of_text(line, bridge):
    line.say("light 7\nbumper 0\n")
    until(lambda: value_of(bridge, "bumper.data") == 0, "nothing arrives")
    bridge.robot.move(linear=0.2, angular=-1)
    until(lambda: "move 0.200 -1.000" in line.told(), "nothing was sent")


def test_an_unplugged_robot_is_lost_and_found_when_it_is_plugged_in_again(line, bridge):
    line.unplug()
    until(lambda: bridge.status.state == "lost", "it was not noticed")
    with pytest.raises(BridgeError):
        bridge.robot.move(linear=0.2)
    line.plug_in()
    until(lambda: bridge.status.state != "lost", "it was not found again")
    line.say("light 9\n")
    until(lambda: value_of(bridge, "light.data") == 9, "nothing arrives")
    assert not [told for told in line.told() if told.startswith("move 0.2")], "an old command was sent again"


def test_a_line_that_is_not_there_is_told_with_its_name(tmp_path):
    with pytest.raises(BridgeError, match=r"`.*nowhere` cannot be opened: .*Plug the robot in"):
        make_bridge(SERIAL, port=str(tmp_path / "nowhere")).open()


def test_a_speed_that_is_no_number_is_told_with_its_name():
    with pytest.raises(BridgeError, match=r"`baud.*fast`"):
        make_bridge(SERIAL, port="/dev/ttyACM0", baud="fast")
