"""The lab and its hosts: `lrp lab`, the cell that holds the program, and notebooks without a kernel."""

import json
from urllib.request import urlopen

import pytest

from e2e.conftest import WAIT
from e2e.jupyter import jupyter
from e2e.pages import APP
from e2e.programs import COUNTER, FOLLOWER
from lrp_jupyter import programs
from lrp_jupyter.cli.lab import FIRST

NEWS = "lab/api/settings/@jupyterlab/apputils-extension:notification"


@pytest.fixture
def first_visit(tmp_path, context):
    """The server and page of `lrp lab` for a user who has never run Jupyter."""
    with jupyter(tmp_path, ("lrp_jupyter", "lab", "--dir"), settings={}) as server:
        page = context.new_page()
        page.set_default_timeout(WAIT)
        page.goto(server.url)
        page.wait_for_function(f"{APP}?.content?.widgets?.length > 0")
        yield server, page
        page.close()


def test_lrp_lab_shows_pictures_and_neither_a_side_bar_nor_a_question(first_visit):
    server, page = first_visit
    assert page.evaluate(f"{APP}.context.path") == FIRST
    page.locator(".jp-RenderedSVG img").first.wait_for(state="attached")
    assert "SVG object" not in page.locator(".jp-Notebook").inner_text()
    assert page.locator("#jp-left-stack").is_hidden()
    with urlopen(f"{server.url}/{NEWS}", timeout=20) as answer:
        assert json.load(answer)["schema"]["properties"]["fetchNews"]["default"] == "false"
    assert page.locator(".Toastify__toast").count() == 0


# -- the cell above the lab ------------------------------------------------------------------------


@pytest.fixture
def input_of(page):
    """The drawn text of a cell."""
    return lambda index=1: page.locator(".jp-CodeCell").nth(index).locator(".jp-InputArea-editor")


def source_of(notebook, index=1):
    """Return the text of a cell."""
    return notebook.page.evaluate(
        f"index => {APP}.content.widgets[index].model.sharedModel.getSource()", index
    )


def has_height(page, condition):
    """Wait until the height of the text of the lab's cell, in px, meets a condition."""
    cell = "document.querySelectorAll('.jp-CodeCell')[1]"
    page.wait_for_function(f"{cell}.querySelector('.jp-InputArea-editor').offsetHeight {condition}")


def is_one_line(page):
    """Wait until the lab's cell is folded to its first line."""
    has_height(page, "< 40")


def is_whole(page):
    """Wait until all lines of the lab's cell are shown."""
    has_height(page, "> 100")


@pytest.mark.parametrize("app", ["lab/tree", "notebooks"])
def test_one_text_is_shown_once_and_two_texts_are_both_shown(open_notebook, page, app):
    notebook = open_notebook("%load_ext lrp_jupyter", f"%%lrp m\n{COUNTER}", app=app)
    notebook.run_cell(0)
    notebook.begin_cell(1)
    lab = notebook.lab().ready()
    is_one_line(page)
    lab.type_after("(state rest)", " (state third)")
    lab.sees('[data-lrp-state="m/third"]')
    page.locator(".lrp-lab-differs").wait_for(state="attached")
    is_one_line(page)  # nothing moves while the user types
    before = lab.box()
    page.evaluate("document.activeElement.blur()")
    is_whole(page)
    assert abs(lab.box()["y"] - before["y"]) < 2
    lab.select(" (state third)")
    page.keyboard.press("Delete")
    page.evaluate("document.activeElement.blur()")
    is_one_line(page)


def test_a_folded_cell_is_edited_as_any_other(open_lab, input_of):
    lab = open_lab(COUNTER)
    is_one_line(lab.page)
    input_of().click(position={"x": 60, "y": 10})
    is_whole(lab.page)
    lab.page.keyboard.press("Control+End")
    lab.page.keyboard.type("; edited")
    lab.page.keyboard.press("Escape")
    lab.notebook.run_cell(0)  # the focus is elsewhere
    is_whole(lab.page)
    lab.notebook.run_cell(1)
    lab.reads(".cm-content", "; edited")
    is_one_line(lab.page)


