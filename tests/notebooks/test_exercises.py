"""The exercises of the notebooks: what they begin with does not pass, and the teachers' solutions do."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

import pytest
from prose import file_of, prose
from stored import NOTEBOOKS, challenge_of, opened_program, paths, read, sources
from support.tables import every

from lrp_jupyter import Session, grade
from lrp_jupyter.grading import challenges as registry
from lrp_jupyter.grading.attempt import attempt
from lrp_jupyter.grading.challenges import BUNDLED, Challenge, challenge, challenges
from lrp_jupyter.grading.grade import jobs_of
from lrp_jupyter.grading.workers import run_jobs
from lrp_jupyter.language.edits.initials import with_initial

SOLUTIONS = NOTEBOOKS / "teachers" / "solutions"
BROKEN = NOTEBOOKS / "08-why-did-it-not-fire.ipynb"
LONG = {"robust follower"}
"""Challenges whose many runs take long."""
OWN_BEGINNING = {"there and back"}
"""Challenges that a notebook begins with less than they do: the reader types the rest."""


class Exercise(NamedTuple):
    """A cell that opens a challenge."""

    notebook: Path
    challenge: str
    text: str

    @property
    def seeds(self) -> range | None:
        """Fewer seeds than the challenge has, where they are many."""
        return range(1000, 1010) if self.challenge in LONG else None

    @property
    def solution(self) -> Path:
        return _solution_of(self.challenge)


def _solution_of(challenge: str) -> Path:
    return SOLUTIONS / f"{file_of(challenge)}.lrp"


def _exercises() -> Iterator[Exercise]:
    for path in paths():
        if path.parent.name in ("appendix", "reference"):
            continue
        for source in sources(read(path), "code"):
            if name := challenge_of(source):
                yield Exercise(path, name, source.partition("\n")[2])


EXERCISES = list(_exercises())


def _exercises_with(is_slow: Callable[[Exercise], bool]) -> pytest.MarkDecorator:
    return pytest.mark.parametrize(
        "exercise",
        [
            pytest.param(each, marks=pytest.mark.slow if is_slow(each) else (), id=each.solution.stem)
            for each in EXERCISES
        ],
    )


all_exercises = _exercises_with(lambda each: each.challenge in LONG)
all_but_most_of_a_series = _exercises_with(
    lambda each: (
        each.challenge in LONG
        or (each.notebook.parent.name == "exercises" and not each.challenge.endswith((".1", "bug 1")))
    )
)


def test_every_lesson_has_an_exercise_and_so_has_every_project_but_the_own_idea():
    with_one = {exercise.notebook for exercise in EXERCISES}
    expected = [path for path in paths() if path.parent in (NOTEBOOKS, NOTEBOOKS / "projects")]
    assert {path.stem for path in set(expected) - with_one} == {"own-idea"}
    assert len({exercise.challenge for exercise in EXERCISES}) == len(EXERCISES)


def test_every_exercise_has_a_solution_and_every_solution_its_challenge():
    assert {exercise.solution for exercise in EXERCISES} <= set(SOLUTIONS.iterdir())
    assert {path.stem for path in SOLUTIONS.iterdir()} <= {file_of(each.name) for each in challenges()}


OPENED = {exercise.challenge for exercise in EXERCISES}


@pytest.mark.slow
@every("task", [each for each in BUNDLED if each.name not in OPENED and _solution_of(each.name).exists()])
def test_the_solution_of_a_challenge_without_a_notebook_passes_in_a_world(task: Challenge):
    _, jobs = jobs_of(_solution_of(task.name).read_text(encoding="utf-8"), task)
    made = attempt(jobs[-1])
    assert made.passed, str(made)


@all_exercises
def test_an_exercise_begins_as_its_challenge_does_or_does_not_pass_either(exercise: Exercise):
    if exercise.challenge in OWN_BEGINNING:
        assert not attempt(jobs_of(exercise.text, exercise.challenge)[1][0]).passed
    else:  # which tests/grading/test_challenges.py tries
        assert exercise.text.strip() == challenge(exercise.challenge).starter.strip()


@every("exercise", EXERCISES)
def test_the_bracket_that_closes_a_machine_has_a_line_of_its_own(exercise: Exercise):
    for machine in re.split(r"^(?=\(machine)", exercise.text, flags=re.MULTILINE)[1:]:
        assert "\n)\n" in f"{machine}\n"


@all_but_most_of_a_series
def test_the_solution_passes_in_a_world(exercise: Exercise):
    _, jobs = jobs_of(exercise.solution.read_text(encoding="utf-8"), exercise.challenge)
    made = attempt(jobs[EXERCISES.index(exercise) % len(jobs)])
    assert made.passed, str(made)


@pytest.mark.slow
@all_exercises
def test_the_solution_passes(exercise: Exercise):
    result = grade(exercise.solution.read_text(encoding="utf-8"), exercise.challenge, exercise.seeds)
    assert result, result
    assert result.points == result.out_of


def _place(path: Path) -> str:
    return path.relative_to(NOTEBOOKS).as_posix()


SERIES = [exercise for exercise in EXERCISES if exercise.notebook.parent.name == "exercises"]


@every("exercise", SERIES)
def test_an_exercise_of_a_series_says_its_task_and_its_number(exercise: Exercise):
    text = "\n".join(sources(read(exercise.notebook), "markdown"))
    number = exercise.challenge.removeprefix("exercise ").capitalize()
    assert re.search(rf"^## {number}( · .*)?\n\n{re.escape(challenge(exercise.challenge).task)}", text, re.M)


def test_a_lesson_leads_to_five_exercises_of_which_the_fourth_is_open_and_the_plans_know_all():
    lessons = [NOTEBOOKS / path.name for path in paths() if re.match(r"exercises/\d\d", _place(path))]
    assert [path.name for path in lessons] == [path.name for path in paths() if path.parent == NOTEBOOKS]
    answers = (NOTEBOOKS / "teachers" / "exercises.md").read_text(encoding="utf-8")
    table = re.findall(r"^\| \[\d\d\]\(\.\./(.*?)\) \| ([\d.]+) \|(?:[^|]+\|){2} \d+ \|$", answers, re.M)
    expected = []
    for path in lessons:
        file = f"exercises/{path.name}"
        assert f"Exercises: [five for this lesson]({file})." in prose(read(path))
        number = int(path.stem[:2])
        headings = re.findall(r"^## ([\d.]+) · ", prose(read(NOTEBOOKS / file)), re.M)
        assert headings == [f"{number}.{each}" for each in range(1, 6)]
        closed = [each.challenge for each in SERIES if each.notebook.name == path.name]
        assert closed == [f"exercise {number}.{each}" for each in (1, 2, 3, 5)]
        expected += [(file, heading) for heading in headings]
    assert table == expected
    bugs = [each.challenge for each in SERIES if each.notebook.stem == "find-the-bug"]
    assert bugs == [f"bug {each}" for each in re.findall(r"^\| (\d) \|", answers, re.M)[-len(bugs) :]]


@pytest.mark.slow
@every(
    ("name", "asked", "code"),
    [
        ("exercise 8.1", "tstop", "condition-false"),
        ("exercise 8.2", "tleave", "delay-not-over"),
        ("exercise 8.3", "tback", "condition-false"),
        ("bug 1", "tstop", "fired"),
        ("bug 2", "tstop", "condition-false"),
        ("bug 3", "tstop", "source-inactive"),
        ("bug 4", "robot.move", "commanded"),
        ("bug 6", "tend", "fired"),
        ("bug 7", "tturn", "delay-not-over"),
    ],
)
def test_a_program_that_is_to_be_asked_answers_as_its_exercise_says(name: str, asked: str, code: str):
    task = challenge(name)
    world, seed = task.runs[0]
    session = Session(task.starter, "sim", world=world, noise=task.noise, seed=seed)
    session.run(12)
    assert code in {session.explain(asked, tick).code for tick in range(2, session.frame.tick)}


@every("exercise", EXERCISES)
def test_the_students_notebook_does_not_hold_the_solution(exercise: Exercise):
    text = re.sub(r"\s+", " ", exercise.solution.read_text(encoding="utf-8"))
    text = re.sub(r"^(;.*? )+(?=\()", "", text).strip()
    stored = re.sub(r"\s+", " ", exercise.notebook.read_text(encoding="utf-8").replace("\\n", " "))
    assert text not in stored
    assert "A solution" not in stored


# -- what the notebooks say about them ---------------------------------------------------------------


def _sees_the_line_at(speed: float) -> bool:
    text = (SOLUTIONS / "stop-at-the-line.lrp").read_text(encoding="utf-8")
    _, jobs = jobs_of(text.replace("linear=0.2", f"linear={speed:g}"), "stop at the line")
    return all(attempt(job).passed for job in jobs)


@pytest.mark.slow
def test_a_robot_that_is_faster_than_the_rule_allows_does_not_see_the_line():
    said = prose(read(NOTEBOOKS / "04-what-the-robot-sees.ipynb"))
    assert "at 0.45 m/s and ten ticks per second it moves 4.5 cm" in said
    assert "The line is 3 cm wide" in said
    assert _sees_the_line_at(0.3)
    assert not _sees_the_line_at(0.4)


@pytest.mark.slow
@every("speed", [0.2, 0.26, 0.3, 0.32, 0.4, 0.42, 0.5])
def test_the_rule_on_speed_holds_at_every_speed(speed):
    assert _sees_the_line_at(speed) == (speed <= 0.3)


@pytest.mark.slow
def test_a_lap_needs_the_faster_drive_and_the_faster_search_that_its_plan_names():
    assert "`forward` at 0.4 and `search` at 1.5 pass; either alone does not" in _plans()
    begins = challenge("lap").starter
    fast = _with(begins, forward=0.4)
    assert not grade(fast, "lap")
    assert not grade(_with(begins, search=1.5), "lap")
    assert grade(_with(fast, search=1.5), "lap")


def test_gains_between_those_that_the_plan_names_keep_the_distance_and_others_do_not():
    said = re.search(r"Gains from ([\d.]+) to ([\d.]+) pass", _plans())
    assert said is not None
    solution = (SOLUTIONS / "keep-your-distance.lrp").read_text(encoding="utf-8")
    small, large = float(said[1]), float(said[2])
    passed = {}
    for gain in (small / 2, small, large, 2 * large):
        _, jobs = jobs_of(_with(solution, gain=gain), "keep your distance")
        passed[gain] = attempt(jobs[-1]).passed
    assert list(passed.values()) == [False, True, True, False]


@pytest.mark.slow
def test_the_gap_helps_the_robust_follower_as_much_as_its_plan_says():
    said = re.search(r"(\d+) of 50 pass with a `gap` of (\d+)", _plans())
    assert said is not None
    text = _with(challenge("robust follower").starter, gap=int(said[2]))
    assert _runs_passed(text) == (int(said[1]), 50)


@pytest.mark.slow
def test_a_gap_that_is_too_wide_costs_the_time_that_its_plan_says():
    said = re.search(r"about (\d+) s with (\d+) and (\d+) s with (\d+), instead of (\d+) s\.", _plans())
    assert said is not None
    task = replace(challenge("robust follower"), seeds=range(1000, 1006))
    for seconds, gap in ((said[1], said[2]), (said[3], said[4]), (said[5], "70")):
        _, jobs = jobs_of(_with(task.starter, gap=int(gap)), task)
        times = sorted(attempt(job).seconds for job in jobs)
        assert round(times[len(times) // 2]) == int(seconds)


def _runs_passed(text: str) -> tuple[int, int]:
    """How many of the runs of the robust follower a program passes."""
    _, jobs = jobs_of(text, "robust follower")
    return sum(made.passed for _, made in run_jobs(jobs)), len(jobs)


def _plans() -> str:
    return (NOTEBOOKS / "teachers" / "lesson-plans.md").read_text(encoding="utf-8")


def _with(program: str, **values: float) -> str:
    """Return a program with other initial values."""
    for name, value in values.items():
        program = with_initial(program, (name,), repr(value))
    return program


@pytest.mark.slow
def test_the_robust_follower_passes_as_often_as_its_notebook_says():
    path = NOTEBOOKS / "10-robust-robots.ipynb"
    said = re.search(r"In (\d+) of them\.", prose(read(path)))
    assert said is not None
    (exercise,) = (each for each in EXERCISES if each.notebook == path)
    assert _runs_passed(exercise.text) == (int(said[1]), 50)


def test_the_rooms_of_the_last_exercises_show_what_is_to_be_repaired():
    cells = sources(read(NOTEBOOKS / "exercises" / "16-testing-your-own-program.ipynb"), "code")
    names: dict[str, Any] = {}
    exec(next(cell for cell in cells if "def room" in cell), names)
    own = SimpleNamespace(**names)
    stops = (own.touches_nothing(), own.ends_in("right place"), own.ends_still(2))

    def passed(number: str, worlds: list[Any], *criteria: Any, **more: Any) -> list[bool]:
        tests = own.tests(worlds, criteria, **more)
        return [attempt(job).passed for job in jobs_of(challenge(f"exercise {number}").starter, tests)[1]]

    room, backs_off = own.room, (own.touches("edge"), own.ends_in("between the walls"))
    assert passed("16.1", [room(1), room(0.5), room(0.2, 0.1)], *backs_off) == [True, True, False]
    assert passed("16.2", [room(1.2)], *stops, seeds=[0, 4, 6, 7], dropout=0.06) == [True, *[False] * 3]
    rooms = [room(2, line=1), room(2, line=1, grey=90), room(2), room(1.2, line=1)]
    assert passed("16.3", rooms, *stops) == [True, False, False, True]


# -- six broken robots ---------------------------------------------------------------------------------

_LETTERS = {
    "condition-false": "A",
    "raised": "B",
    "earlier-fired": "C",
    "delay-not-over": "D",
    "machine-not-running": "E",
    "watchdog": "F",
}


@pytest.mark.slow
def test_the_six_broken_robots_answer_as_the_notebook_says():
    text = prose(read(BROKEN))
    said = dict(re.findall(r"(\d) ([A-F])\b", text.partition("<summary>The reasons</summary>")[2]))
    robots = [each for each in EXERCISES if each.notebook == BROKEN]
    for number, robot in enumerate(robots, 1):
        asked = re.search(r"ask (?:`(\w+)`|the robot)", challenge(robot.challenge).task)
        assert asked is not None
        session = Session(robot.text, "sim", world="boxes")
        session.run(5)
        ticks = range(2, session.frame.tick)
        codes = [session.explain(asked[1] or "robot.move", tick).code for tick in ticks]
        wanted = next(code for code, letter in _LETTERS.items() if letter == said[str(number)])
        if number == 6:
            assert codes.count("raised") == 1, "in one single tick"
        elif number in (3, 5):
            assert wanted in codes
        else:
            assert codes[-1] == wanted


def test_every_reason_that_the_table_lists_is_that_of_one_robot():
    text = prose(read(BROKEN))
    listed = re.findall(r"^\| ([A-F]) \|", text, re.MULTILINE)
    said = re.findall(r"(\d) ([A-F])\b", text.partition("<summary>The reasons</summary>")[2])
    assert sorted(letter for _, letter in said) == listed == list(_LETTERS.values())


def test_each_broken_robot_is_named_by_the_cell_that_opens_it():
    names = [opened_program(source) for source in sources(read(BROKEN), "code") if challenge_of(source)]
    assert names == ["pusher", "sleeper", "doors", "search", "stander", "counter"]


# -- a challenge of one's own --------------------------------------------------------------------------


@pytest.mark.slow
def test_no_clock_parks_in_all_garages_and_no_robot_that_rests_again_and_again_parks(monkeypatch):
    notebook = read(NOTEBOOKS / "appendix" / "your-own-challenge.ipynb")
    said = prose(notebook)
    assert "One time may fit one garage or two, but never all of them" in said
    assert "that is why there is `stops_once`" in said
    monkeypatch.setattr(registry, "_challenges", dict(registry._challenges))
    cells = [cell for cell in sources(notebook, "code") if re.search(r"def garage|register\(", cell)]
    names: dict[str, object] = {}
    for cell in cells:
        exec(cell, names)
    (cell,) = (cell for cell in sources(notebook, "code") if "by_the_clock =" in cell)
    exec(cell.partition("for program in")[0], names)
    parking = challenge("parking")
    passed = []
    for milliseconds in range(2000, 12001, 2000):
        text = str(names["by_the_clock"]).replace("10000", str(milliseconds))
        passed.append({job.world_name for job in jobs_of(text, parking)[1] if attempt(job).passed})
    assert {1, 2} <= {len(worlds) for worlds in passed} <= {0, 1, 2}
    resting = jobs_of(str(names["now_and_then"]), replace(parking, seconds=60))[1]
    assert not any(attempt(job).passed for job in resting)
    once, others = parking.criteria[2], (*parking.criteria[:2], *parking.criteria[3:])
    assert once.sentence == "stops only once"
    resting = jobs_of(str(names["now_and_then"]), replace(parking, seconds=60, criteria=others))[1]
    assert any(attempt(job).passed for job in resting)
