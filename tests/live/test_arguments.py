"""Wrong arguments of the public API: one sentence, where they are made."""

import contextlib
import gc
import math
import threading

import pytest

import lrp_jupyter as lrp
from lrp_jupyter.errors import BridgeError, FileError, LRPSyntaxError, UnknownElementError
from lrp_jupyter.grading.batch import grade_all
from lrp_jupyter.grading.challenge import Challenge
from lrp_jupyter.grading.challenges import challenge
from lrp_jupyter.grading.workers import HowRun

PROGRAM = "(var n := [1]) (machine m (state a) (state b) (ontime 300 a -> b)) (spawn m a)"


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ({"spede": 3}, "The bridge `none` has no option `spede`; it takes no options. Did you mean `speed`?"),
        (
            {"bridge": "sim", "wrld": "line"},
            "The bridge `sim` has no option `wrld`; it takes `world`, `seed`, `noise`. Did you mean `world`?",
        ),
        (
            {"bridge": lrp.SimBridge(), "on_isue": "pause"},
            "The bridge `sim` exists already and accepts no more options, such as `on_isue`."
            " Did you mean `on_issue`?",
        ),
        ({"bridge": 3}, "A bridge is a name, a subclass of Bridge or an object of one, not int."),
        ({"on_issue": "paus"}, "`on_issue` must be `record` or `pause`, not `paus`. Did you mean `pause`?"),
        ({"on_active_edit": None}, "`on_active_edit` must be `restart` or `keep`, not None."),
        (
            {"driver": "threads"},
            "`driver` must be `thread` or `asyncio`, not `threads`. Did you mean `thread`?",
        ),
        ({"journal": -1}, "`journal` must be a number of ticks, 0 or more, not -1."),
        ({"journal": 2.5}, "`journal` must be a number of ticks, not float."),
        ({"journal": "many"}, "`journal` must be a number of ticks, not str."),
        ({"rate": "fast"}, "`rate` must be a number of ticks per second, not str."),
        ({"speed": None}, "`speed` must be a number, not None."),
        ({"clock": 3}, "`clock` must be a clock, such as `VirtualClock()`, not int."),
        ({"namespace": ["n"]}, "`namespace` must be a dict, not list."),
        ({"name": 3}, "`name` must be a text, not int."),
        ({"hung_after": 0}, "`hung_after` must be a number of seconds above 0, not 0."),
        ({"dead_man": 0}, "`dead_man` must be a number of seconds above 0, not 0."),
        ({"dead_man": "never"}, "`dead_man` must be a number of seconds, not str."),
        ({"program": b"text"}, "`program` must be a text or a Program, not bytes."),
        (
            {"world": "line"},
            "The bridge `none` has no option `world`; it takes no options."
            ' Name the robot that takes it, as in `bridge="sim"`.',
        ),
        (
            {"bridge": lrp.SimBridge(), "world": "line"},
            "The bridge `sim` exists already and accepts no more options, such as `world`.",
        ),
        ({"bridge": "sim", "seed": "x"}, "The bridge `sim`: `seed` takes a whole number, not `x`."),
        ({"bridge": "sim", "seed": True}, "`seed` must be a whole number, not bool."),
        ({"bridge": "sim", "noise": 3}, '`noise` must be a mapping such as `{"light": 4}`, not int.'),
        (
            {"bridge": "sim", "noise": {"light": -4}},
            "`light` must be a standard deviation, 0 or more, not -4.",
        ),
        ({"bridge": "sim", "noise": {"light": "4"}}, "`light` must be a standard deviation, not str."),
        ({"rate": True}, "`rate` must be a number of ticks per second, not bool."),
        ({"speed": True}, "`speed` must be a number, not bool."),
        ({"journal": True}, "`journal` must be a number of ticks, not bool."),
        ({"dead_man": True}, "`dead_man` must be a number of seconds, not bool."),
        (
            {"clock": lrp.VirtualClock},
            "`clock` must be a clock, such as `VirtualClock()`, not the class VirtualClock.",
        ),
        (
            {"clock": lrp.VirtualClock(), "speed": 2},
            "Pass either `clock` or `speed`: a clock has a speed of its own.",
        ),
    ],
)
def test_a_wrong_argument_of_a_session_is_one_sentence(arguments, sentence):
    with pytest.raises((BridgeError, TypeError, ValueError)) as caught:
        lrp.Session(**{"program": PROGRAM, **arguments})
    assert str(caught.value) == sentence


