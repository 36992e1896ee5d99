"""``lrp run`` within this process: options, plain lines, traces, exit codes."""

import json
import os
import re
import signal
import threading
from queue import SimpleQueue
from typing import ClassVar

import pytest
from support.seeds import seeds
from support.smil import evaluate, placed

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.panel import Panel, Question
from lrp_jupyter.cli import run_command as run
from lrp_jupyter.cli import terminal
from lrp_jupyter.live.session import Session
from lrp_jupyter.sim import load
from lrp_jupyter.sim.svg_shapes import robot_colour

COUNT = """(var n := [0])
(machine counter
  (state one (running [n += 1]))
  (state two (onentry [print("two at", n)]))
  (ontime 300 one -> two go))
(spawn counter one)
"""
FAULTY = """(machine m
  (state a (running [1 / 0]))
  (state b)
  (ontime 500 a -> b))
(spawn m a)
"""


def trace_of(result):
    return [json.loads(line) for line in result.stdout.splitlines()]


def test_a_run_is_traced_line_by_line(lrp, program):
    result = lrp("run", program(COUNT), "--speed", "max", "--for", "1", "--bridge", "none")
    assert result.exit_code == 0
    assert result.stdout.splitlines()[:-1] == [
        "     0.0 s  counter/one",
        "     0.3 s  counter/two  (go)",
        "two at 3",
    ]
    assert result.stdout.splitlines()[-1].startswith("my: 1.0 s, 10 ticks; counter/two active; ")
    assert result.stdout.endswith("times real time\n")


def test_one_machine_is_run_alone(lrp, program):
    text = """(var n := [3])
(machine outer
  (state a (onentry [print("not this")] (spawn counter one))
    (machine counter (state one) (state two (onentry [print("n is", n)])) (ontime 300 one -> two go))))
(spawn outer a)
"""
    options = "--speed", "max", "--for", "1", "--bridge", "none"
    result = lrp("run", program(text), "--start", "outer/a/counter", *options)
    assert result.stdout.splitlines()[:-1] == [
        "     0.0 s  outer/a/counter/one",
        "     0.3 s  outer/a/counter/two  (go)",
        "n is 3",
    ]
    result = lrp("run", program(text), "--start", "outer/a/count", *options)
    assert (result.exit_code, result.stdout) == (2, "")
    assert "There is no machine or state `outer/a/count`. Did you mean `outer/a/counter`?" in result.stderr


@pytest.mark.parametrize("options", [("--for", "1"), ("--until", "two")])
def test_what_a_program_does_at_its_end_is_the_last_thing_in_a_trace(lrp, program, options):
    text = f"(onend [print('over')] [1 / 0]) {COUNT}"
    result = lrp("run", program(text), "--speed", "max", *options, "--bridge", "none", "--trace", "-")
    *_, printed, issue, ended = trace_of(result)
    assert [line["event"] for line in (printed, issue, ended)] == ["printed", "issue", "ended"]
    assert printed["text"] == "over\n"
    assert "issue LRP601 line 1: " in result.stderr
    assert "; 1 issue; " in result.stderr


def test_a_run_beside_a_clock_ends_in_time(lrp, program):
    result = lrp("run", program(COUNT), "--for", "0.5", "--bridge", "none", "--trace", "-")
    assert result.exit_code == 0
    assert max(line["time"] for line in trace_of(result)) < 0.5
    assert "times real time" not in result.stderr


