from __future__ import annotations

import contextlib
import re
import sys
import tracemalloc
from collections import Counter
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.tables import every

from lrp_jupyter.errors import MOST_FINDINGS, LRPSyntaxError
from lrp_jupyter.language import parser
from lrp_jupyter.language.blocks.block import facts_of
from lrp_jupyter.language.parser import MOST_PYTHON, parse, scan
from lrp_jupyter.language.program import Block, Finding, Program
from lrp_jupyter.language.reading import tokens
from lrp_jupyter.language.reading.forms import USAGE, Mistake, shape_of
from lrp_jupyter.language.reading.matching import DEEPEST
from lrp_jupyter.language.reading.tokens import LEGAL

LISTING = (Path(__file__).parent / "printed_listing.lrp").read_text(encoding="utf-8")


def places(text: str) -> list[tuple[str, int, int]]:
    program, findings = scan(text)
    assert (program is None) == bool(findings)
    return [(finding.code, finding.line, finding.column) for finding in findings]


def test_the_listing_printed_in_the_paper_has_wrong_brackets_in_lines_19_33_and_35_only() -> None:
    assert [place for place in places(LISTING) if place[0] < "LRP500"] == [
        ("LRP102", 19, 59),
        ("LRP103", 33, 18),
        ("LRP102", 33, 57),
        ("LRP103", 35, 18),
        ("LRP102", 35, 60),
    ]


def test_a_text_that_is_not_a_program_raises_all_its_errors_at_once() -> None:
    with pytest.raises(LRPSyntaxError) as caught:
        parse("(var x [1])\n(var y := [1 +])")
    assert [finding.line for finding in caught.value.findings] == [1, 2]


def only(text: str) -> Finding:
    """The one error of a text."""
    program, findings = scan(text)
    assert program is None
    (finding,) = findings
    assert finding.severity == "error"
    return finding


FOLLOWER = """\
(var limit := [100]) ; how dark
(machine follower
  # the states
  (state moving
    (onentry [robot.go()])
    (running [robot.move(limit)]))
  (state looking
    (onentry (spawn look left) [print("]")])
    (machine look
      (var time := [limit])
      (state left
        (onexit [time = 2 * time]))
      (ontime time left -> left)
      (exit dark left -> moving)))
  (event dark [robot.light < limit])
  (on dark moving -> looking lost)
  (on [robot.bumper] *-> moving)
  (eps {looking moving} -> end))
(spawn follower moving)
"""


# Programs


def test_every_form_is_read() -> None:
    program = parse(
        """
        (var a := [1]) (event top [a > 1])
        (machine m
          (var b := [a + 1]) (event e [b])
          (state s (onentry [1] (spawn n q) [2]) (onentry [3]) (running [4] [5]) (onexit [6])
            (machine n (state q)))
          (on e s -> t) (on [True] * -> s back) (ontime 100 {s t}->s) (ontime b *-{s} -> t x)
          (ontime [2 * b] s->t) (eps s -> t) (exit e s -> t out) (exit [True] s -> t))
        (onpause [7]) (onresume [8] [9]) (onpause [10]) (onend [11]) (spawn m s) (spawn m t)
        """
    )
    assert [variable.name for variable in program.variables] == ["a"]
    assert [event.name for event in program.events] == ["top"]
    hooks = {kind: [block.text for block in part] for kind, part in program.hooks.items()}
    assert hooks == {"onpause": ["7", "10"], "onresume": ["8", "9"], "onend": ["11"]}
    assert [(spawn.machine, spawn.state) for spawn in program.spawns] == [("m", "s"), ("m", "t")]
    (machine,) = program.machines
    (state,) = machine.states
    assert [part.text if isinstance(part, Block) else part.machine for part in state.onentry] == [
        "1",
        "n",
        "2",
        "3",
    ]
    assert [block.text for block in (*state.running, *state.onexit)] == ["4", "5", "6"]
    assert [inner.name for inner in state.machines] == ["n"]
    assert machine.labels == (
        "e:s->t",
        "back",
        "100:{s t}->s",
        "x",
        "[2 * b]:s->t",
        "eps:s->t",
        "out",
        "[True]:s->t",
    )
    assert [transition.kind for transition in machine.transitions] == [
        *("on", "on", "ontime", "ontime", "ontime", "eps", "exit", "exit")
    ]
    assert [transition.wildcard for transition in machine.transitions] == [
        *(False, True, False, True, False, False, False, False)
    ]