A_PROGRAM = "a Program, which `parse(text)` makes of a text"
LAMP = challenge("lamp")
NO_HITS = "`after` must be a number of hits, 1 or more, not 0."
A_PATH = "A path is a text such as `m/a`, or a tuple of names, not int."


def made(name="mine", criteria=LAMP.criteria, **fields):
    return Challenge(name, "Do it.", ("line",), criteria, **fields)


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: lrp.parse(3), "`text` must be the text of a program, not int."),
        (lambda: lrp.check(None), "`text_or_program` must be a text or a Program, not None."),
        (lambda: lrp.diff(PROGRAM, 3), f"`old` must be {A_PROGRAM}, not str."),
        (lambda: lrp.to_source(PROGRAM), f"`program` must be {A_PROGRAM}, not str."),
        (lambda: lrp.state_graph(3), f"`program` must be {A_PROGRAM}, not int."),
        (lambda: lrp.Interpreter(PROGRAM), f"`program` must be {A_PROGRAM}, not str."),
        (lambda: lrp.Lab(3), "`program` must be a text, a Program or a Session, not int."),
        (lambda: lrp.StateGraph(3), "`session` must be a Session, a Lab or the name of a program, not int."),
        (
            lambda: lrp.grade("", 4),
            "`what` must be the name of a challenge, a Challenge or a World, not int.",
        ),
        (lambda: lrp.grade("", "square", limit="x"), "`limit` must be a number of seconds, not str."),
        (
            lambda: lrp.grade("", "square", True),
            "`seeds` must be a number of runs, or the seeds themselves, not bool.",
        ),
        (lambda: lrp.VirtualClock("now"), "`start` must be a time in seconds, not str."),
        (lambda: lrp.diff(lrp.parse(PROGRAM), PROGRAM), f"`new` must be {A_PROGRAM}, not str."),
        (lambda: lrp.Interpreter(lrp.parse(PROGRAM), namespace=[]), "`namespace` must be a dict, not list."),
        (lambda: lrp.Lab(PROGRAM, challenge=3), "`challenge` must be a Challenge or its name, not int."),
        (lambda: lrp.grade("", "lamp", memory=0), "`memory` must be a number of megabytes above 0, not 0."),
        (lambda: lrp.grade("", "lamp", 0), "`seeds` must be a number of runs, 1 or more, not 0."),
        (
            lambda: lrp.grade("", LAMP.worlds[0], seconds=0),
            "`seconds` must be a number of seconds above 0, not 0.",
        ),
        (
            lambda: grade_all([""], LAMP, how=HowRun(limit=0)),
            "`limit` must be a number of seconds above 0, not 0.",
        ),
        (
            lambda: grade_all([""], LAMP, how=HowRun(memory=0)),
            "`memory` must be a number of megabytes above 0, not 0.",
        ),
        (
            lambda: grade_all([""], LAMP, how=HowRun(processes=0)),
            "`processes` must be a number of processes, 1 or more, not 0.",
        ),
        (
            lambda: lrp.sweep(PROGRAM, 3, {}),
            "`what` must be the name of a challenge or a Challenge, not int.",
        ),
        (lambda: made(name=3), "`name` must be a text, not int."),
        (lambda: made(needed=0), "`needed` must be a share from 0 to 1 above 0, not 0."),
        (lambda: made(criteria=(3,)), "`criteria` must be made by functions such as `visits`, not int."),
    ],
)
def test_a_wrong_argument_anywhere_is_one_sentence(call, sentence):
    with pytest.raises((TypeError, ValueError)) as caught:
        call()
    assert str(caught.value) == sentence


