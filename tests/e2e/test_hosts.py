"""The lab and its hosts: `lrp lab`, the cell that holds the program, and notebooks without a kernel."""

import json
from urllib.request import urlopen

import pytest

from e2e.conftest import WAIT
from e2e.jupyter import jupyter
from e2e.pages import APP
from lrp_jupyter.cli.lab import FIRST

NEWS = "lab/api/settings/@jupyterlab/apputils-extension:notification"


@pytest.fixture
def first_visit(tmp_path, context):
    """The server and page of `lrp lab` for a user who has never run Jupyter."""
    with jupyter(tmp_path, ("lrp_jupyter", "lab", "--dir"), settings={}) as server:
        page = context.new_page()
        page.set_default_timeout(WAIT)
        page.goto(server.url)
        page.wait_for_function(f"{APP}?.content?.widgets?.length > 0")
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
