"""Whatever is typed, asked and done to the robot: nothing escapes, nothing breaks, nothing stops."""

from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule

import lrp_jupyter
from lrp_jupyter.errors import LRPError
from lrp_jupyter.interpreter.issues import IssueKind
from lrp_jupyter.live.session import Session

PROGRAMS = {
    path.stem: path.read_text(encoding="utf-8")
    for path in sorted((Path(lrp_jupyter.__file__).parent / "programs").glob("*.lrp"))
}
OWN = """
(var n := [0]) (var v := [0.2])
(event seen [robot.light.data < 128])
(machine m
  (var k := [n])
  (state a (onentry [k = k + 1]) (running [robot.move(linear=v)] [n += 1; print(n)]))
  (state b (onentry (spawn inner x)) (onexit [robot.stop()])
    (machine inner
      (state x (running [robot.move(angular=1)])) (state y (onentry [1 / (n % 3)]))
      (ontime 200 x -> y) (exit [n > 60] y -> a)))
  (on seen a -> b) (ontime 300 a -> b t) (ontime [n * 10] b -> a) (on [robot.bumper.data] *-> b))
(spawn m a)
"""
TEXTS = [OWN, *PROGRAMS.values()]
PIECES = [
    "(",
    ")",
    "[",
    "]",
    '"',
    "state",
    "(spawn m a)",
    "[1/0]",
    "nope",
    "\n",
    "; x",
    "->",
    "*",
    " ",
    "9",
    "#",
]

text = st.sampled_from(TEXTS)
name = st.sampled_from(["m", "a", "b", "x", "y", "inner", "follower", "looking", "moving", "end", "nope", ""])
path = st.lists(name, max_size=4).map(tuple) | name
variable = st.sampled_from(["n", "v", "m/k", "follower/nobump", "nope", "forward"])
expression = st.sampled_from(
    ["n + 1", "0", "None", "'x'", "nope", "(", "", "[1] * 3", "float('nan')", "-1", "robot"]
)
number = st.floats(allow_nan=True, allow_infinity=True) | st.floats(-1, 4)


@st.composite
def botched(draw):
    """A program with a piece put in or taken out somewhere."""
    whole = draw(text)
    start = draw(st.integers(0, len(whole)))
    end = min(len(whole), start + draw(st.integers(0, 12)))
    return whole[:start] + draw(st.sampled_from([*PIECES, ""])) + whole[end:]


class Anything(RuleBasedStateMachine):
    @initialize(
        first=text,
        rate=st.sampled_from([0, 1, 10, 33, 100]),
        keep=st.booleans(),
        pause=st.booleans(),
        journal=st.sampled_from([0, 5, 1000]),
        world=st.sampled_from(["line", "boxes", "empty"]),
    )
    def begin(self, first, rate, keep, pause, journal, world):
        self.session = Session(
            first,
            "sim",
            world=world,
            rate=rate,
            on_active_edit="keep" if keep else "restart",
            on_issue="pause" if pause else "record",
            journal=journal,
            noise={"motor": 0.05, "light": 5},
        )

    @rule(new=text | botched() | st.text(max_size=30))
    def edit(self, new):
        findings = self.session.edit(new)
        assert self.session.text == new
        assert not {"LRP690", "LRP699"} & {finding.code for finding in findings}

    @rule(start=st.integers(0, 400), whole=text)
    def type_a_few_characters(self, start, whole):
        for end in range(start, start + 8):
            self.session.edit(whole[:end] + whole[end + 3 :])

    @rule(seconds=st.floats(0, 3))
    def run(self, seconds):
        self.session.run(seconds)

    @rule()
    def step(self):
        tick, time = self.session.frame.tick, self.session.frame.time
        self.session.step()
        assert self.session.frame.tick == tick + 1
        assert self.session.frame.time > time

    @rule(where=path, teleport=st.booleans())
    def force(self, where, teleport):
        (self.session.teleport_to if teleport else self.session.transition_to)(where)

    @rule(where=variable, value=expression)
    def set_variable(self, where, value):
        with suppress(LRPError, SyntaxError, NameError, TypeError):  # an expression's own errors come through
            self.session.set_variable(where, value)

    @rule(
        kind=st.sampled_from(["state", "machine", "event", "variable", "transition"]),
        where=path,
        new=st.sampled_from(["z", "a", "class", "1", "", "on"]),
    )
    def rename(self, kind, where, new):
        with suppress(LRPError, ValueError):
            assert self.session.rename(kind, where, new) == self.session.text

    @rule(ticks=st.integers(-1, 30))
    def rewind(self, ticks):
        tick = self.session.frame.tick
        try:
            self.session.rewind(ticks)
        except (LRPError, ValueError):
            assert self.session.frame.tick == tick
        else:
            assert self.session.frame.tick == tick - ticks

    @rule()
    def reset(self):
        self.session.reset()

    @rule()
    def pause(self):
        self.session.pause()

    @rule()
    def resume(self):
        self.session.resume()

    @rule(rate=st.sampled_from([0, 1, 7.5, 10, 100, 1e6, 0.5, -1, float("nan"), float("inf"), 1e-9]))
    def set_rate(self, rate):
        try:
            self.session.rate = rate
        except ValueError:
            assert rate not in (0, 1, 7.5, 10, 100, 1e6, 0.5)

    @rule(speed=number)
    def set_speed(self, speed):
        try:
            self.session.speed = speed
        except ValueError:
            assert not speed > 0

    @rule(pose=st.tuples(number, number, number))
    def drag_the_robot(self, pose):
        with suppress(LRPError):
            self.session.bridge.place_robot(pose)

    @rule()
    def draw_and_reset_the_world(self):
        self.session.bridge.draw(((0.2, 0.2), (1.0, 1.0)))
        self.session.bridge.reset_world()

    @precondition(lambda self: self.session.frame.tick > 50)
    @rule()
    def stop_and_start_again(self):
        self.session.stop()
        self.session.run(0.1)

    @invariant()
    def nothing_is_broken(self):
        if not hasattr(self, "session"):
            return
        assert self.session.fault == ""
        frame = self.session.frame
        assert frame.status in ("ready", "running", "paused", "stopped")
        states = {
            (str(machine.name), str(state.name))
            for _, machine in frame.program.walk()
            for state in machine.states
        }
        for active in frame.active:
            assert active[-2:] in states
        assert {issue.kind for issue in frame.issues} <= set(IssueKind.__args__)

    def teardown(self):
        if hasattr(self, "session"):
            self.session.close()
            assert self.session.status == "closed"


TestAnything = Anything.TestCase
TestAnything.settings = settings(
    max_examples=settings().max_examples // 2, stateful_step_count=25, deadline=None
)


@pytest.mark.parametrize(
    "name",
    ["own", "exit", *(pytest.param(name, marks=pytest.mark.slow) for name in PROGRAMS if name != "exit")],
)
def test_typing_a_program_letter_by_letter_never_stops_the_one_that_runs(session, name):
    whole = PROGRAMS.get(name, OWN)
    typing = session(OWN, "sim", world="empty")
    for end in range(0, len(whole) + 1, 1 if name in ("own", "follower") else 3):
        typing.edit(whole[:end])
        typing.step()
    typing.edit(whole)
    typing.step()
    assert typing.fault == ""
    assert typing.program.text == typing.text == whole
    assert typing.frame.active or name == "own"
