"""What an edit is going to do, and what was: both are shown in the world."""

import pytest

from e2e.axe import finds_nothing_serious

STANDS = """\
(machine m
  (state ahead (running [robot.move(linear=0.0)])))
(spawn m ahead)
"""
CURVES = """\
(machine m
  (state bend (running [robot.move(linear=0.2, angular=1.0)]))
  (state back (running [robot.move(linear=0.2, angular=-1.0)]))
  (ontime 1000 bend -> back)
  (ontime 1000 back -> bend))
(spawn m bend)
"""
DRIVES = """\
(machine m
  (state ahead (running [robot.move(linear=0.2)])))
(spawn m ahead)
"""
WORLD = ".lrp-world-body"
AHEAD = ".lrp-world-ahead"


@pytest.fixture
def open_world(open_lab):
    """Open a lab with a world, and see all of the world."""

    def open_world(program, world):
        lab = open_lab(program, f"m --world {world}")
        lab.sees(".lrp-canvas[data-view]").scroll_into_view_if_needed()
        lab.do("world-zoom-fit")
        return lab

    return open_world


def drive_into_the_wall(lab):
    """Turn the robot, which stands before a wall, into a robot that drives against it."""
    revision = lab.revision
    lab.replace("linear=0.0", "linear=-0.1")
    lab.until("(root, revision) => Number(root.dataset.lrpRevision) > revision", argument=revision)


def test_an_edit_shows_where_it_leads_and_the_collision_before_it_happens(open_world):
    lab = open_world(STANDS, "line")
    lab.goes_on()
    lab.pause()
    lab.misses(f"{WORLD}[data-what-if]")
    drive_into_the_wall(lab)
    lab.sees(f"{WORLD}[data-what-if]")
    lab.reads(AHEAD, "The robot touches near wall")
    finds_nothing_serious(lab)
    tick = lab.tick
    lab.do("run")
    lab.misses(f"{WORLD}[data-what-if]")
    lab.until("sentence => sentence.textContent === ''", AHEAD)
    assert lab.tick > tick + 20  # it was told seconds before


def test_a_preview_of_a_running_program_is_shown_until_its_end(open_world):
    lab = open_world(CURVES, "empty")
    lab.goes_on()
    lab.select("angular=-1.0")
    lab.page.keyboard.press("Alt+ArrowUp")
    lab.sees(f"{WORLD}[data-what-if]")
    lab.misses(f"{WORLD}[data-what-if]")


def test_without_previews_an_edit_shows_nothing(open_world):
    lab = open_world(STANDS, "line")
    lab.goes_on()
    lab.pause()
    lab.do("world-menu")
    lab.choose("preview")
    drive_into_the_wall(lab)
    tick = lab.tick
    lab.do("step")
    lab.until("(root, tick) => Number(root.dataset.lrpTick) > tick", argument=tick)
    assert lab.find(f"{WORLD}[data-what-if]").count() == 0
    assert lab.find(AHEAD).inner_text() == ""


def test_a_click_on_the_trail_shows_that_moment_and_a_drag_the_present_again(open_world):
    lab = open_world(DRIVES, "line")
    lab.goes_on()
    lab.pause()
    lab.sees('[data-lrp-action="world"]').select_option(label="empty")  # where time begins again
    lab.until("list => list.selectedOptions[0]?.text === 'empty'", '[data-lrp-action="world"]')
    lab.do("world-zoom-fit")
    begin = lab.tick
    lab.do("run")
    lab.until("(root, tick) => Number(root.dataset.lrpTick) >= tick", argument=begin + 25)
    lab.pause()
    mouse, now = lab.page.mouse, lab.tick
    mouse.move(*lab.place(1.7, 1.0))
    lab.reads(".lrp-tip", "click to look")
    mouse.click(*lab.place(1.7, 1.0))
    lab.sees(f"{WORLD}[data-looking]")
    assert 8 <= lab.tick - begin <= 14  # it drives 2 cm in a tick, once it has started
    mouse.click(*lab.place(1.7, 1.0))
    lab.reads(".lrp-thing", "Robot")  # as it was

    lab.drag_robot((1.7, 1.0), (1.7, 1.6))
    lab.misses(f"{WORLD}[data-looking]")
    assert lab.tick == now
    lab.page.keyboard.press("Escape")
    mouse.click(*lab.place(1.5 + 0.02 * (now - begin - 1), 1.0))
    lab.reads(".lrp-thing", "Robot")  # as it is: nothing has moved it
