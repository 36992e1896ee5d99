"""`lrp run --record`, `lrp replay`, `lrp why` and `lrp looks`."""

import csv
import json
from datetime import datetime, timedelta

import pytest

from lrp_jupyter.live.session import Session

TEXT = """; world: line
(var limit := [100])
(var n := [0])
(machine m
  (state drive (running [robot.move(linear=0.2)] [n += 1]))
  (state stop (onentry [robot.stop()]))
  (on [robot.light.data > 300] drive -> stop bright)
  (on [n > limit] drive -> stop far))
(spawn m drive)
"""


@pytest.fixture
def recorded(lrp, program, tmp_path):
    """A recording of a run."""

    def record(*options, text=TEXT, name="run.lrplog"):
        path = tmp_path / name
        done = lrp("run", program(text), "--speed", "max", "--for", "5", "--record", path, *options)
        assert done.exit_code == 0
        return path

    return record


def test_a_run_is_recorded_and_run_again(lrp, recorded):
    path = recorded("--noise", "light=5", "--set", "limit=20")
    done = lrp("replay", path)
    assert done.exit_code == 0
    assert "5.0 s, 50 ticks; m/stop active" in done.stdout
    assert "The run matches the recording." in done.stdout
    assert "m/stop  (far)" in done.stdout


def test_when_it_was_recorded_is_told_and_what_the_robots_clock_showed(lrp, recorded):
    before = datetime.now().astimezone()
    path = recorded("--set", "limit=20")
    done = lrp("replay", path)
    when = datetime.fromisoformat(done.stdout.split()[1].rstrip("."))
    assert before - timedelta(milliseconds=1) <= when <= datetime.now().astimezone()
    first, *lines = map(json.loads, path.read_text().splitlines())
    del first["recorded"]  # as before there was this field
    next(line for line in lines if line.get("time") == 0.5 and "readings" in line)["clock"] = 105.8
    path.write_text("".join(json.dumps(line) + "\n" for line in [first, *lines]))
    told = "The robot's clock was at 105.300 s at 0 s.\n"
    replayed = lrp("replay", path, "--trust").stdout
    assert replayed.startswith(told)
    assert "The run matches the recording." in replayed
    assert lrp("why", path, "drive", "--trust").stdout.startswith(told)


def test_a_part_of_a_run_is_printed(lrp, recorded):
    done = lrp("replay", recorded("--set", "limit=20"), "--from", "1", "--until", "3")
    assert "m/drive" not in done.stdout
    assert "m/stop  (far)" in done.stdout
    assert "3.0 s, 31 ticks" in done.stdout


def test_another_program_is_run_with_the_recorded_inputs(lrp, recorded, program):
    path = recorded()
    done = lrp("replay", path, "--program", program(TEXT.replace("[100]", "[10]"), "other.lrp"))
    assert done.exit_code == 0
    assert "Replay: `far` fired, from `drive` to `stop`." in done.stdout, "and not that `limit` is another"
    broken = lrp("replay", path, "--program", program("(machine", "broken.lrp"))
    assert broken.exit_code == 1
    assert "LRP1" in broken.stderr


