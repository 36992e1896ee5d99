"""What ``lrp site`` says before it builds anything; ``tests/e2e/test_site.py`` opens what it builds."""

import json

import pytest
from typer.testing import CliRunner

from lrp_jupyter.cli import app
from lrp_jupyter.cli.lab_command import shipped_notebooks
from lrp_jupyter.site.notebooks import copy_for_students, for_the_browser
from lrp_jupyter.site.runtime import LOCK, Pyodide


@pytest.fixture
def lrp_site(tmp_path):
    """Run the command; return what it prints."""

    def lrp_site(folder, *options):
        result = CliRunner().invoke(app, ["site", str(folder), *map(str, options)], prog_name="lrp")
        assert result.exit_code == 2
        return " ".join(result.output.split())

    return lrp_site


@pytest.fixture
def unpublished(monkeypatch):
    """Pyodide is published where nothing answers."""
    monkeypatch.setattr(Pyodide, "url", "http://127.0.0.1:9/")


def test_a_folder_with_other_files_is_not_replaced(lrp_site, tmp_path):
    file = tmp_path / "mine/thesis.txt"
    file.parent.mkdir()
    file.write_text("mine")
    said = lrp_site(file.parent)
    assert "contains other files, which would be lost. Choose a new folder." in said
    assert file.read_text() == "mine"


def test_a_file_of_pyodide_that_is_nowhere_is_named(lrp_site, tmp_path, unpublished):
    empty = tmp_path / "pyodide"
    empty.mkdir()
    said = lrp_site(tmp_path / "site", "--offline", "--pyodide", empty)
    assert f"`{LOCK}` of Pyodide" in said
    assert "Pass a folder that contains it with `--pyodide`." in said
    assert [each.name for each in tmp_path.iterdir()] == ["pyodide"]


def test_a_file_of_pyodide_comes_from_the_folder_without_the_network(tmp_path, unpublished):
    (tmp_path / LOCK).write_text("{}")
    assert Pyodide(tmp_path).read(LOCK) == b"{}"


def test_a_notebook_asks_for_the_python_of_the_browser():
    notebook = {
        "cells": [{"source": "1 + 1"}],
        "metadata": {"kernelspec": {"name": "python3", "display_name": "Python 3 (ipykernel)"}, "a": "b"},
    }
    changed = json.loads(for_the_browser(json.dumps(notebook)))
    assert changed["metadata"]["kernelspec"]["name"] == "python"
    assert changed["metadata"]["a"] == "b"
    assert changed["cells"] == notebook["cells"]


def test_a_site_for_students_has_all_lessons_and_no_solutions(tmp_path):
    copy_for_students(shipped_notebooks(), tmp_path / "files")
    names = {each.name for each in (tmp_path / "files").rglob("*")}
    assert {each.name for each in shipped_notebooks().rglob("*.ipynb")} <= names
    assert not {"teachers", "solutions", "square.lrp"} & names
