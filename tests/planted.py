"""Planted bugs: programs with a mistake, what a person asks about it, and what the answer must say.

The programs are those of beginners; the mistakes are the classical ones. Each case says which question is
asked (`why_not` a transition did not fire, `why` a state is active or the robot does what it does), about
which tick, and what makes an answer right: its code, a line that it has to mention, and a piece of its text.

At the rate of 10 Hz, tick n is at (n - 1) * 0.1 s.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from lrp_jupyter import Session, VirtualClock
from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.message import Message, Twist

__all__ = ["PLANTED", "LateRobot", "Planted", "open_session", "perform"]


@dataclass(frozen=True)
class Planted:
    """One planted bug, and the question about it.

    `line` counts from 1, in the program as it is at the end of `do`. The `world` is one of the simulator,
    "none" for no robot, or "late" for a :class:`LateRobot` ("late hardware": one that is not armed).
    """

    name: str
    question: str
    program: str
    ask: str
    code: str
    line: int
    kind: Literal["why not", "why"] = "why not"
    world: str = "none"
    do: tuple[tuple[Any, ...], ...] = (("run", 3.0),)
    at: int | None = None
    says: str = ""


class LateRobot(Bridge):
    """A robot whose scanner needs two seconds for its first data, and whose light sensor is not connected."""

    name = "late"
    hardware = False
    stop_timeout = None

    def __init__(self, hardware: bool = False) -> None:
        self.safety.armed = not hardware
        self.time = 0.0
        self.speeds = (0.0, 0.0)

    def open_interface(self) -> None:
        self.add_variable("scan.data", lambda: 1.5 if self.time >= 2.0 else None, unit="m")
        self.add_variable("light.data", lambda: None)
        self.add_method("move", self.move, message=Twist, limits={"linear": 0.5, "angular": 4.0})

    def sense(self, now: float) -> None:
        self.time = now

    def move(self, message: Message) -> None:
        self.speeds = (message.linear.x, message.angular.z)


def open_session(planted: Planted) -> Session:
    """Return a session of the program in its world, in virtual time; nothing has run yet."""
    if planted.world == "none":
        return Session(planted.program, clock=VirtualClock())
    if planted.world.startswith("late"):
        robot = LateRobot(hardware=planted.world == "late hardware")
        return Session(planted.program, robot, clock=VirtualClock())
    return Session(planted.program, "sim", clock=VirtualClock(), world=planted.world)


def perform(session: Session, planted: Planted) -> None:
    """Do what is done before the question is asked, in virtual time."""
    for action, *arguments in planted.do:
        match action:
            case "run":
                session.run(*arguments)
            case "edit":
                old, new = arguments
                assert old in session.text, f"{planted.name}: there is no {old!r} to replace"
                session.edit(session.text.replace(old, new))
            case "set":
                variable, expression = arguments
                session.set_variable(variable, evaluate=expression)
            case "transition":
                session.transition_to(*arguments)
            case "teleport":
                session.teleport_to(*arguments)
            case "pause":  # as a person does: while it runs, in one more tick
                session.run(0.1, after_tick=session.pause)
            case "reset":
                session.reset()
            case "place":  # it is there from the tick after this one
                session.bridge.place_robot(*arguments)
                session.run(0.1)
            case "stop":  # as a person does, in one more tick
                session.run(0.1, after_tick=session.stop_robot)
            case "disarm":
                session.call(session.bridge.disarm)
            case _:
                raise ValueError(f"{planted.name}: {action!r}")


PLANTED: tuple[Planted, ...] = (
    Planted(
        name="limit above the range of the sensor",
        question="The robot has left the line. Why does it not look for it?",
        program="""\
; Follow the line; outside of it, look for it.
(machine follower
  (event lost [robot.light.data > 300])
  (state moving
    (running [robot.move(linear=0.2)]))
  (state looking
    (running [robot.move(angular=1.0)]))
  (on lost moving -> looking tlook))
(spawn follower moving)
""",
        ask="tlook",
        code="condition-false",
        line=3,
        world="line",
        do=(("run", 4.0),),
        says="255",
    ),
    Planted(
        name="sensor compared with itself",
        question="It gets brighter all the time. Why does it not notice?",
        program="""\
(var reference := [128])

(machine watcher
  (event brighter [robot.light.data > robot.light.data + 10])
  (state driving
    (running [robot.move(linear=0.2)]))
  (state bright
    (onentry [robot.stop()]))
  (on brighter driving -> bright tbright))
(spawn watcher driving)
""",
        ask="tbright",
        code="condition-false",
        line=4,
        world="line",
        do=(("run", 4.0),),
        says="255",
    ),
    Planted(
        name="wrong direction of the comparison",
        question="The light is far above the limit. Why does it not search?",
        program="""\
(var lightlim := [128])

(machine follower
  (event outofline [robot.light.data < lightlim - 10])
  (state moving
    (running [robot.move(linear=0.2)]))
  (state searching
    (running [robot.move(angular=0.8)]))
  (on outofline moving -> searching tsearch))
(spawn follower moving)
""",
        ask="tsearch",
        code="condition-false",
        line=4,
        world="line",
        do=(("place", (1.6, 1.1, 0.0)), ("run", 2.0)),
        says="255",
    ),
    Planted(
        name="turning right counts down",
        question="It has turned by more than a quarter. Why does it not drive on?",
        program="""\
(machine turner
  (state turning
    (running [robot.move(angular=-1.0)]))
  (state straight
    (running [robot.move(linear=0.1)]))
  (on [robot.gyro.data > 1.57] turning -> straight tstraight))
(spawn turner turning)
""",
        ask="tstraight",
        code="condition-false",
        line=6,
        world="empty",
        do=(("run", 2.5),),
        says="1.57",
    ),
    Planted(
        name="degrees instead of radians",
        question="It turns and turns. Why does it not stop at 90 degrees?",
        program="""\
(var quarter := [90])

(machine turner
  (event turned [robot.gyro.data >= quarter])
  (state turning
    (running [robot.move(angular=1.0)]))
  (state done
    (onentry [robot.stop()]))
  (on turned turning -> done tdone))
(spawn turner turning)
""",
        ask="tdone",
        code="condition-false",
        line=4,
        world="empty",
        do=(("run", 5.0),),
        says="90",
    ),
    Planted(
        name="the wrong sign of a limit",
        question="It stands against the wall. Why is it not close enough?",
        program="""\
(var near := [-0.2])   ; m

(machine parker
  (event close [robot.distance.data < near])
  (state approaching
    (running [robot.move(linear=0.3)]))
  (state parked
    (onentry [robot.stop()]))
  (on close approaching -> parked tparked))
(spawn parker approaching)
""",
        ask="tparked",
        code="condition-false",
        line=4,
        world="empty",
        do=(("run", 8.0),),
        says="-0.2",
    ),
    Planted(
        name="a bumper compared with a word",
        question="The bumper is pressed. Why does it not back off?",
        program="""\
(machine bumpy
  (event bump [robot.bumper.data == "pressed"])
  (state driving
    (running [robot.move(linear=0.3)]))
  (state backing
    (running [robot.move(linear=-0.1)]))
  (on bump driving -> backing tback))
(spawn bumpy driving)
""",
        ask="tback",
        code="condition-false",
        line=2,
        world="boxes",
        do=(("run", 3.0),),
        says="pressed",
    ),
    Planted(
        name="two parts that exclude each other",
        question="It is dark and the bumper is free. Why does it not go?",
        program="""\
(var dark := [60])

(event ready [robot.light.data < dark and robot.light.data > 100])

(machine starter
  (state waiting)
  (state driving
    (running [robot.move(linear=0.1)]))
  (on ready waiting -> driving tdrive))
(spawn starter waiting)
""",
        ask="tdrive",
        code="condition-false",
        line=3,
        world="line",
        do=(("run", 1.0),),
        says="100",
    ),
    Planted(
        name="put down beside the line",
        question="I have put it on the line. Why does it not follow it?",
        program="""\
(var lightlim := [128])

(machine follower
  (event intheline [robot.light.data < lightlim])
  (state waiting
    (running [robot.stop()]))
  (state moving
    (running [robot.move(linear=0.2)]))
  (on intheline waiting -> moving tmove)
  (on [not (robot.light.data < lightlim)] moving -> waiting twait))
(spawn follower moving)
""",
        ask="tmove",
        code="condition-false",
        line=4,
        world="line",
        do=(("run", 0.5), ("place", (1.6, 1.1, 0.0)), ("run", 1.0)),
        says="255",
    ),
    Planted(
        name="nothing in reach is infinitely far",
        question="There is nothing in front. Why does it not turn to search?",
        program="""\
