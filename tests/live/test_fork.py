"""A fork is the session as it was, goes on as it did, and the session does not notice."""

import random

import pytest
from support.sessions import seen

from lrp_jupyter.errors import SessionTimeoutError
from lrp_jupyter.language.program import Element
from lrp_jupyter.live import questions
from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.past.fork import private_namespace
from lrp_jupyter.live.running import checkpoints
from lrp_jupyter.live.running.loop import Loop
from lrp_jupyter.live.session import Session

COUNTER = "(var n := [0])(machine m (state a (running [n += 1])))(spawn m a)"


def test_what_a_rewind_has_undone_is_in_no_fork(monkeypatch):
    monkeypatch.setattr(checkpoints, "_SHARE", 0)  # one every 200 ticks, however long it takes
    with Session(COUNTER, clock=VirtualClock()) as session:
        session.run(20)
        session.variables["n"] = 1000
        session.run(0.5)
        session.rewind(5)
        session.run(0.5)
        assert session.frame.values["n"] == 205
        assert session.at(205).values["n"] == 205
        with session.fork(205) as fork:
            assert fork.frame.values["n"] == 205


def test_a_fork_is_as_a_tick_ended_though_a_checkpoint_was_taken_later_before_the_next(monkeypatch):
    monkeypatch.setattr(checkpoints, "_SHARE", 0)
    with Session(COUNTER, clock=VirtualClock()) as session:
        session.run(20)
        session.variables["n"] = 1000
        session.run(0.5)
        assert session._loop.record.checkpoints.all[-1].tick == 200
        with session.fork(200) as fork:
            assert fork.frame.values["n"] == session.at(200).values["n"] == 200
        with session.fork(200, inputs=True) as fork:
            fork.run(0.5)
            assert fork.frame.values["n"] == session.frame.values["n"] == 1005


def test_a_fork_of_the_beginning_is_as_the_first_tick_began():
    with Session(COUNTER, clock=VirtualClock()) as session:
        session.edit(COUNTER.replace("n += 1", "n += 7"))
        session.run(0.5)
        with session.fork(0) as fork, session.fork(0, inputs=True) as repeated:
            for each in (fork, repeated):
                each.run(0.5)
                assert each.frame.values == session.frame.values


def test_a_fork_after_a_rewind_to_the_beginning_has_the_program_of_the_session():
    with Session(COUNTER, clock=VirtualClock()) as session:
        session.edit(COUNTER.replace("n += 1", "n += 7"))
        session.run(0.5)
        session.rewind(5)
        session.run(0.5)
        with session.fork(5) as fork:
            assert fork.program.text == session.program.text
            assert fork.frame.values == session.frame.values


def test_the_rate_and_the_policies_that_a_rewind_keeps_are_those_of_a_fork():
    with Session(COUNTER, clock=VirtualClock()) as session:
        session.run(1)
        session.rate, session.on_issue, session.on_active_edit = 20, "pause", "keep"
        session.run(1)
        session.rewind(20)
        session.run(0.5)
        with session.fork(15) as fork:
            assert (fork.rate, fork.on_issue, fork.on_active_edit) == (20, "pause", "keep")
            fork.run(0.3)
            assert (fork.frame.tick, fork.frame.values) == (session.frame.tick, session.frame.values)


LEAVING = """(var n := [0]) (var seen := [[]]) (var r := [0.0])
(machine m (state a (running [n += 1] [
if n > 12: pass
]))) (spawn m a)"""


def gone_back(program=LEAVING, act=None, **options):
    """A session that was run for 2 s, has gone back to its tenth tick, and was run on."""
    session = Session(program, clock=VirtualClock(), **options)
    session.run(1.5)
    if act is not None:
        act(session)
    session.run(0.5)
    session.rewind(10)
    session.run(1.5)
    return session


@pytest.mark.parametrize(
    ("block", "left"),
    [
        ("seen.append(n)", "`seen`"),
        ("1 / 0", "an issue"),
        ("import random; r = random.random(); r = 0", "the state of the random numbers"),
        ("found[n] = [n]", "`found`"),
    ],
)
def test_what_a_rewind_leaves_is_told_by_a_fork_of_an_earlier_tick_that_comes_to_it(block, left):
    with gone_back(LEAVING.replace("pass", block), namespace={"found": {}}) as session:
        told = (
            rf"after tick 10 cannot be .*: the session went back to it, and {left} was no longer as before\."
        )
        with session.fork(5, inputs=True) as fork:
            fork.run(0.5)
            with pytest.raises(ValueError, match=told):
                fork.run(0.5)
        with pytest.raises(ValueError, match=told):
            session.what_if(5, seconds=2)
        assert session.what_if(5, seconds=0.3).divergence is None
        for tick in (10, 20):
            with session.fork(tick, inputs=True) as fork:
                fork.run(session.frame.time - fork.frame.time)
                assert seen(fork) == seen(session)
        with session.fork(5, LEAVING, inputs=True) as fork:
            fork.run(2)
            assert fork.frame.tick == 25, "another program does not come from what was left"