def test_a_trace_has_a_line_for_every_event_and_stdout_has_nothing_else(lrp, program):
    result = lrp("run", program(COUNT), "--speed", "max", "--for", "0.35", "--bridge", "none", "--trace", "-")
    assert trace_of(result) == [
        {"tick": 1, "time": 0.0, "event": "started"},
        {"tick": 1, "time": 0.0, "event": "spawned", "machine": "counter"},
        {"tick": 1, "time": 0.0, "event": "entered", "state": "counter/one"},
        {"tick": 1, "time": 0.0, "event": "changed", "variable": "n", "value": 1},
        {"tick": 2, "time": 0.1, "event": "changed", "variable": "n", "value": 2},
        {"tick": 3, "time": 0.2, "event": "changed", "variable": "n", "value": 3},
        {"tick": 4, "time": 0.3, "event": "left", "state": "counter/one"},
        {"tick": 4, "time": 0.3, "event": "fired", "machine": "counter", "transition": "go",
         "source": "one", "destination": "two"},
        {"tick": 4, "time": 0.3, "event": "entered", "state": "counter/two"},
        {"tick": 4, "time": 0.3, "event": "printed", "text": "two at 3\n"},
    ]  # fmt: skip
    assert result.stderr.splitlines()[0] == "two at 3"


QUEUE = """(var q := [list(range(11))])
(machine m
  (state filling (running [q.append(len(q))]))
  (state full)
  (on [len(q) == 14] filling -> full))
(spawn m filling)
"""


def test_a_trace_shows_a_list_that_is_changed_in_place_as_it_was_in_each_tick(lrp, program, tmp_path):
    log = tmp_path / "run.lrplog"
    result = lrp("run", program(QUEUE), "--speed", "max", "--for", "1", "--trace", "-", "--record", log)
    first = ", ".join(map(str, range(12)))
    assert [(line["tick"], line["value"]) for line in trace_of(result) if line["event"] == "changed"] == [
        (1, f"[{first}]"),
        (2, f"[{first}, ... 1 more]"),
        (3, f"[{first}, ... 2 more]"),
    ]
    assert lrp("replay", log).exit_code == 0
    other = lrp("replay", log, "--program", program(QUEUE.replace("len(q))", "0)")))
    assert "`q` became" in other.stdout


def test_a_trace_goes_into_a_file_as_well(lrp, program, tmp_path):
    path = tmp_path / "trace.jsonl"
    lrp("run", program(COUNT), "--speed", "max", "--for", "1", "--trace", path)
    assert len(path.read_text().splitlines()) == 10


@pytest.mark.parametrize("name", ["follower", "two-machines"])
def test_two_runs_have_the_same_trace(lrp, name):
    arguments = (
        "run",
        name,
        "--speed",
        "max",
        "--for",
        "20",
        "--seed",
        "5",
        "--noise",
        "motor=0.1",
        "--trace",
        "-",
    )
    first, second, other = (
        lrp(*arguments).stdout,
        lrp(*arguments).stdout,
        lrp(*arguments, "--seed", "6").stdout,
    )
    assert first == second
    assert (name == "follower") == (first != other)


@pytest.mark.slow
@pytest.mark.parametrize("seed", seeds(1, 4))
def test_the_papers_constants_lead_there_and_back_with_noise(lrp, seed):
    result = lrp(
        "run", "follower-paper", "--world", "line", "--speed", "max", "--for", "300", "--until", "end",
        "--seed", seed, "--noise", "motor=0.02", "--noise", "light=5", "--trace", "-",
    )  # fmt: skip
    assert result.exit_code == 0, result.stderr
    assert trace_of(result)[-1]["state"] == "follower/end"
    bumps = [line["destination"] for line in trace_of(result) if line["event"] == "fired"]
    assert bumps.count("bumpback") == 1


def test_a_run_until_a_state_ends_in_it(lrp, program):
    result = lrp("run", program(COUNT), "--speed", "max", "--until", "counter/two", "--trace", "-")
    entered = [line["state"] for line in trace_of(result) if line["event"] == "entered"]
    assert (result.exit_code, entered[-1]) == (0, "counter/two")
    result = lrp("run", program(COUNT), "--until", "two", "--trace", "-")  # beside a clock
    entered = [line["state"] for line in trace_of(result) if line["event"] == "entered"]
    assert (result.exit_code, entered[-1]) == (0, "counter/two")


