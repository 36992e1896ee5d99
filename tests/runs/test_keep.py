"""The present run is kept from its beginning, and is the same when it is run again."""

from itertools import count
from pathlib import Path

import pytest
from runs.conftest import LAPS

from lrp_jupyter.errors import FileError
from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.recording import read_recording
from lrp_jupyter.live.reproduction import reproduce
from lrp_jupyter.live.session import Session
from lrp_jupyter.runs.again import begin_run
from lrp_jupyter.runs.rerun import Rerun

NOISE = {"motor": 0.2, "light": 10, "distance": 0.02}


def by_hand(session):
    session.set_variable("pace", evaluate="0.2 + 0.05")
    session.run(1)
    session.bridge.place_robot((0.7, 0.5, 1.0))


def assigned(session):
    session.namespace["turns"] = [2, 3]
    session.variables["pace"] = [0.1]  # which moves nothing
    session.run(1)
    session.variables["pace"] = 0.1


def edited(session):
    session.edit(session.text.replace("1500", "1200"))
    session.run(2)
    session.edit(session.text.replace("aside", "around"))


def rewound(session):
    session.run(3)
    session.rewind(12)


def settled(session):
    session.run(2)
    session.rate, session.on_issue = 25, "pause"
    session.resume()
    session.rewind(6)
    session.variables["turn"] = None  # an issue, at which it pauses


def restarted(session):
    session.pause()
    session.reset()


@pytest.mark.slow
@pytest.mark.parametrize("begins_again", [False, True])
@pytest.mark.parametrize("act", [by_hand, assigned, edited, rewound, settled, restarted])
def test_a_kept_run_is_the_same_again_whatever_was_done_in_it_and_wherever_it_began(
    tmp_path, act, begins_again
):
    text, names = LAPS.replace("turn aside", "[turn * turns[0]] aside"), {"turns": [1]}
    common = {"world": "line", "noise": NOISE, "seed": 3, "name": "laps", "namespace": names}
    with Session(text, "sim", VirtualClock(), **common) as session:
        if begins_again:
            session.run(7.3)
            begin_run(session)
        begin = session.frame.time
        session.run(5)
        act(session)
        session.run(8)
        recording = read_recording(session.keep(folder=tmp_path))
        assert recording.seconds == pytest.approx(session.frame.time - begin)
        again = reproduce(recording)
        assert again.difference is None
        assert again.session.frame.values == session.frame.values
        assert again.session.bridge.pose == session.bridge.pose


FAILING = """(var sum := [0])
(machine m (state a (running [sum += dt] [sum / 0])) (state b) (ontime 1000 a -> b) (ontime 1000 b -> a))
(spawn m a)"""


@pytest.mark.parametrize("policy", ["record", "pause"])
@pytest.mark.parametrize("begins", [begin_run, lambda session: session.reset()])
@pytest.mark.parametrize("rate", [10, 7])
def test_a_run_that_begins_again_is_as_if_it_were_the_first(tmp_path, rate, begins, policy):
    with Session(FAILING, clock=VirtualClock(), rate=rate, on_issue=policy) as session:
        for _ in range(3):  # at the issue, a run pauses once
            session.run(2.3)
        begins(session)
        session.run(4)
        session.resume()
        session.run(0.35)
        file = session.keep(folder=tmp_path)
        again = reproduce(read_recording(file))
        assert again.difference is None
        assert again.session.frame.values == session.frame.values
    if (rate, policy) == (10, "record"):  # where it ticks at the same times
        with Session(FAILING, clock=VirtualClock()) as first:
            first.run(4.35)
            new = read_recording(first.keep(folder=tmp_path))
        assert read_recording(file).followed == new.followed


@pytest.mark.parametrize("policy", ["record", "pause"])
def test_a_run_that_was_begun_step_by_step_is_the_same_again(tmp_path, policy):
    with Session(FAILING, clock=VirtualClock(), on_issue=policy) as session:
        session.run(1)
        session.pause()
        session.reset()
        for _ in range(3):
            session.step()
        again = reproduce(read_recording(session.keep(folder=tmp_path)))
        assert again.difference is None
        assert again.session.frame.values == session.frame.values


