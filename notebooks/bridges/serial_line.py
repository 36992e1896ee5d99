"""A robot on a serial line: a micro:bit or an Arduino on a USB cable, or with a Bluetooth serial adapter.

    pip install pyserial
    lrp run follower --bridge serial_line.py --option port=/dev/ttyACM0

or `%run serial_line.py` in a notebook, then `%lrp bridge serial`. The robot prints lines such as
`light 212` (0 dark … 255 bright) and `bumper 1` (1 pressed) many times a second, and whatever else it has:
each name becomes `robot.NAME.data`. It reads lines `move 0.2 0.0`: metres and radians per second. On a
micro:bit:

    while True:
        print("light", read_the_light())
        print("bumper", read_the_bumper())
        line = uart.readline()                  # then drive as the last `move` said

A task is a line with a number: `drive 0.3 7`, 0.3 m ahead, or `turn 1.571 8`, a quarter to the left. It comes
again and again while it is wanted, and the robot begins when the number is another one than before. With its
readings it prints what has become of it: `done 7`, `blocked 7` if it does not get on, `dropped 7` if no line
came for half a second. A `move` ends the task, and the robot forgets its number. So a line that is lost,
or cannot be read, costs a moment and nothing else.

Who stops the robot when this process dies? The guard process: it calls `halt` below. When the computer dies
or the cable comes off, only the robot can: let its program stop, in the middle of a task, too, if no line has
come for half a second.

Met in tests: pyserial on a pseudo-terminal, with a simulated robot at its other end. Not met: a cable.
"""

from contextlib import suppress

import serial

from lrp_jupyter import BridgeError
from lrp_jupyter.bridges import ReconnectingBridge, Stopper

DRIVES_BY = {"light": "0 dark … 255 bright", "bumper": "1 pressed"}  # it stops when one of these is late
ENDS = {
    "done": ("succeeded", ""),
    "blocked": ("aborted", "The robot does not get on."),
    "dropped": ("aborted", "No line has reached the robot for half a second."),
}
MEANWHILE = "The robot was told something else meanwhile."


class SerialLine(ReconnectingBridge):
    """A robot that prints its readings on a serial line.

    Parameters
    ----------
    port : str
        Name of the line: `/dev/ttyACM0`, `COM3`, `/dev/tty.usbmodem1`.
    baud : int
        Speed of the line.
    """

    name = "serial"
    asked = None  # the last task, and its line

    def __init__(self, port: str, baud: int = 115200):
        self.port, self.baud = port, baud

    def add_members(self):
        for name, doc in DRIVES_BY.items():
            self.feed(f"{name}.data", doc=doc, type=float)
        self.add_method("move", self.move, "m/s and rad/s", limits={"linear": 0.5, "angular": 2.0})
        end = self.cancel  # and `mover`: what is begun last has the wheels, a task or `move`
        self.add_task("drive_by", self.drive_by, end, "ahead, in m", limits={"metres": 100}, mover="")
        self.add_task("turn_by", self.turn_by, end, "to the left, in rad", limits={"radians": 100}, mover="")

    def connect(self):
        try:
            self.line = serial.Serial(self.port, self.baud, timeout=0.2, write_timeout=0.5, exclusive=True)
        except serial.SerialException as error:
            raise BridgeError(f"`{self.port}` cannot be opened: {error}. Plug the robot in.") from error
        self.rest = b""

    def receive(self):
        *lines, self.rest = (self.rest + self.line.read(self.line.in_waiting or 1)).split(b"\n")
        for line in lines:
            try:
                name, value = line.decode("ascii").split()
                if name in ENDS:
                    self.over(int(value), *ENDS[name])
                    continue
                late = 1.0 if name in DRIVES_BY else None
                self.feed(
                    f"{name}.data", float(value), doc=DRIVES_BY.get(name, "as printed"), stale_after=late
                )
            except ValueError:  # the first line may have been cut in two
                self.safety.notice("fault", f"The robot printed {line!r}, not a name and a number.", "a line")

    def move(self, linear=0.0, angular=0.0):
        if self.asked:
            self.asked[0].update("aborted", reason=MEANWHILE)
        self.line.write(f"move {linear:.3f} {angular:.3f}\n".encode())

    def drive_by(self, task, metres):
        self.ask(task, f"drive {metres:.3f}")

    def turn_by(self, task, radians):
        self.ask(task, f"turn {radians:.3f}")

    def ask(self, task, what):
        self.move()  # the robot forgets the number of the task before
        self.asked = task, f"{what} {task.number}\n".encode()
        self.act(0)

    def act(self, now):  # after each tick
        if self.asked and self.asked[0].is_wanted:
            with suppress(serial.SerialException):  # `receive` reports the loss
                self.line.write(self.asked[1])

    def over(self, number, status, reason):
        if self.asked and self.asked[0].number == number:
            self.asked[0].update(status, reason=reason)

    def cancel(self, task):
        self.move()

    def disconnect(self):
        self.line.close()

    def stopper(self):
        return Stopper(halt, {"port": self.port, "baud": self.baud})


def halt(port, baud):
    """Stop the robot from another process, even in the middle of a line."""
    with serial.Serial(port, baud, write_timeout=0.5) as line:
        line.write(b"\nmove 0 0\n")
        line.flush()
