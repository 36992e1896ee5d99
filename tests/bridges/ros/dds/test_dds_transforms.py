"""Transforms on ROS 2's wire: of two publishers, each of which keeps its own, and of those that move."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import pytest
from support.waiting import until

from lrp_jupyter.bridges.ros import RosBridge
from lrp_jupyter.errors import NoDataYet

pytest.importorskip("cyclonedds", reason="the extra `ros2` is missing")
pytest.importorskip("rosbags", reason="the extra `ros2` is missing")

from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.topic import Topic

from lrp_jupyter.bridges.ros import dds_domain
from lrp_jupyter.bridges.ros.dds_types import MessageTypes

TYPE = "tf2_msgs/TFMessage"
KEPT = Qos(Policy.Reliability.Reliable(0), Policy.Durability.TransientLocal, Policy.History.KeepLast(1))
MOVING = Qos(Policy.Reliability.Reliable(0), Policy.Durability.Volatile, Policy.History.KeepLast(100))


@pytest.fixture
def publish(domain: int) -> Iterator[Callable[..., None]]:
    """Publish one transform by a writer of its own, the same one again for the same child."""
    network = Domain(domain, dds_domain._configuration(""))
    participant, types = DomainParticipant(domain), MessageTypes()
    topics = {name: Topic(participant, f"rt{name}", types.struct(TYPE)) for name in ("/tf", "/tf_static")}
    writers: dict[str, DataWriter[Any]] = {}

    def send(topic: str, parent: str, child: str, x: float) -> None:
        if child not in writers:
            writers[child] = DataWriter(participant, topics[topic], MOVING if topic == "/tf" else KEPT)
        transform = {"translation": {"x": x}, "rotation": {"w": 1.0}}
        one = {"header": {"frame_id": parent}, "child_frame_id": child, "transform": transform}
        writers[child].write(types.sample(TYPE, {"transforms": [one]}))

    yield send
    participant.__del__()
    network.__del__()


@pytest.mark.slow
def test_all_that_is_kept_comes_and_what_moves_is_the_newest(
    publish: Callable[..., None], connect: Callable[..., RosBridge]
) -> None:
    publish("/tf_static", "base_link", "laser", 0.25)
    publish("/tf_static", "base_link", "camera", 0.5)
    ros = connect()
    ros.subscribe("tf", "/tf")

    def x(target: str, source: str) -> float | None:
        try:
            seen: Any = ros.robot.tf(target, source)
        except NoDataYet:
            return None
        return float(seen.x)

    def has_come(metres: float) -> bool:
        publish("/tf", "odom", "base_link", metres)
        publish("/tf", "base_link", "wheel", 0.125)
        return x("odom", "laser") == metres + 0.25 and x("laser", "wheel") == -0.125

    until(lambda: x("laser", "camera") == 0.25)
    for metres in (1.0, 2.0):
        until(lambda metres=metres: has_come(metres))
