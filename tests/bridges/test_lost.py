"""A robot that is lost: stopped once, commanded no more, and stopped again when it is found."""

from __future__ import annotations

import threading

import pytest
from support.robots import Bare

from lrp_jupyter.bridges.bridge import ConnectionState
from lrp_jupyter.errors import BridgeError
from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.recording import read_recording
from lrp_jupyter.live.reproduction import reproduce
from lrp_jupyter.live.session import Session


@pytest.fixture
def boat() -> Bare:
    """A boat with a radio, which the test switches off; open and armed."""

    def members(boat: Bare) -> None:
        boat.add_method("move", boat.move, "drive, in m/s")
        boat.add_method("depth", lambda: 3, "of the water, in m", command=False)

    boat = Bare(members, notes="stop", hardware=True)
    boat.open()
    boat.set_status("connected", "The boat is on the water.")
    boat.arm()
    return boat


def elsewhere(boat: Bare, state: str, sentence: str = "") -> None:
    """Set the status on another thread, as a library's callback does."""
    thread = threading.Thread(target=boat.set_status, args=(state, sentence))
    thread.start()
    thread.join()


def tick(boat: Bare, at: float) -> None:
    boat.begin_tick(at, 0.1)
    boat.end_tick(at)


def test_a_lost_robot_is_stopped_once_and_that_is_logged(boat):
    boat.robot.move(linear=0.2)
    elsewhere(boat, "lost", "The radio is silent.")
    elsewhere(boat, "lost", "The radio is still silent.")
    assert boat.calls == [0.2, "stop"]
    assert [notice.text for notice in boat.safety.notices if notice.kind == "fault"] == [
        "The radio is silent."
    ]
    assert boat.status.sentence == "The radio is still silent."


@pytest.mark.parametrize("state", ["lost", "connecting", "disconnected"])
def test_until_it_is_found_it_gets_no_command(boat, state):
    elsewhere(boat, "lost", "The radio is silent.")
    elsewhere(boat, state, "The radio is silent.")
    del boat.calls[:]
    with pytest.raises(BridgeError, match=r"^`robot\.move` was not sent: The radio is silent\.$"):
        boat.robot.move(linear=0.2)
    assert boat.calls == []
    assert boat.safety.commands[-1].sent is False
    assert boat.robot.depth() == 3, "a question is for the bridge to answer"


@pytest.mark.parametrize("state", ["connected", "waiting for data", "stale"])
def test_when_it_is_found_it_is_stopped_first_and_gets_nothing_a_second_time(boat, state):
    boat.robot.move(linear=0.2)
    elsewhere(boat, "lost")
    with pytest.raises(BridgeError):
        boat.robot.move(linear=0.9)
    del boat.calls[:]
    elsewhere(boat, state, "The radio speaks again.")
    assert boat.calls == ["stop"]
    assert boat.status.sentence == "The radio speaks again."
    boat.robot.move(linear=0.1)
    assert boat.calls == ["stop", 0.1]


def test_a_robot_that_was_never_commanded_is_left_alone_when_it_is_found(boat):
    elsewhere(boat, "lost")
    del boat.calls[:]
    elsewhere(boat, "connected")
    assert boat.calls == []


def test_a_bridge_that_stops_what_it_finds_is_not_asked_to(boat):
    boat.stops_when_found = True  # type: ignore[misc]
    boat.robot.move(linear=0.2)
    elsewhere(boat, "lost")
    elsewhere(boat, "connected")
    assert boat.calls == [0.2, "stop"]


def test_a_robot_that_is_lost_again_while_it_is_stopped_stays_lost(boat):
    boat.robot.move(linear=0.2)
    elsewhere(boat, "lost", "The radio is silent.")
    boat.stop = lambda: boat.set_status("lost", "It broke again.")  # type: ignore[method-assign]
    elsewhere(boat, "connected")
    assert boat.status.state is ConnectionState.LOST
    with pytest.raises(BridgeError, match="It broke again"):
        boat.robot.move()


def test_a_disarmed_robot_that_is_lost_still_shows_its_commands(boat):
    boat.disarm()
    elsewhere(boat, "lost")
    boat.robot.move(linear=0.2)
    assert boat.safety.commands[-1].arguments == {"linear": 0.2}


def test_what_a_closed_connection_says_is_left_out(boat):
    boat.close()
    elsewhere(boat, "lost", "The socket is closed.")
    assert boat.status.state is ConnectionState.DISCONNECTED
    boat.open()
    boat.arm()
    boat.robot.move(linear=0.2)


@pytest.mark.parametrize("hook", ["sense", "act"])
def test_a_hook_that_works_again_has_found_the_robot(boat, hook):
    boat.robot.move(linear=0.2)
    boat.failing[hook] = OSError("unplugged")
    tick(boat, 0.0)
    tick(boat, 0.1)
    assert boat.status.sentence == f"`{hook}` raised OSError: unplugged."
    assert boat.calls == [0.2, "stop"]
    with pytest.raises(BridgeError, match="unplugged"):
        boat.robot.move(linear=0.2)
    del boat.failing[hook]
    tick(boat, 0.2)
    assert boat.status.sentence == "The boat is on the water."
    assert boat.calls == [0.2, "stop", "stop"]
    tick(boat, 0.3)
    boat.robot.move(linear=0.3)
    assert boat.calls == [0.2, "stop", "stop", 0.3]


def test_a_hook_that_works_again_does_not_find_a_robot_that_is_lost_otherwise(boat):
    boat.failing["sense"] = OSError("unplugged")
    tick(boat, 0.0)
    elsewhere(boat, "lost", "The radio is silent.")
    boat.failing.clear()
    tick(boat, 0.1)
    assert boat.status.sentence == "The radio is silent."


PROGRAM = """(var count := [0])
(machine m (state a (running [robot.move(linear=0.2); count += 1]))) (spawn m a)"""


def test_a_program_goes_on_without_its_robot_and_a_replay_is_the_same(boat, tmp_path):
    path = tmp_path / "run.lrplog"
    with Session(PROGRAM, boat, clock=VirtualClock()) as session:
        boat.arm()
        with session.record(path):
            session.run(0.5)
            elsewhere(boat, "lost", "The radio is silent.")
            session.run(0.5)
            (issue,) = session.issues
            why = session.why("robot.move")
            assert "It was not sent: The radio is silent." in str(why)
            assert issue.message.endswith("`robot.move` was not sent: The radio is silent.")
            elsewhere(boat, "connected")
            session.run(0.5)
        assert session.frame.variables[("count",)] == "10"
        assert [(command.name, command.sent) for command in boat.safety.commands] == [
            ("move", True),
            ("move", False),
            ("move", True),
        ]
        assert not [issue for issue in session.issues if not issue.resolved]
    again = reproduce(read_recording(path))
    assert again.difference is None
    assert again.session.frame.variables[("count",)] == "10"


def test_a_run_goes_on_after_a_hook_of_its_life_has_failed(boat):
    with Session(PROGRAM, boat, clock=VirtualClock()) as session:
        session.run(0.2)
        boat.failing["on_resume"] = OSError("unplugged")
        session.run(0.2)
        assert "`on_resume` raised OSError" in boat.safety.notices[-2].text
        assert boat.status.state is ConnectionState.CONNECTED, "its next tick went well"
