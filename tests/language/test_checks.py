"""Static checks: what they find in names, references and the graph of states."""

from __future__ import annotations

import re
import socket
import subprocess
from importlib.util import find_spec
from types import ModuleType

from checking import fixed, found, start_of
from hypothesis import given
from hypothesis import strategies as st
from programs import programs
from support.tables import every

import lrp_jupyter
from lrp_jupyter.errors import MOST_FINDINGS
from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.language.checks import CODES, Code, check, report
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.printer import to_source
from lrp_jupyter.language.program import Block, Machine, Name, Program, Spawn, State, Transition
from lrp_jupyter.language.resolution import Scope, resolve
from lrp_jupyter.language.triggers import Epsilon
from lrp_jupyter.programs import heading

KNOWN = find_spec("pymunk") is not None  # else the members of a simulated robot are not
EXAMPLES = [  # those of a run are in tests/test_codes.py
    code for code in CODES.values() if code.code < "LRP6" and (KNOWN or not heading(code.example).world)
]


# The table


@every("code", EXAMPLES)
def test_an_example_has_its_code_and_no_other(code: Code) -> None:
    findings = lrp_jupyter.check(code.example)
    assert {(finding.code, finding.severity) for finding in findings} == {(code.code, code.severity)}
    for finding in findings:
        assert re.fullmatch(r"(`|[A-Z]).*[.?]", finding.message)


@every("code", EXAMPLES)
def test_a_repaired_example_has_no_findings(code: Code) -> None:
    assert lrp_jupyter.check(code.repaired) == ()


def test_a_program_and_its_text_have_the_same_findings() -> None:
    text = "(machine m (state a) (on e a -> b))"
    assert check(parse(text)) == check(text) != ()


# 2xx: names


@every("newline", ["\n", "\r\n", "\r"])
def test_a_missing_spawn_is_reported_at_the_first_line_and_added_where_it_is_certain(newline: str) -> None:
    text = f"; a robot{newline}(machine m (state a))"
    assert found(text) == [("LRP206", "; a robot")]
    assert fixed(text) == f"{text}{newline}{newline}(spawn m a){newline}"
    assert fixed(text + newline) == f"{text}{newline}{newline}(spawn m a){newline}"


# 3xx: references


# 4xx: reachability


@every(
    ("first", "second"),
    [
        ("(eps a -> b)", "(on e a -> c)"),
        ("(ontime 0 a -> b)", "(eps a -> c)"),
        ("(on e a -> b)", "(on e a -> c)"),
        ("(on e *-> b)", "(on e {a c} -> b other)"),
        ("(on [robot.x] a -> b)", "(on [ robot.x ] a -> c)"),
        ("(ontime 500 a -> b)", "(ontime 500 a -> c)"),
        ("(ontime 500 a -> b)", "(ontime 900 a -> c)"),
        ("(ontime v a -> b)", "(ontime v a -> c)"),
        ("(ontime [v * 2] a -> b)", "(ontime [v*2] a -> c)"),
        ("(ontime 900 a -> b)(ontime 500 a -> b x)", "(ontime 600 a -> c)"),
    ],
)
def test_a_transition_after_one_that_always_fires_first_is_never_tested(first: str, second: str) -> None:
    frame = (
        "(var v := [100])(event e [robot.b])(machine m (state a) (state b) (state c) {}"
        "(on [robot.u] *-> c u) (on e b -> c v) (ontime v b -> a w)) (spawn m a)"
    )
    assert found(frame.format(first + second)) == [("LRP404", second)] or first.startswith(
        ("(eps", "(ontime 0")
    )
    assert ("LRP404", second) in found(frame.format(first + second))
    assert ("LRP404", second) not in found(frame.format(second + first))


@every(
    "pair",
    [
        "(on e a -> b)(on f a -> c)",
        "(on e a -> b)(on e c -> b)",
        "(on e a -> b)(on e {a c} -> b x)",
        "(ontime 900 a -> b)(ontime 500 a -> c)",
        "(ontime 500 a -> b)(on e a -> c)",
        "(ontime v a -> b)(ontime 500 a -> c)",
        "(on e *-> b)(on e b -> c)",
        "(ontime 500 a -> b)(ontime 900 {a c} -> b x)",
    ],
)
def test_transitions_that_can_both_fire_are_not_reported(pair: str) -> None:
    text = (
        "(var v := [100])(event e [robot.b])(event f [robot.c])(machine m (state a) (state b) (state c) "
        + pair
        + "(on [robot.u] *-> c u) (on [robot.w] *-> b w) (on f c -> a)) (spawn m a)"
    )
    assert "LRP404" not in [code for code, _ in found(text)]
    assert "LRP406" not in [code for code, _ in found(text)]


