"""Blocks that do not return: they are named, interrupted for whoever waits, and become issues."""

import signal
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor

import pytest
from support.waiting import until

from lrp_jupyter.errors import LRPError, SessionTimeoutError
from lrp_jupyter.language.parser import parse
from lrp_jupyter.live.running import monitor
from lrp_jupyter.live.running.commands import ReplaceProgram, Reset, SetVariable
from lrp_jupyter.live.running.frame import Hung
from lrp_jupyter.live.running.interruption import RunningBlock, interrupt
from lrp_jupyter.live.session import Session

LONG = 120.0  # seconds; reached only when something is wrong, however busy the machine is
RUNNING = "(machine m (state a (running [{}]))) (spawn m a)"
GOOD = "(var n := [0]) (machine m (state a (running [n += 1]))) (spawn m a)"
COUNTING = "\n(machine other (var n := [0]) (state x (running [n += 1]))) (spawn other x)"
ENDLESS = "entered.set(), [0 for _ in iter(int, 1)]"

BLOCKS = {
    "loop": "while True: pass",
    "caught": "\nwhile True:\n  try: pass\n  except BaseException: pass",
    "caught while it sleeps": "\nimport time\nwhile True:\n  try: time.sleep(0.01)\n  except: pass",
    "caught twice": "\nimport time\nwhile True:\n  try:\n"
    "    try: time.sleep(0.01)\n    except: pass\n  except: pass",
    "kept": "\nimport time\nlast = []\nwhile True:\n  try: time.sleep(0.01)\n"
    "  except BaseException as error: last.append(error)",
    "suppressed": "\nimport time, contextlib\nwhile True:\n"
    "  with contextlib.suppress(BaseException): time.sleep(0.01)",
    "finally": "\ntry:\n  while True: pass\nfinally:\n  while True: pass",
    "returning from finally": "\nimport time\ndef f():\n"
    "  try: time.sleep(0.01)\n  finally: return\nwhile True: f()",
    "function": "\ndef wait():\n  while True: pass\nwait()",
    "generator": "\ndef forever():\n  while True:\n"
    "    try: yield 1\n    except BaseException: pass\nsum(forever())",
    "recursion": "\ndef f(n):\n  while True:\n    if n: f(n - 1)\nf(50)",
    "output": "while True: print('again')",
    "robot": "while not robot.bumper.data: robot.move(linear=0.1)",
}

PLACES = {
    "onentry": "(machine m (state a (onentry [{}]))) (spawn m a)",
    "onexit": "(machine m (state a (onexit [{}])) (state b) (eps a -> b)) (spawn m a)",
    "event": "(event e [{}]) (machine m (state a) (state b) (on e a -> b)) (spawn m a)",
    "condition": "(machine m (state a) (state b) (on [{}] a -> b)) (spawn m a)",
    "delay": "(machine m (state a) (state b) (ontime [{}] a -> b)) (spawn m a)",
    "variable": "(var v := [{}]) (machine m (state a)) (spawn m a)",
    "nested variable": "(machine m (state a (onentry (spawn n b))"
    " (machine n (var v := [{}]) (state b)))) (spawn m a)",
    "function of a variable": "(var f := [\n def wait():\n  {}\n wait])"
    " (machine m (state a (running [f()]))) (spawn m a)",
}


@pytest.fixture(autouse=True)
def impatient(monkeypatch):
    monkeypatch.setattr(monitor, "AGAIN", 0.05)


class Wall:
    """The wall time of a monitor: it stands still until a test moves it."""

    def __init__(self):
        self.now, self.looks = 0.0, 0

    def __call__(self):
        self.looks += 1
        return self.now

    def pass_unnoticed(self, seconds):
        """Advance, and wait until the monitor has looked again and again."""
        self.now += seconds
        looks = self.looks
        until(lambda: self.looks > looks + 4)


@pytest.fixture
def wall(monkeypatch):
    made = Wall()
    monkeypatch.setattr(monitor, "monotonic", made)
    monkeypatch.setattr(monitor, "_INTERVAL", 0.01)
    return made