(machine finder
  (event nothing [robot.distance.data == 0])
  (state waiting)
  (state turning
    (running [robot.move(angular=0.5)]))
  (on nothing waiting -> turning tturn))
(spawn finder waiting)
""",
        ask="tturn",
        code="condition-false",
        line=2,
        world="line",
        do=(("run", 1.0),),
        says="inf",
    ),
    Planted(
        name="a float compared with ==",
        question="Three times 0.1 is 0.3. Why does it not stop?",
        program="""\
(var way := [0.0])

(machine walker
  (state going
    (running [way += 0.1]))
  (state there)
  (on [way == 0.3] going -> there tthere))
(spawn walker going)
""",
        ask="tthere",
        code="condition-false",
        line=7,
        at=5,
        says="0.30000000000000004",
    ),
    Planted(
        name="a counter that jumps over its limit",
        question="It counts far beyond ten. Why does it not end?",
        program="""\
(machine counter
  (var count := [0])
  (state counting
    (running [count += 3]))
  (state ended)
  (on [count == 10] counting -> ended tend))
(spawn counter counting)
""",
        ask="tend",
        code="condition-false",
        line=6,
        at=6,
        says="12",
    ),
    Planted(
        name="one of three parts decides",
        question="All three are ready, I think. Why does it not start?",
        program="""\
(var left := [5])
(var middle := [2])
(var right := [7])

(event allready [left > 3 and middle > 3 and right > 3])

(machine team
  (state waiting)
  (state started)
  (on allready waiting -> started tstart))
(spawn team waiting)
""",
        ask="tstart",
        code="condition-false",
        line=5,
        says="middle",
    ),
    Planted(
        name="not binds only the first part",
        question="Nothing is blocked and nothing is full. Why does it not go?",
        program="""\
(var blocked := [False])
(var full := [False])

(machine truck
  (event free [not blocked and full])   ; meant: neither
  (state standing)
  (state going)
  (on free standing -> going tgo))
(spawn truck standing)
""",
        ask="tgo",
        code="condition-false",
        line=5,
        says="full",
    ),
    Planted(
        name="a bit operation instead of and",
        question="Both numbers are larger than one. Why is the condition false?",
        program="""\
(var a := [2])
(var b := [2])

(machine both
  (state idle)
  (state busy)
  (on [a > 1 & b > 1] idle -> busy tbusy))
(spawn both idle)
""",
        ask="tbusy",
        code="condition-false",
        line=7,
        says="a > 1 & b > 1",
    ),
    Planted(
        name="an interval the wrong way round",
        question="The level is between 3 and 5. Why does it not react?",
        program="""\
(var level := [4])

(machine tank
  (event between [5 < level < 3])
  (state filling)
  (state full)
  (on between filling -> full tfull))
(spawn tank filling)
""",
        ask="tfull",
        code="condition-false",
        line=4,
        says="4",
    ),
    Planted(
        name="a number compared with a text",
        question="The lap is 3. Why does it not celebrate?",
        program="""\
(var laps := [0])

(machine race
  (state driving
    (running [laps = min(laps + 1, 3)]))
  (state won)
  (on [laps == "3"] driving -> won twon))
(spawn race driving)
""",
        ask="twon",
        code="condition-false",
        line=7,
        says="laps",
    ),
    Planted(
        name="a flag that is never reset",
        question="It has been round once. Why does it not go a second time?",
        program="""\
(var done := [False])

(machine rounds
  (event again [not done])
  (state resting)
  (state going
    (onexit [done = True]))
  (on again resting -> going tgo)
  (ontime 500 going -> resting trest))
(spawn rounds resting)
""",
        ask="tgo",
        code="condition-false",
        line=4,
        says="done",
    ),
    Planted(
        name="a counter that starts again with every spawn",
        question="It has turned far more than three times. Why is it not done?",
        program="""\
(machine dancer
  (state dancing
    (onentry (spawn steps left))
    (machine steps
      (var turns := [0])
      (state left
        (onexit [turns += 1]))
      (state right)
      (exit [turns == 3] right -> done tdone)
      (ontime 200 left -> right tright)
      (ontime 200 right -> left tleft)))
  (state pausing)
  (state done)
  (ontime 500 dancing -> pausing tpause)
  (ontime 200 pausing -> dancing tdance))
(spawn dancer dancing)
""",
        ask="tdone",
        code="condition-false",
        line=9,
        at=19,
        says="turns",
    ),
    Planted(
        name="a variable shadowed in the inner machine",
        question="The inner machine counts to five. Why does the outer one not see it?",
        program="""\
(machine outer
  (var count := [0])
  (state working
    (onentry (spawn inner ticking))
    (machine inner
      (var count := [0])
      (state ticking
        (running [count += 1]))))
  (state finished)
  (on [count >= 5] working -> finished tfinish))
(spawn outer working)
""",
        ask="tfinish",
        code="condition-false",
        line=10,
        says="0",
    ),
    Planted(
        name="a flag switched off by hand",
        question="The time is over. Why does it not start?",
        program="""\
(var enabled := [True])
(var ticks := [0])

(machine starter
  (state waiting
    (running [ticks += 1]))
  (state started)
  (on [enabled and ticks > 15] waiting -> started tstart))
(spawn starter waiting)
""",
        ask="tstart",
        code="condition-false",
        line=8,
        do=(("run", 1.0), ("set", "enabled", "False"), ("run", 2.0)),
        says="enabled",
    ),
    Planted(
        name="a flag cleared before anybody looks",
        question="The button was pressed at 0.5 s. Why is the light not on at 1.3 s?",
        program="""\
(var pressed := [False])

(machine button
  (state up)
  (state down
    (onentry [pressed = True])
    (running [pressed = False]))
  (ontime 500 up -> down tdown)
  (ontime 500 down -> up tup))

(machine light
  (state off)
  (state waiting)
  (state on)
  (ontime 800 off -> waiting tready)
  (on [pressed] waiting -> on ton))

(spawn button up)
(spawn light off)
""",
        ask="ton",
        code="condition-false",
        line=16,
        at=14,
        says="pressed",
    ),
    Planted(
        name="seconds compared with milliseconds",
        question="Two seconds have passed. Why is the time not over?",
        program="""\
(var seconds := [0.0])

(machine timer
  (event over [seconds > 2000])
  (state running
    (running [seconds += 0.1]))
  (state rung)
  (on over running -> rung tring))
(spawn timer running)
""",
        ask="tring",
        code="condition-false",
        line=4,
        says="2000",
    ),
    Planted(
        name="a limit that the length cannot reach",
        question="The list has three items. Why is it not full?",
        program="""\
(var items := [[]])

(machine collector
  (event full [len(items) > 3])
  (state collecting
    (running [
      if len(items) < 3:
          items.append("x")]))
  (state packed)
  (on full collecting -> packed tpack))
(spawn collector collecting)
""",
        ask="tpack",
        code="condition-false",
        line=4,
        says="3",
    ),
    Planted(
        name="a delay in seconds times ten thousand",
        question="It should wait two seconds. Why is it still waiting?",
        program="""\
(var seconds := [2])

(machine waiter
  (state waiting)
  (state gone)
  (ontime [seconds * 10000] waiting -> gone tgo))
(spawn waiter waiting)
""",
        ask="tgo",
        code="delay-not-over",
        line=6,
        says="20000",
    ),
    Planted(
        name="a condition that stays true restarts the timer",
        question="One second is over long ago. Why does it not fall asleep?",
        program="""\
(var beat := [0])

(machine heart
  (state pumping
    (running [beat += 1]))
  (state asleep)
  (ontime 1000 pumping -> asleep tsleep)
  (on [beat % 5 == 4] {pumping} -> pumping tagain))   ; in each tick from then on
(spawn heart pumping)
""",
        ask="tsleep",
        code="delay-not-over",
        line=8,
        says="1000",
    ),
    Planted(
        name="a pulse of another machine restarts the timer",
        question="Nobody presses anything. Why does it not go dark?",
        program="""\
(var moves := [0])

(machine cat
  (state walking
    (onexit [moves += 1]))
  (state sitting)
  (ontime 300 walking -> sitting tsit)
  (ontime 500 sitting -> walking twalk))

(machine lamp
  (var seen := [0])
  (event moved [moves > seen])
  (state lit
    (onentry [seen = moves]))
  (state dark)
  (on moved {lit dark} -> lit tlit)
  (ontime 1000 lit -> dark tdark))

