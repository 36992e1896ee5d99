"""A wrong argument of a public function is refused at once, in a sentence that names it."""

from __future__ import annotations

import re

import pytest
from support.tables import every

import lrp_jupyter
from lrp_jupyter import BridgeError, Lab, Session, SimBridge, VirtualClock, parse
from lrp_jupyter.grading.batch import HowRun, grade_all
from lrp_jupyter.grading.challenge import Challenge
from lrp_jupyter.grading.challenges import challenge
from lrp_jupyter.grading.grade import grade
from lrp_jupyter.grading.sweep import sweep
from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.language.diff import diff
from lrp_jupyter.language.printer import to_source
from lrp_jupyter.live.clock import MonotonicClock

TEXT = "(var n := [0]) (machine m (state a) (state b) (ontime 500 a -> b)) (spawn m a)"
PROGRAM = parse(TEXT)
SECONDS = "a number of seconds"
LAMP = challenge("lamp")

OF_FUNCTIONS = [
    (lambda: lrp_jupyter.parse(b"(machine m)"), "`text` must be the text of a program, not bytes"),
    (lambda: lrp_jupyter.check(3), "`text_or_program` must be a text or a Program, not int"),
    (lambda: to_source(TEXT), "`program` must be a Program"),
    (lambda: diff(TEXT, PROGRAM), "`old` must be a Program"),
    (lambda: diff(PROGRAM, TEXT), "`new` must be a Program"),
    (lambda: lrp_jupyter.state_graph(TEXT), "`program` must be a Program"),
    (lambda: Interpreter(TEXT), "`program` must be a Program"),
    (lambda: Interpreter(PROGRAM, namespace=[]), "`namespace` must be a dict, not list"),
    (lambda: Interpreter(PROGRAM, journal=2.5), "`journal` must be a number of ticks, not float"),
    (lambda: Interpreter(PROGRAM, journal=-1), "`journal` must be a number of ticks, 0 or more, not -1"),
    (lambda: Session(3), "`program` must be a text or a Program, not int"),
    (lambda: Session(TEXT, name=3), "`name` must be a text, not int"),
    (lambda: Session(TEXT, namespace=[]), "`namespace` must be a dict, not list"),
    (lambda: Session(TEXT, clock=3), "`clock` must be a clock"),
    (lambda: Session(TEXT, rate="10"), "`rate` must be a number of ticks per second, not str"),
    (lambda: Session(TEXT, hung_after=0), f"`hung_after` must be {SECONDS} above 0, not 0"),
    (lambda: Session(TEXT, dead_man=0), f"`dead_man` must be {SECONDS} above 0, not 0"),
    (lambda: SimBridge(seed="1"), "`seed` must be a whole number, not str"),
    (lambda: SimBridge(noise=4), "`noise` must be a mapping"),
    (lambda: SimBridge(noise={"light": -1}), "must be a standard deviation, 0 or more, not -1"),
    (lambda: MonotonicClock("2"), "`speed` must be a number, not str"),
    (lambda: MonotonicClock(0), "The speed must be above 0, not 0"),
    (lambda: VirtualClock("2"), "`start` must be a time in seconds, not str"),
    (lambda: Lab(3), "`program` must be a text, a Program or a Session, not int"),
    (lambda: Lab(TEXT, challenge=3), "`challenge` must be a Challenge or its name, not int"),
    (lambda: grade(TEXT, 3), "`what` must be the name of a challenge"),
    (lambda: grade(TEXT, "lamp", limit=0), f"`limit` must be {SECONDS} above 0, not 0"),
    (lambda: grade(TEXT, "lamp", memory=0), "`memory` must be a number of megabytes above 0, not 0"),
    (
        lambda: grade(TEXT, "lamp", 2.5),
        "must be a number of runs, or the seeds themselves, not float",
    ),
    (lambda: grade(TEXT, "lamp", 0), "`seeds` must be a number of runs, 1 or more, not 0"),
    (lambda: grade(TEXT, LAMP.worlds[0], seconds=0), f"`seconds` must be {SECONDS} above 0, not 0"),
    (lambda: all_graded(HowRun(limit=0)), f"`limit` must be {SECONDS} above 0, not 0"),
    (lambda: all_graded(HowRun(memory=-1)), "`memory` must be a number of megabytes above 0, not -1"),
    (lambda: all_graded(HowRun(processes=0)), "`processes` must be a number of processes, 1 or more, not 0"),
    (lambda: sweep(TEXT, 3, {}), "`what` must be the name of a challenge or a Challenge, not int"),
    (lambda: made(name=3), "`name` must be a text, not int"),
    (lambda: made(seconds=0), f"`seconds` must be {SECONDS} above 0, not 0"),
    (lambda: made(needed=0), "`needed` must be a share from 0 to 1 above 0, not 0"),
    (lambda: made(criteria=(3,)), "`criteria` must be made by functions such as `visits`, not int"),
]
OF_SESSIONS = [
    (lambda session: session.pause(3), "`reason` must be a sentence, not int"),
    (lambda session: session.run(-1), "`seconds` must be a number, 0 or more, not -1"),
    (lambda session: session.run(1, limit=0), f"`limit` must be {SECONDS} above 0, not 0"),
    (lambda session: session.wait_for("a", -1), f"`timeout` must be {SECONDS}, 0 or more, not -1"),
    (lambda session: session.offer(3), "`text` must be the text of a program, not int"),
    (lambda session: session.check(3), "`program` must be a text or a Program, not int"),
    (lambda session: session.fork(program=3), "`program` must be a text or a Program, not int"),
    (lambda session: session.what_if(seconds=0), f"`seconds` must be {SECONDS} above 0, not 0"),
    (lambda session: session.try_values("n", [1], -1), f"`seconds` must be {SECONDS}, 0 or more, not -1"),
    (lambda session: session.plots([3]), "`names` must be a list of texts, not int"),
    (lambda session: session.set_breakpoint(1, after=2.5), "`after` must be a number of hits, not float"),
    (lambda session: session.set_breakpoint(1, after=0), "must be a number of hits, 1 or more, not 0"),
    (lambda session: session.rename(3, "m/a", "c"), "`kind` must be the kind of an element"),
    (lambda session: session.rename("state", "m/a", 3), "`new_name` must be a name, not int"),
    (lambda session: session.set_variable("n", evaluate=3), "`evaluate` must be a text"),
    (lambda session: session.rewind(2.5), "`ticks` must be a number of ticks, not float"),
    (lambda session: session.rewind(-1), "`ticks` must be a number of ticks, 0 or more, not -1"),
    (lambda session: session.pause_when("m/a", after=2.5), "`after` must be a number of hits, not float"),
    (
        lambda session: session.pause_when("m/a", after=0),
        "must be a number of hits, 1 or more, not 0",
    ),
    (lambda session: session.pause_when(condition=3), "`condition` must be a text, a Python expression"),
    (lambda session: session.timeline(3), "`since` must be the `cursor` of a timeline, not int"),
    (lambda session: session.timeline(plots=["n"]), "`plots` must be a mapping of names to ticks, not list"),
    (lambda session: session.at("now"), "must be the number of a tick, or a time in seconds, not str"),
    (lambda session: session.at(-0.5), "must be a time in seconds, 0 or more, not -0.5"),
]


def made(name="mine", criteria=LAMP.criteria, **fields):
    return Challenge(name, "Do it.", ("line",), criteria, **fields)


def all_graded(how):
    grade_all([TEXT], LAMP, None, how)


def refuses(call, sentence):
    with pytest.raises((TypeError, ValueError, BridgeError), match=re.escape(sentence)):
        call()


@every(("call", "sentence"), OF_FUNCTIONS)
def test_functions_and_classes_refuse_it(call, sentence):
    refuses(call, sentence)


@every(("call", "sentence"), OF_SESSIONS)
def test_sessions_refuse_it_and_go_on(call, sentence):
    with Session(TEXT, clock=VirtualClock()) as session:
        session.run(1)
        refuses(lambda: call(session), sentence)
        assert (session.frame.tick, session.frame.reason, session.text) == (10, "", TEXT)
