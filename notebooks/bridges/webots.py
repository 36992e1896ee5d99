"""A robot in a world of Webots: the e-puck with its ground sensors, or one with the same devices.

In Webots, set the robot's `controller` to `<extern>`. Then start the program where Python finds Webots' own
module, for example::

    export WEBOTS_HOME=/usr/local/webots
    export PYTHONPATH=$WEBOTS_HOME/lib/controller/python
    lrp run follower --bridge webots.py --speed max

or `%run webots.py` in a notebook, then `%lrp bridge webots`. Webots has a clock of its own, and this bridge
moves it: `advance` makes one step of the world after the other. While the program is paused, or stands at a
breakpoint, the whole world stands still; with `--speed max` it runs as fast as Webots can.

Who stops the robot when this process dies? Webots: without its controller, the world makes no further step.

Met in tests: a stand-in for Webots' module, written from its documentation, with another simulator behind
it. Not met: Webots itself.
"""

import math

from lrp_jupyter import Bridge, BridgeError

WHEEL = 0.0205  # m, radius
APART = 0.052  # m, between the wheels
NEAR = 2000  # of the infrared sensors, about a centimetre before a wall


class Webots(Bridge):
    """The e-puck in a simulated world of Webots.

    Parameters
    ----------
    step : float
        The basic time step of the world, in seconds.
    dark, bright : float
        What the middle ground sensor says on black and on white.
    """

    name = "webots"
    hardware = False  # nothing real moves
    stop_timeout = None  # `stop` only takes a note

    def __init__(self, step: float = 0.032, dark: float = 300.0, bright: float = 900.0):
        self.time_step, self.dark, self.bright = step, dark, bright
        self.wheels = (0.0, 0.0)  # rad/s, left and right

    def open_interface(self):
        try:
            from controller import Robot
        except ImportError as error:
            raise BridgeError(
                "Python does not find Webots' module `controller`. Add `lib/controller/python` of the folder"
                " of Webots to `PYTHONPATH`."
            ) from error
        self.epuck = getattr(Robot, "created", None) or Robot()  # there is one for a process
        step = self.epuck.getBasicTimeStep() / 1000
        if not math.isclose(step, self.time_step):
            raise BridgeError(f"This world moves in steps of {step:g} s. Say so: `step={step:g}`.")
        self.motors = [self.device(f"{side} wheel motor") for side in ("left", "right")]
        for motor in self.motors:
            motor.setPosition(math.inf)  # turn without an end, with the velocity that is set
            motor.setVelocity(0.0)
        self.ground, *self.front = (self.device(name) for name in ("gs1", "ps0", "ps7"))
        for sensor in (self.ground, *self.front):
            sensor.enable(round(1000 * step))
        self.add_variable("light.data", self.light, "0 dark … 255 bright")
        self.add_variable("bumper.data", self.bumper, "1 a centimetre before a wall")
        self.add_method("move", self.move, "m/s and rad/s", limits={"linear": 0.12, "angular": 2.0})

    def device(self, name):
        found = self.epuck.getDevice(name)
        if found is None:
            raise BridgeError(
                f"The robot in Webots has no device `{name}`. Take an e-puck with ground sensors."
            )
        return found

    def light(self):
        seen = self.ground.getValue()
        if math.isnan(seen):  # before the first step
            return None
        return max(0, min(255, round(255 * (seen - self.dark) / (self.bright - self.dark))))

    def bumper(self):
        return int(any(sensor.getValue() > NEAR for sensor in self.front))

    def move(self, linear=0.0, angular=0.0):
        turn = angular * APART / 2
        self.wheels = ((linear - turn) / WHEEL, (linear + turn) / WHEEL)

    def stop(self):
        self.wheels = (0.0, 0.0)

    def advance(self, seconds):
        for motor, velocity in zip(self.motors, self.wheels, strict=True):
            motor.setVelocity(velocity)
        for _ in range(round(seconds / self.time_step)):
            if self.epuck.step(round(1000 * self.time_step)) == -1:
                self.set_status("lost", "Webots has ended the simulation.")
                return

    def rewind(self, moment):
        raise BridgeError("The world of Webots cannot step back. Reset it in Webots.")
