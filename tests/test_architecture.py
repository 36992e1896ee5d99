"""What holds the package together: which module may import which, and one meaning for every class name."""

import ast
import subprocess
import sys
from collections import Counter
from pathlib import Path

import lrp_jupyter

PROJECT = Path(__file__).parents[1]
PACKAGE = Path(lrp_jupyter.__file__).parent


def test_every_import_points_down_and_none_goes_in_a_circle():
    command = [Path(sys.executable).with_name("lint-imports"), "--no-cache", "--no-logo"]
    done = subprocess.run(command, cwd=PROJECT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_a_class_name_has_one_meaning():
    homes = Counter(
        node.name
        for path in PACKAGE.rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.ClassDef)
    )
    assert [name for name, count in homes.items() if count > 1] == []


def test_two_modules_write_the_files_of_a_user_whole_ones_and_lines():
    writing = {
        path.relative_to(PACKAGE).as_posix()
        for path in PACKAGE.rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if (
            isinstance(node, ast.Call)
            and ast.unparse(node.func).rpartition(".")[2] in ("write_text", "write_bytes", "fdopen")
        )
        or (isinstance(node, ast.Call) and ast.unparse(node.func) in ("open", "os.open"))
    }
    writing = {name for name in writing if not name.startswith("site/")}  # which fills a new folder
    pipes = {"bridges/guard_process.py", "cli/run.py", "grading/worker.py"}
    assert writing == {"files.py", "logs.py"} | pipes


def test_a_session_without_a_simulated_robot_does_not_import_the_physics():
    program = (
        "import sys; from lrp_jupyter import Session; Session().run(1); sys.exit('pymunk' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0


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
