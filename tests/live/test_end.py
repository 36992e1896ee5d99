"""The end of a run: `onend` runs once, between two stops of the robot, and holds up neither."""

import asyncio
import gc
import sys
import threading
import warnings
from itertools import groupby

import pytest
from support.robots import Bare, Courier
from support.waiting import until

from lrp_jupyter.bridges.tasks import Tasks
from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.recording import read_recording
from lrp_jupyter.live.reproduction import reproduce
from lrp_jupyter.live.running import driver, monitor
from lrp_jupyter.live.running.loop import Loop
from lrp_jupyter.live.session import Session

COUNT = "(var n := [0]) (machine m (state a (running [n += 1]))) (spawn m a)"
SAYING = f'(onpause [print("pause")]) (onend [print("end", n)]) {COUNT}'
DRIVE = "(machine m (state a (running [robot.move(linear=0.2)]))) (spawn m a)"
LONG = 120.0  # s; reached only when something is wrong


@pytest.fixture
def impatient(monkeypatch):
    """What does not return is waited for a moment only."""
    for module in (driver, monitor):
        monkeypatch.setattr(module, "PATIENCE", 0.1)
        monkeypatch.setattr(module, "AGAIN", 0.05)


def robot(**options):
    """A robot that notes its speeds and stops."""

    def members(bridge):
        bridge.add_method("move", bridge.move)
        bridge.add_method("lamp", lambda on: bridge.calls.append(("lamp", on)))

    return Bare(members, notes="stop", **options)


def said(session):
    return str(session.output).splitlines()


@pytest.mark.parametrize(
    ("acts", "expected"),
    [
        ("run stop", ["end 3"]),
        ("run close", ["end 3"]),
        ("run stop stop close", ["end 3"]),
        ("run reset close", ["end 3"]),
        ("run reset run close", ["end 3", "end 3"]),
        ("run stop run close", ["end 3", "end 3"]),
        ("run resume pause run", ["pause"]),
        ("run resume pause close", ["pause", "end 3"]),
        ("run run", []),
        ("open close", []),
        ("run edit", []),
        ("run edit close", []),
        ("run edit run close", ["end 6"]),
    ],
)
def test_a_program_acts_once_at_the_end_of_each_run(session, acts, expected):
    made = session(SAYING)
    does = {
        "run": lambda: made.run(0.3),
        "edit": lambda: made.edit(SAYING.replace("n += 1", "n += 2")),
    }
    for act in acts.split():
        does.get(act, lambda act=act: getattr(made, act)())()
    assert said(made) == expected
    assert not made.issues


def test_it_acts_on_the_thread_that_ran_the_program(session):
    text = """(var me := [0]) (onend [print(where() == me)])
    (machine m (state a (onentry [me = where()]))) (spawn m a)"""
    made = session(text, namespace={"where": threading.get_ident})
    made.start()
    made.wait_for("a", LONG)
    made.stop()
    assert said(made) == ["True"]
    assert made.status == "stopped"


def test_it_acts_where_there_are_no_threads(session):
    async def run():
        made = session(SAYING, driver="asyncio")
        made.start()
        while not made.frame.tick:
            await asyncio.sleep(0)
        made.stop()
        return made

    assert len(said(asyncio.run(run()))) == 1


def test_a_session_stopped_by_one_of_its_own_blocks_acts_after_that_tick(session):
    names = {}
    text = "(onend [print('end')]) (machine m (state a (running [s.stop()] [print('tick')]))) (spawn m a)"
    made = session(text, namespace=names)
    names["s"] = made
    made.start()
    until(lambda: said(made) == ["tick", "end"], "the end")


def test_a_session_that_was_dropped_acts(session):
    bridge = robot()
    made = Session(f"(onend [robot.lamp(False)]) {DRIVE}", bridge)
    made.start()
    made.wait_for("a", LONG)
    with warnings.catch_warnings(category=ResourceWarning, action="ignore"):
        del made
        gc.collect()
        until(lambda: not bridge.is_open, "the end")
    lamp = bridge.calls.index(("lamp", False))
    assert bridge.calls[lamp - 1] == bridge.calls[lamp + 1] == "stop"


def test_a_session_that_broke_down_does_not_act(session):
    made = session(SAYING)
    made.run(0.3)
    made.interpreter.observe(lambda event: 1 / 0)
    made.run(0.3)
    assert made.status == "broken"
    made.close()
    assert said(made) == []


# -- the robot


@pytest.mark.parametrize("act", [Session.stop, Session.close, Session.reset])
@pytest.mark.parametrize("threaded", [True, False])
def test_the_robot_stands_before_it_and_is_stopped_after_it(session, act, threaded):
    bridge = robot()
    made = session(f"(onend [robot.lamp(True)] [robot.move(linear=0.5)]) {DRIVE}", bridge)
    if threaded:
        made.start()
        made.wait_for("a", LONG)
        made.pause()
    else:
        made.run(0.3)
        made.resume()
    del bridge.calls[:]
    act(made)
    calls = [call for call, _ in groupby(bridge.calls) if call != 0.2]
    assert calls == ["stop", ("lamp", True), 0.5, "stop"]
    assert not bridge.safety.motion


class Teller(Courier):
    """A robot whose calls take as long as the end of the run waits for them."""

    def call(self, task, what):
        def is_waited_for():
            frame = sys._current_frames().get(threading.main_thread().ident)
            while frame is not None and frame.f_code is not Tasks.finish_calls.__code__:
                frame = frame.f_back
            return (frame is not None and "go 1" in self.log) or self.is_closed

        until(is_waited_for, "the end")
        self.log.append(f"call {what}")

    def close_interface(self):
        self.log.append("close")