def difference(lrp, path, other):
    """What `lrp replay --program` says at its end, in one line."""
    done = lrp("replay", path, "--program", other)
    assert done.exit_code == 0
    return " ".join(done.stdout.split("active\n")[-1].split())


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        (
            "> limit",
            "> 2",
            "The first difference is at 0.3 s (tick 4), in the machine `m`. Recorded: `drive.running` "
            "(line 5) called `robot.move(linear=0.2)`. Replay: `far` fired, from `drive` to `stop`.",
        ),
        (
            "> 300",
            "> -1",
            "The first difference is at 0 s (tick 1), in the machine `m`. Only in the recording: "
            "`drive.running` (line 5) called `robot.move(linear=0.2)`.",
        ),
        (
            "linear=0.2",
            "linear=0.1",
            "The first difference is at 0 s (tick 1), in the machine `m`. Recorded: `drive.running` "
            "(line 5) called `robot.move(linear=0.2)`. Replay: `drive.running` (line 5) called "
            "`robot.move(linear=0.1)`.",
        ),
        (
            "(var n := [0])",
            "(var n := [0]) (var more := [1])",
            "The first difference is at 0 s (tick 1). Only in the replay: `more` became 1.",
        ),
        (
            "[n += 1]",
            "[n += 1] [what]",
            "The first difference is at 0 s (tick 1), in the machine `m`. Only in the replay: `drive` "
            "(line 5) had an issue: `what` is not defined here. Correct the name, or declare "
            "`(var what := [value])`.",
        ),
        ("; world: line\n", "; world: line\n\n\n", "The run matches the recording."),
    ],
    ids=["fired", "enabled", "commanded", "more", "issue", "other lines"],
)
def test_the_first_difference_says_when_where_and_what_each_did(lrp, recorded, program, old, new, told):
    path = recorded()
    assert TEXT.count(old) == 1
    assert difference(lrp, path, program(TEXT.replace(old, new), "other.lrp")) == told


def test_a_run_that_is_another_one_now_is_told(lrp, recorded):
    path = recorded()
    lines = path.read_text(encoding="utf-8").splitlines()
    changed = [line.replace('"value":7}', '"value":8}') for line in lines]
    assert changed != lines
    path.write_text("\n".join(changed) + "\n", encoding="utf-8")
    done = lrp("replay", path)
    assert done.exit_code == 1
    assert "Recorded: `n` became 8. Replay: `n` became 7." in done.stdout


def test_a_recording_is_asked_why(lrp, recorded):
    path = recorded(name="run.lrplog.gz")
    done = lrp("why", path, "bright", "--at", "2")
    assert done.exit_code == 0
    assert "`bright` (line 7) did not fire at 2 s: `robot.light.data > 300` was False" in done.stdout
    assert "7 |   (on [robot.light.data > 300] drive -> stop bright)" in done.stdout
    assert "`drive` was entered at 0 s when the program started" in lrp("why", path, "drive").stdout
    assert "`drive.running` (line 5)" in lrp("why", path, "robot.move", "--at", "1.5").stdout


@pytest.mark.slow
def test_a_recording_or_trace_never_overwrites_what_the_run_reads_or_writes(lrp, program, tmp_path):
    path, other = program(TEXT), tmp_path / "run.lrplog"
    (link := tmp_path / "link.lrp").symlink_to(path)
    world = tmp_path / "mine.json"
    world.write_text(lrp("worlds", "--json", "line").stdout, encoding="utf-8")
    for options, told in (
        (["--record", path], "--record would overwrite the program"),
        (["--record", link], "--record would overwrite the program"),
        (["--trace", path], "--trace would overwrite the program"),
        (["--world", world, "--record", world], "--record would overwrite the world"),
        (["--trace", other, "--record", other], "--record would overwrite the trace"),
        (["--animate", path], "--animate would overwrite the program"),
        (["--record", other, "--animate", other], "--animate would overwrite the recording"),
        (["--record", "-"], "--record writes a file."),
    ):
        done = lrp("run", path, "--speed", "max", "--for", "1", *options)
        assert done.exit_code == 2
        assert told in " ".join(done.stderr.replace("│", " ").split())
    assert path.read_text(encoding="utf-8") == TEXT
    assert world.read_text(encoding="utf-8").startswith("{")
    assert not other.exists()
    done = lrp("run", path, "--speed", "max", "--for", "1", "--trace", "/dev/null", "--record", "/dev/null")
    assert done.exit_code == 0


def test_random_numbers_are_recorded_by_their_seed(lrp, recorded):
    text = TEXT.replace("n += 1", "import random; n = random.random()")
    assert "matches the recording" in lrp("replay", recorded(text=text)).stdout


