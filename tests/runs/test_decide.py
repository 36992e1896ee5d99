"""Kept runs are run again with another text, and judged by what is expected of each."""

import json
import os
from pathlib import Path
from threading import Event

import pytest
from live.test_recording import ROVER, Rover
from runs.conftest import LAPS

from lrp_jupyter import Lab, repair
from lrp_jupyter.errors import LRPError
from lrp_jupyter.grading.challenges import challenges
from lrp_jupyter.grading.workers import HowRun
from lrp_jupyter.language.parser import parse
from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.recording import read_recording
from lrp_jupyter.live.reproduction import reproduce
from lrp_jupyter.live.session import Session
from lrp_jupyter.runs.again import record_again, show_run
from lrp_jupyter.runs.decide import decide
from lrp_jupyter.runs.expectation import ExpectedPart, expectation
from lrp_jupyter.runs.kept_runs import expect, kept_runs, remove, rename
from lrp_jupyter.runs.outcome import OPEN_LOOP
from lrp_jupyter.widgets import registry

AUTOGROUP = "/proc/self/autogroup"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "time", "reason"),
    [
        (LAPS, None, ""),
        (LAPS + "; another comment", None, ""),
        (LAPS.replace("aside", "around"), None, ""),  # renamed
        (LAPS.replace("[0.3]", "[0.31]"), 22.7, "`away` is entered; in the original run it is not."),
        (LAPS.replace("2000", "2100"), 2.0, "`aside` is not entered; in the original run it is."),
        (
            LAPS.replace("(ontime 2000", "(on [elapsed > 1] ahead -> away) (ontime 2000"),
            1.1,
            "`away` is entered",
        ),
    ],
)
def test_the_first_difference_of_a_run_is_the_one_that_a_replay_reports(keep, text, time, reason):
    file = keep()
    (outcome,) = decide(text, [file]).outcomes.values()
    assert outcome.passed == (time is None)
    assert reason in outcome.reason
    again = reproduce(read_recording(file), program=text)
    entered = [
        (each.time, each.state[-1]) for each in again.session.timeline().happenings if each.kind == "entered"
    ]
    assert [(each.time, each.state) for each in outcome.now] == entered
    if time is not None:
        assert outcome.time == pytest.approx(time)
        pairs = zip(outcome.recorded, outcome.now, strict=False)
        assert outcome.time == next(min(a.time, b.time) for a, b in pairs if a != b)


LINES = [
    ("as recorded until 20 s", True, ""),
    ("as recorded until 22.8 s", False, "differs at 22.7 s"),
    ("reaches away", True, ""),
    ("reaches laps/away within 22 s", False, "`laps/away` is entered at 22.7 s."),
    ("reaches nowhere", False, "There is no state `nowhere`."),
    ("never away", False, "`away` is entered at 22.7 s."),
    ("never enters laps/away", False, "`laps/away` is entered at 22.7 s."),
    ("never touches", False, "The robot touches the edge of the world at 22.7 s."),
    ("never touches ball", True, ""),
    ("meets there and back", False, "it never touched the far wall"),
    ("meets first move", True, ""),
    ("meets `first move`, never touches ball", True, ""),
    ("reaches aside,  never touches ball", True, ""),
    ("reaches aside, never touches", False, "The robot touches the edge"),
]
"""What may be expected of a run of a program that is a little faster; whether it holds, and why not."""


@pytest.mark.slow
def test_what_is_expected_of_a_run_is_a_line(keep):
    file, runs = keep(), []
    for line, _, _ in LINES:
        expect(*kept_runs(file), line)
        runs += kept_runs(file)
    outcomes = decide(LAPS.replace("[0.3]", "[0.31]"), runs).outcomes
    for run, (line, passed, reason) in zip(runs, LINES, strict=True):
        outcome = outcomes[run]
        assert expectation(run.expected) == expectation(line)
        assert (outcome.passed, outcome.problem, reason in outcome.reason) == (passed, "", True), line


def test_every_challenge_can_be_named_also_one_with_a_comma_in_its_name():
    for each in challenges():
        line = f"{ExpectedPart('meets', each.name)}, never touches"
        assert expectation(line).challenges == {each.name: each}
        assert str(expectation(line)) == line


