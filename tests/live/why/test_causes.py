"""Every transition has one reason in every tick: the one that an interpreter saw that notes them all."""

from numbers import Real
from types import SimpleNamespace

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from support.reference import Reference, Skip, find
from support.wild import program

from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.interpreter.tick_reasons import cause_in
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Element
from lrp_jupyter.language.resolution import resolve
from lrp_jupyter.language.triggers import InState, Occurrence
from lrp_jupyter.live.reason import EXPLANATIONS

slow = settings(suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])


class Witness(Reference):
    """The reference, which notes of every transition what became of it in a tick."""

    def step(self, now):
        self.seen, self.fault = {}, None
        self.begun = [(self.path(m), m.machine, m.state) for m in self.everything()]
        self.done, self.exits, self.entered = set(), [], []
        super().step(now)

    def enter(self, m, state):
        self.entered.append((self.path(m), m.machine, state.name))
        super().enter(m, state)

    def tick(self, m, fires=True):
        if not fires:
            return super().tick(m, fires)
        path = self.path(m)
        self.done.add(path)
        for t, id_ in zip(m.machine.transitions, m.machine.ids, strict=True):
            if not t.leaves(m.state.name):
                continue
            self.fault = None
            holds = self.enabled(t, m)
            if holds:
                home = m.parent if t.kind == "exit" else m
                target = home and find(home.machine.states, t.destination)
                if target:
                    self.seen[path, id_] = "fired"
                    for block in t.effect:
                        self.attempt(block, m)
                    self.exits.append(self.path(home))
                    self.leave(home)
                    self.enter(home, target)
                    self.tick(home, fires=False)
                    return t.kind == "exit"
                self.seen[path, id_] = "unknown-destination"
            else:
                false = "delay-not-over" if self.waits else "condition-false"
                self.seen[path, id_] = self.fault or false
        for block in m.state.running:
            self.attempt(block, m)
        for n in list(m.inside):
            if self.tick(n):
                break
        return False

    def enabled(self, t, m):
        self.waits = False
        if isinstance(t.trigger, Occurrence) and self.event(t.trigger.event, m) is None:
            self.fault = "unknown-event"
            return False
        if isinstance(t.trigger, InState):
            states = [state for state in m.machine.states if t.leaves(state.name)]
            found = [self.spawnable(t.trigger.machine, m, find(states, state.name)) for state in states]
            if not any(each and find(each[0].states, t.trigger.state) for each in found):
                self.fault = "unknown-event"
                return False
        return super().enabled(t, m)

    def is_over(self, delay, m, since):
        self.value = 0
        over = super().is_over(delay, m, since)
        number = isinstance(self.value, Real) and not isinstance(self.value, bool)
        self.fault, self.waits = None if number and self.value == self.value else "raised", not over
        return over

    def run(self, block, m, place=None):
        try:
            value = super().run(block, m, place)
        except Skip:
            self.fault = "raised"
            raise
        self.value = value
        self.fault = None if isinstance(value, bool) else "not-boolean"
        return value

    def read(self, name, scope):
        try:
            self.value = super().read(name, scope)
            return self.value
        except Skip:
            self.fault = "raised"
            raise

    def code(self, path, machine, state, number):
        t, id_ = machine.transitions[number], machine.ids[number]
        if not t.leaves(state.name):
            return self.not_there(machine, t, "source-inactive", path)
        if (path, id_) in self.seen:
            return self.seen[path, id_]
        if path in self.done:
            return "earlier-fired"
        home = next(home for home in self.exits if path[: len(home)] == home)
        return "exit-took-parent" if self.by_exit(home, path) else "outer-fired"

    def not_there(self, machine, t, code, path=None):
        """The reason of a transition whose source was not active when the tick began."""
        entered = any(
            each is machine and path in (None, where) and t.leaves(name) for where, each, name in self.entered
        )
        return "just-entered" if entered else code

    def by_exit(self, home, path):
        """Whether a machine beside, and not around, this one took the outer machine along."""
        return not any(
            path[: len(other)] == other and self.seen.get((other, id_)) == "fired" for other, id_ in self.seen
        )


@pytest.mark.slow
@slow
@given(program, st.lists(st.sampled_from([0, 1]), min_size=1, max_size=25))
def test_the_reason_is_the_one_that_was_seen(text, lights):
    robots = SimpleNamespace(light=0), SimpleNamespace(light=0)
    parsed = parse(text)
    i, witness = Interpreter(parsed, robots[0]), Witness(parsed, robots[1])
    expected = []
    for tick, light in enumerate(lights):
        for robot, each in zip(robots, (i, witness), strict=True):
            robot.light = light
            each.step(tick / 10)
        known = {each[0]: each for each in witness.begun}
        instances = {}
        for machine in i.history.state(tick + 1, before=True).walk():
            instances.setdefault(machine.state[:-1], []).append(machine.path)
        expected.append({})
        for where, scope in resolve(i.program).by_path.items():
            machine = scope.noun
            for number, id_ in enumerate(machine.ids if machine else ()):
                element = Element("transition", (*where, id_))
                for path in instances.get(where, ()):
                    expected[-1][element, path] = witness.code(*known[path], number)
                if where not in instances:
                    t = machine.transitions[number]
                    expected[-1][element, None] = witness.not_there(machine, t, "machine-not-running")
    for tick, each in enumerate(expected, 1):
        before, after, facts = (
            i.history.state(tick, before=True),
            i.history.state(tick),
            i.history.facts(tick),
        )
        for (element, path), code in each.items():
            machine = path and after.machine(element.path[:-1], path)
            holds = bool(machine) and element.path[-1] in machine.holding
            found = cause_in(before, facts, element, path, holds=holds).code
            assert (found, found in EXPLANATIONS["transition"]) == (code, True), f"{element} in tick {tick}"