def test_the_settings_that_a_rewind_keeps_are_those_of_a_fork_that_comes_to_it():
    def act(session):
        session.rate, session.on_issue, session.on_active_edit = 20, "pause", "keep"

    with gone_back(act=act) as session, session.fork(5, inputs=True) as fork:
        fork.run(session.frame.time - fork.frame.time)
        assert (fork.rate, fork.on_issue, fork.on_active_edit) == (20, "pause", "keep")


def test_a_fork_of_a_tick_before_a_rewind_comes_to_the_present_if_nothing_is_left():
    program = LEAVING.replace("pass", "seen = [*seen, n]")
    with gone_back(program, namespace={"unused": []}) as session:
        random.random()  # by others
        with session.fork(5, inputs=True) as fork:
            fork.run(session.frame.time - fork.frame.time)
            assert fork.frame.values == session.frame.values
        assert session.what_if(5).divergence is None


def test_the_checkpoints_of_rewinds_are_the_last_to_be_dropped(monkeypatch):
    monkeypatch.setattr(checkpoints, "_SHARE", 0)
    monkeypatch.setattr(checkpoints, "_MOST", 6)
    with Session(LEAVING.replace("pass", "seen.append(n)"), clock=VirtualClock()) as session:
        session.run(50)
        session.rewind(10)
        session.run(500)
        assert len(session._loop.record.checkpoints.all) <= 6
        with session.fork(500, inputs=True) as fork:
            fork.run(1)
            assert fork.frame.values["n"] == 510


def test_the_names_that_a_program_uses_are_its_global_names():
    program = """(machine m (state a (running [
      import math
      robot.light.data
      limit
      [step for _ in 'a']
      class Near:
        def far(self):
          return self.width + found]))) (spawn m a)"""
    with Session(program, namespace={"data": [], "limit": 1}) as session:
        used = session._loop.record.names_used()
        assert used >= {"limit", "step", "found"}
        assert used.isdisjoint({"data", "light", "width", "math"})


def test_values_nested_too_deeply_to_be_copied_do_not_disturb_the_session():
    program = """(var n := [0])(var m := [[]])
      (machine m (state a (running [n = [n]] [m.append(1)])))(spawn m a)"""
    with Session(program, clock=VirtualClock()) as session:
        session.run(200)
        session._loop.record.checkpoint(running=False)
        assert (session.status, session.fault, session.frame.tick) == ("paused", "", 2000)
        with session.fork() as fork:
            fork.run(1)
            assert len(fork.interpreter.variables["m"]) == 2010
            assert len(session.interpreter.variables["m"]) == 2000


class Once:
    """An object of which no copy can be made, though it can be pickled."""

    def __init__(self):
        self.made = True

    def __setstate__(self, state):
        raise RuntimeError("there is only one")


def test_a_value_whose_copy_fails_is_told():
    program = "(var n := [Once()])(machine m (state a))(spawn m a)"
    with Session(program, clock=VirtualClock(), namespace={"Once": Once}) as session:
        session.run(1)
        for fork in (session.fork, session.what_if):
            with pytest.raises(ValueError, match=r"cannot be copied\. RuntimeError: there is only one\."):
                fork()
        session.run(1)
        assert "was entered" in str(session.why("m/a"))


GAINING = COUNTER.replace("n += 1", "n += gain")


def test_a_fork_has_the_values_that_a_notebook_had_then():
    names = {"gain": 1}
    with Session(GAINING, clock=VirtualClock(), namespace=names) as session:
        session.run(5)
        names["gain"] = 5
        session.run(2)
        with session.fork(30) as fork:
            assert fork.frame.values["n"] == session.at(30).values["n"] == 30
            fork.run(1)
            assert fork.frame.values["n"] == session.at(fork.frame.tick).values["n"] == 39


def by_hand(session):
    return [(each.tick, each.text) for each in session.timeline().happenings if each.kind == "hand"]


