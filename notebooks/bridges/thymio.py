"""A Thymio, through the Thymio Device Manager, which Thymio Suite starts.

    pip install tdmclient
    lrp run follower --bridge thymio.py

or `%run thymio.py` in a notebook, then `%lrp bridge thymio`. The device manager listens on port 8596 of
this computer; this bridge takes the first robot that is free. The Thymio has no bumper:
`robot.bumper.data` is 1 when something is about a centimetre before it. Its ground sensors go from 0 to
about 1000 and are different in every robot: see what `robot.light.data` says on your line, and change
`bright`.

Who stops the robot when this process dies? The guard process: it calls `halt` below, which takes the robot
over. While this process is only suspended, or when the computer dies, nothing does.

Met in tests: the server that tdmclient brings with it, with a simulated robot. Not met: a Thymio, and the
real device manager.
"""

import socket
import time
from contextlib import suppress

from tdmclient import ClientAsync, ThymioFB

from lrp_jupyter import BridgeError
from lrp_jupyter.bridges import ReconnectingBridge, Stopper

UNITS = 2500  # of the motors, for 1 m/s: 500 are about 20 cm/s
APART = 0.094  # m, between the wheels
NEAR = 3500  # of the sensors in front


class Manager:
    """A connection to the device manager, as tdmclient wants it: messages with their length before them."""

    def __init__(self, host, port):
        self.socket = socket.create_connection((host, port), timeout=2)
        self.stream = self.socket.makefile("rb")

    def close(self):
        with suppress(OSError):
            self.socket.shutdown(socket.SHUT_RDWR)  # ends a read that waits
        self.stream.close()
        self.socket.close()

    def send_packet(self, packet):
        self.socket.sendall(len(packet).to_bytes(4, "little") + packet)

    def receive_packet(self):
        size = int.from_bytes(self.stream.read(4), "little")
        packet = self.stream.read(size)
        if not packet:
            raise ConnectionError("The device manager has ended.")
        return packet


class Thymio(ReconnectingBridge):
    """A Thymio II.

    Parameters
    ----------
    host : str
        Where the device manager is.
    port : int
        What it listens on.
    bright : float
        What the ground sensors say on white.
    """

    name = "thymio"
    guarded_by = "If this program dies, a guard process stops the Thymio. If it hangs, nothing does."

    def __init__(self, host: str = "127.0.0.1", port: int = 8596, bright: float = 1000.0):
        self.host, self.port, self.bright = host, port, bright

    def add_members(self):
        self.feed("light.data", doc="0 dark … 255 bright", type=int)
        self.feed("bumper.data", doc="1 a centimetre before something", type=int)
        self.add_method("move", self.move, "m/s and rad/s", limits={"linear": 0.2, "angular": 2.0})

    def connect(self):
        try:
            self.manager = Manager(self.host, self.port)
        except OSError as error:
            raise BridgeError(
                f"No device manager answers at {self.host}:{self.port} ({error}). Start Thymio Suite."
            ) from error
        try:
            self.client = ClientAsync(tdm_transport=self.manager)
            self.node = self.wait_for(ThymioFB.NODE_STATUS_AVAILABLE)
            self.node.send_lock_node()
            self.wait_for(ThymioFB.NODE_STATUS_READY)
            self.seen = {}
            self.node.add_variables_changed_listener(self.changed)
            self.node.watch_node(ThymioFB.WATCHABLE_INFO_VARIABLES)
        except BaseException:
            self.disconnect()
            raise

    def wait_for(self, status):
        end = time.monotonic() + 3
        with suppress(TimeoutError):
            while time.monotonic() < end:
                self.receive()
                for node in self.client.nodes:
                    if node.status == status:
                        return node
        raise BridgeError(
            f"The device manager at {self.host}:{self.port} has no Thymio that is free. Switch one on, and"
            " close other programs that use it."
        )

    def receive(self):
        self.client.process_message(self.manager.receive_packet())

    def changed(self, _node, variables):
        self.seen |= variables  # only what has changed is sent
        if "prox.ground.delta" in self.seen and "prox.horizontal" in self.seen:
            ground = sum(self.seen["prox.ground.delta"]) / 2
            self.feed("light.data", max(0, min(255, round(255 * ground / self.bright))))
            self.feed("bumper.data", int(max(self.seen["prox.horizontal"][:5]) > NEAR))

    def move(self, linear=0.0, angular=0.0):
        turn = angular * APART / 2
        left, right = (round(UNITS * each) for each in (linear - turn, linear + turn))
        self.node.send_set_variables({"motor.left.target": [left], "motor.right.target": [right]})

    def disconnect(self):
        self.manager.close()

    def stopper(self):
        return Stopper(halt, {"host": self.host, "port": self.port})


def halt(host, port):
    """Stop the robot from another process, when the one that had it is gone."""
    thymio = Thymio(host, port)
    thymio.open()
    stopped = thymio.stop_all()
    thymio.close()
    if not stopped:  # it is tried again
        raise BridgeError("The device manager did not take the stop.")