@pytest.fixture
def hanging(session):
    """Start a program, and wait until it hangs."""

    def start(text, bridge="none", **options):
        made = session(text, bridge, **{"hung_after": 0.05, "rate": 100, **options})
        made.start()
        made.wait_for(lambda frame: frame.status == "hung", LONG)
        return made

    return start


def runs_on(session):
    session.wait_for(lambda frame: frame.status == "running", LONG)
    before = session.frame.tick
    return session.wait_for(lambda frame: frame.tick > before + 3, LONG)


@pytest.mark.parametrize("block", BLOCKS.values(), ids=BLOCKS)
def test_an_edit_interrupts_a_block_that_does_not_return(hanging, block):
    session = hanging(RUNNING.format(block), "sim")
    codes = [finding.code for finding in session.edit(GOOD)]
    assert "LRP690" not in codes
    frame = runs_on(session)
    assert frame.numbers[("n",)] > 0
    (issue,) = frame.issues
    assert (issue.code, issue.resolved) == ("LRP611", True)
    assert "`ontime`" in issue.message


def test_an_edit_interrupts_a_block_that_is_at_the_limit_of_recursion(hanging):
    session = hanging(RUNNING.format("\ndef f():\n  try: f()\n  except RecursionError: f()\nf()"))
    limit = sys.getrecursionlimit()
    session.edit(GOOD)
    assert runs_on(session).issues[0].code == "LRP611"
    assert sys.getrecursionlimit() == limit


class SlowlyFinalized:
    def __del__(self):
        for _ in range(200_000):
            pass


def test_an_interruption_that_meets_a_finalizer_is_not_reported_and_returns(hanging, monkeypatch):
    reported = []
    monkeypatch.setattr(sys, "unraisablehook", lambda unraisable: reported.append(unraisable.exc_type))
    session = hanging(RUNNING.format("while True: Slow()"), namespace={"Slow": SlowlyFinalized})
    session.edit(GOOD)
    assert runs_on(session).issues[0].code == "LRP611"
    assert reported == []


def test_other_errors_of_finalizers_are_still_reported(hanging, monkeypatch):
    reported = []
    monkeypatch.setattr(sys, "unraisablehook", lambda unraisable: reported.append(unraisable.exc_type))
    session = hanging(RUNNING.format("while True: pass"))
    session.edit(
        "(var n := [\n class A:\n  def __del__(self): 1/0\n A() and 0])" + GOOD[len("(var n := [0])") :]
    )
    runs_on(session)
    assert reported == [ZeroDivisionError]


FINALIZED_AT_THE_LIMIT = """
import gc
from lrp_jupyter import Session

class Cycle:
    def __init__(self):
        self.me = self

    def __del__(self):
        def deep(n):
            if n:
                deep(n - 1)
        try:
            deep(10)
        except RecursionError:
            pass

block = "def f():\\n  Cycle()\\n  try: f()\\n  except RecursionError: f()\\nf()"
program = f"(machine m (state a (running [{block}]))) (spawn m a)"
gc.set_threshold(20, 2, 2)
with Session(program, hung_after=0.2, namespace={"Cycle": Cycle}) as session:
    session.start()
    for number in range(4):
        session.wait_for(lambda frame: frame.status == "hung", 100)
        session.edit(f"{program}; {number}")
    print(session.issues[0].code)
"""


@pytest.mark.slow
def test_objects_that_python_finalizes_at_the_limit_of_recursion_do_not_end_the_process():
    """Python 3.11 aborts where an error is raised more than 50 frames beyond the limit."""
    python = subprocess.run([sys.executable, "-c", FINALIZED_AT_THE_LIMIT], capture_output=True, timeout=LONG)
    assert (python.returncode, python.stdout.split()) == (0, [b"LRP611"])


@pytest.mark.parametrize("place", PLACES.values(), ids=PLACES)
def test_an_edit_gets_through_wherever_the_block_is(hanging, place):
    session = hanging(place.format("while True: pass"))
    session.edit(GOOD)
    assert runs_on(session).numbers[("n",)] > 0


