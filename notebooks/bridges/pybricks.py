"""A hub with Pybricks firmware: SPIKE, Robot Inventor, or Technic, over Bluetooth Low Energy.

    pip install bleak
    lrp run follower --bridge pybricks.py --option hub="Pybricks Hub"

or `%run pybricks.py` in a notebook, then `%lrp bridge pybricks`. First save `pybricks_hub.py`, which is
beside this file, on the hub. This bridge starts it, reads what it prints (`light 42`, from 0 to 100, and
`bumper 1`), and writes lines to it: `200 -57`, a speed in mm/s and a turn in degrees per second.

Who stops the robot when this process dies? The hub, after 0.6 s: its program stops the motors when nothing
comes.

Met in tests: the program of the hub, on stand-ins for its modules, at the other end of a pipe. Not met: a
hub, and Bluetooth.
"""

import asyncio
import math

from bleak import BleakClient, BleakScanner
from bleak.exc import BleakError

from lrp_jupyter import BridgeError
from lrp_jupyter.bridges import ReconnectingBridge

SERVICE = "c5f50001-8280-46da-89f4-6d8051e4aeef"
CHANNEL = "c5f50002-8280-46da-89f4-6d8051e4aeef"
START, WRITE, PRINTED = b"\x01", b"\x06", 1  # two commands to the hub, and an event from it


class Pybricks(ReconnectingBridge):
    """A hub with Pybricks firmware, two motors, a colour sensor and a force sensor.

    Parameters
    ----------
    hub : str
        The name of the hub, or a part of it; by default the first one that is found.
    """

    name = "pybricks"
    connect_within = 20.0  # s; the search for the hub takes up to ten
    stops_when_found = True  # the hub stops by itself; a stop would wait for the thread that found it

    def __init__(self, hub: str = ""):
        self.hub = hub

    def add_members(self):
        self.feed("light.data", doc="0 dark … 255 bright", type=int)
        self.feed("bumper.data", doc="1 pressed", type=int)
        self.add_method("move", self.move, "m/s and rad/s", limits={"linear": 0.5, "angular": 3.0})

    def connect(self):
        self.loop, self.rest = asyncio.new_event_loop(), b""
        try:
            self.loop.run_until_complete(self.start())
        except BaseException:
            self.loop.close()
            raise

    async def start(self):
        try:
            found = await BleakScanner.find_device_by_filter(
                lambda device, seen: SERVICE in seen.service_uuids and self.hub in (device.name or ""),
                timeout=10,
            )
            if found is None:
                raise BridgeError(f"No hub `{self.hub}` with Pybricks is near. Switch it on.")
            self.client = BleakClient(found)
            await self.client.connect()
            await self.client.start_notify(CHANNEL, self.arrived)
            await self.client.write_gatt_char(CHANNEL, START, response=True)
        except (BleakError, OSError) as error:
            raise BridgeError(f"The hub cannot be reached by Bluetooth: {error}.") from error

    def receive(self):
        self.loop.run_until_complete(asyncio.sleep(0.05))
        if not self.client.is_connected:
            raise ConnectionError("The hub is gone.")

    def arrived(self, _sender, data):
        if data[0] == PRINTED:
            *lines, self.rest = (self.rest + data[1:]).split(b"\n")
            for name, value in (line.split() for line in lines):
                scale = 2.55 if name == b"light" else 1
                self.feed(f"{name.decode()}.data", round(int(value) * scale))

    def move(self, linear=0.0, angular=0.0):
        line = f"{1000 * linear:.0f} {-math.degrees(angular):.0f}\n"
        writing = self.client.write_gatt_char(CHANNEL, WRITE + line.encode(), response=True)
        asyncio.run_coroutine_threadsafe(writing, self.loop).result(0.5)

    @property
    def failsafe(self):
        return "The hub stops the robot after 0.6 s, whatever dies: this program, this computer, or the link."

    def disconnect(self):
        self.loop.run_until_complete(self.client.disconnect())
        self.loop.close()
