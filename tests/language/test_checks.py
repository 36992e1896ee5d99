"""Static checks: what they find in names, references and the graph of states."""

from __future__ import annotations

import re
from importlib.util import find_spec

import pytest
from checking import fixed, found, message
from hypothesis import given
from hypothesis import strategies as st
from programs import programs

import lrp_jupyter
from lrp_jupyter.errors import MOST_FINDINGS
from lrp_jupyter.language.checks import CODES, Code, check, report
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.printer import to_source
from lrp_jupyter.language.program import Block, Machine, Name, Program, Spawn, State, Transition
from lrp_jupyter.language.triggers import Epsilon
from lrp_jupyter.programs import heading

EXAMPLES = [
    code for code in CODES.values() if code.code < "LRP6"
]  # those of a run are in tests/test_codes.py
OF_A_WORLD = pytest.mark.skipif(
    find_spec("pymunk") is None, reason="the members of a simulated robot are known where pymunk is"
)


# The table


@pytest.mark.parametrize(
    "code",
    [pytest.param(code, marks=OF_A_WORLD if heading(code.example).world else ()) for code in EXAMPLES],
    ids=lambda code: code.code,
)
def test_an_example_has_its_code_and_no_other(code: Code) -> None:
    findings = lrp_jupyter.check(code.example)
    assert {(finding.code, finding.severity) for finding in findings} == {(code.code, code.severity)}
    for finding in findings:
        assert re.fullmatch(r"(`|[A-Z]).*[.?]", finding.message)


@pytest.mark.parametrize("code", EXAMPLES, ids=lambda code: code.code)
def test_a_repaired_example_has_no_findings(code: Code) -> None:
    assert lrp_jupyter.check(code.repaired) == ()


def test_a_text_that_is_not_a_program_has_the_parsers_findings_only() -> None:
    assert found("(machine m (state a)\n(spawn nobody a)") == [("LRP101", "(machine")]


def test_a_program_and_its_text_have_the_same_findings() -> None:
    text = "(machine m (state a) (on e a -> b))"
    assert check(parse(text)) == check(text) != ()


def test_findings_are_in_order_of_place() -> None:
    findings = check("(var a := [b])\n(machine m (state s (running [c])) (on e s -> t))\n(spawn n s)")
    places = [(finding.line, finding.column) for finding in findings]
    assert len(places) == 5
    assert places == sorted(places)


# 2xx: names


@pytest.mark.parametrize(
    ("text", "repeated"),
    [
        ("(var x := [1])(var x := [2])(machine m (state a))(spawn m a)", "x"),
        ("(machine m (state a) (state a))(spawn m a)", "a"),
        ("(machine m (state a))(machine m (state b))(spawn m a)", "m"),
        ("(machine m (state a (onentry (spawn n b)) (machine n (state b)) (machine n)))(spawn m a)", "n"),
    ],
)
def test_a_second_definition_is_an_error_at_the_second_place(text: str, repeated: str) -> None:
    (finding,) = check(text)
    assert (finding.code, finding.message[: len(repeated) + 2]) == ("LRP201", f"`{repeated}`")
    assert text.rindex(repeated + (" " if f"{repeated} " in text[20:] else ""), 0, finding.end_column)


def test_a_second_definition_names_the_line_of_the_first_one() -> None:
    text = (
        "(machine m\n (event e [True])\n (event e [False])\n (state a) (state b) (on e a -> b))\n(spawn m a)"
    )
    assert message(text) == (
        "`e` is already an event of `m`, in line 2, "
        "and only the first definition counts. Rename or remove this one."
    )


def test_what_is_inside_a_second_definition_is_ignored() -> None:
    assert found("(machine m (state a) (state a (running [nonsense])))(spawn m a)") == [("LRP201", "a")]


def test_siblings_may_share_names() -> None:
    text = "(machine m (var x := [1]) (state a))(machine n (var x := [2]) (state a))(spawn m a)(spawn n a)"
    assert check(text) == ()


