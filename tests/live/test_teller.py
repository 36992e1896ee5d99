"""What a bridge is told of a run, by the hook that every author of a bridge can override."""

from __future__ import annotations

import json
import threading
from typing import Any

import pytest
from support.robots import Bare
from support.waiting import until

from lrp_jupyter.live.session import Session

DRIVES = """
(var far := [0.5])
(machine m
  (state ahead (running [robot.move(linear=0.1)]))
  (state back (onentry [robot.move()]))
  (state broken (running [1 / 0]))
  (on [robot.range.data < far] ahead -> back near)
  (ontime 200 back -> broken))
(spawn m ahead)
"""


class Told(Bare, offered=False):
    """A disarmed robot that keeps what it is told."""

    tells_why = True

    def __init__(self) -> None:
        super().__init__(hardware=True)
        self.told: list[dict[str, Any]] = []
        self.distance = 1.0

    def add_members(self) -> None:
        self.add_method("move", self.move, velocity=True)
        self.add_variable("range.data", lambda: self.distance)

    def tell(self, told: Any) -> None:
        self.told.append(json.loads(json.dumps(told, allow_nan=False)))

    def world_time(self) -> float:
        return 42.0  # s

    def events(self, kind: str) -> list[dict[str, Any]]:
        return [event for told in self.told for event in told["events"] if event["event"] == kind]


@pytest.fixture
def robot() -> Told:
    return Told()


@pytest.mark.filterwarnings("ignore:The bridge .* is disarmed")
def test_a_bridge_is_told_what_is_active_what_fired_and_why_also_disarmed(robot: Told) -> None:
    with Session(DRIVES, robot, name="drive") as session:
        session.run(0.3)
        robot.distance = 0.25
        session.run(0.1)
        assert robot.told[-1]["active"] == ["m/back"]
        assert robot.told[-1]["stamp"] == 42.0
        (fired,) = robot.events("fired")
        assert (fired["source"], fired["destination"], fired["line"]) == ("ahead", "back", 7)
        assert fired["values"] == {"robot.range.data": 0.25, "far": 0.5}
        because = "because `robot.range.data < far` was True (`robot.range.data` was 0.25 and `far` was 0.5)."
        assert fired["why"].endswith(because)
        session.run(0.4)
        (issue,) = robot.events("issue")
        assert (issue["line"], issue["code"], robot.told[-1]["active"]) == (6, "LRP601", ["m/broken"])
        kinds = {event["event"] for told in robot.told for event in told["events"]}
        assert kinds == {"started", "spawned", "entered", "left", "fired", "issue", "notice"}
        (notice,) = robot.events("notice")
        assert notice["kind"] == "disarmed"
        heard = len(robot.told)
        session.what_if(3, seconds=1.0)
        session.at(2)
        assert len(robot.told) == heard, "a fork tells nothing"
        session.edit(DRIVES.replace("1 / 0", "2 / 1"))
        (patched,) = robot.events("patched")
        assert patched["restarted"]
        assert "`running` of `m/broken` changed" in patched["changes"]
    assert (robot.told[-1]["program"], robot.told[-1]["status"]) == ("drive", "closed")


def test_a_bridge_is_told_of_a_block_that_does_not_return_and_of_what_happens_in_a_pause(robot: Told) -> None:
    robot.arm()
    held, going = threading.Event(), threading.Event()
    names = {"held": held, "going": going}
    text = "(machine m (state s (running [going.set() or held.wait()]))) (spawn m s)"
    with Session(text, robot, namespace=names, hung_after=0.05) as session:
        session.start()
        until(lambda: robot.told and robot.told[-1]["status"] == "hung")
        assert robot.told[-1]["reason"].startswith("`s.running` has run for")
        held.set()
        until(lambda: robot.told[-1]["status"] == "running")
        session.pause("Enough.")
        until(lambda: robot.told[-1]["status"] == "paused")
        assert robot.told[-1]["reason"] == "Enough."
        robot.set_status("lost", "It hung up.")
        until(lambda: robot.events("notice")[-1]["message"] == "It hung up.")


def test_a_bridge_that_fails_to_tell_is_a_notice_and_the_run_goes_on(robot: Told) -> None:
    def tell(_: object) -> None:
        raise OSError("no broker")

    robot.tell = tell  # type: ignore[method-assign]
    robot.arm()
    with Session(DRIVES, robot) as session:
        session.run(1.0)
        assert session.frame.tick == 10
    (notice,) = [each for each in robot.safety.notices if each.kind == "fault"]
    assert notice.text == "What happens could not be told: OSError: no broker."


@pytest.mark.parametrize(
    ("wants", "journal", "knows"), [(True, 10, True), (True, 0, False), (False, 10, False)]
)
def test_why_a_transition_fired_is_told_where_that_is_wanted_and_remembered(
    robot: Told, wants: bool, journal: int, knows: bool
) -> None:
    robot.arm()
    robot.tells_why, robot.distance = wants, 0.1
    with Session(DRIVES, robot, journal=journal) as session:
        session.run(0.3)
    (fired,) = robot.events("fired")
    assert ("why" in fired, "values" in fired) == (knows, knows)
    assert fired["transition"] == "near"