@pytest.mark.slow
def test_a_hang_names_its_line_and_the_remedy_and_is_an_issue_there(hanging):
    session = hanging(RUNNING.format("\n n = 1\n while True:\n  n += 1"))
    frame = session.frame
    assert frame.hung.where == "a.running"
    assert frame.hung.line in (3, 4)
    assert "`a.running` has run for" in frame.reason
    assert "`ontime`" in frame.reason
    assert session.interrupt()
    (issue,) = session.wait_for(lambda frame: frame.issues, LONG).issues
    assert (issue.code, issue.element.path, issue.line in (3, 4)) == ("LRP611", ("m", "a"), True)
    session.wait_for(lambda frame: frame.status == "hung", LONG)
    assert session.interrupt()
    session.wait_for(lambda frame: frame.issues[0].count == 2, LONG)


@pytest.mark.slow
@pytest.mark.parametrize("act", ["pause", "reset", "stop", "close"])
def test_a_person_gets_through_to_a_program_that_hangs(hanging, act):
    session = hanging(RUNNING.format(BLOCKS["caught while it sleeps"]))
    before = session.frame.restarts
    getattr(session, act)()
    frame = session.frame
    if act == "reset":
        assert frame.restarts == before + 1
    else:
        expected = {"stop": "stopped", "close": "closed"}.get(act, "paused")
        assert frame.status == expected
    assert act in ("pause", "reset") or not session._driver.running


def test_stopping_the_robot_pauses_a_program_that_hangs(hanging):
    session = hanging(RUNNING.format("while True: pass"))
    session.stop_robot()
    frame = session.wait_for(lambda frame: frame.status == "paused", LONG)
    assert frame.reason == "The robot was stopped."


def test_several_blocks_of_one_tick_that_hang_do_not_hold_up_an_edit(hanging):
    session = hanging(
        "(machine m (state a (running [while True: pass] [while True: pass]))) (spawn m a)" + COUNTING
    )
    session.edit(GOOD)
    assert runs_on(session).numbers[("n",)] > 0


def test_an_edit_whose_variable_hangs_is_interrupted_by_the_next(session):
    entered = threading.Event()
    made = session(GOOD, hung_after=0.05, namespace={"entered": entered})
    made.start()
    made.wait_for("a", LONG)
    made.submit(ReplaceProgram(parse(f"(var more := [{ENDLESS}])" + GOOD, "<lrp lrp>")))
    assert entered.wait(LONG)
    made.edit(GOOD)
    assert runs_on(made).issues[0].code == "LRP611"


def test_an_expression_that_does_not_return_is_interrupted_and_refused(session):
    entered = threading.Event()
    made = session(GOOD, hung_after=0.05, namespace={"entered": entered})
    made.start()
    made.wait_for("a", LONG)
    answer = made.ask(SetVariable(("n",), ENDLESS))
    assert entered.wait(LONG)
    made.pause()
    with pytest.raises(LRPError, match=r"^The block did not return"):
        answer.result(LONG)


@pytest.mark.parametrize(
    ("where", "sentence"),
    [
        ("the robot", "The robot has not answered for 3 s."),
        ("a command", "A command has not returned for 3 s."),
        ("x.__repr__", "`x.__repr__` has run for 3 s."),
    ],
)
def test_what_has_no_name_is_a_word_and_not_code(where, sentence):
    assert str(Hung(where, 3)) == sentence


def test_a_block_that_has_returned_meanwhile_is_not_interrupted():
    def block():
        return sys._getframe()

    over = RunningBlock("a.running", 1, block())
    assert not interrupt(threading.get_ident(), over)
    block()  # a call, at which it would be raised


def test_a_block_that_is_only_slow_is_not_interrupted(session, wall):
    names = {"entered": threading.Event(), "gate": threading.Event()}
    made = session(RUNNING.format("entered.set(); gate.wait()"), namespace=names, hung_after=60)
    made.start()
    assert names["entered"].wait(LONG)
    answer = made.submit(ReplaceProgram(parse(GOOD)))
    wall.pass_unnoticed(50)
    names["gate"].set()
    answer.result(LONG)
    assert runs_on(made).issues == ()


