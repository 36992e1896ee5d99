"""A block that does not return, in a page: it is named, and there are ways out."""

from e2e.programs import COUNTER, LONG

HUNG = ':scope[data-lrp-status="hung"]'
NOTE = ".lrp-note:not([hidden])"
HANGING = COUNTER.replace("n = n + 1", "while True: n = n + 1")


def hang(lab):
    lab.replace("n = n + 1", "while True: n = n + 1")
    lab.sees(HUNG)


def test_there_are_five_ways_out_of_a_block_that_does_not_return(open_lab):
    lab = open_lab(COUNTER)
    lab.goes_on()
    notebook = lab.notebook

    hang(lab)  # the first way: an edit
    lab.until("note => /`?count.running`? has run for \\d+ s \\(line \\d+\\)/.test(note.textContent)", NOTE)
    lab.until("note => note.textContent.includes('ontime')", NOTE)
    lab.replace("while True: n = n + 1", "n = n + 1")
    lab.ready("running").goes_on()
    lab.misses(NOTE)

    hang(lab)
    lab.do("interrupt")
    lab.sees('[data-lrp-issue^="LRP611"]')

    lab.do("pause")  # it ran on, and into it again
    lab.ready("paused")
    lab.misses(NOTE)

    notebook.write_cell(1, f"%%lrp cell\n{HANGING}")
    notebook.run_cell(1)
    lab.sees(HUNG)
    notebook.write_cell(1, f"%%lrp cell\n{COUNTER}")
    notebook.run_cell(1)
    lab.ready("running").goes_on()

    notebook.write_cell(1, f"%%lrp cell\n{HANGING}")
    notebook.run_cell(1)
    lab.sees(HUNG)
    notebook.restart_kernel()
    notebook.run_cell(0)
    notebook.run_cell(1)
    lab.ready("paused")  # or the cell would hang at once
    lab.until("note => note.textContent.includes('did not return when it last ran')", NOTE)
    lab.replace("while True: n = n + 1", "n = n + 1")
    lab.do("run")
    lab.goes_on()


def test_where_a_cell_holds_up_what_the_page_sends_the_button_to_stop_says_it(open_notebook, page, server):
    """JupyterLab can send everything to where the cells run; by default it does not."""
    notebook = open_notebook("%load_ext lrp_jupyter", f"%%lrp m\n{COUNTER}", LONG)
    notebook.run_cell(0)
    page.evaluate(
        "jupyterapp.shell.currentWidget.sessionContext.session.kernel.commsOverSubshells = 'disabled'"
    )
    notebook.begin_cell(1)
    lab = notebook.lab().ready()
    lab.reads(".lrp-stop", "Stop after cells")
    notebook.begin_cell(2)
    notebook.prints(2)
    lab.do("stop")
    lab.reads(".lrp-stop[data-away]", "Not reachable")
    (notebook.path.parent / "go").touch()
    lab.ready("paused")
    lab.reads(".lrp-stop", "Stop after cells")

    page.evaluate("jupyterapp.shell.currentWidget.sessionContext.session.kernel.shutdown()")
    lab.sees(".lrp-stop[data-away]:disabled")
    other = notebook.lab().root.locator(".lrp-note:not([hidden])")
    assert "then the cell again" in other.first.inner_text()
