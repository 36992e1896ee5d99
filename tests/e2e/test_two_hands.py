"""Two windows on one kernel: what is typed in both at once, over links of any speed, is in both texts."""

from functools import partial
from itertools import zip_longest

import pytest

from e2e.pages import NotebookPage
from e2e.programs import COUNTER

ANOTHER = "import lrp_jupyter; lrp_jupyter.Lab('m')"  # a widget that this window need not ask the kernel for
KERNEL = "import lrp_jupyter; print(lrp_jupyter.Lab('m').text)"
FIRST, SECOND = "; what the first hand types\n", "; and this is from the second one\n"


def delayed(route, delay):
    """Connect a page's WebSocket to the server, `delay` seconds later in each direction."""
    server = route.connect_to_server()
    loop = route._loop

    def later(send):
        return lambda message: loop.call_later(delay, send, message)

    if delay:
        route.on_message(later(server.send))
        server.on_message(later(route.send))


@pytest.fixture
def windows(page, context, server, request):
    """Open a lab in two windows, whose links take so long in each direction (s)."""
    opened = []

    def windows(program, delay):
        name = f"{request.node.name}/notebook.ipynb"
        server.write(name, ["%load_ext lrp_jupyter", f"%%lrp m\n{program}", ANOTHER, KERNEL])
        labs = []
        for cells in ((0, 1), (2,)):
            window = context.new_page()
            opened.append(window)
            window.route_web_socket(lambda url: "/channels" in url, partial(delayed, delay=delay))
            notebook = NotebookPage(window, server, name).show()
            for cell in cells:
                notebook.run_cell(cell)
            lab = notebook.lab().ready()
            lab.notebook = notebook
            labs.append(lab)
        return labs

    yield windows
    for window in opened:
        window.close()


@pytest.mark.parametrize("delay", [0.0, 0.075, 0.2], ids=["no delay", "150 ms", "400 ms"])
def test_two_windows_that_type_at_once_end_with_every_letter_in_one_text(windows, delay):
    labs = windows(COUNTER, delay)
    for lab, after in zip(labs, ["[1000])", "(spawn m count)"], strict=True):
        lab.select(after)
        lab.page.keyboard.press("ArrowRight")
    for one, other in zip_longest(FIRST, SECOND):  # two people, who do not wait for each other
        labs[0].page.keyboard.type(one or "")
        labs[1].page.keyboard.type(other or "")
    text = COUNTER.replace("[1000])", f"[1000]){FIRST}").rstrip("\n") + SECOND + "\n"
    for lab in labs:
        lab.sees(".lrp-hand-caret")
        lab.reads(".cm-content", FIRST.strip())
        lab.reads(".cm-content", SECOND.strip())
    assert [lab.text.rstrip("\n") for lab in labs] == [text.rstrip("\n")] * 2
    labs[0].notebook.run_cell(3)
    labs[0].notebook.prints(3)
    printed = labs[0].page.locator(".jp-OutputArea-output pre").last.text_content()
    assert printed.rstrip("\n") == text.rstrip("\n")
