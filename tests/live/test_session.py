import builtins
import math
import os
from dataclasses import replace
from types import MappingProxyType

import pytest

from lrp_jupyter.errors import BridgeError, LRPError, LRPSyntaxError, SessionClosedError, UnknownElementError
from lrp_jupyter.language.half_typed import Cursor
from lrp_jupyter.live import session as sessions
from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.running.commands import Call, Reset
from lrp_jupyter.live.session import Session

BLINK = """
(var n := [0])
(machine light
  (state on (running [n = n + 1]))
  (state off)
  (ontime 500 on -> off)
  (ontime 200 off -> on again))
(spawn light on)
(onpause [print("paused")]) (onresume [print("resumed")])
"""
ON, OFF = ("light", "on"), ("light", "off")


def times(session, seconds, **options):
    """Run, and return the times of the ticks."""
    seen = []
    session.interpreter.observe(lambda event: seen.append(event.now))
    session.run(seconds, **options)
    return sorted(set(seen))


COUNT = "(var n := [0]) (machine m (state a (running [n = n + 1]))) (spawn m a)"


# -- time


def test_a_run_ticks_at_the_beginning_of_each_period(session):
    counting = session(COUNT)
    assert times(counting, 0.5) == [0.0, 0.1, 0.2, 0.3, 0.4]
    assert (counting.frame.time, counting.frame.tick) == (0.5, 5)


@pytest.mark.parametrize("rate", [1, 3, 10, 40, 1000])
def test_a_run_ticks_at_its_rate(session, rate):
    counting = session(COUNT, rate=rate)
    counting.run(2)
    assert counting.frame.tick == 2 * rate


def test_ten_steps_are_a_run_of_a_second(session):
    stepped, ran = session(BLINK), session(BLINK)
    for _ in range(10):
        stepped.step()
    ran.run(1)
    assert (stepped.frame.time, stepped.frame.variables) == (ran.frame.time, ran.frame.variables)
    assert stepped.frame.fired == ran.frame.fired


def test_two_runs_are_as_good_as_one(session):
    twice, once = session(BLINK), session(BLINK)
    for _ in range(7):
        twice.run(0.35)
    once.run(2.45)
    assert twice.frame.tick == once.frame.tick
    assert twice.frame.fired == once.frame.fired


def test_at_rate_0_a_run_ticks_at_every_step_of_virtual_time(session):
    counting = session(COUNT, rate=0)
    counting.run(1)
    assert counting.frame.tick == 100


def test_a_run_ends_at_the_state_it_runs_to(session):
    blinking = session(BLINK)
    assert blinking.run(until="off")
    assert blinking.frame.active == (OFF,)
    assert blinking.frame.time == 0.5


def test_a_run_that_does_not_get_there_reports_it(session):
    assert not session(BLINK).run(0.4, until=OFF)


def test_a_state_that_is_active_only_between_two_frames_ends_a_run(session):
    passing = session(
        "(machine m (state a) (state b (onentry (spawn n x)) (machine n (state x))) (eps a -> b)) (spawn m a)"
    )
    assert passing.run(1, until="m/b/n/x")


def test_a_run_ends_when_a_condition_on_the_frame_holds(session):
    counting = session(COUNT)
    assert counting.run(9, until=lambda frame: frame.numbers[("n",)] >= 3)
    assert counting.frame.variables == {("n",): "3"}


def test_a_run_without_an_end_is_refused(session):
    with pytest.raises(ValueError, match="How long should it run"):
        session(COUNT).run()


def test_the_rate_can_change_while_a_program_runs(session):
    counting = session(COUNT)
    counting.run(1)
    counting.rate = 100
    counting.run(1)
    assert counting.frame.tick == 10 + 100
    assert counting.frame.rate == 100


def test_a_higher_rate_does_not_wait_for_the_tick_of_the_lower_one(session):
    counting = session(COUNT, rate=0.1)
    counting.run(1)
    counting.rate = 10
    counting.run(1)
    assert counting.frame.tick == 10


