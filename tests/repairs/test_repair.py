"""The smallest change that makes a program pass: found by real runs, or said not to be found."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

from lrp_jupyter import grade, repair
from lrp_jupyter.errors import LRPSyntaxError
from lrp_jupyter.grading.attempt import attempt
from lrp_jupyter.grading.bundled.starters import starter
from lrp_jupyter.grading.grade import jobs_of
from lrp_jupyter.grading.workers import Halt
from lrp_jupyter.repairs.numbers import Numbers
from lrp_jupyter.repairs.search import Search
from lrp_jupyter.repairs.structure import Structure
from lrp_jupyter.repairs.witness import Evidence, WitnessJob, with_notes

SOLUTIONS = Path(__file__).parents[2] / "notebooks" / "teachers" / "solutions"
SLOW = "(machine m (state go (running [robot.move(linear=0.02)]))) (spawn m go)"
IDLE = "(machine m (state waiting)) (spawn m waiting)"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "words"),
    [
        pytest.param(1, "instead of `robot.distance.data < -0.01` (line 2)", marks=pytest.mark.slow),
        pytest.param(3, "Swapping `tsave` and `talarm` (lines 8 and 9)", marks=pytest.mark.slow),
        (5, "`[robot.move(linear=0.2)]` in `running` instead of `onentry` of `driving` (line 3)"),
        (6, "create the variable `lap_time`"),
    ],
)
def test_the_first_change_of_a_broken_robot_is_what_was_broken(number, words):
    challenge = f"robot {number}"
    found = repair(starter(challenge), challenge, seeds=2)
    assert words in found.repairs[0].sentence
    assert found.repairs[0].sentence.endswith("passes in 2 of 2 runs (now 0).")
    assert grade(found.repairs[0].text, challenge, 2).passed


@pytest.mark.slow
def test_a_planted_number_is_found_and_a_round_one_is_proposed():
    found = repair(SLOW, "first move", seeds=2)
    value = float(re.match(r"`linear=([\d.]+)` instead of `linear=0.02` \(line 1\)", str(found))[1])
    assert 0.06 <= value <= 0.5
    assert len(str(value)) <= 4
    assert (found.passed, found.runs, found.repairs[0].line) == (0, 2, 1)


@pytest.mark.slow
def test_where_no_small_change_helps_this_is_said_with_what_was_tried():
    found = repair(IDLE, "first move", seeds=1)
    assert not found
    assert "There was nothing to try." in str(found)
    assert str(found).startswith("No small change was found that makes the program pass (now 0 of 1 runs).")
    tried = repair(SLOW.replace("linear", "angular"), "first move", seeds=1)
    assert "runs: other numbers" in str(tried)
    passing = repair(SLOW.replace("0.02", "0.2"), "first move", seeds=1)
    assert str(passing) == "The program passes as it is (1 of 1 runs)."


@pytest.mark.slow
def test_it_can_be_stopped_and_says_so():
    halt, counts = Halt(), []

    def progress(done, of):
        counts.append((done, of))
        if done == 5:
            halt.set()

    found = repair(starter("robot 3"), "robot 3", seeds=2, progress=progress, halt=halt)
    assert found.made < 20
    assert str(found).endswith("The search ended before everything had been tried.")
    assert all(done <= of for done, of in counts)


@pytest.mark.slow
def test_two_searches_give_the_same_answer():
    first, second = (repair(starter("robot 4"), "robot 4", seeds=1) for _ in range(2))
    assert first == second


def test_a_text_that_is_no_program_is_refused():
    with pytest.raises(LRPSyntaxError):
        repair("(machine", "first move")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["square", "bump and turn", "debug the printed listing"])
def test_a_witness_does_what_the_program_does(name):
    text = (SOLUTIONS / f"{name.replace(' ', '-')}.lrp").read_text("utf-8")
    noted = with_notes(Numbers(text))
    assert noted != text
    names = {"lrp_read_number": lambda _, value: value, "lrp_compared_side": lambda _, __, value: value}
    runs = [jobs_of(each, name, 1)[1][0] for each in (text, noted)]
    plain, witness = (attempt(replace(run, namespace=names)) for run in runs)
    assert plain.passed
    assert (witness.path, witness.seconds) == (plain.path, plain.seconds)


def test_a_delay_that_grows_beyond_all_numbers_of_a_clock_is_never_over():
    text = "(var t := [10 ** 400]) (machine m (state a) (state b) (ontime t a -> b)) (spawn m a)"
    made = attempt(jobs_of(text, "first move", 1)[1][0])
    assert (made.ended, made.passed) == ("", False)


NOTHING = {"used": [], "compared": {}, "fired": [], "stayed": [], "ended": ""}


@pytest.mark.parametrize(
    "data",
    [None, [], {"used": [1]}, NOTHING | {"used": ["a"]}, NOTHING | {"compared": {"0": [[10**400, 1]]}}],
)
def test_what_a_program_writes_instead_of_evidence_is_refused(data):
    job = jobs_of(SLOW, "first move", 1)[1][0]
    witness = WitnessJob(**vars(job))
    assert witness.made(NOTHING) == Evidence()
    with pytest.raises(ValueError, match=r"evidence|invalid literal"):
        witness.made(data)


STRUCTURE = """(machine m
  (state a (onentry [robot.stop()] [n = 0]))
  (state b)
  (on [n < 3 and (n == 1 or n > 9)] a -> b t)
  (on [n] *-{b} -> c u)
  (state c))