# Laws


TEXT = "\n".join(code.example + "\n" + code.repaired for code in EXAMPLES if code.code != "LRP111")


@given(st.data())
def test_no_text_makes_a_check_raise(data: st.DataObject) -> None:
    code = data.draw(st.sampled_from(EXAMPLES))
    start, end = sorted(data.draw(st.tuples(*[st.integers(0, len(code.repaired))] * 2)))
    begin = data.draw(st.integers(0, len(TEXT)))
    piece = TEXT[begin : begin + data.draw(st.integers(0, 30))] or data.draw(st.text(max_size=5))
    text = code.repaired[:start] + piece + code.repaired[end:]
    lines = re.split(r"\r\n|\r|\n", text)
    for finding in check(text, names={"np"}):
        assert finding.severity == CODES[finding.code].severity
        assert (1, 1) <= (finding.line, finding.column) <= (finding.end_line, finding.end_column)
        assert finding.end_column - 1 <= len(lines[finding.end_line - 1])


@given(programs)
def test_no_program_makes_a_check_raise(program: Program) -> None:
    text = to_source(program)
    assert [finding.code for finding in check(program)] == [finding.code for finding in check(program)]
    assert sorted(finding.code for finding in check(program)) == sorted(
        finding.code for finding in check(text)
    )


@given(programs)
def test_every_reference_that_does_not_resolve_is_an_error_in_its_form(program: Program) -> None:
    text = to_source(program)
    errors = [start_of(text, finding) for finding in check(text) if finding.severity == "error"]
    names = resolve(parse(text))
    dangling = [spawning.noun.span for spawning in names.spawns if spawning.unresolved]
    for arrows in names.arrows.values():
        dangling += [each.noun.span for each in arrows if each.unresolved_trigger or each.unresolved_hold]
    for span in dangling:
        assert any(span.start <= start < span.end for start in errors)


@given(programs)
def test_what_a_run_finds_no_meaning_for_is_a_finding(program: Program) -> None:
    program = parse(to_source(program))
    interpreter = Interpreter(program)
    for tick in range(3):
        interpreter.step(tick / 10)
    codes = {finding.code for finding in check(program)}
    for issue in interpreter.issues:
        if issue.kind.startswith("unknown "):
            assert any(code.startswith(("LRP3", "LRP50")) for code in codes), issue
        if issue.kind == "already running":
            assert codes & {"LRP407", "LRP408"}, issue


def test_a_program_put_together_by_hand_can_be_checked() -> None:
    states = (State(Name("a"), running=(Block("this is no Python"),)), State(Name("b")))
    exits = (Transition(Epsilon(), (Name("a"),), False, Name("b"), outward=True),)
    program = Program(
        machines=(Machine(Name("m"), states=states, transitions=exits),),
        spawns=(Spawn(Name("m"), Name("a")),),
    )
    (finding,) = check(program)
    assert (finding.code, finding.fix, finding.line) == ("LRP307", None, 1)


def unknown_states(count: int) -> str:
    return f"(machine m (state a) {' '.join(f'(eps a -> state{i})' for i in range(count))}) (spawn m a)"


def test_of_thousands_of_findings_the_first_are_listed_and_the_others_counted():
    *listed, last = check(unknown_states(1000))
    assert len(listed) == MOST_FINDINGS
    assert {finding.code for finding in listed} == {"LRP303"}
    assert (last.code, last.severity) == ("LRP698", "hint")
    assert last.message == "There are 800 more findings. Correct these first."
    assert (last.line, last.column) == (listed[-1].line, listed[-1].column)


def test_errors_are_listed_before_what_may_be_right():
    hints = " ".join(f"(state s{i})" for i in range(400))
    findings = check(f"(machine m (state a) {hints} (on nothing a -> a)) (spawn m a)")
    assert [finding.code for finding in findings].count("LRP301") == 1
    assert findings[-1].code == "LRP698"