def test_a_state_that_is_not_entered_is_a_failure(lrp, program):
    assert lrp("run", program(COUNT), "--speed", "max", "--until", "two", "--for", "0.2").exit_code == 1


@pytest.mark.parametrize("variable", ["forward", "maxlook"])
def test_a_variable_starts_with_another_value(lrp, variable):
    result = lrp(
        "run", "follower", "--speed", "max", "--for", "1", "--set", f"{variable}=7 * 10", "--trace", "-"
    )
    first = next(line for line in trace_of(result) if line.get("variable") == variable)
    assert first["value"] == 70


def test_a_variable_of_a_nested_machine_is_set_by_its_path_or_its_only_name(lrp):
    path = "follower/looking/lookalgo/time"
    for name in (path, "time"):
        result = lrp(
            "run", "follower", "--speed", "max", "--for", "1", "--set", f"{name}=3 * maxlook", "--trace", "-"
        )
        values = [line["value"] for line in trace_of(result) if line.get("variable") == path]
        assert values[0] == 600


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["--set", "serch=1"], "Did you mean `search`?"),
        (["--set", "search"], "takes NAME=VALUE"),
        (["--set", "search="], "It is empty."),
        (["--set", "search=1 +"], "is not a valid Python expression"),
        (["--speed", "fast"], "such as 2, or `max`"),
        (["--speed", "-1"], "a factor of 0.001 or more"),
        (["--rate", "-1"], "or 0 for as many as possible, not `-1`"),
        (["--for", "soon"], "unable to parse"),
        (["--noise", "motor=much"], "takes a number"),
        (["--noise", "moter=1"], "There is no noise `moter`"),
        (["--world", "lin"], "Did you mean `line`?"),
        (["--world", "no.json"], "cannot be read"),
        (["--bridge", "simm"], "There is no bridge `simm`"),
        (["--bridge", "no/such/bridge.py"], "`no/such/bridge.py` cannot be read: No such file or directory."),
        (["--bridge", "none", "--world", "line"], "--world is for the simulator"),
        (["--bridge", "none", "--option", "port=1"], "has no option `port`"),
        (["--bridge", "sim", "--host", "10.0.0.1"], "no option `host`"),
        (["--until", "ende"], "Did you mean `end`?"),
        (["--watch"], "--watch needs a file of your own"),
        (["--trace", "no/such/folder"], "`no/such/folder` cannot be written: there is no such folder."),
        (["--on-issue", "panic"], "panic"),
        (["--on-active-edit", "kep"], "kep"),
    ],
)
def test_what_cannot_be_meant_is_a_sentence_and_exit_code_2(lrp, arguments, sentence):
    result = lrp("run", "follower", "--speed", "max", "--for", "1", *arguments)
    assert result.exit_code == 2
    assert sentence in " ".join(result.stderr.replace("│", " ").split())
    assert "Traceback" not in result.stderr


def test_a_variable_set_in_a_program_that_has_none_is_a_sentence(lrp, program):
    result = lrp("run", program("(machine m (state a)) (spawn m a)"), "--set", "x=1")
    words = "lrp: --set x: There is no variable `x`. The program has no variable.\n"
    assert (result.exit_code, result.stderr) == (2, words)


@pytest.mark.parametrize("command", [[], ["run"], ["check"], ["graph"], ["grade"]])
def test_the_help_lists_the_exit_codes(lrp, command):
    words = " ".join(lrp(*command, "--help").stdout.split())
    assert re.search(r"Exit codes?: 0", words)
    assert ("154" in words) == (command in ([], ["run"]))


def test_a_text_that_is_not_a_program_is_shown_with_its_errors_and_does_not_run(lrp, program):
    result = lrp("run", program("(machine m\n(spawn m a)"))
    assert (result.exit_code, result.stdout) == (1, "")
    assert "LRP101" in result.stderr
    assert "^" in result.stderr


