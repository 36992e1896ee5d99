"""The debugger at an issue, in a cell below the lab."""

import pytest

from e2e.pages import APP

FAULTY = """\
(var p := [42])
(machine m
  (var n := [0])
  (state count
    (running [n = n + 1]
             [100 / (n - n)]))
  (state rest)
  (on [p] count -> rest))
(spawn m count)
"""


def source_of(notebook, index):
    return notebook.page.evaluate(
        f"index => {APP}.content.widgets[index]?.model.sharedModel.getSource()", index
    )


@pytest.mark.parametrize("app", ["lab/tree", "notebooks"])
def test_a_debugger_opens_at_an_issue_in_a_cell_below_and_the_lab_goes_on(open_notebook, app):
    notebook = open_notebook(
        "import lrp_jupyter", f"lrp_jupyter.Lab({FAULTY!r}, name='m')", "'last'", app=app
    )
    page = notebook.page
    notebook.begin_cell(0)
    notebook.begin_cell(1)
    lab = notebook.lab().ready()
    prompt = page.locator(".jp-Stdin-input")

    def asks(count):
        page.wait_for_function(
            "count => document.querySelectorAll('.jp-Stdin-input').length === count", arg=count
        )

    def ask(typed, answer):
        asks(1)
        prompt.fill(typed)
        prompt.press("Enter")
        page.wait_for_function("answer => document.body.innerText.includes(answer)", arg=answer)

    for code in ("LRP602", "LRP601"):
        lab.sees(f'[data-lrp-issue="{code}"] .lrp-debug').click()
        asks(1)
        lab.ready("paused")
        ask("p (p, robot is None, state)", "(42, False, 'm/count')")
        if code == "LRP601":
            ask("!p = False", "ipdb>  !p = False")
            lab.has_value("p", "False")
            lab.do("run")
            lab.goes_on()
            lab.do("debug")
            lab.reads(".lrp-toast", "End the debugger there with q first.")
        ask("q", "ipdb>  q")
        asks(0)
    assert source_of(notebook, 2).startswith("%load_ext lrp_jupyter\n%lrp debug 6:")
    assert source_of(notebook, 3) == "'last'", "the cell is used again"
