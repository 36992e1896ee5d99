"""An exam: no hints for students, worlds that only the teacher has, and a code of what is handed in."""

import csv
import json
from pathlib import Path

import pytest
from support.tables import every
from typer.testing import CliRunner

from lrp_jupyter.cli import app
from lrp_jupyter.errors import LRPError
from lrp_jupyter.grading import challenges as registry
from lrp_jupyter.grading.challenges import load
from lrp_jupyter.grading.grade import grade
from lrp_jupyter.grading.handing_in import code_of
from lrp_jupyter.sim.world import CircleZone, RobotSpec, World
from lrp_jupyter.sim.worlds import load as load_world

EXAM = """
from lrp_jupyter.grading import Challenge, ends_in, ends_still, register

register(Challenge("exam 1", "Stop in the circle.", "yard.json", [ends_in("goal"), ends_still(1)], seconds=20,
                   hints=[lambda run: "Use the sensor."], exam=True, hidden=["far.json"]))
"""
BY_THE_CLOCK = """\
(machine m
  (state driving (running [robot.move(linear=0.2)]))
  (state stopped)
  (ontime 2500 driving -> stopped))
(spawn m driving)
"""


@pytest.fixture(autouse=True)
def _as_before(monkeypatch):
    """Let no test leave a challenge behind."""
    monkeypatch.setattr(registry, "_challenges", dict(registry._challenges))


@pytest.fixture
def folder(tmp_path):
    """The teacher's folder."""
    for name, x in (("yard", 1.0), ("far", 2.0)):
        world = World(size=(3, 2), robots=(RobotSpec((0.5, 1, 0)),), zones={"goal": CircleZone((x, 1, 0.15))})
        (tmp_path / f"{name}.json").write_text(world.to_json(), encoding="utf-8")
    (tmp_path / "exam-1.py").write_text(EXAM, encoding="utf-8")
    return tmp_path


def test_students_see_the_open_world_only_and_no_hint(folder):
    (folder / "far.json").unlink()
    task = load(folder / "exam-1.py")
    assert grade(BY_THE_CLOCK, task).passed
    wrong = grade(task.beginning, task)
    assert (wrong.passed, wrong.hints) == (False, ())


def test_a_teacher_marks_in_the_hidden_worlds_too(folder):
    task = load(folder / "exam-1.py").whole()
    result = grade(BY_THE_CLOCK, task)
    assert [(each.world, each.passed) for each in result.attempts] == [("yard", True), ("far", False)]
    assert "Use the sensor." in result.hints


def test_a_hidden_world_that_the_teacher_lacks_is_named(folder):
    (folder / "far.json").unlink()
    with pytest.raises(LRPError, match=r"hidden world of `exam 1` is missing\. .*far\.json .*Grade on the"):
        load(folder / "exam-1.py").whole()


def test_marks_show_the_code_that_the_students_wrote_down(folder):
    handed_in = folder / "in"
    handed_in.mkdir()
    (handed_in / "anna.lrp").write_text(BY_THE_CLOCK, encoding="utf-8")
    cells = [
        {"cell_type": "code", "source": f"%%lrp {head}\n{text}", "outputs": []}
        for head, text in (
            ("try", "(machine t)"),
            ("e --challenge tasks/exam-1.py", BY_THE_CLOCK.replace("\n", "\n\n")),
        )
    ]
    (handed_in / "ben.ipynb").write_text(json.dumps({"cells": cells}), encoding="utf-8")
    out = folder / "marks.csv"
    options = ["--challenge", str(folder / "exam-1.py"), "--out", str(out)]
    result = CliRunner().invoke(app, ["grade", str(handed_in), *options])
    assert result.exit_code == 0, result.output
    assert result.output.count(code_of(BY_THE_CLOCK)) == 2
    rows = list(csv.DictReader(out.read_text(encoding="utf-8-sig").splitlines()))
    assert [(row["code"], row["runs_passed"], row["runs"]) for row in rows] == [
        (code_of(BY_THE_CLOCK), "1", "2"),
    ] * 2
    alone = CliRunner().invoke(app, ["grade", str(handed_in / "anna.lrp"), *options])
    assert f"Hand-in code: {code_of(BY_THE_CLOCK)}" in alone.output


def test_a_code_is_that_of_the_text_without_its_white_space():
    assert code_of("(machine m)\r\n") == code_of("( machine\tm )") != code_of("(machine n)")
    assert code_of("") == "VW4Q-5YZY"  # what was written down stays valid


@every(("text",), [("é 世界 🤖",), ("\ud800",)])
def test_every_text_has_a_code_that_can_be_read_aloud(text):
    assert len(code_of(text)) == 9
    assert not set(code_of(text)) & set("ILOUilou")


def test_the_exam_of_the_teachers_page_is_one(tmp_path):
    page = (Path(__file__).parents[2] / "notebooks/teachers/exam.md").read_text(encoding="utf-8")
    code = page.partition("```python exam\n")[2].partition("```")[0]
    (tmp_path / "exam-1.py").write_text(code, encoding="utf-8")
    task = load(tmp_path / "exam-1.py")
    assert (task.name, task.exam) == ("exam 1", True)
    assert not grade(task.beginning, task, seeds=1).hints
    for each in task.hidden:
        each.write_text(load_world(task.worlds[0]).to_json(), encoding="utf-8")
    assert len(task.whole().worlds) == len(task.worlds) + 2
