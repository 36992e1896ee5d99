"""Actions and services over rosbridge where the robot's side is in memory: ROS 2, and faults of a line."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

import pytest
from support.waiting import until

from lrp_jupyter.bridges.ros import RosBridge
from lrp_jupyter.bridges.ros.definitions import HEADERS, Definition, FieldType
from lrp_jupyter.bridges.ros.link import GUARD_NODE
from lrp_jupyter.errors import BridgeError
from lrp_jupyter.live.session import Session

Make = Callable[..., RosBridge]

NAVIGATE = "nav2_msgs/Navigate"
PARTS = {
    f"{NAVIGATE}_Goal": {"pose": FieldType("geometry_msgs/PoseStamped")},
    f"{NAVIGATE}_Feedback": {"left": FieldType("float64")},
    f"{NAVIGATE}_Result": {"taken": FieldType("float64")},
    "lamps/Switch_Request": {"on": FieldType("bool")},
    "lamps/Switch_Response": {"said": FieldType("string")},
}


@pytest.fixture
def ros2(graph: Any, server: Any) -> Any:
    """The graph of a ROS 2, with two actions and a service."""
    graph.is_ros2 = server.is_recent = True
    graph.definitions |= HEADERS[2] | {name: Definition(name, fields) for name, fields in PARTS.items()}
    graph.actions |= {"/navigate": NAVIGATE, "/dock": NAVIGATE}
    graph.services["/lamp"] = ("lamps/Switch", lambda values: {"said": "on" if values["on"] else "off"})
    return graph


@pytest.fixture
def ros(make: Make, ros2: Any) -> RosBridge:
    bridge = make()
    bridge.open()
    bridge.arm()
    until(lambda: bridge.live.get("action"))
    bridge.action("drive_to", "/navigate")
    bridge.publish("move", "/cmd_vel")
    until(lambda: [channel.handle for channel in bridge.wiring.channels if channel.handle][1:])
    return bridge


def goal(graph: Any, x: float) -> Any:
    """The goal with this target, when it has come."""
    found = until(lambda: [g for g in tuple(graph.goals.values()) if target(g) == x])
    return found[0]


def target(goal: Any) -> float:
    return float(goal.values["pose"]["pose"]["position"]["x"])


def latched(ros: RosBridge, name: str = "drive_to") -> tuple[str | None, str]:
    """What a tick sees."""
    ros.begin_tick(0.0, 0.1)
    ros.end_tick(0.0)
    task = getattr(ros.robot, name)
    return task.status, task.reason


def drive(ros: RosBridge, x: float) -> None:
    latched(ros)  # a tick in which it was stopped is over
    ros.robot.drive_to(pose_pose_position_x=x)


def test_a_goal_of_ros_2_holds_up_neither_commands_nor_its_own_cancel(
    ros: RosBridge, ros2: Any, server: Any
) -> None:
    drive(ros, 1.0)
    first = goal(ros2, 1.0)
    first.feedback({"left": 0.5})
    until(lambda: latched(ros) and ros.robot.drive_to.feedback)
    assert ros.robot.drive_to.feedback.left == 0.5
    ros.robot.move(linear=0.2)
    until(lambda: ros2.heard)
    drive(ros, 2.0)  # another one, while the server is busy with the first, which it replaces
    second = goal(ros2, 2.0)
    until(lambda: first.cancels)
    assert not second.cancels
    second.end(4, taken=3.5)
    until(lambda: latched(ros) == ("succeeded", ""))
    assert ros.robot.drive_to.result.taken == 3.5
    sent = [each for each in server.requests if each["op"] == "send_action_goal"]
    assert {each["action_type"] for each in sent} == {"nav2_msgs/action/Navigate"}
    assert server.log == []


def test_a_cancel_is_repeated_until_the_goal_has_ended(ros: RosBridge, ros2: Any) -> None:
    ros2.accepts = False  # rosbridge ignores the cancel of a goal that is not accepted yet
    drive(ros, 1.0)
    late = goal(ros2, 1.0)
    ros.stop_all()
    until(lambda: late.cancels > 1)
    late.is_accepted = True
    until(lambda: late.outcome)
    assert latched(ros) == ("cancelled", "The robot was stopped.")
    until(lambda: ros.panel().tables[0].rows[0][-1].startswith("cancelled"))


@pytest.mark.parametrize(("number", "status"), [(0, "rejected"), (5, "cancelled"), (6, "aborted")])
def test_each_end_has_its_own_status(ros: RosBridge, ros2: Any, number: int, status: str) -> None:
    drive(ros, 1.0)
    goal(ros2, 1.0).end(number, taken=0.0)
    until(lambda: latched(ros)[0] == status)


def test_a_goal_whose_server_is_not_there_or_gone_is_lost(ros: RosBridge, ros2: Any) -> None:
    drive(ros, 1.0)
    first = goal(ros2, 1.0)
    del ros2.actions["/navigate"]
    until(lambda: latched(ros)[0] == "lost")
    assert latched(ros)[1].startswith("No node offers the action `/navigate`.")
    until(lambda: first.cancels)  # in case that it goes on
    drive(ros, 2.0)
    until(lambda: latched(ros)[0] == "lost")
    assert [target(each) for each in ros2.goals.values()] == [1.0]


def test_a_goal_of_a_line_that_was_cut_is_lost_in_a_sentence_and_cancelled_when_it_is_back(
    make: Make, ros2: Any, wire: Any
) -> None:
    ros = make(port=wire.port, setup={"actions": {"drive_to": {"action": "/navigate", "type": NAVIGATE}}})
    ros.open()
    ros.arm()
    until(lambda: ros.wiring.channels[0].handle)
    drive(ros, 1.0)
    first = goal(ros2, 1.0)
    wire.cut()
    until(lambda: latched(ros)[0] == "lost")
    sentence = f"The connection to `ws://127.0.0.1:{wire.port}` is lost. It was cut."
    assert latched(ros)[1] == sentence
    until(lambda: any(notice.text == sentence for notice in ros.safety.notices))
    until(lambda: first.cancels)


def test_a_guard_cancels_the_goals_of_every_client(
    ros: RosBridge, make: Make, ros2: Any, request: pytest.FixtureRequest
) -> None:
    ros.remove("move")  # an action is enough for a guard
    drive(ros, 1.0)
    first = goal(ros2, 1.0)
    request.getfixturevalue("guarded")
    stopper = ros.stopper()
    assert stopper is not None
    guard = make(node=GUARD_NODE, setup=stopper.arguments["setup"])
    guard.open()
    guard.stop()
    until(lambda: first.outcome)
    until(lambda: latched(ros)[0] == "cancelled")


def test_a_velocity_that_is_overdue_ends_no_goal(ros: RosBridge, ros2: Any) -> None:
    drive(ros, 1.0)
    first = goal(ros2, 1.0)
    ros.begin_tick(0.1, 0.1)
    ros.robot.move(linear=0.2)
    ros.end_tick(0.1)
    ros.begin_tick(2.0, 0.1)
    ros.end_tick(2.0)
    until(lambda: [values["linear"]["x"] for _, values in ros2.heard][-1:] == [0.0])
    assert not first.cancels
    ros.stop_all()
    until(lambda: first.cancels)


def test_a_service_that_hangs_holds_up_nothing(ros: RosBridge, ros2: Any) -> None:
    let_go = threading.Event()
    ros2.services["/lamp"] = ("lamps/Switch", lambda values: let_go.wait(120) and {"said": "on"})
    ros.service("lamp", "/lamp")
    ros.robot.lamp(on=True)
    drive(ros, 1.0)
    goal(ros2, 1.0)
    ros.robot.move(linear=0.2)
    until(lambda: ros2.heard)
    assert latched(ros, "lamp") == ("active", "")
    let_go.set()
    until(lambda: latched(ros, "lamp")[0] == "succeeded")
    assert ros.robot.lamp.result.said == "on"
    del ros2.services["/lamp"]
    ros.robot.lamp(on=True)
    until(lambda: latched(ros, "lamp")[0] == "lost")
    assert "/lamp" in ros.robot.lamp.reason


def test_a_service_that_the_end_of_a_run_calls_is_reached_before_the_connection_ends(
    ros: RosBridge, ros2: Any
) -> None:
    called: list[bool] = []
    ros2.services["/lamp"] = ("lamps/Switch", lambda values: {"said": called.append(values["on"]) or "on"})
    ros.service("lamp", "/lamp")
    with Session("(onend [robot.lamp(on=True)]) (machine m (state s)) (spawn m s)", bridge=ros) as session:
        session.run(0.2)
    until(lambda: called == [True])


@pytest.mark.slow
def test_the_cancels_of_two_goals_leave_through_a_line_that_was_held_up(
    make: Make, wire: Any, graph: Any
) -> None:
    graph.definitions |= {
        "move_base_msgs/MoveBaseGoal": Definition("move_base_msgs/MoveBaseGoal", {"x": FieldType("float64")}),
        "move_base_msgs/MoveBaseFeedback": Definition("move_base_msgs/MoveBaseFeedback", {}),
        "move_base_msgs/MoveBaseResult": Definition("move_base_msgs/MoveBaseResult", {}),
    }
    ros = make(port=wire.port)
    ros.open()
    ros.arm()
    ros.action("drive_to", "/move_base", "move_base_msgs/MoveBase")

    def drive_to(x: float) -> str:
        latched(ros)
        ros.robot.drive_to(x=x)
        sent = lambda: [each for _, each in tuple(graph.heard) if each.get("goal", {}).get("x") == x]  # noqa: E731
        return str(until(sent)[0]["goal_id"]["id"])

    def known(*statuses: tuple[str, int]) -> None:
        each = [{"goal_id": {"id": id_}, "status": number, "text": ""} for id_, number in statuses]
        graph.send("/move_base/status", status_list=each)

    first = drive_to(1.0)
    until(lambda: known((first, 1)) or ros.wiring.channels[0].waiting == "")
    wire.hold()
    ros.stop_all()
    wire.release()
    until(lambda: ("/move_base/cancel", {"id": first}) in graph.heard)
    second = drive_to(2.0)
    goals: Any = ros.wiring.channels[0].handle
    until(lambda: known((first, 2), (second, 1)) or goals._goals[second].listed_at)
    until(lambda: known((first, 2)) or latched(ros)[0] == "lost")
    assert "was started again" in latched(ros)[1]
    # one that is over here and goes on there is cancelled again
    del graph.heard[:]
    until(lambda: known((second, 1)) or ("/move_base/cancel", {"id": second}) in graph.heard)


def test_a_server_that_cannot_describe_an_action_or_a_service_is_to_be_updated(
    make: Make, ros2: Any, server: Any
) -> None:
    server.is_recent = False
    ros = make()
    ros.open()
    ros.arm()
    until(lambda: ros.live.get("action"))
    with pytest.raises(BridgeError, match=r"does not describe actions\. Update rosbridge"):
        ros.action("drive_to", "/navigate", "nav2_msgs/action/Navigate")
    with pytest.raises(BridgeError, match=r"not asked for types of services, .* Update rosbridge\.$"):
        ros.service("lamp", "/lamp", "lamps/srv/Switch")
    ros.action("drive_to", "/navigat")
    drive(ros, 1.0)
    until(lambda: latched(ros)[0] == "aborted")
    assert "`/navigat` does not exist yet" in latched(ros)[1]
    assert "Did you mean `/navigate`?" in latched(ros)[1]
