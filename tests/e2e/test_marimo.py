"""What only marimo has: cells that depend on the lab, and run again."""

from pathlib import Path

import pytest

from e2e import hosts
from e2e.conftest import WAIT, WINDOW

EXAMPLE = Path(__file__).parents[2] / "notebooks/hosts/marimo_lab.py"

pytestmark = pytest.mark.host("marimo")


@pytest.fixture
def opened(context, tmp_path):
    """Open a notebook in marimo, in a page of its own."""
    page = context.new_page()
    page.set_viewport_size(WINDOW)
    page.set_default_timeout(WAIT)
    left = []

    def opened(*arguments, **options):
        left.append(hosts.marimo(page, tmp_path, *arguments, **options))
        return left[0].__enter__()

    yield opened
    page.close()
    for notebook in left:
        notebook.__exit__(None, None, None)


def test_a_cell_that_uses_the_lab_shows_the_active_state_and_runs_again_when_that_changes(opened):
    host = opened("run")
    lab = host.lab.ready()
    host.prints("('m', 'count'), running")
    lab.type_after("(state rest)", "\n(ontime 100 count -> rest)")
    host.prints("('m', 'rest'), running")
    lab.pause()
    host.prints("('m', 'rest'), paused")


def test_a_cell_that_runs_again_continues_with_the_program_on_the_same_thread(opened):
    host = opened("edit")
    lab = host.lab.ready()
    lab.type_after("(state rest)", " (state third)")
    lab.sees('[data-lrp-state="m/third"]')
    lab.goes_on()
    tick = lab.tick
    lab.root.evaluate("root => { root.dataset.old = ''; }")
    cell = host.page.locator(".marimo-cell", has_text="program = lrp_jupyter.Lab")
    cell.hover()
    cell.get_by_test_id("run-button").first.click()
    host.page.locator(".lrp-lab[data-old]").wait_for(state="detached")
    lab.ready().sees('[data-lrp-state="m/third"]')
    assert lab.tick > tick
    lab.goes_on()
    host.prints("1 loop")


def test_the_example_shows_what_the_robot_does_and_its_blocks_read_a_slider(opened):
    host = opened("run", notebook=EXAMPLE.read_text())
    lab = host.lab.ready()
    host.prints("driver/left at ")
    host.prints("driver/right at ")
    lab.has_value("speed", "0.2")
    host.page.get_by_role("slider").first.press("ArrowRight")
    lab.has_value("speed", "0.25")
    assert lab.find("[data-lrp-issue]").count() == 0
