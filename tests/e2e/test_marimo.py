"""marimo: what every host promises, and cells that depend on the lab and run again."""

from pathlib import Path

import pytest

from e2e import hosts
from e2e.conftest import WAIT, WINDOW

EXAMPLE = Path(__file__).parents[2] / "notebooks/hosts/marimo_lab.py"

pytestmark = pytest.mark.host("marimo")


@pytest.fixture(scope="module")
def page(context):
    page = context.new_page()
    page.set_viewport_size(WINDOW)
    page.set_default_timeout(WAIT)
    yield page
    page.close()


@pytest.fixture(scope="module")
def app(tmp_path_factory):
    """Show a notebook as an app: ``marimo run``."""
    notebooks = {"notebook": hosts.MARIMO, "example": EXAMPLE.read_text()}
    with hosts.marimo(tmp_path_factory.mktemp("app"), "run", **notebooks) as show:
        yield show


def test_an_app_shows_the_lab_and_a_cell_that_uses_it_runs_again_when_the_active_state_changes(page, app):
    host = app(page, "notebook")
    host.prints("('m', 'count'), running")
    lab = host.works()
    host.shows_it_again()
    lab.type_after("(state rest)", "\n(ontime 100 count -> rest)")
    host.prints("('m', 'rest'), running")
    lab.pause()
    host.prints("('m', 'rest'), paused")


def test_a_cell_that_runs_again_continues_with_the_program_on_the_same_thread(page, tmp_path):
    with hosts.marimo(tmp_path, "edit", notebook=hosts.MARIMO) as show:
        host = show(page, "notebook")
        lab = host.works()
        host.shows_it_again()
        tick = lab.tick
        lab.root.evaluate("root => { root.dataset.old = ''; }")
        cell = page.locator(".marimo-cell", has_text="program = lrp_jupyter.Lab")
        cell.hover()
        cell.get_by_test_id("run-button").first.click()
        page.locator(".lrp-lab[data-old]").wait_for(state="detached")
        lab.ready().sees('[data-lrp-state="m/third"]')
        assert lab.tick > tick
        lab.goes_on()
        host.prints("1 loop")


def test_the_example_shows_what_the_robot_does_and_its_blocks_read_a_slider(page, app):
    host = app(page, "example")
    lab = host.lab.ready()
    host.prints("driver/left at ")
    host.prints("driver/right at ")
    lab.has_value("speed", "0.2")
    page.get_by_role("slider").first.press("ArrowRight")
    lab.has_value("speed", "0.25")
    assert lab.find("[data-lrp-issue]").count() == 0