(spawn cat walking)
(spawn lamp lit)
""",
        ask="tdark",
        code="delay-not-over",
        line=16,
        do=(("run", 5.0),),
        says="1000",
    ),
    Planted(
        name="a timer in a blinking state",
        question="It has blinked for three seconds. Why does it not stop?",
        program="""\
(machine lamp
  (state on)
  (state off)
  (state finished)
  (ontime 400 on -> off toff)
  (ontime 400 off -> on ton)
  (ontime 2000 on -> finished tfinish))
(spawn lamp on)
""",
        ask="tfinish",
        code="delay-not-over",
        line=6,
        do=(("run", 4.2),),
        says="2000",
    ),
    Planted(
        name="a delay that doubles each time",
        question="It looked again soon before. Why does it now take so long?",
        program="""\
(var wait := [200])

(machine looker
  (state looking
    (onexit [wait = wait * 2]))
  (state resting)
  (ontime wait looking -> resting trest)
  (ontime 100 resting -> looking tlook))
(spawn looker looking)
""",
        ask="trest",
        code="delay-not-over",
        line=7,
        do=(("run", 4.0),),
        says="3200",
    ),
    Planted(
        name="one tick before the end of a delay",
        question="300 ms are over in the third tick, are they not?",
        program="""\
(machine short
  (state a)
  (state b)
  (ontime 300 a -> b tshort))
(spawn short a)
""",
        ask="tshort",
        code="delay-not-over",
        line=4,
        at=3,
        says="300",
    ),
    Planted(
        name="a timer that began again after a restart",
        question="It runs since three seconds. Why is the second not over?",
        program="""\
(var speed := [1])
(var way := [0])

(machine walker
  (state walking
    (running [way += speed]))
  (state resting)
  (ontime 1000 walking -> resting trest))
(spawn walker walking)
""",
        ask="trest",
        code="delay-not-over",
        line=8,
        do=(("run", 0.8), ("edit", "way += speed", "way += speed * 2"), ("run", 0.6)),
        says="1000",
    ),
    Planted(
        name="a teleport that restarts a timer",
        question="It was nearly over. Why does it start from the beginning?",
        program="""\
(machine oven
  (state baking)
  (state ready)
  (ontime 2000 baking -> ready tready))
(spawn oven baking)
""",
        ask="tready",
        code="delay-not-over",
        line=4,
        do=(("run", 1.8), ("teleport", "oven/baking"), ("run", 1.0)),
        says="2000",
    ),
    Planted(
        name="the first of two enabled transitions",
        question="The level is very low. Why is there no alarm?",
        program="""\
(var level := [11])

(machine battery
  (event low [level < 6])
  (event verylow [level < 3])
  (state draining
    (running [level -= 1]))
  (state saving)
  (state alarm)
  (ontime 1000 draining -> saving tsave)
  (on verylow draining -> alarm talarm))
(spawn battery draining)
""",
        ask="talarm",
        code="earlier-fired",
        line=10,
        at=11,
        says="tsave",
    ),
    Planted(
        name="general before special",
        question="The level is below three. Why does it save instead of sounding the alarm?",
        program="""\
(var level := [2])

(machine battery
  (event low [level < 6])
  (event verylow [level < 3])
  (state checking)
  (state saving)
  (state alarm)
  (on low checking -> saving tsave)
  (on verylow checking -> alarm talarm))
(spawn battery checking)
""",
        ask="talarm",
        code="earlier-fired",
        line=9,
        at=2,
        says="tsave",
    ),
    Planted(
        name="an epsilon transition before the condition",
        question="The door is open. Why does it go the other way?",
        program="""\
(var open := [True])

(machine door
  (state deciding)
  (state through)
  (state around)
  (eps deciding -> around taround)
  (on [open] deciding -> through tthrough))
(spawn door deciding)
""",
        ask="tthrough",
        code="earlier-fired",
        line=7,
        at=2,
        says="taround",
    ),
    Planted(
        name="a wildcard that stands first",
        question="It has arrived. Why does it flee instead of celebrating?",
        program="""\
(var way := [0])

(event far [way >= 8])

(machine runner
  (on far *-> fleeing tflee)
  (state running
    (running [way += 1]))
  (state fleeing)
  (state celebrating)
  (on far running -> celebrating tcelebrate))
(spawn runner running)
""",
        ask="tcelebrate",
        code="earlier-fired",
        line=6,
        at=10,
        says="tflee",
    ),
    Planted(
        name="an exit before an inner transition",
        question="The inner machine should go to b. Why does it not?",
        program="""\
(var ready := [True])

(machine outer
  (state busy
    (onentry (spawn inner a))
    (machine inner
      (state a)
      (state b)
      (exit [ready] a -> done texit)
      (on [ready] a -> b tb)))
  (state done))
(spawn outer busy)
""",
        ask="tb",
        code="earlier-fired",
        line=9,
        at=2,
        says="texit",
    ),
    Planted(
        name="the wall is beside the robot and not ahead",
        question="The wall on the right is close. Why does it not veer?",
        program="""\
(var near := [0.45])   ; m

(machine follower
  (event blocked [robot.distance.data < near or robot.distance.all[1] < near])
  (state leaning)
  (state veering
    (running [robot.move(angular=0.8)]))
  (on blocked leaning -> veering tveer))
(spawn follower leaning)
""",
        ask="tveer",
        code="condition-false",
        line=4,
        world="walls",
        do=(("run", 1.0),),
        says="robot.distance.all[1]",
    ),
    Planted(
        name="the bumper is pressed but the floor is white",
        question="The bumper is pressed. Why is it not touching?",
        program="""\
(machine pusher
  (event touching [robot.bumper.data == 1 and robot.light.data < 50])
  (state approaching
    (running [robot.move(linear=0.3)]))
  (state pushing
    (running [robot.move(linear=0.1)]))
  (on touching approaching -> pushing tpush))
(spawn pusher approaching)
""",
        ask="tpush",
        code="condition-false",
        line=2,
        world="boxes",
        do=(("run", 3.0),),
        says="255",
    ),
    Planted(
        name="a border that is not dark enough for the limit",
        question="It stands on the black border. Why does it not back off?",
        program="""\
(machine guard
  (event border [robot.light.data < 0])
  (state driving
    (running [robot.move(linear=0.2)]))
  (state backing
    (running [robot.move(linear=-0.15)]))
  (on border driving -> backing tback))
(spawn guard driving)
""",
        ask="tback",
        code="condition-false",
        line=2,
        world="arena",
        do=(("place", (2.04, 0.9, 0.0)), ("run", 0.2)),
        at=2,
        says="robot.light.data",
    ),
    Planted(
        name="a counter that starts at the wrong place",
        question="It has gone more than half a metre. Why does it not turn?",
        program="""\
(var start := [0.0])

(machine walker
  (event far [robot.odom.x - start > 0.5])
  (state going
    (running [robot.move(linear=0.25)] [start += 0.02]))
  (state turning
    (running [robot.move(angular=1.0)]))
  (on far going -> turning tturn))
(spawn walker going)
""",
        ask="tturn",
        code="condition-false",
        line=4,
        world="empty",
        do=(("run", 3.0),),
        says="start",
    ),
    Planted(
        name="a transition from the wrong state",
        question="The bumper is pressed. Why does it not back off?",
        program="""\
(machine bumpy
  (event bump [robot.bumper.data == 1])
  (state searching
    (running [robot.move(linear=0.3)]))
  (state driving
    (running [robot.move(linear=0.3)]))
  (state backing
    (running [robot.move(linear=-0.1)]))
  (ontime 500 searching -> driving tdrive)
  (on bump searching -> backing tback))
(spawn bumpy searching)
""",
        ask="tback",
        code="source-inactive",
        line=9,
        world="boxes",
        do=(("run", 3.0),),
        says="driving",
    ),
    Planted(
        name="a wildcard that has taken over",
        question="Why does it no longer follow the line?",
        program="""\
(machine follower
  (state moving
    (running [robot.move(linear=0.2)]))
  (state looking
    (running [robot.move(angular=1.0)]))
  (state safe
    (onentry [robot.stop()]))
  (on [robot.light.data > 138] moving -> looking tlook)
  (on [robot.light.data < 118] looking -> moving tmove)
  (on [robot.odom.x > 0.1] *-> safe tsafe))
(spawn follower moving)
""",
        ask="tmove",
        code="source-inactive",
        line=10,
        world="line",
        do=(("run", 4.0),),
        says="safe",
    ),
    Planted(
        name="a state that lasts a single tick",
        question="It was in flash, I have seen it. Why did the condition not fire there?",
        program="""\