def test_what_cannot_be_run_again_is_refused(lrp, recorded, tmp_path):
    path = recorded()
    assert "no transition, state or command `brigt`. Did you mean `bright`?" in " ".join(
        lrp("why", path, "brigt").stderr.replace("│", " ").split()
    )
    late = lrp("why", path, "bright", "--at", "7").stderr.replace("│", " ")
    assert "ends at 5.0 s. Ask about an earlier time." in " ".join(late.split())
    assert lrp("replay", tmp_path / "missing.lrplog").exit_code == 2
    start, *rest = path.read_text(encoding="utf-8").splitlines()
    foreign = json.loads(start) | {"names": ["draw"]}
    path.write_text("\n".join([json.dumps(foreign), *rest]), encoding="utf-8")
    assert "recorded in a notebook" in " ".join(
        lrp("replay", path, "--trust").stderr.replace("│", " ").split()
    )


def test_a_trace_is_the_part_of_a_recording_that_followed(lrp, program, tmp_path):
    trace, log = tmp_path / "t.jsonl", tmp_path / "r.lrplog"
    text = TEXT.replace("[n += 1]", "[n += 1; print(n)]")
    lrp("run", program(text), "--speed", "max", "--for", "3", "--trace", trace, "--record", log)
    _, *lines = map(json.loads, log.read_text(encoding="utf-8").splitlines())
    followed = [line for line in lines if "input" not in line and "readings" not in line]
    assert followed == [*map(json.loads, trace.read_text(encoding="utf-8").splitlines())]
    assert {"entered", "changed", "commanded", "printed"} <= {line["event"] for line in followed}
    command = next(line for line in followed if line["event"] == "commanded")
    assert (command["command"], command["block"], command["line"]) == ("move", "drive.running", 5)
    assert {"tick": 3, "time": 0.2, "event": "printed", "text": "3\n"} in followed


def test_a_breakpoint_ends_a_run_without_a_keyboard(lrp, program):
    done = lrp("run", program(TEXT), "--speed", "max", "--for", "5", "--set", "limit=20", "--break", "stop")
    assert done.exit_code == 1
    assert "Paused: `stop` was entered (breakpoint 1, 1st time)." in done.stdout


@pytest.mark.parametrize(
    ("what", "said"),
    [
        ("far", "`far` fired"),
        ("left drive", "`drive` was left"),
        ("when n > 10", "`n > 10` became True"),
    ],
)
def test_a_run_can_wait_for_other_things(lrp, program, what, said):
    done = lrp("run", program(TEXT), "--speed", "max", "--for", "5", "--set", "limit=20", "--break", what)
    assert said in done.stdout


@pytest.mark.parametrize(
    ("what", "said"),
    [
        ("stopp", "There is no state or transition `stopp`. Did you mean `stop`?"),
        ("n", "`n` is a variable, not a state or transition. There are: `drive`, `stop`, `bright`, `far`."),
        ("left", "Write more after `left`, as in `--break 'left moving'`."),
        ("when", "Write more after `when`"),
        ("event bright", "`bright` is a transition, not an event."),
        ("fahr", "There is no state or transition `fahr`. Did you mean `far`?"),
        ("when n +", "--break"),
    ],
)
def test_a_breakpoint_that_cannot_be_set_is_refused(lrp, program, what, said):
    done = lrp("run", program(TEXT), "--for", "1", "--break", what)
    assert done.exit_code == 2
    assert said in " ".join(done.stderr.replace("│", " ").split())


@pytest.mark.parametrize(
    ("what", "said"),
    [
        ("a", "Several states are called `a`. Use one of `m/a`, `k/a`."),
        ("t", "Several transitions are called"),
    ],
)
def test_a_breakpoint_at_one_of_several_is_refused(lrp, program, what, said):
    twins = "".join(f"(machine {name} (state a) (state b) (ontime 9 a -> b t))" for name in "mk")
    done = lrp("run", program(twins), "--for", "1", "--break", what)
    assert done.exit_code == 2
    assert said in " ".join(done.stderr.replace("│", " ").split())


