"""A notebook that was executed without a page shows its pictures without a kernel and without a network."""

import subprocess
import sys

import pytest

from e2e.conftest import WAIT
from e2e.jupyter import private, write_notebook
from e2e.programs import FOLLOWER


@pytest.fixture
def offline(context):
    """A page whose browser has no network."""
    context = context.browser.new_context(offline=True)
    context.set_default_timeout(WAIT)
    yield context.new_page()
    context.close()


def test_the_html_of_an_executed_notebook_shows_the_picture_of_the_lab(tmp_path, offline):
    notebook = write_notebook(
        tmp_path / "notebooks" / "demo.ipynb", ["%load_ext lrp_jupyter", f"%%lrp m\n{FOLLOWER}"]
    )
    subprocess.run(
        [sys.executable, "-m", "nbconvert", "--execute", "--to", "html", notebook],
        env=private(tmp_path),
        check=True,
    )
    offline.goto(notebook.with_suffix(".html").as_uri())
    picture = offline.locator(".jp-OutputArea-output img")
    picture.wait_for()
    assert picture.evaluate("image => image.naturalWidth") > 100
    assert picture.is_visible()