def test_names_of_different_kinds_do_not_meet() -> None:
    text = "(var m := [1])(event m [m > 0])(machine m (state m) (state n) (on m m -> n m))(spawn m m)"
    assert check(text) == ()


def test_a_hidden_outer_variable_is_found_at_the_inner_one() -> None:
    text = (
        "(var x := [1])\n"
        "(machine m (state a (onentry (spawn n b)) (machine n (var x := [x + 1]) (state b))))(spawn m a)"
    )
    assert found(text) == [("LRP202", "x")]
    assert "line 1" in message(text)


def test_transitions_with_equal_names_and_ends_are_distinguished_by_order_only() -> None:
    text = (
        "(var x := [1])(machine m (state a) (state b) (on [x > 1] a -> b t) (on [x > 2] a -> b t))(spawn m a)"
    )
    assert found(text) == [("LRP205", "(on [x > 2] a -> b t)")]
    assert "another name" in message(text)


def test_a_program_without_machines_needs_no_spawn() -> None:
    assert check("") == ()
    assert check("; nothing yet\n(var x := [1])") == ()


@pytest.mark.parametrize("newline", ["\n", "\r\n", "\r"])
def test_a_missing_spawn_is_reported_at_the_first_line_and_added_where_it_is_certain(newline: str) -> None:
    text = f"; a robot{newline}(machine m (state a))"
    assert found(text) == [("LRP206", "; a robot")]
    assert fixed(text) == f"{text}{newline}{newline}(spawn m a){newline}"
    assert fixed(text + newline) == f"{text}{newline}{newline}(spawn m a){newline}"


def test_which_of_two_states_to_spawn_is_not_certain() -> None:
    (finding,) = check("(machine m (state a) (state b) (eps a -> b) (ontime 1 b -> a))")
    assert (finding.code, finding.fix) == ("LRP206", None)
    assert "`(spawn m state)`" in message("(machine m)")


# 3xx: references


def test_events_are_found_outwards_and_never_inwards() -> None:
    text = """
(event outer [robot.a])
(machine m
  (event middle [robot.b])
  (state a
    (onentry (spawn n c))
    (machine n
      (event inner [robot.c])
      (state c) (state d)
      (on outer c -> d) (on middle d -> c) (on inner c -> d back)))
  (state b)
  (on inner a -> b)
  (on middle b -> a))
(spawn m a)"""
    assert found(text) == [("LRP301", "inner")]
    assert (
        message(text) == "There is no event `inner` here. The one of `m/a/n` is out of scope. "
        "Move its definition outward."
    )


def test_a_dangling_event_without_a_likeness_asks_for_a_definition() -> None:
    text = "(machine m (state a) (state b) (on bump a -> b))(spawn m a)"
    assert message(text) == "There is no event `bump` here. Define `(event bump […])`."


def test_a_misspelt_name_has_a_fix_and_everything_else_is_checked_as_if_it_were_repaired() -> None:
    text = "(event bump [robot.b])(machine m (state a) (state looking) (on Bump a -> lookin))(spawn m a)"
    assert found(text) == [("LRP301", "Bump"), ("LRP303", "lookin")]
    follower = "(machine follower (state moving) (state end) (ontime 9 moving -> end))(spawn folower moving)"
    assert check(fixed(follower)) == ()
    start = "(machine m (state moving) (state end) (ontime 9 moving -> end))(spawn m mooving)"
    assert check(fixed(start)) == ()
    source = "(machine m (state moving) (state end) (ontime 9 movin -> end))(spawn m moving)"
    assert found(source) == [("LRP302", "movin")]
    assert check(fixed(source)) == ()


def test_a_variable_in_the_place_of_an_event_becomes_a_block() -> None:
    text = "(var ready := [True])(machine m (state a) (state b) (on ready a -> b))(spawn m a)"
    assert "`ready` is a variable" in message(text)
    assert "(on [ready] a -> b)" in fixed(text)
    assert check(fixed(text)) == ()