def test_the_findings_of_a_program_are_shown_and_it_runs(lrp, program):
    text = COUNT.replace("one -> two", "one -> twoo")
    result = lrp("run", program(text), "--speed", "max", "--for", "1")
    assert result.exit_code == 0
    assert "error LRP303" in result.stdout
    assert "issue LRP303 line 5, as said above\n" in result.stdout
    assert result.stdout.count("has no state") == 1, "a fault is told once"


def test_an_issue_is_shown_once_at_its_place(lrp, program):
    result = lrp("run", program(FAULTY), "--speed", "max", "--for", "1")
    assert result.exit_code == 0
    assert result.stdout.count("issue LRP601 line 2") == 1
    assert "    2 |   (state a (running [1 / 0]))\n" in result.stdout
    assert "; 1 issue; " in result.stdout


@pytest.mark.parametrize("speed", ["max", "1"])
def test_an_issue_ends_the_run_when_it_cannot_be_resumed(lrp, program, speed):
    result = lrp("run", program(FAULTY), "--speed", speed, "--for", "30", "--on-issue", "pause")
    assert result.exit_code == 1
    assert "ZeroDivisionError" in result.stdout
    assert "0.0 s, 1 tick;" in result.stdout


@pytest.mark.parametrize("speed", ["1", "max"])
def test_a_run_that_the_program_itself_pauses_ends_with_the_reason(lrp, program, speed):
    text = "(machine m (state a (running [raise KeyboardInterrupt]))) (spawn m a)"
    result = lrp("run", program(text), "--speed", speed, "--for", "30", "--bridge", "none")
    assert result.exit_code == 1
    assert "Paused: The program raised `KeyboardInterrupt`, as Ctrl-C does.\n" in result.stdout
    assert "0.0 s, 1 tick;" in result.stdout


def test_a_notice_of_the_robot_is_printed_once(lrp, program):
    text = "(machine m (state a (onentry [robot.move(linear=0.1)]))) (spawn m a)"
    result = lrp("run", program(text), "--speed", "max", "--for", "3")
    assert result.stdout.count("No command for 0.5 s. If it has to go on, put `move` into `running`.") == 1


def test_a_limit_of_the_robot_is_printed_once_however_much_is_asked_for(lrp, program):
    text = "(var n := [1]) (machine m (state a (running [n += 1; robot.move(linear=n)]))) (spawn m a)"
    result = lrp("run", program(text), "--speed", "max", "--for", "3")
    assert result.stdout.count("limited to") == 1
    assert "`move`: linear 2 limited to 0.5." in result.stdout


def test_the_text_itself_names_its_world(lrp, program, tmp_path):
    (tmp_path / "mine.json").write_text(lrp("worlds", "--json", "boxes").stdout)
    look = "(machine m (state a (onentry [print(robot.distance.data)]))) (spawn m a)"
    near = lrp("run", program(f"; world: mine.json\n{look}"), "--speed", "max", "--for", "0.2").stdout
    assert float(near.splitlines()[1]) < 1
    other = lrp(
        "run", program(f"; world: boxes\n{look}"), "--world", "empty", "--speed", "max", "--for", "0.2"
    ).stdout
    assert float(other.splitlines()[1]) > 1
    none = lrp("run", program(f"; world: none\n{look}"), "--speed", "max", "--for", "0.2").stdout
    assert "the bridge `none` offers no members" in none


def test_modules_beside_the_file_can_be_imported(lrp, program, tmp_path):
    (tmp_path / "beside.py").write_text("ANSWER = 42")
    text = "(var n := [import beside; beside.ANSWER]) (machine m (state a (onentry [print(n)]))) (spawn m a)"
    assert "42" in lrp("run", program(text), "--speed", "max", "--for", "0.2").stdout.splitlines()


def test_rate_0_ticks_with_every_step_of_the_world(lrp, program):
    result = lrp("run", program(COUNT), "--rate", "0", "--speed", "max", "--for", "0.2")
    assert "0.2 s, 20 ticks" in result.stdout