@pytest.mark.parametrize("rate", [-1, math.nan, math.inf])
def test_a_rate_that_is_none_is_refused_and_breaks_nothing(session, rate):
    counting = session(COUNT)
    with pytest.raises(ValueError, match="rate"):
        counting.rate = rate
    assert counting.run(1)


# -- pause and step


def test_a_step_is_one_tick_and_one_period(session):
    counting = session(COUNT, rate=4)
    counting.step()
    counting.step()
    assert (counting.frame.tick, counting.frame.time, counting.frame.status) == (2, 0.5, "paused")


@pytest.mark.parametrize("end", ["until", "after_tick"])
@pytest.mark.parametrize("error", [ValueError, SystemExit, KeyboardInterrupt])
def test_what_the_condition_of_a_run_raises_reaches_the_caller_and_breaks_nothing(session, end, error):
    def fail(*_):
        raise error

    made = session("(machine m (state a)) (spawn m a)")
    with pytest.raises(error):
        made.run(1, **{end: fail})
    assert (made.status, made.frame.tick, made.fault) == ("paused", 1, "")
    assert made.run(1)


def test_a_listener_is_notified_of_new_frames_until_it_unsubscribes(session):
    lab = session(BLINK)
    ticks = []
    unlisten = lab.listen(lambda: ticks.append(lab.frame.tick))
    lab.step()
    assert ticks[-1] == 1
    unlisten()
    lab.step()
    assert ticks[-1] == 1


def test_a_block_may_pause_its_own_session_and_the_tick_is_completed(session):
    names = {}
    pausing = session(
        "(var n := [0]) (machine m (state a (running [session.pause('enough')] [n = 1]))) (spawn m a)",
        namespace=names,
    )
    names["session"] = pausing
    assert not pausing.run(5)
    frame = pausing.frame
    assert (frame.status, frame.reason, frame.tick, frame.variables) == (
        "paused",
        "enough",
        1,
        {("n",): "1"},
    )


def test_pausing_runs_the_pause_actions_once(session):
    names = {}
    text = BLINK.replace("[n = n + 1]", "[n = n + 1] [session.pause() if n == 2 else None]")
    blinking = session(text, namespace=names)
    names["session"] = blinking
    blinking.run(5)
    blinking.pause()
    assert str(blinking.output) == "paused\n"
    blinking.resume()
    assert str(blinking.output) == "paused\nresumed\n"


def test_on_issue_pause_completes_the_tick_and_pauses(session):
    failing = session(
        "(var n := [0]) (machine m (state a (running [1 / 0] [n = n + 1]))) (spawn m a)", on_issue="pause"
    )
    assert not failing.run(5)
    frame = failing.frame
    assert (frame.status, frame.tick, frame.variables) == ("paused", 1, {("n",): "1"})
    assert "ZeroDivisionError" in frame.reason
    assert frame.paused_by is frame.issues[0]
    failing.run(1)
    assert failing.frame.issues[0].count > 1


# -- edits


def test_an_issue_of_a_command_pauses_at_once_and_a_resume_goes_on(session):
    made = session(
        "(machine m (state a (onexit [1 / 0])) (state b) (ontime 9000 a -> b)) (spawn m a)", on_issue="pause"
    )
    made.run(0.2)
    made.resume()
    made.transition_to("b")
    assert (made.status, made.frame.reason) == ("paused", "ZeroDivisionError: division by zero")
    made.resume()
    assert (made.status, made.frame.paused_by) == ("running", None)
    assert made.run(1), "nothing else pauses it"


def test_an_edit_continues_from_where_the_program_is(session):
    blinking = session(BLINK)
    blinking.run(0.6)
    assert blinking.edit(BLINK.replace("200 off", "[150 + 50] off")) == ()
    assert blinking.frame.active == (OFF,)
    assert (blinking.frame.restarts, blinking.frame.revision) == (0, 1)


def test_a_text_that_is_not_a_program_leaves_the_old_one_running(session):
    blinking = session(BLINK)
    blinking.run(0.6)
    broken = BLINK.replace("(spawn light on)", "(spawn light on")
    findings = blinking.edit(broken)
    assert [finding.severity for finding in findings][:1] == ["error"]
    assert (blinking.text, blinking.program.text) == (broken, BLINK)
    assert blinking.findings == findings
    assert blinking.run(1, until="on")