def test_a_block_that_returns_soon_after_an_edit_is_not_interrupted(session, wall):
    names = {"entered": threading.Event(), "gate": threading.Event()}
    made = session(RUNNING.format("entered.set()\nwhile not gate.is_set(): pass"), namespace=names)
    made.start()
    assert names["entered"].wait(LONG)
    wall.pass_unnoticed(0)  # the monitor has seen that it runs
    wall.pass_unnoticed(100)
    assert made.status == "hung"
    answer = made.submit(ReplaceProgram(parse(GOOD)))
    wall.pass_unnoticed(0)
    wall.pass_unnoticed(0.9 * monitor.PATIENCE)
    names["gate"].set()
    answer.result(LONG)
    assert runs_on(made).issues == ()


@pytest.mark.slow
def test_the_ticks_after_a_block_that_hung_do_not_count_as_hung(hanging):
    session, seen = hanging(RUNNING.format("while True: pass"), "sim", hung_after=1.0), []
    begin_tick = session.bridge.begin_tick

    def begin(*when):
        seen.append(session.status)
        begin_tick(*when)

    session.bridge.begin_tick = begin
    session.edit(GOOD)
    runs_on(session)
    assert set(seen) == {"running"}


def test_a_call_that_cannot_be_interrupted_is_named_as_such(hanging):
    gate = threading.Event()
    session = hanging(RUNNING.format("gate.wait(60)"), namespace={"gate": gate})
    answer = session.ask(Reset())
    frame = session.wait_for(lambda frame: frame.hung and frame.hung.held, LONG)
    assert "cannot end the call" in frame.reason
    assert not answer.done()
    gate.set()
    answer.result(LONG)
    assert runs_on(session).issues[0].code == "LRP611"


@pytest.mark.parametrize("kind", ["loop", "caught", "kept", "robot"])
def test_a_run_in_virtual_time_ends_with_a_sentence_when_a_block_does_not_return(session, kind):
    made = session(RUNNING.format(BLOCKS[kind]), "sim")
    with pytest.raises(SessionTimeoutError, match=r"`a\.running` \(line \d+\) did not return within 0\.05 s"):
        made.run(5, limit=0.05)
    assert made.status == "paused"
    assert [issue.code for issue in made.issues] == ["LRP611"]
    made.edit(GOOD)
    assert made.run(1)


@pytest.mark.skipif(not hasattr(signal, "pthread_kill"), reason="there are no signals to threads")
@pytest.mark.parametrize(
    "ctrl_c", [signal.default_int_handler, signal.SIG_IGN], ids=["terminal", "background"]
)
@pytest.mark.parametrize("call", ["time.sleep(1000)", "threading.Event().wait()"])
def test_a_run_on_the_main_thread_ends_though_a_block_sleeps(session, call, ctrl_c):
    made = session(RUNNING.format(f"import time, threading; {call}"))
    before = signal.signal(signal.SIGINT, ctrl_c)
    try:
        with pytest.raises(SessionTimeoutError, match=r"did not return within 0\.05 s"):
            made.run(5, limit=0.05)
    finally:
        signal.signal(signal.SIGINT, before)
    made.edit(GOOD)
    assert made.run(1)


PROFILED_AFTERWARDS = """\
import sys
from lrp_jupyter import Session
from lrp_jupyter.errors import SessionTimeoutError
program = "(machine m (state a (running [import time; time.sleep(1000)]))) (spawn m a)"
with Session(program) as session:
    try:
        session.run(5, limit=0.05)
    except SessionTimeoutError:
        sys.setprofile(lambda *_: None)
        print((lambda: "profiled")())
"""


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(signal, "pthread_kill"), reason="there are no signals to threads")
def test_debuggers_and_profilers_go_on_after_a_call_was_ended():
    """Python 3.11 hangs in what is traced while it looks for an exception that was called off."""
    python = subprocess.run([sys.executable, "-c", PROFILED_AFTERWARDS], capture_output=True, timeout=LONG)
    assert python.stdout.split() == [b"profiled"]


