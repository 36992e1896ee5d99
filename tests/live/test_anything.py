"""Whatever is done to a session: nothing breaks it, and five oracles agree.

The run is what the reference makes of the program; going back restores each earlier moment; the recording is
reproduced; a fork comes to the present; and a page that reads now and then shows what a new page is shown.
"""

import random
from contextlib import suppress
from tempfile import TemporaryDirectory
from typing import get_type_hints

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule
from support import wild
from support.bench import Bench
from support.reference import Reference
from support.robots import Bare
from support.sessions import come_to_the_end, seen, values
from support.story import HERE

from lrp_jupyter.errors import LRPError
from lrp_jupyter.interpreter.issues import IssueKind
from lrp_jupyter.language.checks import check
from lrp_jupyter.language.parser import scan
from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.recording import read_recording
from lrp_jupyter.live.reproduction import reproduce
from lrp_jupyter.live.running import checkpoints
from lrp_jupyter.live.session import Session
from lrp_jupyter.widgets.wire.protocol import ViewState

REFUSED = (LRPError, ValueError, SyntaxError, NameError, TypeError)
SMALL = [path.read_text("utf-8") for path in sorted((HERE / "programs").glob("*.lrp"))]
MARKS = st.sampled_from([{"gain": 3}, {"gain": 0.5}, {"marks": [7]}, {"marks": []}])

tame = precondition(lambda self: not self.hostile)
simulated = precondition(lambda self: self.session.bridge.name == "sim")
lit = precondition(lambda self: self.session.bridge.name != "sim")
has_run = precondition(lambda self: self.session.frame.tick > 0)


def lamp_that_tests_switch():
    return Bare(lambda robot: robot.add_variable("light", lambda: robot.shining), shining=0)


