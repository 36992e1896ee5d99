"""Breakpoints pause after the tick in which they are hit, and follow their element."""

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from support.robots import Bare
from support.wild import program

from lrp_jupyter.bridges.sim import SimBridge
from lrp_jupyter.errors import UnknownElementError
from lrp_jupyter.interpreter import linker, variables
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.resolution import resolve
from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.session import Session

TEXT = """(var n := [0])
(event odd [n % 2 == 1])
(machine m
  (var own := [0])
  (state a (running [n += 1]))
  (state b (onentry [own += 1] (spawn inner s))
    (machine inner (state s) (state t) (ontime 100 s -> t deep)))
  (ontime 300 a -> b there)
  (ontime 300 b -> a back))
(spawn m a)"""


@pytest.fixture
def live():
    with Session(TEXT, clock=VirtualClock()) as session:
        yield session


def pauses(session, seconds=5.0):
    """The ticks after which the program pauses."""
    ticks, end = [], session.frame.time + seconds
    while session.frame.time < end - 1e-6:
        session.run(end - session.frame.time)
        if session.frame.paused_by is not None:
            ticks.append(session.frame.tick)
            session.resume()
    return ticks


def test_the_tick_in_which_a_state_is_entered_is_completed(live):
    live.pause_when("b")
    live.run(5)
    frame = live.frame
    assert (frame.tick, frame.status, frame.is_active("b")) == (4, "paused", True)
    assert frame.reason == "`b` was entered (breakpoint 1, 1st time)."
    assert (frame.paused_by.number, frame.paused_by.count, frame.paused_by.tick) == (1, 1, 4)
    live.run(5)
    assert (live.frame.tick, live.frame.paused_by.count) == (10, 2)


@pytest.mark.parametrize(
    ("when", "tick"),
    [
        ({"left": "a"}, 4),
        ({"fires": "back"}, 7),
        ({"fires": "m/there"}, 4),
        ({"fires": "deep"}, 5),
        ({"entered": "m/b/inner/t"}, 5),
        ({"event": "odd"}, 1),
        ({"condition": "n == 3"}, 3),
        ({"condition": "own == 1", "machine": "m"}, 4),
    ],
)
def test_what_can_be_waited_for(live, when, tick):
    live.pause_when(**when)
    live.run(5)
    assert live.frame.tick == tick


def test_only_what_becomes_true_is_a_hit(live):
    live.pause_when(condition="n >= 2")
    assert pauses(live) == [2]


def test_a_breakpoint_can_wait_for_the_third_time_and_pause_once(live):
    live.pause_when("b", after=3, once=True)
    assert pauses(live) == [16]
    (known,) = live.breakpoints
    assert (known.hits, known.enabled) == (8, False)


def test_breakpoints_are_listed_switched_off_and_removed(live):
    live.pause_when("b")
    live.pause_when(fires="back")
    live.set_breakpoint(1, False)
    assert [str(each) for each in live.breakpoints] == [
        "1: pause when `b` is entered; 0 hits, switched off",
        "2: pause when `back` fires; 0 hits",
    ]
    assert pauses(live, 1) == [7]
    assert live.breakpoints[0].hits == 2, "it is counted though it is switched off"
    live.remove_breakpoint(2)
    live.remove_breakpoint(1)
    assert live.breakpoints == ()
    assert pauses(live, 2) == []
    with pytest.raises(ValueError, match="There is no breakpoint 1"):
        live.remove_breakpoint(1)


def test_a_forced_state_is_entered_too(live):
    live.pause_when("b")
    live.run(0.1)
    live.resume()
    live.transition_to("b")
    assert (live.frame.status, str(live.frame.paused_by)) == (
        "paused",
        "`b` was entered (breakpoint 1, 1st time).",
    )


def test_single_steps_show_what_was_hit(live):
    live.pause_when("b")
    for _ in range(4):
        live.step()
    assert live.frame.paused_by.count == 1
    live.step()
    assert live.frame.paused_by is None


def test_a_breakpoint_follows_its_element_over_renames_and_edits(live):
    live.pause_when("b")
    live.rename("state", "m/b", "beside")
    assert live.breakpoints[0].name == "beside"
    live.edit(live.text.replace("(ontime 300 a", "(ontime 500 a"))
    live.run(5)
    assert (live.frame.tick, live.frame.paused_by.what) == (6, "`beside` was entered")
    live.rewind(6)
    live.edit(TEXT)
    assert not live.breakpoints[0].dormant


