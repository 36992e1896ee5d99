"""The public checks of every bridge, on rosbridge and rospy; on DDS they are in a folder of their own."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from bridges.ros.follower import FRESH, SETUP

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.conformance import BridgeConformance
from lrp_jupyter.bridges.message import moves
from lrp_jupyter.bridges.ros import RosBridge

ROBOT, SERVER = (str(SETUP.with_name(name)) for name in ("robot_node.py", "action_node.py"))


class TestRosbridge(BridgeConformance):
    moves = True

    @pytest.fixture(autouse=True)
    def _connected(self, serve: Callable[..., Any], graph: Any) -> Iterator[None]:
        self.serve, self.graph = serve, graph
        self.server = serve()
        self.port = self.server.port
        self.speaks, over = True, threading.Event()

        def speak() -> None:
            while not over.wait(0.05):
                if self.speaks:
                    graph.send("/light", data=200)

        speaker = threading.Thread(target=speak)
        speaker.start()
        yield
        over.set()
        speaker.join()

    def make_bridge(self) -> Bridge:
        wires = {**FRESH, "subscriptions": {"light": FRESH["subscriptions"]["light"]}}
        return RosBridge("rosbridge", "127.0.0.1", self.port, wires, patience=self.open_within)

    def has_moved(self, bridge: Bridge) -> bool:
        return any(topic == "/cmd_vel" and moves(values) for topic, values in self.graph.heard)

    def silence(self) -> None:
        self.speaks = False

    def cut(self) -> None:
        self.server.close()

    def restore(self) -> None:
        if self.speaks:
            self.server = self.serve(self.port)
        self.speaks = True


@pytest.mark.ros
class TestRospy(BridgeConformance):
    moves = True
    robot: Any = None  # for all checks
    action_server: Any = None

    @pytest.fixture(autouse=True)
    def _connected(self, lasting: Any) -> None:
        self.ros, self.port = lasting, lasting.master_port
        if TestRospy.robot is None:
            self.start()
            first = self.make_bridge()  # rospy's one node, with its threads, stays with the process
            first.open()
            first.close()

    def start(self) -> None:
        command = (sys.executable, ROBOT, "1", "line")
        TestRospy.robot = self.ros.start(*command, ready=True)
        TestRospy.action_server = self.ros.start(sys.executable, SERVER, "full", ready=True)

    def make_bridge(self) -> Bridge:
        setup = {**FRESH, "actions": {"drive_to": "/move_base"}}
        return RosBridge("rospy", "127.0.0.1", self.port, setup, patience=self.open_within)

    def ask_a_little(self, bridge: Bridge) -> None:
        bridge.robot.drive_to(target_pose_pose_position_x=0.1)

    def silence(self) -> None:
        os.killpg(self.robot.pid, signal.SIGSTOP)

    def cut(self) -> None:
        self.ros.end(self.robot)
        self.ros.end(self.action_server)
        self.ros.kill_master()

    def restore(self) -> None:
        if self.robot.poll() is None:
            os.killpg(self.robot.pid, signal.SIGCONT)
        else:
            self.ros.start_master()
            self.start()
