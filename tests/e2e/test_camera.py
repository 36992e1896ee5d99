"""The camera of the state graph: it stays where it is, unless something is out of view."""

import math
import struct
from xml.etree import ElementTree

import pytest

from e2e import axe
from e2e.programs import COUNTER, FOLLOWER, INNER

RING = "(machine m {})\n(spawn m s0)\n".format(
    "\n  ".join(
        [f"(state s{i})" for i in range(24)] + [f"(ontime 90000 s{i} -> s{(i + 1) % 24})" for i in range(24)]
    )
)
PLACES = """svg => { const all = svg.getBoundingClientRect();
  return Object.fromEntries([...svg.querySelectorAll('[data-lrp-state]')].map(node => {
    const box = node.querySelector('.lrp-box').getBoundingClientRect();
    return [node.dataset.lrpState, [box.x + box.width / 2 - all.x, box.y + box.height / 2 - all.y]]; })); }"""
OUT_OF_VIEW = """svg => { const all = svg.getBoundingClientRect();
  return [...svg.querySelectorAll('.lrp-box')].filter(node => { const box = node.getBoundingClientRect();
    return box.left < all.left - 1 || box.right > all.right + 1
      || box.top < all.top - 1 || box.bottom > all.bottom + 1; }).length; }"""
IS_VISIBLE = """box => { const all = box.closest('svg').getBoundingClientRect();
  const one = box.getBoundingClientRect();
  return one.left >= all.left - 1 && one.right <= all.right + 1
    && one.top >= all.top - 1 && one.bottom <= all.bottom + 1; }"""
FONTS = """svg => ['.lrp-name', '.lrp-label', '.lrp-nested text', '.lrp-within'].flatMap(kind =>
  [...svg.querySelectorAll(kind)].map(text => parseFloat(getComputedStyle(text).fontSize)
    * svg.querySelector('.lrp-layer-states').getScreenCTM().a))"""


def graph(lab):
    return lab.sees(".lrp-graph")


def places(lab):
    """Return the centres of all states in the panel, in px of the screen."""
    return graph(lab).evaluate(PLACES)


def distance(a, b):
    return max(abs(a[0] - b[0]), abs(a[1] - b[1]))


def rests(lab):
    """Wait until the kernel has had its turn and nothing has moved for longer than the camera waits."""
    lab.goes_on()
    lab.page.evaluate(
        """async places => { const svg = document.querySelector('.lrp-graph');
        let before = '', since = performance.now();
        while (performance.now() - since < 1400) {
          const now = svg.querySelector('g').getAttribute('transform')
            + [...svg.querySelectorAll('[data-lrp-state]')].map(one => one.getAttribute('transform'));
          if (now !== before) { before = now; since = performance.now(); }
          await new Promise(requestAnimationFrame); } }"""
    )


def drag(lab, state, dx, dy):
    """Drag a state by so many px of the screen, not gripped at its centre; return where it is dropped."""
    lab.state(state).scroll_into_view_if_needed()
    start = places(lab)[state]
    box = lab.box(f'[data-lrp-state="{state}"] .lrp-box')
    x, y = box["x"] + 12, box["y"] + 9
    mouse = lab.page.mouse
    mouse.move(x, y)
    mouse.down()
    mouse.move(x + dx, y + dy, steps=8)
    mouse.up()
    return start[0] + dx, start[1] + dy


def test_states_stay_where_they_are_while_one_types(open_lab):
    lab = open_lab(FOLLOWER, "follower --world line")
    rests(lab)
    moved = graph(lab).evaluate_handle(
        """svg => { const moved = []; let key = -Infinity;
        window.addEventListener('keydown', () => { key = performance.now(); }, true);
        new MutationObserver(records => { for (const { target } of records)
          moved.push([target.dataset.lrpState ?? 'camera', performance.now() - key]); }).observe(svg,
          { subtree: true, attributes: true, attributeFilter: ['transform'] });
        return moved; }"""
    )
    before = set(places(lab))
    lab.select("(machine follower")
    lab.page.keyboard.press("ArrowRight")
    lab.page.keyboard.press("Enter")
    lab.page.keyboard.type("(state resting)(eps resting -> waiting")
    lab.sees('[data-lrp-state="follower/waiting"]')
    lab.until(IS_VISIBLE, '[data-lrp-state="follower/waiting"] .lrp-box')
    for what, since_key in moved.json_value():
        assert what not in before
        assert what != "camera" or since_key >= 1000


def test_what_is_new_comes_into_view_when_one_pauses(open_lab):
    lab = open_lab(COUNTER)
    rests(lab)
    for name in ("a_state_with_a_long_name", "another", "third", "fourth", "fifth"):
        lab.type_after("(state rest)", f" (state {name})")
        lab.sees(f'[data-lrp-state="m/{name}"]')
        lab.until(IS_VISIBLE, f'[data-lrp-state="m/{name}"] .lrp-box')


def test_a_dragged_state_lands_where_it_is_dropped(open_lab):
    lab = open_lab(COUNTER)
    rests(lab)
    rest = places(lab)["m/rest"]
    for way in ((-90, 60), (120, -70), (40, 200)):
        dropped = drag(lab, "m/count", *way)
        assert distance(places(lab)["m/count"], dropped) < 1.5
        rests(lab)
        assert distance(places(lab)["m/count"], dropped) < 1.5
        assert distance(places(lab)["m/rest"], rest) < 1.5


