"""What completion offers. `completions.json` is what the lab's page is tested with, too."""

import json
from pathlib import Path

import pytest

from lrp_jupyter import programs
from lrp_jupyter.editors.call_signatures import signature_at
from lrp_jupyter.editors.program_text import AssumedRobot, ProgramText
from lrp_jupyter.editors.word_options import complete
from lrp_jupyter.language.form_texts import form_texts
from lrp_jupyter.language.reading.forms import USAGE

TABLE = json.loads(Path(__file__).with_name("completions.json").read_text(encoding="utf-8"))
ROBOT = AssumedRobot(None, None)


def offered(text):
    """The completions at the `|` of a text; one that begins with `@` is a part of the table's program."""
    text = TABLE["program"].replace("@", text[1:]) if text.startswith("@") else text
    offset = text.index("|")
    found = complete(ProgramText(text[:offset] + text[offset + 1 :], 1, "utf-16", ROBOT), offset)
    return {each.label: each for each in found.options}


@pytest.mark.parametrize(("text", "labels"), TABLE["offered"])
def test_what_may_stand_there_is_offered(text, labels):
    assert sorted(offered(text)) == labels


def test_a_block_offers_what_it_can_use():
    names = [*offered("@ (state s (running [|]))")]
    assert names[:5] == ["own", "robot", "near", "move", "part"]
    assert {"abs", "elapsed", "degrees", "if"} <= {*names}


def test_the_robot_of_the_program_offers_its_members():
    members = offered("; world: maze\n(state s (running [robot.|]))")
    assert {"light", "scan", "move", "drive_by"} <= members.keys()
    assert members["move"].detail == "(linear=0.0, angular=0.0)"
    assert "brightness" in offered("(state s (running [robot.light.|]))")["data"].info
    assert [*offered("(state s (running [robot.odom.|]))")] == ["x", "y", "theta"]
    assert [*offered("(state s (running [robot.move(lambda m: m.linear.|)]))")] == ["x", "y", "z"]
    assert [*offered("(state s (running [robot.move(lambda : f().|)]))")] == []
    assert {"linear=", "angular="} <= offered("(state s (running [robot.move(|)]))").keys()
    for world, has_members in [("line", True), ("none", False)]:
        text = f"; mine (the second)\n; world: {world}\n(state s (running [robot.|]))"
        assert bool(offered(text)) is has_members


@pytest.mark.parametrize(
    ("written", "active"),
    [
        ("robot.move(|", "linear"),
        ("robot.move(0.2, |", "angular"),
        ("robot.move(max(1, 2), |", "angular"),
        ("robot.move(angular=|", "angular"),
        ("robot.drive_by(1, speed=0|", "speed"),
        ("robot.light(|", None),
        ("robot.move(0.2)|", None),
        ("move(|", None),
        ("'robot.move' (|", None),
    ],
)
def test_what_a_command_takes_is_shown_while_it_is_written(written, active):
    text = f"(machine m (state s (running [{written}])))"
    offset = text.index("|")
    found = signature_at(ProgramText(text.replace("|", ""), 1, "utf-16", ROBOT), offset)
    assert (found and found.parameters[found.active]) == active


def test_a_form_that_is_not_closed_hides_nothing_after_it():
    assert [*offered("@ (on near carrying -> |\n  (state later)")] == ["carrying", "look", "later"]


def test_a_form_that_is_written_gets_its_bracket_only_where_it_lacks_one():
    assert offered("(machine m (st|")["state"].snippet.endswith(")")
    assert not offered("(machine m (st|))")["state"].snippet.endswith(")")


@pytest.mark.parametrize("keyword", [*form_texts()])
def test_what_is_said_about_a_form_is_what_the_parser_says(keyword):
    said = form_texts()[keyword]
    assert said.usage == USAGE.get(keyword, said.usage)
    assert said.doc.endswith(".")


@pytest.mark.parametrize("name", programs.names())
def test_completion_goes_on_wherever_a_program_is_cut_off(name):
    text = programs.load(name)
    for end in range(0, len(text), 97):
        assert complete(ProgramText(text[:end], 1, "utf-16", ROBOT), end).begin <= end