def test_a_run_of_a_program_that_defines_something_twice_is_the_same_again(tmp_path):
    with Session(f"(var pace := [0]) {LAPS}", "sim", VirtualClock(), on_issue="pause") as session:
        for begins in (lambda: None, lambda: begin_run(session), session.reset):
            begins()
            session.run(1)
            session.resume()
            session.run(1)
            recording = read_recording(session.keep(folder=tmp_path))
            assert reproduce(recording).difference is None
            assert Rerun((session.text,), str(tmp_path / "run.lrplog")).outcome().passed


@pytest.mark.parametrize("begins_again", [False, True])
def test_a_pause_stops_the_robot_again_when_a_kept_run_is_repeated(tmp_path, begins_again):
    text = f"(var pauses := [0]) (onpause [pauses += 1]) {LAPS}"
    with Session(text, "sim", VirtualClock(), world="line") as session:
        if begins_again:
            session.run(1)
            begin_run(session)
        session.resume()
        session.run(1)
        session.pause()
        session.run(1)
        again = reproduce(read_recording(session.keep(folder=tmp_path)))
        assert again.difference is None
        assert again.session.frame.values == session.frame.values
        assert again.session.bridge.pose == session.bridge.pose


def test_a_run_is_kept_up_to_now_also_while_it_goes_on(tmp_path):
    with Session(LAPS, "sim", VirtualClock(), world="line") as session:
        session.run(3)
        session.resume()  # so that the end of `run` is no rest
        session.run(0.95)
        recording = read_recording(session.keep(folder=tmp_path))
        assert recording.seconds == session.frame.time == 3.95
        assert reproduce(recording).session.bridge.pose == session.bridge.pose


def test_a_run_that_cannot_be_repeated_because_one_went_back_says_so(tmp_path):
    text = "(var seen := [[]]) (machine m (state a (running [seen.append(1)]))) (spawn m a)"
    with Session(text, clock=VirtualClock()) as session:
        session.run(2)
        session.rewind(5)
        session.run(1)
        with pytest.raises(ValueError, match=r"^This run cannot be kept: you went back in it, and `seen`"):
            session.keep(folder=tmp_path)


def test_runs_are_kept_beside_the_program_and_none_is_overwritten(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with Session(LAPS, "sim", VirtualClock(), name="laps") as session:
        session.run(1)
        assert [session.keep("a"), session.keep("a"), session.keep()] == [
            Path("laps.runs", name) for name in ("a.lrplog", "a (2).lrplog", "run.lrplog")
        ]
        for name in ("../a", ".a", "a.", "con", "x" * 81, "a\u202eb"):
            with pytest.raises(FileError, match="cannot be the name of a run") as raised:
                session.keep(name)
            assert str(raised.value).isprintable()


def placed(session):
    session.bridge.place_robot((1, 1, 0))
    session.call(lambda: session.bridge.simulation.step(0))
    session.run(1)


@pytest.mark.parametrize(
    ("act", "reason"),
    [
        (lambda session: None, "No tick has run yet"),
        (placed, "did not begin at the start"),
        (lambda session: session.run(90), "began 2 minutes ago"),
    ],
)
def test_a_run_whose_beginning_is_not_known_is_refused_and_leaves_no_file(tmp_path, act, reason):
    with Session(LAPS, "sim", VirtualClock(), name="laps", journal=300) as session:
        act(session)
        with pytest.raises(ValueError, match=reason):
            session.keep(folder=tmp_path)
        assert not [*tmp_path.iterdir()]
        begin_run(session)
        session.run(1)
        assert read_recording(session.keep(folder=tmp_path)).ticks == 10


def test_a_run_in_which_no_file_can_hold_what_was_done_is_refused_and_leaves_no_file(tmp_path):
    with Session(LAPS, "sim", VirtualClock(), world="line") as session:
        session.run(1)
        session.variables["pace"] = object()
        session.run(1)
        with pytest.raises(ValueError, match=r"^This run cannot be kept: something was done"):
            session.keep(folder=tmp_path)
        assert not [*tmp_path.iterdir()]


def test_a_run_that_cannot_be_repeated_is_refused_and_leaves_no_file(tmp_path):
    text = "(var n := [0]) (machine m (state a (running [n = outside()]))) (spawn m a)"
    with Session(text, clock=VirtualClock(), namespace={"outside": count().__next__}) as session:
        session.run(1)
        with pytest.raises(ValueError, match="cannot be repeated exactly: `n` had another value"):
            session.keep(folder=tmp_path)
        assert not [*tmp_path.iterdir()]