# -- hardware


class Recorder(Bridge):
    """A bridge to a robot that only remembers."""

    name = "recorder"
    log: ClassVar = []
    interrupt_after = 3

    def __init__(self, port=1, host=None):
        self.log.append(("made", port, host))

    def open_interface(self):
        self.add_method("move", self.move)
        return Panel("recorder", questions=(Question("name", "How is it called?"),))

    def move(self, linear=0.0):
        if linear:
            self.log.append(("move", linear))
        if len([entry for entry in self.log if entry[0] == "move"]) == self.interrupt_after:
            os.kill(os.getpid(), signal.SIGINT)

    def answer(self, key, value):
        if key != "name":
            super().answer(key, value)
        self.log.append(("answer", key, value))

    def stop(self):
        self.log.append(("stop",))

    def close_interface(self):
        self.log.append(("close",))


DRIVE = "(machine m (state a (running [robot.move(linear=0.1)]))) (spawn m a)"


class Watched(Bridge, offered=False):
    """A bridge that waits until a person could read what has happened, and then ends the run."""

    printed: ClassVar[list[str]] = []

    def open_interface(self):
        self.begun, self.is_over = 0, False
        self.add_variable("is_over", lambda: self.is_over)

    def was_printed(self, words):
        return any(words in line for line in self.printed[self.begun :])

    def stop(self):
        pass


@pytest.fixture
def said_by(lrp, program, monkeypatch):
    """Run a program until a bridge is over; what was printed about its robot."""
    monkeypatch.setattr(Watched, "printed", [])
    show = run._Run.print
    monkeypatch.setattr(
        run._Run, "print", lambda self, what: (show(self, what), Watched.printed.append(str(what)))
    )
    text = "(machine m (state a) (state over) (on [robot.is_over] a -> over)) (spawn m a)"

    def said_by(name):
        result = lrp("run", program(text), "--bridge", name, "--until", "over")
        assert result.exit_code == 0
        said = [line.partition("robot: ")[2] for line in result.stdout.splitlines() if "robot: " in line]
        return [words for words in said if "armed" not in words and "No tick for" not in words]

    return said_by


class Away(Watched):
    """A bridge to a robot that is found late, and lost again."""

    name = "away"

    def open_interface(self):
        super().open_interface()
        found, lost = ("connected", "The robot was found."), ("lost", "The connection broke.")
        self.changes = [found, lost, found, lost]
        self.set_status("waiting for data", "No robot was found yet.")

    def sense(self, now):
        if self.was_printed(self.status.sentence):
            self.begun, self.is_over = len(self.printed), not self.changes
            if self.changes:
                self.set_status(*self.changes.pop(0))


def test_every_change_of_the_connection_to_the_robot_is_printed(said_by):
    found_and_lost = ["The robot was found.", "The connection broke."]
    assert said_by("away") == ["No robot was found yet.", *found_and_lost, *found_and_lost]


class Sudden(Watched):
    """A bridge to a robot that is lost right after its status was read."""

    name = "sudden"

    @property
    def status(self):
        status = super().status
        if threading.current_thread() is threading.main_thread() and self.was_printed("is connected."):
            self.begun = len(self.printed)
            self.set_status("lost", "The connection broke.")
        return status

    def sense(self, now):
        self.is_over = self.was_printed("The connection broke.")


def test_a_loss_in_the_midst_of_printing_is_printed_once(said_by):
    assert said_by("sudden") == ["`sudden` is connected.", "The connection broke."]


class Hushed(Watched):
    """A bridge to a robot that is silent for a while."""

    name = "hushed"

    def open_interface(self):
        super().open_interface()
        self.time = 0.0
        self.fed.clock = lambda: self.time
        self.feed("light.data", 7, doc="brightness", stale_after=0.3)

    def sense(self, now):
        if self.was_printed("is stale"):
            self.feed("light.data", 7)
            self.is_over = self.was_printed("`hushed` is connected.")
        elif self.was_printed("`hushed` is connected."):
            self.begun, self.time = len(self.printed), 0.5