@pytest.mark.parametrize(
    ("call", "error", "sentence"),
    [
        (lambda s: s.edit(3), TypeError, "`text` must be the text of a program, not int."),
        (lambda s: s.run("b"), TypeError, "`seconds` must be a number, not str."),
        (lambda s: s.run(-1), ValueError, "`seconds` must be a number, 0 or more, not -1."),
        (lambda s: s.run(float("nan")), ValueError, "`seconds` must be a number, 0 or more, not nan."),
        (lambda s: s.run(1, limit="x"), TypeError, "`limit` must be a number of seconds, not str."),
        (lambda s: s.run(1, limit=0), ValueError, "`limit` must be a number of seconds above 0, not 0."),
        (
            lambda s: s.run(1, until="bb"),
            UnknownElementError,
            "There is no state `bb`. Did you mean `b`?",
        ),
        (lambda s: s.rewind("x"), TypeError, "`ticks` must be a number of ticks, not str."),
        (
            lambda s: s.transition_to(3),
            TypeError,
            A_PATH,
        ),
        (
            lambda s: s.frame.is_active(3),
            TypeError,
            A_PATH,
        ),
        (
            lambda s: setattr(s, "on_issue", "stop"),
            ValueError,
            "`on_issue` must be `record` or `pause`, not `stop`.",
        ),
        (
            lambda s: lrp.Session("(var v := [1]) (machine m (state a)) (spawn m a)").set_variable("v", 2),
            UnknownElementError,
            "There is no variable `v` now. Variables exist while their machine runs, global ones from the "
            "first tick after a start or restart.",
        ),
        (lambda s: s.fork(program=5), TypeError, "`program` must be a text or a Program, not int."),
        (
            lambda s: s.what_if(seconds=math.inf),
            ValueError,
            "All runs last so many `seconds`. Pass a number that is not infinite.",
        ),
        (
            lambda s: s.try_values("n", [1], math.inf),
            ValueError,
            "A run without `until` never ends. Pass `until`, or other `seconds`.",
        ),
        (
            lambda s: s.try_values("n", "123"),
            TypeError,
            "`values` must be a list, such as `[0.2, 0.3]`, not str.",
        ),
        (
            lambda s: s.try_programs("x"),
            TypeError,
            "`programs` must be a list, such as `[text, other]`, not str.",
        ),
        (lambda s: s.try_values("n", [1], outcome=5), TypeError, "`outcome` must be a function, not int."),
        (
            lambda s: s.plots("n"),
            TypeError,
            '`names` must be a list, such as `["robot.light.data"]`, not str.',
        ),
        (lambda s: s.plots([3]), TypeError, "`names` must be a list of texts, not int."),
        (lambda s: s.timeline(3), TypeError, "`since` must be the `cursor` of a timeline, not int."),
        (
            lambda s: s.timeline(plots=["n"]),
            TypeError,
            "`plots` must be a mapping of names to ticks, not list.",
        ),
        (
            lambda s: s.pause_when(condition=5),
            TypeError,
            "`condition` must be a text, a Python expression, not int.",
        ),
        (lambda s: s.pause_when("a", after=1.5), TypeError, "`after` must be a number of hits, not float."),
        (
            lambda s: s.pause_when("a", machine="m"),
            TypeError,
            "`machine` is the scope of a `condition`. To name an element, pass its path.",
        ),
        (
            lambda s: s.pause_when("a", after=0),
            ValueError,
            NO_HITS,
        ),
        (lambda s: s.set_breakpoint(1, after=1.5), TypeError, "`after` must be a number of hits, not float."),
        (
            lambda s: s.set_breakpoint(1, after=0),
            ValueError,
            NO_HITS,
        ),
        (lambda s: s.what_if(seconds=0), ValueError, "`seconds` must be a number of seconds above 0, not 0."),
        (
            lambda s: s.try_values("n", [1], -1),
            ValueError,
            "`seconds` must be a number of seconds, 0 or more, not -1.",
        ),
        (lambda s: s.offer(3), TypeError, "`text` must be the text of a program, not int."),
        (
            lambda s: s.wait_for("b", -1),
            ValueError,
            "`timeout` must be a number of seconds, 0 or more, not -1.",
        ),
        (lambda s: s.rewind(1.5), TypeError, "`ticks` must be a number of ticks, not float."),
        (lambda s: s.rewind(-1), ValueError, "`ticks` must be a number of ticks, 0 or more, not -1."),
        (lambda s: s.pause(3), TypeError, "`reason` must be a sentence, not int."),
        (lambda s: s.rename("state", "m/a", 3), TypeError, "`new_name` must be a name, not int."),
        (
            lambda s: s.rename(3, "m/a", "c"),
            TypeError,
            "`kind` must be the kind of an element, such as `state`, not int.",
        ),
        (
            lambda s: s.set_variable("n", evaluate=5),
            TypeError,
            "`evaluate` must be a text, a Python expression, not int.",
        ),
        (
            lambda s: s.set_variable("n", evaluate="x = 5"),
            SyntaxError,
            "`x = 5` is not an expression. Write a value, such as `2 * 3`.",
        ),
        (lambda s: s.run(1, until=[]), UnknownElementError, "There is no state ``. There are: `a`, `b`."),
        (lambda s: s.frame.values[b"n"], TypeError, A_PATH.replace("int", "bytes")),
        (lambda s: s.frame.values[None], TypeError, A_PATH.replace("int", "None")),
        (lambda s: s.check(3), TypeError, "`program` must be a text or a Program, not int."),
        (lambda s: s.run(True), TypeError, "`seconds` must be a number, not bool."),
        (lambda s: s.run(1, after_tick=3), TypeError, "`after_tick` must be a function, not int."),
        (lambda s: s.run(1, until=lambda frame: 1 / 0), ZeroDivisionError, "division by zero"),
        (lambda s: s.run(1, after_tick=lambda: 1 / 0), ZeroDivisionError, "division by zero"),
        (lambda s: s.call(3), TypeError, "`function` must be a function, not int."),
        (lambda s: s.observe(3), TypeError, "`observer` must be a function, not int."),
        (lambda s: s.listen(3), TypeError, "`callback` must be a function, not int."),
        (lambda s: s.wait_for("b", "soon"), TypeError, "`timeout` must be a number of seconds, not str."),
        (
            lambda s: setattr(s, "rate", "fast"),
            TypeError,
            "`rate` must be a number of ticks per second, not str.",
        ),
        (
            lambda s: s.wait_for("b", 5),
            lrp.LRPError,
            "The session was not started. Call `start` first, or use `run(until=…)`.",
        ),
    ],
)
def test_a_wrong_call_of_a_session_is_one_sentence_and_breaks_nothing(call, error, sentence):
    with lrp.Session(PROGRAM) as session:
        session.step()
        with pytest.raises(error) as caught:
            call(session)
        assert str(caught.value) == sentence
        assert session.run(1, until="b")
        assert not session.issues


