"""``lrp lab`` copies the notebooks once, and opens JupyterLab on them."""

from pathlib import Path

import pytest
from hatchling.builders.wheel import WheelBuilder

from lrp_jupyter.cli.lab_command import (
    FIRST,
    copy_notebooks,
    fold_side_bar,
    shipped_notebooks,
    sign_notebooks,
    use_settings,
)


def test_the_notebooks_are_copied_once(tmp_path):
    copied = copy_notebooks(tmp_path)
    assert tmp_path / FIRST in copied
    (tmp_path / FIRST).write_text("mine")
    (tmp_path / "reference" / "language.ipynb").unlink()
    assert copy_notebooks(tmp_path) == [tmp_path / "reference" / "language.ipynb"]
    assert (tmp_path / FIRST).read_text() == "mine"


def test_the_sources_of_the_documentation_are_not_copied(tmp_path):
    copied = [path.name for path in copy_notebooks(tmp_path) if path.parent == tmp_path]
    assert FIRST in copied
    assert {Path(name).suffix for name in copied} == {".ipynb"}


def test_the_example_bridges_are_copied_with_what_they_need(tmp_path):
    copied = {path.name for path in copy_notebooks(tmp_path) if path.parent == tmp_path / "bridges"}
    assert {"mqtt.py", "pybricks.py", "pybricks_hub.py", "serial_line.py", "thymio.py", "webots.py"} == copied


def test_every_notebook_is_shipped():
    assert len(list(shipped_notebooks().rglob("*.ipynb"))) >= 20


def test_no_solution_is_copied(tmp_path):
    assert (shipped_notebooks() / "teachers" / "unplugged.md").is_file()
    copied = copy_notebooks(tmp_path)
    assert not [file for file in copied if "teachers" in file.parts]


def test_what_students_install_holds_no_answers():
    wheel = WheelBuilder(str(Path(__file__).parents[2])).recurse_included_files()
    installed = {file.distribution_path for file in wheel}
    assert f"lrp_jupyter/notebooks/{FIRST}" in installed
    teachers = {name for name in installed if "teachers" in name or name.startswith("tests")}
    assert teachers == {"lrp_jupyter/notebooks/teachers/unplugged.md"}  # `lrp sheets` prints it


@pytest.fixture
def private(tmp_path, monkeypatch):
    """Jupyter's directories in a folder of their own."""
    for name in ("CONFIG", "DATA", "RUNTIME"):
        monkeypatch.setenv(f"JUPYTER_{name}_DIR", str(tmp_path / name))
    monkeypatch.delenv("JUPYTER_CONFIG_PATH", raising=False)
    monkeypatch.setenv("JUPYTERLAB_WORKSPACES_DIR", str(tmp_path / "WORKSPACES"))
    return tmp_path


def test_a_copied_notebook_is_trusted_until_it_is_changed_elsewhere(private):
    nbformat = pytest.importorskip("nbformat")
    from nbformat.sign import NotebookNotary

    copy_notebooks(private / "work")
    sign_notebooks()
    notebook = nbformat.read(private / "work" / FIRST, as_version=4)
    assert NotebookNotary().check_signature(notebook)
    notebook.cells[0].source = "other"
    assert not NotebookNotary().check_signature(notebook)


def test_the_side_bar_is_folded_once_and_then_stays_as_the_user_left_it(private):
    pytest.importorskip("jupyterlab")
    folder = private / "WORKSPACES"
    fold_side_bar()
    (file,) = folder.iterdir()
    assert '"collapsed": true' in file.read_text()
    left = file.read_text().replace("true", "false")
    file.write_text(left)
    fold_side_bar()
    assert file.read_text() == left


def test_a_workspace_that_cannot_be_read_or_written_stays_as_it_is(private, monkeypatch):
    pytest.importorskip("jupyterlab")
    fold_side_bar()
    (file,) = (private / "WORKSPACES").iterdir()
    file.write_text("{")
    fold_side_bar()
    assert file.read_text() == "{"
    monkeypatch.setenv("JUPYTERLAB_WORKSPACES_DIR", str(file / "inside"))
    fold_side_bar()
    assert file.read_text() == "{"


def test_the_users_own_defaults_precede_those_of_the_package(private, monkeypatch):
    pytest.importorskip("jupyterlab_server")
    from jupyter_server.services.config.manager import ConfigManager

    news = "@jupyterlab/apputils-extension:notification"
    section = "default_setting_overrides"
    monkeypatch.setenv("JUPYTER_CONFIG_PATH", str(private / "own"))
    use_settings()
    assert ConfigManager(config_dir_name="labconfig").get(section)[news] == {"fetchNews": "false"}
    (private / "own" / "labconfig").mkdir(parents=True)
    (private / "own" / "labconfig" / f"{section}.json").write_text(f'{{"{news}": {{"fetchNews": "true"}}}}')
    assert ConfigManager(config_dir_name="labconfig").get(section)[news] == {"fetchNews": "true"}
