"""The timeline: the whole lab shows an earlier moment, runs on from there, and tells what if."""

import pytest

from e2e import axe
from e2e.programs import COUNTER, FOLLOWER

PLAYHEAD = ".lrp-playhead"
BAND = ".lrp-band"
BODY = ".lrp-timeline-body"
PARTS = ("editor", "tree", "graph", "world", "variables", "issues", "timeline")
VISITS = ".lrp-timeline-visit:not([data-other])"


@pytest.fixture
def follower(open_lab):
    """A follower that has driven for some seconds."""
    lab = open_lab(FOLLOWER, "follower --world line")
    lab.until("root => Number(root.dataset.lrpTick) > 60")
    lab.sees(f'{VISITS}[data-lrp-visit="follower/moving"]')
    return lab


@pytest.fixture
def counter(open_lab):
    lab = open_lab(COUNTER)
    lab.until("root => Number(root.dataset.lrpTick) > 40")
    lab.sees(VISITS)
    return lab


def looks(lab):
    """Wait until the lab shows an earlier moment; return its time in seconds."""
    lab.sees("css=:scope[data-looking]")
    return float(
        lab.find(f"{BAND} [role=status]").inner_text().removeprefix("Looking at ").removesuffix(" s")
    )


def is_back(lab):
    lab.sees("css=:scope:not([data-looking])")


def press(lab, *keys):
    lab.find(PLAYHEAD).focus()
    for key in keys:
        lab.page.keyboard.press(key)


def drag(lab, share):
    """Drag the playhead to a share of the recorded time."""
    head = lab.box(PLAYHEAD)
    first = lab.box(VISITS)["x"]
    x, y = head["x"] + head["width"] / 2, head["y"] + 10
    mouse = lab.page.mouse
    mouse.move(x, y)
    mouse.down()
    mouse.move(first + share * (x - first), y, steps=6)
    mouse.up()


def test_dragging_the_playhead_shows_the_moment_in_all_panels(counter):
    lab = counter
    drag(lab, 0.5)
    lab.ready("paused")
    at = "(root, tick) => Number(root.dataset.lrpTick) === tick"
    looks(lab)
    lab.page.wait_for_timeout(500)  # the last moves of the drag arrive
    tick = lab.tick
    lab.has_value("m/n", str(tick - 1))  # the first tick only enters the state
    lab.reads(".lrp-status", f"tick {tick}")
    lab.reads(BAND, "s ago.")
    lab.reads(BAND, f"Looking at {(tick - 1) / 10:.1f} s")
    press(lab, "ArrowLeft")
    lab.until(at, argument=tick - 1)
    lab.has_value("m/n", str(tick - 2))


def test_the_graph_and_the_robot_are_those_of_the_moment(follower):
    lab = follower
    lab.pause()
    lab.page.wait_for_timeout(500)  # the last readings arrive
    now = place(lab)
    for _ in range(3):
        lab.do("timeline-in")  # visits of a tick are wide enough to aim at
    lab.find(f'{VISITS}[data-lrp-visit="follower/looking"]').last.click(button="right")
    lab.choose("look")
    looks(lab)
    lab.is_active("follower/looking")
    lab.until("(row, now) => row.textContent !== now", ODOMETER, now)
    press(lab, "Escape")
    is_back(lab)
    lab.until("(row, now) => row.textContent === now", ODOMETER, now)


ODOMETER = '.lrp-members [data-key="odom.x"]'


def place(lab):
    """Where the robot is said to be."""
    return lab.sees(ODOMETER).text_content()


def test_the_keys_move_tick_by_tick_and_lead_back(counter):
    lab = counter
    lab.pause()
    last = lab.tick
    at = "(root, tick) => Number(root.dataset.lrpTick) === tick"
    for keys, tick in [
        (["ArrowLeft"], last - 1),
        (["Shift+ArrowLeft"], last - 11),
        (["ArrowRight"], last - 10),
        (["Home"], 1),
        (["ArrowLeft"], 1),
        (["End"], last),
    ]:
        press(lab, *keys)
        lab.until(at, argument=tick)
    is_back(lab)
    press(lab, "ArrowLeft")
    assert looks(lab) == (last - 2) / 10
    assert lab.find(PLAYHEAD).get_attribute("aria-valuetext").endswith("s ago")
    press(lab, "ArrowRight", "ArrowRight")
    is_back(lab)


def test_the_run_goes_on_from_the_moment(counter):
    lab = counter
    lab.pause()
    last = lab.tick
    press(lab, "Home")
    looks(lab)
    lab.do("run-from")
    is_back(lab)
    lab.ready("running")
    lab.pause()
    assert lab.tick < last


def test_a_run_leads_back_to_the_present(counter):
    lab = counter
    lab.pause()
    last = lab.tick
    press(lab, "Home")
    looks(lab)
    lab.do("step")
    is_back(lab)
    lab.until("(root, tick) => Number(root.dataset.lrpTick) > tick", argument=last)


