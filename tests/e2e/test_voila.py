"""Voila: every visitor of a notebook has a kernel, a lab and a text of their own."""

import psutil
import pytest

from e2e.conftest import WAIT, WINDOW
from e2e.hosts import listens
from e2e.jupyter import free_port, private, serving, write_notebook
from e2e.pages import LabPage
from e2e.programs import COUNTER

pytestmark = pytest.mark.host("voila")


class Voila:
    """A server of one notebook."""

    def __init__(self, url, notebook, process):
        self.url, self.notebook, self.process = url, notebook, process

    def end_kernels(self):
        for child in psutil.Process(self.process.pid).children():
            child.kill()


@pytest.fixture(scope="module")
def voila(tmp_path_factory):
    home = tmp_path_factory.mktemp("voila")
    notebook = write_notebook(
        home / "notebooks" / "demo.ipynb", ["%load_ext lrp_jupyter", f"%%lrp m\n{COUNTER}"]
    )
    port = free_port()
    arguments = (str(notebook), "--no-browser", "--Voila.ip=127.0.0.1", f"--port={port}")
    with serving("voila", *arguments, home=home, answers=lambda: listens(port), env=private(home)) as process:
        yield Voila(f"http://127.0.0.1:{port}", notebook, process)


@pytest.fixture
def visit(context, voila):
    """Open the notebook: in a browser of its own, or in a further tab of the same one."""
    contexts = []

    def visit(tab_of=None):
        if tab_of is None:
            contexts.append(context.browser.new_context(viewport=WINDOW))
            contexts[-1].set_default_timeout(WAIT)
        page = contexts[-1].new_page() if tab_of is None else tab_of.page.context.new_page()
        page.goto(voila.url)
        return LabPage(page).ready()

    yield visit
    for each in contexts:
        each.close()


def is_untouched(lab):
    """Return whether a lab shows the text of its notebook, and asks nothing."""
    lab.goes_on()
    return lab.text == COUNTER and lab.find('[role="alertdialog"]').is_hidden()


def test_no_visitor_sees_what_another_one_has_typed(visit, voila):
    first, second = visit(), visit()
    first.type_after("(state rest)", " (state third)")
    first.sees('[data-lrp-state="m/third"]')
    assert is_untouched(second)
    second.type_after("(state rest)", " (state fourth)")
    second.sees('[data-lrp-state="m/fourth"]')
    first.goes_on()
    assert "fourth" not in first.text
    assert is_untouched(visit())
    assert [file.name for file in voila.notebook.parent.iterdir()] == ["demo.ipynb"]


def test_a_visitors_own_text_outlives_the_kernel_in_its_tab_and_nowhere_else(visit, voila):
    lab = visit()
    lab.type_after("(state rest)", " (state third)")
    lab.sees('[data-lrp-state="m/third"]')
    voila.end_kernels()
    lab.misses(':scope[data-link="live"]')
    assert is_untouched(visit(tab_of=lab))
    lab.page.reload()
    lab.ready()
    lab.reads('[role="alertdialog"]', "Which text should be kept?")
    lab.do("take")
    lab.sees('[data-lrp-state="m/third"]')
