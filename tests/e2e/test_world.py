"""The world in the page: edited by mouse and keyboard, saved, watched; what will be, and what was."""

import json
import math
import xml.etree.ElementTree as ElementTree

import pytest
from support.waiting import until

from e2e import axe
from e2e.pages import SESSION

STILL = "(machine m (state waiting)) (spawn m waiting)"
DRIVER = """\
(machine m
  (state ahead (running [robot.move(linear=0.3)]))
  (state aside (running [robot.move(0.2, 0.8)]))
  (ontime 1000 ahead -> aside)
  (ontime 1000 aside -> ahead))
(spawn m ahead)
"""
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
DRIVES = STANDS.replace("0.0", "0.2")
AT_START = f"""\
{SESSION}
x, y, _ = session.bridge.simulation.robot.pose
print(session.frame.tick * (abs(x - 1.0) < 0.05 > abs(y - 0.4)))
"""
WORLD = ".lrp-world-body"
AHEAD = ".lrp-world-ahead"
WORLDS = '[data-lrp-action="world"]'
THING = ".lrp-thing"


def test_a_world_is_edited_by_mouse_and_keyboard_saved_and_opened(open_lab):
    lab = edited(open_lab(STILL, "m --world empty"))
    move_the_start(lab)
    edit_by_mouse(lab)
    for theme in ("dark", "light"):
        axe.choose_theme(lab, theme)
        axe.finds_nothing_serious(lab)
    lab = edited(lab.notebook.open(STILL, "undo --world empty"))
    undo_where_the_last_act_was(lab)
    magnify(lab)
    open_worlds(lab)
    edit_by_keyboard(edited(lab.notebook.open(STILL, "keys --world empty")))


def test_a_world_is_watched_and_tells_what_will_be_and_what_was(open_lab):
    lab = seen(open_lab(DRIVER, "m --world crossing"))
    save_pictures(lab)
    clear_the_trail(lab)
    see_a_collision_ahead(seen(lab.notebook.open(STANDS, "stands --world line")))
    see_a_preview_end(seen(lab.notebook.open(CURVES, "curves --world empty")))
    look_back_along_the_trail(seen(lab.notebook.open(DRIVES, "drives --world line")))


def seen(lab):
    """See all of the world."""
    lab.sees(".lrp-canvas[data-view]").scroll_into_view_if_needed()
    lab.do("world-zoom-fit")
    return lab


def edited(lab):
    """Open the tools, and see all of the world."""
    seen(lab).do("edit-world")
    lab.place(0, 0)  # the tools have taken some room: wait until what was painted is of that size
    return lab


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
    lab.sees(f'[data-lrp-action="world"] option[value="{name}.world.json"]')
    return json.loads((lab.notebook.path.parent / f"{name}.world.json").read_text())


def is_edited(lab):
    """Wait until the world has an edit that can be undone."""
    lab.until("button => !button.disabled", '[data-lrp-action="world-undo"]')


def click(lab, x, y):
    lab.page.mouse.click(*lab.place(x, y))


def press(lab, *keys):
    for key in keys:
        lab.page.keyboard.press(key)


# -- edited ----------------------------------------------------------------------------------------


def move_the_start(lab):
    """The robot returns to its start whenever the world is reset."""
    lab.drag_robot((1.5, 1.0), (0.6, 0.6))
    lab.reads(THING, "Robot")
    lab.do("start-here")
    is_edited(lab)
    lab.drag_robot((0.6, 0.6), (2.0, 1.5))
    lab.drag_robot((0.6, 0.6), (1.0, 0.4))  # the outline that stays at the start
    lab.do("reset-world")
    tick = until(lambda: int(lab.notebook.kernel(AT_START)), "the robot is at its start")
    lab.until("(root, tick) => Number(root.dataset.lrpTick) > tick", argument=tick)
    lab.sees(".lrp-canvas").focus()
    press(lab, "Escape")
    lab.until("strip => strip.hidden", THING)
    lab.drag_robot((1.0, 0.4), (1.3, 1.7))  # it was there, or nothing would be selected
    lab.reads(THING, "Robot")
    assert saved(lab, "start")["robots"][0]["pose"][:2] == pytest.approx([1.0, 0.4], abs=0.02)