def test_data_that_are_too_old_are_printed_once_and_so_is_their_end(said_by):
    connected = "`hushed` is connected."
    assert said_by("hushed") == [connected, "`robot.light.data` is stale: its value is 0.5 s old.", connected]


@pytest.mark.skipif(not hasattr(signal, "SIGHUP"), reason="Windows has no such signal")
@pytest.mark.parametrize(("handler", "caught"), [(signal.SIG_IGN, []), (signal.SIG_DFL, [1])])
def test_a_run_that_is_to_outlive_its_terminal_does(handler, caught):
    before = signal.signal(signal.SIGHUP, handler)
    try:
        with terminal.recorded_signals(SimpleQueue()) as found:
            os.kill(os.getpid(), signal.SIGHUP)
        assert found == caught
        assert signal.getsignal(signal.SIGHUP) is handler
    finally:
        signal.signal(signal.SIGHUP, before)


def test_hardware_that_is_named_is_armed_and_ctrl_c_stops_it(lrp, program):
    handler = signal.getsignal(signal.SIGINT)  # in the background it is another than in a terminal
    Recorder.log.clear()
    result = lrp(
        "run", program(DRIVE), "--bridge", "recorder", "--option", "port=7", "--option", "name=Robbie"
    )
    assert result.exit_code == 130
    log = Recorder.log
    assert log[:2] == [("made", 7, None), ("answer", "name", "Robbie")]
    moves = [place for place, entry in enumerate(log) if entry[0] == "move"]
    assert len(moves) >= 3
    assert ("stop",) in log[moves[-1] :]
    assert log[-1] == ("close",)
    assert "`recorder` is armed" in result.stdout
    assert signal.getsignal(signal.SIGINT) is handler


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["--option", "colour=red"], "has no option `colour`; it takes `port`, `host`, `name`."),
        (["--option", "port=seven"], "`port` takes a number, not `seven`."),
        (["--speed", "2"], "moves in real time"),
        (["--seed", "2"], "--seed is for the simulator"),
    ],
)
def test_what_a_robot_does_not_accept_is_reported_in_a_sentence(lrp, program, arguments, sentence):
    result = lrp("run", program(DRIVE), "--bridge", "recorder", *arguments)
    assert result.exit_code == 2
    assert sentence in " ".join(result.stderr.replace("│", " ").split())


def test_the_address_of_a_robot_has_an_option_of_its_own(lrp, program):
    Recorder.log.clear()
    lrp("run", program(DRIVE), "--bridge", "recorder", "--host", "10.0.0.1", "--for", "0.1")
    assert Recorder.log[0] == ("made", 1, "10.0.0.1")


@pytest.fixture
def impatient(monkeypatch):
    """Have a block count as hung soon, and a run end soon after that."""
    monkeypatch.setitem(Session.__init__.__kwdefaults__, "hung_after", 0.1)
    monkeypatch.setattr(run, "LIMIT", 0.2)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("options", "block"),
    [
        ("--for 1", "while True: pass"),
        ("--for 1", "import time; time.sleep(60)"),
        ("--for 1 --speed max", "while True: pass"),
        ("--until b --speed max", "while True: pass"),
    ],
)
def test_a_run_of_limited_length_ends_though_a_block_does_not_return(lrp, program, impatient, options, block):
    text = "(machine m\n  (state a (running [" + block + "])) (state b))\n(spawn m a)\n"
    result = lrp("run", program(text), *options.split(), "--bridge", "none")
    assert result.exit_code == 1
    assert "hung: `a.running` has run for" in result.stderr
    assert "(line 2)" in result.stderr
    assert "ended the run" in result.stderr


