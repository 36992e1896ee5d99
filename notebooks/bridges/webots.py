"""A robot in a world of Webots: the e-puck with its ground sensors, or one with the same devices.

In Webots, set the robot's `controller` to `<extern>`. Then start the program where Python finds Webots' own
module, for example::

    export WEBOTS_HOME=/usr/local/webots
    export PYTHONPATH=$WEBOTS_HOME/lib/controller/python
    lrp run follower --bridge webots.py --speed max

or `%run webots.py` in a notebook, then `%lrp bridge webots`. Webots has a clock of its own, and this bridge
moves it: `advance` makes one step of the world after the other. While the program is paused, or stands at a
breakpoint, the whole world stands still; with `--speed max` it runs as fast as Webots can.

`robot.turn_by(1.571)` is a task: in each step of the world the bridge turns the wheels, until their own
sensors say that the robot has turned so far. Nothing tells it when a wheel slips.

Who stops the robot when this process dies? Webots: without its controller, the world makes no further step.

Met in tests: a stand-in for Webots' module, written from its documentation, with another simulator behind
it. Not met: Webots itself.
"""

import math

from lrp_jupyter import Bridge, BridgeError

WHEEL = 0.0205  # m, radius
APART = 0.052  # m, between the wheels
NEAR = 2000  # of the infrared sensors, about a centimetre before a wall
STRAIGHT = 0.01  # rad: so near to its end, a turn is done


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
    turning = None  # the task under way, the angle in rad, and the heading when it began

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
        self.encoders = [self.device(f"{side} wheel sensor") for side in ("left", "right")]
        for sensor in (self.ground, *self.front, *self.encoders):
            sensor.enable(round(1000 * step))
        self.add_variable("light.data", self.light, "0 dark … 255 bright")
        self.add_variable("bumper.data", self.bumper, "1 a centimetre before a wall")
        self.add_method("move", self.move, "m/s and rad/s", limits={"linear": 0.12, "angular": 2.0})
        doc, limits = "to the left, in rad", {"radians": 100}
        self.add_task("turn_by", self.turn_by, self.cancel, doc, limits=limits, mover="")

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

    def heading(self):  # by the wheels, in rad
        left, right = (sensor.getValue() for sensor in self.encoders)
        return (right - left) * WHEEL / APART

    def move(self, linear=0.0, angular=0.0):
        if self.turning:
            self.turning[0].update("aborted", reason="The robot was told something else meanwhile.")
        self.turning = None
        self.wheels = velocities(linear, angular)

    def turn_by(self, task, radians):
        self.move()
        self.turning = task, radians, self.heading()

    def cancel(self, task):
        self.turning = None

    def turned(self, task, radians, begun):
        """Return the velocities of the wheels for the next step of a turn."""
        heading = self.heading()
        left = radians + begun - heading
        if math.isnan(left):  # before the first step
            self.turning = task, radians, heading
        elif abs(left) > STRAIGHT:
            task.update(feedback=abs(left))
            return velocities(0.0, max(-1.0, min(1.0, 4 * left)))
        else:
            self.turning = None
            task.update("succeeded")
        return 0.0, 0.0

    def stop(self):
        self.wheels = (0.0, 0.0)

    def advance(self, seconds):
        for _ in range(round(seconds / self.time_step)):
            turning = self.turning
            speeds = self.turned(*turning) if turning and turning[0].is_wanted else self.wheels
            for motor, speed in zip(self.motors, speeds, strict=True):
                motor.setVelocity(speed)
            if self.epuck.step(round(1000 * self.time_step)) == -1:
                self.set_status("lost", "Webots has ended the simulation.")
                return

    def rewind(self, moment):
        raise BridgeError("The world of Webots cannot step back. Reset it in Webots.")


def velocities(linear, angular):
    """Return those of the left and the right wheel, in rad/s."""
    turn = angular * APART / 2
    return (linear - turn) / WHEEL, (linear + turn) / WHEEL
