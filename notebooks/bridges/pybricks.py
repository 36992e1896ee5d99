"""A hub with Pybricks firmware: SPIKE, Robot Inventor, or Technic, over Bluetooth Low Energy.

    pip install bleak
    lrp run follower --bridge pybricks.py --option hub="Pybricks Hub"

or `%run pybricks.py` in a notebook, then `%lrp bridge pybricks`. First save `pybricks_hub.py`, which is
beside this file, on the hub. This bridge starts it, reads what it prints (`light 42`, from 0 to 100, and
`bumper 1`), and writes lines to it: `drive 200 -57`, a speed in mm/s and a turn in degrees per second.

A task is a line with a number: `straight 300 7`, in mm, or `turn -90 8`, in degrees to the right. It is
written after each tick while it is wanted; the hub begins when the number is another one than before, and
prints `done 7`, `blocked 7` when the motors stall, or `dropped 7` when nothing has come for 0.6 s.

Who stops the robot when this process dies? The hub, after 0.6 s, in the middle of a task, too: its program
stops the motors when nothing comes.

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
ENDS = {
    "done": ("succeeded", ""),
    "blocked": ("aborted", "The motors have stalled."),
    "dropped": ("aborted", "The hub has heard nothing for 0.6 s."),
}
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
    asked = None  # the last task, and its line
    stops_when_found = True  # the hub stops by itself; a stop would wait for the thread that found it

    def __init__(self, hub: str = ""):
        self.hub = hub

    def add_members(self):
        self.feed("light.data", doc="0 dark … 255 bright", type=int)
        self.feed("bumper.data", doc="1 pressed", type=int)
        self.add_method("move", self.move, "m/s and rad/s", limits={"linear": 0.5, "angular": 3.0})
        end = self.cancel  # and `mover`: what is begun last has the wheels, a task or `move`
        self.add_task("drive_by", self.drive_by, end, "ahead, in m", limits={"metres": 100}, mover="")
        self.add_task("turn_by", self.turn_by, end, "to the left, in rad", limits={"radians": 100}, mover="")

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
            for name, value in (line.decode().split() for line in lines):
                if name in ENDS:
                    self.over(int(value), *ENDS[name])
                else:
                    self.feed(f"{name}.data", round(int(value) * (2.55 if name == "light" else 1)))

    def over(self, number, status, reason):
        if self.asked and self.asked[0].number == number:
            self.asked[0].update(status, reason=reason)

    def move(self, linear=0.0, angular=0.0):
        if self.asked:
            self.asked[0].update("aborted", reason="The robot was told something else meanwhile.")
        self.write(f"drive {1000 * linear:.0f} {-math.degrees(angular):.0f}")

    def drive_by(self, task, metres):
        self.ask(task, f"straight {1000 * metres:.0f}")

    def turn_by(self, task, radians):
        self.ask(task, f"turn {-math.degrees(radians):.0f}")

    def ask(self, task, what):
        self.move()  # the hub forgets the number of the task before
        self.asked = task, f"{what} {task.number}"
        self.act(0)

    def act(self, now):  # after each tick
        if self.asked and self.asked[0].is_wanted:
            self.write(self.asked[1])

    def cancel(self, task):
        self.move()

    def write(self, line):
        writing = self.client.write_gatt_char(CHANNEL, WRITE + line.encode() + b"\n", response=True)
        asyncio.run_coroutine_threadsafe(writing, self.loop).result(0.5)

    @property
    def failsafe(self):
        return "The hub stops the robot after 0.6 s, whatever dies: this program, this computer, or the link."

    def disconnect(self):
        self.loop.run_until_complete(self.client.disconnect())
        self.loop.close()