@pytest.mark.slow
def test_a_block_that_does_not_return_is_interrupted_by_a_save(lrp, program, impatient, monkeypatch):
    monkeypatch.setattr(run, "LIMIT", 60)
    endless = COUNT.replace("n += 1", "while True: pass")
    file = program(endless)
    begun = []

    def repair(board, *_):
        if not begun:
            begun.append(file.write_text(COUNT))

    monkeypatch.setattr(run._Run, "_print_hang", lambda self, frame: frame.hung and repair(self))
    result = lrp("run", file, "--watch", "--until", "two", "--bridge", "none")
    assert result.exit_code == 0
    assert "saved: restarted" in result.stdout
    assert "LRP611" in result.stdout


@pytest.mark.parametrize("rate", ["inf", "nan", "0.001", "1e9"])
def test_a_rate_without_time_between_ticks_is_refused_in_a_sentence(lrp, rate):
    result = lrp("run", "stopwatch", "--rate", rate)
    assert result.exit_code == 2
    words = " ".join(result.stderr.replace("│", " ").split())
    assert "--rate takes 0.01 to 1,000,000 ticks per second, or 0 for as many as possible, not" in words


def test_a_rate_of_0_ticks_as_often_as_possible(lrp, program):
    result = lrp("run", program(COUNT), "--rate", "0", "--for", "0.5", "--speed", "max", "--bridge", "none")
    assert result.stdout.splitlines()[-1].startswith("my: 0.5 s, 50 ticks; ")


def test_a_noise_that_is_not_a_number_is_refused(lrp):
    result = lrp("run", "follower", "--noise", "motor=nan", "--for", "1")
    assert (result.exit_code, "--noise motor takes a number" in result.stderr) == (2, True)


def test_grading_without_a_file_says_so(lrp):
    result = lrp("grade", "--challenge", "square")
    assert result.exit_code == 2
    assert result.stderr.startswith("lrp: No file was named. Write `lrp grade FILE --challenge NAME`.")


def test_a_run_is_written_as_a_moving_picture(lrp, program, tmp_path):
    path = tmp_path / "run.svg"
    done = lrp("run", "box-pusher", "--speed", "max", "--for", "20", "--animate", path)
    assert done.exit_code == 0
    picture = path.read_text(encoding="utf-8")
    assert "boxes · 0.0 to 20.0 s" in picture
    start, end = (placed(evaluate(picture, time), robot_colour(0)[0])[0][:2] for time in (0.0, 19.9))
    assert start == pytest.approx(load("boxes").robots[0].pose[:2], abs=0.002)
    assert end != pytest.approx(start, abs=0.1)
    assert len(picture) < 20_000


def test_only_a_simulated_run_is_animated(lrp, program, tmp_path):
    for options, told in (
        (
            ["--bridge", "none", "--animate", tmp_path / "run.svg"],
            "--animate draws a simulated world, and `none`",
        ),
        (["--animate", "-"], "--animate writes a file. Give its name, as in `--animate run.svg`."),
    ):
        done = lrp("run", program(COUNT), "--speed", "max", "--for", "1", *options)
        assert done.exit_code == 2
        assert told in " ".join(done.stderr.replace("│", " ").split())


@pytest.mark.parametrize("ending", ["--for 1", "--for 0.955", "--for 9 --until lookleft"])
def test_a_run_ends_at_the_time_or_after_the_tick_that_is_asked_for_at_any_speed(lrp, ending):
    runs = [
        lrp(
            "run",
            "follower",
            "--set",
            "follower/nobump=True",
            "--trace",
            "-",
            "--speed",
            speed,
            *ending.split(),
        )
        for speed in ("max", "1000", "50")
    ]
    assert [run.exit_code for run in runs] == [0, 0, 0]
    assert len({run.stdout.count('"event":"commanded"') for run in runs}) == 1
    lengths = {run.stderr.splitlines()[-1].partition(";")[0] for run in runs}
    assert len(lengths) == 1, "the same seconds, and the same ticks"
