"""The timeline: the whole lab shows an earlier moment, runs on from there, and tells what if."""

import re

from e2e import axe
from e2e.conftest import WINDOW
from e2e.pages import SESSION
from e2e.programs import COUNTER, FOLLOWER

PLAYHEAD = ".lrp-playhead"
BAND = ".lrp-band"
BODY = ".lrp-timeline-body"
PARTS = ("editor", "graph", "world", "variables", "timeline")
VISITS = ".lrp-timeline-visit:not([data-other])"
ODOMETER = '.lrp-members [data-key="odom.x"]'
PRESENT = f"""\
{SESSION}
session.call(session.bridge.refresh)
print(session.bridge.robot.odom.x)
"""
NAME = "a_counter_with_a_name_that_is_much_too_long_to_be_read_at_a_glance"
LONG = re.sub(r"\bn\b", NAME, COUNTER)


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


def test_the_past_of_a_counter_is_looked_at_and_the_run_goes_on_from_there(open_lab):
    lab = open_lab(COUNTER)
    lab.until("root => Number(root.dataset.lrpTick) > 40")
    lab.sees(VISITS)
    drag_the_playhead(lab)
    go_by_keys(lab)
    go_on_from_the_past(lab)
    see_edits_and_issues(lab)
    show_it_on_one_line(lab)
    keep_it_as_it_was_left(lab)
    read_values_with_long_names(lab)


def test_the_past_of_a_robot_is_asked_and_edited(open_lab):
    lab = open_lab(FOLLOWER, "follower --world line")
    lab.until("root => Number(root.dataset.lrpTick) > 60")
    lab.sees(f'{VISITS}[data-lrp-visit="follower/moving"]')
    plot_a_reading(lab)
    lab.until("root => Number(root.dataset.lrpTick) > 100")
    lab.pause()
    for tick in (101, 100):  # where its visits are does not depend on how long the page took
        lab.rewind_to(tick)
        lab.until("(head, time) => Number(head.ariaValueMax) === time", PLAYHEAD, tick / 10)
    ask_at_a_border(lab)
    see_the_robot_of_the_moment(lab)
    press(lab, "Shift+ArrowLeft")
    looks(lab)
    for theme in ("light", "dark"):
        axe.choose_theme(lab, theme)
        axe.finds_nothing_serious(lab)  # while it shows the past
    press(lab, "Escape")
    is_back(lab)
    axe.finds_nothing_serious(lab)
    axe.choose_theme(lab, "light")
    edit_the_past(lab)


def drag_the_playhead(lab):
    """All panels show the moment; the world is larger meanwhile, and then everything is where it was."""

    def places():
        return {part: lab.box(f'[data-lrp="{part}"]') for part in PARTS}

    before = places()
    drag(lab, 0.5)
    lab.ready("paused")
    looks(lab)
    lab.until(  # the last move of the drag has arrived
        "(head, band) => head.closest('.lrp-lab').querySelector(band).textContent"
        " === `Looking at ${head.ariaValueNow} s`",
        PLAYHEAD,
        f"{BAND} [role=status]",
    )
    tick = round(looks(lab) * 10) + 1
    lab.shows(tick)
    lab.has_value("m/n", str(tick))
    lab.reads(".lrp-status", f"tick {tick}")
    lab.reads(BAND, "s ago.")
    lab.reads(BAND, f"Looking at {(tick - 1) / 10:.1f} s")
    press(lab, "ArrowLeft")
    lab.shows(tick - 1)
    lab.has_value("m/n", str(tick - 1))
    during = places()
    assert during["timeline"] == before["timeline"]
    assert during["world"]["width"] * during["world"]["height"] > 1.2 * (
        before["world"]["width"] * before["world"]["height"]
    )
    press(lab, "Escape")
    is_back(lab)
    lab.ready("running")  # as it was
    assert places() == before


def go_by_keys(lab):
    lab.pause()
    last = lab.tick
    for keys, tick in [
        (["ArrowLeft"], last - 1),
        (["Shift+ArrowLeft"], last - 11),
        (["ArrowRight"], last - 10),
        (["Home"], 1),
        (["ArrowLeft"], 1),
        (["End"], last),
    ]:
        press(lab, *keys)
        lab.shows(tick)
    is_back(lab)
    press(lab, "ArrowLeft")
    assert looks(lab) == (last - 2) / 10
    assert lab.find(PLAYHEAD).get_attribute("aria-valuetext").endswith("s ago")
    assert lab.find(PLAYHEAD).evaluate("head => getComputedStyle(head).outlineStyle") == "solid"
    press(lab, "ArrowRight", "ArrowRight")
    is_back(lab)


def go_on_from_the_past(lab):
    last = lab.tick
    press(lab, "Home")
    looks(lab)
    lab.do("step")  # leads back to the present
    is_back(lab)
    lab.shows(last + 1)
    soon = lab.pause_when("condition='n == 20', machine='m'")
    press(lab, "Home")
    looks(lab)
    lab.do("run-from")
    is_back(lab)
    lab.is_paused_by(soon)
    assert lab.tick == 20 < last
    lab.do("run")