def test_a_fork_repeats_what_was_changed_in_the_notebook_when_it_was_changed():
    names = {"gain": 1, "step": lambda: 1, "more": [1]}
    text = GAINING.replace("gain", "gain * step() + len(more)")
    with Session(text, clock=VirtualClock(), namespace=names) as session:
        session.run(5)
        names["gain"], names["step"] = 5, lambda: 2
        session.run(2)
        names["more"] = [1, 2, 3]
        session.run(1)
        del names["step"]
        session.run(1)
        for tick in (10, 45, 60, 75, 85):
            with session.fork(tick, inputs=True) as fork:
                assert fork.frame.values == session.at(tick).values
                fork.run(session.frame.time - fork.frame.time)
                assert (fork.frame.values, fork.frame.issues) == (session.frame.values, session.frame.issues)
                fork.namespace["more"].append(0)
                assert by_hand(fork) == by_hand(session)
        assert names["more"] == [1, 2, 3]


def test_what_was_changed_in_the_notebook_stays_when_the_run_goes_back():
    names = {"gain": 1}
    with Session(GAINING, clock=VirtualClock(), namespace=names) as session:
        session.run(3)
        names["gain"] = 5
        session.run(1)
        session.rewind(20)
        session.run(1)
        assert session.frame.values["n"] == 20 + 50
        with session.fork(15, inputs=True) as fork:
            fork.run(0.5)
            assert fork.frame.values["n"] == 20
            fork.run(1)
            assert fork.frame.values == session.frame.values


def test_a_name_that_is_assigned_the_same_value_has_not_changed():
    names = {"gain": 1.5}
    with Session(GAINING, clock=VirtualClock(), namespace=names) as session:
        session.run(1)
        names["gain"] = float("1.5")
        session.run(1)
        assert not by_hand(session)


def test_a_list_that_was_assigned_from_outside_is_repeated_as_it_was():
    text = COUNTER.replace("n += 1", "seen.append(n)] [n = len(seen)") + "(var seen := [[]])"
    with Session(text, clock=VirtualClock()) as session:
        session.run(1)
        session.variables["seen"] = [7]
        session.run(1)
        with session.fork(15) as fork:
            assert fork.frame.values["n"] == session.at(15).values["n"] == 6
            fork.run(1)
            assert len(fork.frame.values["seen"]) == 15
        assert len(session.frame.values["seen"]) == 11


def test_a_past_that_cannot_be_repeated_exactly_is_refused_with_the_reason():
    clock = iter(range(1000))
    names = {"clock": lambda: next(clock)}
    with Session(COUNTER.replace("n += 1", "n = clock()"), clock=VirtualClock(), namespace=names) as session:
        session.run(2)
        with pytest.raises(ValueError, match=r"cannot be repeated exactly.* such as a clock, a file, or"):
            session.fork(10)


def test_a_tick_after_which_the_program_paused_can_be_repeated():
    text = COUNTER.replace("n += 1]", "n += 1] [1 / (n - 5)]") + "(onpause [n += 100])"
    with Session(text, clock=VirtualClock(), on_issue="pause") as session:
        session.run(1)
        assert (session.frame.tick, session.frame.values["n"]) == (5, 105)
        with session.fork(5) as fork:
            assert fork.frame.tick == 5


def test_an_input_that_cannot_be_applied_again_is_told():
    names = {"k": [1]}
    with Session(COUNTER, clock=VirtualClock(), namespace=names) as session:
        session.run(1)
        session.set_variable("n", evaluate="len(k)")
        session.run(1)
        del names["k"]
        with pytest.raises(ValueError, match=r"^What was done after tick 10 cannot be repeated: .*`?k`?"):
            session.fork(15)


def test_a_number_that_is_none_is_no_difference():
    with Session(COUNTER.replace("n += 1", "n = float('nan')"), clock=VirtualClock()) as session:
        session.run(1)
        with session.fork(5) as fork:
            assert fork.frame.tick == 5


HANGING = """(var n := [0])
(machine m (state a (running [n += 1] [
  while n == 5: pass]))
  (on [n > 20] a -> a late))
(spawn m a)"""


@pytest.mark.slow
def test_a_block_that_does_not_return_is_not_repeated_for_ever(monkeypatch):
    monkeypatch.setattr(questions, "REPEATING", 0.2)
    with Session(HANGING, clock=VirtualClock()) as session:
        with pytest.raises(SessionTimeoutError):
            session.run(1, limit=0.2)
        session.run(1)
        with session.fork(4) as fork:
            assert fork.frame.values["n"] == 4
        for ask in (session.fork, session.what_if):
            with pytest.raises(SessionTimeoutError, match=r"^Tick 5 cannot be repeated: a block did not"):
                ask(6)
        late = Element("transition", ("m", "late"))
        assert session.call(lambda: questions.test_again(session, 5, late, ("m",))) is None
        assert session.call(lambda: questions.test_again(session, 8, late, ("m",))) is None


