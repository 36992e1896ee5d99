"""Breakpoints: set in the graph, in the text and in the list, and why the program paused."""

from e2e import axe
from e2e.programs import VISITS

BLINK = VISITS.replace(
    "(on [steps < 0] here -> there tgo)", "(ontime 700 here -> there tgo)\n  (ontime 700 there -> here tback)"
)
DOTS = '.lrp-breakpoint-gutter [data-dot="on"]'


def paused_by(lab, words):
    """Wait until the foot says why the program paused."""
    lab.sees('.lrp-status .lrp-dot[data-status="paused"]')
    lab.sees(f".lrp-paused-by:has-text('{words}')")


def press_gutter(lab, line, x):
    """Press the gutter beside a line: its dot is at the left, its question mark at the right."""
    text = lab.sees(f".cm-line:has-text('{line}')").bounding_box()
    gutter = lab.find(".lrp-breakpoint-gutter").bounding_box()
    place = gutter["x"] + x, text["y"] + text["height"] / 2
    lab.page.mouse.move(*place)
    lab.sees(".lrp-gutter-why[data-asks]")
    lab.page.mouse.click(*place)


def has_dots(lab, count):
    """Wait until so many lines have a dot."""
    lab.until("(root, [dots, count]) => root.querySelectorAll(dots).length === count", argument=[DOTS, count])


def test_a_program_is_stopped_from_the_graph_the_text_and_the_list(open_lab):
    lab = open_lab(BLINK)
    lab.is_active("m/here")
    watch_in_the_graph(lab)
    watch_in_the_text(lab)
    keep_dots_beside_a_broken_text(lab)
    watch_a_condition(lab)
    find_the_list_in_a_low_panel(lab)


def watch_in_the_graph(lab):
    lab.state("m/there").click(button="right")
    assert lab.find('[role="menuitem"]').first.inner_text() == "Transition here"
    lab.choose("pause-entered")
    paused_by(lab, "there was entered (breakpoint 1, ")
    lab.sees('[data-lrp-state="m/there"] > .lrp-breakpoint[data-dot="on"]')
    lab.find(".lrp-paused-by").click()
    lab.sees(".cm-activeLine:has-text('state there')")
    lab.replace("visits = visits + 1", "visits = visits + 2")
    lab.do("reset")
    lab.sees('[data-lrp-state="m/there"] > .lrp-breakpoint')  # an edit and a reset keep it
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


def watch_in_the_text(lab):
    press_gutter(lab, "ontime 700 there", 6)
    lab.misses(DOTS)
    lab.misses(".lrp-graph .lrp-breakpoint")
    lab.select("here tback")
    lab.page.keyboard.press("Control+F8")
    lab.sees(DOTS)
    press_gutter(lab, "ontime 700 here", 19)
    lab.sees(".lrp-why .lrp-why-sentence code")
    assert lab.find(".lrp-why").get_attribute("aria-label") == "Why not tgo?"
    lab.page.keyboard.press("Escape")
    lab.select("state there")
    lab.page.keyboard.press("Alt+F8")
    lab.sees(".lrp-why[aria-label='Why there?']")
    lab.page.keyboard.press("Escape")


def keep_dots_beside_a_broken_text(lab):
    lab.select("state there")
    lab.page.keyboard.press("Control+F8")
    has_dots(lab, 2)
    lab.type_after("(machine m", "(")
    lab.page.keyboard.press("Delete")  # the bracket that closed it
    lab.reads('[data-lrp="editor"]', "error")
    assert lab.find(DOTS).count() == 2
    for left in (1, 0):
        place = lab.find(DOTS).first.bounding_box()
        lab.page.mouse.click(place["x"] + place["width"] / 2, place["y"] + place["height"] / 2)
        has_dots(lab, left)
    lab.page.keyboard.press("Backspace")
    lab.sees('.lrp-verdict[data-state="runs"]')


def watch_a_condition(lab):
    lab.open_tab("breakpoints")
    field = lab.find(".lrp-condition input")
    field.fill("visits = 3")
    field.press("Enter")
    lab.sees(".lrp-condition .lrp-error:has-text('not an expression')")
    field.fill("steps % 2 == 1")  # it becomes True again and again, however long the page takes
    field.press("Enter")
    lab.do("run")
    paused_by(lab, "steps % 2 == 1 became True (breakpoint 5, 1st time).")
    lab.sees(".lrp-breakpoint-item:has-text('1 hit')")
    lab.find("[data-lrp-action=breakpoint-on]").uncheck()
    lab.do("remove-breakpoint")
    lab.misses(".lrp-breakpoint-item")
    field.fill("missing > 1")
    field.press("Enter")
    lab.sees(".lrp-breakpoint-item .lrp-error:has-text('missing')")
    axe.finds_nothing_serious(lab)


def find_the_list_in_a_low_panel(lab):
    lab.page.set_viewport_size({"width": 1280, "height": 800})
    lab = lab.notebook.open(BLINK.replace("(state here", "(event unused [visits > 9])\n  (state here"), "low")
    lab.open_tab("breakpoints")
    for line in ("here tback", "there tgo"):
        lab.select(line)
        lab.page.keyboard.press("Control+F8")
    lab.sees(".lrp-breakpoint-item >> nth=1")
    panel = lab.box(".lrp-breakpoint-list")
    for selector in (".lrp-condition input", ".lrp-breakpoint-item:last-child > .lrp-link"):
        box = lab.box(selector)
        assert panel["y"] <= box["y"]
        assert box["y"] + box["height"] <= panel["y"] + panel["height"]
