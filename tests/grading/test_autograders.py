"""nbgrader and Otter give the points of `grade`: the real packages, which have an environment of their own.

The cells are those of ``notebooks/teachers/autograders.md``.
"""

import json
import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest
from e2e.programs import SQUARE

from lrp_jupyter import grade

if find_spec("nbgrader") is None or find_spec("otter") is None:
    pytest.skip("nbgrader and Otter have an environment of their own", allow_module_level=True)
nbformat = pytest.importorskip("nbformat")  # slow: only where it is used

pytestmark = [
    pytest.mark.slow,  # each starts kernels
    pytest.mark.filterwarnings("ignore:Object of type <.*> not in session"),  # nbgrader
]

HALF = SQUARE.replace("corners == 4", "corners == 2")  # stops at the second corner
PAGE = Path(__file__).parents[2] / "notebooks/teachers/autograders.md"


def code(name, language="python"):
    """Return the code of the page for teachers that follows the word `name` in its first line."""
    blocks = PAGE.read_text("utf-8").split("```")[1::2]
    found = [block.partition("\n")[2] for block in blocks if block.startswith(f"{language} {name}\n")]
    assert len(found) == 1, f"{PAGE.name} has {len(found)} blocks `{name}`"
    return found[0].rstrip("\n")


def test_the_programs_differ_in_their_points():
    assert grade(SQUARE, "square").points == 10
    assert 0 < grade(HALF, "square").points < 10


def notebook(*cells):
    """Return a notebook of cells: each a text, or a text and its part in nbgrader."""
    made = nbformat.v4.new_notebook(
        metadata={"kernelspec": {"name": "python3", "language": "python", "display_name": "Python 3"}}
    )
    for cell in cells:
        source, part = cell if isinstance(cell, tuple) else (cell, None)
        made.cells.append(nbformat.v4.new_code_cell(source, metadata={"nbgrader": part} if part else {}))
    return made


def saved_with(text):
    """Return the output of a lab as Jupyter saves it."""
    about = {"lrp_jupyter": {"program": "square", "challenge": "square", "widget": "a name"}}
    data = {"image/svg+xml": "<svg/>", "text/plain": text}
    return nbformat.v4.new_output("execute_result", data, metadata=about, execution_count=1)


def part(name, **roles):
    """Return nbgrader's metadata of a cell."""
    roles = {"grade": False, "solution": False, "locked": False, "task": False} | roles
    return {"schema_version": 3, "grade_id": name, **roles}


@pytest.fixture(autouse=True, scope="module")
def _commands():
    """Let nbgrader find the commands of this environment."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PATH", f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
        yield


@pytest.fixture(scope="module")
def course(tmp_path_factory):
    """A course of nbgrader with a released notebook, with a test of each kind: its API, its folder."""
    from nbgrader.apps import NbGraderAPI
    from traitlets.config import Config

    folder = tmp_path_factory.mktemp("course")
    config = Config()
    exec(code("config"), {"get_config": lambda: config})
    config.CourseDirectory.root = str(folder)
    source = folder / "source/lesson/square.ipynb"
    source.parent.mkdir(parents=True)
    answer = code("answer", "lrp").replace("(machine m (state side))\n", SQUARE)
    cells = [
        (code("setup"), part("setup", locked=True)),
        (answer, part("answer", solution=True)),
        *((code(kind), part(kind, grade=True, locked=True, points=10)) for kind in ("partial", "whole")),
    ]
    nbformat.write(notebook(*cells), source)
    api = NbGraderAPI(config=config)
    done = api.generate_assignment("lesson")
    assert done["success"], done["log"]
    yield api, folder
    api.gradebook.close()


def test_the_released_notebook_of_nbgrader_has_a_place_for_the_program_instead_of_the_solution(course):
    released = nbformat.read(course[1] / "release/lesson/square.ipynb", as_version=4)
    lines = released.cells[1].source.splitlines()
    assert lines[0] == "%%lrp square --challenge square"
    assert lines[2:] == ["; YOUR PROGRAM HERE"]


@pytest.mark.parametrize(
    ("student", "text"), [("ada", SQUARE), ("bob", HALF), ("carl", "(machine m"), ("dora", "; nothing")]
)
def test_nbgrader_gives_the_points_of_grade(course, student, text):
    api, folder = course
    handed_in = nbformat.read(folder / "release/lesson/square.ipynb", as_version=4)
    handed_in.cells[1].source = f"%%lrp square --challenge square\n{text}"
    handed_in.cells[1].outputs = [saved_with(text)]
    place = folder / f"submitted/{student}/lesson/square.ipynb"
    place.parent.mkdir(parents=True)
    nbformat.write(handed_in, place)
    done = api.autograde("lesson", student)
    assert done["success"], done["log"]

    expected = grade(text, "square")
    with api.gradebook as gradebook:
        (graded,) = gradebook.find_submission("lesson", student).notebooks
        scores = {each.name: each.score for each in graded.grades}
    assert scores == {"partial": expected.points, "whole": 10 * expected.passed}
    cells = nbformat.read(folder / f"autograded/{student}/lesson/square.ipynb", as_version=4).cells
    assert f"{expected.points:g} of 10 points" in json.dumps(cells[2].outputs)
    assert not any(output.get("name") == "stderr" for output in cells[2].outputs)


def otter(*arguments):
    """Run a command of Otter in a process of its own."""
    done = subprocess.run([sys.executable, "-m", "otter", *arguments], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_otter_gives_the_points_of_the_test_cases_that_pass(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("tests").mkdir()
    Path("tests/square.py").write_text(code("otter"))
    otter("generate", "--no-environment")
    expected = {"ada": (SQUARE, 10), "bob": (HALF, 2)}
    for student, (text, points) in expected.items():
        cells = [code("setup"), f"%%lrp square --challenge square\n{text}", code("check")]
        nbformat.write(notebook(*cells), f"{student}.ipynb")
        otter("run", f"{student}.ipynb")
        tests = json.loads(Path("results.json").read_text())["tests"]
        assert [(each["score"], each["max_score"]) for each in tests if "score" in each] == [(points, 10)]