(var count := [0])

(machine camera
  (state waiting
    (running [count += 1]))
  (state flash)
  (state ready)
  (state printed)
  (on [count == 5] waiting -> flash tflash)
  (eps flash -> ready tready)
  (on [count > 4] flash -> printed tprint))
(spawn camera waiting)
""",
        ask="tprint",
        code="source-inactive",
        line=10,
        at=9,
        says="ready",
    ),
    Planted(
        name="a misspelt source",
        question="Three seconds are over. Why does it not wake up?",
        program="""\
(machine sleeper
  (state sleeping)
  (state awake)
  (ontime 1000 slepping -> awake twake))
(spawn sleeper sleeping)
""",
        ask="twake",
        code="source-inactive",
        line=4,
        says="sleeping",
    ),
    Planted(
        name="a wildcard does not leave its own destination",
        question="The alarm event occurs. Why is alarm not entered again?",
        program="""\
(var level := [0])

(event high [level > 5])

(machine siren
  (state quiet
    (running [level += 1]))
  (state alarm)
  (on high *-> alarm talarm))
(spawn siren quiet)
""",
        ask="talarm",
        code="source-inactive",
        line=9,
        says="alarm",
    ),
    Planted(
        name="a wildcard that excludes this state",
        question="The stop button is pressed. Why does it not stop?",
        program="""\
(var pressed := [False])

(machine mill
  (state starting)
  (state grinding
    (onentry [pressed = True]))
  (state stopped)
  (ontime 500 starting -> grinding tgrind)
  (on [pressed] *-{grinding} -> stopped tstop))
(spawn mill starting)
""",
        ask="tstop",
        code="source-inactive",
        line=9,
        says="grinding",
    ),
    Planted(
        name="put into another state by hand",
        question="It was on its way. Why does it not arrive?",
        program="""\
(machine train
  (state waiting)
  (state going)
  (state arrived)
  (ontime 500 waiting -> going tgo)
  (ontime 1000 going -> arrived tarrive))
(spawn train waiting)
""",
        ask="tarrive",
        code="source-inactive",
        line=6,
        do=(("run", 1.0), ("transition", "train/waiting"), ("run", 0.3)),
        says="waiting",
    ),
    Planted(
        name="the condition was over too early",
        question="The level was high at two seconds. Why did it not react?",
        program="""\
(var level := [0])

(machine source
  (state rising
    (running [level += 1]))
  (state falling
    (running [level -= 1]))
  (ontime 2000 rising -> falling tfall))

(machine reader
  (state busy)
  (state listening)
  (state heard)
  (ontime 2500 busy -> listening tlisten)
  (on [level > 15] listening -> heard theard))

(spawn source rising)
(spawn reader busy)
""",
        ask="theard",
        code="source-inactive",
        line=15,
        at=21,
        says="busy",
    ),
    Planted(
        name="a nested machine that is never spawned",
        question="Why does it not sweep to the right?",
        program="""\
(machine follower
  (state looking
    (machine sweep
      (state left)
      (state right)
      (ontime 200 left -> right tright)))
  (state moving)
  (ontime 5000 looking -> moving tmove))
(spawn follower looking)
""",
        ask="tright",
        code="machine-not-running",
        line=6,
        says="sweep",
    ),
    Planted(
        name="a machine that another state spawns",
        question="It is in looking. Why does the sweep not run?",
        program="""\
(machine follower
  (state looking)
  (state moving
    (onentry (spawn sweep left)))
  (ontime 1000 moving -> looking tlook))

(machine sweep
  (state left)
  (state right)
  (ontime 200 left -> right tright)
  (ontime 200 right -> left tleft))

(spawn follower moving)
""",
        ask="tright",
        code="machine-not-running",
        line=4,
        says="sweep",
    ),
    Planted(
        name="nothing is tested in the first tick",
        question="The condition is true at the start. Why does it not fire at once?",
        program="""\
(machine starter
  (state waiting)
  (state going)
  (on [True] waiting -> going tgo))
(spawn starter waiting)
""",
        ask="tgo",
        code="machine-not-running",
        line=4,
        at=1,
        says="starter",
    ),
    Planted(
        name="spawned only in that tick",
        question="It was spawned at 0.5 s. Why did it not test anything then?",
        program="""\
(machine outer
  (state resting)
  (state working
    (onentry (spawn inner first))
    (machine inner
      (state first)
      (state second)
      (on [True] first -> second tsecond)))
  (ontime 500 resting -> working twork))
(spawn outer resting)
""",
        ask="tsecond",
        code="machine-not-running",
        line=9,
        at=6,
        says="inner",
    ),
    Planted(
        name="the inner machine ended with its state",
        question="Why does the counting not go on?",
        program="""\
(var count := [0])

(machine outer
  (state counting
    (onentry (spawn inner one))
    (machine inner
      (state one
        (running [count += 1]))
      (state two)
      (on [count > 20] one -> two ttwo)))
  (state resting)
  (ontime 1000 counting -> resting trest))
(spawn outer counting)
""",
        ask="ttwo",
        code="machine-not-running",
        line=12,
        says="inner",
    ),
    Planted(
        name="in the tick after a reset",
        question="I have reset it. Why is the transition not tested in the tick after?",
        program="""\
(var level := [9])

(machine tank
  (state full)
  (state empty)
  (on [level > 100] full -> empty tempty))
(spawn tank full)
""",
        ask="tempty",
        code="machine-not-running",
        line=6,
        do=(("run", 1.0), ("reset",), ("run", 0.5)),
        at=11,
        says="tank",
    ),
    Planted(
        name="a spawn forgotten at the top level",
        question="Why does the lamp never blink?",
        program="""\
(machine engine
  (state idle)
  (state going)
  (ontime 1000 idle -> going tgo))

(machine lamp
  (state off)
  (state on)
  (ontime 300 off -> on ton)
  (ontime 300 on -> off toff))

(spawn engine idle)
""",
        ask="ton",
        code="machine-not-running",
        line=9,
        says="lamp",
    ),
    Planted(
        name="an outer timeout in the same tick",
        question="One second is over. Why does the inner machine not go on?",
        program="""\
(machine outer
  (state working
    (onentry (spawn inner first))
    (machine inner
      (state first)
      (state second)
      (ontime 1000 first -> second tsecond)))
  (state resting)
  (ontime 1000 working -> resting trest))
(spawn outer working)
""",
        ask="tsecond",
        code="outer-fired",
        line=9,
        at=11,
        says="trest",
    ),
    Planted(
        name="the outer machine sees the event first",
        question="The event occurs. Why does only the outer machine react?",
        program="""\
(var count := [0])

(event enough [count >= 5])

(machine outer
  (state counting
    (onentry (spawn inner adding))
    (machine inner
      (state adding
        (running [count += 1]))
      (state added)
      (on enough adding -> added tadded)))
  (state stopped)
  (on enough counting -> stopped tstopped))
(spawn outer counting)
""",
        ask="tadded",
        code="outer-fired",
        line=14,
        at=7,
        says="tstopped",
    ),
    Planted(
        name="an outer wildcard interrupts the inner machine",
        question="It is at the wall. Why does the sweep not turn back?",
        program="""\
(machine guard
  (event bump [robot.bumper.data == 1])
  (state patrol
    (onentry (spawn legs straight))
    (machine legs
      (state straight
        (running [robot.move(linear=0.4)]))
      (state back
        (running [robot.move(linear=-0.2)]))
      (on bump straight -> back tback)))
  (state alarm
    (onentry [robot.stop()]))
  (on bump *-> alarm talarm))
(spawn guard patrol)
""",
        ask="tback",
        code="outer-fired",
        line=13,
        world="boxes",
        at=16,
        says="talarm",
    ),
    Planted(
        name="two levels further out",
        question="Why does the innermost machine not change its state?",
        program="""\
(machine top
  (state on
    (onentry (spawn middle running))
    (machine middle
      (state running
        (onentry (spawn bottom low))
        (machine bottom
          (state low)
          (state high)
          (ontime 600 low -> high thigh)))))
  (state off)
  (ontime 600 on -> off toff))
(spawn top on)
""",
        ask="thigh",
        code="outer-fired",
        line=12,
        at=7,
        says="toff",
    ),
    Planted(
        name="the exit of the machine beside it",
        question="The arms should go up at once. Why do they not?",
        program="""\