def test_states_left_out_of_a_wildcard_must_exist() -> None:
    text = "(machine m (state a) (state b) (on [robot.b] *-{nowhere} -> b))(spawn m a)"
    assert found(text) == [("LRP302", "nowhere")]


EXITS = """
(machine m
  (state work
    (onentry (spawn n a))
    (machine n (state a) {}))
  (state rest))
(spawn m work)"""


def test_an_exit_reaches_a_state_of_the_machine_around() -> None:
    assert check(EXITS.format("(exit [robot.b] a -> rest)")) == ()


def test_only_exit_leads_out_of_a_machine() -> None:
    text = EXITS.format("(on [robot.b] a -> rest)")
    assert found(text) == [("LRP303", "rest")]
    assert fixed(text) == EXITS.format("(exit [robot.b] a -> rest)")
    (timeout,) = check(EXITS.format("(ontime 5 a -> rest)"))
    assert (timeout.code, timeout.fix) == ("LRP303", None)


def test_the_fix_of_a_keyword_passes_over_comments() -> None:
    text = EXITS.format("( ; on purpose\n # as well\n on [robot.b] a -> rest)")
    assert check(fixed(text)) == ()


def test_an_exit_within_its_own_machine_becomes_on() -> None:
    text = EXITS.format("(state b) (exit [robot.b] a -> b)")
    assert found(text) == [("LRP306", "b"), ("LRP401", "rest")]
    text = text.replace("(state rest)", "(state rest) (ontime 9 work -> rest)")
    assert check(fixed(text)) == ()


def test_an_exit_to_nowhere_names_the_machine_around() -> None:
    (finding,) = check(EXITS.format("(exit [robot.b] a -> xyz)"))
    assert (
        finding.message
        == "`exit` leads to a state of `m`, where there is no `xyz`. Define `(state xyz)` there."
    )


def test_a_word_for_any_state_becomes_a_wildcard() -> None:
    text = "(machine m (state a) (state b) (on [robot.b] any -> b))(spawn m a)"
    assert found(text) == [("LRP302", "any")]
    assert fixed(text) == text.replace("any", "*")


def test_an_event_in_brackets_loses_them() -> None:
    text = "(machine m (event e [robot.b]) (state a) (state b) (on [e] a -> b) (on e b -> a))(spawn m a)"
    assert found(text) == [("LRP502", "e")]
    assert fixed(text) == text.replace("[e]", "e")


def test_an_exit_in_a_root_machine_dangles() -> None:
    text = "(machine m (state a) (state b) (exit [robot.b] a -> c))(spawn m a)"
    assert found(text) == [("LRP401", "b"), ("LRP307", "(exit [robot.b] a -> c)")]


def test_an_exit_leads_to_the_machine_that_spawned_wherever_that_is() -> None:
    text = """
(machine shared (state s) (exit [robot.b] s -> done))
(machine m (state a (onentry (spawn shared s))) (state done))
(spawn m a)"""
    assert check(text) == ()


def test_a_machine_that_is_never_spawned_exits_to_the_machine_around_it() -> None:
    text = "(machine m (state a (machine n (state b) (exit [robot.b] b -> c))) (state c))(spawn m a)"
    assert found(text) == [("LRP402", "n")]


@pytest.mark.parametrize("actions", ["", " (onentry [print()])", " (running [print()])"])
def test_the_fix_spawns_a_forgotten_machine_at_the_entry_of_its_state(actions: str) -> None:
    text = f"(machine m (state a{actions} (machine n (state b) (state c) (eps b -> c))))(spawn m a)"
    spawning = (
        "(onentry [print()] (spawn n b))" if "onentry" in actions else f"(onentry (spawn n b)){actions}"
    )
    assert parse(fixed(text)) == parse(text.replace(f"(state a{actions}", f"(state a {spawning}"))