@pytest.mark.parametrize(
    "line",
    ["reaches", "reach a", "never", "as recorded until x s", "reaches a within 3", "never touches a b, no"],
)
def test_what_cannot_be_expected_is_refused_and_nothing_is_written(keep, line):
    (run,) = kept_runs(keep(seconds=0.1))
    with pytest.raises(LRPError, match="is not "):
        expect(run, line)
    assert kept_runs(run.file) == (run,)


@pytest.mark.slow
@pytest.mark.parametrize("line", ["as recorded", "as recorded, reaches away within 30 s"])
@pytest.mark.parametrize("force", [Session.transition_to, Session.teleport_to])
def test_a_state_that_was_entered_by_hand_after_the_last_tick_is_entered_again(keep, tmp_path, force, line):
    with Session(LAPS, "sim", VirtualClock(), world="line") as session:
        session.run(20)
        force(session, "laps/aside")
        run = expect(kept_runs(session.keep(folder=tmp_path))[0], line)
    (outcome,) = decide(LAPS, [run]).outcomes.values()
    assert outcome.difference == ""
    assert outcome.now[: len(outcome.recorded)] == outcome.recorded


def test_a_real_robots_recording_is_an_open_loop_from_the_first_difference_on(keep, tmp_path):
    file = keep(text=ROVER, bridge=Rover, act=lambda session: session.bridge.arm(), seconds=2)
    (same,) = decide(ROVER, [file]).outcomes.values()
    assert (same.passed, same.open_loop) == (True, None)
    faster = ROVER.replace("linear=2", "linear=0.4")
    (other,) = decide(faster, [file]).outcomes.values()
    assert (other.passed, other.open_loop) == (True, 0.0)  # the states follow from the readings alone
    assert OPEN_LOOP in str(decide(faster, [file]))
    (later,) = decide(ROVER.replace("< 1", "< 1.5"), [file]).outcomes.values()
    assert (later.passed, later.open_loop, later.time) == (False, 0.6, 0.6)


def test_a_simulated_run_goes_on_as_long_as_what_is_expected_of_it_may_take(keep):
    (run,) = kept_runs(keep(seconds=3))
    (short,) = decide(LAPS, [run]).outcomes.values()
    (longer,) = decide(
        LAPS, [run._replace(expected="as recorded, reaches away within 30 s")]
    ).outcomes.values()
    assert (short.passed, longer.passed) == (True, True)
    assert (short.seconds, longer.seconds) == (3, 30)
    real = keep(text=ROVER, bridge=Rover, act=lambda session: session.bridge.arm(), seconds=0.5)
    (open_loop,) = decide(ROVER, [real]).outcomes.values()
    assert open_loop.seconds == 0.5