def test_an_edit_of_the_past_shows_the_other_course_and_runs_on_from_there(follower):
    lab = follower
    press(lab, "Home")
    looks(lab)
    lab.replace("forward := [0.2]", "forward := [0.05]")
    lab.reads(".lrp-timeline-other", "with the edit: ")
    lab.sees(".lrp-timeline-divergence")
    assert lab.find(".lrp-timeline-visit[data-other]").count() > 0
    lab.sees(".lrp-world-body[data-what-if]")
    lab.reads(BAND, "with the edit")
    lab.do("run-from")
    is_back(lab)
    lab.misses(".lrp-timeline-divergence")
    lab.has_value("forward", "0.05")
    assert "forward := [0.05]" in lab.text


def test_a_border_in_the_timeline_says_why_the_transition_fired(follower):
    lab = follower
    lab.pause()
    area, visit = lab.box(".lrp-timeline-area"), lab.find(f'{VISITS}[data-by="follower:tmoving"]').first
    x, y = (float(visit.get_attribute(name)) for name in ("x", "y"))
    lab.page.mouse.click(area["x"] + x + 1, area["y"] + y + 5)
    lab.sees('.lrp-why[data-code="fired"]')
    lab.reads(".lrp-why-sentence", "tmoving")
    lab.reads(".lrp-why .lrp-title", "Why tmoving?")
    looks(lab)


def test_a_reading_is_plotted_with_the_threshold_of_its_condition(follower):
    lab = follower
    lab.do("plot")
    lab.choose("plot-robot.light.data")
    lab.until("path => path.getAttribute('d').length > 100", ".lrp-timeline-curve")
    limits = lab.find(".lrp-timeline-limit")
    assert sorted(limits.all_text_contents()) == ["lightlim + 10", "lightlim - 10"]
    press(lab, "ArrowLeft")
    looks(lab)
    assert "light.data" in lab.find(PLAYHEAD).get_attribute("data-label")


def test_the_values_at_the_playhead_stay_in_sight_however_long_their_names(page, open_lab):
    page.set_viewport_size({"width": 900, "height": 900})
    name = "a_counter_with_a_name_that_is_much_too_long_to_be_read_at_a_glance"
    lab = open_lab(
        COUNTER.replace("n := ", f"{name} := ")
        .replace("[n = n + 1]", f"[{name} += 1]")
        .replace("n > ", f"{name} > ")
    )
    lab.until("root => Number(root.dataset.lrpTick) > 40")
    lab.do("timeline")
    lab.do("timeline-in")
    lab.do("plot")
    lab.choose(f"plot-m/{name}")
    for key in ("Shift+ArrowLeft", "Shift+ArrowLeft", "Shift+ArrowLeft"):
        press(lab, key)
        looks(lab)
        lab.until(
            "head => { const label = getComputedStyle(head, '::after');"
            " const { left, right } = head.parentElement.getBoundingClientRect();"
            " const at = head.getBoundingClientRect().left + head.offsetWidth / 2;"
            " const room = head.hasAttribute('data-right') ? at - left : right - at;"
            " return parseFloat(label.width) > 50 && parseFloat(label.width) <= room + 1; }",
            PLAYHEAD,
        )


def test_an_edit_and_an_issue_are_marked(counter):
    lab = counter
    lab.replace("[1000]", "[2000]")
    lab.pause()
    lab.page.wait_for_timeout(500)  # nothing moves any more
    lab.find('[data-lrp-mark="edit"]').first.click(position={"x": 1, "y": 7})  # others may be beside it
    looks(lab)
    lab.replace("n = n + 1", "n = n + 1 / 0")
    lab.do("run")
    is_back(lab)
    lab.sees('[data-lrp-mark="issue"] title')


def test_nothing_moves_when_the_past_is_shown(counter):
    lab = counter
    lab.pause()
    before = {part: lab.box(f'[data-lrp="{part}"]') for part in PARTS}
    press(lab, "Home")
    looks(lab)
    assert {part: lab.box(f'[data-lrp="{part}"]') for part in PARTS} == before


def test_where_there_is_little_room_it_is_one_line_that_still_says_that_the_past_is_shown(page, open_lab):
    page.set_viewport_size({"width": 700, "height": 900})
    lab = open_lab(COUNTER)
    lab.goes_on()
    assert not lab.find(BODY).is_visible()
    lab.do("timeline")
    lab.sees(VISITS)
    press(lab, "ArrowLeft")
    looks(lab)
    lab.do("timeline")
    assert not lab.find(BODY).is_visible()
    assert lab.find(BAND).is_visible()
    assert lab.root.evaluate("root => root.scrollWidth <= root.clientWidth")
    lab.do("back-to-now")
    is_back(lab)
    lab.ready("running")


def test_it_stays_as_it_was_left_and_so_do_its_plots(counter):
    lab = counter
    lab.do("plot")
    lab.choose("plot-m/n")
    lab.sees('[data-lrp-plot="m/n"]')
    lab.do("timeline")
    lab.until("body => body.hidden", BODY)
    lab.notebook.save()
    lab.page.reload()
    lab.notebook.ready()
    lab.notebook.begin_cell(1)
    again = lab.notebook.lab().ready()
    again.goes_on()
    assert not again.find(BODY).is_visible()
    again.do("timeline")
    again.sees('[data-lrp-plot="m/n"]')


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_nothing_serious_is_found_in_it(follower, theme):
    lab = follower
    axe.choose_theme(lab, theme)
    axe.finds_nothing_serious(lab)
    press(lab, "Shift+ArrowLeft")
    looks(lab)
    axe.finds_nothing_serious(lab)