class Anything(RuleBasedStateMachine):
    """A session that is recorded from its first tick on, and shown in a page."""

    hostile = False

    @initialize(
        lamp=st.booleans(),
        rate=st.sampled_from([10, 10, 25, 7, 100]),
        keep=st.booleans(),
        pause=st.sampled_from([False, False, True]),
        journal=st.sampled_from([None, None, None, 5, 0]),
        world=st.sampled_from(["line", "boxes", "empty"]),
        noise=st.booleans(),
        data=st.data(),
    )
    def begin(self, lamp, rate, keep, pause, journal, world, noise, data):
        self.lines = []
        common = {
            "clock": VirtualClock(),
            "rate": rate,
            "on_active_edit": "keep" if keep else "restart",
            "on_issue": "pause" if pause else "record",
            "journal": journal,
            "namespace": {"gain": 1, "marks": [1, 2]},
        }
        if lamp:
            self.session = Session(data.draw(st.sampled_from(SMALL)), lamp_that_tests_switch(), **common)
        else:
            first = data.draw(st.sampled_from([wild.ROVING, wild.ROVING, *wild.BUNDLED.values()]))
            rough = {"motor": 0.1, "light": 8, "odom": 0.05} if noise else None
            self.session = Session(first, "sim", world=world, noise=rough, **common)
        self.patches = pytest.MonkeyPatch()
        self.patches.setattr(checkpoints, "_SPACING", 7)
        self.patches.setattr(checkpoints, "_SHARE", 0)  # however long one takes
        self.lab = Bench(self.session)
        self.recorder = self.session.recorder(self.lines.append)
        self.page = self.lab.page()
        self.frames, self.reference, self.went_back = {}, None, 0
        self.happenings, self.cursor = [], None
        self.begin_reference()
        self.go_on(1)

    # -- the oracles -------------------------------------------------------------------------------

    def begin_reference(self):
        """Let the reference start with the session, where it knows the robot and all blocks."""
        program = self.session.program
        known = self.session.bridge.name != "sim" and "(onpause" not in program.text
        self.reference = (
            Reference(program, self.session.bridge.robot, self.session.namespace) if known else None
        )

    def follow(self):
        """After a tick: the reference does the same, and the moment is remembered."""
        i = self.session.interpreter
        if self.hostile:  # not even its values can be looked at
            return
        if self.reference is not None:
            self.reference.step(i.now)
            assert i.active == self.reference.active, f"after tick {i.tick}"
            assert values(i) == {p: repr(v) for p, v in self.reference.variables.items() if not callable(v)}
        self.frames[i.tick] = (i.active, values(i), i.program.text, i.now)

    def acted(self):
        """Something was done that the reference does not know."""
        self.reference = None

    def teardown(self):
        if not hasattr(self, "session"):
            return
        try:
            self.judge()
        finally:
            self.patches.undo()

    def judge(self):
        """At the end, ask the oracles for which the run has to be over."""
        session, lab = self.session, self.lab
        self.go_on(0.5)
        if session.frame.tick and not self.hostile:
            self.reproduced()
            if session.bridge.name == "sim":  # forks with another robot are fed what it has read
                self.forked()
        lab.publish()
        shown, new = self.page, lab.page("new")
        lab.publish()
        assert shown.text == new.text
        for field in get_type_hints(ViewState):
            assert shown.merged(field) == new.merged(field), field
        lab.connection.close()
        assert lab.connection.fault == ""
        session.close()
        assert session.status == "closed"

    def reproduced(self):
        session = self.session
        session.call(lambda: None)  # what waits to be done to the world
        session.call(self.recorder.end)
        with TemporaryDirectory() as folder:
            path = f"{folder}/run.lrplog"
            with open(path, "w", encoding="utf-8", errors="surrogatepass") as stream:
                stream.writelines(self.lines)
            again = reproduce(read_recording(path))
        with again.session:
            if (
                again.difference is not None
            ):  # of a robot, what a block reads between two ticks is not recorded
                assert "was not read in this tick" in str(again.difference)
            else:
                assert seen(again.session) == seen(session)

    def forked(self):
        session, present = self.session, seen(self.session)
        kept = session._loop.record.checkpoints.all
        if not kept:
            return
        now = session.frame.tick
        first = max(kept[0].tick, now - session.interpreter.journal)
        for tick in {now, random.Random(len(self.lines)).randint(first, now)}:
            with session.fork(tick, inputs=True) as fork:
                assert fork.frame.tick == tick
                refusal = come_to_the_end(fork, session)
                if tick >= self.went_back:
                    assert refusal == ""
                    assert seen(fork) == present, f"from tick {tick}"
                elif refusal:
                    assert "the session went back to it, and" in refusal
                else:  # counts went on over a rewind
                    there, here = fork.frame, session.frame
                    assert (there.tick, there.time, there.active) == (here.tick, here.time, here.active)
                    assert (there.numbers, there.readings) == (here.numbers, here.readings)
        assert seen(session) == present, "the session does not notice"

    @invariant()
    def nothing_is_broken(self):
        if not hasattr(self, "session"):
            return
        frame = self.session.frame
        assert (self.session.fault, self.lab.connection.fault) == ("", "")
        assert frame.status in ("ready", "running", "paused", "stopped")
        states = {
            (str(machine.name), str(state.name))
            for _, machine in frame.program.walk()
            for state in machine.states
        }
        for active in frame.active:
            assert active[-2:] in states
        assert {issue.kind for issue in frame.issues} <= set(IssueKind.__args__)

    # -- time --------------------------------------------------------------------------------------

    def go_on(self, seconds):
        self.session.run(seconds, after_tick=self.follow)

    # half of what happens is that time passes
    run, again, more, on, further, later = map(
        rule(seconds=st.sampled_from([0.1, 0.3, 1.0, 2.2])), [go_on] * 6
    )

    @rule()
    def step(self):
        tick, time = self.session.frame.tick, self.session.frame.time
        self.session.step()
        assert self.session.frame.tick == tick + 1
        assert self.session.frame.time > time
        self.follow()

    @rule(ticks=st.integers(-1, 12))
    def rewind(self, ticks):
        tick = self.session.frame.tick
        try:
            self.session.rewind(ticks)
        except (LRPError, ValueError):
            assert self.session.frame.tick == tick
            return
        self.acted()
        now = self.went_back = tick - ticks
        assert self.session.frame.tick == now
        self.frames = {tick: frame for tick, frame in self.frames.items() if tick <= now}
        if now and not self.hostile:
            i = self.session.interpreter
            assert (i.active, i.program.text) == (self.frames[now][0], self.frames[now][2])
            assert unchanging(values(i)) == unchanging(self.frames[now][1])

    @rule()
    def pause(self):
        self.session.pause()

    @rule()
    def resume(self):
        self.session.resume()

    @rule()
    def reset(self):
        self.session.reset()
        self.begin_reference()

    @rule(rate=st.sampled_from([0, 1, 7.5, 10, 100, -1, float("nan"), float("inf"), 1e-9]))
    def set_rate(self, rate):
        try:
            self.session.rate = rate
        except ValueError:
            assert rate not in (0, 1, 7.5, 10, 100)

    @has_run
    @rule()
    def stop_and_start_again(self):
        self.session.stop()
        self.acted()
        self.session.run(0.1, after_tick=self.follow)

    # -- the program -------------------------------------------------------------------------------

    def offers(self, text):
        findings = self.session.edit(text)
        self.acted()
        assert self.session.text == text
        assert not {"LRP690", "LRP699"} & {finding.code for finding in findings}

    @rule(change=wild.change)
    def edit(self, change):
        self.offers(wild.changed(self.session.text, *change))

    @rule(change=wild.change)
    def edit_and_undo(self, change):
        text, running = self.session.text, self.session.program.text
        self.offers(wild.changed(text, *change))
        self.offers(text)
        assert self.session.program.text == running or text != running

    @tame
    @rule(change=wild.change)
    def type_in_the_page(self, change):
        self.lab.publish()
        assert self.page.text == self.session.text
        text = wild.changed(self.page.text, *change)
        answer = self.page.type(text)
        self.acted()
        assert self.page.text == self.session.text == text
        assert answer["accepted"] == (scan(text)[0] is not None)

    @rule(place=st.sampled_from(wild.ROVING_EDITS))
    def edit_here_and_there(self, place):
        self.offers(self.session.text.replace(*place, 1))

    @rule(new=st.sampled_from([wild.ROVING, *SMALL, *wild.BUNDLED.values()]))
    def edit_all(self, new):
        self.offers(new)

    @rule(
        order=wild.renaming
        | st.tuples(st.just("state"), st.just("m/back"), st.sampled_from(["back", "away"]))
    )
    def rename(self, order):
        with suppress(LRPError, ValueError):
            assert self.session.rename(*order) == self.session.text
            self.acted()

    @rule(number=st.integers(0, 40), nowhere=st.sampled_from(["", "", "", "nope"]), teleport=st.booleans())
    def force(self, number, nowhere, teleport):
        walk = self.session.program.walk()
        states = [(*path, str(state.name)) for path, machine in walk for state in machine.states]
        where = nowhere or (states[number % len(states)] if states else "nope")
        (self.session.teleport_to if teleport else self.session.transition_to)(where)
        self.acted()

    @rule(where=wild.somewhere | st.sampled_from(["hit", "dim", "again", "away", "flip", "m/turn/inner/out"]))
    def fire(self, where):
        with suppress(LRPError, ValueError):
            self.session.fire(where)
        self.acted()

    @rule(where=wild.variable_path, value=wild.expression)
    def set_variable(self, where, value):
        with suppress(*REFUSED, ZeroDivisionError):  # an expression's own errors come through
            self.session.set_variable(where, evaluate=value)
        self.acted()

    @rule(where=wild.variable_path, value=st.sampled_from([0.1, 3, [7], None]))
    def assign(self, where, value):
        with suppress(*REFUSED):
            self.session.variables[where] = value
        self.acted()

    @rule(policy=st.sampled_from(["keep", "restart", "record", "pause"]))
    def choose_a_policy(self, policy):
        setattr(self.session, "on_issue" if policy in ("record", "pause") else "on_active_edit", policy)

    @rule(marks=MARKS)
    def assign_in_the_notebook(self, marks):
        self.session.namespace |= marks
        self.acted()

    # -- the robot and its world -------------------------------------------------------------------

    @lit
    @rule(light=st.sampled_from([0, 1]))
    def shine(self, light):
        self.session.bridge.shining = light

    @rule()
    def stop_the_robot(self):
        self.session.stop_robot()

    @simulated
    @rule(
        x=st.floats(-1, 2) | st.just(float("nan")),
        y=st.floats(0.3, 1.2),
        angle=st.floats(-3, 3),
        what=st.sampled_from(["place", "place", "draw", "reset", "move", "ask"]),
    )
    def change_the_world(self, x, y, angle, what):
        bridge = self.session.bridge
        with suppress(LRPError, ValueError):
            if what == "place":
                bridge.place_robot((x, y, angle))
            elif what == "draw":
                bridge.draw(((x, y), (1.0, 1.0)))
            elif what == "reset":
                bridge.reset_world()
            elif what == "ask":
                self.session.call(lambda: bridge.robot.drive_to(x, y))
            else:
                self.session.call(lambda: bridge.robot.move(linear=0.2))
        self.session.call(lambda: None)

    # -- looking -----------------------------------------------------------------------------------

    @rule()
    def publish(self):
        self.lab.publish()

    @rule()
    def read_the_timeline(self):
        """A page that asks now and then has what it would get if it asked for everything."""
        part = self.session.timeline(self.cursor)
        kept = [each for each in self.happenings if each.tick <= part.kept]
        self.happenings, self.cursor = [*kept, *part.happenings], part.cursor
        if self.session.interpreter.journal == self.session.frame.tick:  # it remembers all, as the page does
            assert self.happenings == list(self.session.timeline().happenings)

    @has_run
    @tame
    @rule(back=st.integers(0, 20))
    def look_back(self, back):
        tick = self.session.frame.tick - back
        if back < self.session.interpreter.journal and tick in self.frames:
            past, (active, then, text, now) = self.session.at(tick), self.frames[tick]
            assert (past.active, past.program.text, past.time) == (active, text, now)
            assert {path: repr(past.values[path]) for path in unchanging(then)} == unchanging(then)

    @rule(what=wild.waited_for, after=st.integers(0, 3), once=st.booleans())
    def pause_when(self, what, after, once):
        with suppress(*REFUSED):
            kind, argument = what
            self.session.pause_when(**{kind: argument}, after=after, once=once)

    @rule(number=st.integers(0, 3), enabled=st.sampled_from([True, False, None]))
    def change_a_breakpoint(self, number, enabled):
        with suppress(ValueError):
            if enabled is None:
                self.session.remove_breakpoint(number)
            else:
                self.session.set_breakpoint(number, enabled)

    @has_run
    @tame
    @rule(seconds=st.floats(0.1, 0.5))
    def fork(self, seconds):
        """A fork goes on as the session does, and the session does not notice it."""
        if any(each.enabled for each in self.session.breakpoints):
            return
        present = seen(self.session)
        with self.session.fork() as fork:
            assert seen(fork) == present
            fork.run(seconds)
            assert seen(self.session) == present
            if self.session.bridge.name == "sim":  # what another robot will see is not known
                self.session.run(seconds, after_tick=self.follow)
                assert seen(fork) == seen(self.session)