def test_a_condition_of_a_breakpoint_that_raises_is_told_at_the_end(lrp, program):
    done = lrp("run", program(TEXT), "--speed", "max", "--for", "1", "--break", "when nn > 3")
    assert done.exit_code == 0
    assert "The condition `nn > 3` of --break could not be evaluated: NameError" in done.stderr
    assert not lrp("run", program(TEXT), "--speed", "max", "--for", "1", "--break", "when n > 999").stderr


def test_a_transition_is_fired_by_hand_recorded_and_fired_again(lrp, recorded):
    path = recorded("--fire", "far@2")
    done = lrp("replay", path)
    assert "2.0 s  forced fire" in done.stdout
    assert "m/stop active" in done.stdout
    assert "The run matches the recording." in done.stdout
    assert "`stop` was entered at 2 s by hand (fire), not by the program." in lrp("why", path, "stop").stdout


@pytest.mark.parametrize(
    ("fire", "code", "told"),
    [
        ("fahr@2", 2, "--fire: There is no transition `fahr`. Did you mean `far`?"),
        ("far", 2, "--fire takes TRANSITION@SECONDS, such as `tlooking@2.5`, not `far`."),
        ("far@soon", 2, "--fire far@ takes a number of seconds, not `soon`."),
        ("bright@3", 0, "3.0 s --fire bright: None of the states that `bright` leaves is active: drive."),
    ],
)
def test_a_transition_that_cannot_be_fired_is_told(lrp, program, fire, code, told):
    options = ("--speed", "max", "--for", "4", "--set", "limit=9", "--fire", fire)
    done = lrp("run", program(TEXT), *options)
    assert done.exit_code == code
    assert told in " ".join((done.stdout + done.stderr).replace("│", " ").split())


def test_a_part_that_ends_before_it_begins_is_refused(lrp, recorded):
    done = lrp("replay", recorded(), "--from", "3", "--until", "1")
    assert done.exit_code == 2
    assert "--from 3 is after --until 1" in done.stderr
    assert "0.0 s, 1 tick; m/drive active" in lrp("replay", recorded(), "--until", "0").stdout


def test_initial_values_stay_after_a_recorded_edit_and_a_reset(lrp, program, tmp_path):
    from lrp_jupyter.language.edits.initials import with_initialiser
    from lrp_jupyter.language.parser import parse
    from lrp_jupyter.live.clock import VirtualClock
    from lrp_jupyter.live.running.commands import ReplaceProgram
    from lrp_jupyter.live.session import Session

    path, initials = tmp_path / "run.lrplog", {"n": "100"}
    other = with_initialiser(parse(TEXT.replace("[n += 1]", "[n += 2]"), "run.lrp"), "n", "100")
    first = with_initialiser(parse(TEXT, "run.lrp"), "n", "100")
    with (
        open(path, "w", encoding="utf-8") as stream,
        Session(first, "sim", VirtualClock(), world="line") as session,
    ):
        recorder = session.recorder(stream.write, initials=initials)
        session.run(0.5)
        session.ask(ReplaceProgram(other))
        session.reset()
        session.run(0.5)
        recorder.end()
    done = lrp("replay", path)
    assert (done.exit_code, "matches the recording" in done.stdout) == (0, True)


SETS = """(var order := [list({"a", "b", "c", "d", "e", "f"})])
(machine m
  (state one (running [robot.move(linear=0.01 * order.index("a"))]) (onexit [print(order)]))
  (state two)
  (ontime 200 one -> two))
(spawn m one)
"""


@pytest.mark.slow
def test_a_set_of_texts_has_its_order_in_a_replay_with_the_same_hashes(
    process, program, tmp_path, monkeypatch
):
    """With others the replay differs, and says why that may be."""
    file, log = program(SETS), tmp_path / "a.lrplog"
    monkeypatch.setenv("PYTHONHASHSEED", "1")
    process("run", file, "--for", "1", "--speed", "max", "--record", log).communicate()
    said = {}
    for seed in (1, 2):
        monkeypatch.setenv("PYTHONHASHSEED", str(seed))
        replay = process("replay", log)
        said[seed] = replay.communicate()[0].splitlines()[-1]
        assert replay.returncode == seed - 1
    assert said[1] == "The run matches the recording."
    assert "`PYTHONHASHSEED` to one number" in said[2]


