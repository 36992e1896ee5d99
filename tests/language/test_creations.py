"""What is missing can be created: by an edit that is offered, and that makes the finding go away."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given
from programs import programs
from support.tables import every

from lrp_jupyter import check, parse
from lrp_jupyter.language.edits import form_places as sheet
from lrp_jupyter.language.printer import to_source
from lrp_jupyter.language.program import Finding, Program

MACHINE = """\
(var limit := [5])   ; of all

(machine m
  (var n := [0])
  (event full [n > limit])   ; at last

  (state count (running [n += 1]))
  (state rest)
  (on full count -> rest)
  {})

(spawn m count)
"""


@every(
    ("wrong", "title", "line", "after"),
    [
        ("(on full rest -> finished)", "Create the state `finished`", "  (state finished)", "  (state rest)"),
        ("(on full asleep -> rest)", "Create the state `asleep`", "  (state asleep)", "  (state rest)"),
        (
            "(on begin rest -> count)",
            "Create the event `begin`",
            "  (event begin [False])",
            "  (event full [n > limit])   ; at last",
        ),
        (
            "(ontime pause rest -> count)",
            "Create the variable `pause`",
            "(var pause := [1000])",
            "(var limit := [5])   ; of all",
        ),
        (
            "(on [found] rest -> count)",
            "Create the variable `found`",
            "(var found := [0])",
            "(var limit := [5])   ; of all",
        ),
    ],
)
def test_what_a_transition_names_is_created_after_the_last_one_of_its_kind(
    wrong: str, title: str, line: str, after: str
) -> None:
    text = MACHINE.format(wrong)
    (finding,) = (each for each in check(text) if each.severity == "error")
    assert finding.creates is not None
    assert finding.creates.title == title
    created = finding.creates.apply(text)
    assert created == text.replace(f"{after}\n", f"{after}\n{line}\n")
    assert [each for each in check(created) if each.severity == "error"] == []


def test_a_similar_name_is_offered_beside_the_creation() -> None:
    (finding,) = check(MACHINE.format("(on full rest -> cuont)"))
    assert finding.fix is not None
    assert finding.creates is not None
    assert (finding.fix.title, finding.creates.title) == ("Change to `count`", "Create the state `cuont`")


def test_a_machine_that_a_state_spawns_is_created_in_it() -> None:
    text = "(machine m\n  (state a\n    (onentry (spawn search left))))\n(spawn m a)\n"
    (finding,) = check(text)
    assert finding.creates is not None
    assert finding.creates.apply(text) == (
        "(machine m\n  (state a\n    (onentry (spawn search left))\n    (machine search (state left))))\n"
        "(spawn m a)\n"
    )


@every(
    ("text", "spawned"),
    [
        (
            "(machine m (state a (machine n (state x) (state y))))\n(spawn m a)",
            "(machine m (state a (onentry (spawn n x)) (machine n (state x) (state y))))\n(spawn m a)",
        ),
        ("(machine m (state a) (state b))", "(machine m (state a) (state b))\n\n(spawn m a)\n"),
    ],
)
def test_a_spawn_is_written_even_where_the_start_is_not_certain(text: str, spawned: str) -> None:
    finding = next(each for each in check(text) if each.code in ("LRP402", "LRP206"))
    assert finding.fix is None
    assert finding.creates is not None
    assert finding.creates.apply(text) == spawned


PARTS = """\
(machine m
  (state a{})
  (state b (onentry (spawn move x (var tries := [1]))))
  (on {} a -> b)
  (on move.y b -> a))

(machine move
  (var tries := [0])
  (state x)
  (state y)
  (on [tries > 2] x -> y))

(machine lamp
  (state off))

(spawn m a)
(spawn lamp off)
"""


@every(
    ("wrong", "right"),
    [
        (("", "move.y"), (" (onentry (spawn move x))", "move.y")),
        (("", "lamp.off"), ("", '[lamp.state == "off"]')),
        (("", "go.away"), (" (machine go (state away))", "go.away")),
    ],
)
def test_what_a_condition_on_a_machine_lacks_is_created(
    wrong: tuple[str, str], right: tuple[str, str]
) -> None:
    finding = next(each for each in check(PARTS.format(*wrong)) if each.creates)
    assert finding.creates is not None
    assert parse(finding.creates.apply(PARTS.format(*wrong))) == parse(PARTS.format(*right))


def test_what_a_spawn_sets_is_created_in_its_machine() -> None:
    text = PARTS.format("", "[True]").replace("(var tries := [1])", "(var keep := [1])")
    (finding,) = check(text)
    assert finding.creates is not None
    assert finding.creates.title == "Create the variable `keep`"
    created = finding.creates.apply(text)
    assert "  (var tries := [0])\n  (var keep := [0])\n" in created


def test_nothing_is_created_for_a_name_that_something_else_explains() -> None:
    for block in ("sqrt(math.pi)", "full"):
        text = MACHINE.format("(state last (running [found = BLOCK]))".replace("BLOCK", block))
        offered = {each.creates.title for each in check(text) if each.creates}
        assert offered <= {"Create the variable `sqrt`"}


def alike(finding: Finding, findings: list[Finding]) -> int:
    """How many findings say the same: machines of one name may lack the same in several places."""
    return sum((each.code, each.message) == (finding.code, finding.message) for each in findings)


@given(programs)
def test_a_creation_leaves_a_program_without_the_finding(program: Program) -> None:
    text = to_source(program)
    findings = check(text)
    for finding in findings[:5]:
        if finding.creates:
            after = finding.creates.apply(text)
            parse(after)
            assert alike(finding, check(after)) < alike(finding, findings)


def test_a_creation_in_a_long_program_reads_only_the_forms_around_it(monkeypatch: pytest.MonkeyPatch) -> None:
    made = []
    make = sheet.WrittenForm.__init__

    def counted(form: sheet.WrittenForm, *rest: Any, **more: Any) -> None:
        made.append(form)
        make(form, *rest, **more)

    monkeypatch.setattr(sheet.WrittenForm, "__init__", counted)
    states = "".join(f" (state s{number} (onentry [1]))" for number in range(20))
    others = "".join(f"(machine m{number}{states})\n(spawn m{number} s0)\n" for number in range(10))
    found = check(parse(f"{others}(machine last (state a) (on [True] a -> b))\n(spawn last a)\n"))
    assert [each.creates.title for each in found if each.creates] == ["Create the state `b`"]
    assert len(made) < 30


def test_a_program_put_together_from_two_texts_is_checked_and_nothing_is_created_in_it() -> None:
    other = parse("(machine other (state here) (on begin here -> there) (state a (onentry (spawn b c))))")
    mixed = replace(parse(MACHINE.format("")), machines=other.machines)
    created = [finding.creates for finding in check(mixed) if finding.code in ("LRP301", "LRP303")]
    assert created == [None, None]
