"""The page for teachers says which hint comes for which mistake; for each, an answer gets it."""

import re
from pathlib import Path

import pytest
from grading.answers import ANSWERS
from grading.test_hints import BACKS, DRIVE, SLOW, rover
from support.tables import every

from lrp_jupyter.grading.attempt import attempt
from lrp_jupyter.grading.challenges import challenges
from lrp_jupyter.grading.grade import jobs_of

PAGE = Path(__file__).parents[2] / "notebooks" / "teachers" / "index.md"
ANY = {
    "a state to which no transition leads": (rover("(on bump driving -> backing)"), "bump and turn"),
    "`robot.move` in `onentry` only": (DRIVE.replace("running", "onentry"), "square"),
    "the robot never stops turning": (rover(BACKS), "bump and turn"),
    "right, but too slow": (SLOW, "square"),
    "a measured value compared with `==`": (
        rover(f"{BACKS} (on [robot.gyro.data == 3.14] turning -> driving)"),
        "bump and turn",
    ),
}


def rows():
    """Return exercise, mistake and words of the hint of each row of the table."""
    table = (
        PAGE.read_text("utf-8").partition("| words of the hint |\n|---|---|---|\n")[2].partition("\n\n")[0]
    )
    exercise, found = "", []
    for line in table.splitlines():
        first, mistake, words = (cell.strip() for cell in line.strip("|").split(" | "))
        exercise = first or exercise
        found.append((exercise, mistake, words.strip('"')))
    return found


ROWS = rows()
NAMES = {each.name for each in challenges()}


@every(("exercise", "mistake", "words"), [row for row in ROWS if row[0] != "any"])
def test_a_wrong_answer_gets_the_hint_that_the_page_quotes(exercise, mistake, words):
    for name in [exercise] if exercise in NAMES else exercise.split(", "):
        about = [each.about for each in ANSWERS if (each.challenge, each.kind) == (name, "wrong")]
        assert any(words in each for each in about), f"{name}: {about}"


@pytest.mark.slow
@every(("exercise", "mistake", "words"), [row for row in ROWS if row[0] == "any"])
def test_the_hint_that_comes_in_every_exercise_is_the_first_one(exercise, mistake, words):
    made = attempt(jobs_of(*ANY[mistake])[1][0])
    assert re.search(re.escape(words).replace("…", ".+"), made.hint), made.hint