@every("text", ["", " \n\t", "; nothing", "# nothing\r\n", "\ufeff\u3000\xa0"])
def test_a_text_without_forms_is_the_empty_program(text: str) -> None:
    assert parse(text) == Program()


@every("arrow", ["*->", "* ->", "*  \n->", "*;c\n->;c\n", "*-> ;c\n"])
def test_white_space_and_comments_are_free_between_tokens(arrow: str) -> None:
    (transition,) = parse(f"( ;c\nmachine #c\n m(on e {arrow}b))").machines[0].transitions
    assert (transition.source_text, transition.destination) == ("*", "b")


def test_a_source_and_its_arrow_need_no_space() -> None:
    (transition,) = parse("(machine m (on e a->b c))").machines[0].transitions
    assert transition.label == "c"


def test_keywords_may_be_names() -> None:
    program = parse("(machine machine (state state) (on on state -> end eps)) (spawn machine state)")
    assert program.machines[0].transitions[0].identity == ("on", frozenset({"state"}), False, "end", "eps")


@every("end", ["\n", "\r\n", "\r"])
def test_every_line_end_is_read_and_counted(end: str) -> None:
    program = parse(f"; one{end}(var a := [1]){end}(var b := [{end}  2 # ]{end}  ])")
    assert [(variable.initial.line, variable.initial.column) for variable in program.variables] == [
        (2, 12),
        (3, 12),
    ]
    assert program.place(program.variables[1].span.start) == (3, 1)


def test_nouns_know_their_places() -> None:
    text = "  (machine é (state \U0001d518 (running [1]\n [2])))"
    (machine,) = parse(text).machines
    (state,) = machine.states
    assert [text[slice(*span)] for span in (machine.span, machine.name.span, state.name.span)] == [
        text.strip(),
        "é",
        "\U0001d518",
    ]
    assert state.name == "U"  # the same identifier, as Python sees it
    second = state.running[1]
    assert (text[slice(*second.span)], second.line, second.column, second.before) == ("[2]", 2, 3, 2)


def test_only_layout_and_comments_differ_between_equal_programs() -> None:
    assert parse(FOLLOWER) == parse(FOLLOWER.replace("\n", " \n;)\n ").replace("; how", ";"))


# Forms


def test_a_global_of_a_variable_in_scope_is_an_error_anywhere() -> None:
    text = "(machine m (var a := [1]) (state s (running [def f():\n  global a, b])))\n"
    text += "(var b := [2])(var c := [3])"
    assert places(text) == [("LRP501", 2, 10), ("LRP501", 2, 13)]
    assert places(text.replace("(var a := [1])", "").replace("b := ", "d := ")) == []


def test_every_broken_form_is_reported_and_no_other() -> None:
    text = FOLLOWER.replace(":= [limit]", "= [limit]").replace("-> end", "end").replace("] *->", "] ->")
    assert [(code, line) for code, line, _ in places(text)] == [
        ("LRP104", 10),
        ("LRP108", 17),
        ("LRP108", 18),
    ]


def test_errors_in_unknown_forms_are_reported_as_well() -> None:
    assert places("(machine m\n (staet a (running [1 +]) (machine b (var x))))") == [
        ("LRP106", 2, 3),
        ("LRP501", 2, 23),
        ("LRP108", 2, 44),
    ]


