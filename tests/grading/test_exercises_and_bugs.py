"""The exercises of the lessons, and the bugs: none begins solved, and neither cheats nor mistakes pass.

Their solutions are tried by tests/notebooks/test_exercises.py, with the notebooks that hold them.
"""

import re
from dataclasses import replace

import pytest
from grading.answers import of_series
from support.tables import every

from lrp_jupyter import Session
from lrp_jupyter.grading.attempt import attempt
from lrp_jupyter.grading.challenges import EXERCISES, challenges_by_series
from lrp_jupyter.grading.grade import jobs_of
from lrp_jupyter.language.parser import scan

ANSWERS = of_series()


def some(rows, of):
    """Return the rows as parameters; all but one in eight are marked slow."""
    return [
        pytest.param(each, id=of(each), marks=() if index % 8 == 0 else pytest.mark.slow)
        for index, each in enumerate(rows)
    ]


def failing(text, name):
    """Return the first run that does not pass; None if there is none."""
    _, jobs = jobs_of(text, name)
    return next((made for made in map(attempt, jobs) if not made.passed), None)


@pytest.mark.parametrize("each", some(EXERCISES, lambda each: each.name))
def test_an_exercise_does_not_begin_solved_and_has_a_hint_for_who_changes_nothing(each):
    made = failing(each.beginning, each.name)
    assert made is not None
    assert made.hint, made.reason


@pytest.mark.slow
@pytest.mark.parametrize("answer", some(ANSWERS, lambda answer: answer.id))
def test_a_cheat_or_a_mistake_fails_and_a_mistake_gets_its_hint(answer):
    made = failing(answer.text, answer.challenge)
    assert made is not None
    if answer.kind == "wrong":
        assert any(answer.about in hint for hint in made.hints), "\n".join(map(str, (*made.hints, made)))


def test_every_exercise_has_a_cheat_or_a_mistake():
    assert {answer.challenge for answer in ANSWERS} == {each.name for each in EXERCISES}


@every("each", EXERCISES)
def test_an_exercise_can_be_judged_in_each_world_and_is_run_with_more_than_one_seed(each):
    each.check()
    assert each.count > 1


def test_the_exercises_have_four_numbers_in_each_lesson_and_the_bugs_are_counted():
    series = challenges_by_series()
    exercises = [each.name for each in series["exercises of the lessons"]]
    lessons = list(dict.fromkeys(re.findall(r"exercise (\d+)\.", " ".join(exercises))))
    assert exercises == [f"exercise {lesson}.{number}" for lesson in lessons for number in (1, 2, 3, 5)]
    bugs = [each.name for each in series.get("find the bug", ())]
    assert bugs == [f"bug {number}" for number, _ in enumerate(bugs, 1)]


@every(
    ("name", "worlds"),
    [
        ("exercise 16.1", {"wall after 1 m", "wall after 0.5 m"}),
        ("exercise 16.3", {"black line", "line near the wall"}),
    ],
)
def test_what_a_hint_calls_broken_had_passed(name, worlds):
    task = next(each for each in EXERCISES if each.name == name)
    jobs = jobs_of(task.beginning, task, 1)[1]
    assert {job.world_name for job in jobs if attempt(job).passed} == worlds
    broken = map(attempt, jobs_of(task.beginning.replace("driving ->", "stopped ->"), task, 1)[1])
    assert {
        made.world for made in broken if any("an edit has broken it" in hint for hint in made.hints)
    } == worlds


@every("each", EXERCISES)
def test_the_bracket_that_closes_a_machine_has_a_line_of_its_own(each):
    program, _ = scan(each.starter)
    for machine in program.machines if program else ():
        assert each.starter[machine.span.start : machine.span.end].splitlines()[-1].strip() == ")"


@every("each", challenges_by_series()["find the bug"])
def test_the_lab_finds_nothing_in_a_bug_before_it_runs(each):
    world, _ = each.runs[0]
    with Session(each.starter, "sim", world=world) as session:
        assert not [found for found in session.check(session.program) if found.severity != "hint"]


@every("each", challenges_by_series()["find the bug"])
def test_one_sees_a_bug_in_the_world_that_the_lab_opens(each):
    alone = replace(each, worlds=each.worlds[:1], vary=(), seeds=1)
    assert not attempt(jobs_of(each.starter, alone)[1][0]).passed or each.name == "bug 8"  # which is rare
