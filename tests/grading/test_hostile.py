"""A program that attacks what grades it costs itself its marks, and nobody else theirs."""

import csv
import io
import json
import os
import signal
import struct
import sys
from contextlib import suppress
from pathlib import Path
from subprocess import PIPE, Popen

import pytest
from support.tables import every
from support.waiting import until

from lrp_jupyter.errors import LRPError
from lrp_jupyter.grading import notes, similarity, workers
from lrp_jupyter.grading.attempt import Attempt, Job
from lrp_jupyter.grading.batch import grade_all
from lrp_jupyter.grading.challenges import challenge
from lrp_jupyter.grading.criteria.criterion import Verdict
from lrp_jupyter.grading.grade import grade
from lrp_jupyter.grading.marks import grade_class
from lrp_jupyter.grading.notes import LONGEST, notes_about
from lrp_jupyter.grading.submissions import Submission
from lrp_jupyter.grading.workers import HowRun
from lrp_jupyter.programs import load, names

pytestmark = pytest.mark.slow  # programs that hang are ended after seconds

DRIVE = "(machine m (state driving (running [robot.move(linear=0.2)]))) (spawn m driving)"
FIRST = challenge("first move")
FORGED = {"world": "empty", "seed": 0, "seconds": 1.0, "verdicts": [], "hints": [], "share": 1.0, "ended": ""}
needs_fork = pytest.mark.skipif(not hasattr(os, "fork"), reason="the run is the worker")


def doing(code):
    """Return a program that runs some lines of Python."""
    return DRIVE.replace("robot.move(linear=0.2)", f"exec(bytes.fromhex('{code.encode().hex()}').decode())")


def writing(data):
    """Return a program that writes into everything that its process has inherited, and ends it."""
    return doing(
        "import os\n"
        "for number in range(3, 64):\n"
        f"    try: os.write(number, {data!r})\n"
        "    except OSError: pass\n"
        "os._exit(0)"
    )


def framed(text):
    return struct.pack(">Q", len(text)) + text.encode()


NOTED = {
    "from lrp_jupyter.sim import world": "imports `lrp_jupyter.sim`, which judges the program",
    "import gc": "imports `gc`",
    "import numpy.random as r": "imports `numpy.random`",
    "from time import monotonic": "imports `time`, whose clock is that of the run when it is graded",
    "robot._bridge": "uses `._bridge`",
    "().__class__": "uses `.__class__`",
    "__builtins__": "uses `__builtins__`",
    "f'{robot._prefix}'": "uses `._prefix`",
    "'{0.__doc__}'.format(robot)": "has a text with `__`",
    "e = exec": "runs a text as Python with `exec`",
    "getattr(robot, 'move')": "looks up a name with `getattr`",
    "list(map(open, ['x']))": "opens a file with `open`",
    "import math; math.pi = 3": "changes `math.pi`",
    "robot.move.x = 3": "changes `robot.move.x`",
    "type(robot).move = 3": "changes `type(robot).move`",
    "import operator; operator.attrgetter('move')(robot)": "looks up a name with `attrgetter`",
    "from operator import methodcaller": "looks up a name with `methodcaller`",
    "import string; string.Formatter().get_field('0', [robot], {})": "looks up a name with `get_field`",
    "import typing; typing.get_type_hints(robot)": "looks up a name with `get_type_hints`",
    "import enum; enum.sys": "reaches another module with `.sys`",
    "from dataclasses import inspect": "reaches another module with `.inspect`",
    "g = (g for _ in [1]); g.gi_frame": "looks into frames with `.gi_frame`",
    "f.f_back": "looks into frames with `.f_back`",
    "\nmatch robot:\n    case object(_bridge=b): pass": "uses `._bridge`",
}


def test_a_program_that_reaches_beyond_its_robot_is_noted_with_its_line():
    text = "(machine m\n (state a)\n (state b (running [0]))) (spawn m a)"
    noted = {block: notes_about([text.replace("0", block)]) for block in NOTED}
    assert noted == {
        block: (f"Line {5 if 'match' in block else 3} {note}.",) for block, note in NOTED.items()
    }


CARRIED = [
    "robot._bridge.place_robot((2.0, 1.0, 0.0))",
    "import gc; [a.place_robot((2.0, 1.0, 0.0)) for a in gc.get_objects() if hasattr(a, 'place_robot')]",
    "robot._bridge.simulation.robot.body.position = (2.0, 1.0)",
]
FORGED_RUNS = [
    "from lrp_jupyter.grading.referee import Referee; Referee.share = 1.0",
    "import sys; sys.modules['lrp_jupyter.grading.referee'].Referee.share = 1.0",
    "from lrp_jupyter.bridges.sim import SimBridge; SimBridge.touched = frozenset({'wall'})",
    "import gc; [a.samples.clear() for a in gc.get_objects() if type(a).__name__ == 'RunRecord']",
]