def test_a_form_nested_too_deeply_is_the_only_error_reported() -> None:
    deep = "(machine m (state s " * (DEEPEST // 2)
    assert places(deep + "))" * (DEEPEST // 2)) == []
    finding = only(deep + "(machine m" + "))" * (DEEPEST // 2))
    assert (finding.code, finding.column) == ("LRP111", len(deep) + 1)


# Brackets


ALL = [match.start() for match in re.finditer(r"[()\[\]]", FOLLOWER)]


@every("offset", ALL)
def test_one_missing_bracket_is_reported_in_its_line_or_at_what_it_leaves_open(offset: int) -> None:
    if FOLLOWER[offset] == "]" and FOLLOWER[offset - 1] == '"':
        return  # it is in a string
    text = FOLLOWER[:offset] + FOLLOWER[offset + 1 :]
    findings = scan(text)[1]
    line = FOLLOWER.count("\n", 0, offset) + 1
    assert 1 <= len(findings) <= 3
    opened = {line}
    if FOLLOWER[offset] == ")":
        opened |= {FOLLOWER.count("\n", 0, start) + 1 for start in openings(offset)}
    assert {finding.line for finding in findings} <= opened


def openings(offset: int) -> list[int]:
    """The brackets that are closed where this one is."""
    end = re.compile(r"\)+").search(FOLLOWER, offset)
    assert end
    start = offset
    while FOLLOWER[start - 1] == ")":
        start -= 1
    program = parse(FOLLOWER)
    spans = [machine.span for _, machine in program.walk()]
    spans += [state.span for _, machine in program.walk() for state in machine.states]
    return [span.start for span in spans if start < span.end <= end.end()]


@every("offset", ALL)
def test_one_extra_bracket_is_reported_in_its_line(offset: int) -> None:
    bracket = FOLLOWER[offset]
    if bracket == "]" and FOLLOWER[offset - 1] == '"':
        return
    if bracket in "(":
        return
    text = FOLLOWER[:offset] + bracket + FOLLOWER[offset:]
    line = FOLLOWER.count("\n", 0, offset) + 1
    findings = scan(text)[1]
    assert findings
    assert {finding.line for finding in findings} <= {line}


def test_an_unclosed_form_is_reported_where_it_opens() -> None:
    finding = only(FOLLOWER.replace("robot.move(limit)]))", "robot.move(limit)])"))
    assert (finding.code, finding.line, finding.column, finding.end_column) == ("LRP101", 4, 3, 9)
    assert finding.message == "This `(state` is not closed. Put its `)` at the end of line 6."


def test_an_unclosed_bracket_without_a_keyword_is_reported() -> None:
    assert places("(machine m)\n(") == [("LRP101", 2, 1), ("LRP106", 2, 1)]


def test_a_bracket_at_the_margin_of_a_deep_text_is_not_searched_for_long() -> None:
    deep = "(machine m\n (state s\n" * 4
    assert {code for code, _, _ in places(f"{deep}  )\n(event")} <= {"LRP101", "LRP108"}


def test_a_keyword_that_lost_its_bracket_is_reported() -> None:
    finding = only(FOLLOWER.replace("(event", "event"))
    assert (finding.code, finding.line, finding.column) == ("LRP101", 15, 3)
    assert finding.message == "A `(` is missing before `event`. Insert it."


def test_several_wrong_brackets_are_reported_each_at_its_place() -> None:
    text = (
        FOLLOWER.replace("go()])", "go()]))")
        .replace("2 * time]", "2 * time")
        .replace("[limit])\n", "[limit]\n")
    )
    assert [(code, line) for code, line, _ in places(text)] == [
        ("LRP102", 5),
        ("LRP101", 10),
        ("LRP103", 12),
    ]


def test_a_string_that_swallows_the_end_of_a_block_is_reported_in_its_line() -> None:
    assert {line for _, line, _ in places(FOLLOWER.replace('print("]")', 'print("])'))} == {8}
    assert {line for _, line, _ in places(FOLLOWER.replace("2 * time]", "2 * time # ]"))} == {12}


def test_a_block_that_is_not_closed_ends_before_the_next_form() -> None:
    text = FOLLOWER.replace("[time = 2 * time]))", "[time = (2 * time")
    assert [(code, line) for code, line, _ in places(text)] == [("LRP103", 12)]


def test_half_a_program_has_few_errors_all_near_its_end() -> None:
    for end in range(0, len(FOLLOWER), 3):
        findings = scan(FOLLOWER[:end])[1]
        assert len(findings) <= 8


# Whatever is typed


@given(st.text("()[]{}'\"#;:=->*\\\n\r abx1é\U0001d518\0\ud800\ufeff", max_size=60))
def test_no_text_raises_anything_but_a_syntax_error(text: str) -> None:
    with contextlib.suppress(LRPSyntaxError):
        parse(text)


@given(st.data())
def test_no_change_of_a_program_raises_anything_but_a_syntax_error(data: st.DataObject) -> None:
    text = data.draw(st.sampled_from([FOLLOWER, LISTING, "(var a := [f'{x!r:>{y}}'])\r\n(spawn a b)"]))
    for _ in range(data.draw(st.integers(1, 5))):
        start = data.draw(st.integers(0, len(text)))
        end = data.draw(st.integers(start, min(start + 20, len(text))))
        text = text[:start] + data.draw(st.text("()[]{}'\"#; \n:=ax", max_size=3)) + text[end:]
    program, findings = scan(text)
    assert (program is None) == bool(findings)
    rows = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    for finding in findings:
        assert (finding.line, finding.column) <= (finding.end_line, finding.end_column)
        assert 1 <= finding.column <= len(rows[finding.line - 1]) + 2
        assert finding.message.endswith((".", "?"))
    assert list(findings) == sorted(findings, key=lambda finding: (finding.line, finding.column))


# The grammar


def test_the_places_of_forms_are_those_of_the_grammar() -> None:
    for around, usage in (("program", ()), *((keyword, ()) for keyword in USAGE)):
        assert not usage
        head = {
            **dict.fromkeys(("machine", "state"), ("NAME",)),
            "spawn": ("NAME", "NAME"),
            **dict.fromkeys(("on", "ontime", "exit"), ("NAME", "NAME", "ARROW", "NAME")),
            "eps": ("NAME", "ARROW", "NAME"),
        }.get(around, ())
        legal = {
            keyword
            for keyword in USAGE
            if not isinstance(shape_of((around.upper(), *head, f"{keyword.upper()}_FORM")), Mistake)
        }
        assert legal == LEGAL.get(around, set())


def test_every_form_can_be_written_as_in_its_usage() -> None:
    for keyword, usage in USAGE.items():
        form = usage.replace("…", "").replace("milliseconds", "5")
        around = {"onentry": "(machine m (state s {}))", "running": "(machine m (state s {}))"}
        around["onexit"] = around["running"]
        around["effect"] = "(machine m (eps a -> b {}))"
        for inner in ("state", "on", "ontime", "eps", "exit"):
            around[inner] = "(machine m {})"
        parse(around.get(keyword, "{}").format(form))


@pytest.mark.slow
@every("piece", ["[)", "(state a)\n", "]", "*->", "(event e [", "[\n"])
def test_the_time_for_a_text_full_of_mistakes_grows_with_its_length(piece: str) -> None:
    def steps(count: int) -> int:
        calls = 0

        def counted(*_: object) -> None:
            nonlocal calls
            calls += 1

        sys.setprofile(counted)
        try:
            scan(piece * count)
        finally:
            sys.setprofile(None)
        return calls

    steps(125)  # fills the caches
    assert steps(1000) < 12 * steps(126)  # a text of its own, because the tokens of the last ones are kept


def test_a_long_line_is_not_copied_for_each_block_in_it():
    def occupied(blocks: int) -> int:
        text = f"(machine m (state a {'(running [x = 1]) ' * blocks}))"
        scan(text)  # fills the caches
        tracemalloc.start()
        try:
            scan(text)
            return tracemalloc.get_traced_memory()[1]
        finally:
            tracemalloc.stop()

    assert occupied(2000) < 6 * occupied(500)


def test_stray_characters_in_a_row_are_one_finding():
    (finding,) = scan("(machine m (state a)) (spawn m a)\n" + "%" * 500_000)[1]
    assert (finding.code, finding.line, finding.column, finding.end_column) == ("LRP104", 2, 1, 500_001)
    assert finding.message == f"`{'%' * 27}…` is not part of the language. Remove it."


def test_of_thousands_of_errors_the_first_are_listed_and_the_others_counted():
    *listed, last = scan("% " * 5_000)[1]
    assert len(listed) == MOST_FINDINGS
    assert last.message == "There are 4,800 more findings. Correct these first."


def test_a_bracket_without_a_partner_is_searched_for_within_bounds(monkeypatch):
    searched = Counter()

    class Counting:
        def search(self, text, start, end):
            searched["characters"] += end - start

    monkeypatch.setattr(tokens, "_NEWLINE", Counting())
    scan("a " * 2000 + "]" * 2000)
    assert searched["characters"] < 2_000_000


def test_more_python_than_can_be_compiled_in_seconds_is_one_error_found_at_once(monkeypatch):
    read = []
    monkeypatch.setattr(parser, "facts_of", lambda text: read.append(len(text)) or facts_of(text))
    monkeypatch.setattr(parser, "MOST_PYTHON", 25_000)
    block = "y = 1\n" * (25_000 // 6)
    assert scan(f"(machine m (state a (running [{block}])))")[0]
    (finding,) = scan(f"(machine m (state a (running [{block}] [{block}] [{block * 40}])))")[1]
    assert (finding.code, finding.line) == ("LRP501", 1 + 25_000 // 6)
    assert finding.message == (
        "The blocks up to here have more than 25,000 characters."
        " Move functions and tables into a module, and import it."
    )
    assert max(read) < 25_000 < MOST_PYTHON
