"""The lab and its hosts: `lrp lab`, JupyterLab and Notebook 7, the cell that holds the program, no kernel."""

import json
import subprocess
import sys
from urllib.request import urlopen
from xml.etree import ElementTree

import pytest

from e2e.conftest import WAIT
from e2e.jupyter import jupyter, private, write_notebook
from e2e.pages import APP
from e2e.programs import COUNTER, FOLLOWER
from lrp_jupyter import programs
from lrp_jupyter.cli.lab_command import FIRST

NEWS = "lab/api/settings/@jupyterlab/apputils-extension:notification"
STORED = ".jp-RenderedSVG img"
LARGEST = 100_000  # bytes of a notebook with one lab


@pytest.fixture
def first_visit(tmp_path, context):
    """The server and page of `lrp lab` for a user who has never run Jupyter."""
    with jupyter(tmp_path, ("lrp_jupyter", "lab", "--dir"), settings={}) as server:
        page = context.new_page()
        page.set_default_timeout(WAIT)
        page.goto(server.url)
        # a kernel that is still being started may hold up the end of its server
        page.wait_for_function(f"{APP}?.sessionContext?.session?.kernel?.status === 'idle'")
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
    page.wait_for_function(f"{APP}.context.model.getMetadata('language_info').version")
    assert not page.evaluate(f"{APP}.context.model.dirty"), (
        "nothing is to be saved before the user did anything"
    )


@pytest.mark.parametrize("app", ["lab/tree", "notebooks"])
def test_a_cell_holds_the_program_and_a_picture_stands_where_no_kernel_runs(open_notebook, server, app):
    notebook = open_notebook(
        "%load_ext lrp_jupyter", f"%%lrp m\n{COUNTER}", "%lrp new stopwatch", "'last'", app=app
    )
    notebook.run_cell(0)
    notebook.begin_cell(1)
    lab = notebook.lab().ready()
    show_one_text_once_and_two_texts_both(lab)
    if app == "lab/tree":
        edit_the_folded_cell(lab)
        write_and_use_the_cell(lab)
    lose_the_kernel(lab)
    see_the_picture(lab, server, app)
    if app == "lab/tree":
        write_a_new_cell(lab)


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


def show_one_text_once_and_two_texts_both(lab):
    page = lab.page
    is_one_line(page)
    lab.type_after("(state rest)", " (state third)")
    lab.sees('[data-lrp-state="m/third"]')
    page.locator(".lrp-lab-newer").wait_for(state="attached")
    lab.notebook.write_cell(1, source_of(lab.notebook) + " ; edited, too")
    page.locator(".lrp-lab-differs").wait_for(state="attached")
    is_one_line(page)  # nothing moves while the user types
    before = lab.box()
    page.evaluate("document.activeElement.blur()")
    is_whole(page)
    assert abs(lab.box()["y"] - before["y"]) < 2
    lab.select(" (state third)")
    page.keyboard.press("Delete")
    lab.notebook.write_cell(1, source_of(lab.notebook).removesuffix(" ; edited, too"))
    page.evaluate("document.activeElement.blur()")
    is_one_line(page)


def edit_the_folded_cell(lab):
    """It is edited as any other."""
    lab.page.locator(".jp-CodeCell").nth(1).locator(".jp-InputArea-editor").click(position={"x": 60, "y": 10})
    is_whole(lab.page)
    lab.page.keyboard.press("Control+End")
    lab.page.keyboard.type("; edited")
    lab.page.keyboard.press("Escape")
    lab.notebook.run_cell(0)  # the focus is elsewhere
    is_whole(lab.page)
    lab.notebook.run_cell(1)
    lab.reads(".cm-content", "; edited")
    is_one_line(lab.page)


def write_and_use_the_cell(lab):
    """The cell's text is used again, and that undone; the lab's is written into it, and is no other then."""
    before = lab.text
    lab.type_after("(state rest)", " (state third)")
    lab.sees('[data-lrp-state="m/third"]')
    lab.do("menu")
    lab.choose("use-cell")
    lab.misses('[data-lrp-state="m/third"]')
    assert lab.text.rstrip("\n") == before.rstrip("\n")
    lab.find(".cm-content").press("Control+z")
    lab.sees('[data-lrp-state="m/third"]')
    lab.do("menu")
    lab.choose("write-cell")
    is_one_line(lab.page)
    assert source_of(lab.notebook) == f"%%lrp m\n{lab.text}".rstrip("\n")
    lab.notebook.save()


def lose_the_kernel(lab):
    """A lab whose kernel was restarted says so, and asks nothing when its cell runs again."""
    lab.notebook.restart_kernel()
    lab.ready("dead")
    lab.reads(".lrp-verdict", "no kernel")
    lab.notebook.run_cell(0)
    lab.notebook.run_cell(1)
    lab.ready().goes_on()
    assert lab.find('[role="alertdialog"]').is_hidden()


def write_a_new_cell(lab):
    """A lab without a cell of its own writes its text into a new one."""
    notebook = lab.notebook
    notebook.begin_cell(2)
    other = notebook.lab(1).ready()
    other.do("menu")
    assert not other.find('[data-lrp-action="use-cell"]').is_enabled()
    other.choose("write-cell")
    lab.page.wait_for_function(f"{APP}.content.widgets.length === 5")
    assert source_of(notebook, 3) == f"%%lrp stopwatch --bridge none\n{programs.load('stopwatch')}".rstrip(
        "\n"
    )


def see_the_picture(lab, server, app):
    """A saved notebook shows it where its kernel has ended, and stores one, as often as it runs."""
    notebook, page = lab.notebook, lab.page
    notebook.save()
    assert notebook.path.stat().st_size < LARGEST
    notebook.close()
    server.end_kernels()
    notebook.show(app)
    page.locator(STORED).wait_for(state="attached")
    page.wait_for_function(f"document.querySelector('{STORED}').naturalWidth > 100")
    assert "model not found" not in page.locator(".jp-Notebook").inner_text()
    notebook.run_cell(0)
    notebook.run_cell(1)
    lab.ready()
    assert page.locator(STORED).count() == 0
    notebook.save()
    assert "widgets" not in json.loads(notebook.path.read_text())["metadata"]


def test_a_notebook_shows_graph_and_text_on_paper_and_without_a_network(open_lab, context, tmp_path):
    lab = open_lab(FOLLOWER, "follower --world line")
    lab.goes_on()
    lab.notebook.save()
    bundle = json.loads(lab.notebook.path.read_text())["cells"][1]["outputs"][0]["data"]
    assert "".join(bundle["text/plain"]) == FOLLOWER
    shown = "".join(ElementTree.fromstring("".join(bundle["image/svg+xml"])).itertext())
    for word in ("follower", "moving", "looking", "tlooking"):
        assert word in shown

    notebook = write_notebook(tmp_path / "demo.ipynb", ["%load_ext lrp_jupyter", f"%%lrp m\n{FOLLOWER}"])
    offline = context.browser.new_context(offline=True)
    offline.set_default_timeout(WAIT)
    page = offline.new_page()
    page.goto(converted(notebook, tmp_path / "home", "--execute").as_uri())
    image = page.locator(".jp-OutputArea-output img")
    image.wait_for()
    assert image.evaluate("image => image.naturalWidth") > 100
    assert image.is_visible()
    offline.close()


def converted(notebook, home, *options):
    """Convert a notebook to HTML."""
    home.mkdir()
    command = [sys.executable, "-W", "ignore", "-m", "nbconvert", "--to", "html", *options]
    subprocess.run([*command, "--output-dir", home, notebook], env=private(home), check=True)
    return home / f"{notebook.stem}.html"
