"""The live display: its lines, and the whole of it in a pseudo terminal."""

import signal
from dataclasses import replace

import pytest
from support.waiting import until

from lrp_jupyter.cli.board import BoardState, board_text
from lrp_jupyter.cli.map import columns_for
from lrp_jupyter.live.running.frame import Hung
from lrp_jupyter.live.session import Session

NESTED = """(var speed := [0.2])
(machine outer
  (state a (onentry (spawn inner x)) (machine inner (var n := [3]) (state x)))
  (state b (running [1 / 0]))
  (ontime 300 a -> b))
(machine other (state o))
(spawn outer a) (spawn other o)
"""


def state_after(seconds, **more):
    with Session(NESTED) as session:
        session.run(seconds)
        return BoardState(frame=session.frame, name="my", where="none", **more)


def text_of(state, width=100, rows=None):
    return [str(line).rstrip() for line in board_text(state, width, rows)]


def test_every_active_state_has_a_line_with_its_machine_and_since_when():
    lines = text_of(state_after(0.25, since={("outer", "a"): 0.0, ("other", "o"): 0.1}))
    assert lines[3].split() == ["outer", "a", "0.2", "s"]
    assert lines[4].split() == ["inner", "x"]
    assert lines[4].startswith("  inner")
    assert lines[5].split()[:2] == ["other", "o"]


def test_variables_have_short_names_and_values():
    lines = text_of(state_after(0.2))
    assert ["speed", "0.2"] in [line.split() for line in lines]
    assert ["inner/n", "3"] in [line.split() for line in lines]


def test_variables_of_two_instances_have_names_that_tell_them_apart():
    with Session(
        "(machine follow (var side := [1]) (state x))"
        "(machine m (state a (onentry (spawn follow x (var side := [2])))))"
        "(machine k (state a (onentry (spawn follow x)))) (spawn m a) (spawn k a)"
    ) as session:
        session.step()
        lines = [line.split() for line in text_of(BoardState(frame=session.frame))]
    assert ["m/a/follow/side", "2"] in lines
    assert ["k/a/follow/side", "1"] in lines


def test_the_transition_that_fired_last_stands_out_from_those_before_it():
    lines = board_text(state_after(0.2, last=("0.3 s  b → a", "0.2 s  a → b", "0.1 s  b → a")), 60)
    assert [str(line.style) for line in lines if "→" in line.plain] == ["bold", "dim", "dim"]


def test_nothing_jumps_when_states_and_variables_go():
    rows = {}
    before = text_of(state_after(0.2), rows=rows)
    after = text_of(state_after(0.4), rows=rows)
    assert before.index(next(line for line in before if "speed" in line)) == after.index(
        next(line for line in after if "speed" in line)
    )


def test_an_issue_is_shown_with_its_line_and_a_caret():
    lines = text_of(state_after(1))
    place = next(number for number, line in enumerate(lines) if "LRP601" in line)
    assert "4:22" in lines[place]
    assert "(7 times)" in lines[place]
    assert lines[place + 1] == "    4 |   (state b (running [1 / 0]))"
    assert lines[place + 2].endswith("^")


def test_the_map_is_beside_in_a_wide_terminal_and_below_in_a_narrow_one():
    state = state_after(0.1, map=["  →", "###"])
    wide, narrow = text_of(state, 100), text_of(state, 60)
    assert any("outer" in line and "┌───┐" in line for line in wide)
    assert "┌───┐" in narrow
    assert all(len(line) < 60 for line in narrow)


def test_the_header_shows_what_is_unusual():
    state = state_after(0.1)
    frame = replace(state.frame, status="hung", reason="`a` has run for 2 s.", restarts=2, achieved_speed=0.5)
    (header,) = [line for line in text_of(replace(state, frame=frame)) if "tick" in line]
    for words in ("my", "0.1 s", "tick 1", "0.5x real time", "2 restarts", "hung: `a` has run for 2 s."):
        assert words in header


def test_the_key_that_interrupts_a_block_is_named_while_one_hangs():
    from dataclasses import replace

    state = replace(state_after(0.1), keys=True)
    assert not any("interrupt" in line for line in text_of(state))
    hanging = replace(state, frame=replace(state.frame, hung=Hung("a.running", 3.0)))
    assert any("i: interrupt the block" in line for line in text_of(hanging))