@every("block", [*CARRIED, *FORGED_RUNS])
def test_a_program_that_tampers_with_its_run_is_noted_and_a_robot_that_it_carries_earns_nothing(block):
    result = grade(DRIVE.replace("robot.move(linear=0.2)", f"{block}; robot.move(linear=0.2)"), FIRST, 1)
    assert result.notes
    if block in CARRIED:
        assert (result.passed, result.points) == (False, 0), str(result)


def test_an_ordinary_program_is_not_noted():
    block = "for _ in range(3): import math, random; n = math.pi; msg = robot.drive_to; log.append(open)"
    usual = f"(var open := [0]) (var log := [[]]) (machine m (state a (running [{block}]))) (spawn m a)"
    assert notes_about([usual, "(machine", *map(load, names())]) == ()


def test_a_program_that_would_hold_up_the_class_is_not_looked_through_but_noted(monkeypatch):
    """Its run has a limit of its own; the process that grades the class has none."""
    text = DRIVE + f"; {'x' * LONGEST}"
    for module in (notes, similarity):
        monkeypatch.setattr(module, "scan", lambda text: pytest.fail("it is parsed") if text else (None, ()))
    (note,) = notes_about([text])
    assert note.startswith(f"The program has more than {LONGEST:,} characters")
    assert similarity.alike({"Ada": text, "Bob": text}) == []


def test_what_is_noted_is_in_the_marks_and_costs_nothing():
    text = DRIVE.replace("[", "[import gc; ")
    result = grade(text, FIRST)
    note = "Line 1 imports `gc`."
    assert (result.points, result.notes) == (10, (note,))
    assert str(result).endswith(f"\nNote: {note}")
    marks = grade_class([Submission("Ada", "ada.lrp", text), Submission("Bob", "bob.lrp", None, "?")], FIRST)
    assert [row["notes"] for row in csv.DictReader(io.StringIO(marks.csv()))] == [note, ""]
    assert [each["notes"] for each in marks.to_dict()["submissions"]] == [(note,), ()]


ANSWERS = ["[]", "{}", "5", "null", '{"fault": 3}', "[" * 100_000, '"\\ud800"', json.dumps(FORGED)]


def test_what_is_no_answer_of_a_run_is_an_error_of_that_run_alone():
    data = [*(text.encode() for text in ANSWERS), *map(framed, ANSWERS), b"\xff" * 40, framed("[]")[:9]]
    good, *others = grade_all([DRIVE, *map(writing, data)], FIRST, 1)
    assert good.points == 10
    for other in others:
        (attempt,) = other.attempts
        assert (other.points, attempt.ended) == (0, "crash")
        assert attempt.verdicts[0].reason.startswith("The run ended with")


ENDINGS = {
    "import os; os._exit(3)": "exit code 3. Remove the call",
    "import os; os._exit(0)": "The run ended without an answer. The program must not end",
    "import os; os.abort()": "(SIGABRT). Python alone does not: remove calls of `os`",
    "import os, signal; os.kill(os.getpid(), signal.SIGKILL)": "Remove what ends processes",
    "while True: pass": "A block must end at once: use a state with `ontime`",
    "sum(range(10**13))": "One call in a block did not return",
}


@pytest.mark.slow  # one call is waited for
@needs_fork
def test_why_a_run_has_ended_is_said_with_a_remedy():
    grades = grade_all(
        [DRIVE.replace("robot.move(linear=0.2)", code) for code in ENDINGS], FIRST, 1, HowRun(3)
    )
    reasons = [each.attempts[0].reason for each in grades]
    assert [
        words for words, reason in zip(ENDINGS.values(), reasons, strict=True) if words not in reason
    ] == []


def changed(**values):
    return {**FORGED, "path": [], **values}


@pytest.mark.parametrize(
    "data",
    [
        *([], {}, 5, None, FORGED),
        *(changed(share=value) for value in ("1", None, float("nan"), True, 10**400)),
        *(changed(seconds=value) for value in (float("inf"), [], "1")),
        *(changed(path=value) for value in ([1], [[1]], [[1, "2"]], 5, [[1, 2, 3]])),
        *(changed(verdicts=value) for value in ([1], [{}], ["passed"], {"a": 1})),
        *(changed(ended="no"), changed(ended=[]), changed(hints=[1]), changed(world=1)),
    ],
    ids=repr,
)
def test_what_does_not_describe_an_attempt_is_refused(data):
    with pytest.raises(ValueError, match=r"."):
        Attempt.from_dict(data)