def edit_by_mouse(lab):
    """Place things, move, resize, turn and remove them."""
    lab.do("tool-wall")
    lab.drag_robot((0.5, 0.9), (1.1, 0.9))
    lab.reads(THING, "Wall")
    lab.do("tool-box")
    lab.drag_robot((2.0, 1.5), (2.4, 1.3))
    lab.reads(THING, "Box")
    lab.do("tool-zone")
    lab.drag_robot((2.4, 0.5), (2.7, 0.5))
    lab.reads(THING, "Zone")
    field = lab.sees('[data-lrp-action="thing-name"]')
    field.fill("harbour")
    field.press("Enter")
    world = saved(lab, "first")
    wall, box = world["solids"]
    assert wall["box"] == pytest.approx([0.8, 0.9, 0.64, 0.04], abs=0.02)
    assert "push" not in wall
    assert box["box"] == pytest.approx([2.2, 1.4, 0.4, 0.2], abs=0.02)
    assert box["push"] > 0
    assert world["zones"] == {"harbour": {"circle": pytest.approx([2.4, 0.5, 0.3], abs=0.02)}}

    lab.do("tool-move")
    lab.drag_robot((0.8, 0.9), (0.8, 1.2))  # it is selected now, with its handles
    lab.reads(THING, "Wall")
    lab.drag_robot((1.12, 1.22), (1.42, 1.32))  # a corner
    lab.drag_robot((2.4, 0.8), (2.5, 1.0))  # the rim of the zone
    click(lab, 2.2, 1.4)
    lab.reads(THING, "Box")
    press(lab, "Delete")
    lab.until("strip => strip.hidden", THING)
    world = saved(lab, "second")
    (wall,) = world["solids"]
    assert wall["box"] == pytest.approx([0.95, 1.25, 0.94, 0.14], abs=0.03)
    assert world["zones"]["harbour"]["circle"] == pytest.approx([2.5, 0.7, 0.3], abs=0.03)
    click(lab, 0.95, 1.25)
    lab.reads(THING, "Wall")


def edit_by_keyboard(lab):
    lab.pause()  # or the wall, which is put in the same place, would push the box away
    canvas = lab.sees(".lrp-canvas")
    for tool, kind in ("wall", "Wall"), ("box", "Box"), ("zone", "Zone"):
        lab.sees(f'[data-lrp-action="tool-{tool}"]').focus()
        press(lab, "Space", "Enter")  # the focus is in the world now
        press(lab, "ArrowRight", "ArrowRight", "Shift+ArrowUp", "[")
        lab.until("(strip, kind) => !strip.hidden && strip.textContent.startsWith(kind)", THING, kind)
    press(lab, "Escape")
    lab.until("button => button.ariaPressed === 'true'", '[data-lrp-action="tool-move"]')
    canvas.focus()
    press(lab, "n", "n", "n", "ArrowUp")
    lab.reads(THING, "Box")
    press(lab, "n", "Delete")  # the wall
    lab.until("strip => strip.hidden", THING)
    world = saved(lab, "keys")
    (box,) = world["solids"]
    assert box["box"] == pytest.approx([1.54, 1.02, 0.2, 0.22])
    assert box["angle"] == pytest.approx(math.radians(10), abs=1e-3)
    assert world["zones"]["goal"]["circle"] == pytest.approx([1.54, 1.0, 0.26])


def undo_where_the_last_act_was(lab):
    lab.replace("waiting))", "waiting) (state other))")
    lab.until("root => root.querySelectorAll('[data-lrp-state]').length === 2")
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
    lab.do("tool-move")


def magnify(lab):
    """The world is magnified where the pointer is, and the robot can be followed."""
    before = lab.place(2.5, 1.5)
    lab.page.mouse.move(*before)
    changing(lab, lambda: lab.page.mouse.wheel(0, -300), "Control")
    assert lab.place(2.5, 1.5) == pytest.approx(before, abs=1.5)
    lab.do("world-zoom-fit")
    lab.do("world-follow")
    lab.sees('[data-lrp-action="world-follow"][aria-pressed="true"]')
    changing(lab, lambda: lab.drag_robot((1.5, 1.0), (1.5, 1.4)))
    lab.do("world-zoom-fit")


def changing(lab, act, *held):
    """Act with some keys held, and wait until something else of the world is shown."""
    before = lab.sees(".lrp-canvas").get_attribute("data-view")
    for key in held:
        lab.page.keyboard.down(key)
    act()
    lab.until("(canvas, before) => canvas.dataset.view !== before", ".lrp-canvas", before)
    for key in held:
        lab.page.keyboard.up(key)


def open_worlds(lab):
    """A saved world is offered, and a file is opened."""
    lab.do("tool-draw")
    lab.drag_robot((0.3, 0.3), (1.3, 0.3))
    lab.reads(WORLDS, "empty (edited)")
    world = saved(lab, "mine")
    assert world["floor"]["strokes"][0]["path"][0] == pytest.approx([0.3, 0.3], abs=0.02)
    world["name"] = "theirs"
    with lab.page.expect_file_chooser() as chooser:
        choose(lab, "open-world")
    chooser.value.set_files(
        {"name": "their.json", "mimeType": "application/json", "buffer": json.dumps(world).encode()}
    )
    lab.until("select => select.selectedOptions[0]?.text === 'theirs'", WORLDS)
    lab.notebook.run_cell(1)  # the lab opens again
    lab.sees(f'{WORLDS} option[value="mine.world.json"]')


# -- watched ---------------------------------------------------------------------------------------