def test_a_fork_that_fails_is_closed(monkeypatch):
    closed = []
    monkeypatch.setattr(Session, "close", lambda self: closed.append(self.name))
    monkeypatch.setattr(Loop, "begin", lambda self, checkpoint: 1 / 0)
    session = Session(COUNTER, clock=VirtualClock())
    with pytest.raises(ZeroDivisionError):
        session.fork()
    assert closed == [f"{session.name} fork"]
    monkeypatch.undo()
    session.close()


def test_a_namespace_can_be_written_while_it_is_copied():
    names = {}

    class Writing:
        """Another thread writes whenever it likes; this does when it is looked at."""

        @property
        def __class__(self):
            names[len(names)] = None
            return object

    names["writing"], names["last"] = Writing(), 1
    assert private_namespace(names, random.getstate())["last"] == 1


def test_a_fork_with_another_program_keeps_the_state():
    with Session(COUNTER, clock=VirtualClock()) as session:
        session.run(2)
        with session.fork(
            10, COUNTER.replace("n += 1", "n -= 1").replace("(running", "(onexit [n])(running")
        ) as fork:
            assert fork.frame.restarts == 1
        session.on_active_edit = "keep"
        session.run(0.1)
        with session.fork(21, COUNTER.replace("n += 1", "n -= 1")) as fork:
            fork.run(0.5)
            assert (fork.frame.values["n"], session.frame.values["n"]) == (17, 21)


def test_random_numbers_of_a_fork_are_those_of_the_session():
    program = """(var r := [0])
      (machine m (state a (running [import random; r = random.random() + draw()])))
      (spawn m a)"""
    names = {"draw": random.random}
    with Session(program, clock=VirtualClock(), namespace=names) as session:
        session.run(1)
        state = random.getstate()
        with session.fork() as fork:
            fork.run(1)
            assert random.getstate() == state, "the fork draws from a generator of its own"
            session.run(1)
            assert fork.frame.values["r"] == session.frame.values["r"]


def test_what_a_notebook_has_defined_is_copied_where_a_block_can_change_it():
    names = {"found": [], "limit": 3}
    program = "(machine m (state a (running [found.append(limit)])))(spawn m a)"
    with Session(program, clock=VirtualClock(), namespace=names) as session:
        session.run(1)
        assert len(names["found"]) == 10
        with session.fork(5) as fork:
            assert len(fork.namespace["found"]) == 5
            fork.run(1)
        assert len(names["found"]) == 10


def test_what_a_fork_prints_is_its_own():
    program = "(machine m (state a (running [print('tick')])))(spawn m a)"
    with Session(program, clock=VirtualClock()) as session:
        session.run(1)
        with session.fork() as fork:
            fork.run(1)
            assert (fork.output.count, session.output.count) == (10, 10)


def test_only_recorded_ticks_can_be_forked_or_looked_at():
    with Session(COUNTER, clock=VirtualClock(), journal=5) as session:
        session.run(2)
        with pytest.raises(ValueError, match="Choose one from 15 to 20"):
            session.fork(21)
        with pytest.raises(ValueError, match="Ask about ticks 16 to 20"):
            session.at(3)
    with Session(COUNTER, clock=VirtualClock(), journal=0) as session:
        with pytest.raises(ValueError, match=r"^No tick has run yet\. Run the program first\.$"):
            session.fork(0)
        session.run(2)
        with pytest.raises(ValueError, match=r"^Tick 3 is not remembered\. None is\.$"):
            session.fork(3)


def test_a_fork_begins_at_a_tick_or_a_time():
    with Session(COUNTER, clock=VirtualClock()) as session:
        session.run(1)
        with session.fork(0.55) as fork, session.fork(6) as other:
            assert fork.frame.tick == other.frame.tick == 6
        assert session.what_if(0.55, seconds=1).tick == session.what_if(6, seconds=1).tick == 6
        assert [each.seconds for each in session.try_values("n", [1], seconds=1, at=0.55)] == [1.0]
        for ask in (session.fork, session.what_if):
            with pytest.raises(TypeError, match="`at` must be the number of a tick, or a time in seconds"):
                ask("x")