def test_an_edit_before_the_start_is_what_starts(session):
    editing = session("")
    editing.edit(BLINK)
    assert editing.run(1, until="on")
    assert editing.frame.restarts == 0


def test_the_reason_of_a_restart_is_in_the_frame(session):
    blinking = session(BLINK)
    blinking.run(0.2)
    blinking.edit(BLINK.replace("n + 1", "n + 2"))
    assert blinking.frame.restarts == 1
    assert "`on`" in blinking.frame.restart_reason
    assert blinking.frame.active == ()


def test_with_the_policy_keep_nothing_restarts(session):
    blinking = session(BLINK)
    blinking.on_active_edit = "keep"
    blinking.run(0.2)
    blinking.edit(BLINK.replace("n + 1", "n + 100"))
    blinking.run(0.2)
    assert blinking.frame.numbers[("n",)] == 202
    assert blinking.frame.restarts == 0


def test_names_of_the_namespace_are_not_findings(session):
    text = "(machine m (state a (running [helpful()]))) (spawn m a)"
    assert session("", namespace={"helpful": print}).edit(text) == ()
    assert session("").edit(text) != ()


def test_the_namespace_is_used_as_it_is_and_never_written(session):
    names = {"start": 3}
    counting = session(COUNT.replace("[0]", "[start]").replace("n + 1", "n + start"), namespace=names)
    counting.run(0.2)
    assert counting.frame.numbers[("n",)] == 9
    names["start"] = 10
    counting.run(0.1)
    assert counting.frame.numbers[("n",)] == 19
    assert names == {"start": 10, "__builtins__": builtins}, "as `exec` adds it"


def test_functions_of_c_that_import_modules_work_in_a_block(session):
    pytest.importorskip("numpy")
    text = """(var n := [0])
    (machine m (state a (running [import numpy; n = int(numpy.array([1, 2]).sum())])))
    (spawn m a)"""
    for names in (None, {"other": 1}):
        summing = session(text, namespace=names)
        summing.run(0.3)
        assert (summing.frame.numbers[("n",)], summing.issues) == (3, ())
        with summing.fork() as fork:
            fork.run(0.1)
            assert fork.issues == ()


def test_a_session_does_not_start_with_a_text_that_is_not_a_program():
    with pytest.raises(LRPSyntaxError):
        Session("(machine")


def test_the_text_is_saved_to_the_letter(session, tmp_path):
    editing = session("")
    text = "; ünder\r\n(machine m (state a))\r(spawn m a)\n\n; not yet ("
    editing.edit(text)
    editing.save(tmp_path / "m.lrp")
    assert (tmp_path / "m.lrp").read_bytes() == text.encode()


def test_a_rename_changes_the_text_and_restarts_nothing(session):
    blinking = session(BLINK)
    blinking.run(0.2)
    text = blinking.rename("state", "light/on", "bright")
    assert (
        blinking.text
        == text
        == BLINK.replace(" on ", " bright ").replace(" on)", " bright)").replace("-> on", "-> bright")
    )
    assert blinking.frame.active == (("light", "bright"),)
    assert blinking.frame.restarts == 0


@pytest.mark.parametrize("text", [BLINK + "(", "(machine light (state blue))"])
def test_nothing_is_renamed_while_the_text_does_not_run(session, text):
    blinking = session(BLINK)
    blinking.run(0.2)
    blinking.edit(text)
    with pytest.raises(ValueError, match="not the running program"):
        blinking.rename("state", "light/on", "bright")
    assert blinking.text == text


# -- forcing


@pytest.mark.parametrize("state", ["off", "light/off", OFF])
def test_a_state_is_forced_by_name_or_path(session, state):
    blinking = session(BLINK)
    blinking.run(0.1)
    blinking.transition_to(state)
    assert blinking.frame.active == (OFF,)
    blinking.teleport_to(ON)
    assert blinking.frame.active == (ON,)


