"""A person with a tablet: no mouse, no right button, nothing that hovers."""

import pytest

from e2e.conftest import WAIT
from e2e.drawer import Drawer, middle
from e2e.fingers import Fingers
from e2e.pages import NotebookPage

TABLET = {
    "viewport": {"width": 1180, "height": 820},
    "has_touch": True,
    "is_mobile": True,
    "device_scale_factor": 2,
}
ZERO = '[data-lrp-state="watch/zero"] .lrp-box'
BAR = ".lrp-splitter-columns:not([hidden])"
PLAYHEAD = ".lrp-playhead"
SCROLLED = "document.querySelector('.jp-WindowedPanel-outer').scrollTop"
SCROLL = f"""async () => {{
  for (let same = 0, last = 0; same < 10;) {{
    same = {SCROLLED} >= 55 && {SCROLLED} === last ? same + 1 : 0;
    if ({SCROLLED} < 55) {SCROLLED} = 80;
    last = {SCROLLED};
    await new Promise(requestAnimationFrame);
  }}
}}"""  # also where JupyterLab has stayed at the top, or what a finger has pushed moves on
PLACE_OF = """([line, text]) => {
  const walk = document.createTreeWalker(line, NodeFilter.SHOW_TEXT);
  while (!walk.nextNode().data.includes(text));
  const range = new Range();
  range.selectNode(walk.currentNode);
  const { x, y, width, height } = range.getBoundingClientRect();
  return [x + width / 2, y + height / 2];
}"""
PRESSED = "button, select, summary, input, [role=treeitem], .lrp-playhead, .lrp-splitter"
LEAST = 35  # px: 36, less what a neighbour rounds off
SMALL = """([root, pressed, least]) => [...root.querySelectorAll(pressed)].filter(each => {
  const { left, right, top, bottom } = each.getBoundingClientRect();
  const [x, y] = [(left + right) / 2, (top + bottom) / 2];
  const hits = (x, y) => {
    const at = document.elementFromPoint(x, y);
    return at && (each.contains(at) || each.closest("label")?.contains(at));
  };
  const inside = [[left + 1, y], [right - 1, y], [x, top + 1], [x, bottom - 1], [x, y]];
  if (each.disabled || !inside.every(([x, y]) => hits(x, y))) return false;  // or it is cut off, or not seen
  const reach = (dx, dy) => { let n = 0; while (n < least && hits(x + dx * n, y + dy * n)) n++; return n; };
  return Math.min(reach(1, 0) + reach(-1, 0), reach(0, 1) + reach(0, -1)) - 1 < least;
}).map(each => each.outerHTML.slice(0, 120))"""
ZOOM = "svg => Number(svg.firstElementChild.getAttribute('transform').match(/scale\\((.*)\\)/)[1])"


@pytest.fixture
def tablet(context, server):
    tablet = context.browser.new_context(**TABLET)
    tablet.set_default_timeout(WAIT)
    errors = []
    tablet.on("weberror", lambda each: errors.append(str(each.error.stack)))
    yield tablet.new_page()
    tablet.close()
    server.end_kernels()
    assert [each for each in errors if "blob:" in each] == []


def test_a_watch_is_drawn_asked_and_gone_back_with_by_finger_only(tablet, server):
    notebook = NotebookPage(tablet, server, "touch/notebook.ipynb")
    server.write(notebook.name, ["%load_ext lrp_jupyter", "%%lrp m --world walls\n; drawn\n"])
    notebook.show()
    tablet.locator('.jp-SideBar [data-id="filebrowser"]').tap()
    notebook.run_cell(0)
    notebook.begin_cell(1)
    lab = notebook.lab().ready()
    fingers = Fingers(tablet)
    draw_a_watch(lab, fingers)
    ask(lab, fingers)
    scroll_the_notebook(lab, fingers)
    zoom_the_graph(lab, fingers)
    drag_the_robot(lab, fingers)
    change_a_number(lab, fingers)
    move_a_bar(lab, fingers)
    find_all_large_enough(lab)
    go_faster(lab, fingers)
    go_back(lab, fingers)
    pause_at_a_line(lab, fingers)


def draw_a_watch(lab, fingers):
    drawer = Drawer(lab, fingers)
    free = 0.1, 0.2
    drawer.choose_free(*free, "draw-var", "tenths", "0")
    drawer.machine(*free, "watch")
    drawer.state("zero", 0.25, 0.5)
    drawer.state("running", 0.75, 0.5)
    drawer.choose("watch/zero", "draw-onentry", "tenths = 0")
    drawer.choose("watch/running", "draw-running", "tenths += 1")
    drawer.transition("watch/zero", "watch/running", "0.3 s")
    drawer.transition("watch/running", "watch/zero", "tenths > 9")
    drawer.choose_free(*free, "draw-form", "(spawn watch zero)")
    lab.is_active("watch/running")