def test_runs_in_a_row_share_the_thread_that_watches_them_and_it_ends_with_the_session(session, wall):
    made = session(GOOD)
    before, threads = set(threading.enumerate()), set()
    for _ in range(10):
        made.run(0.1)
        threads |= {each for each in threading.enumerate() if each.name == "lrp monitor"} - before
    made.close()
    assert not any(each.is_alive() for each in threads)
    assert len(threads) == 1


def test_the_thread_that_watches_runs_ends_when_none_follows(session, wall):
    made = session(GOOD)
    before = set(threading.enumerate())
    made.run(0.1)
    (thread,) = set(threading.enumerate()) - before
    wall.pass_unnoticed(0.9)
    assert thread.is_alive()
    wall.now += 0.2
    thread.join(LONG)
    assert not thread.is_alive()
    assert made.run(0.1), "and the next run has its own"


def test_a_run_whose_blocks_are_only_many_is_not_ended(session, wall):
    made = session(RUNNING.format("take(0.15)"), namespace={"take": wall.pass_unnoticed})
    assert made.run(0.5, limit=0.2)


@pytest.mark.parametrize("hung_after", [2.0, 2 * LONG])
def test_a_run_while_a_thread_drives_is_limited_as_well(session, hung_after):
    later = "(machine m (state a) (state b (running [while True: pass])) (ontime 3600000 a -> b)) (spawn m a)"
    made = session(later, hung_after=hung_after)
    made.start()
    with ThreadPoolExecutor(1) as pool, pytest.raises(SessionTimeoutError, match=r"`b\.running`"):
        pool.submit(made.run, 4000, limit=0.05).result(LONG)


@pytest.mark.parametrize(
    ("text", "act", "code"),
    [
        ("(onpause [while True: pass])" + GOOD, lambda session: session.pause(), "LRP611"),
        (
            "(machine m (state a) (state b (onentry [while True: pass])) (on [False] a -> b)) (spawn m a)",
            lambda session: session.transition_to("b"),
            "LRP611",
        ),
        (
            GOOD,
            lambda session: session.edit("(var more := [while True: pass])" + GOOD),
            "LRP611",
        ),
    ],
    ids=["pause", "force", "edit"],
)
def test_a_command_whose_own_block_does_not_return_is_completed(session, text, act, code):
    made = session(text, hung_after=0.05)
    made.start()
    made.wait_for("a", LONG)
    act(made)
    assert [issue.code for issue in made.issues] == [code]
    assert made.status == ("paused" if "onpause" in text else "running")


def test_a_lock_of_this_package_is_not_left_locked_by_an_interruption(session):
    made = session(GOOD, rate=100)
    made.start()
    thread = made._driver._thread

    def waits():
        frame = sys._current_frames()[thread]
        return frame if frame.f_back.f_code is Session._notify.__code__ else None

    with made._changed:
        where = until(waits)
        was_interrupted = interrupt(thread, RunningBlock("the robot", 0, where))
    assert not was_interrupted
    runs_on(made)


@pytest.mark.slow
def test_closing_waits_for_the_thread_that_tells_of_the_end(hanging, monkeypatch):
    """It ends as soon as it is waited for."""
    made, waited, join = hanging(RUNNING.format("while True: pass")), threading.Event(), threading.Thread.join

    def tell():
        if threading.current_thread().name == "lrp notice" and made.frame.status != "hung":
            waited.wait(LONG)

    def joined(thread, timeout=None):
        if thread.name == "lrp notice":
            waited.set()
        join(thread, timeout)

    monkeypatch.setattr(monitor.Monitor, "_check", lambda self: None)  # it sees no end of it before its own
    monkeypatch.setattr(threading.Thread, "join", joined)
    made.listen(tell)
    made.close()
    left = [thread.name for thread in threading.enumerate() if thread.is_alive()]
    waited.set()
    assert "lrp notice" not in left
