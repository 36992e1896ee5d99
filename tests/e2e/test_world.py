"""The world in the page: it is looked at, and edited by mouse and keyboard."""

import json
import math
import xml.etree.ElementTree as ElementTree

import pytest

from e2e.axe import choose_theme, finds_nothing_serious

STILL = "(machine m (state waiting)) (spawn m waiting)"
DRIVER = """\
(machine m
  (state ahead (running [robot.move(0.3, 0.8)]))
  (state aside (running [robot.move(0.2, 0.8)]))
  (ontime 1000 ahead -> aside)
  (ontime 1000 aside -> ahead))
(spawn m ahead)
"""


@pytest.fixture
def open_world(open_lab):
    """Open a lab with a world, and see the world well."""

    def open_world(program=STILL, world="empty"):
        lab = open_lab(program, f"m --world {world}")
        lab.sees(".lrp-canvas[data-view]").scroll_into_view_if_needed()
        lab.do("world-zoom-fit")
        lab.do("edit-world")
        lab.place(0, 0)  # the tools have taken some room: wait until what was painted is of that size
        return lab

    return open_world


def choose(lab, action):
    lab.do("world-menu")
    lab.choose(action)


def saved(lab, name):
    """The world as it is saved to a file."""
    choose(lab, "save-world")
    field = lab.sees('[data-lrp="world"] form input')
    field.fill(name)
    field.press("Enter")
    lab.until("form => form.hidden", '[data-lrp="world"] form')
    return json.loads((lab.notebook.path.parent / f"{name}.world.json").read_text())


def is_edited(lab):
    """Wait until the world has an edit that can be undone."""
    lab.until("button => !button.disabled", '[data-lrp-action="world-undo"]')


def click(lab, x, y):
    lab.page.mouse.click(*lab.place(x, y))


def press(lab, *keys):
    for key in keys:
        lab.page.keyboard.press(key)


def test_things_are_placed_moved_resized_turned_and_removed_with_the_mouse(open_world):
    lab = open_world()
    lab.do("tool-wall")
    lab.drag_robot((0.5, 0.5), (1.1, 0.5))
    lab.reads(".lrp-thing", "Wall")
    lab.do("tool-box")
    lab.drag_robot((2.0, 1.5), (2.4, 1.3))
    lab.reads(".lrp-thing", "Box")
    lab.do("tool-zone")
    lab.drag_robot((2.4, 0.5), (2.7, 0.5))
    lab.reads(".lrp-thing", "Zone")
    field = lab.sees('[data-lrp-action="thing-name"]')
    field.fill("harbour")
    field.press("Enter")
    world = saved(lab, "first")
    wall, box = world["solids"]
    assert wall["box"] == pytest.approx([0.8, 0.5, 0.64, 0.04], abs=0.02)
    assert "push" not in wall
    assert box["box"] == pytest.approx([2.2, 1.4, 0.4, 0.2], abs=0.02)
    assert box["push"] > 0
    assert world["zones"] == {"harbour": {"circle": pytest.approx([2.4, 0.5, 0.3], abs=0.02)}}

    lab.do("tool-move")
    lab.drag_robot((0.8, 0.5), (0.8, 0.8))  # it is selected now, with its handles
    lab.reads(".lrp-thing", "Wall")
    lab.drag_robot((1.12, 0.82), (1.42, 0.92))  # a corner
    lab.drag_robot((2.4, 0.8), (2.5, 1.0))  # the rim of the zone
    click(lab, 2.2, 1.4)
    lab.reads(".lrp-thing", "Box")
    press(lab, "Delete")
    lab.until("strip => strip.hidden", ".lrp-thing")
    world = saved(lab, "second")
    (wall,) = world["solids"]
    assert wall["box"] == pytest.approx([0.95, 0.85, 0.94, 0.14], abs=0.03)
    assert world["zones"]["harbour"]["circle"] == pytest.approx([2.5, 0.7, 0.3], abs=0.03)


