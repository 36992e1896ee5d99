"""Two windows on one kernel: what is typed in both at once, over links of any speed, is in both texts."""

from itertools import zip_longest

import pytest
from support.waiting import until

from e2e.pages import NotebookPage
from e2e.programs import COUNTER

ANOTHER = "import lrp_jupyter; lrp_jupyter.Lab('m')"  # a widget that this window need not ask the kernel for
KERNEL = "import lrp_jupyter; print(lrp_jupyter.Lab('m').text)"
FIRST, SECOND = "; what the first hand types\n", "; and this is from the second one\n"


class Link:
    """A WebSocket between a page and the server that takes so long in each direction."""

    delay = 0.0  # s

    def __call__(self, route):
        server = route.connect_to_server()
        loop = route._loop

        def later(send):
            return lambda message: loop.call_later(self.delay, send, message)

        route.on_message(later(server.send))
        server.on_message(later(route.send))


@pytest.fixture
def windows(page, context, server, request):
    """Open a lab in two windows, with the link that both have."""
    link, opened = Link(), []

    def windows(program):
        name = f"{request.node.name}/notebook.ipynb"
        server.write(name, ["%load_ext lrp_jupyter", f"%%lrp m\n{program}", ANOTHER, KERNEL])
        labs = []
        for cells in ((0, 1), (2,)):
            window = context.new_page()
            opened.append(window)
            window.route_web_socket(lambda url: "/channels" in url, link)
            notebook = NotebookPage(window, server, name).show()
            for cell in cells:
                notebook.run_cell(cell)
            labs.append(notebook.lab().ready())
        return link, labs

    yield windows
    for window in opened:
        window.close()


def test_two_windows_that_type_at_once_end_with_every_letter_in_one_text(windows):
    link, labs = windows(COUNTER)
    begin, end = "[1000])", "(spawn m count)"
    for count, link.delay in enumerate([0.0, 0.075, 0.2], 1):
        for lab, after in zip(labs, [begin, end], strict=True):
            lab.select(after)
            lab.page.keyboard.press("ArrowRight")
        for one, other in zip_longest(FIRST, SECOND):  # two people, who do not wait for each other
            labs[0].page.keyboard.type(one or "")
            labs[1].page.keyboard.type(other or "")
        text = COUNTER.replace(begin, begin + FIRST * count).replace(end, end + SECOND * count)
        for lab in labs:
            lab.sees(".lrp-hand-caret")
            has_text(lab, text)
    labs[0].notebook.run_cell(3)
    labs[0].notebook.prints(3)
    printed = labs[0].page.locator(".jp-OutputArea-output pre").last.text_content()
    assert printed.rstrip("\n") == text.rstrip("\n")


def has_text(lab, text):
    """Wait until a lab shows a text."""
    until(lambda: lab.text.rstrip("\n") == text.rstrip("\n"), lambda: lab.text)
