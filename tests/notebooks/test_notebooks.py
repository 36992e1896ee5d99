"""The notebooks run from top to bottom, and what they claim is true."""

from __future__ import annotations

import ast
import re
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import pytest
from prose import bold, links, minutes, named_in_the_lab, prose, solution
from stored import NOTEBOOKS, WIDGET, Node, data_of, opened_program, paths, read, sources, texts_of
from support.tables import every

from lrp_jupyter.language.checks import CODES, check
from lrp_jupyter.language.deviations import DEVIATIONS
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Program, Spawn, State
from lrp_jupyter.language.reading.forms import USAGE
from lrp_jupyter.live.recording import RunStart
from lrp_jupyter.live.stored.input_lines import INPUTS
from lrp_jupyter.programs import names as bundled
from lrp_jupyter.widgets.magics import WORDS

ALL = paths()
LESSONS = [path for path in ALL if path.parent == NOTEBOOKS]
TEACHERS = NOTEBOOKS / "teachers"
REFERENCE = NOTEBOOKS / "reference" / "language.ipynb"
PATTERNS = NOTEBOOKS / "reference" / "patterns.ipynb"
SERIES = [
    path
    for path in ALL
    if path.parent.name == "exercises" and all(map(opened_program, sources(read(path), "code")[1:]))
]
"""Notebooks that only load the extension and open programs."""
EXECUTED = [path for path in ALL if path not in SERIES[1:]]
all_notebooks = every("path", ALL)
all_lessons = every("path", LESSONS)


class Run(NamedTuple):
    """A notebook as it is stored, the same after Restart & Run All, and what the solution it hides gave."""

    stored: Node
    fresh: Any
    solved: str


