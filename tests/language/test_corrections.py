"""What is spelt as in other languages, or slightly wrong, is one error, with the fix that takes it back."""

from __future__ import annotations

import random
from itertools import pairwise

import pytest
from checking import start_of
from support.seeds import seeds
from support.tables import every
from test_wrong_texts import SECTIONS

from lrp_jupyter.errors import edited
from lrp_jupyter.language import mistakes
from lrp_jupyter.language.checks import check
from lrp_jupyter.language.mistakes import text_draft as draft
from lrp_jupyter.language.mistakes import unclosed
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Finding

RIGHT = """\
(var speed := [0.2])
(event bump [robot.bumper.data == 1])
(machine drive
  (state have_rest
    (onentry [robot.stop()] (spawn inner first))
    (machine inner
      (state first (running [print("here")]))
      (exit [speed > 1] first -> moving)))
  (state moving
    (running [robot.move(linear=speed)]) ; ahead
    (onexit [
      speed = 0.1
      print("stops")]))
  (on bump {have_rest moving} -> have_rest tbump)
  (ontime 500 have_rest -> moving)
  (on [speed > 3] *-{moving} -> moving))
(spawn drive moving)
"""


def fixed(text: str, finding: Finding) -> str:
    assert finding.fix
    return finding.fix.apply(text)


def test_a_wrong_name_is_one_error_wherever_it_is_and_its_fix_changes_all() -> None:
    text = RIGHT.replace("have_rest", "have-rest")
    (finding,) = check(text)
    assert finding.line == 4
    assert fixed(text, finding) == RIGHT


def test_every_mistake_of_a_text_is_reported_and_their_fixes_do_not_disturb_each_other() -> None:
    text = (
        RIGHT.replace(":=", "=", 1)
        .replace("500 have_rest ->", "500ms have_rest =>")
        .replace("(state m", "(stat m")
    )
    found = [(finding.code, finding.line) for finding in check(text)]
    assert found == [("LRP104", 1), ("LRP106", 9), ("LRP108", 15), ("LRP104", 15)]
    for _ in found:
        text = fixed(text, check(text)[0])
    assert parse(text) == parse(RIGHT)


def test_an_error_behind_a_correction_is_at_its_place() -> None:
    text = RIGHT.replace(":= [0.2]", "= 0.2").replace("speed > 1", "speed >")
    *_, last = check(text)
    assert (last.code, last.line) == ("LRP501", 8)
    assert text[start_of(text, last) :].startswith(">")


def test_what_a_correction_reveals_is_corrected_as_well() -> None:
    text = '(machine m ("tate a))\n(spawn m a)'
    fixes = [finding.fix for finding in check(text)]
    assert len(fixes) == 2
    assert (
        edited(text, [edit for fix in fixes if fix for edit in fix.edits])
        == "(machine m (state a))\n(spawn m a)"
    )


def test_where_the_remedy_is_not_certain_there_is_no_fix() -> None:
    for wrong, right in [
        ("bump [] [True]", "bump [robot.bumper.data == 1]"),
        ("", "drive\n"),
        ("", "500 have_rest"),
    ]:
        findings = check(RIGHT.replace(right, wrong))
        assert findings
        assert all(finding.fix is None for finding in findings)


PIECES = [*"()[]{}=-,#;→\n'\"", "->", ":=", "//", "/*", "2s"]


@pytest.mark.parametrize("seed", seeds(8, 40))
def test_fixes_of_any_text_can_be_applied_and_come_to_an_end(seed: int) -> None:
    chance = random.Random(seed)
    for _ in range(10):
        text = RIGHT
        for _ in range(chance.choice([1, 1, 2, 5])):
            at = chance.randrange(len(text))
            text = text[:at] + chance.choice(["", *PIECES]) + text[at + chance.randrange(3) :]
        tried = set()
        while fixable := [
            each for each in check(text) if each.fix and (each.message, each.line) not in tried
        ]:
            for finding in fixable:
                assert finding.fix
                edits = sorted(finding.fix.edits)
                assert all(0 <= start <= end <= len(text) for start, end, _ in edits)
                assert all(first.end <= second.start for first, second in pairwise(edits))
                assert finding.fix.apply(text) != text
            tried.add((fixable[0].message, fixable[0].line))
            text = fixed(text, fixable[0])
        assert len(tried) < 30


def test_an_event_with_a_hyphen_is_a_name_in_conditions_too() -> None:
    text = RIGHT.replace("bump ", "the-bump ")
    (finding,) = check(text)
    assert finding.code == "LRP110"
    assert fixed(text, finding) == RIGHT.replace("bump ", "the_bump ")


def test_an_event_called_like_the_second_part_of_a_keyword_is_a_condition() -> None:
    text = RIGHT.replace("bump ", "start ").replace("{have_rest moving}", "(have_rest moving)")
    (finding,) = check(text)
    assert fixed(text, finding) == RIGHT.replace("bump ", "start ")


def test_an_action_without_its_form_runs_once_or_repeatedly_by_what_it_does() -> None:
    text = RIGHT.replace('(running [print("here")])', '[print("here")]')
    (finding,) = check(text)
    assert "Write `(onentry […])` or `(running […])`." in finding.message
    assert fixed(text, finding) == RIGHT.replace('(running [print("here")])', '(onentry [print("here")])')


