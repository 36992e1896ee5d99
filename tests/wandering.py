"""Sessions in which at random everything happens that can come from outside."""

import random
from contextlib import suppress

from lrp_jupyter.errors import LRPError
from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.session import Session

PROGRAM = """(var n := [0])
(var speed := [0.3])
(var seen := [[]])
(var bumps := [0])
(var count := [None])
(event dark [robot.light.data < 150])
(event bump [robot.bumper.data])
(machine m
  (var k := [n])
  (state drive
    (onentry [
      def count():
        nonlocal bumps
        bumps += 1])
    (running [robot.move(linear=speed, angular=0.2)] [n += 1]))
  (state turn
    (onentry [seen.append(robot.odom.x)] (spawn inner left))
    (running [robot.move(angular=1.5)])
    (onexit [robot.stop()])
    (machine inner
      (var own := [len(seen)])
      (state left (onentry [own += 1]))
      (state right (running [1 / (n % 4)]))
      (ontime 300 left -> right flip)
      (on [own > 3] right -> left)
      (exit [n % 11 == 0] right -> back out)))
  (state back (running [robot.move(linear=-0.2)]) (onexit [count()]))
  (on bump *-{back} -> back hit)
  (on dark drive -> turn dim)
  (ontime 900 turn -> drive again)
  (ontime [400 + n % 3] back -> turn away))
(machine watch
  (state idle) (state busy (running [n += gain + len(marks)]))
  (on [n > 40] idle -> busy) (eps busy -> idle))
(onpause [n += 100])
(spawn m drive)
(spawn watch idle)
"""

STATES = ["drive", "turn", "back", "m/turn/inner/right", "watch/busy", "nowhere"]
PLACES = [
    ("n += 1", "n += 2"),
    ("n += 2", "n += 1"),
    ("0.2)]", "0.4)]"),
    ("900", "500"),
    ("500", "900"),
    ("< 150", "< 90"),
    ("(state idle)", "(state idle (running [speed]))"),
    ("[n]", "[n"),
]
REMOVALS = [
    ("(spawn watch idle)", ""),
    ("(eps busy -> idle)", "(ontime 200 busy -> idle)"),
    ("(state back", "(state bac"),
    ("(state bac ", "(state back "),
]


def session(seed: int, bridge: str = "sim", **options) -> Session:
    """A session that can wander about; with a seed of 0 without noise."""
    draw = random.Random(seed)
    if bridge == "sim":
        options["world"] = draw.choice(["boxes", "line", "empty"])
        options["noise"] = {"motor": 0.1, "light": 8, "odom": 0.05} if seed else None
    program = PROGRAM if bridge == "sim" else PROGRAM.replace("robot.light.data", "n % 200")
    return Session(
        program,
        bridge,
        clock=VirtualClock(),
        rate=draw.choice([10, 10, 25, 7]),
        on_active_edit=draw.choice(["restart", "keep"]),
        on_issue=draw.choice(["record", "record", "pause"]),
        namespace={"gain": 1, "marks": [1, 2]},
        **options,
    )


def act(draw: random.Random, wandering: Session, rewinds: bool = True, removals: bool = True) -> str:
    """Do something at random from outside, and return what."""
    choices = ["run", "run", "run", "run", "step", "edit", "force", "set", "assign", "place", "draw"]
    choices += ["world", "rate", "pause", "resume", "reset", "stop", "drive", "rename", "notebook", "list"]
    what = draw.choice([*choices, *(["rewind"] if rewinds else [])])
    text, bridge = wandering.text, wandering.bridge
    simulated = bridge.name == "sim"
    with suppress(LRPError, ValueError, SyntaxError):
        match what:
            case "run":
                wandering.run(draw.uniform(0, 2.5))
            case "step":
                wandering.step()
            case "edit":
                wandering.edit(text.replace(*draw.choice(PLACES + REMOVALS if removals else PLACES), 1))
            case "force":
                draw.choice([wandering.transition_to, wandering.teleport_to])(draw.choice(STATES))
            case "set":
                wandering.set_variable("n", draw.choice(["n + 7", "0", "len(seen)"]))
            case "assign":
                wandering.variables["speed"] = draw.choice([0.1, 0.35])
            case "list":
                wandering.variables["seen"] = [draw.random()]
            case "notebook":
                wandering.namespace |= draw.choice([{"gain": 3}, {"gain": 0.5}, {"marks": [draw.random()]}])
            case "place" if simulated:
                bridge.place_robot((draw.uniform(0.3, 1.2), draw.uniform(0.3, 1.2), draw.uniform(-3, 3)))
            case "draw" if simulated:
                bridge.draw(((draw.random(), draw.random()), (1.0, 1.0)))
            case "world" if simulated:
                bridge.reset_world()
            case "rate":
                wandering.rate = draw.choice([10, 20, 5])
            case "pause":
                wandering.pause()
            case "resume":
                wandering.resume()
            case "reset":
                wandering.reset()
            case "stop":
                wandering.stop_robot()
            case "drive" if simulated:
                wandering.call(lambda: bridge.robot.move(linear=0.2))
            case "rename":
                wandering.rename("state", "m/back", draw.choice(["back", "away"]))
            case "rewind":
                wandering.rewind(draw.choice([0, 1, 5]))
    wandering.call(lambda: None)  # and apply what waits to be done to the world
    return what


def seen(wandering: Session) -> tuple:
    """All that can be known of a session, as text: nothing in it may depend on identity."""
    frame = wandering.frame
    robot = frame.robot
    shown = (robot.time, robot.robots, robot.solids, robot.marks) if robot else ()
    values = {path: text for path, text in frame.variables.items() if "function" not in text}
    return (
        frame.tick,
        frame.time,
        frame.active,
        repr(values),
        dict(frame.visits),
        dict(frame.fired),
        [(str(issue), issue.resolved) for issue in frame.issues],
        frame.restarts,
        shown,
        wandering.program.text,
    )
