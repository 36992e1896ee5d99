"""Voila: what every host promises, and a kernel, a lab and a text for each visitor."""

import psutil
import pytest

from e2e import hosts
from e2e.conftest import WAIT, WINDOW
from e2e.pages import LabPage
from e2e.programs import COUNTER

pytestmark = pytest.mark.host("voila")


@pytest.fixture
def browsers(context):
    """Open a page of a browser of its own."""
    contexts = []

    def open_browser():
        contexts.append(context.browser.new_context(viewport=WINDOW))
        contexts[-1].set_default_timeout(WAIT)
        return contexts[-1].new_page()

    yield open_browser
    for each in contexts:
        each.close()


def test_what_a_visitor_types_is_seen_by_no_other_and_outlives_the_kernel_in_its_tab(browsers, tmp_path):
    with hosts.voila(tmp_path) as (folder, url, process):

        def visit(page):
            page.goto(url)
            return LabPage(page).ready()

        def is_untouched(lab):
            """Return whether a lab shows the text of its notebook, and asks nothing."""
            lab.goes_on()
            return lab.text == COUNTER and lab.find('[role="alertdialog"]').is_hidden()

        page = browsers()
        visit(page)
        first = hosts.Host(page, page.reload).works()  # and types a third state
        second = visit(browsers())
        assert is_untouched(second)
        second.type_after("(state rest)", " (state fourth)")
        second.sees('[data-lrp-state="m/fourth"]')
        first.goes_on()
        assert "fourth" not in first.text
        assert [file.name for file in folder.iterdir()] == ["demo.ipynb"]

        for kernel in psutil.Process(process.pid).children():
            kernel.kill()
        first.misses(':scope[data-link="live"]')
        assert is_untouched(visit(page.context.new_page()))
        page.reload()
        first.ready()
        first.reads('[role="alertdialog"]', "Which text should be kept?")
        first.do("take")
        first.sees('[data-lrp-state="m/third"]')
        first.goes_on()