def unchanging(texts):
    """Values without those that may be changed in place."""
    return {path: text for path, text in texts.items() if text[:1] not in "[{("}


class Hostile(Anything):
    """A session whose programs do what they can to harm it. They cannot be repeated: only the page judges."""

    hostile = True

    @rule(new=wild.hostile | wild.damaged)
    def edit_maliciously(self, new):
        self.offers(new)


TestAnything = Anything.TestCase
TestAnything.settings = settings(stateful_step_count=25)
TestHostile = Hostile.TestCase
TestHostile.settings = settings(max_examples=settings().max_examples // 2, stateful_step_count=25)


@given(wild.damaged)
def test_any_text_is_explained(text):
    program, findings = scan(text)
    assert (program is None) == any(finding.severity == "error" for finding in findings)
    if program is not None:
        assert program.text == text
        findings = check(program)
    lines = text.count("\n") + text.count("\r") + 2
    for finding in findings:
        assert 1 <= finding.line <= finding.end_line <= lines, finding
        assert finding.column >= 1
        assert finding.message
        for start, end, _ in finding.fix.edits if finding.fix else ():
            assert 0 <= start <= end <= len(text), finding


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [
        "roving",
        "exit",
        *(pytest.param(name, marks=pytest.mark.slow) for name in wild.BUNDLED if name != "exit"),
    ],
)
def test_typing_a_program_letter_by_letter_never_stops_the_one_that_runs(session, name):
    whole = wild.BUNDLED.get(name, wild.ROVING)
    typing = session(wild.ROVING, "sim", world="empty", namespace={"gain": 1, "marks": []})
    for end in range(0, len(whole) + 1, 1 if name in ("roving", "follower") else 3):
        typing.edit(whole[:end])
        typing.step()
    typing.edit(whole)
    typing.step()
    assert typing.fault == ""
    assert typing.program.text == typing.text == whole
    assert typing.frame.active