def test_an_attempt_that_is_not_judged_by_the_criteria_is_none_for_its_job():
    job = Job((DRIVE,), FIRST, "empty", 0, 60)
    with pytest.raises(ValueError, match="another challenge"):
        Attempt.from_dict(changed()).of(job)


def test_no_text_of_a_program_commands_a_terminal_or_cannot_be_written():
    verdict = Verdict("a\x1b[2J", False, "half \ud800, \x9b1A" + "x" * 10**6, state="failed")._asdict()
    found = Attempt.from_dict(changed(verdicts=[verdict], hints=["\u202eab\ncd"])).verdicts[0]
    assert found.sentence == "a<U+001B>[2J"
    assert found.reason.startswith("half <U+D800>, <U+009B>1A")
    assert len(found.reason) < 20_000


def ours():
    """Return the processes that workers of this process have started, and the workers."""
    marks = [SLEEP.encode(), *(worker._mark.encode() for worker in workers._idle)]
    found = set()
    for process in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            told = (process / "environ").read_bytes() + (process / "cmdline").read_bytes()
            if any(mark in told for mark in marks):
                found.add(int(process.name))
    return found


SLEEP = f"1000.{os.getpid()}"  # seconds, by which the process is known
STARTS = f"import subprocess; subprocess.Popen(['sleep', '{SLEEP}'], start_new_session=True"

WAIT = "threading.Event().wait(1000)"

LEAVING = [
    f"{STARTS}); os._exit(0)",
    f"{STARTS}, env={{}}); os._exit(0)",
    f"os.fork(); os.fork(); os.getsid(0) == os.getpid() or os.setsid(); {WAIT}",
    f"os.fork() or (os.setsid(), {WAIT}); os.closerange(3, 99); os._exit(0)",
]


@needs_fork
@pytest.mark.parametrize("code", LEAVING, ids=["started", "hidden", "forked", "closed"])
def test_no_process_that_a_program_has_started_stays(code):
    bad, good = grade_all([doing(f"import os, threading; {code}"), DRIVE], FIRST, 1, HowRun(limit=1))
    assert (bad.points, good.points) == (0, 10)
    idle = {worker.process.pid for worker in workers._idle}
    until(lambda: ours() <= idle, lambda: f"{ours()} beside {idle}")


@needs_fork
@pytest.mark.parametrize("number", ["KILL", "STOP", "TERM"])
def test_a_program_that_ends_or_stops_all_workers_takes_no_mark_from_another(number):
    """All workers, that of the other program's run and an idle one too; both runs are made again, alone."""
    workers.close_workers()
    grade_all([DRIVE.replace("0.2", f"0.2{digit}") for digit in "012"], FIRST, 1, HowRun(processes=3))
    siblings = {worker.process.pid for worker in workers._idle}
    attack = doing(
        f"import os, signal\nfor number in {siblings}: os.kill(number, signal.SIG{number})\nwhile True: pass"
    )
    long = DRIVE.replace("[", "[sum(range(1_000_000)); ", 1)
    bad, good = grade_all([attack, long], FIRST, 1, HowRun(limit=3, processes=2))
    assert (bad.points, good.points) == (0, 10)


def test_a_worker_that_cannot_start_is_an_error_and_no_mark(monkeypatch):
    workers.close_workers()
    monkeypatch.setattr(workers, "python_of", lambda _: {"args": [sys.executable, "-c", "1/0"], "env": {}})
    with pytest.raises(LRPError, match=r"does not start: ZeroDivisionError: division by zero\."):
        grade_all([DRIVE], FIRST, 1)


WORKER = """
import os, signal, sys
from lrp_jupyter.grading import worker

def held_up(option, value):  # until its worker is gone
    parent = os.getppid()
    os.kill(parent, signal.SIGKILL)
    while os.getppid() == parent:
        pass
    prctl(option, value)

prctl, worker._prctl = worker._prctl, held_up
worker._answer = lambda *_: os.write(int(sys.argv[1]), b"made")
worker._forked(b"", 1.0, 0, 1)
"""


@needs_fork
def test_a_run_whose_worker_has_ended_before_it_could_ask_to_end_with_it_is_not_made():
    reading, writing = os.pipe()
    with Popen(
        [sys.executable, "-c", WORKER, str(writing)], stdin=PIPE, stdout=PIPE, pass_fds=[writing]
    ) as worker:
        os.close(writing)
        with open(reading, "rb") as made:
            assert made.read() == b""
    assert worker.returncode == -signal.SIGKILL
