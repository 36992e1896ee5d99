"""The program for the hub of `pybricks.py`: it prints what its sensors see, and drives as it is told.

It runs on a hub with Pybricks firmware 3.2 or newer: save it there with code.pybricks.com, then close that
page. Wheels at A and B, a colour sensor at C that looks at the floor, a force sensor at D that looks ahead.
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
number = None  # of the last task; None after `drive`
is_on = False  # whether the task is under way


while True:
    while heard.poll(0):
        byte = stdin.buffer.read(1)
        if byte != b"\n":
            line += byte
            continue
        silence.reset()
        word, first, second = line.split()
        line = b""
        if word == b"drive":
            base.drive(int(first), int(second))  # mm/s, and degrees per second to the right
            number, is_on = None, False
        elif int(second) != number:  # else it says only that the computer is still there
            number, is_on = int(second), True
            if word == b"straight":
                base.straight(int(first), wait=False)  # mm
            else:
                base.turn(int(first), wait=False)  # degrees to the right
    end = ""
    if silence.time() > 600:  # ms: the computer is gone, or its program is paused
        end = "dropped"
        base.stop()
    elif is_on and base.done():
        end = "done"
    elif is_on and base.stalled():
        end = "blocked"
        base.stop()
    if is_on and end:
        print(end, number)
        is_on = False
    print("light", eye.reflection())
    print("bumper", int(bumper.pressed()))
    wait(40)