def test_a_block_is_closed_before_the_next_one():
    text = "(machine m (state a (onexit [robot.stop() [robot.pen(False)])))\n(spawn m a)"
    (finding,) = check(text)
    assert finding.code == "LRP103"
    assert fixed(text, finding) == text.replace("()", "()]", 1)


def test_a_block_is_closed_before_one_that_contains_brackets() -> None:
    text = RIGHT.replace('print("stops")])', 'print("stops")\n      [print([1][0])])')
    (finding,) = check(text)
    assert (finding.code, finding.line) == ("LRP103", 13)
    assert '"stops")]\n      [print([1][0])])' in fixed(text, finding)


def test_the_name_of_a_transition_is_not_a_delay_in_the_wrong_place() -> None:
    (finding,) = check(
        RIGHT.replace("(ontime 500 have_rest -> moving)", "(ontime have_rest -> moving tslow)")
    )
    assert finding.message.startswith("Expected the source state")
    (finding,) = check(
        RIGHT.replace("(ontime 500 have_rest -> moving)", "(ontime have_rest -> moving speed)")
    )
    assert finding.message.startswith("The delay comes before")


@every(
    ("changes", "line", "words"),
    [
        (
            [("(state moving\n", "(state moving)\n"), ('print("stops")]))', 'print("stops")])')],
            9,
            "too early",
        ),
        ([("(state have_rest\n", "(state have_rest)\n"), ("-> moving)))", "-> moving))")], 4, "too early"),
    ],
)
def test_a_closing_bracket_in_the_wrong_place_is_one_error(
    changes: list[tuple[str, str]], line: int, words: str
) -> None:
    text = RIGHT
    for right, wrong in changes:
        text = text.replace(right, wrong)
    (finding,) = check(text)
    assert (finding.code, finding.line) == ("LRP102", line)
    assert words in finding.message
    assert parse(fixed(text, finding)) == parse(RIGHT)


def test_a_block_without_its_end_does_not_end_in_a_comment_or_another_form() -> None:
    text = RIGHT.replace("linear=speed)])", "linear=speed))").replace("; ahead", "; [ahead]")
    (finding,) = check(text)
    assert (finding.code, finding.line) == ("LRP103", 10)
    assert fixed(text, finding).count("linear=speed)])") == 1


@every(
    ("wrong", "right"),
    [
        ('print("on, speed)', 'print("on", speed)'),
        ('print("on", speed, "off)', 'print("on", speed, "off")'),
        ('print("on, speed, "off")', 'print("on", speed, "off")'),
        ('print("on", speed, off")', 'print("on", speed, "off")'),
        ('print("on, off)', 'print("on, off")'),
    ],
)
def test_a_string_that_is_not_closed_ends_before_the_names_of_the_program(wrong: str, right: str) -> None:
    text = RIGHT.replace('print("here")', wrong)
    (finding,) = check(text)
    assert finding.code == "LRP514"
    assert fixed(text, finding) == RIGHT.replace('print("here")', right)


def test_the_place_of_a_quote_is_not_searched_for_in_long_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    parsed = []

    def is_python(text: str) -> bool:
        parsed.append(len(text))
        return draft.is_python(text)

    monkeypatch.setattr(unclosed, "is_python", is_python)
    call = "b(c, d), " * 3_000
    wrong = f'(machine m (state a (running [print("a, {call})])))(spawn m a)'
    assert {finding.line for finding in check(wrong)} == {1}
    assert sum(parsed) < 1_000_000


@pytest.mark.parametrize(
    ("transition", "codes", "last"),
    [
        ("(on e x y, -> b)", ["LRP108", "LRP104"], "by spaces, not by commas. Remove the comma."),
        ("(on e 3 -> b,)", ["LRP108", "LRP104"], "by spaces, not by commas. Remove the comma."),
        ("(on e -> b,)", ["LRP108", "LRP104"], "by spaces, not by commas. Remove the comma."),
        ("(on e x y -> (b))", ["LRP108", "LRP110"], "without brackets here. Write `b`."),
        ("(on e x y, -> (b),)", ["LRP108", "LRP104", "LRP110"], "without brackets here. Write `b`."),
    ],
)
def test_a_mistake_after_one_without_an_explanation_is_explained(
    transition: str, codes: list[str], last: str
) -> None:
    findings = check(f"(machine m (state a) (state b) {transition})")
    assert [finding.code for finding in findings] == codes
    assert last in findings[-1].message


def _found(text: str) -> list[tuple[str, str, int, int]]:
    return [(each.code, each.message, each.line, each.column) for each in check(text)]


@pytest.mark.slow
def test_every_rule_is_needed_and_can_be_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    wrong = [
        section.frame.replace("□" if "□" in section.frame else row.right, row.text)
        for section in SECTIONS
        for row in section.rows
    ]
    explained = {text: found for text in wrong if (found := _found(text))}
    every_rule = mistakes.RULES
    for left_out in every_rule:
        monkeypatch.setattr(mistakes, "RULES", [rule for rule in every_rule if rule is not left_out])
        assert any(_found(text) != found for text, found in explained.items()), left_out.propose