(var n := [0])
(spawn m a)
"""


@pytest.mark.parametrize(
    ("phrase", "line"),
    [
        ("Swapping `t` and `u` (lines 4 and 5)", "  (on [n < 3 and (n == 1 or n > 9)] a -> b t)"),
        (
            "`[n = 0]` in `onexit` instead of `onentry` of `a` (line 2)",
            "  (state a (onentry [robot.stop()]) (onexit [n = 0]))",
        ),
        ("Letting `t` also leave `c` (line 4)", "  (on [n < 3 and (n == 1 or n > 9)] {a c} -> b t)"),
        (
            "Letting `t` leave `c` instead of `a` (line 4)",
            "  (on [n < 3 and (n == 1 or n > 9)] c -> b t)",
        ),
        ("Not letting `u` leave `a` (line 5)", "  (on [n] *-{b a} -> c u)"),
        ("`n >= 1` instead of `n == 1` (line 4)", "  (on [n < 3 and (n >= 1 or n > 9)] a -> b t)"),
        ("Leaving out `n < 3` (line 4)", "  (on [(n == 1 or n > 9)] a -> b t)"),
        ("Leaving out `n == 1 or n > 9` (line 4)", "  (on [n < 3] a -> b t)"),
        ("Leaving out `n > 9` (line 4)", "  (on [n < 3 and (n == 1)] a -> b t)"),
        ("Leaving out `t` (line 4)", "  (state b)\n  (on [n] *-{b} -> c u)"),
    ],
)
def test_a_change_of_the_structure_is_named_and_touches_nothing_else(phrase, line):
    evidence = Evidence(
        frozenset({0}),
        {index: [(1.0, 2.0)] for index in range(3)},
        frozenset({("m", "t"), ("m", "u")}),
        {("m", "a"): 1, ("m", "c"): 1},
    )
    found = {each.subject: each for each in Structure(Numbers(STRUCTURE), evidence, ()).changes()}
    text = found[phrase].apply(STRUCTURE)
    assert f"{line}\n" in text
    assert len({*text.splitlines()} - {*STRUCTURE.splitlines()}) <= 1


class Between:
    """A judge: a program passes if the number in it is in a range."""

    runs = 3

    def __init__(self, low, high):
        self._low, self._high = low, high

    def outcomes(self, trials):
        for index, trial in enumerate(trials):
            number = float(re.search(r":= \[(.*?)\]", trial.text)[1])
            yield index, self._low <= number <= self._high

    def witness(self, numbers, run):
        return Evidence()

    def group(self, run):
        return run


@pytest.mark.parametrize(
    ("now", "low", "high"),
    [
        (1280, 20, 235),
        (0.02, 0.08, 0.3),
        (-0.2, 0.1, 0.4),
        (1000, 2500, 3500),
        (0.5, 0.9, 1.2),
        (4, 0.3, 0.5),
    ],
)
def test_the_proposed_number_is_round_and_well_inside_the_range_that_passes(now, low, high):
    found = Search(f"(var v := [{now}])", Between(low, high)).run().repairs
    value = float(found[0].changes[0].text)
    assert low + 0.1 * (high - low) <= value <= high - 0.1 * (high - low)
    assert len(f"{value:g}".strip("0.")) <= 2
