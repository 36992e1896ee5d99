"""Every bundled challenge: its solutions pass, its cheats fail, its typical wrong answers get their hints."""

from collections import Counter

import pytest
from grading.answers import ANSWERS
from support.tables import every

from lrp_jupyter.grading.attempt import attempt
from lrp_jupyter.grading.challenges import BUNDLED
from lrp_jupyter.grading.grade import grade, jobs_of
from lrp_jupyter.language.parser import scan
from lrp_jupyter.programs import heading, load, names

NAMES = [each.name for each in BUNDLED]
MADE_FOR = {name: challenge for name in names() if (challenge := heading(load(name)).challenge)}


LONG = 100  # s
SEEDS = {"find the line": (0, 6), "follow the line": (0, 9), "robust follower": range(1000, 1005)}
"""Seeds with which solutions are proved, among them one that was too hard, where it is not the first two."""


def answers(kind, few, few_long):
    """Return the answers of a kind; all but some of each challenge, fewer if it is long, are marked slow."""
    found = []
    for challenge in BUNDLED:
        some = few_long if challenge.seconds > LONG else few
        of_it = [each for each in ANSWERS if (each.challenge, each.kind) == (challenge.name, kind)]
        for index, each in enumerate(of_it):
            found.append(pytest.param(each, id=each.id, marks=pytest.mark.slow if index >= some else ()))
    return found


def failing(text, what):
    """Return the first run that does not pass; None if there is none."""
    _, jobs = jobs_of(text, what)
    return next((made for made in map(attempt, jobs) if not made.passed), None)


@pytest.mark.parametrize("answer", answers("solution", 1, 0))
def test_a_solution_passes_in_a_world(answer):
    _, jobs = jobs_of(answer.text, answer.challenge)
    made = attempt(jobs[NAMES.index(answer.challenge) % len(jobs)])
    assert made.passed, str(made)


@pytest.mark.slow
@pytest.mark.parametrize("answer", answers("solution", 9, 9))
def test_a_solution_does_not_pass_by_luck(answer):
    result = grade(answer.text, answer.challenge, SEEDS.get(answer.challenge, 2))
    assert result.passed, str(result)
    assert result.points == result.out_of


@pytest.mark.parametrize("answer", answers("cheat", 1, 0))
def test_a_cheat_fails(answer):
    assert failing(answer.text, answer.challenge)


@pytest.mark.parametrize("answer", answers("wrong", 1, 0))
def test_a_typical_wrong_answer_gets_its_hint(answer):
    made = failing(answer.text, answer.challenge)
    assert made is not None
    answer.check_hint(made.hints)


@pytest.mark.parametrize(
    "each",
    [
        pytest.param(each, id=each.name, marks=pytest.mark.slow if each.seconds > LONG else ())
        for each in BUNDLED
    ],
)
def test_the_text_that_one_begins_with_does_not_pass_and_gets_a_hint(each):
    made = failing(each.beginning, each)
    assert made is not None
    assert made.hint


@every("each", BUNDLED)
def test_the_text_that_one_begins_with_says_the_task_and_has_its_last_bracket_on_a_line_of_its_own(each):
    comments = [line.removeprefix("; ") for line in each.beginning.splitlines() if line.startswith("; ")]
    assert " ".join(comments).startswith(f"{each.assignment} challenge: {each.name}")
    assert heading(each.beginning).challenge == each.name
    program, _ = scan(each.beginning)
    for machine in program.machines if program else ():
        text = each.beginning[machine.span.start : machine.span.end]
        assert text.splitlines()[-1].strip() == ")", machine.name


@every("each", BUNDLED)
def test_a_challenge_is_run_three_times_at_least_and_can_be_judged_in_each_world(each):
    assert len(each.runs) >= 3
    each.check()


@every("each", BUNDLED)
def test_a_challenge_has_three_solutions_two_cheats_and_three_wrong_answers(each):
    kinds = Counter(answer.kind for answer in ANSWERS if answer.challenge == each.name)
    assert kinds["solution"] >= 3
    assert kinds["cheat"] >= 2
    assert kinds["wrong"] >= 3


def test_some_bundled_programs_are_made_for_challenges():
    assert MADE_FOR == {
        "box-pusher": "push the box",
        "edge-guard": "edge guard",
        "follower": "there and back",
        "wall-follower": "wall follower",
    }


@pytest.mark.slow
@pytest.mark.parametrize("name", MADE_FOR)
def test_a_bundled_program_masters_the_challenge_that_it_is_made_for(name):
    result = grade(load(name), MADE_FOR[name])
    assert result.passed, str(result)