def test_what_is_asked_for_there_ends_with_it_but_a_call_reaches_the_robot_before_it_is_closed(session):
    bot = Teller()
    made = session(f"(onend [robot.go(1)] [robot.call('dark')]) {COUNT}", bot)
    made.run(0.3)
    made.close()
    assert [each for each, _ in groupby(bot.log) if each != "go 1"] == [
        "stop", "call dark", "cancel go 1", "stop", "close",
    ]  # fmt: skip


def test_a_robot_that_is_disarmed_gets_nothing(session):
    bridge = robot(hardware=True)
    made = session(f"(onend [robot.lamp(True)]) {DRIVE}", bridge)
    with pytest.warns(UserWarning, match="disarmed"):
        made.run(0.3)
    made.stop()
    assert bridge.safety.commands[-1].name == "lamp"
    assert ("lamp", True) not in bridge.calls


@pytest.mark.parametrize("threaded", [True, False])
@pytest.mark.parametrize(
    ("block", "code"), [("1 / 0", "LRP601"), ("while True: pass", "LRP611")], ids=["raises", "hangs"]
)
def test_what_goes_wrong_there_is_an_issue_and_keeps_neither_the_stop_nor_the_rest(
    session, impatient, block, code, threaded
):
    bridge = robot()
    made = session(f"(onend [robot.move(linear=0.5)] [{block}] [robot.lamp(False)]) {DRIVE}", bridge)
    if threaded:
        made.start()
        made.wait_for("a", LONG)
    else:
        made.run(0.3)
    made.stop()
    assert [issue.code for issue in made.issues] == [code]
    assert bridge.safety.commands[-1].name == "lamp"  # held back if the monitor stopped the robot before
    assert bridge.calls[-1] == "stop"
    assert made.status == "stopped"
    assert not any(notice.kind == "fault" for notice in bridge.safety.notices)


def test_a_call_that_cannot_be_interrupted_there_is_left_behind(session, impatient):
    bridge, gate = robot(), threading.Event()
    text = f"(onend [robot.move(linear=0.5)] [gate.wait()] [robot.move(linear=0.5)]) {DRIVE}"
    made = session(text, bridge, namespace={"gate": gate})
    made.start()
    made.wait_for("a", LONG)
    made.stop()
    assert bridge.calls[-1] == "stop"
    (notice,) = bridge.safety.notices
    assert notice.text == (
        "`onend` (line 1) did not return at the end of the run, and could not be interrupted."
    )
    gate.set()
    until(lambda: not any(thread.name == "lrp lrp" for thread in threading.enumerate()), "its thread")
    assert bridge.calls[-1] == "stop"  # what it commands later is not sent
    made.close()


def test_a_block_that_hangs_when_the_run_ends_does_not_take_its_time(session, impatient, monkeypatch):
    made = session("(onend [print('end')]) (machine m (state a (running [while True: pass]))) (spawn m a)")
    made.start()
    until(lambda: made._loop.ticking, "the block")
    made.stop()
    assert [issue.element.kind for issue in made.issues] == ["running"]
    assert said(made) == ["end"]


# -- recordings and copies


@pytest.fixture
def path(tmp_path):
    return tmp_path / "run.lrplog"


def lamps(session):
    return [
        (each.name, each.arguments["on"]) for each in session.bridge.safety.commands if each.name == "lamp"
    ]


@pytest.mark.parametrize("bridge", ["sim", robot])
def test_the_end_of_a_run_is_recorded_and_reproduced_once(path, bridge):
    text = f"(onend [print('end', n)] [robot.lamp(True)]) {COUNT}"
    made = Session(text, bridge if bridge == "sim" else bridge(), clock=VirtualClock())
    made.record_until_closed(path)
    made.run(0.5)
    made.reset()
    made.run(0.3)
    made.stop()
    made.close()
    again = reproduce(read_recording(path))
    with again.session as copy:
        assert again.difference is None
        assert said(copy) == said(made) == ["end 5", "end 3"]
        assert lamps(copy) == lamps(made)
    assert said(copy) == said(made)


def test_a_recording_of_a_run_that_did_not_end_does_not_end_in_a_replay(path):
    with Session(SAYING, clock=VirtualClock()) as made:
        with made.record(path):
            made.run(0.5)
        again = reproduce(read_recording(path))
        again.session.close()
        assert said(again.session) == said(made) == []


def test_a_fork_ends_as_the_run_did_and_not_when_it_is_closed(session, monkeypatch):
    made, ended = session(SAYING), []
    monkeypatch.setattr(
        Loop, "end_program", lambda loop, run=Loop.end_program: (ended.append(loop), run(loop))
    )
    made.run(0.5)
    made.reset()
    made.run(0.5)
    del ended[:]
    with made.fork(3) as copy:
        copy.run(2)
    assert said(copy) == []
    made.try_values("n", [1, 2], 1)
    made.what_if(3, SAYING.replace("n += 1", "n += 3"), 0.1)
    assert not ended
    with made.fork(3, inputs=True) as copy:
        copy.run(0.5)
    assert len(ended) == 1


def test_what_it_commanded_is_explained(session):
    made = session(f"(onend [robot.lamp(True)]) {DRIVE}", "sim")
    made.run(1)
    made.stop()
    assert "`onend`" in str(made.why("robot.lamp"))
    assert str(made.why("robot.move")).endswith("Then the run ended, which stops the robot.")