def test_the_blocks_of_a_lab_can_read_its_names(keep, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    file, names = keep(seconds=3), {"speed": 0.3}
    lab = Lab(LAPS.replace("[0.3]", "[speed]"), name="other", namespace=names)
    try:
        assert decide(lab, file)
    finally:
        lab.close()


def slowed(session):
    session.run(0.1)
    session.set_variable("pace", evaluate="-0.1")


@pytest.mark.slow
def test_one_run_that_hangs_costs_the_others_nothing_and_says_so(keep):
    good, bad = keep("good"), keep("bad", act=slowed)
    text = LAPS.replace("(running [robot.move(angular=1.0)])", "(running [while pace < 0: pass])")
    made = decide(text, [good, bad], HowRun(limit=1))
    assert "did not return within 1 s of computing" in made["bad"].reason
    assert made["good"].problem == ""


def test_an_expression_in_a_strangers_recording_runs_only_if_trusted(keep, tmp_path):
    mark, strange = tmp_path / "mark", tmp_path / "strange.lrplog"
    expression = f"__import__('pathlib').Path({str(mark)!r}).touch()"
    strange.write_text(keep(act=slowed).read_text().replace('"-0.1"', json.dumps(expression)))
    (outcome,) = decide(LAPS, [strange]).outcomes.values()
    assert "an expression that you have not recorded here" in outcome.problem
    with Session(LAPS, "sim", VirtualClock(), world="line") as session:
        for act in (
            lambda: record_again(strange, LAPS, {}),
            lambda: show_run(session, read_recording(strange)),
        ):
            with pytest.raises(LRPError, match="an expression that you have not recorded here"):
                act()
    assert not mark.exists()
    decide(LAPS, [strange], trusted=True)
    assert mark.exists()


NESTED = """(machine arm
  (state idle)
  (state want
    (onentry (spawn hand open))
    (machine hand (state open) (state shut) (ontime 500 open -> shut)))
  (ontime 900 idle -> want))
(spawn arm idle)"""


def test_a_run_of_a_machine_that_was_started_alone_is_run_again_alone(keep):
    file = keep(text=NESTED, bridge="none", seconds=2, start="arm/want/hand")
    assert decide(NESTED, [file])
    assert decide(NESTED.replace("hand", "claw"), [file])  # renamed
    (outcome,) = decide(NESTED.replace("(spawn hand open)", "[0]"), [file]).outcomes.values()
    assert "`arm/want/hand` (line 5) is never spawned." in outcome.reason


@pytest.mark.parametrize("name", ["a 'quoted' run", "ü", "\N{ROBOT FACE}", "a\x7fb", "a\u2028b"])
def test_what_is_expected_of_a_run_of_any_name_can_be_read_again(keep, name):
    file = keep(seconds=1)  # and another program has named it
    run = expect(kept_runs(file.rename(file.with_name(f"{name}.lrplog")))[0], "reaches away")
    assert kept_runs(run.file.parent) == (run,)


@pytest.mark.parametrize("name", ["2.lrplog", "v1.2", "a.lrplog.gz b"])
def test_a_run_that_has_another_name_keeps_what_is_expected_of_it(keep, name):
    run = rename(expect(kept_runs(keep(seconds=1))[0], "reaches away"), name)
    assert kept_runs(run.file.parent) == (run,)


@pytest.mark.slow
def test_a_run_has_another_name_is_recorded_again_or_is_removed_and_nothing_is_lost(keep):
    file, other = keep("one"), keep("two")
    expect(kept_runs(file)[0], "reaches away")
    run = rename(kept_runs(file)[0], "three")
    assert [(each.name, each.expected) for each in kept_runs(file.parent)] == [
        ("three", "reaches away"),
        ("two", "as recorded"),
    ]
    with pytest.raises(LRPError, match="There is already a run `two`"):
        rename(run, "two")
    changed = LAPS.replace("2000", "2100")
    assert not decide(changed, [other])
    record_again(other, changed, {})
    assert decide(changed, [other])
    remove(run)
    assert [each.name for each in kept_runs(file.parent)] == ["two"]
    assert [each.name for each in kept_runs(file.parent / ".removed")] == ["three"]


@pytest.mark.slow
def test_a_run_that_is_shown_in_a_session_is_the_same_there(keep):
    recording = read_recording(keep(noise={"motor": 0.2}, seed=5))
    with Session(LAPS, "sim", VirtualClock(), world="empty") as session:
        session.run(3.7)
        begin = show_run(session, recording)
        shown = [
            (round(each.time - begin, 9), each.state[-1])
            for each in session.timeline().happenings
            if each.kind == "entered" and each.time >= begin
        ]
        recorded = [
            (line["time"], line["state"].split("/")[-1])
            for line in recording.followed
            if line.get("event") == "entered"
        ]
        assert (shown, session.status) == (recorded, "paused")


@pytest.mark.parametrize(
    ("text", "options", "reason"),
    [
        (NESTED, {"start": "arm/want/hand"}, "began with `arm/want/hand` alone"),
        (LAPS, {}, r"began with `\(var pace := \[0.2\]\)`"),
    ],
)
def test_a_run_that_began_otherwise_than_the_program_does_is_not_shown_as_if_it_had(
    keep, tmp_path, text, options, reason
):
    file = keep(text=text, bridge="none", seconds=2, **options)
    file.write_text(file.read_text().replace('"initials":{}', '"initials":{"pace":"0.2"}', text == LAPS))
    with Session(text, clock=VirtualClock()) as session:
        with pytest.raises(LRPError, match=reason):
            show_run(session, read_recording(file))
        assert session.frame.tick == 0
    start = read_recording(file).start
    record_again(file, text, {})
    again = read_recording(file).start
    assert (again.initials, again.start) == (start.initials, start.start)


@pytest.mark.slow
def test_what_runs_have_reached_is_what_their_events_say(keep):
    files = [keep("short", seconds=3), keep("long")]
    coverage = decide(LAPS, files).coverage
    lines = [read_recording(file).followed for file in files]
    for name, count in (("ahead", 2), ("aside", 2), ("away", 1)):
        entered = sum(any(line.get("state") == f"laps/{name}" for line in each) for each in lines)
        assert coverage.states["laps", name] == entered == count
    program = parse(LAPS)
    assert coverage.program == program
    assert str(coverage) == (
        "Reached: 3 of 3 states, 3 of 4 transitions, both outcomes of 1 of 2 conditions.\n"
        "Never fired: `laps/[pace < 0]:ahead->aside`.\n"
        "Never true: `laps/[pace < 0]:ahead->aside`."
    )
    with Session(LAPS, "sim", VirtualClock(), world="line") as session:
        session.run(25)
        live = session.coverage
        assert (live.states["laps", "ahead"], live.conditions) == (7, coverage.conditions)
        session.edit(LAPS.replace("pace < 0", "pace < 1"))
        assert [each.label for each in session.coverage.undecided] == []


def test_a_run_that_is_named_twice_is_run_once(keep):
    file = keep(seconds=0.1)
    (run,) = kept_runs(file.parent)
    assert kept_runs([file, run, file.parent]) == (run,)


@pytest.mark.slow
@pytest.mark.skipif(not Path(AUTOGROUP).exists(), reason="only Linux has priorities of sessions")
def test_a_run_behind_a_lab_gives_way_to_it(keep):
    """Also in the eyes of Linux, which compares the priorities of sessions before those of processes."""
    low = f"__import__('os').nice(0) == {os.nice(0) + 10} and ' nice 10' in open('{AUTOGROUP}').read()"
    text = LAPS.replace("pace < 0", low)
    run = expect(kept_runs(keep(text=text, seconds=0.3))[0], "reaches aside")
    for behind in (False, True):
        assert decide(text, [run], HowRun(limit=10, behind=behind)).passed is behind


@pytest.mark.slow
def test_the_smallest_change_with_which_kept_runs_pass_is_found(keep):
    folder = keep(seconds=6).parent
    late = LAPS.replace("[1500]", "[3000]")
    assert not decide(late, folder)
    found = repair(late, runs=folder, progress=lambda done, of: None)
    assert (found.passed, found.runs) == (0, 1)
    assert "`turn` 1500 ms instead of 3000 ms (line 1) passes in 1 of 1 runs (now 0)." in str(found)
    assert decide(found.repairs[0].text, folder)


def test_the_run_of_a_real_robot_is_shown_by_one_that_repeats_its_readings(keep, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("LRP_KEEP", "nothing")
    keep("drive", text=ROVER, bridge=Rover, act=lambda session: session.bridge.arm(), seconds=2)
    other, news = ROVER.replace("< 1", "< 1.5"), Event()
    connection = registry.open_program("laps", other, "none")
    try:
        connection.runs.attach(news.set)
        while connection.runs.view(connection.session)["coverage"] is None:
            assert news.wait(60)
            news.clear()
        shown = connection.runs.kept()["drive"]
        assert (shown["open_loop"], shown["differs"][0]) == (OPEN_LOOP, 0.6)
        connection.runs.show(connection, "drive")
        session = connection.session
        looked_at = connection.looking.shown(session).frame
        assert session.bridge.name == "recorded"
        assert looked_at.active == (("m", "stop"),)
        assert "`robot.range` was 1.4" in str(session.why_not("near", at=looked_at.tick))
    finally:
        registry.forget(connection)