def test_a_delay_is_a_variable_of_the_program() -> None:
    def text(name: str) -> str:
        return (
            "(machine m (state a (onentry (spawn n c)) (machine n (var inner := [1]) (state c)))"
            f"(state b) (ontime {name} a -> b))(spawn m a)"
        )

    assert (
        message(text("inner")) == "There is no variable `inner` here. The one of `m/a/n` is out of scope. "
        "Move its definition outward."
    )
    assert (
        message(text("pause"))
        == "There is no variable `pause` here. Define `(var pause := [1000])`, in milliseconds."
    )
    assert "(ontime [pause] a -> b)" in fixed(text("pause"), names=["pause"])


def test_a_machine_cannot_be_spawned_from_inside_itself() -> None:
    text = "(machine m (state a (onentry (spawn m a))))(spawn m a)"
    assert found(text) == [("LRP304", "m")]
    assert "can spawn neither itself" in message(text)


def test_a_machine_inside_another_state_cannot_be_spawned() -> None:
    text = """
(machine m
  (state a (onentry (spawn n c)) (machine n (state c)))
  (state b (onentry (spawn n c)))
  (ontime 9 a -> b))
(spawn m a)"""
    assert found(text) == [("LRP304", "n")]
    assert message(text).endswith("The one of `m/a/n` is out of scope. Move its definition outward.")


def test_the_innermost_machine_of_a_name_is_spawned() -> None:
    text = """
(machine n (state top))
(machine m
  (state a (onentry (spawn n inner)) (machine n (state inner))))
(spawn m a) (spawn n top)"""
    assert check(text) == ()


def test_a_nested_machine_with_the_name_of_the_one_around_can_be_spawned() -> None:
    assert check("(machine m (state a (onentry (spawn m b)) (machine m (state b))))(spawn m a)") == ()


# 4xx: reachability


def test_states_are_reached_through_spawns_exits_and_wildcards() -> None:
    text = """
(event bump [robot.bumper.data])
(machine m
  (state a
    (onentry (spawn n b))
    (machine n (state b) (state c) (eps b -> c) (exit bump c -> d)))
  (state d) (state e) (state f)
  (on bump *-{a} -> e)
  (ontime 1000 {e d} -> f))
(spawn m a)"""
    assert check(text) == ()


def test_only_the_outermost_of_what_is_out_of_reach_is_reported() -> None:
    text = """
(machine m
  (state a)
  (state lost (onentry (spawn n b))
    (machine n (state b) (state c))))
(spawn m a)"""
    assert found(text) == [("LRP401", "lost")]


def test_a_state_reached_only_from_a_lost_state_is_lost() -> None:
    text = "(machine m (state a) (state b) (state c) (ontime 9 b -> c) (ontime 9 c -> b))(spawn m a)"
    assert found(text) == [("LRP401", "b"), ("LRP401", "c")]


def test_what_a_state_still_to_be_written_leads_to_is_not_out_of_reach() -> None:
    text = "(machine m (state a) (state c) (ontime 9 a -> bumpback) (ontime 9 bumpback -> c))(spawn m a)"
    assert found(text) == [("LRP303", "bumpback"), ("LRP302", "bumpback")]


def test_with_an_unknown_start_state_any_state_may_be_the_start() -> None:
    text = "(machine m (state a) (state b))(spawn m nowhere)"
    assert found(text) == [("LRP305", "nowhere")]


def test_with_an_unknown_machine_spawned_any_machine_may_be_meant() -> None:
    text = "(machine follower (state a))(spawn xyz a)"
    assert found(text) == [("LRP304", "xyz")]


def test_a_root_machine_that_is_not_spawned_beside_others_is_reported() -> None:
    text = "(machine m (state a))(machine idle)(spawn m a)"
    assert found(text) == [("LRP402", "idle")]
    assert "`(spawn idle state)` into the top level" in message(text)


def test_a_machine_that_runs_already_is_not_spawned_again() -> None:
    text = """
(machine m
  (state a (onentry (spawn n c) (spawn n c) (spawn root d)) (machine n (state c)))
  (state b (onentry (spawn other e)))
  (state c (onentry (spawn other e)))
  (ontime 9 a -> b) (ontime 9 b -> c))
(machine root (state d)) (machine other (state e))
(spawn m a) (spawn root nowhere) (spawn root d)"""
    assert found(text) == [("LRP407", "(spawn n c)"), ("LRP407", "(spawn root d)"), ("LRP305", "nowhere")]