def test_forcing_an_unknown_state_is_an_issue_and_changes_nothing(session):
    blinking = session(BLINK)
    blinking.run(0.1)
    blinking.transition_to("of")
    assert blinking.frame.active == (ON,)
    (issue,) = blinking.issues
    assert issue.kind == "unknown state"


@pytest.mark.parametrize("transition", ["go", "light/go", ("light", "go"), "light:go"])
def test_a_transition_is_fired_by_name_or_path(session, transition):
    waiting = session("(machine light (state on) (state off) (on [False] on -> off go)) (spawn light on)")
    waiting.run(0.1)
    waiting.fire(transition)
    assert waiting.frame.active == (OFF,)
    assert str(waiting.why("off")) == "`off` was entered at 0.1 s by hand (fire), not by the program."
    with pytest.raises(ValueError, match="None of the states that `go` leaves is active: on"):
        waiting.fire(transition)


def test_a_variable_is_set_by_an_expression_in_its_scope(session):
    blinking = session(BLINK)
    blinking.run(0.2)
    blinking.set_variable("n", "n * 100")
    assert blinking.frame.variables[("n",)] == "200"


def test_an_expression_that_fails_changes_nothing(session):
    blinking = session(BLINK)
    blinking.run(0.2)
    with pytest.raises(ZeroDivisionError):
        blinking.set_variable("n", "n / 0")
    with pytest.raises(SyntaxError):
        blinking.set_variable("n", "n = 3")
    with pytest.raises(UnknownElementError):
        blinking.set_variable("m", "3")
    assert blinking.frame.variables[("n",)] == "2"
    assert blinking.run(1)


# -- going back


def test_rewinding_and_running_again_is_the_same_run(session):
    blinking = session(BLINK)
    blinking.run(2)
    before = (blinking.frame.active, blinking.frame.variables, blinking.frame.time)
    blinking.rewind(13)
    assert blinking.frame.tick == 7
    for _ in range(13):
        blinking.step()
    assert (blinking.frame.active, blinking.frame.variables, blinking.frame.time) == before


def test_rewinding_undoes_edits_and_restores_the_text(session):
    blinking = session(BLINK)
    blinking.run(0.5)
    blinking.edit(BLINK.replace("200", "300"))
    blinking.run(0.5)
    blinking.rewind(6)
    assert blinking.text == blinking.program.text == BLINK


def test_rewinding_to_before_the_start_leaves_nothing_active(session):
    blinking = session(BLINK)
    blinking.run(0.5)
    blinking.rewind(5)
    assert (blinking.frame.active, blinking.frame.time, blinking.frame.tick) == ((), 0.0, 0)


def test_rewinding_too_far_is_refused_and_changes_nothing(session):
    blinking = session(BLINK, journal=3)
    blinking.run(1)
    with pytest.raises(ValueError, match="only 3 can be undone"):
        blinking.rewind(4)
    assert blinking.frame.tick == 10


# -- output, values, end


def test_what_blocks_print_is_kept_and_counted_and_never_on_stdout(session, capsys):
    talking = session("(machine m (state a (onentry [print('a', 1, sep='-')]))) (spawn m a)")
    talking.run(1)
    assert talking.output.since(0) == (1, ("a-1",))
    assert talking.frame.printed == 1
    assert capsys.readouterr() == ("", "")


def test_a_program_without_a_spawn_runs_and_does_nothing(session):
    idle = session("(machine m (state a))")
    assert idle.run(1)
    assert idle.frame.active == ()


def test_a_closed_session_keeps_its_text_and_frame_and_refuses_the_rest(session):
    blinking = session(BLINK)
    blinking.run(0.3)
    blinking.close()
    blinking.close()
    assert (blinking.status, blinking.frame.tick, blinking.text) == ("closed", 3, BLINK)
    for call in (blinking.start, blinking.step, blinking.pause, lambda: blinking.run(1)):
        with pytest.raises(SessionClosedError):
            call()


def test_a_session_closes_at_the_end_of_a_with_statement():
    with Session(BLINK) as blinking:
        blinking.run(1)
    assert blinking.status == "closed"


