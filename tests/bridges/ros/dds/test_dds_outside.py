"""What other nodes of ROS 2 see of a run: a stranger on the wire follows its states and its log."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from typing import Any

import pytest
from bridges.ros.test_seen_from_outside import PROGRAM, SETUP
from support.waiting import until

from lrp_jupyter.bridges.bridge import ConnectionState
from lrp_jupyter.bridges.ros import RosBridge
from lrp_jupyter.live.session import Session

pytestmark = pytest.mark.ros


def test_a_stranger_follows_the_states_and_reads_the_log_also_if_it_comes_late(
    peer: Any, connect: Callable[..., RosBridge]
) -> None:
    robot, follower = peer("writer light reliable", lease=2), peer("reader state reliable volatile")
    before = time.time()
    ros = connect(setup=SETUP, state_topic="/lrp/state", node="behaviour")
    with Session(PROGRAM, ros, name="light") as session:
        session.start()

        def states() -> list[dict[str, Any]]:
            return [json.loads(each["data"]) for each in follower.got("rt/lrp/state")]

        until(lambda: robot.do("light 42") or (states() and states()[-1]["active"] == ["m/dark"]))
        fired = [event for told in states() for event in told["events"] if event["event"] == "fired"]
        assert [(each["transition"], each["values"]) for each in fired] == [
            ("darkens", {"robot.light.data": 42})
        ]
        heard = len(follower.got("rt/lrp/state"))
        follower.do(
            "drop state", "reader state reliable transient_local", "reader rosout reliable transient_local"
        )
        until(lambda: len(follower.got("rt/lrp/state")) > heard)
        assert states()[-1]["active"] == ["m/dark"]
        until(lambda: any("LRP601" in each["msg"] for each in follower.got("rt/rosout")))
        log = [each for each in follower.got("rt/rosout") if each["file"] == "<lrp light>"]
        assert [(each["level"], each["msg"], each["line"]) for each in log][-2:] == [
            (20, "`light` has started.", 0),
            (40, "LRP601 ZeroDivisionError: division by zero", 3),
        ]
        assert all(before <= each["sec"] + 1 <= time.time() + 1 for each in log)
        assert {each["name"] for each in log} == {"behaviour"}

        # who follows the run is not the robot
        robot.kill()
        until(lambda: ros.status.state is ConnectionState.LOST)