def test_a_graph_that_was_dragged_is_back_after_escape(open_lab):
    lab = open_lab(FOLLOWER, "follower --world line")
    rests(lab)
    before = places(lab)
    box = lab.box(".lrp-graph")
    lab.page.mouse.move(box["x"] + 6, box["y"] + 6)
    lab.page.mouse.down()
    lab.page.mouse.move(box["x"] + 60, box["y"] + 40, steps=4)
    assert all(distance(now, before[name]) > 30 for name, now in places(lab).items())
    lab.page.keyboard.press("Escape")
    lab.page.mouse.move(box["x"] + 90, box["y"] + 90)
    lab.page.mouse.up()
    assert all(distance(now, before[name]) < 1 for name, now in places(lab).items())


def test_the_graph_shows_the_machine_in_which_one_types(open_lab):
    lab = open_lab(INNER)
    lab.sees('[data-lrp-state="m/b"]')
    lab.type_after("(state y)", " (state z)")
    lab.sees('[data-lrp-state="m/a/inner/z"]')
    lab.misses('[data-lrp-state="m/b"]')
    lab.type_after("(state b)", " (state c)")
    lab.sees('[data-lrp-state="m/c"]')


@pytest.mark.parametrize("width", [700, 900, 1280, 1600])
def test_names_and_labels_are_legible_at_every_width(open_lab, width):
    lab = open_lab(RING)
    lab.page.set_viewport_size({"width": width, "height": 800})
    rests(lab)
    assert min(graph(lab).evaluate(FONTS)) >= 9.99


def test_what_does_not_fit_is_scrolled_by_the_wheel_and_reached_by_keys(open_lab):
    lab = open_lab(RING)
    lab.sees('[data-lrp-state="m/s12"]')
    lab.page.set_viewport_size({"width": 800, "height": 700})
    rests(lab)
    assert graph(lab).evaluate(OUT_OF_VIEW) > 0
    assert lab.find(".lrp-scroll").evaluate_all("bars => bars.some(bar => !bar.hidden)")
    before = places(lab)["m/s0"]
    graph(lab).scroll_into_view_if_needed()
    graph(lab).hover()
    lab.page.wait_for_timeout(400)  # a new gesture
    lab.page.mouse.wheel(60, 60)
    lab.until(f"(svg, y) => ({PLACES})(svg)['m/s0'].join() !== y", ".lrp-graph", ",".join(map(str, before)))
    for state in ("m/s0", "m/s23", "m/s12"):
        lab.find(f'[data-lrp-state="{state}"]').focus()
        lab.page.keyboard.press("ArrowRight")
        lab.page.keyboard.press("ArrowDown")
        focused = lab.find(".lrp-graph").evaluate("() => document.activeElement.dataset.lrpState")
        if focused:
            lab.until(IS_VISIBLE, f'[data-lrp-state="{focused}"] .lrp-box')


def test_nested_machines_are_drawn_inside_their_states(open_lab):
    lab = open_lab(INNER)
    lab.sees('[data-lrp-state="m/b"]')
    assert not lab.find('[data-lrp-state="m/a/inner/y"]').count()
    lab.do("graph-menu")
    lab.choose("nest")
    lab.sees('[data-lrp-state="m/a"] [data-lrp-state="m/a/inner/x"][data-active]')
    axe.finds_nothing_serious(lab)
    rests(lab)
    before = places(lab)
    dropped = drag(lab, "m/a/inner/y", 60, 30)
    rests(lab)
    now = places(lab)
    assert distance(now["m/a/inner/y"], dropped) < 1.5
    assert distance(now["m/a/inner/x"], before["m/a/inner/x"]) < 1.5
    lab.type_after("(state y)", " (state z)")
    lab.sees('[data-lrp-state="m/a"] [data-lrp-state="m/a/inner/z"]')
    lab.sees('[data-lrp-state="m/b"]')
    lab.do("graph-menu")
    lab.choose("nest")
    lab.misses('[data-lrp-state="m/a/inner/z"]')


def test_the_graph_is_saved_as_a_picture_that_stands_alone(open_lab, tmp_path):
    lab = open_lab(INNER)
    rests(lab)
    for kind in ("svg", "png"):
        lab.do("graph-menu")
        with lab.page.expect_download() as download:
            lab.choose(f"save-{kind}")
        assert download.value.suggested_filename == f"m.{kind}"
        download.value.save_as(tmp_path / f"m.{kind}")
    root = ElementTree.fromstring((tmp_path / "m.svg").read_text())
    assert {"a", "b", "90000 ms"} <= {text.strip() for text in root.itertext()}
    boxes = [box for box in root.iter("{http://www.w3.org/2000/svg}rect") if box.get("rx") == "9"]
    assert len({box.get("fill") for box in boxes}) == 2, "the active state is marked"
    assert all(box.get("fill").startswith(("rgb", "color")) for box in boxes)
    width, height = struct.unpack(">II", (tmp_path / "m.png").read_bytes()[16:24])
    assert (width, height) == tuple(math.ceil(2 * float(root.get(side))) for side in ("width", "height"))


def test_a_graph_that_fills_the_lab_by_a_key_is_in_its_middle_at_once(open_lab):
    lab = open_lab(COUNTER)
    rests(lab)
    graph(lab).focus()
    lab.page.keyboard.press("F9")
    lab.until(
        "svg => { const all = svg.getBoundingClientRect();"
        " const {left, right} = svg.querySelector('.lrp-layer-states').getBoundingClientRect();"
        " return all.width > 900 && Math.abs((left + right - all.left - all.right) / 2) < 60; }",
        ".lrp-graph",
    )