(machine walker
  (state busy
    (onentry
      (spawn legs walking)
      (spawn arms down))
    (machine legs
      (state walking)
      (exit [True] walking -> done tdone))
    (machine arms
      (state down)
      (state up)
      (on [True] down -> up tup)))
  (state done))
(spawn walker busy)
""",
        ask="tup",
        code="exit-took-parent",
        line=8,
        at=2,
        says="tdone",
    ),
    Planted(
        name="a counter that leaves for both",
        question="At the count of five the lamp should go on. Why does it not?",
        program="""\
(var count := [0])

(event five [count == 5])

(machine watch
  (state running
    (onentry
      (spawn counter counting)
      (spawn lamp dark))
    (running [count += 1])
    (machine counter
      (state counting)
      (exit five counting -> stopped tstopped))
    (machine lamp
      (state dark)
      (state lit)
      (on five dark -> lit tlit)))
  (state stopped))
(spawn watch running)
""",
        ask="tlit",
        code="exit-took-parent",
        line=13,
        at=6,
        says="tstopped",
    ),
    Planted(
        name="the guard beside it leaves first",
        question="The bumper is pressed. Why does the arm not draw back?",
        program="""\
(machine pusher
  (event bump [robot.bumper.data == 1])
  (state pushing
    (onentry
      (spawn wheels driving)
      (spawn arm stretched))
    (machine wheels
      (state driving
        (running [robot.move(linear=0.3)]))
      (exit bump driving -> resting trest))
    (machine arm
      (state stretched)
      (state drawn)
      (on bump stretched -> drawn tdraw)))
  (state resting
    (onentry [robot.stop()])))
(spawn pusher pushing)
""",
        ask="tdraw",
        code="exit-took-parent",
        line=10,
        world="boxes",
        at=20,
        says="trest",
    ),
    Planted(
        name="a timeout that leaves beside a timeout",
        question="Why did the lamp not go on after one second?",
        program="""\
(machine house
  (state evening
    (onentry
      (spawn clock ticking)
      (spawn lamp off))
    (machine clock
      (var minutes := [0])
      (state ticking
        (running [minutes += 1]))
      (exit [minutes >= 9] ticking -> night tnight))
    (machine lamp
      (state off)
      (state on)
      (ontime 1000 off -> on ton)))
  (state night))
(spawn house evening)
""",
        ask="ton",
        code="exit-took-parent",
        line=10,
        at=11,
        says="tnight",
    ),
    Planted(
        name="a list as a condition",
        question="The list is not empty. Why does it not go on?",
        program="""\
(var seen := [["wall", "box"]])

(machine finder
  (state looking)
  (state found)
  (on [seen] looking -> found tfound))
(spawn finder looking)
""",
        ask="tfound",
        code="not-boolean",
        line=6,
        says="['wall', 'box']",
    ),
    Planted(
        name="or with a text",
        question="The colour is green. Why is the condition wrong?",
        program="""\
(var colour := ["green"])

(event warm [colour == "red" or "yellow"])

(machine painter
  (state cold)
  (state hot)
  (on warm cold -> hot thot))
(spawn painter cold)
""",
        ask="thot",
        code="not-boolean",
        line=3,
        says="yellow",
    ),
    Planted(
        name="a function that is not called",
        question="The light is bright. Why does it not stop?",
        program="""\
(machine lamp
  (event bright [
    def is_bright():
        return robot.light.data > 128
    is_bright])
  (state driving
    (running [robot.move(linear=0.2)]))
  (state resting
    (onentry [robot.stop()]))
  (on bright driving -> resting trest))
(spawn lamp driving)
""",
        ask="trest",
        code="not-boolean",
        line=2,
        world="line",
        do=(("run", 4.0),),
        says="is_bright",
    ),
    Planted(
        name="a number as a condition",
        question="The count is not zero. Why does it not count as true?",
        program="""\
(var count := [0])

(machine counter
  (state counting
    (running [count += 1]))
  (state some)
  (on [count] counting -> some tsome))
(spawn counter counting)
""",
        ask="tsome",
        code="not-boolean",
        line=7,
        at=9,
        says="7",
    ),
    Planted(
        name="an assignment instead of a comparison",
        question="Mode is 2. Why does it not switch?",
        program="""\
(var mode := [2])

(machine switch
  (state off)
  (state on)
  (on [mode = 2] off -> on ton))
(spawn switch off)
""",
        ask="ton",
        code="not-boolean",
        line=6,
        says="None",
    ),
    Planted(
        name="a method of the robot as a condition",
        question="It stands still. Why is it not in resting?",
        program="""\
(machine mover
  (state standing
    (onentry [robot.stop()]))
  (state resting)
  (on [robot.stop] standing -> resting trest))
(spawn mover standing)
""",
        ask="trest",
        code="not-boolean",
        line=5,
        world="empty",
        do=(("run", 1.0),),
        says="robot.stop",
    ),
    Planted(
        name="a text added to a number",
        question="Why does the score never reach the limit?",
        program="""\
(var score := ["5"])

(machine game
  (event won [score + 1 > 5])
  (state playing)
  (state over)
  (on won playing -> over tover))
(spawn game playing)
""",
        ask="tover",
        code="raised",
        line=4,
        says="str",
    ),
    Planted(
        name="an undefined name",
        question="The light is bright enough. Why does nothing happen?",
        program="""\
(var lightlim := [128])

(machine follower
  (event bright [robot.light.data > lightlimit])
  (state moving
    (running [robot.move(linear=0.2)]))
  (state looking
    (running [robot.move(angular=1.0)]))
  (on bright moving -> looking tlook))
(spawn follower moving)
""",
        ask="tlook",
        code="raised",
        line=4,
        world="line",
        do=(("run", 4.0),),
        says="lightlimit",
    ),
    Planted(
        name="a division by zero",
        question="The ratio is large. Why does it not fire?",
        program="""\
(var left := [8])
(var right := [0])

(machine scale
  (state level)
  (state tilted)
  (on [left / right > 2] level -> tilted ttilt))
(spawn scale level)
""",
        ask="ttilt",
        code="raised",
        line=7,
        says="division by zero",
    ),
    Planted(
        name="an index behind the end of a list",
        question="It is at the fourth station. Why does it not stop there?",
        program="""\
(var stations := [["a", "b", "c"]])
(var here := [0])

(machine train
  (event terminus [stations[here] == "d"])
  (state going
    (running [here += 1]))
  (state ended)
  (on terminus going -> ended tend))
(spawn train going)
""",
        ask="tend",
        code="raised",
        line=5,
        at=10,
        says="out of range",
    ),
    Planted(
        name="a delay that is a text",
        question="The time is over. Why does it not go on?",
        program="""\
(var pause := ["500"])

(machine waiter
  (state waiting)
  (state going)
  (ontime pause waiting -> going tgo))
(spawn waiter waiting)
""",
        ask="tgo",
        code="raised",
        line=6,
        says="500",
    ),
    Planted(
        name="a sensor that this robot does not have",
        question="It is red. Why does it not stop?",
        program="""\
(machine follower
  (event red [robot.colour.data == "red"])
  (state moving
    (running [robot.move(linear=0.1)]))
  (state stopped
    (onentry [robot.stop()]))
  (on red moving -> stopped tstop))
(spawn follower moving)
""",
        ask="tstop",
        code="raised",
        line=2,
        world="line",
        do=(("run", 1.0),),
        says="colour",
    ),
    Planted(
        name="the sensor instead of its value",
        question="The light is below the limit. Why does it not stop?",
        program="""\
(machine follower
  (event dark [robot.light < 128])
  (state moving
    (running [robot.move(linear=0.1)]))
  (state stopped
    (onentry [robot.stop()]))
  (on dark moving -> stopped tstop))
(spawn follower moving)
""",
        ask="tstop",
        code="raised",
        line=2,
        world="line",
        do=(("run", 1.0),),
        says="robot.light",
    ),
    Planted(
        name="a scanner that has not sent anything yet",
        question="Nothing is in the way. Why does it not start?",
        program="""\
(machine starter
  (event free [robot.scan.data > 0.5])
  (state waiting)
  (state driving
    (running [robot.move(linear=0.2)]))
  (on free waiting -> driving tdrive))
(spawn starter waiting)
""",
        ask="tdrive",
        code="no-data",
        line=2,
        world="late",
        do=(("run", 1.0),),
        says="robot.scan.data",
    ),
    Planted(
        name="a sensor that is not connected",
        question="Why does it not notice the dark?",
        program="""\
(machine lamp
  (state day)
  (state night)
  (on [robot.light.data < 50] day -> night tnight))