def test_a_session_takes_a_subclass_of_bridge_with_its_options():
    with lrp.Session(PROGRAM, lrp.SimBridge, world="empty") as session:
        assert session.bridge.world.name == "empty"


def test_waiting_in_vain_names_a_state_that_does_not_exist():
    with lrp.Session(PROGRAM) as session:
        session.start()
        with pytest.raises(TimeoutError, match=r"There is no state `bb`\. Did you mean `b`\?"):
            session.wait_for("bb", 0.01)


def test_a_session_begins_with_a_file_its_name_and_its_world(tmp_path):
    path = tmp_path / "mine.lrp"
    path.write_bytes("\ufeff; Mine.\r\n; world: oval\r\n".encode() + PROGRAM.encode())
    with lrp.Session.from_file(path, "sim", rate=20) as session:
        assert (session.name, session.rate, session.bridge.world.name) == ("mine", 20.0, "oval")
        assert session.text == "; Mine.\r\n; world: oval\r\n" + PROGRAM
    with lrp.Session.from_file(str(path), bridge="sim", world="empty", name="other") as session:
        assert (session.name, session.bridge.world.name) == ("other", "empty")
    with lrp.Session.from_file(path) as session:
        assert session.bridge.name == "none"


def test_a_file_that_cannot_be_read_is_a_sentence(tmp_path):
    with pytest.raises(FileError, match=r"missing\.lrp` cannot be read: No such file or directory\."):
        lrp.Session.from_file(tmp_path / "missing.lrp")
    with pytest.raises(FileError, match="cannot be read: Is a directory"):
        lrp.Session.from_file(tmp_path)
    path = tmp_path / "picture.lrp"
    path.write_bytes(b"\x89PNG")
    with pytest.raises(FileError, match="is not valid UTF-8: byte 0 cannot be decoded"):
        lrp.Session.from_file(path)
    path.write_text("(machine")
    with pytest.raises(LRPSyntaxError):
        lrp.Session.from_file(path)


