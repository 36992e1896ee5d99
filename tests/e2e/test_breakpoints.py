"""Breakpoints: set in the graph, in the text and in the list, and why the program paused."""

from e2e import axe
from e2e.programs import VISITS

BLINK = VISITS.replace(
    "(on [steps < 0] here -> there tgo)", "(ontime 700 here -> there tgo)\n  (ontime 700 there -> here tback)"
)


def paused_by(lab, words):
    """Wait until the foot says why the program paused."""
    lab.sees('.lrp-status .lrp-dot[data-status="paused"]')
    lab.sees(f".lrp-paused-by:has-text('{words}')")


def test_a_state_and_a_transition_are_watched_from_the_graph(open_lab):
    lab = open_lab(BLINK)
    lab.is_active("m/here")
    lab.state("m/there").click(button="right")
    assert lab.find('[role="menuitem"]').first.inner_text() == "Transition here"
    lab.choose("pause-entered")
    paused_by(lab, "there was entered (breakpoint 1, ")
    lab.sees('[data-lrp-state="m/there"] > .lrp-breakpoint[data-dot="on"]')
    lab.find(".lrp-paused-by").click()
    lab.sees(".cm-activeLine:has-text('state there')")
    lab.state("m/there").click(button="right")
    lab.sees('[data-lrp-action="pause-entered"][aria-checked="true"]')
    lab.choose("pause-entered")
    lab.misses(".lrp-breakpoint")
    lab.find('[data-lrp-transition="m:tback"]').first.focus()
    lab.page.keyboard.press("m")
    lab.choose("pause-fired")
    lab.do("run")
    paused_by(lab, "tback fired (breakpoint 2, 1st time).")
    lab.sees('[data-lrp-transition="m:tback"] > .lrp-breakpoint')


def press_gutter(lab, line, x):
    """Press the gutter beside a line: its dot is at the left, its question mark at the right."""
    text = lab.sees(f".cm-line:has-text('{line}')").bounding_box()
    gutter = lab.find(".lrp-breakpoint-gutter").bounding_box()
    place = gutter["x"] + x, text["y"] + text["height"] / 2
    lab.page.mouse.move(*place)
    lab.sees(".lrp-gutter-why[data-asks]")
    lab.page.mouse.click(*place)


def test_the_gutter_sets_breakpoints_and_asks_why(open_lab):
    lab = open_lab(BLINK)
    lab.is_active("m/here")
    lab.select("here tback")
    lab.page.keyboard.press("Control+F8")
    paused_by(lab, "tback fired (breakpoint 1, 1st time).")
    lab.sees('.lrp-breakpoint-gutter .lrp-breakpoint-dot[data-dot="on"]')
    press_gutter(lab, "ontime 700 here", 19)
    lab.sees(".lrp-why .lrp-why-sentence code")
    assert lab.find(".lrp-why").get_attribute("aria-label") == "Why not tgo?"
    lab.page.keyboard.press("Escape")
    press_gutter(lab, "ontime 700 there", 6)
    lab.misses('.lrp-breakpoint-gutter [data-dot="on"]')
    lab.misses(".lrp-graph .lrp-breakpoint")
    lab.select("state there")
    lab.page.keyboard.press("Alt+F8")
    lab.sees(".lrp-why[aria-label='Why there?']")


def test_the_list_takes_a_condition_and_changes_breakpoints(open_lab):
    lab = open_lab(BLINK)
    lab.is_active("m/here")
    lab.find(".lrp-breakpoint-list > summary").click()
    field = lab.find(".lrp-condition input")
    field.fill("visits = 3")
    field.press("Enter")
    lab.sees(".lrp-condition .lrp-error:has-text('not an expression')")
    field.fill("visits % 2 == 1")  # it becomes True again and again, however long the page takes
    field.press("Enter")
    paused_by(lab, "visits % 2 == 1 became True (breakpoint 1, 1st time).")
    lab.sees(".lrp-breakpoint-item:has-text('1 hit')")
    lab.find("[data-lrp-action=breakpoint-on]").uncheck()
    lab.do("remove-breakpoint")
    lab.misses(".lrp-breakpoint-item")
    field.fill("missing > 1")
    field.press("Enter")
    lab.sees(".lrp-breakpoint-item .lrp-error:has-text('missing')")
    axe.finds_nothing_serious(lab)


def test_the_list_is_in_sight_once_it_is_open_however_low_the_panel(page, open_lab):
    page.set_viewport_size({"width": 1280, "height": 800})
    lab = open_lab(BLINK.replace("(state here", "(event unused [visits > 9])\n  (state here"))
    lab.sees(".lrp-issue")
    for line in ("here tback", "there tgo"):
        lab.select(line)
        lab.page.keyboard.press("Control+F8")
    lab.sees(".lrp-breakpoint-item >> nth=1")
    panel = lab.box('[data-lrp="issues"]')
    for selector in (".lrp-breakpoint-list > summary", ".lrp-breakpoint-item > .lrp-link"):
        box = lab.box(selector)
        assert panel["y"] <= box["y"]
        assert box["y"] + box["height"] <= panel["y"] + panel["height"]
    lab.find(".lrp-condition input").focus()  # the last of the list
    box = lab.box(".lrp-condition")
    assert box["y"] + box["height"] <= panel["y"] + panel["height"] + 1


def test_a_breakpoint_is_kept_over_an_edit_and_a_reset(open_lab):
    lab = open_lab(BLINK)
    lab.is_active("m/here")
    lab.state("m/there").click(button="right")
    lab.choose("pause-left")
    lab.sees('[data-lrp-state="m/there"] > .lrp-breakpoint')
    lab.replace("visits = visits + 1", "visits = visits + 2")
    lab.do("reset")
    lab.sees('[data-lrp-state="m/there"] > .lrp-breakpoint')


def test_the_dots_stay_while_a_bracket_is_open(open_lab):
    lab = open_lab(BLINK)
    lab.is_active("m/here")
    for line in ("here tback", "state there"):
        lab.select(line)
        lab.page.keyboard.press("Control+F8")
    dots = '.lrp-breakpoint-gutter [data-dot="on"]'
    lab.until("(root, dots) => root.querySelectorAll(dots).length === 2", argument=dots)
    lab.type_after("(machine m", "(")
    lab.page.keyboard.press("Delete")  # the bracket that closed it
    lab.reads('[data-lrp="editor"]', "error")
    assert lab.find(dots).count() == 2
    place = lab.find(dots).first.bounding_box()
    lab.page.mouse.click(place["x"] + place["width"] / 2, place["y"] + place["height"] / 2)
    lab.until("(root, dots) => root.querySelectorAll(dots).length === 1", argument=dots)