(spawn lamp day)
""",
        ask="tnight",
        code="no-data",
        line=4,
        world="late",
        do=(("run", 5.0),),
        says="robot.light.data",
    ),
    Planted(
        name="the second part has no data",
        question="The scan is free. Why does it not drive?",
        program="""\
(machine starter
  (event free [robot.scan.data > 0.5 and robot.light.data > 100])
  (state waiting)
  (state driving
    (running [robot.move(linear=0.2)]))
  (on free waiting -> driving tdrive))
(spawn starter waiting)
""",
        ask="tdrive",
        code="no-data",
        line=2,
        world="late",
        do=(("run", 4.0),),
        says="robot.light.data",
    ),
    Planted(
        name="a misspelt event",
        question="The bumper is pressed. Why does it not stop?",
        program="""\
(machine driver
  (event bumped [robot.bumper.data == 1])
  (state driving
    (running [robot.move(linear=0.3)]))
  (state stopped
    (onentry [robot.stop()]))
  (on bumpd driving -> stopped tstop))
(spawn driver driving)
""",
        ask="tstop",
        code="unknown-event",
        line=7,
        world="boxes",
        do=(("run", 3.0),),
        says="bumpd",
    ),
    Planted(
        name="an event of the inner machine used outside",
        question="The inner machine has counted enough. Why does the outer one not stop?",
        program="""\
(machine outer
  (state counting
    (onentry (spawn inner adding))
    (machine inner
      (var count := [0])
      (event enough [count > 5])
      (state adding
        (running [count += 1]))))
  (state stopped)
  (on enough counting -> stopped tstop))
(spawn outer counting)
""",
        ask="tstop",
        code="unknown-event",
        line=10,
        says="enough",
    ),
    Planted(
        name="an event of the machine beside it",
        question="The clock has rung. Why does nobody get up?",
        program="""\
(machine clock
  (var minutes := [0])
  (event ringing [minutes > 10])
  (state ticking
    (running [minutes += 1])))

(machine sleeper
  (state asleep)
  (state awake)
  (on ringing asleep -> awake twake))

(spawn clock ticking)
(spawn sleeper asleep)
""",
        ask="twake",
        code="unknown-event",
        line=10,
        says="ringing",
    ),
    Planted(
        name="a variable taken for an event",
        question="The variable is True. Why does it not go?",
        program="""\
(var ready := [True])

(machine runner
  (state waiting)
  (state going)
  (on ready waiting -> going tgo))
(spawn runner waiting)
""",
        ask="tgo",
        code="unknown-event",
        line=6,
        says="ready",
    ),
    Planted(
        name="a misspelt destination",
        question="One second is over. Why does it not go to resting?",
        program="""\
(machine walker
  (state walking)
  (state resting)
  (ontime 1000 walking -> restng trest))
(spawn walker walking)
""",
        ask="trest",
        code="unknown-destination",
        line=4,
        says="restng",
    ),
    Planted(
        name="a destination in the inner machine",
        question="It should begin in the second state. Why does it not?",
        program="""\
(machine outer
  (state idle)
  (state working
    (onentry (spawn inner first))
    (machine inner
      (state first)
      (state second)
      (ontime 300 first -> second tsecond)))
  (eps idle -> second tbegin))
(spawn outer idle)
""",
        ask="tbegin",
        code="unknown-destination",
        line=9,
        says="second",
    ),
    Planted(
        name="on instead of exit",
        question="The inner machine is done. Why does it not leave?",
        program="""\
(machine outer
  (var count := [0])
  (state working
    (onentry (spawn inner counting))
    (machine inner
      (state counting
        (running [count += 1]))
      (on [count > 5] counting -> finished tfinish)))
  (state finished))
(spawn outer working)
""",
        ask="tfinish",
        code="unknown-destination",
        line=8,
        says="finished",
    ),
    Planted(
        name="exit instead of on",
        question="Two hundred milliseconds are over. Why does it not go right?",
        program="""\
(machine outer
  (state looking
    (onentry (spawn inner left))
    (machine inner
      (var turns := [0])
      (state left
        (running [turns += 1]))
      (state right)
      (exit [turns > 2] left -> right tright))))
(spawn outer looking)
""",
        ask="tright",
        code="unknown-destination",
        line=9,
        says="right",
    ),
    Planted(
        name="a state that lasts too short to be seen",
        question="Why is the flash never shown?",
        program="""\
(machine camera
  (state waiting)
  (state flash)
  (state dark)
  (ontime 1000 waiting -> flash tflash)
  (eps flash -> dark tdark))
(spawn camera waiting)
""",
        ask="tflash",
        code="fired",
        line=5,
        at=11,
        says="flash",
    ),
    Planted(
        name="milliseconds taken for seconds",
        question="It should wait two seconds. Why did it go at once?",
        program="""\
(machine waiter
  (state waiting)
  (state going)
  (ontime 2 waiting -> going tgo))
(spawn waiter waiting)
""",
        ask="tgo",
        code="fired",
        line=4,
        at=2,
        says="going",
    ),
    Planted(
        name="it fired and another led back",
        question="The bell should have rung. Why did it not?",
        program="""\
(var count := [0])

(machine bell
  (state silent
    (running [count += 1]))
  (state ringing)
  (on [count % 4 == 3] silent -> ringing tring)
  (on [count > 2] ringing -> silent tsilent))
(spawn bell silent)
""",
        ask="tring",
        code="fired",
        line=7,
        at=5,
        says="ringing",
    ),
    Planted(
        name="centimetres taken for metres",
        question="It is almost two metres away. Why does it turn already?",
        program="""\
(machine driver
  (event near [robot.distance.data < 20])
  (state driving
    (running [robot.move(linear=0.2)]))
  (state turning
    (running [robot.move(angular=0.5)]))
  (on near driving -> turning tturn))
(spawn driver driving)
""",
        ask="turning",
        code="fired",
        line=7,
        kind="why",
        world="walls",
        do=(("run", 2.0),),
        says="tturn",
    ),
    Planted(
        name="the wrong one of two transitions",
        question="Why is it in saving and not in alarm?",
        program="""\
(var level := [10])

(machine battery
  (state draining
    (running [level -= 1]))
  (state saving)
  (state alarm)
  (on [level < 6] draining -> saving tsave)
  (on [level < 3] draining -> alarm talarm))
(spawn battery draining)
""",
        ask="saving",
        code="fired",
        line=8,
        kind="why",
        says="tsave",
    ),
    Planted(
        name="a wildcard led here",
        question="Why does it back off in the middle of the room?",
        program="""\
(var hits := [1])

(machine guard
  (event hit [hits > 0])
  (state driving
    (running [robot.move(linear=0.2)]))
  (state turning
    (running [robot.move(angular=1.0)]))
  (state backing
    (running [robot.move(linear=-0.1)]))
  (ontime 300 driving -> turning tturn)
  (on hit *-> backing tback))
(spawn guard driving)
""",
        ask="backing",
        code="fired",
        line=12,
        kind="why",
        world="empty",
        do=(("run", 1.0),),
        says="tback",
    ),
    Planted(
        name="an exit led here",
        question="Why is the outer machine in resting?",
        program="""\
(machine outer
  (state working
    (onentry (spawn inner first))
    (machine inner
      (var turns := [0])
      (state first
        (running [turns += 1]))
      (exit [turns == 4] first -> resting texit)))
  (state resting)
  (ontime 5000 working -> resting trest))
(spawn outer working)
""",
        ask="resting",
        code="fired",
        line=8,
        kind="why",
        says="texit",
    ),
    Planted(
        name="an or that lets it through",
        question="It was not told to go. Why is it in going?",
        program="""\
(var told := [False])
(var warm := [True])

(machine kettle
  (event start [told or warm])
  (state waiting)
  (state going)
  (on start waiting -> going tgo))
(spawn kettle waiting)
""",
        ask="going",
        code="fired",
        line=5,
        kind="why",
        says="warm",
    ),
    Planted(
        name="asked about an earlier moment",
        question="Why was it in green after one second?",
        program="""\
(machine lights
  (state red)
  (state green)
  (ontime 800 red -> green tgreen)
  (ontime 800 green -> red tred))
(spawn lights red)
""",
        ask="green",
        code="fired",
        line=4,
        kind="why",
        do=(("run", 2.0),),
        at=11,
        says="tgreen",
    ),
    Planted(
        name="paused by a person",
        question="The time is over long ago. Why does it not go on?",
        program="""\
(machine waiter
  (state waiting)
  (state going)
  (ontime 2000 waiting -> going tgo))