def test_a_breakpoint_of_a_removed_element_is_dormant_until_it_comes_back(live):
    live.pause_when(fires="back")
    live.edit(TEXT.replace("(ontime 300 b -> a back)", ""))
    assert str(live.breakpoints[0]) == "1: pause when `back` fires; 0 hits, dormant"
    live.edit(TEXT)
    assert pauses(live, 1) == [7]


def test_a_condition_that_raises_is_a_problem_of_the_breakpoint(live):
    live.pause_when(condition="nope > 3")
    live.run(1)
    assert live.breakpoints[0].problem.startswith("NameError")
    assert str(live.breakpoints[0]).endswith("0 hits. NameError: name 'nope' is not defined.")
    assert (live.frame.tick, live.issues) == (10, ())


def test_a_condition_has_no_problem_before_the_variables_exist():
    with Session(TEXT) as fresh:
        assert str(fresh.pause_when(condition="n > 3")).endswith("; 0 hits")
        fresh.run(1)
        assert fresh.breakpoints[0].problem == ""


@pytest.mark.parametrize(
    ("when", "error", "message"),
    [
        ({"entered": "c"}, UnknownElementError, "There is no state `c`"),
        ({"fires": "bak"}, UnknownElementError, "Did you mean `back`"),
        ({"event": "even"}, UnknownElementError, "There is no event `even`"),
        ({"condition": "n ="}, SyntaxError, ""),
        ({"condition": "n > 1", "machine": "k"}, UnknownElementError, "There is no machine `k`"),
        ({}, TypeError, "Pass one of"),
        ({"entered": "a", "left": "b"}, TypeError, "Pass one of"),
        ({"entered": "a", "after": 0}, ValueError, "after"),
    ],
)
def test_a_mistake_is_refused_at_once(live, when, error, message):
    with pytest.raises(error, match=message or None):
        live.pause_when(**when)
    assert live.breakpoints == ()


def test_a_running_thread_is_paused():
    with Session(TEXT, rate=50) as live:
        live.pause_when("b")
        live.start()
        frame = live.wait_for(lambda frame: frame.paused_by is not None, timeout=120)
        assert frame.paused_by.what == "`b` was entered"


def defined_in(session):
    """The function from a state as spawned to its path of definition."""
    return lambda path: (*resolve(session.program).defined(path[:-1]), path[-1])


