"""A machine that several states use behaves as a copy of it in each of them, with the settings in place."""

from types import SimpleNamespace
from typing import NamedTuple

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from support.story import ORDINARY
from support.wild import moment

from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.language.parser import parse

slow = settings(suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])
_of = st.sampled_from
ANY = ["g += 1", "g = elapsed", "1 / (g % 3)", "g += dt", "h = e", ""]
INSIDE = _of([*ANY, "v += 1", "w = g", "g += w", "w = elapsed", "del v", "h = f"])
OUTSIDE = _of([*ANY, "q += 1", "g = n.v", "h = n.state", "q = n.w", "nope"])
TRUE = ["True", "g % 2 == 0", "robot.light == 1", "elapsed >= 0.2", "e", "5"]
IN, OUT = _of([*TRUE, "v > 1", "w > g", "f"]), _of([*TRUE, "n.state == 'x'", "q > 2", "n.v > 1"])
OWN = _of(["0", "1", "g + 1", "elapsed", "robot.light"])
SET = _of(["7", "q", "q + g", "nope", "e", "h", "g * 2"])
FOR = _of(["", "", " for 100", " for 200", " for g"])
x, a = _of("xxyyz"), _of("aabbc")


def _transitions(keyword, state, test, action, to):
    form = "({} {}{} {} -> {}{})".format
    effect = st.just("") | action.map(" (effect [{}])".format)
    tests = test.map("[{}]".format) | _of(["e", "nope"]) | x.map("n.{}".format)
    held = st.builds(form, keyword, tests, FOR, state, to, effect)
    return held | st.builds(form, st.just("ontime"), _of(["100", "250", "g"]), st.just(""), state, to, effect)


class Text(NamedTuple):
    """A program: the variables of the shared machine `n`, the rest of it, and those that use it."""

    top: str
    own: dict
    part: str
    q: str
    users: tuple

    def shared(self, setting=()):
        own = "".join(
            f" (var {name} := [{dict(setting).get(name, text)}])" for name, text in self.own.items()
        )
        return f"(machine n{own} {self.part})"

    def edited(self, other, taken):
        """What it is with some fields of another one; what is spawned stays the same."""
        new = {field: getattr(other, field) for field in taken}
        if "users" in taken:
            _, states, transitions = other.users[0]
            new["users"] = tuple(
                (name, tuple((o[0], *n[1:]) for o, n in zip(old, states, strict=True)), transitions)
                for name, old, _ in self.users
            )
        return self._replace(**new)

    def text(self, expanded):
        users = []
        for name, states, transitions in self.users:
            inside = ""
            for state, (start, setting, entry, running, leaving) in zip("abc", states, strict=True):
                set_ = "" if expanded else "".join(f" (var {k} := [{v}])" for k, v in setting.items())
                inside += f"\n  (state {state} (onentry [{entry}]) (running [{running}]) (onexit [{leaving}])"
                if start:
                    inside += f" (onentry (spawn n {start}{set_})) {self.shared(setting) if expanded else ''}"
                inside += ")"
            users.append(f"(machine {name} (var q := [{self.q}])\n  {transitions}{inside})\n(spawn {name} a)")
        return f"(var g := [{self.top}])(var h := [1])(event e [g > 2])\n{self.shared()}\n" + "\n".join(users)


def _state(actions):
    setting = st.dictionaries(_of("vw"), SET, max_size=2)
    return st.tuples(x | st.just(""), setting, actions, actions, actions)


@st.composite
def texts(draw):
    inside = _transitions(st.just("on"), x, IN, INSIDE, x) | _transitions(st.just("exit"), x, IN, INSIDE, a)
    own = draw(st.fixed_dictionaries({"v": OWN, "w": OWN | st.just("v + 1")}))
    states = "".join(f"(state {s} (running [{draw(INSIDE)}]) (onexit [{draw(INSIDE)}]))" for s in "xyz")
    part = (
        "".join(draw(st.lists(inside, min_size=1, max_size=3)))
        + f"(event f [{draw(_of(['v > 2', 'e']))}]) {states}"
    )
    users = []
    for name in draw(_of(["m", "mo"])):
        arrows = st.lists(_transitions(st.just("on"), a, OUT, OUTSIDE, a), min_size=1, max_size=4)
        users.append((name, draw(st.tuples(*[_state(OUTSIDE)] * 3)), "".join(draw(arrows))))
    return Text(draw(_of(["0", "3"])), own, part, draw(_of(["0", "4", "g"])), tuple(users))


@pytest.mark.slow
@slow
@given(texts(), texts(), st.sets(_of(Text._fields)), st.lists(_of([0, 1]), max_size=16), st.booleans())
def test_a_shared_machine_behaves_as_its_copies(one, other, taken, lights, keep):
    edited = one.edited(other, taken)
    robots, seen = [SimpleNamespace(light=0) for _ in range(2)], ([], [])
    runs = [
        Interpreter(parse(one.text(expanded)), robot, on_active_edit="keep" if keep else "restart")
        for expanded, robot in enumerate(robots)
    ]
    for i, events in zip(runs, seen, strict=True):
        i.observe(lambda e, to=events: to.append((e.kind, e.path, e.tick)) if e.kind in ORDINARY else None)
    for tick, light in enumerate(lights):
        for expanded, (i, robot) in enumerate(zip(runs, robots, strict=True)):
            robot.light = light
            i.step(tick / 10)
            if tick == len(lights) // 2:
                i.patch(parse(edited.text(expanded)))
        assert moment(runs[0]) == moment(runs[1])
        assert seen[0] == seen[1]