def test_names_are_compared_within_bounds(monkeypatch):
    compared = []
    monkeypatch.setattr(report, "nearest", lambda name, known: compared.append(len(known)))
    check(
        "(machine m " + " ".join(f"(state a{i}) (eps a{i} -> b{i})" for i in range(1000)) + ") (spawn m a0)"
    )
    assert 0 < sum(compared) < 2 * report.COMPARED


N = "(machine n (var tries := [0]) (state x) (state reached) (eps x -> reached))"


@every(
    ("text", "prefix"),
    [
        ("(machine m (state moving) (state b) (ontime 500 b -> mov)) (spawn m b)", True),
        ("(machine m (state moving) (state b) (ontime 500 b -> movign)) (spawn m b)", False),
        ("(var speed := [1]) (machine m (state a (running [sp]))) (spawn m a)", True),
        ("(var speed := [1]) (machine m (state a (running [speeed]))) (spawn m a)", False),
        (f"(machine m (state a (onentry (spawn n x))) (state b) (on n.reach a -> b)) {N} (spawn m a)", True),
        (f"(machine m (state a (onentry (spawn n x)) (running [print(n.tr)]))) {N} (spawn m a)", True),
        (f"(machine m (state a (onentry (spawn n x)) (running [print(n.tires)]))) {N} (spawn m a)", False),
        ("(machine m (stat a)) (spawn m a)", True),
        ("(machine m (stata a)) (spawn m a)", False),
    ],
)
def test_a_finding_says_whether_its_name_only_begins_a_known_one(text: str, prefix: bool) -> None:
    (finding,) = check(text)
    assert finding.prefix == prefix


def test_the_states_of_a_machine_are_searched_once_for_a_name_in_their_blocks(monkeypatch):
    looked = []
    search = Scope.machine
    monkeypatch.setattr(Scope, "machine", lambda *of: looked.append(of) or search(*of))
    states = " ".join(f"(state s{i} (running [move.tries + {i}]))" for i in range(300))
    check(f"(machine m {states}) (machine move (var tries := [0])) (spawn m s0)")
    assert len(looked) < 1000


# 55x: what acts past `robot`


ROSPY = ModuleType("rospy")
exec("class Publisher:\n  def publish(self, value): return value", vars(ROSPY))


class Lamp:
    """Something of the notebook that acts on nothing."""

    def switch(self, on: bool) -> bool:
        return on


@every(
    ("name", "value", "call", "code"),
    [
        ("s", socket, "s.create_connection(('lamp', 1))", "LRP550"),
        ("dial", socket.create_connection, "dial(('lamp', 1))", "LRP550"),
        ("link", socket.socket.__new__(socket.socket), "link.send(b'on')", "LRP550"),
        ("send", socket.socket.__new__(socket.socket).send, "send(b'on')", "LRP550"),
        ("beep", subprocess.run, "beep(['beep'])", "LRP550"),
        ("done", subprocess.CompletedProcess([], 0), "done.check_returncode()", None),
        ("lamp", Lamp(), "lamp.switch(True)", None),
        ("light", Lamp().switch, "light(True)", None),
        ("r", ROSPY, "r.sleep(1)", "LRP551"),
        ("lamps", ROSPY.Publisher(), "lamps.publish(True)", "LRP551"),
        ("publish", ROSPY.Publisher().publish, "publish(True)", "LRP551"),
        ("Client", ROSPY.Publisher, "Client().publish(True)", "LRP551"),
        ("lamps", ROSPY.Publisher(), "print(lamps)", None),
        ("lamps", ROSPY.Publisher(), "lamps = Lamp(); lamps.publish(True)", None),
    ],
)
def test_what_a_notebook_has_made_of_a_library_that_acts_is_known_by_its_value(
    name: str, value: object, call: str, code: str | None
) -> None:
    program = f"(machine m (state a (onentry [{call}]))) (spawn m a)"
    findings = check(program, {name: value, "Lamp": Lamp})
    assert [finding.code for finding in findings] == ([code] if code else [])
    shadowed = check(f"(var {name} := [Lamp()]) {program}", {name: value, "Lamp": Lamp})
    assert not [finding for finding in shadowed if finding.code in ("LRP550", "LRP551")]
