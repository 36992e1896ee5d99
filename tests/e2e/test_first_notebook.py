"""Somebody opens the first notebook, runs two cells, and types: in a real JupyterLab and a real browser."""

import shutil
from pathlib import Path

from e2e.pages import NotebookPage

FIRST = "00-hello-live-robot.ipynb"
NOTEBOOKS = Path(__file__).parents[2] / "notebooks"


def test_the_first_notebook_keeps_its_promises(page, server):
    shutil.copy(NOTEBOOKS / FIRST, server.root)
    notebook = NotebookPage(page, server, FIRST).show()
    notebook.begin_cell(1)
    notebook.begin_cell(2)
    lab = notebook.lab().ready()
    lab.goes_on()
    assert lab.value("forward") == "0.2"

    lab.replace("0.2", "0.1")  # slower, on the way
    lab.has_value("forward", "0.1")
    tick = lab.tick

    lab.type_after("(on white right -> left)", "\n(state resting (onentry [robot.stop()]))")
    lab.state("driver/resting")
    lab.type_after("(on white right -> left)", "\n(ontime 300 left -> resting)")
    lab.is_active("driver/resting")
    lab.type_after("(on white right -> left)", "\n(ontime 1000 resting -> left)")
    lab.is_active("driver/left")
    assert lab.tick > tick, "it never restarted"

    lab.type_after("(spawn driver left", "(")  # a mistake: the robot drives on
    lab.sees("[data-lrp-issue]")
    lab.goes_on()
    lab.do("pause")
    lab.ready("paused")
