"""The program for the hub of `pybricks.py`: it prints what its sensors see, and drives as it is told.

It runs on a hub with Pybricks firmware: save it there with code.pybricks.com, then close that page. Wheels
at A and B, a colour sensor at C that looks at the floor, a force sensor at D that looks ahead.
"""

from pybricks.parameters import Direction, Port
from pybricks.pupdevices import ColorSensor, ForceSensor, Motor
from pybricks.robotics import DriveBase
from pybricks.tools import StopWatch, wait
from uselect import poll
from usys import stdin

base = DriveBase(Motor(Port.A, Direction.COUNTERCLOCKWISE), Motor(Port.B), wheel_diameter=56, axle_track=112)
eye, bumper = ColorSensor(Port.C), ForceSensor(Port.D)
heard, silence = poll(), StopWatch()
heard.register(stdin)
line = b""

while True:
    while heard.poll(0):
        byte = stdin.buffer.read(1)
        if byte == b"\n":
            speed, turn = line.split()
            base.drive(int(speed), int(turn))  # mm/s, and degrees per second to the right
            silence.reset()
            line = b""
        else:
            line += byte
    if silence.time() > 600:  # ms: the computer is gone, or its program is paused
        base.stop()
    print("light", eye.reflection())
    print("bumper", int(bumper.pressed()))
    wait(40)