def test_a_fault_of_our_own_breaks_the_session_and_reports_it(session, monkeypatch):
    blinking = session(BLINK)
    blinking.run(0.3)
    monkeypatch.setattr(type(blinking.interpreter), "step", lambda *_: {}["our own mistake"])
    blinking.run(1)
    frame = blinking.frame
    assert (frame.status, frame.issues) == ("broken", ())
    assert "The session itself failed, not the program" in frame.reason
    assert "our own mistake" in blinking.fault
    with pytest.raises(LRPError, match="The session itself failed"):
        blinking.step()


def test_an_unknown_bridge_is_refused_by_name():
    with pytest.raises(BridgeError, match="simm"):
        Session(BLINK, "simm")


def test_frames_do_not_change_when_the_run_continues(session):
    blinking = session(BLINK)
    blinking.run(0.6)
    before = blinking.frame
    fired = dict(before.fired)
    blinking.run(3)
    assert isinstance(before.fired, MappingProxyType)
    assert dict(before.fired) == fired
    assert blinking.frame.fired != fired


def test_a_virtual_clock_serves_a_session(session):
    clock = VirtualClock()
    blinking = session(BLINK, clock=clock)
    blinking.run(1)
    assert clock.now() == 1


def test_a_text_can_be_offered_without_waiting_for_its_patch(session):
    s = session("(machine m (state a)) (spawn m a)")
    s.step()
    judgement, answer = s.offer("(machine m (state a) (state b)) (spawn m a)")
    assert answer.result(0).applied
    assert s.program is judgement.program
    judgement, answer = s.offer("(machine m")
    assert judgement.program is None
    assert answer.result(0) is None
    assert [finding.severity for finding in s.findings] == ["error"]


def test_a_text_that_a_block_offers_is_answered_when_it_is_applied_after_the_tick(session):
    text = "(machine m (state a (onentry [edit()]))) (spawn m a)"
    offered = []
    s = session(text, namespace={"edit": lambda: offered.append(s.offer(text + "(var n := [1])"))})
    s.step()
    [(judgement, answer)] = offered
    assert not answer.done()
    s.step()
    assert answer.result(0).applied
    assert s.program is judgement.program


@pytest.mark.parametrize("fault", [KeyError, TypeError, ValueError])
def test_a_fault_of_our_own_in_a_command_breaks_the_session_too(session, monkeypatch, fault):
    def mistake(*_):
        raise fault("our own mistake")

    blinking = session(BLINK)
    blinking.run(0.3)
    monkeypatch.setattr(type(blinking.interpreter), "reset", mistake)
    with pytest.raises(fault):
        blinking.reset()
    assert blinking.status == "broken"
    assert "our own mistake" in blinking.fault


def test_a_fault_of_our_own_in_a_queued_command_breaks_the_session_too(session, monkeypatch):
    blinking = session(BLINK)
    blinking.run(0.3)
    monkeypatch.setattr(type(blinking.interpreter), "reset", lambda *_: {}["our own mistake"])
    first, second = blinking.submit(Reset()), blinking.submit(Reset())
    with pytest.raises(LRPError, match="The session itself failed"):
        blinking.run(0.1)
    assert isinstance(first.exception(0), KeyError)
    assert isinstance(second.exception(0), LRPError)
    assert "our own mistake" in blinking.fault


def test_a_fault_of_the_checks_blocks_no_edit_and_is_reported_as_ours(session, monkeypatch):
    blinking = session("")
    monkeypatch.setattr(sessions, "check", lambda *_: {}["our own mistake"])
    (finding,) = blinking.edit(BLINK)
    assert (finding.code, finding.severity) == ("LRP699", "warning")
    assert blinking.run(1, until="off")


def test_a_keyboard_interrupt_ends_a_run_and_leaves_the_session_usable(session):
    def give_up():
        raise KeyboardInterrupt

    stopping = session(BLINK.replace("[n = n + 1]", "[give_up()]"), namespace={"give_up": give_up})
    with pytest.raises(KeyboardInterrupt):
        stopping.run(5)
    assert stopping.frame.status == "paused"
    stopping.edit(BLINK)
    assert stopping.run(2, until="off")