def save_pictures(lab):
    """The world is saved as a picture and a drawing, and a run as an animation that plays."""
    for state in ("ahead", "aside"):
        lab.sees(f'.lrp-legend li[title="m/{state}"]')
    lab.pause()
    pictures = []
    for key in ("Escape", "n"):  # it shows no handles of what is selected
        lab.find(".lrp-canvas").press(key)
        with lab.page.expect_download() as png:
            choose(lab, "world-png")
        pictures.append(png.value.path().read_bytes())
    assert lab.find(".lrp-thing").is_visible()
    assert pictures[0].startswith(b"\x89PNG")
    assert pictures[0] == pictures[1]
    assert png.value.suggested_filename == "m-crossing.png"
    with lab.page.expect_download() as svg:
        choose(lab, "world-svg")
    assert "goal" in "".join(ElementTree.fromstring(svg.value.path().read_bytes()).itertext())
    with lab.page.expect_download() as run:
        choose(lab, "world-animation")
    assert run.value.suggested_filename == "m-crossing-run.svg"
    page = lab.page.context.new_page()
    page.set_content(run.value.path().read_text(encoding="utf-8"))
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


def clear_the_trail(lab):
    lab.do("reset-world")
    choose(lab, "trail")
    lab.misses(".lrp-legend li")
    choose(lab, "trail")


def drive_into_the_wall(lab, old="0.0", new="-0.1"):
    """Turn the robot, which stands before a wall, into a robot that drives against it."""
    revision = lab.revision
    lab.replace(f"linear={old}", f"linear={new}")
    lab.until("(root, revision) => Number(root.dataset.lrpRevision) > revision", argument=revision)


def see_a_collision_ahead(lab):
    """An edit shows where it leads, and the collision before it happens; without previews, nothing."""
    lab.goes_on()
    lab.pause()
    lab.misses(f"{WORLD}[data-what-if]")
    choose(lab, "preview")
    drive_into_the_wall(lab)
    tick = lab.tick
    lab.do("step")
    lab.until("(root, tick) => Number(root.dataset.lrpTick) > tick", argument=tick)
    assert lab.find(f"{WORLD}[data-what-if]").count() == 0
    assert lab.find(AHEAD).inner_text() == ""
    choose(lab, "preview")
    drive_into_the_wall(lab, "-0.1", "-0.11")
    lab.sees(f"{WORLD}[data-what-if]")
    lab.reads(AHEAD, "The robot touches near wall")
    axe.finds_nothing_serious(lab)
    tick = lab.tick
    lab.do("run")
    lab.misses(f"{WORLD}[data-what-if]")
    lab.until("sentence => sentence.textContent === ''", AHEAD)
    assert lab.tick > tick + 20  # it was told seconds before


def see_a_preview_end(lab):
    """A preview of a running program is shown until its end: of a number, with three values."""
    lab.goes_on()
    lab.select("-1.0")
    lab.page.keyboard.press("Alt+ArrowUp")
    lab.page.keyboard.press("Alt+ArrowUp")
    for name in ("before -1.0", "now -0.89", "next -0.88"):
        lab.sees(f'.lrp-legend span:text-is("{name}")')
    lines = lab.find(".lrp-legend .lrp-swatch").evaluate_all(
        "all => all.slice(0, 3).map(swatch => getComputedStyle(swatch).borderTopStyle)"
    )
    assert lines == ["dashed", "solid", "dotted"], "as the courses"
    edge = lab.place(0, 0)[1]
    for over in (".lrp-legend li", ".lrp-world-time"):
        box = lab.box(over)
        assert box["y"] + box["height"] < edge, "the edge of the world is not interrupted"
    axe.finds_nothing_serious(lab)
    lab.page.keyboard.press("ArrowRight")  # the number is put down
    lab.sees(f"{WORLD}[data-what-if]")
    lab.misses(f"{WORLD}[data-what-if]")


def look_back_along_the_trail(lab):
    """A click on the trail shows that moment, and a drag the present again."""
    lab.goes_on()
    lab.pause()
    lab.sees(WORLDS).select_option(label="empty")  # where time begins again
    lab.until("list => list.selectedOptions[0]?.text === 'empty'", WORLDS)
    lab.do("world-zoom-fit")
    begin = lab.tick
    lab.do("run")
    lab.until("(root, tick) => Number(root.dataset.lrpTick) >= tick", argument=begin + 25)
    lab.pause()
    lab.rewind_to(now := begin + 25)  # before it has reached the wall
    mouse = lab.page.mouse
    mouse.move(*lab.place(1.7, 1.0))
    lab.reads(".lrp-tip", "click to look")
    mouse.click(*lab.place(1.7, 1.0))
    lab.sees(f"{WORLD}[data-looking]")
    assert 8 <= lab.tick - begin <= 14  # it drives 2 cm in a tick, once it has started
    mouse.click(*lab.place(1.7, 1.0))
    lab.reads(THING, "Robot")  # as it was

    lab.drag_robot((1.7, 1.0), (1.7, 1.6))
    lab.misses(f"{WORLD}[data-looking]")
    assert lab.tick == now
    lab.page.keyboard.press("Escape")
    lab.until("strip => strip.hidden", THING)
    mouse.click(*lab.place(1.5 + 0.02 * (now - begin - 1), 1.0))
    lab.until("strip => !strip.hidden && strip.textContent.includes('Robot')", THING)  # nothing has moved it