def test_the_text_is_written_into_the_cell_which_is_then_no_other_text(open_lab):
    lab = open_lab(COUNTER)
    lab.type_after("(state rest)", " (state third)")
    lab.sees('[data-lrp-state="m/third"]')
    lab.do("menu")
    lab.choose("write-cell")
    is_one_line(lab.page)
    assert source_of(lab.notebook) == f"%%lrp m\n{lab.text}".rstrip("\n")
    lab.notebook.save()
    lab.notebook.restart_kernel()
    lab.notebook.run_cell(0)
    lab.notebook.run_cell(1)
    lab.ready()
    lab.sees('[data-lrp-state="m/third"]')
    lab.goes_on()
    assert lab.find('[role="alertdialog"]').is_hidden()


def test_the_cells_text_is_used_again_and_that_can_be_undone(open_lab):
    lab = open_lab(COUNTER)
    lab.type_after("(state rest)", " (state third)")
    lab.sees('[data-lrp-state="m/third"]')
    lab.do("menu")
    lab.choose("use-cell")
    lab.misses('[data-lrp-state="m/third"]')
    assert lab.text == COUNTER
    lab.find(".cm-content").press("Control+z")
    lab.sees('[data-lrp-state="m/third"]')


def test_a_lab_without_a_cell_of_its_own_writes_its_text_into_a_new_one(open_notebook, page):
    notebook = open_notebook("%load_ext lrp_jupyter", "%lrp new stopwatch", "'last'")
    notebook.run_cell(0)
    notebook.begin_cell(1)
    lab = notebook.lab().ready()
    lab.do("menu")
    assert not lab.find('[data-lrp-action="use-cell"]').is_enabled()
    lab.choose("write-cell")
    page.wait_for_function(f"{APP}.content.widgets.length === 4")
    assert source_of(notebook, 2) == f"%%lrp stopwatch\n{programs.load('stopwatch')}".rstrip("\n")


# -- without a kernel ------------------------------------------------------------------------------

STORED = 'img[alt^="State graph"]'
LARGEST = 100_000  # bytes of a notebook with one lab


def has_a_picture(page):
    """Wait until the stored picture is drawn, and nothing in its place."""
    page.locator(STORED).wait_for(state="attached")
    page.wait_for_function(f"document.querySelector('{STORED}').naturalWidth > 100")
    assert "model not found" not in page.locator(".jp-Notebook").inner_text()


@pytest.mark.parametrize("app", ["lab/tree", "notebooks"])
def test_a_saved_notebook_shows_the_picture_where_its_kernel_has_ended(open_lab, server, app):
    lab = open_lab(FOLLOWER)
    notebook = lab.notebook
    notebook.save()
    assert notebook.path.stat().st_size < LARGEST
    notebook.close()
    server.end_kernels()
    notebook.show(app)
    has_a_picture(lab.page)
    for _ in range(2):  # as often as it runs, one picture is stored
        notebook.run_cell(0)
        notebook.run_cell(1)
        notebook.lab().ready()
        assert lab.page.locator(STORED).count() == 0
        notebook.save()
        stored = json.loads(notebook.path.read_text())["metadata"]["widgets"]
        assert len(stored["application/vnd.jupyter.widget-state+json"]["state"]) == 1
        notebook.restart_kernel()


@pytest.mark.parametrize("app", ["lab/tree", "notebooks"])
def test_a_lab_whose_kernel_was_restarted_says_that_no_program_runs(open_notebook, app):
    notebook = open_notebook("%load_ext lrp_jupyter", f"%%lrp m\n{COUNTER}", app=app)
    notebook.run_cell(0)
    notebook.begin_cell(1)
    lab = notebook.lab().ready()
    notebook.restart_kernel()
    lab.ready("dead")
    lab.reads(".lrp-verdict", "no kernel")
    notebook.run_cell(0)
    notebook.run_cell(1)
    lab.ready().goes_on()


def test_a_page_that_is_loaded_again_shows_the_lab_while_its_kernel_runs(open_lab):
    lab = open_lab(COUNTER)
    lab.notebook.save()
    lab.page.reload()
    lab.notebook.ready()
    lab.ready().goes_on()
    assert lab.page.locator(STORED).count() == 0
