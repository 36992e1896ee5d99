"""A notebook that is executed without a page stores pictures instead of widgets."""

import json

import pytest

from lrp_jupyter.widgets.hosts import is_static

pytestmark = pytest.mark.slow  # each starts a kernel

TEXT = "(machine m (state one) (state two) (ontime 60000 one -> two)) (spawn m one)"
WIDGET = "application/vnd.jupyter.widget-view+json"
PNG = "iVBORw0KGgo"  # how every PNG begins


def executed(tmp_path, *cells):
    """Execute cells as nbconvert does; return the notebook."""
    import nbformat  # slow: only here
    from nbclient import NotebookClient

    sources = ["%load_ext lrp_jupyter", *cells]
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(source) for source in sources])
    client = NotebookClient(
        notebook, timeout=120, allow_errors=True, resources={"metadata": {"path": str(tmp_path)}}
    )
    client.execute()
    return notebook


def data_of(notebook, index=1):
    [output] = notebook.cells[index].outputs
    return output.data


@pytest.fixture(autouse=True)
def _nothing_is_set(monkeypatch):
    for name in ("LRP_STATIC", "VOILA_PREHEAT", "SERVER_SOFTWARE"):
        monkeypatch.delenv(name, raising=False)


def test_a_lab_and_its_parts_are_pictures_and_no_state_of_widgets_is_stored(tmp_path):
    parts = ("import lrp_jupyter; lrp_jupyter.StateGraph('m')", "lrp_jupyter.Lab('m').text")
    notebook = executed(tmp_path, f"%%lrp m\n{TEXT}", *parts)
    for index in (1, 2):
        data = data_of(notebook, index)
        assert set(data) == {"image/svg+xml", "image/png", "text/plain"}
        assert ">one</text>" in data["image/svg+xml"]
        assert data["image/png"].startswith(PNG)
        assert data["text/plain"].strip() == TEXT
    assert data_of(notebook, 3)["text/plain"] == repr(f"{TEXT}\n")
    assert "widgets" not in notebook.metadata
    assert len(json.dumps(notebook)) < 200_000


def test_a_lab_is_a_widget_where_one_is_wanted_and_a_wrong_wish_is_told_with_the_right_ones(tmp_path):
    lab = f"%%lrp m\n{TEXT}"
    voila = ("%env LRP_STATIC=", "%env VOILA_PREHEAT=False")
    notebook = executed(
        tmp_path,
        "%env LRP_STATIC=0",
        lab,
        *voila,
        lab,
        "%env LRP_STATIC=yes",
        lab.replace("%%lrp m", "%%lrp n"),
    )
    for index in (2, 5):
        assert WIDGET in data_of(notebook, index)
    assert "widgets" in notebook.metadata
    assert "`yes` does not answer that. Set it to `1` or `0`." in str(notebook.cells[7].outputs)


@pytest.mark.parametrize(("value", "expected"), [(None, False), ("1", True), ("0", False)])
def test_outside_of_a_kernel_only_what_is_set_counts(monkeypatch, value, expected):
    if value is not None:
        monkeypatch.setenv("LRP_STATIC", value)
    assert is_static() is expected