def test_a_started_session_that_is_dropped_ends_with_a_warning():
    def threads() -> list[threading.Thread]:
        return [thread for thread in threading.enumerate() if thread.name.startswith("lrp dropped")]

    sessions = [lrp.Session(PROGRAM, "sim", name="dropped")]
    sessions[0].start()
    bridge = sessions[0].bridge
    assert threads()
    with pytest.warns(ResourceWarning, match="The session `dropped` was dropped while it ran, and ended"):
        sessions.clear()
    for thread in threads():
        thread.join(120)
    assert not threads()
    assert not bridge.is_open


def test_a_closed_session_and_one_that_never_started_are_dropped_in_silence():
    session = lrp.Session(PROGRAM)
    session.start()
    session.close()
    del session
    lrp.Session(PROGRAM).run(1)
    gc.collect()


def test_what_a_newcomer_prints_is_short():
    with lrp.Session(PROGRAM) as session:
        session.run(1)
        assert repr(session.frame) == "<Frame: paused, tick 10, 1 s, m/b active>"
        assert repr(session.interpreter) == "<Interpreter: tick 10, m/b active>"
        assert repr(lrp.VirtualClock(2)) == "<VirtualClock at 2 s>"


WRONG = [3, None, True, b"a", [], {}, object(), float("nan"), "", ("m", 3), "zz", lrp.Session, lambda: 1 / 0]


@pytest.mark.parametrize(
    "call",
    [
        lambda s, wrong: s.pause(wrong),
        lambda s, wrong: s.rename(wrong, "m/a", "c"),
        lambda s, wrong: s.rename("state", wrong, "c"),
        lambda s, wrong: s.rename("state", "m/a", wrong),
        lambda s, wrong: setattr(s, "rate", wrong),
        lambda s, wrong: setattr(s, "speed", wrong),
        lambda s, wrong: setattr(s, "on_issue", wrong),
        lambda s, wrong: s.transition_to(wrong),
        lambda s, wrong: s.fire(wrong),
        lambda s, wrong: s.teleport_to(wrong),
        lambda s, wrong: s.set_variable(wrong, 1),
        lambda s, wrong: s.set_variable("n", wrong),
        lambda s, wrong: s.set_variable("n", evaluate=wrong),
        lambda s, wrong: s.rewind(wrong),
        lambda s, wrong: s.call(wrong),
        lambda s, wrong: s.observe(wrong),
        lambda s, wrong: s.edit(wrong),
        lambda s, wrong: s.run(0.1, until=wrong),
        lambda s, wrong: s.run(0.1, after_tick=wrong),
        lambda s, wrong: s.wait_for(wrong, 0.1),
        lambda s, wrong: s.frame.count_of(wrong),
    ],
)
def test_nothing_that_a_session_is_given_breaks_it(call):
    with lrp.Session(PROGRAM) as session:
        for wrong in WRONG:
            session.run(0.2)
            with contextlib.suppress(
                lrp.LRPError, TypeError, ValueError, ArithmeticError, NameError, SyntaxError
            ):
                call(session, wrong)
            assert session.status == "paused", repr(wrong)


def test_the_members_of_a_session_are_those_of_its_help():
    with lrp.Session(PROGRAM) as session:
        listed = {name for name in dir(session) if not name.startswith("_")}
        kept = {"bridge", "dead_man", "driver", "findings", "log", "name", "namespace", "output"}
        assert listed == {name for name in dir(lrp.Session) if not name.startswith("_")} | kept
        assert "submit" not in listed