@settings(
    max_examples=settings().max_examples // 2,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)
@given(program, st.data())
def test_it_pauses_exactly_when_the_state_is_entered(text, data):
    states = [element for element in resolve(parse(text)).elements() if element.kind == "state"]
    wanted = data.draw(st.sampled_from(states))
    robot = {"robot": None}
    entered = []
    with Session(text, clock=VirtualClock(), namespace=robot) as watched:
        defined = defined_in(watched)
        watched.observe(
            lambda event: (
                entered.append(event.tick)
                if event.kind == "entered" and defined(event.path) == wanted.path
                else None
            )
        )
        watched.run(1.5)
    with Session(text, clock=VirtualClock(), namespace=robot) as live:
        live.pause_when(wanted.path)
        paused = []
        for _ in range(15):
            live.step()
            if live.frame.paused_by is not None:
                paused.append(live.frame.tick)
        assert paused == sorted(set(entered))
        assert live.breakpoints[0].hits == len(entered)


def test_a_number_is_never_used_again(live):
    live.remove_breakpoint(live.pause_when("b").number)
    assert live.pause_when("a").number == 2
    assert live.breakpoints[0].name == "a"


def test_a_step_back_undoes_the_pause_and_another_pause_has_its_own_reason(live):
    live.pause_when("b")
    live.run(5)
    assert live.frame.paused_by.number == 1
    live.rewind(1)
    assert (live.frame.paused_by, live.frame.reason) == (None, "")
    live.run(5)
    assert live.frame.paused_by is not None
    live.pause("A person wanted it.")
    assert (live.frame.paused_by, live.frame.reason) == (None, "A person wanted it.")


LAMP = "(var n := [0]) (machine m (state a (running [n = robot.lamp.data]))) (spawn m a)"


def test_a_condition_tests_what_the_program_has_seen():
    reads = []
    blinking = Bare(lambda robot: robot.add_variable("lamp.data", lambda: reads.append(0) or len(reads)))
    with Session(LAMP, blinking, clock=VirtualClock()) as live:
        live.step()
        live.pause_when(condition="robot.lamp.data != n")
        live.pause_when(condition="n == robot.lamp.data")
        before = len(reads)
        for _ in range(9):
            live.step()
        assert len(reads) - before == 9
        assert [each.hits for each in live.breakpoints] == [0, 1]


def test_a_condition_is_compiled_once(live, monkeypatch):
    places = []

    def compiled(place, *arguments):
        places.append(place)
        return linker.compiled(place, *arguments)

    live.step()
    monkeypatch.setattr(variables, "compiled", compiled)
    live.pause_when(condition="n >= 4")
    live.pause_when(event="odd", after=1000)
    live.run(1)
    assert len(places) == 2
    live.edit(TEXT.replace("own += 1", "own += 2"))
    live.run(1)
    assert len(places) == 4


def test_the_block_of_an_event_at_a_breakpoint_does_not_mean_the_event_itself():
    with Session("(event near [near]) (machine m (state a)) (spawn m a)") as session:
        session.step()
        session.pause_when(event="near")
        assert "not defined" in session.breakpoints[0].problem


def test_a_condition_is_true_or_false_as_that_of_a_transition(live):
    pytest.importorskip("numpy")
    live.pause_when(condition="n")
    live.pause_when(condition="robot")
    live.pause_when(condition="__import__('numpy').int64(n) > 2")
    live.run(5)
    number, part, boolean = live.breakpoints
    assert number.problem == "A condition must be True or False, not 3. Compare it with something."
    assert part.problem.startswith("`robot` ")
    assert (number.hits, part.hits, boolean.hits, boolean.problem) == (0, 0, 1, "")
    assert live.frame.paused_by.number == boolean.number


@pytest.mark.parametrize("wrong", [{"after": 1.5}, {"after": "2"}, {"after": True}])
def test_hits_are_counted_in_whole_numbers(live, wrong):
    with pytest.raises(TypeError, match="`after` must be a number of hits, not "):
        live.pause_when("b", **wrong)


def test_a_condition_is_a_text(live):
    with pytest.raises(TypeError, match="`condition` must be a text, a Python expression, not int"):
        live.pause_when(condition=5)


BLOCK = """(var n := [0])
(event late [
  half = n / 2
  half > 2])
(machine m (var own := [0]) (state a (running [n += 1; own += 2])))
(spawn m a)"""


def test_an_event_of_several_statements_is_waited_for():
    with Session(BLOCK, clock=VirtualClock()) as live:
        live.pause_when(event="late")
        live.run(3)
        assert (live.frame.tick, live.frame.values["n"]) == (5, 5)
        assert live.breakpoints[0].problem == ""


def test_a_condition_follows_its_machine_over_renames():
    with Session(BLOCK, clock=VirtualClock()) as live:
        live.pause_when(condition="own == 8", machine="m")
        live.run(0.1)
        live.rename("machine", "m", "other")
        live.run(3)
        assert (live.frame.tick, live.frame.values["own"]) == (4, 8)
        live.edit(live.text.replace("other", "third"))
        assert live.breakpoints[0].dormant


def test_looking_at_an_event_does_not_change_the_run():
    text = "(var n := [0]) (event e [n += 3]) (machine m (state a (running [n += 1]))) (spawn m a)"
    with Session(text, clock=VirtualClock()) as session:
        session.pause_when(event="e")
        session.run(1.0)
        assert session.frame.values["n"] == 10


@pytest.mark.parametrize("command", ["robot.drive_by(1)", "robot.move(linear=0.4)", "robot.stop()"])
def test_a_condition_that_commands_the_robot_is_a_problem_of_the_breakpoint(command):
    runs = []
    for breaks in (False, True):
        text = "(machine m (state a (running [robot.drive_by(0.5)]))) (spawn m a)"
        with Session(text, SimBridge(), clock=VirtualClock()) as session:
            if breaks:
                session.pause_when(condition=f"{command} is not None")
            session.run(1.0)
            runs.append(session.frame.robot.robots)
            name = command.partition("(")[0]
            sentence = f"`{name}` is a command, and a breakpoint only looks at the run."
            assert [each.problem for each in session.breakpoints] == [sentence] * breaks
    assert runs[0] == runs[1]
