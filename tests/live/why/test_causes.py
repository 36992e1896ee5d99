"""Every transition has one reason in every tick: the one that an interpreter saw that notes them all."""

from numbers import Real
from types import SimpleNamespace

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from support.reference import Reference, Skip, find
from support.wild import program

from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.interpreter.tick_reasons import cause_in
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Element
from lrp_jupyter.language.resolution import resolve
from lrp_jupyter.language.triggers import Delay, Occurrence
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
        self.entered.append((m.machine, state.name))
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
                    self.exits.append(self.path(home))
                    self.leave(home)
                    self.enter(home, target)
                    self.tick(home, fires=False)
                    return t.kind == "exit"
                self.seen[path, id_] = "unknown-destination"
            else:
                false = "delay-not-over" if isinstance(t.trigger, Delay) else "condition-false"
                self.seen[path, id_] = self.fault or false
        for block in m.state.running:
            self.attempt(block, m.scope)
        for n in list(m.inside):
            if self.tick(n):
                break
        return False

    def enabled(self, t, m):
        if isinstance(t.trigger, Occurrence):
            around = m
            while around is not None and not find(around.machine.events, t.trigger.event):
                around = around.home
            if around is None and not find(self.program.events, t.trigger.event):
                self.fault = "unknown-event"
                return False
        self.value = 0
        holds = super().enabled(t, m)
        if isinstance(t.trigger, Delay) and self.fault != "raised":
            delay = self.value
            number = isinstance(delay, Real) and not isinstance(delay, bool) and delay == delay
            self.fault = None if number else "raised"
        return holds

    def run(self, block, scope):
        try:
            value = super().run(block, scope)
        except Skip:
            self.fault = "raised"
            raise
        self.value = value
        if not isinstance(value, bool):
            self.fault = "not-boolean"
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
            return self.not_there(machine, t, "source-inactive")
        if (path, id_) in self.seen:
            return self.seen[path, id_]
        if path in self.done:
            return "earlier-fired"
        home = next(home for home in self.exits if path[: len(home)] == home)
        return "exit-took-parent" if self.by_exit(home, path) else "outer-fired"

    def not_there(self, machine, t, code):
        """The reason of a transition whose source was not active when the tick began."""
        entered = any(each is machine and t.leaves(name) for each, name in self.entered)
        return "just-entered" if entered else code

    def by_exit(self, home, path):
        """Whether a machine beside, and not around, this one took the outer machine along."""
        return not any(
            path[: len(other)] == other and self.seen.get((other, id_)) == "fired" for other, id_ in self.seen
        )


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
        by_definition = {}
        for machine in i.history.state(tick + 1, before=True).walk():
            by_definition[machine.state[:-1]] = machine.path
        expected.append({})
        for where, scope in resolve(i.program).by_path.items():
            path, machine = by_definition.get(where), scope.noun
            for number, id_ in enumerate(machine.ids if machine else ()):
                code = witness.not_there(machine, machine.transitions[number], "machine-not-running")
                if path is not None:
                    code = witness.code(*known[path], number)
                expected[-1][Element("transition", (*where, id_))] = code
    for tick, each in enumerate(expected, 1):
        for element, code in each.items():
            found = cause_in(i.history.state(tick, before=True), i.history.facts(tick), element).code
            assert (found, found in EXPLANATIONS["transition"]) == (code, True), f"{element} in tick {tick}"
