"""``lrp run`` as a process of its own: signals, pipes, saves of the file."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from support.waiting import until

pytestmark = pytest.mark.slow  # each starts processes of its own

WAIT = "(machine m (state a (running [robot.move(linear=0.1)]))) (spawn m a)\n"


def lines_of(path):
    """The complete lines of a trace that is being written."""
    text = path.read_text() if path.exists() else ""
    return [json.loads(line) for line in text.rpartition("\n")[0].splitlines()]


def events_of(path, kind):
    return [line for line in lines_of(path) if line["event"] == kind]


def test_two_processes_write_identical_traces(process):
    arguments = ("run", "follower", "--world", "line", "--speed", "max", "--for", "60", "--trace", "-")
    runs = [process(*arguments) for _ in range(2)]
    (first, output), (second, _) = (run.communicate() for run in runs)
    assert [run.returncode for run in runs] == [0, 0]
    assert first == second
    lines = [json.loads(line) for line in first.splitlines()]
    last = next(line for line in reversed(lines) if line["event"] != "commanded")
    assert (last["event"], last["state"]) == ("entered", "follower/end")
    assert 35 < last["time"] < 60
    assert "follower: 60.0 s, 600 ticks; follower/end active; " in output
    assert "times real time" in output


@pytest.mark.parametrize(("kind", "speed"), [(signal.SIGINT, "1"), (signal.SIGTERM, "max")])
def test_a_signal_ends_the_run_cleanly(process, program, tmp_path, kind, speed):
    trace = tmp_path / "trace.jsonl"
    run = process("run", program(WAIT), "--speed", speed, "--trace", trace)
    until(lambda: events_of(trace, "entered"), "the start")
    run.send_signal(kind)
    out, err = run.communicate()
    assert (run.returncode, err) == (128 + kind, "")
    assert out.splitlines()[-1].startswith("my: ")


@pytest.mark.parametrize("kind", [signal.SIGINT, signal.SIGTERM])
def test_what_a_program_does_at_its_end_is_done_at_a_signal_and_repeated_by_a_replay(
    process, program, tmp_path, kind
):
    text = f"(onend [robot.lamp(True)] [print('lamp on')]) {WAIT}"
    trace, log = tmp_path / "trace.jsonl", tmp_path / "run.lrplog"
    run = process("run", program(text), "--trace", trace, "--record", log)
    until(lambda: events_of(trace, "entered"), "the start")
    run.send_signal(kind)
    out, err = run.communicate()
    assert (run.returncode, err) == (128 + kind, "")
    assert out.count("lamp on\n") == 1
    assert [line["command"] for line in events_of(trace, "commanded")][-1] == "lamp"
    assert len(events_of(trace, "ended")) == 1
    replay = process("replay", log)
    out, err = replay.communicate()
    assert (replay.returncode, out.count("s  ended\n"), err) == (0, 1, "")


@pytest.mark.parametrize("speed", ["1", "max"])
def test_ctrl_c_ends_a_block_that_does_not_return(process, program, speed):
    text = """(machine m (state a (running [
      import os, signal
      os.kill(os.getpid(), signal.SIGINT)
      while True: pass])))
    (spawn m a)"""
    run = process("run", program(text), "--speed", speed)
    out, err = run.communicate()
    assert (run.returncode, err) == (130, "")
    assert "my: " in out


@pytest.mark.parametrize(
    "text",
    ["(machine m (state a) (state b) (ontime 100 a -> b) (ontime 100 b -> a)) (spawn m a)", WAIT],
    ids=["restless", "at rest"],
)
def test_a_reader_that_goes_away_ends_the_run(process, program, text):
    run = process("run", program(text), "--speed", "max", "--trace", "-")
    assert json.loads(run.stdout.readline())["event"] == "started"
    run.stdout.close()
    assert run.wait() == 128 + signal.SIGPIPE
    assert "Traceback" not in run.stderr.read()


def test_a_reader_that_closes_at_the_end_is_not_a_fault_of_the_run(process, program):
    run = process("run", program(WAIT), "--speed", "max", "--for", "0.1", "--trace", "-")
    assert json.loads(run.stdout.readline())["event"] == "started"
    run.stdout.close()
    assert run.wait() in (0, 128 + signal.SIGPIPE)  # before or after the last check
    assert "lrp:" not in run.stderr.read()


def test_every_save_changes_the_running_program(process, program, tmp_path):
    text = "(var n := [1])\n" + WAIT
    path, trace, output = program(text), tmp_path / "trace.jsonl", tmp_path / "output"
    with output.open("w") as out:
        run = process("run", path, "--watch", "--set", "n=5", "--trace", trace, stdout=out)
    until(lambda: events_of(trace, "entered"), "the start")

    path.write_text(text + "(var m := [n + 2])\n")
    until(lambda: events_of(trace, "patched"), "the first save")
    until(lambda: [e for e in events_of(trace, "changed") if e["variable"] == "m"], "the new variable")

    path.write_text(text + "(var m := [7)\n")  # no program: nothing changes …
    other = tmp_path / "other"
    other.write_text(text.replace("0.1", "0.2"))
    until(lambda: "LRP103" in output.read_text(), "the error")
    os.replace(other, path)  # … and as many editors save
    until(lambda: events_of(trace, "restarted"), "the restart")

    path.unlink()
    until(lambda: "No such file or directory. The last program keeps running." in output.read_text(), "it")
    path.write_text(text)
    until(lambda: output.read_text().count("saved: restarted") == 2, "the file again")
    path.write_bytes(b"\xff\xfe(")
    until(lambda: "is not valid UTF-8: byte 0 cannot be decoded." in output.read_text(), "the bytes")
    path.write_text(text)
    until(lambda: "saved: no change in meaning" in output.read_text(), "the old text")

    run.send_signal(signal.SIGINT)
    assert run.wait() == 130
    values = [e["value"] for e in events_of(trace, "changed") if e["variable"] == "m"]
    assert values == [7]  # 5 + 2: what was set stays set
    out = output.read_text()
    assert "saved: applied while it runs: variable `m` added" in out
    assert "saved: not a valid program; the last one keeps running" in out
    assert "(var m := [7)\n" in out
    assert "^" in out
    assert "saved: restarted: `a` is active and its `running` changed." in out
    assert out.count("The last program keeps running.") == 2  # each is reported once


def test_an_active_state_is_kept_when_a_save_changes_it_if_that_is_wanted(process, program, tmp_path):
    path, trace, output = program(WAIT), tmp_path / "trace.jsonl", tmp_path / "output"
    with output.open("w") as out:
        run = process("run", path, "--watch", "--on-active-edit", "keep", "--trace", trace, stdout=out)
    until(lambda: events_of(trace, "commanded"), "the start")
    path.write_text(WAIT.replace("0.1", "0.2"))
    until(
        lambda: (
            events_of(trace, "commanded")[-1]["arguments"] != events_of(trace, "commanded")[0]["arguments"]
        )
    )
    run.send_signal(signal.SIGINT)
    assert run.wait() == 130
    assert [event["restarted"] for event in events_of(trace, "patched")] == [False]
    assert not events_of(trace, "restarted")
    assert "saved: applied while it runs: `running` of `" in output.read_text()


def test_a_save_starts_a_file_that_was_no_program_and_resumes_a_run_that_paused_at_an_issue(
    process, program, tmp_path
):
    bad = "(machine m (state a (running [1 / 0])) (state b) (ontime 500 a -> b)) (spawn m a)"
    path, trace = program("(machine m"), tmp_path / "trace.jsonl"
    run = process("run", path, "--watch", "--on-issue", "pause", "--trace", trace)
    assert "error LRP101" in run.stderr.readline()
    path.write_text(bad)
    until(lambda: events_of(trace, "issue"), "the issue")
    path.write_text(bad.replace("1 / 0", "1 / 1"))
    until(lambda: [e for e in events_of(trace, "entered") if e["state"] == "m/b"], "the next state")
    run.send_signal(signal.SIGINT)
    assert run.wait() == 130


HOLDS = WAIT.replace("robot.move(linear=0.1)", "sum(range(10**12))")


@pytest.mark.parametrize(
    ("before", "code"),
    [("", -getattr(signal, "SIGVTALRM", 0)), ("del signal.setitimer", 1)],
    ids=["here", "as on Windows"],
)
def test_a_run_of_limited_length_ends_though_a_call_never_gives_up_the_interpreter_lock(
    program, before, code
):
    hasty = "from lrp_jupyter.cli import main, run_command\nrun_command.LIMIT = 1.0"
    start = f"import signal\n{before}\n{hasty}\nmain()"
    command = [sys.executable, "-c", start, "run", str(program(HOLDS)), "--for", "1"]
    run = subprocess.run(command, capture_output=True, text=True, timeout=240)
    assert run.returncode == code
    assert 'File "' in run.stderr, "the stacks"
    assert "my.lrp" in run.stderr


def test_grading_ends_though_a_call_never_gives_up_the_interpreter_lock(process, program):
    graded = process("grade", program(HOLDS), "--challenge", "there and back", "--limit", "2")
    report, _ = graded.communicate()
    assert graded.returncode == 1
    assert "One call in a block did not return" in report


def descendants(pid):
    """Return the processes that a process has started, and those that these have."""
    try:
        lists = [path.read_text() for path in Path(f"/proc/{pid}/task").glob("*/children")]
    except OSError:
        return set()
    children = {int(each) for text in lists for each in text.split()}
    return children.union(*map(descendants, children))


def is_running(pid):
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def test_runs_end_with_their_workers_though_nobody_is_left_to_end_them(process, program):
    graded = process("grade", program(HOLDS), "--challenge", "there and back", "--limit", "600")
    both = 2 * min(2, len(os.sched_getaffinity(0)))
    started = until(lambda: len(found := descendants(graded.pid)) >= both and found, "the runs")
    workers = {pid for pid in started if descendants(pid)}
    os.kill(graded.pid, signal.SIGSTOP)
    for pid in (*workers, graded.pid):
        os.kill(pid, signal.SIGKILL)
    until(lambda: not any(map(is_running, started)), "their end")


@pytest.mark.parametrize(
    ("number", "thread", "code"),
    [(signal.SIGKILL, 0, -9), (signal.SIGINT, 0, 130), (signal.SIGINT, -1, 130)],
    ids=["killed", "interrupted", "interrupted in another thread"],
)
def test_a_grading_that_is_killed_or_interrupted_leaves_no_run_behind(process, program, number, thread, code):
    graded = process("grade", program(HOLDS), "--challenge", "there and back", "--limit", "600")
    both = 2 * min(2, len(os.sched_getaffinity(0)))  # the runs, and the workers that have forked them
    started = until(lambda: len(found := descendants(graded.pid)) >= both and found, "the runs")
    os.kill(sorted(map(int, os.listdir(f"/proc/{graded.pid}/task")))[thread], number)
    assert graded.wait() == code
    until(lambda: not any(map(is_running, started)), "their end")
