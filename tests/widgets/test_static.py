"""A notebook that is executed without a page stores pictures instead of widgets."""

import nbformat
import pytest
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError

from lrp_jupyter.widgets.hosts import is_static

pytestmark = pytest.mark.slow  # each starts a kernel

TEXT = "(machine m (state one) (state two) (ontime 60000 one -> two)) (spawn m one)"
WIDGET = "application/vnd.jupyter.widget-view+json"
PNG = "iVBORw0KGgo"  # how every PNG begins


@pytest.fixture
def executed(tmp_path, monkeypatch):
    """Execute cells as nbconvert does, in an environment; return the notebook."""

    def execute(*cells, **environment):
        for name in ("LRP_STATIC", "VOILA_PREHEAT", "SERVER_SOFTWARE"):
            monkeypatch.delenv(name, raising=False)
        for name, value in environment.items():
            monkeypatch.setenv(name, value)
        sources = ["%load_ext lrp_jupyter", f"%%lrp m\n{TEXT}", *cells]
        notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(source) for source in sources])
        NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(tmp_path)}}).execute()
        return notebook

    return execute


def data_of(notebook, index=1):
    [output] = notebook.cells[index].outputs
    return output.data


def test_a_lab_and_its_parts_are_pictures_and_no_state_of_widgets_is_stored(executed):
    notebook = executed("import lrp_jupyter; lrp_jupyter.StateGraph('m')", "lrp_jupyter.Lab('m').text")
    for index in (1, 2):
        data = data_of(notebook, index)
        assert set(data) == {"image/svg+xml", "image/png", "text/plain"}
        assert ">one</text>" in data["image/svg+xml"]
        assert data["image/png"].startswith(PNG)
        assert data["text/plain"].strip() == TEXT
    assert data_of(notebook, 3)["text/plain"] == repr(f"{TEXT}\n")
    assert "widgets" not in notebook.metadata
    assert len(nbformat.writes(notebook)) < 200_000


@pytest.mark.parametrize(
    "environment", [{"LRP_STATIC": "0"}, {"VOILA_PREHEAT": "False"}], ids=["wanted", "Voila"]
)
def test_a_lab_is_a_widget_where_one_is_wanted(executed, environment):
    notebook = executed(**environment)
    assert WIDGET in data_of(notebook)
    assert "widgets" in notebook.metadata


def test_a_wrong_value_is_told_with_the_right_ones(executed):
    with pytest.raises(CellExecutionError, match=r"`yes` does not answer that\. Set it to `1` or `0`\."):
        executed(LRP_STATIC="yes")


@pytest.mark.parametrize(("value", "expected"), [(None, False), ("1", True), ("0", False)])
def test_outside_of_a_kernel_only_what_is_set_counts(monkeypatch, value, expected):
    monkeypatch.delenv("LRP_STATIC", raising=False)
    if value is not None:
        monkeypatch.setenv("LRP_STATIC", value)
    assert is_static() is expected