@pytest.fixture(scope="module", params=EXECUTED, ids=lambda path: path.stem)
def run(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Run:
    import nbformat  # slow: only here
    from execution import Execution

    stored, fresh = read(request.param), nbformat.read(request.param, as_version=4)
    execution = Execution(fresh, tmp_path_factory.mktemp(request.param.stem))
    with execution.setup_kernel():
        execution.run_all()
        check = _solving(stored)
        solved = texts_of(execution.run_more(check)) if check else ""
    return Run(stored, fresh, solved)


def _solving(notebook: Node) -> str:
    """A cell that grades the hidden solution with the words of the challenge."""
    hidden = solution(notebook)
    if hidden is None:
        return ""
    language, text = hidden
    first = text if language == "python" else f'mine = """{text}"""'
    question = [line for source in sources(notebook, "code") for line in source.splitlines()][-1]
    assert re.fullmatch(r"print\((grade|check_bridge)\(.*\)\)", question), "a challenge ends in its question"
    return f"{first}\n{question}"


# -- they run ------------------------------------------------------------------------------------


@pytest.mark.slow
def test_every_stored_text_is_what_comes_out(run: Run):
    for stored, fresh in zip(run.stored.cells, run.fresh.cells, strict=True):
        again = "python tests/notebooks/execution.py stores it again"
        assert texts_of(stored) == texts_of(fresh), f"{stored.id}: {again}"
        assert data_of(stored, "text/markdown") == data_of(fresh, "text/markdown"), f"{stored.id}: {again}"


@pytest.mark.slow
def test_the_hidden_solution_solves_the_challenge(run: Run):
    if run.solved:
        assert re.search(r": passed|\d+ checks passed(?!.* failed)", run.solved), run.solved


@pytest.mark.slow
def test_nothing_is_written_to_the_error_stream(run: Run):
    for cell in run.fresh.cells:
        for output in cell.get("outputs", ()):
            assert output.get("name") != "stderr", output.text


# -- they are stored well ------------------------------------------------------------------------


@all_notebooks
def test_it_reads_well_without_a_kernel(path: Path):
    notebook = read(path)
    pictures = 0
    for cell in notebook.cells:
        for output in cell.get("outputs", ()):
            assert output.output_type != "error"
            assert WIDGET not in output.get("data", {}), "a page without a kernel would say: no model"
        pictures += len(data_of(cell, "image/svg+xml"))
        if cell.cell_type == "code" and opened_program(cell.source):
            assert data_of(cell, "image/svg+xml"), "a lab leaves its picture"
    assert pictures >= 1
    assert "widgets" not in notebook.metadata


@every("path", SERIES)
def test_a_notebook_that_only_opens_programs_stores_each_as_it_comes_out(path: Path):
    first, *others = (cell for cell in read(path).cells if cell.cell_type == "code")
    assert first.source == "%load_ext lrp_jupyter"
    for cell in others:
        (shown,) = data_of(cell, "text/plain")
        assert shown.rstrip() == cell.source.partition("\n")[2].rstrip()


@all_notebooks
def test_its_cells_have_names_of_their_own(path: Path):
    notebook = read(path)
    names = [cell.id for cell in notebook.cells]
    assert len(set(names)) == len(names)
    for name in names:
        assert re.fullmatch(r"[a-z]+-\d\d", name)


@pytest.mark.slow
@all_notebooks
def test_it_is_a_valid_notebook(path: Path):
    import nbformat

    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    assert read(path) == notebook, "as the other tests read it"


@all_notebooks
def test_it_is_small(path: Path):
    assert path.stat().st_size < 400_000


# -- what they name, there is --------------------------------------------------------------------


@all_notebooks
def test_every_button_named_in_the_prose_exists(path: Path):
    named = bold(prose(read(path)))
    assert named
    assert not set(named) - named_in_the_lab()


def test_the_names_in_the_lab_are_found():
    assert {"Run", "Pause", "Reset world", "Hold edits", "Issues", "Rate"} <= named_in_the_lab()
    assert bold("press **Run**, not **Fly**; `**kwargs` **") == ["Run", "Fly"]


@all_notebooks
def test_every_word_after_the_magic_exists(path: Path):
    notebook = read(path)
    code, text = sources(notebook, "code"), prose(notebook)
    opened = {opened_program(source) for source in code}
    for line in re.findall(r"(?<!%)%lrp +([\w -]+)", "\n".join([*code, text])):
        word, *rest = line.split()
        assert word in WORDS or word in opened, f"%lrp {line}"
        assert word != "new" or rest[0] in bundled()
        assert (
            word in ("new", "rate", "bridge", "version", "why", "explain") or not rest or rest[0] in opened
        ), f"%lrp {line}"


@all_notebooks
def test_every_link_leads_somewhere(path: Path):
    notebook = read(path)
    headings = {
        re.sub(r"\s+", "-", heading.strip())
        for source in sources(notebook, "markdown")
        for heading in re.findall(r"^#+ (.*)$", source, re.MULTILINE)
    }
    for link in links(prose(notebook)):
        file, _, anchor = link.partition("#")
        assert not file or (path.parent / file).is_file(), link
        assert file or anchor in headings, link


# -- lessons -------------------------------------------------------------------------------------

_PARTS = ["Questions", "Afterwards you can", "Predict", "Run", "Investigate", "Modify", "Make", "Key points"]
_NEW = re.compile(r"\*About (\d+) minutes(?:, and \w+ more for [^.]+)?\. New: (.+?)\.( .*?)?\*")
_PLAN = {"Goal", "Hard, and what to say", "Discussion", "Check and marks"}


def _headings(text: str, level: int = 2) -> list[str]:
    return re.findall(rf"^{'#' * level} (.*)$", text, re.MULTILINE)


def _title(path: Path) -> str:
    """The title of a lesson, without its number."""
    return _headings(prose(read(path)), 1)[0].partition(" · ")[2]


@all_lessons
def test_a_lesson_has_all_its_parts(path: Path):
    notebook = read(path)
    text, whole = prose(notebook), "\n".join(sources(notebook, "markdown"))
    assert _headings(text) == _PARTS
    assert text.count("redict") >= 2
    assert text.count("<details>") == text.count("</details>") >= 1
    assert re.search(r"^\| (type|type, or press|do|press) \| and see \|$|^```lrp$", whole, re.MULTILINE)
    number = int(path.stem[:2])
    assert _headings(text, 1)[0].startswith(f"{number} · ")


def test_the_lessons_are_numbered_and_lead_to_each_other():
    assert [int(path.stem[:2]) for path in LESSONS] == list(range(17))
    for path, following in pairwise(LESSONS):
        number = int(following.stem[:2])
        assert f"Next: [{number} · {_title(following)}]({following.name})" in prose(read(path))


@all_lessons
def test_a_lesson_has_two_new_ideas_and_takes_as_long_as_it_says(path: Path):
    notebook = read(path)
    found = _NEW.search(prose(notebook))
    assert found is not None
    promised, new = int(found[1]), found[2].split("; ")
    assert len(new) == (1 if path.stem.startswith("07") else 2)
    assert promised in (20, 25), "as the README and the list of lessons say"
    assert promised - 7 < minutes(notebook) < promised + 1, f"it takes {minutes(notebook):.1f} minutes"


def test_the_table_for_teachers_names_what_the_lessons_say_is_new():
    table = (TEACHERS / "index.md").read_text(encoding="utf-8")
    for path in LESSONS:
        found = _NEW.search(prose(read(path)))
        assert found is not None
        new = found[2].partition(". ")[0]
        assert f"| [{path.stem[:2]} {_title(path)}](../{path.name}) | {new} |" in table


def test_every_lesson_has_a_plan():
    text = (TEACHERS / "lesson-plans.md").read_text(encoding="utf-8")
    plans = dict(re.findall(r"^## (.*)\n((?:(?!## ).*\n)*)", text, re.MULTILINE))
    for path in LESSONS:
        plan = plans[f"{path.stem[:2]} · {_title(path)}"]
        assert set(_headings(plan, 3)) == _PLAN
        times = re.findall(r"^\| (\d+)–(\d+) \|", plan, re.MULTILINE)
        assert [first for first, _ in times] == ["0", *(last for _, last in times[:-1])]
        assert times[-1][1] == "45"


@every("path", sorted(TEACHERS.glob("*.md")))
def test_what_teachers_read_names_what_there_is(path: Path):
    text = re.sub(r"^```.*?^```", "", path.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)
    assert not set(bold(text)) - named_in_the_lab()
    for link in links(text):
        assert (TEACHERS / link.partition("#")[0]).exists(), link


@every("path", sorted((NOTEBOOKS / "projects").glob("*.ipynb")))
def test_a_project_tells_its_students_by_which_rows_it_is_judged(path: Path):
    rubrics = (TEACHERS / "rubrics.md").read_text(encoding="utf-8")
    name = _headings(prose(read(path)), 1)[0].removeprefix("Project: ").removeprefix("the ")
    for_teachers = re.search(rf"^### {name}\n((?:(?!#).*\n)*)", rubrics, re.MULTILINE | re.IGNORECASE)
    for_students = prose(read(path)).partition("## Rubric\n")[2]
    assert for_teachers is not None
    first, second = (
        re.findall(r"^\| ([a-z][^|]*) \|", text, re.M) for text in (for_students, for_teachers[1])
    )
    assert first == second
    assert len(first) == 4


# -- the reference -------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def reference() -> Node:
    return read(REFERENCE)


def _programs(notebook: Node) -> list[str]:
    """The programs that the Python of a notebook holds."""
    return [
        node.value
        for source in sources(notebook, "code")
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and "(machine" in node.value
    ]


@pytest.fixture(scope="module")
def examples(reference: Node) -> list[Program]:
    """The programs of the reference that run."""
    found = []
    for text in _programs(reference):
        try:
            found.append(parse(text))
        except Exception:  # an example of a mistake
            continue
    assert len(found) > 15
    return found


def _tables(reference: Node) -> str:
    return "\n".join(table for cell in reference.cells for table in data_of(cell, "text/markdown"))


def test_the_reference_lists_every_departure(reference: Node):
    tables = _tables(reference)
    for deviation in DEVIATIONS:
        row = " | ".join(each.replace("|", r"\|") for each in deviation)
        assert f"| {row} |" in tables


def test_the_reference_lists_every_code(reference: Node):
    tables = _tables(reference)
    for code in CODES.values():
        assert f"| {code.code} | {code.severity} |" in tables


def test_the_reference_lists_every_line_of_a_recording(reference: Node):
    text = prose(reference)
    names = (*INPUTS, "beyond", *RunStart.__dataclass_fields__)
    assert not {name for name in names if f"`{name}`" not in text}


def test_the_reference_has_a_heading_for_every_form(reference: Node):
    headings = re.findall(r"^### (.*)$", "\n".join(sources(reference, "markdown")), re.MULTILINE)
    shown = set(re.findall(r"`\((\w+)", "\n".join(headings)))
    assert shown == set(USAGE)


def test_every_form_of_the_reference_has_a_program_and_its_picture(reference: Node):
    waiting = ""
    for cell in reference.cells:
        found = re.findall(r"^### (.*)$", cell.source, re.MULTILINE) if cell.cell_type == "markdown" else []
        if found:
            assert not waiting, f"{waiting} has no example"
            waiting = found[-1]
        elif cell.cell_type == "code" and "= run(" in cell.source:
            assert data_of(cell, "image/svg+xml"), cell.id
            waiting = ""
    assert not waiting


def test_the_examples_of_the_reference_use_the_whole_grammar(examples: list[Program]):
    machines = [machine for program in examples for _, machine in program.walk()]
    states: list[State] = [state for machine in machines for state in machine.states]
    transitions = [transition for machine in machines for transition in machine.transitions]
    assert {transition.kind for transition in transitions} == {"on", "ontime", "eps", "exit"}
    assert any(each.name for each in transitions)
    sources_used = {re.sub(r"\w+( \w+)*", "a", each.source_text) for each in transitions}
    assert sources_used >= {"a", "*", "*-{a}", "{a}"}
    assert {type(each.trigger.amount).__name__ for each in transitions if each.kind == "ontime"} >= {
        "int",
        "Name",
        "Block",
    }
    assert {type(each.trigger).__name__ for each in transitions if each.kind == "on"} >= {
        "Occurrence",
        "Condition",
        "InState",
    }
    assert any(each.hold for each in transitions)
    assert any(each.effect for each in transitions)
    spawned = [item for state in states for item in state.onentry if isinstance(item, Spawn)]
    assert any(spawn.settings for spawn in spawned)
    assert any(machine.variables for machine in machines)
    assert any(machine.events for machine in machines)
    assert any(program.variables for program in examples)
    assert any(program.events for program in examples)
    assert any(len(program.spawns) > 1 for program in examples)
    assert all(any(program.hooks[kind] for program in examples) for kind in Program().hooks)
    assert all(any(getattr(state, part) for state in states) for part in ("onentry", "running", "onexit"))
    assert any(state.machines for state in states)


# -- patterns ------------------------------------------------------------------------------------


def test_every_pattern_says_when_what_to_try_its_limit_and_which_program_has_it():
    text = prose(read(PATTERNS))
    rows = re.findall(r"^\| \[([^]]+)\]\(#.*\| (.+) \|$", text, re.MULTILINE)
    assert len(rows) == 7
    for name, programs in rows:
        section = text.partition(f"\n## {name}\n")[2].partition("\n## ")[0]
        parts = re.findall(r"^\*(\w+)\.\* (.*)", section, re.MULTILINE)
        assert [part for part, _ in parts] == ["When", "Try", "Limit", "Bundled"], name
        assert set(re.findall(r"`([\w-]+)`", programs)) <= set(bundled())
        assert re.findall(r"`([\w-]+)`", parts[-1][1])[0] in programs


@every("text", _programs(read(PATTERNS)))
def test_a_program_of_the_patterns_has_no_findings(text: str):
    assert check(text) == ()