(spawn waiter waiting)
""",
        ask="tgo",
        code="paused",
        line=4,
        do=(("run", 1.0), ("pause",)),
    ),
    Planted(
        name="paused just before the bumper is pressed",
        question="It is at the box. Why does it not back off?",
        program="""\
(machine bumpy
  (event bump [robot.bumper.data == 1])
  (state driving
    (running [robot.move(linear=0.3)]))
  (state backing
    (running [robot.move(linear=-0.1)]))
  (on bump driving -> backing tback))
(spawn bumpy driving)
""",
        ask="tback",
        code="paused",
        line=7,
        world="boxes",
        do=(("run", 1.8), ("pause",)),
    ),
    Planted(
        name="a variable set while it is paused",
        question="I have set the flag. Why does it not start?",
        program="""\
(var ready := [False])

(machine starter
  (state waiting)
  (state started)
  (on [ready] waiting -> started tstart))
(spawn starter waiting)
""",
        ask="tstart",
        code="paused",
        line=6,
        do=(("run", 1.0), ("pause",), ("set", "ready", "True")),
    ),
    Planted(
        name="paused by the stop button",
        question="I have stopped the robot. Why does the program not rest after a second?",
        program="""\
(machine driver
  (state driving
    (running [robot.move(linear=0.1)]))
  (state resting)
  (ontime 1000 driving -> resting trest))
(spawn driver driving)
""",
        ask="trest",
        code="paused",
        line=5,
        world="empty",
        do=(("run", 0.5), ("stop",)),
    ),
    Planted(
        name="a transition added afterwards",
        question="The level was high at one second. Why did it not react?",
        program="""\
(var level := [9])

(machine tank
  (state filling)
  (state full)
  (ontime 9000 filling -> full tlate))
(spawn tank filling)
""",
        ask="tfull",
        code="not-in-program",
        line=7,
        do=(
            ("run", 2.0),
            ("edit", "tlate))", "tlate)\n  (on [level > 5] filling -> full tfull))"),
            ("run", 1.0),
        ),
        at=10,
        says="tfull",
    ),
    Planted(
        name="a state and its transition added afterwards",
        question="Why was the robot not backing at two seconds?",
        program="""\
(machine bumpy
  (event bump [robot.bumper.data == 1])
  (state driving
    (running [robot.move(linear=0.3)])))
(spawn bumpy driving)
""",
        ask="tback",
        code="not-in-program",
        line=7,
        world="boxes",
        do=(
            ("run", 2.5),
            (
                "edit",
                "0.3)])))",
                "0.3)]))\n"
                "  (state backing\n"
                "    (running [robot.move(linear=-0.1)]))\n"
                "  (on bump driving -> backing tback))",
            ),
            ("run", 0.5),
        ),
        at=20,
        says="tback",
    ),
    Planted(
        name="a machine added afterwards",
        question="Why did the lamp not go on after half a second?",
        program="""\
(machine engine
  (state idle)
  (state going)
  (ontime 1000 idle -> going tgo))
(spawn engine idle)
""",
        ask="ton",
        code="not-in-program",
        line=10,
        do=(
            ("run", 2.0),
            (
                "edit",
                "(spawn engine idle)",
                "(spawn engine idle)\n"
                "\n"
                "(machine lamp\n"
                "  (state off)\n"
                "  (state on)\n"
                "  (ontime 300 off -> on ton))\n"
                "(spawn lamp off)",
            ),
            ("run", 1.0),
        ),
        at=6,
        says="ton",
    ),
    Planted(
        name="the start state of the program",
        question="Nothing led there. Why is it in waiting?",
        program="""\
(machine starter
  (state going)
  (state waiting)
  (ontime 5000 waiting -> going tgo))
(spawn starter waiting)
""",
        ask="waiting",
        code="spawned",
        line=5,
        kind="why",
        says="starter",
    ),
    Planted(
        name="the start state of a nested machine",
        question="Why does the sweep begin on the left each time?",
        program="""\
(machine follower
  (state resting)
  (state looking
    (onentry (spawn sweep left))
    (machine sweep
      (state right)
      (state left)
      (ontime 2000 left -> right tright)))
  (ontime 1000 resting -> looking tlook))
(spawn follower resting)
""",
        ask="left",
        code="spawned",
        line=4,
        kind="why",
        says="looking",
    ),
    Planted(
        name="spawned again by a self transition",
        question="It was in second. Why is it in first again?",
        program="""\
(machine outer
  (state working
    (onentry (spawn inner first))
    (machine inner
      (state first)
      (state second)
      (ontime 500 first -> second tsecond)))
  (ontime 1200 {working} -> working tagain))
(spawn outer working)
""",
        ask="first",
        code="spawned",
        line=3,
        kind="why",
        at=15,
        says="working",
    ),
    Planted(
        name="a machine of the top level spawned by a state",
        question="Why is the siren in loud?",
        program="""\
(machine guard
  (state calm)
  (state alarmed
    (onentry (spawn siren loud)))
  (ontime 1500 calm -> alarmed talarm))

(machine siren
  (state soft)
  (state loud))

(spawn guard calm)
""",
        ask="loud",
        code="spawned",
        line=4,
        kind="why",
        says="alarmed",
    ),
    Planted(
        name="forced by a person",
        question="No transition led there. Why is it in resting?",
        program="""\
(machine worker
  (state working)
  (state resting)
  (on [False] working -> resting trest))
(spawn worker working)
""",
        ask="resting",
        code="forced",
        line=3,
        kind="why",
        do=(("run", 1.0), ("transition", "worker/resting")),
    ),
    Planted(
        name="teleported and still there",
        question="Why is it in b although a never ended?",
        program="""\
(machine steps
  (state a)
  (state b)
  (state c)
  (ontime 60000 a -> b tb)
  (ontime 60000 b -> c tc))
(spawn steps a)
""",
        ask="b",
        code="forced",
        line=3,
        kind="why",
        do=(("run", 1.0), ("teleport", "steps/b"), ("run", 2.0)),
    ),
    Planted(
        name="an inner state forced from outside",
        question="Why is it in right while the robot was moving?",
        program="""\
(machine follower
  (state moving)
  (state looking
    (onentry (spawn sweep left))
    (machine sweep
      (state left)
      (state right)
      (ontime 900 left -> right tright)))
  (ontime 9000 moving -> looking tlook))
(spawn follower moving)
""",
        ask="right",
        code="forced",
        line=7,
        kind="why",
        do=(("run", 1.0), ("transition", "follower/looking/sweep/right"), ("run", 0.5)),
    ),
    Planted(
        name="an edit of the active state",
        question="It was in cruising. Why is it back in starting?",
        program="""\
(var way := [0])

(machine cruiser
  (state starting)
  (state cruising
    (running [way += 1]))
  (ontime 1000 starting -> cruising tcruise))
(spawn cruiser starting)
""",
        ask="starting",
        code="restarted",
        line=8,
        kind="why",
        do=(("run", 2.0), ("edit", "way += 1", "way += 2"), ("run", 0.5)),
        says="cruising",
    ),
    Planted(
        name="a reset by a person",
        question="It was nearly done. Why is it in first again?",
        program="""\
(machine steps
  (state first)
  (state second)
  (ontime 1000 first -> second tsecond))
(spawn steps first)
""",
        ask="first",
        code="restarted",
        line=5,
        kind="why",
        do=(("run", 2.0), ("reset",), ("run", 0.5)),
    ),
    Planted(
        name="the active state renamed by typing",
        question="I have only renamed a state. Why did it begin again?",
        program="""\
(machine walker
  (state standing)
  (state walking)
  (ontime 1000 standing -> walking twalk))
(spawn walker standing)
""",
        ask="standing",
        code="restarted",
        line=5,
        kind="why",
        do=(("run", 2.0), ("edit", "(state walking)", "(state strolling)"), ("run", 0.5)),
        says="walking",
    ),
    Planted(
        name="the second machine has the last word",
        question="The legs drive straight on. Why does it turn?",
        program="""\
(machine legs
  (state straight
    (running [robot.move(linear=0.2)])))

(machine avoider
  (state turning
    (running [robot.move(angular=0.5)])))

(spawn legs straight)
(spawn avoider turning)
""",
        ask="robot.move",
        code="commanded",
        line=7,
        kind="why",
        world="empty",
        do=(("run", 1.0),),
        says="turning",
    ),
    Planted(
        name="the sign of the speed",
        question="Why does it drive backwards?",
        program="""\
(var speed := [0.2])

(machine driver
  (state forward
    (running [robot.move(linear=speed)]))
  (state corner
    (onentry [speed = -speed]))
  (ontime 1000 forward -> corner tcorner)
  (ontime 300 corner -> forward tforward))