def ask(lab, fingers):
    fingers.click(*middle(lab.at_rest('[data-lrp-state="watch/running"] .lrp-box')), button="right")
    lab.choose("why")
    lab.reads(".lrp-why-sentence", "running")
    lab.press(".lrp-why .lrp-tools button")
    lab.misses(".lrp-why")
    fingers.click(*middle(lab.at_rest('.lrp-layer-labels [data-of^="watch:"]')), button="right")
    lab.choose("why")
    lab.sees(".lrp-why-sentence")
    lab.press(".lrp-why .lrp-tools button")
    fingers.click(*middle(lab.at_rest('[data-lrp-action="reset"]')), button="right")
    lab.sees(".lrp-tip")


def scroll_the_notebook(lab, fingers):
    """One finger scrolls over both pictures, unless it has grabbed something."""
    for picture in (".lrp-graph", ".lrp-canvas"):
        lab.page.evaluate(SCROLL)
        box, before = lab.at_rest(picture), scrolled(lab)
        x, y = box["x"] + 12, box["y"] + box["height"] - 12
        fingers.drag((x, y), (x, y + 80))
        lab.page.wait_for_function(f"before => {SCROLLED} < before - 50", arg=before)
    lab.page.evaluate(SCROLL)
    box, before = lab.at_rest(ZERO), scrolled(lab)
    x, y = middle(box)
    fingers.drag((x, y), (x, y + 40))
    lab.until("(box, y) => box.getBoundingClientRect().y > y + 20", ZERO, box["y"])
    assert scrolled(lab) == before


def scrolled(lab):
    return lab.page.evaluate(SCROLLED)


def zoom_the_graph(lab, fingers):
    """Two fingers move and zoom it, also where the first one has grabbed a state."""
    box, before = lab.at_rest(ZERO), lab.until(ZOOM, ".lrp-graph")
    x, y = middle(box)
    fingers.two([(x, y), (x + 40, y)], [(x - 40, y), (x + 80, y)])
    lab.until(f"(svg, before) => ({ZOOM})(svg) > 2.5 * before", ".lrp-graph", before)
    lab.do("zoom-fit")


def move_a_bar(lab, fingers):
    bar = lab.at_rest(BAR)
    x, y = middle(bar)
    fingers.drag((x - 14, y), (x + 60, y))
    lab.until("(bar, x) => bar.getBoundingClientRect().x > x + 50", BAR, bar["x"])


def drag_the_robot(lab, fingers):
    lab.do("world-zoom-fit")
    lab.drag_robot((0.5, 0.5), (1.2, 0.5), fingers)
    lab.drag_robot((1.2, 0.5), (0.8, 0.5), fingers)  # it was there, or nothing would be selected
    lab.reads(".lrp-thing", "Robot")


def change_a_number(lab, fingers):
    """A tap on it shows a strip that is dragged on, or tapped at its ends."""
    line = lab.find(".cm-line:has-text('ontime 300')")
    fingers.click(*lab.page.evaluate(PLACE_OF, [line.element_handle(), "300"]))
    x, y = middle(lab.at_rest(".lrp-scrub"))
    fingers.drag((x, y), (x + 80, y))
    lab.reads(".cm-content", "ontime 500 zero")
    fingers.click(x - 100, y)
    lab.reads(".cm-content", "ontime 490 zero")


def pause_at_a_line(lab, fingers):
    gutter = lab.at_rest(".lrp-breakpoint-gutter")
    line = lab.find(".cm-line:has-text('(ontime')").bounding_box()
    fingers.click(gutter["x"] + 12, line["y"] + line["height"] / 2)
    lab.ready("paused")


def find_all_large_enough(lab):
    lab.until(f"(root, asked) => !({SMALL})([root, ...asked]).length", argument=[PRESSED, LEAST])


def go_faster(lab, fingers):
    x, y = middle(lab.at_rest(".lrp-slider"))
    before = int(lab.find(".lrp-slider").input_value())
    fingers.drag((x, y), (x + 20, y))
    lab.until("(slider, before) => Number(slider.value) > before", ".lrp-slider", before)


def go_back(lab, fingers):
    lab.pause()  # or the playhead would move on
    head, now = lab.at_rest(PLAYHEAD), lab.tick
    x, y = middle(head)
    fingers.drag((x + 14, y), (x - 100, y))
    lab.sees("css=:scope[data-looking]")
    lab.until("(root, now) => Number(root.dataset.lrpTick) < now", argument=now)
    lab.do("back-to-now")
    lab.sees("css=:scope:not([data-looking])")
    lab.do("run")
    lab.ready("running")
