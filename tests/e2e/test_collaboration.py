"""Two users of one notebook: both see the lab, what each of them types, and what it does."""

from importlib.util import find_spec

import pytest
from support.waiting import until

from e2e.conftest import WAIT, WINDOW
from e2e.jupyter import jupyter
from e2e.pages import APP, NotebookPage
from e2e.programs import COUNTER

pytestmark = pytest.mark.skipif(
    find_spec("jupyter_collaboration") is None,
    reason="there is no jupyter-collaboration, which has an environment of its own",
)


@pytest.fixture(scope="module")
def shared_server(tmp_path_factory):
    """A JupyterLab whose notebooks are shared."""
    with jupyter(tmp_path_factory.mktemp("shared")) as server:
        yield server


class SharedNotebook(NotebookPage):
    """A notebook as one of its users sees it."""

    def ready(self):
        self.page.wait_for_function(
            f"path => {APP}?.context?.path.endsWith(path)"
            f" && {APP}.sessionContext?.session?.kernel?.status === 'idle'",
            arg=self.name,
        )
        return self


@pytest.fixture
def users(context, shared_server, request):
    """Two users who have opened a notebook before any of its cells runs."""
    name = f"{request.node.name}/notebook.ipynb"
    shared_server.write(name, ["%load_ext lrp_jupyter", f"%%lrp m\n{COUNTER}"])
    contexts = [context.browser.new_context(viewport=WINDOW) for _ in range(2)]
    for each in contexts:
        each.set_default_timeout(WAIT)
    yield [SharedNotebook(each.new_page(), shared_server, name).show() for each in contexts]
    for each in contexts:
        each.close()
    shared_server.end_kernels()


def run(notebook):
    """Run the cells, and return the lab as this user sees it."""
    notebook.run_cell(0)
    notebook.run_cell(1)
    return notebook.lab().ready()


def test_a_page_that_was_open_before_the_cell_ran_shows_the_lab_and_what_is_typed_in_either(users):
    first, second = users
    run(first)
    second.lab().ready()
    for notebook in (second, first):  # either of them runs the cell again
        run(notebook)
        for each in users:
            each.lab().ready().goes_on()
            assert each.page.locator('[data-lrp="lab"]').count() == 1

    mine, theirs = (each.lab() for each in users)
    mine.root.evaluate("lab => { lab.isFirst = true; }")
    mine.type_after("(state rest)", " (state third)")
    for lab in (mine, theirs):
        lab.sees('[data-lrp-state="m/third"]')
        lab.reads(".cm-content", "(state third)")
    theirs.type_after("(state third)", " (state fourth)")
    for lab in (theirs, mine):
        lab.sees('[data-lrp-state="m/fourth"]')
        lab.reads(".cm-content", "(state fourth)")
    assert mine.root.evaluate("lab => lab.isFirst")  # it was not drawn again for the other one
    is_saved_once(users, mine.text)


def is_saved_once(users, text):
    """What was typed in either page is in the cell that they share, and in the file."""
    source = f"%%lrp m\n{text}".rstrip("\n")
    for each in users:
        each.page.wait_for_function(
            f"source => {APP}.content.widgets[1].model.sharedModel.getSource() === source", arg=source
        )
    path = users[0].path
    users[0].command("docmanager:save")  # these servers save nothing unasked
    until(lambda: "(state fourth)" in path.read_text(), "the server has not saved it")
