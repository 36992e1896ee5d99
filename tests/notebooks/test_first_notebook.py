"""Somebody opens the first notebook, runs two cells, and types: in a real JupyterLab and a real browser."""

from __future__ import annotations

import os
import shutil

import pytest
from e2e.jupyter import FLAGS, chromium, jupyter, lacking
from e2e.pages import NotebookPage
from execution import NOTEBOOKS

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(bool(lacking()) and not os.environ.get("CI"), reason=f"there is no {lacking()}"),
]
FIRST = "00-hello-live-robot.ipynb"


@pytest.fixture
def notebook(tmp_path):
    from playwright.sync_api import sync_playwright

    assert not lacking(), f"there is no {lacking()}"
    with jupyter(tmp_path) as server, sync_playwright() as playwright:
        shutil.copy(NOTEBOOKS / FIRST, server.root)
        browser = playwright.chromium.launch(executable_path=chromium(), args=FLAGS)
        page = browser.new_page(viewport={"width": 1600, "height": 1000})
        page.set_default_timeout(30_000)
        yield NotebookPage(page, server, FIRST).show()
        server.end_kernels()
        browser.close()


def test_the_first_notebook_keeps_its_promises(notebook):
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
    assert lab.tick > tick, "it never began anew"

    lab.type_after("(spawn driver left", "(")  # a mistake: the robot drives on
    lab.sees("[data-lrp-issue]")
    lab.goes_on()
    lab.do("pause")
    lab.ready("paused")