def test_a_map_fits_into_its_room():
    assert columns_for((3, 1), 72, 30) == 72
    assert columns_for((3, 1), 72, 5) == 30
    assert columns_for((1, 3), 72, 1) == 1


# -- in a terminal


@pytest.mark.slow
def test_the_board_shows_a_run_and_obeys_the_keys(terminal):
    run = terminal("run", "follower", "--speed", "4")
    for words in ("▶ follower", "lookalgo", "┌──", "lightlim", "space: pause"):
        run.wait_for(words)
    run.press(" ")
    run.wait_for("⏸ follower")
    run.press("s")
    run.wait_for("⏸ follower")
    run.press("r")
    run.wait_for("1 restart")
    run.press("q")
    run.wait_for("\x1b[?25h")  # the cursor is back
    run.wait_for("active\r\n")
    assert run.end() == 0


@pytest.mark.slow
def test_a_block_that_does_not_return_is_interrupted_by_a_key(terminal, program):
    path = program("(machine m\n  (state a (running [while True: pass])))\n(spawn m a)\n")
    run = terminal("run", path, "--bridge", "none")
    run.wait_for("hung: `a.running` has run for")
    run.wait_for("(line 2)")
    run.wait_for("i: interrupt the block")
    run.press("i")
    run.wait_for("LRP611")
    run.press("q")
    run.wait_for("1 issue")
    assert run.end() == 0


@pytest.mark.slow
@pytest.mark.parametrize("speed", ["1", "max"])
def test_ctrl_c_in_a_terminal_ends_the_run(terminal, speed):
    run = terminal("run", "two-machines", "--speed", speed, columns=60, rows=20)
    run.wait_for("two-machines")
    run.wait_for("hand")
    run.press("\x03")
    run.wait_for("two-machines: ")  # the line about the whole run, of one tick or more
    assert run.end() == 130


@pytest.mark.slow
def test_what_is_printed_scrolls_above_the_board(terminal, program):
    path = program('(machine m (state a (onentry [print("hello", 6 * 7)]))) (spawn m a)')
    run = terminal("run", path, "--watch")
    run.wait_for("hello 42")
    path.write_text("(machine")
    run.wait_for("saved: not a valid program; the last one keeps running")
    run.wait_for("LRP101")
    run.wait_for("▶ my")
    run.press("q")
    assert run.end() == 0


@pytest.mark.slow
def test_a_dumb_terminal_gets_plain_lines(terminal):
    run = terminal("run", "exit", "--speed", "max", "--for", "5", term="dumb")
    run.wait_for("walker/walking")
    assert run.end() == 0
    assert "┌──" not in run.read()


def test_the_board_says_that_the_file_on_disk_is_not_what_runs():
    state = state_after(0.1)
    differs = "The file on disk is not what runs: it has errors."
    shown, usual = (text_of(replace(state, differs=words)) for words in (differs, ""))
    assert shown[2] == differs
    assert len(shown) == len(usual)
    assert differs not in usual


def test_the_board_says_why_the_robot_does_not_move():
    trouble, differs = "`robot.light.data` is stale: its value is 1.4 s old.", "The file has errors."
    shown = text_of(state_after(0.1, trouble=trouble))
    assert shown[2] == trouble
    assert text_of(state_after(0.1, trouble=trouble, differs=differs))[2] == f"{differs}  {trouble}"


@pytest.mark.slow
def test_a_run_ends_by_q_in_a_terminal_that_was_halted(terminal):
    run = terminal("run", "follower")
    run.wait_for("follower")
    run.press("\x13q")  # Ctrl-S
    until(lambda: run.process.poll() is not None, "it does not end")
    assert run.process.returncode == 0


@pytest.mark.slow
def test_a_run_whose_terminal_was_closed_ends_as_by_the_signal(terminal):
    run = terminal("run", "follower")
    run.wait_for("follower")
    run.hang_up()
    assert run.process.wait(120) == 128 + signal.SIGHUP


@pytest.mark.slow
def test_a_run_may_write_to_the_terminal_of_another_session(terminal):
    run = terminal("run", "exit", "--for", "0.2", is_own=False)
    assert run.end() == 0, run.text