def see_edits_and_issues(lab):
    lab.goes_on()
    lab.replace("1000", "2000")
    lab.has_value("limit", "2000")
    lab.pause()
    edit = '[data-lrp-mark="edit"]'
    lab.at_rest(edit)
    lab.find(edit).first.click(position={"x": 1, "y": 7})  # others may be beside it
    looks(lab)
    lab.replace("n = n + 1", "n = n + 1 / 0")
    lab.do("run")
    is_back(lab)
    lab.sees('[data-lrp-mark="issue"] title')


def show_it_on_one_line(lab):
    """Where there is little room it is one line, which still says that the past is shown."""
    lab.page.set_viewport_size({"width": 700, "height": 900})
    lab = lab.notebook.open(COUNTER, "narrow")
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


def keep_it_as_it_was_left(lab):
    """It stays closed, and keeps its plots, when the page is loaded again."""
    lab.page.set_viewport_size(WINDOW)
    lab.do("timeline")
    lab.sees(VISITS)
    lab.do("plot")
    lab.choose("plot-m/n")
    lab.sees('[data-lrp-plot="m/n"]')
    lab.do("timeline")
    lab.until("body => body.hidden", BODY)
    lab.notebook.save()
    lab.page.reload()
    lab.notebook.ready()
    lab.notebook.begin_cell(1)
    lab.ready().goes_on()
    assert not lab.find(BODY).is_visible()
    lab.do("timeline")
    lab.sees('[data-lrp-plot="m/n"]')


def read_values_with_long_names(lab):
    """The values at the playhead stay in sight, however long their names."""
    lab = lab.notebook.open(LONG, "long")
    lab.until("root => Number(root.dataset.lrpTick) > 40")
    lab.page.set_viewport_size({"width": 900, "height": 900})
    if not lab.find(BODY).is_visible():
        lab.do("timeline")
    lab.do("timeline-in")
    lab.do("plot")
    lab.choose(f"plot-m/{NAME}")
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


def plot_a_reading(lab):
    """The value of an event shows its past; plotted, it has the thresholds of all conditions that read it."""
    lab.select("(event outofline")
    value = lab.find('.lrp-values [data-lrp-history*="outofline"]')
    value.hover()
    lab.reads(".lrp-history-card .lrp-timeline-limit", "lightlim + 10")
    value.click()
    lab.until("path => path.getAttribute('d').length > 100", f"{BODY} .lrp-timeline-curve")
    lab.page.keyboard.press("Shift+Alt+H")
    lab.reads('[role="dialog"] .lrp-timeline-limit', "lightlim + 10")
    lab.sees('[role="dialog"] [data-lrp-action="pin"][aria-pressed="true"]')
    lab.page.keyboard.press("Escape")
    limits = lab.find(f"{BODY} .lrp-timeline-limit")
    assert sorted(limits.all_text_contents()) == ["lightlim + 10", "lightlim - 10"]
    press(lab, "ArrowLeft")
    looks(lab)
    assert "light.data" in lab.find(PLAYHEAD).get_attribute("data-label")
    press(lab, "Escape")
    is_back(lab)


def see_the_robot_of_the_moment(lab):
    shows_the_present(lab)
    now = lab.find(ODOMETER).text_content()
    for _ in range(3):
        lab.do("timeline-in")  # visits of a tick are wide enough to aim at
    visits = lab.find(f'{VISITS}[data-lrp-visit="follower/looking"]')
    visits.nth(1).click(button="right")  # the first may end where the window begins
    lab.choose("look")
    looks(lab)
    lab.is_active("follower/looking")
    lab.until("(row, now) => row.textContent !== now", ODOMETER, now)
    press(lab, "Escape")
    is_back(lab)
    shows_the_present(lab)


def shows_the_present(lab):
    """Wait until the odometer shows where the robot is."""
    lab.until(
        "(row, x) => Math.abs(/([-\\d.]+) m$/.exec(row.textContent)?.[1] - x) < 0.001",
        ODOMETER,
        float(lab.notebook.kernel(PRESENT)),
    )


def ask_at_a_border(lab):
    """A border of two visits says why the transition fired, and shows that moment."""
    area, visit = lab.box(".lrp-timeline-area"), lab.find(f'{VISITS}[data-by="follower:tmoving"]').first
    x, y = (float(visit.get_attribute(name)) for name in ("x", "y"))
    lab.page.mouse.click(area["x"] + x + 1, area["y"] + y + 5)
    lab.sees('.lrp-why[data-code="fired"]')
    lab.reads(".lrp-why-sentence", "tmoving")
    lab.reads(".lrp-why .lrp-title", "Why tmoving?")
    looks(lab)
    lab.do("close-why")
    press(lab, "Escape")
    is_back(lab)


def edit_the_past(lab):
    """The other course is shown, where there is room already, and runs on from there."""
    height = lab.box('[data-lrp="timeline"]')["height"]
    press(lab, "Home")
    looks(lab)
    lab.replace("forward := [0.2]", "forward := [0.05]")
    lab.until("head => head.dataset.label.includes('with the edit, from ')", PLAYHEAD)
    lab.sees(".lrp-timeline-divergence")
    assert lab.find(".lrp-timeline-visit[data-other]").count() > 0
    assert lab.box('[data-lrp="timeline"]')["height"] == height
    lab.sees(".lrp-world-body[data-what-if]")
    lab.reads(BAND, "with the edit")
    lab.do("run-from")
    is_back(lab)
    lab.misses(".lrp-timeline-divergence")
    lab.has_value("forward", "0.05")
    assert "forward := [0.05]" in lab.text
