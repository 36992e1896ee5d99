"""A Thymio behind a device manager: ``python thymio_robot.py PORT SPEED``.

The messages are understood and answered by tdmclient's own server; here are the robot and the socket.
"""

from __future__ import annotations

import socket
import sys
import threading
import time
from contextlib import suppress
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from tdmclient import ThymioFB
from tdmclient.server import ServerHandler, ServerNode

sys.path.append(str(Path(__file__).parents[2]))

from support.simulated import SimulatedRobot, ready

UNITS = 2500  # of the motors, for 1 m/s
APART = 0.094  # m between the wheels
BLACK_TO_WHITE = 4  # the ground sensors go to 1023


class Thymio(ServerNode):
    """The node that the device manager offers; its variables are those of the robot."""

    def __init__(self, robot: SimulatedRobot) -> None:
        self.robot, self._variables = robot, {}
        super().__init__(
            type=ThymioFB.NODE_TYPE_THYMIO2,
            name="thymio",
            variables={
                "prox.horizontal": [0] * 7,
                "prox.ground.delta": [0, 0],
                "acc": [0, 0, 22],
                "motor.left.target": [0],
                "motor.right.target": [0],
            },
        )

    @property
    def variables(self) -> dict[str, list[int]]:
        return self._variables

    @variables.setter
    def variables(self, variables: dict[str, list[int]]) -> None:
        self._variables = variables
        if "motor.left.target" in variables:
            left, right = (variables[f"motor.{side}.target"][0] / UNITS for side in ("left", "right"))
            self.robot.drive((left + right) / 2, (right - left) / APART)


class Connection:
    """One program that is connected."""

    def __init__(self, link: socket.socket, node: Thymio, others: list[Connection]) -> None:
        self.link, self.node, self.others = link, node, others
        self.sending = threading.Lock()
        self.known: dict[str, list[int]] = {}
        self.handler = ServerHandler(None, {node}, self.send)

    def start(self) -> None:
        threading.Thread(target=self.listen, daemon=True).start()

    def send(self, packet: bytes) -> None:
        with self.sending, suppress(OSError):
            self.link.sendall(len(packet).to_bytes(4, "little") + packet)

    def listen(self) -> None:
        with self.link, self.link.makefile("rb") as stream, suppress(OSError):
            while size := stream.read(4):
                self.handler.process_message(stream.read(int.from_bytes(size, "little")))
        self.others.remove(self)
        self.node.status = ThymioFB.NODE_STATUS_AVAILABLE  # who is gone has no lock
        self.node.watch_flags = 0
        for other in tuple(self.others):  # one of them may wait for it
            other.handler.send_nodes_changed()

    def tell(self) -> None:
        """Send what has changed, as the device manager does ten times a second."""
        changed = {
            name: value for name, value in self.node.variables.items() if self.known.get(name) != value
        }
        self.known |= changed
        self.handler.send_variables_changed(SimpleNamespace(id=self.node.id, variables=changed))


def main(port: int, speed: float) -> None:
    robot = SimulatedRobot(speed)
    node = Thymio(robot)
    listener = socket.create_server(("127.0.0.1", port))
    connections: list[Connection] = []

    def accept() -> None:
        while True:
            link = listener.accept()[0]
            connections.append(Connection(link, node, connections))
            connections[-1].start()

    threading.Thread(target=accept, daemon=True).start()
    ready(robot, f"ready {listener.getsockname()[1]}")
    last = [0.0]

    def publish(light: int, bumper: bool, _odom: Any) -> None:
        node._variables |= {
            "prox.horizontal": [0, 0, 4000 * bumper, 0, 0, 0, 0],
            "prox.ground.delta": [light * BLACK_TO_WHITE] * 2,
            "acc": [0, 0, 22 + (node.variables["acc"][2] == 22)],
        }
        if node.watch_flags & ThymioFB.WATCHABLE_INFO_VARIABLES and time.monotonic() - last[0] > 0.1 / speed:
            last[0] = time.monotonic()
            for connection in tuple(connections):
                connection.tell()

    robot.run(publish)


if __name__ == "__main__":
    main(int(sys.argv[1]), float(sys.argv[2]))