def test_an_event_is_used_by_the_transitions_of_inner_machines_and_by_exits() -> None:
    text = EXITS.format("(exit done a -> rest)").replace("(machine m", "(event done [robot.b])(machine m", 1)
    assert check(text) == ()


@pytest.mark.parametrize(
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


@pytest.mark.parametrize(
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


def test_a_transition_without_destination_keeps_none_from_being_tested() -> None:
    text = "(machine m (state a) (state b) (eps a -> nowhere) (ontime 5 a -> b))(spawn m a)"
    assert found(text) == [("LRP303", "nowhere")]


def test_two_transitions_on_the_same_unknown_event_are_two_findings_only() -> None:
    text = "(machine m (state a) (state b) (state c) (on e a -> b) (on e a -> c))(spawn m a)"
    assert [code for code, _ in found(text)] == ["LRP301", "LRP301"]


def test_a_delay_of_nothing_back_to_its_source_never_rests() -> None:
    text = "(machine m (state a) (state b) (ontime 0 {a b} -> b))(spawn m a)"
    assert found(text) == [("LRP405", "(ontime 0 {a b} -> b)")]


def test_two_states_may_chase_each_other() -> None:
    assert check("(machine m (state a) (state b) (eps a -> b) (eps b -> a))(spawn m a)") == ()


def test_a_wildcard_may_match_no_state() -> None:
    text = "(machine m (state a) (state b) (on [robot.b] *-{a} -> b)(ontime 5 a -> b))(spawn m a)"
    assert found(text) == [("LRP406", "(on [robot.b] *-{a} -> b)")]


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
    *listed, last = check(unknown_states(5000))
    assert len(listed) == MOST_FINDINGS
    assert {finding.code for finding in listed} == {"LRP303"}
    assert (last.code, last.severity) == ("LRP698", "hint")
    assert last.message == "There are 4,800 more findings. Correct these first."
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


@pytest.mark.parametrize(
    ("text", "prefix"),
    [
        ("(machine m (state moving) (state b) (ontime 5 b -> mov)) (spawn m b)", True),
        ("(machine m (state moving) (state b) (ontime 5 b -> movign)) (spawn m b)", False),
        ("(var speed := [1]) (machine m (state a (running [sp]))) (spawn m a)", True),
        ("(var speed := [1]) (machine m (state a (running [speeed]))) (spawn m a)", False),
        ("(machine m (stat a)) (spawn m a)", True),
        ("(machine m (stata a)) (spawn m a)", False),
    ],
)
def test_a_finding_says_whether_its_name_only_begins_a_known_one(text: str, prefix: bool) -> None:
    (finding,) = check(text)
    assert finding.prefix == prefix


def test_the_only_state_from_which_all_are_reached_is_where_a_machine_starts() -> None:
    text = "(machine m (state b) (state a) (ontime 5 a -> b))\n"
    assert fixed(text) == text + "\n(spawn m a)\n"
    (finding,) = check("(machine m (state b) (state a) (ontime 5 a -> b) (ontime 5 b -> a))")
    assert finding.fix is None


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("(machine m (state a) (state b) (ontime 5 a -> elsewhere)) (spawn m a)", "LRP303"),
        ("(machine m (state a) (state b) (ontime 5 nowhere -> b)) (spawn m a)", "LRP302"),
        ("(event e [True]) (machine m (state a) (state b) (on other a -> b)) (spawn m a)", "LRP301"),
        ("(machine m (state a (machine n (state b)))) (spawn other a)", "LRP304"),
        ("(event e [True]) (machine m (state a) (state b) (on [e] a -> b)) (spawn m a)", "LRP502"),
    ],
)
def test_what_follows_from_an_unknown_name_is_not_reported(text: str, code: str) -> None:
    assert [finding.code for finding in check(text)] == [code]