def test_a_keyboard_interrupt_in_a_queued_command_ends_the_run_that_applies_it(session):
    def give_up():
        raise KeyboardInterrupt

    stopping = session(BLINK)
    refused = stopping.submit(Call(give_up))
    later = stopping.submit(Reset())
    with pytest.raises(KeyboardInterrupt):
        stopping.run(5)
    assert isinstance(refused.exception(0), KeyboardInterrupt)
    assert stopping.run(2, until="off")
    assert later.result(0) is None


@pytest.mark.parametrize("speed", [5e-324, 1e-308, 1e-9, 1e9, 1e308])
def test_a_session_survives_every_speed(session, speed):
    counting = session(BLINK, rate=100)
    counting.start()
    counting.speed = speed
    counting.step()
    counting.resume()
    counting.speed = 1
    assert counting.wait_for("off", 120)
    assert counting.fault == ""


@pytest.mark.parametrize("rate", [1e7, 1e308, 10**400])
def test_a_rate_at_which_no_time_would_pass_is_refused(session, rate):
    with pytest.raises(ValueError, match="A rate is between"):
        session(BLINK).rate = rate


def test_a_run_inside_a_block_is_refused_with_the_reason(session):
    running = session(
        "(machine m (state a (running [run()]))) (spawn m a)", namespace={"run": lambda: running.run(1)}
    )
    running.run(0.2)
    (issue,) = running.issues
    assert "`run` cannot be called by a block of the program" in issue.message
    assert running.frame.tick == 2


def test_a_name_is_the_same_name_in_every_way_to_write_it(session):
    micro, mu = "\N{MICRO SIGN}", "\N{GREEK SMALL LETTER MU}"
    text = f"(var {micro} := [0]) "
    text += f"(machine m (state {micro} (running [{mu} = {micro} + 1])) (state b)) (spawn m {micro})"
    running = session(text)
    assert running.run(1, until=micro)
    assert running.frame.is_active(f"m/{micro}")
    assert running.frame.count_of(f"m/{mu}") == running.frame.count_of(f"m/{micro}") == 1
    running.transition_to("m/b")
    running.transition_to(micro)
    running.set_variable(micro, "7")
    assert running.frame.variables[mu,] == "7"
    running.rename("state", f"m/{micro}", "c")
    running.rename("state", "m/c", micro)
    assert (running.frame.active, running.issues) == ((("m", mu),), ())


NAMED = "(var n := [1]) (machine m (var k := [[1, 2]]) (state a) (state b) (ontime 300 a -> b)) (spawn m a)"


def test_a_frame_has_values_beside_their_texts_by_name(session):
    named = session(NAMED)
    named.step()
    assert (named.frame.values["n"], named.frame.values["k"], named.frame.values["m/k"]) == (
        1,
        [1, 2],
        [1, 2],
    )
    assert (named.frame.variables["n"], named.frame.variables["k"]) == ("1", "[1, 2]")
    assert named.frame.numbers["n"] == 1.0
    assert named.run(1, until=lambda frame: frame.values["n"] > 0)


def test_a_variable_is_set_to_a_value_to_a_text_and_by_an_expression(session):
    named = session(NAMED)
    named.step()
    named.set_variable("n", 5)
    named.set_variable("m/k", evaluate="k + [n]")
    assert (named.variables["n"], named.variables["k"]) == (5, [1, 2, 5])
    named.set_variable("n", "n + 1")  # an expression, as ever
    assert named.variables["n"] == 6
    named.variables["n"] = "n + 1"
    assert named.variables["n"] == "n + 1"
    named.set_variable("k", None)
    assert named.variables == named.frame.values == {("n",): "n + 1", ("m", "k"): None}
    assert repr(named.variables) == "n = 'n + 1'\nm/k = None"


def test_a_value_that_is_set_is_taken_back_by_rewinding(session):
    named = session(NAMED)
    named.step()
    named.step()
    named.set_variable("n", 5)
    named.step()
    named.rewind(2)
    assert named.variables["n"] == 1


