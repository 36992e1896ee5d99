"""The answer to a beginner's question about a planted bug has the right reason, line and words.

In ``planted.lrp``, ``;;;`` and a name begin a case, with the question below::

    ;? why not QUESTION @TICK = CODE, line LINE: WORDS
    ;! WORLD | run SECONDS | edit OLD → NEW | …

The answer has the code, mentions the line of the program as it is in the end, and has the words in it.
Without a tick, the question is about the last one. The world is one of the simulator, ``none`` for no robot,
or ``late`` for a `LateRobot`, which is not armed if it is ``late hardware``. `perform` does what comes after
it. Without this line, the program runs for 3 s without a robot.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

import pytest
from support.tables import every

from lrp_jupyter import Session, VirtualClock
from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.message import Message, Twist


class Planted(NamedTuple):
    """One planted bug, and the question about it."""

    name: str
    program: str
    world: str
    acts: list[str]
    kind: str
    ask: str
    at: int | None
    code: str
    line: int
    says: str


def read(case: str) -> Planted:
    head, acts, program = re.fullmatch(r"(.*?\n;\? .*?\n)(?:;! (.*?)\n)?([^;].*|; .*)", case, re.S).groups()
    name, _, question = head.splitlines()
    kind, ask, at, code, line, says = re.fullmatch(
        r";\? (why not|why) (.+?)(?: @(\d+))? = ([\w-]+), line (\d+)(?:: (.*))?", question
    ).groups()
    world, *do = (acts or "none | run 3").split(" | ")
    at = None if at is None else int(at)
    return Planted(name, program.rstrip() + "\n", world, do, kind, ask, at, code, int(line), says or "")


CASES = Path(__file__).with_name("planted.lrp").read_text(encoding="utf-8").split("\n;;; ")[1:]


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


def opened(planted: Planted) -> Session:
    """Return a session of the program in its world, in virtual time; nothing has run yet."""
    if planted.world == "none":
        return Session(planted.program, clock=VirtualClock())
    if planted.world.startswith("late"):
        return Session(planted.program, LateRobot(planted.world == "late hardware"), clock=VirtualClock())
    return Session(planted.program, "sim", clock=VirtualClock(), world=planted.world)


def perform(session: Session, act: str) -> None:
    """Do what is done before the question is asked, in virtual time."""
    what, _, how = act.partition(" ")
    match what:
        case "run":
            session.run(float(how))
        case "edit":
            old, new = how.replace("⏎", "\n").split(" → ")
            assert old in session.text, f"there is no {old!r} to replace"
            session.edit(session.text.replace(old, new))
        case "set":
            variable, _, expression = how.partition(" ")
            session.set_variable(variable, evaluate=expression)
        case "transition":
            session.transition_to(how)
        case "teleport":
            session.teleport_to(how)
        case "pause":  # as a person does: while it runs, in one more tick
            session.run(0.1, after_tick=session.pause)
        case "reset":
            session.reset()
        case "place":  # it is there from the tick after this one
            session.bridge.place_robot(tuple(map(float, how.split())))
            session.run(0.1)
        case "stop":  # as a person does, in one more tick
            session.run(0.1, after_tick=session.stop_robot)
        case "disarm":
            session.call(session.bridge.disarm)
        case _:
            raise ValueError(act)


@pytest.mark.slow
@every("planted", map(read, CASES))
def test_the_answer_names_the_bug(planted: Planted) -> None:
    with opened(planted) as session:
        for act in planted.acts:
            perform(session, act)
        ask = session.why_not if planted.kind == "why not" else session.why
        answer = ask(planted.ask, at=planted.at)
        assert answer.code == planted.code, str(answer)
        assert planted.line in answer.facts["lines"], str(answer)
        assert planted.says in str(answer), str(answer)