(spawn driver forward)
""",
        ask="robot.move",
        code="commanded",
        line=5,
        kind="why",
        world="empty",
        do=(("run", 2.0),),
        says="-0.2",
    ),
    Planted(
        name="a stop in onexit overrides",
        question="It should turn after driving. Why does it stand?",
        program="""\
(machine driver
  (state driving
    (running [robot.move(linear=0.2)])
    (onexit [robot.stop()]))
  (state turning)
  (ontime 1000 driving -> turning tturn))
(spawn driver driving)
""",
        ask="robot.stop",
        code="commanded",
        line=4,
        kind="why",
        world="empty",
        do=(("run", 1.3),),
        says="driving",
    ),
    Planted(
        name="a stop in onexit after the last move",
        question="It was told to drive. Why does it stand?",
        program="""\
(machine driver
  (state driving
    (running [robot.move(linear=0.2)])
    (onexit [robot.stop()]))
  (state waiting)
  (ontime 2000 driving -> waiting twait))
(spawn driver driving)
""",
        ask="robot.move",
        code="commanded",
        line=4,
        kind="why",
        world="line",
        do=(("run", 2.3),),
        says="robot.stop",
    ),
    Planted(
        name="a stop after the move in the same block",
        question="It is told to drive. Why does it stand?",
        program="""\
(machine driver
  (state driving
    (running
      [robot.move(linear=0.2)]
      [robot.stop()])))
(spawn driver driving)
""",
        ask="robot.stop",
        code="commanded",
        line=5,
        kind="why",
        world="empty",
        do=(("run", 1.0),),
        says="driving",
    ),
    Planted(
        name="an inner machine turns while the outer one drives",
        question="Why does it drive in a curve and not straight?",
        program="""\
(machine outer
  (state driving
    (onentry (spawn wiggle left))
    (running [robot.move(linear=0.2)])
    (machine wiggle
      (state left
        (running [robot.move(linear=0.1, angular=0.6)])))))
(spawn outer driving)
""",
        ask="robot.move",
        code="commanded",
        line=7,
        kind="why",
        world="empty",
        do=(("run", 1.0),),
        says="left",
    ),
    Planted(
        name="faster than the robot can",
        question="I want two metres per second. Why is it so slow?",
        program="""\
(machine racer
  (state racing
    (running [robot.move(linear=2.0)])))
(spawn racer racing)
""",
        ask="robot.move",
        code="limited",
        line=3,
        kind="why",
        world="line",
        do=(("run", 0.5),),
        says="0.5",
    ),
    Planted(
        name="centimetres per second",
        question="20 should be slow. Why does it run that fast?",
        program="""\
(var speed := [20])   ; cm per second

(machine walker
  (state walking
    (running [robot.move(linear=speed)])))
(spawn walker walking)
""",
        ask="robot.move",
        code="limited",
        line=5,
        kind="why",
        world="empty",
        do=(("run", 1.0),),
        says="20",
    ),
    Planted(
        name="degrees per second",
        question="It should turn by 90 degrees in a second. Why does it turn by more?",
        program="""\
(machine turner
  (state turning
    (running [robot.move(angular=90)])))
(spawn turner turning)
""",
        ask="robot.move",
        code="limited",
        line=3,
        kind="why",
        world="empty",
        do=(("run", 1.0),),
        says="4",
    ),
    Planted(
        name="move in onentry only",
        question="It drives a little and stops. Why?",
        program="""\
(machine driver
  (state driving
    (onentry [robot.move(linear=0.2)])))
(spawn driver driving)
""",
        ask="robot.move",
        code="watchdog",
        line=3,
        kind="why",
        world="empty",
        do=(("run", 2.0),),
        says="0.5",
    ),
    Planted(
        name="a state without any command",
        question="It left driving without a stop. Why does it stand now?",
        program="""\
(machine driver
  (state driving
    (running [robot.move(linear=0.2)]))
  (state resting)
  (ontime 1000 driving -> resting trest))
(spawn driver driving)
""",
        ask="robot.move",
        code="watchdog",
        line=3,
        kind="why",
        world="empty",
        do=(("run", 3.0),),
    ),
    Planted(
        name="a turn that is commanded once",
        question="Why does it turn for half a second only?",
        program="""\
(machine turner
  (state waiting)
  (state turning
    (onentry [robot.move(angular=1.0)]))
  (state done)
  (ontime 500 waiting -> turning tturn)
  (ontime 3142 turning -> done tdone))
(spawn turner waiting)
""",
        ask="robot.move",
        code="watchdog",
        line=4,
        kind="why",
        world="walls",
        do=(("run", 2.0),),
    ),
    Planted(
        name="disarmed by a person",
        question="The wheels are told to turn. Why do they not?",
        program="""\
(machine driver
  (state driving
    (running [robot.move(linear=0.2)])))
(spawn driver driving)
""",
        ask="robot.move",
        code="disarmed",
        line=3,
        kind="why",
        world="empty",
        do=(("run", 1.0), ("disarm",), ("run", 1.0)),
    ),
    Planted(
        name="a real robot begins disarmed",
        question="The program runs. Why does the robot not move?",
        program="""\
(machine driver
  (state waiting)
  (state driving
    (running [robot.move(linear=0.2)]))
  (ontime 500 waiting -> driving tdrive))
(spawn driver waiting)
""",
        ask="robot.move",
        code="disarmed",
        line=4,
        kind="why",
        world="late hardware",
        do=(("run", 2.0),),
    ),
    Planted(
        name="disarmed and fast",
        question="It is told to race. Why does nothing move?",
        program="""\
(machine racer
  (state racing
    (running [robot.move(angular=1.0)])))
(spawn racer racing)
""",
        ask="robot.move",
        code="disarmed",
        line=3,
        kind="why",
        world="line",
        do=(("disarm",), ("run", 1.0)),
    ),
    Planted(
        name="stopped by the stop button",
        question="Why does the robot stand?",
        program="""\
(machine driver
  (state driving
    (running [robot.move(linear=0.2)])))
(spawn driver driving)
""",
        ask="robot.move",
        code="stopped",
        line=3,
        kind="why",
        world="empty",
        do=(("run", 1.0), ("stop",)),
    ),
    Planted(
        name="stopped by a pause",
        question="It is in driving. Why does it not drive?",
        program="""\
(machine driver
  (state driving
    (running [robot.move(angular=0.7)])))
(spawn driver driving)
""",
        ask="robot.move",
        code="stopped",
        line=3,
        kind="why",
        world="line",
        do=(("run", 1.0), ("pause",)),
    ),
    Planted(
        name="stopped by a restart",
        question="I changed the speed while it drove. Why does it stand?",
        program="""\
(machine driver
  (state driving
    (running [robot.move(linear=0.2)])))
(spawn driver driving)
""",
        ask="robot.move",
        code="stopped",
        line=3,
        kind="why",
        world="empty",
        do=(("run", 1.0), ("edit", "0.2", "0.1")),
    ),
    Planted(
        name="stopped by a reset",
        question="Why did the robot stop in the middle of the room?",
        program="""\
(machine driver
  (state driving
    (running [robot.move(linear=0.3)])))
(spawn driver driving)
""",
        ask="robot.move",
        code="stopped",
        line=3,
        kind="why",
        world="empty",
        do=(("run", 1.0), ("reset",)),
    ),
    Planted(
        name="the state that drives is never entered",
        question="Why does the robot not move?",
        program="""\
(machine driver
  (event start [robot.bumper.data == 1])
  (state waiting)
  (state driving
    (running [robot.move(linear=0.2)]))
  (on start waiting -> driving tdrive))
(spawn driver waiting)
""",
        ask="robot.move",
        code="never",
        line=5,
        kind="why",
        world="empty",
        do=(("run", 2.0),),
    ),
    Planted(
        name="a method that is not called",
        question="It is in driving. Why does it not move?",
        program="""\
(machine driver
  (state driving
    (running [robot.move])))
(spawn driver driving)
""",
        ask="robot.move",
        code="never",
        line=3,
        kind="why",
        world="empty",
        do=(("run", 1.0),),
    ),
    Planted(
        name="the block raises before the command",
        question="It is in driving. Why does it not move?",
        program="""\
(machine driver
  (state driving
    (running [robot.move(linear=spede)])))
(spawn driver driving)
""",
        ask="robot.move",
        code="never",
        line=3,
        kind="why",
        world="empty",
        do=(("run", 1.0),),
    ),
)
