"""What holds the package together: which module may import which, and one meaning for every class name."""

import ast
import re
import subprocess
import sys
from collections import Counter
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

import pytest

import lrp_jupyter

pytestmark = pytest.mark.slow  # they read every module

PROJECT = Path(__file__).parents[1]
PACKAGE = Path(lrp_jupyter.__file__).parent
AS_PYTHON = {"AttributeError", "IndentationError", "SyntaxError"}  # worded as Python words them
BEGINNINGS = ("`", "'", '"', "{", "-", "%", "lrp: ")


class Package(NamedTuple):
    """What its modules define, call and raise."""

    classes: list[str]
    writing: set[str]
    messages: list[tuple[str, int, str]]


@pytest.fixture(scope="module")
def package() -> Package:
    found = Package([], set(), [])
    for path in sorted(PACKAGE.rglob("*.py")):
        name = path.relative_to(PACKAGE).as_posix()
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ClassDef):
                found.classes.append(node.name)
            elif isinstance(node, ast.expr) and writes(node):
                found.writing.add(name)
            elif isinstance(node, ast.Raise) and (text := message(node)):
                found.messages.append((name, node.lineno, text))
    return found


def writes(function: ast.expr) -> bool:
    """Whether an expression is a function that writes a file, called here or later."""
    if isinstance(function, ast.Name):
        return isinstance(function.ctx, ast.Load) and function.id in ("open", "write_text", "fdopen")
    return isinstance(function, ast.Attribute) and (
        function.attr in ("write_text", "write_bytes", "fdopen") or ast.unparse(function) == "os.open"
    )


def message(node: ast.Raise) -> str:
    """The text with which a module raises, with ``{}`` for what is inserted."""
    if not isinstance(node.exc, ast.Call) or not node.exc.args:
        return ""
    by = node.exc.func
    return "" if isinstance(by, ast.Name) and by.id in AS_PYTHON else literal(node.exc.args[-1])


def literal(node: ast.expr) -> str:
    if isinstance(node, ast.Constant):
        return node.value if isinstance(node.value, str) else ""
    if isinstance(node, ast.JoinedStr):
        return "".join(literal(part) if isinstance(part, ast.Constant) else "{}" for part in node.values)
    return ""


def is_sentence(text: str) -> bool:
    text = text.lstrip()  # a second sentence
    begins = text[0].isupper() or text.startswith(BEGINNINGS)
    return begins and text.rstrip("`").endswith((".", "?", ":", "…", "{}"))


def test_every_import_points_down_and_none_goes_in_a_circle():
    command = [Path(sys.executable).with_name("lint-imports"), "--no-cache", "--no-logo"]
    done = subprocess.run(command, cwd=PROJECT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_a_class_name_has_one_meaning(package: Package):
    assert [name for name, count in Counter(package.classes).items() if count > 1] == []


def test_a_module_name_has_one_meaning():
    """Robots are packages of a kind: each has a bridge, a link, a protocol."""
    robots = PACKAGE / "bridges"
    files = [file for file in PACKAGE.rglob("*.py") if file.parents[1] != robots]
    names = [file.parent.name if file.stem == "__init__" else file.stem for file in files]
    twice = {name for name, count in Counter(names).items() if count > 1}
    assert twice == {"interpreter", "sim"}  # the module of the package's name, and the bridge to it


def test_what_texts_and_documents_import_is_there():
    """Scripts in strings and examples in pages are run seldom, and are not seen by other tools."""
    places = ("lrp_jupyter", "tests", "notebooks", ".binder", ".github", "README.md")
    files = [file for place in places for file in (PROJECT / place, *(PROJECT / place).rglob("*"))]
    texts = [
        file.read_text(encoding="utf-8")
        for file in files
        if file.suffix in (".py", ".md", ".ipynb", ".lrp", ".yml") or file.name == "Dockerfile"
    ]
    found = {
        (module, name.split(" as ")[0].strip())
        for text in texts
        for module, names in re.findall(r"from (lrp_jupyter(?:\.\w+)*) import (\w[\w, ]*)", text)
        for name in names.split(",")
        if name.strip()
    }
    assert len(found) > 500
    assert [each for each in sorted(found) if not is_there(*each)] == []


def is_there(module: str, name: str) -> bool:
    try:
        return hasattr(import_module(module), name) or bool(find_spec(f"{module}.{name}"))
    except ModuleNotFoundError:
        return False


def test_two_modules_write_the_files_of_a_user_whole_ones_and_lines(package: Package):
    writing = {name for name in package.writing if not name.startswith("site/")}  # which fills a new folder
    pipes = {"bridges/guard_process.py", "cli/run_command.py", "grading/worker.py"}
    assert writing == {"files.py", "logs.py"} | pipes


def test_messages_that_are_raised_are_sentences(package: Package):
    assert len(package.messages) > 200
    assert [each for each in package.messages if not is_sentence(each[2])] == []


def test_a_fragment_is_not_a_sentence():
    fragments = ("there is no state `a`.", "There is no state `a`", "cannot go back")
    assert not any(map(is_sentence, fragments))


def test_no_text_of_the_language_names_a_module_above_it():
    naming = {
        path.name
        for path in (PACKAGE / "language").rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Constant)
        and str(node.value).startswith("lrp_jupyter.")
        and node.value != "lrp_jupyter.language"
    }
    assert naming == set()


def test_a_program_shows_its_picture_which_is_imported_only_then():
    program = (
        "import sys; from lrp_jupyter import parse; program = parse('(machine m (state a))');"
        "assert 'lrp_jupyter.graph.still' not in sys.modules;"
        "sys.exit('image/svg+xml' not in program._repr_mimebundle_())"
    )
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0