ACTING = TEXT.replace("(running", "(onentry [from pathlib import Path; Path('acted').touch()]) (running")


@pytest.fixture
def foreign(recorded, here, monkeypatch, tmp_path_factory):
    """A recording of another person, and the file that its program makes when it runs."""
    path = recorded(text=ACTING)
    (here / "acted").unlink()
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path_factory.mktemp("another")))
    return path, here / "acted"


def test_the_program_of_another_person_runs_only_when_it_is_trusted(lrp, foreign):
    path, acted = foreign
    for arguments in (["replay", path], ["why", path, "bright"], ["replay", path, "--program", "follower"]):
        done = lrp(*arguments)
        assert done.exit_code == 2
        assert "contains a program that you have not recorded here" in done.stderr
        assert "It runs with `--trust`." in done.stderr
        assert not acted.exists()
    assert lrp("replay", path, "--trust").exit_code == 0
    acted.unlink()
    assert lrp("why", path, "bright", "--trust").exit_code == 0
    assert acted.exists()


@pytest.mark.slow
def test_at_a_terminal_it_is_asked_and_can_be_read_before_it_runs(terminal, foreign, monkeypatch):
    path, acted = foreign
    monkeypatch.setenv("PAGER", "cat")
    for answer in ("\r", "n\r", "what\r", "r\r\r"):
        asked = terminal("replay", path)
        asked.wait_for("Run it? [y/N, r to read it]")
        asked.press(answer)
        if answer[0] == "r":
            asked.wait_for("Path('acted').touch()")
        assert asked.end() == 2
        assert "matches" not in asked.text
    assert not acted.exists()
    asked = terminal("replay", path)
    asked.wait_for("Run it? [y/N, r to read it]")
    asked.press("y\r")
    asked.wait_for("The run matches the recording.")
    assert asked.end() == 0
    assert acted.exists()


@pytest.fixture
def watched(tmp_path):
    """The recording of a session whose user looked at something."""
    path = tmp_path / "participant-07.lrplog"
    with Session(TEXT, bridge="sim", world="line") as session:
        session.record_until_closed(path)
        session.run(1)
        session.looked("why", "transition m:bright")
        session.edit(TEXT.replace("[100]", "[90]"))
        session.looked("why", "transition m:bright", on=False)
        session.run(1)
        assert session.log == str(path)
    assert session.log == ""
    return path


def test_what_a_user_looked_at_is_listed_and_the_run_is_the_same_again(lrp, watched, tmp_path):
    assert "The run matches the recording." in lrp("replay", watched).stdout
    listed = [line.split("tick ")[1].split(maxsplit=1) for line in lrp("looks", watched).stdout.splitlines()]
    assert [
        (int(tick), " ".join(what.split())) for tick, what in listed if "why" in what or "edit" in what
    ] == [
        (10, "why transition m:bright"),
        (10, "input edit"),
        (10, "why transition m:bright, ended"),
    ]
    table = tmp_path / "looks.csv"
    assert lrp("looks", watched, "--out", table).exit_code == 0
    rows = list(csv.DictReader(table.read_text("utf-8-sig").splitlines()))
    assert [(row["about"], row["on"]) for row in rows if row["what"] == "why"] == [
        ("transition m:bright", "True"),
        ("transition m:bright", "False"),
    ]
    walls = [float(row["wall"]) for row in rows]
    assert walls == sorted(walls)


def test_a_recording_without_what_was_looked_at_says_how_to_make_one(lrp, recorded, watched, tmp_path):
    assert "does not say what its user looked at" in lrp("looks", recorded()).stdout
    assert lrp("looks", watched, "--out", tmp_path / "looks.txt").exit_code == 2
    text = watched.read_text().replace('"about":"transition', '"about":5,"was":"transition')
    watched.write_text(text)
    done = lrp("looks", watched)
    assert done.exit_code == 2
    assert "The field `about` is wrong: it is 5." in done.stderr
