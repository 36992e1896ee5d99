"""A challenge of one's own: a few lines of Python, and a world that was saved from the lab."""

import pytest
from support.tables import every

from lrp_jupyter.errors import LRPError
from lrp_jupyter.grading import challenges as registry
from lrp_jupyter.grading.challenge import Challenge
from lrp_jupyter.grading.challenges import load, register
from lrp_jupyter.grading.criteria import drives, touches, visits
from lrp_jupyter.grading.grade import grade
from lrp_jupyter.sim.world import BoxSolid, CircleZone, RobotSpec, World

DRIVE = "(machine m (state driving (running [robot.move(linear=0.2)]))) (spawn m driving)"
MINE = """
from lrp_jupyter.grading import Challenge, Criterion, register, touches, touches_nothing, visits

hurry = Criterion("hurries", lambda run: (run.seconds < 6, f"{run.seconds:.1f} s"), "always")

def never_came(run):
    return None if any(run.inside("goal")) else f"The robot drove {run.driven:.1f} m. Drive on to the goal."

register(Challenge("to the goal", "Drive to the goal.", "yard.json", [visits("goal"), hurry],
                   seconds=8, hints=[never_came], seeds=3, noise={"motor": 0.01}))
"""


@pytest.fixture(autouse=True)
def _as_before(monkeypatch):
    """Let no test leave a challenge behind."""
    monkeypatch.setattr(registry, "_challenges", dict(registry._challenges))


@pytest.fixture
def folder(tmp_path):
    world = World(
        size=(3, 2),
        robots=(RobotSpec((0.5, 1, 0)),),
        solids=(BoxSolid((2, 1, 0.1, 1), name="wall"),),
        zones={"goal": CircleZone((1.2, 1, 0.1))},
    )
    (tmp_path / "yard.json").write_text(world.to_json(), encoding="utf-8")
    (tmp_path / "mine.py").write_text(MINE, encoding="utf-8")
    return tmp_path


@pytest.mark.slow
def test_a_challenge_in_ten_lines_with_a_world_of_the_lab_is_graded(folder):
    task = load(folder / "mine.py")
    assert [world.name for world in task.worlds] == ["yard"]
    result = grade(DRIVE, task)
    assert result.passed, str(result)
    assert len(result.attempts) == 3
    slow = grade(DRIVE.replace("0.2", "0.05"), task)
    assert (slow.passed, slow.hint) == (False, "The robot drove 0.3 m. Drive on to the goal.")


@pytest.mark.slow
def test_it_is_then_known_by_its_name_and_its_program_begins_with_the_task(folder):
    task = load(str(folder / "mine.py"))
    assert load("To-the-goal") is task
    assert task.beginning.startswith(
        "; Drive to the goal. Time limit: 8 seconds.\n; challenge: to the goal\n"
    )
    assert not grade(task.beginning, task)


def test_the_last_challenge_of_a_file_counts_and_a_changed_file_is_read_again(folder):
    path = folder / "mine.py"
    first = load(path)
    path.write_text(MINE + MINE.replace("to the goal", "again"), encoding="utf-8")
    assert load(path).name == "again"
    assert load("to the goal") is not first


@every(
    ("text", "message"),
    [
        ("", "registers no challenge"),
        ("import nothing_of_that_name", "line 1: ModuleNotFoundError"),
        ("x = 1\ny = (", "line 2: SyntaxError"),
        (MINE.replace('visits("goal")', 'visits("gaol")'), "no zone `gaol`. Did you mean `goal`?"),
        (MINE.replace('visits("goal")', 'touches("wal")'), "no solid `wal`. Did you mean `wall`?"),
        (MINE.replace("run.seconds < 6", "run.sekonds < 6"), "`hurries`: AttributeError"),
        (MINE.replace("yard.json", "yrad.json"), "yrad.json"),
        (MINE.replace('"yard.json"', '"linne"'), "There is no world `linne`. Did you mean `line`?"),
        (MINE.replace('[visits("goal"), hurry]', "[]"), "has no criterion"),
        (
            MINE.replace('visits("goal")', "touches_nothing()"),
            "met before the robot moves, so every program",
        ),
        (MINE.replace("seconds=8", "seconds=0"), "`seconds` must be a number of seconds above 0, not 0"),
    ],
)
def test_a_mistake_in_the_file_is_a_sentence(folder, text, message):
    (folder / "mine.py").write_text(text, encoding="utf-8")
    with pytest.raises(LRPError) as raised:
        load(folder / "mine.py")
    assert message in str(raised.value)


def test_a_file_that_is_not_there_and_a_wrong_name_are_told(tmp_path):
    with pytest.raises(LRPError, match="cannot be read"):
        load(tmp_path / "mine.py")
    with pytest.raises(LRPError, match=r"Did you mean `square`\?.*or a file whose name ends with `\.py`"):
        load("sqare")


def test_a_criterion_that_a_world_cannot_judge_is_refused_before_any_run():
    with pytest.raises(LRPError, match="no zone `goal`"):
        grade(DRIVE, Challenge("mine", "", "empty", visits("goal")))
    with pytest.raises(LRPError, match="`touches the ball`"):
        register(Challenge("mine", "", ("line", "empty"), [drives(1), touches("ball")]))
    with pytest.raises(LRPError, match="has no world"):
        Challenge("mine", "", (), drives(1))
    with pytest.raises(TypeError, match="`criteria` must be"):
        Challenge("mine", "", "empty", ["drives"])


def test_a_registered_challenge_replaces_one_of_its_name():
    mine = register(Challenge("square", "Drive.", "empty", drives(1), 3))
    assert load("square") is mine
    assert registry.challenges()[-1] is mine