def test_the_start_is_moved_and_the_robot_returns_to_it_whenever_the_world_is_reset(open_world):
    lab = open_world()
    lab.drag_robot((1.5, 1.0), (0.6, 0.6))
    click(lab, 0.6, 0.6)
    lab.do("start-here")
    is_edited(lab)
    lab.drag_robot((0.6, 0.6), (2.0, 1.5))
    lab.drag_robot((0.6, 0.6), (1.0, 0.4))  # the outline that stays at the start
    lab.do("reset-world")
    lab.goes_on()
    lab.drag_robot((1.0, 0.4), (1.3, 0.4))  # it was there, or nothing would be dragged
    click(lab, 1.3, 0.4)
    lab.reads(".lrp-thing", "Robot")
    assert saved(lab, "start")["robots"][0]["pose"][:2] == pytest.approx([1.0, 0.4], abs=0.02)


def test_everything_can_be_edited_by_keyboard(open_world):
    lab = open_world()
    lab.pause()  # or the wall, which is put in the same place, would push the box away
    canvas = lab.sees(".lrp-canvas")
    for tool, kind in ("wall", "Wall"), ("box", "Box"), ("zone", "Zone"):
        lab.sees(f'[data-lrp-action="tool-{tool}"]').focus()
        press(lab, "Space", "Enter")  # the focus is in the world now
        press(lab, "ArrowRight", "ArrowRight", "Shift+ArrowUp", "[")
        lab.until("(strip, kind) => !strip.hidden && strip.textContent.startsWith(kind)", ".lrp-thing", kind)
    press(lab, "Escape")
    lab.until("button => button.ariaPressed === 'true'", '[data-lrp-action="tool-move"]')
    canvas.focus()
    press(lab, "n", "n", "n", "ArrowUp")
    lab.reads(".lrp-thing", "Box")
    press(lab, "n", "Delete")  # the wall
    lab.until("strip => strip.hidden", ".lrp-thing")
    world = saved(lab, "keys")
    (box,) = world["solids"]
    assert box["box"] == pytest.approx([1.54, 1.02, 0.2, 0.22])
    assert box["angle"] == pytest.approx(math.radians(10), abs=1e-3)
    assert world["zones"]["goal"]["circle"] == pytest.approx([1.54, 1.0, 0.26])


def test_undo_acts_where_the_last_act_was(open_world):
    lab = open_world()
    lab.replace("waiting))", "waiting) (state other))")
    lab.until("(root, text) => root.querySelectorAll('[data-lrp-state]').length === 2")
    text = lab.text
    lab.do("tool-wall")
    lab.drag_robot((0.5, 0.5), (1.1, 0.5))
    lab.drag_robot((0.5, 1.5), (1.1, 1.5))
    is_edited(lab)
    press(lab, "Control+z")
    lab.until("button => !button.disabled", '[data-lrp-action="world-redo"]')
    press(lab, "Control+z")
    lab.until("button => button.disabled", '[data-lrp-action="world-undo"]')
    press(lab, "Control+Shift+z")
    is_edited(lab)
    assert lab.text == text
    assert len(saved(lab, "walls")["solids"]) == 1
    lab.find(".cm-content").focus()
    press(lab, "Control+z")
    lab.until("root => root.querySelectorAll('[data-lrp-state]').length === 1")
    assert len(saved(lab, "walls again")["solids"]) == 1


def test_a_saved_world_is_offered_and_a_file_is_opened(open_world):
    lab = open_world()
    lab.do("tool-draw")
    lab.drag_robot((0.3, 0.3), (1.3, 0.3))
    is_edited(lab)
    lab.reads('[data-lrp-action="world"]', "empty (edited)")
    world = saved(lab, "mine")
    assert world["floor"]["strokes"][0]["path"][0] == pytest.approx([0.3, 0.3], abs=0.02)
    world["name"] = "theirs"
    with lab.page.expect_file_chooser() as chooser:
        choose(lab, "open-world")
    chooser.value.set_files(
        {"name": "their.json", "mimeType": "application/json", "buffer": json.dumps(world).encode()}
    )
    lab.until("select => select.selectedOptions[0]?.text === 'theirs'", '[data-lrp-action="world"]')
    lab.notebook.begin_cell(1)  # the lab opens again
    again = lab.notebook.lab()
    again.sees('[data-lrp-action="world"] option[value="mine.world.json"]')


