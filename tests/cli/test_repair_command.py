"""``lrp repair``, and ``lrp grade --repair``."""

import csv

import pytest

from lrp_jupyter.grading.bundled.starters import starter

IDLE = "(machine m (state waiting)) (spawn m waiting)"


@pytest.mark.slow
def test_the_command_prints_the_change_and_writes_the_program(lrp, tmp_path):
    mine, mended = tmp_path / "mine.lrp", tmp_path / "mended.lrp"
    mine.write_text(starter("robot 5"))
    result = lrp("repair", mine, "--challenge", "robot 5", "--seeds", "1", "--write", mended)
    assert result.exit_code == 0
    assert "in `running` instead of `onentry` of `driving` (line 3) passes in 1 of 1 runs" in result.stdout
    assert "(running [robot.move(linear=0.2)])" in mended.read_text()
    assert mine.read_text() == starter("robot 5")


@pytest.mark.parametrize(
    ("text", "words"),
    [(IDLE, "No small change was found"), ("(machine m", "is not closed")],
)
def test_it_says_that_there_is_none_with_an_exit_code(lrp, tmp_path, text, words):
    mine = tmp_path / "mine.lrp"
    mine.write_text(text)
    result = lrp("repair", mine, "--challenge", "first move", "--seeds", "1")
    assert (result.exit_code, words in result.stdout + result.stderr) == (1, True)


@pytest.mark.slow
def test_grading_a_class_notes_how_far_off_each_program_is(lrp, tmp_path):
    folder, out, pages = tmp_path / "class", tmp_path / "marks.csv", tmp_path / "pages"
    folder.mkdir()
    moves = starter("robot 5")
    (folder / "ada.lrp").write_text(moves)
    (folder / "bob.lrp").write_text(moves.replace("onentry", "running"))
    options = ("--seeds", "1", "--repair", "--out", out, "--feedback", pages)
    lrp("grade", folder, "--challenge", "robot 5", *options)
    with out.open(encoding="utf-8-sig", newline="") as file:
        notes = [row["notes"] for row in csv.DictReader(file)]
    assert "in `running` instead of `onentry`" in notes[0]
    assert notes[1] == ""
    assert "instead of" not in "".join(page.read_text("utf-8") for page in pages.glob("ada*"))