@pytest.mark.parametrize(("arguments", "options"), [((), {}), ((5,), {"evaluate": "5"})])
def test_a_variable_is_set_to_either_a_value_or_an_expression(session, arguments, options):
    named = session(NAMED)
    named.step()
    with pytest.raises(TypeError, match="Pass either a value or `evaluate`"):
        named.set_variable("n", *arguments, **options)


def test_a_word_does_not_wait_for_what_the_world_has_lost_meanwhile(session):
    text = (
        "(var n := [1]) (machine m (state a (running [n])) (on [robot.distance.data > 1] a -> a)) (spawn m a)"
    )
    s = session(text, bridge="sim")
    s.step()
    at = text.index("[n]") + 2
    assert (
        s.judge(text.replace("[n]", "[q]"), Cursor(at)).unmeant is not None
    )  # the running program is checked
    world = s.bridge.world
    s.bridge.load_world(replace(world, robots=(replace(world.robots[0], distance=()),)))
    judgement = s.judge(text.replace("[n]", "[3 + n]"), Cursor(at + 4))
    assert judgement.unmeant is None
    assert [finding.code for finding in judgement.findings] == ["LRP520"]


IN_A_BLOCK = {
    "animation": (),
    "at": (1,),
    "call": (int,),
    "check": ("x",),
    "edit": ("x",),
    "explain": ("t",),
    "fire": ("t",),
    "fork": (),
    "from_file": (__file__,),
    "judge": ("x",),
    "listen": (int,),
    "looked": ("x",),
    "observe": (print,),
    "offer": ("x",),
    "offer_rename": ("state", ("m", "a"), "z"),
    "on_tick": (int,),
    "pause_when": ("a",),
    "plots": (["n"],),
    "record": (os.devnull,),
    "record_until_closed": None,  # as `record`
    "recorder": (print,),
    "remove_breakpoint": (1,),
    "rename": ("state", "m/a", "q"),
    "run": (1,),
    "save": (os.devnull,),
    "set_breakpoint": (1,),
    "set_variable": ("n", 1),
    "teleport_to": ("b",),
    "timeline": (),
    "transition_to": ("b",),
    "try_programs": (["x"],),
    "try_values": ("n", [1], 1),
    "wait_for": ("a",),
    "what_if": (),
    "why": ("a",),
    "why_not": ("t",),
    "driving": (1,),
    "interrupt": None,  # which ends the block
}
"""The arguments with which a block calls a method of its session; those without any are not here."""
OF_LATER = {
    "at",
    "explain",
    "why",
    "why_not",
    "coverage",
    "keep",
    "fork",
    "what_if",
    "try_programs",
    "try_values",
    "timeline",
    "plots",
    "animation",
}
"""The methods whose answer is known only between two ticks."""


def test_what_a_block_cannot_ask_its_session_is_refused_in_a_sentence_and_nothing_else_leaks():
    called = []

    def act():
        for name in sorted(name for name in dir(Session) if not name.startswith("_")):
            arguments = IN_A_BLOCK.get(name, ())
            if called.count(name) or arguments is None or name in ("stop", "close"):
                continue
            called.append(name)
            try:
                member = getattr(session, name)
                result = member(*arguments) if callable(member) else member
                if name == "record":
                    with result:
                        pass
                told[name] = None
            except Exception as error:
                told[name] = error

    told = {}
    text = (
        "(var n := [0]) (machine m (state a (running [act()])) (state b) (on [False] a -> b t)) (spawn m a)"
    )
    with Session(text, namespace={"act": act}) as session:
        session.run(0.3)
        assert (session.fault, session.issues) == ("", ())
    refused = {name for name, error in told.items() if "cannot be called by a block" in str(error)}
    assert refused == OF_LATER | {"run", "record", "wait_for"}
    for name, error in told.items():
        assert error is None or isinstance(error, LRPError | ValueError), name
        assert name not in refused or str(error).startswith(f"`{name}` cannot be called"), name