def test_the_world_is_saved_as_a_picture_and_as_a_drawing(open_world):
    lab = open_world(world="boxes")
    with lab.page.expect_download() as png:
        choose(lab, "world-png")
    assert png.value.path().read_bytes().startswith(b"\x89PNG")
    assert png.value.suggested_filename == "m-boxes.png"
    with lab.page.expect_download() as svg:
        choose(lab, "world-svg")
    assert "goal" in "".join(ElementTree.fromstring(svg.value.path().read_bytes()).itertext())


def test_a_run_beside_moving_things_is_saved_as_an_animation_that_plays(open_world):
    lab = open_world(DRIVER.replace("robot.move(0.3, 0.8)", "robot.move(linear=0.3)"), world="crossing")
    lab.sees('.lrp-legend li[title="m/aside"]')
    lab.pause()
    with lab.page.expect_download() as saved:
        choose(lab, "world-animation")
    assert saved.value.suggested_filename == "m-crossing-run.svg"
    picture = saved.value.path().read_text(encoding="utf-8")
    page = lab.page.context.new_page()
    page.set_content(picture)
    places = [
        page.evaluate(
            """seconds => {
                const svg = document.querySelector("svg");
                svg.pauseAnimations();
                svg.setCurrentTime(seconds);
                const things = [...svg.querySelectorAll('[fill="#A6CEE3"], [fill="#8fc7c3"]')];
                return things.map((each) => {
                    const { x, y } = each.getBoundingClientRect();
                    return [x, y];
                });
            }""",
            seconds,
        )
        for seconds in (0.0, 1.0)
    ]
    page.close()
    assert len(places[0]) == 3, "a robot and two carts"
    assert all(math.dist(before, after) > 5 for before, after in zip(*places, strict=True)), places


def test_the_trail_shows_the_states_and_names_them(open_world):
    lab = open_world(DRIVER)
    for state in ("ahead", "aside"):
        lab.sees(f'.lrp-legend li[title="m/{state}"]')
    lab.pause()
    lab.do("reset-world")
    choose(lab, "trail")
    lab.misses(".lrp-legend li")


def test_the_world_is_magnified_where_the_pointer_is_and_the_robot_can_be_followed(open_world):
    lab = open_world()
    before = lab.place(2.5, 1.5)
    lab.page.mouse.move(*before)
    changing(lab, lambda: lab.page.mouse.wheel(0, -300), "Control")
    assert lab.place(2.5, 1.5) == pytest.approx(before, abs=1.5)
    lab.do("world-zoom-fit")
    lab.do("world-follow")
    lab.sees('[data-lrp-action="world-follow"][aria-pressed="true"]')
    changing(lab, lambda: lab.drag_robot((1.5, 1.0), (1.5, 1.4)))


def changing(lab, act, *held):
    """Act with some keys held, and wait until something else of the world is shown."""
    before = lab.sees(".lrp-canvas").get_attribute("data-view")
    for key in held:
        lab.page.keyboard.down(key)
    act()
    lab.until("(canvas, before) => canvas.dataset.view !== before", ".lrp-canvas", before)
    for key in held:
        lab.page.keyboard.up(key)


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_axe_has_nothing_serious_against_the_world_while_it_is_edited(open_world, theme):
    lab = open_world()
    choose_theme(lab, theme)
    lab.do("tool-wall")
    lab.drag_robot((0.5, 0.5), (1.1, 0.5))
    lab.reads(".lrp-thing", "Wall")
    finds_nothing_serious(lab)
    choose_theme(lab, "light")
