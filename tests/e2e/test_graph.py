"""The state graph in a page: what is new comes into view, the rest stays where it is, names can be read."""

import math
import struct
from xml.etree import ElementTree

from e2e import axe
from e2e.programs import COUNTER, FOLLOWER, INNER

RING = "(machine m {})\n(spawn m s0)\n".format(
    "\n  ".join(
        [f"(state s{i})" for i in range(24)] + [f"(ontime 90000 s{i} -> s{(i + 1) % 24})" for i in range(24)]
    )
)
TURNS = """(machine m (state a) (state b) (state c) (state d)
  (ontime 100 a -> b) (ontime 100 b -> c) (ontime 100 c -> d) (ontime 100 d -> a))
(spawn m a)"""
GLOWS = """async svg => { const seen = [];
  const number = (node, property) => parseFloat(getComputedStyle(node)[property]);
  while (seen.length < 60) {
    await new Promise(requestAnimationFrame);
    const arrows = [...svg.querySelectorAll('.lrp-transition')];
    const plates = svg.querySelectorAll('.lrp-halo');
    const ages = arrows.map((arrow, index) => [arrow.hasAttribute('data-fired'),
      number(arrow.querySelector('.lrp-glow'), 'opacity'),
      number(arrow.querySelector('.lrp-shaft'), 'strokeWidth'),
      getComputedStyle(plates[index]).stroke]);
    seen.push(ages.sort((a, b) => b[0] - a[0]).map(([, ...age]) => age));
  }
  return seen; }"""
FORCED = """svg => { const probe = document.createElement('p');
  svg.parentNode.append(probe);
  probe.style.color = 'CanvasText';
  probe.style.backgroundColor = 'Canvas';
  const { color, backgroundColor } = getComputedStyle(probe);
  probe.remove();
  return [getComputedStyle(svg.querySelector('.lrp-machine')).fill, color, backgroundColor]; }"""
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
    """Wait until neither the drawing nor the camera has moved for some frames."""
    lab.catches_up()
    lab.at_rest(".lrp-graph .lrp-layer-states")


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


def test_a_graph_is_dragged_and_what_is_new_comes_into_view(open_lab):
    lab = open_lab(COUNTER)
    drop_a_state(lab)
    add_states(lab)
    enlarge(lab)
    follower = lab.notebook.open(FOLLOWER, "follower --world line")
    type_beside_the_graph(follower)
    give_up_a_drag(follower)
    open_a_nested_machine(follower)


def test_in_every_theme_the_last_transition_stands_out_at_every_moment_and_names_can_be_read(open_lab):
    lab = open_lab(TURNS)
    lab.goes_on()
    for theme in ("dark", "light"):
        axe.choose_theme(lab, theme)
        for ages in graph(lab).evaluate(GLOWS):
            (first, width, plate), *others = ages
            assert all(strength <= first / 2 for strength, _, _ in others)
            assert all(each < width for _, each, _ in others)
            assert all(each != plate for _, _, each in others)
        use_the_colours_of_the_system(lab)
    lab.pause()
    assert graph(lab).locator(".lrp-transition[data-fired]").count() == 1
    lab.misses(".lrp-transition[data-glow]")
    lab.sees('.lrp-transition[data-fired][aria-description="fired last"]')


def use_the_colours_of_the_system(lab):
    media = lab.page.emulate_media
    try:
        for scheme in ("dark", "light"):
            media(forced_colors="active", color_scheme=scheme)
            ink, text, paper = graph(lab).evaluate(FORCED)
            assert ink == text != paper
    finally:
        media(forced_colors="none", color_scheme="light")


def test_a_small_window_shows_all_of_a_machine_and_a_large_one_the_whole_nest(open_notebook):
    notebook = open_notebook("%load_ext lrp_jupyter", f"%%lrp follower --world line\n{FOLLOWER}")
    notebook.page.set_viewport_size({"width": 1280, "height": 800})  # for which the states are arranged
    notebook.run_cell(0)
    notebook.begin_cell(1)
    lab = notebook.lab().ready()
    inner = "follower/looking/lookalgo"
    assert not lab.sees('[data-lrp="tree"]').is_visible()
    lab.sees(f'[data-lrp-machine="{inner}"]').click()
    lab.sees(f'[data-lrp-state="{inner}/returnright"]')
    rests(lab)
    assert graph(lab).locator(f'[data-lrp-state^="{inner}/"]').count() == 4
    assert graph(lab).evaluate(OUT_OF_VIEW) == 0
    assert min(graph(lab).evaluate(FONTS)) >= 8.99
    lab.page.set_viewport_size({"width": 1920, "height": 1080})
    lab.sees('[data-lrp-state="follower/moving"]')
    rests(lab)
    assert graph(lab).locator("[data-drawing]").count() == 2
    assert graph(lab).evaluate(OUT_OF_VIEW) == 0
    before = places(lab)
    lab.sees('[data-lrp-machine="follower"]').click()
    lab.goes_on()
    rests(lab)
    assert places(lab) == before
    frame = lab.box(f'[data-drawing="{inner}"] .lrp-frame')
    lab.page.mouse.dblclick(frame["x"] + frame["width"] / 2, frame["y"] + 10)
    lab.sees(".lrp-field input").press("Enter")
    lab.sees(f'[data-lrp-state="{inner}/s1"]')
    listed = '[data-lrp="tree"] [data-lrp-machine="follower"]'
    for see in (lab.sees, lab.misses):  # without the graph, its heading is gone, too
        lab.do("menu")
        lab.choose("panel-graph")
        see(listed)
    in_heading = lab.find('[data-lrp="graph"] .lrp-path')
    for is_shown in (True, False):
        assert in_heading.is_visible() is is_shown
        lab.do("menu")
        lab.choose("panel-tree")


def test_nested_and_large_graphs_are_drawn_saved_and_read(open_lab, tmp_path):
    lab = open_lab(INNER)
    lab.page.set_viewport_size({"width": 1280, "height": 1000})  # too small for the whole nest
    keep_what_is_selected(lab)
    show_what_was_chosen_or_where_the_cursor_is(lab)
    draw_machines_inside_their_states(lab)
    save_pictures(lab, tmp_path)
    lab.page.set_viewport_size({"width": 1600, "height": 700})
    read_a_ring(lab.notebook.open(RING, "ring"))


def drop_a_state(lab):
    rests(lab)
    rest = places(lab)["m/rest"]
    for way in ((-90, 60), (120, -70), (40, 200)):
        dropped = drag(lab, "m/count", *way)
        assert distance(places(lab)["m/count"], dropped) < 1.5
        rests(lab)
        assert distance(places(lab)["m/count"], dropped) < 1.5
        assert distance(places(lab)["m/rest"], rest) < 1.5


def add_states(lab):
    for name in ("a_state_with_a_long_name", "another", "third", "fourth", "fifth"):
        lab.type_after("(state rest)", f" (state {name})")
        lab.sees(f'[data-lrp-state="m/{name}"]')
        lab.until(IS_VISIBLE, f'[data-lrp-state="m/{name}"] .lrp-box')
    lab.is_active("m/count")


def enlarge(lab):
    graph(lab).focus()
    lab.page.keyboard.press("F9")
    lab.until(
        "svg => { const all = svg.getBoundingClientRect();"
        " const {left, right} = svg.querySelector('.lrp-layer-states').getBoundingClientRect();"
        " return all.width > 900 && Math.abs((left + right - all.left - all.right) / 2) < 60; }",
        ".lrp-graph",
    )
    lab.page.keyboard.press("F9")


def give_up_a_drag(lab):
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


def open_a_nested_machine(lab):
    lab.state("follower/looking").dblclick()
    lab.sees('[data-lrp-state="follower/looking/lookalgo/lookleft"]')
    lab.sees('[data-lrp-variable="follower/looking/lookalgo/time"]')
    lab.sees('[data-lrp-machine="follower"]').click()
    lab.sees('[data-lrp-state="follower/moving"]')
    lab.sees('[data-lrp-machine="follower"][aria-selected="true"][data-active]')


def type_beside_the_graph(lab):
    """No state moves, and the camera only when the user pauses."""
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


def keep_what_is_selected(lab):
    """What is selected, and the machine that is shown, stay so through edits and renames."""
    lab.sees('[data-lrp-machine="m"]').click()  # the run is followed no more
    lab.sees('[data-lrp-transition$="a->b"] .lrp-hit').dispatch_event("click")
    arrow = lab.sees(".lrp-transition[data-chosen]").element_handle()
    lab.replace("90000", "70000")
    lab.reads(".lrp-layer-labels", "70000")
    assert arrow.evaluate("arrow => arrow.isConnected && arrow.hasAttribute('data-chosen')")
    lab.state("m/a").click(button="right")
    lab.choose("rename")
    lab.sees(".lrp-rename input").fill("z")
    lab.page.keyboard.press("Enter")
    lab.sees('[data-lrp-transition$="z->b"][data-chosen]')

    lab.sees('[data-lrp-machine="m/z/inner"]').click()
    lab.sees('[data-lrp-state="m/z/inner/x"]')
    lab.select("(state z")
    lab.page.keyboard.press("ArrowRight")
    lab.page.keyboard.press("F2")
    lab.sees(".lrp-rename input").fill("a")
    lab.page.keyboard.press("Enter")
    lab.sees('[data-lrp-machine="m/a/inner"][aria-selected="true"]')
    lab.sees('[data-lrp-state="m/a/inner/x"][data-active]')


def show_what_was_chosen_or_where_the_cursor_is(lab):
    revision = lab.revision
    lab.type_after("(state b)", " (state c)")
    lab.until("(root, before) => Number(root.dataset.lrpRevision) > before", argument=revision)
    lab.goes_on()
    lab.sees('[data-lrp-state="m/a/inner/x"]')
    lab.do("follow-cursor")
    lab.sees('[data-lrp-state="m/c"]')
    lab.misses('[data-lrp-state="m/a/inner/x"]')
    lab.type_after("(state y)", " (state z)")
    lab.sees('[data-lrp-state="m/a/inner/z"]')
    lab.misses('[data-lrp-state="m/b"]')
    lab.sees('[data-lrp-machine="m"]').click()
    lab.sees('[data-lrp-state="m/b"]')
    lab.do("follow-cursor")


def draw_machines_inside_their_states(lab):
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
    lab.type_after("(state y)", " (state more)")
    lab.sees('[data-lrp-state="m/a"] [data-lrp-state="m/a/inner/more"]')
    lab.sees('[data-lrp-state="m/b"]')
    lab.do("graph-menu")
    lab.choose("nest")
    lab.misses('[data-lrp-state="m/a/inner/more"]')


def save_pictures(lab, folder):
    rests(lab)
    for kind in ("svg", "png"):
        lab.do("graph-menu")
        with lab.page.expect_download() as download:
            lab.choose(f"save-{kind}")
        assert download.value.suggested_filename == f"m.{kind}"
        download.value.save_as(folder / f"m.{kind}")
    root = ElementTree.fromstring((folder / "m.svg").read_text())
    assert {"a", "b", "70000 ms"} <= {text.strip() for text in root.itertext()}
    boxes = [box for box in root.iter("{http://www.w3.org/2000/svg}rect") if box.get("rx") == "9"]
    assert len({box.get("fill") for box in boxes}) == 2, "the active state is marked"
    assert all(box.get("fill").startswith(("rgb", "color")) for box in boxes)
    width, height = struct.unpack(">II", (folder / "m.png").read_bytes()[16:24])
    assert (width, height) == tuple(math.ceil(2 * float(root.get(side))) for side in ("width", "height"))


def read_a_ring(lab):
    """Names are legible at every width; what does not fit is scrolled by the wheel and reached by keys."""
    for width in (1600, 1280, 900, 700):
        lab.page.set_viewport_size({"width": width, "height": 700})
        rests(lab)
        assert min(graph(lab).evaluate(FONTS)) >= 8.99
    assert graph(lab).evaluate(OUT_OF_VIEW) > 0
    assert lab.find(".lrp-scroll").evaluate_all("bars => bars.some(bar => !bar.hidden)")
    before = places(lab)["m/s0"]
    graph(lab).scroll_into_view_if_needed()
    graph(lab).hover()
    lab.page.mouse.wheel(60, 60)
    lab.until(f"(svg, y) => ({PLACES})(svg)['m/s0'].join() !== y", ".lrp-graph", ",".join(map(str, before)))
    for state in ("m/s0", "m/s23", "m/s12"):
        lab.find(f'[data-lrp-state="{state}"]').focus()
        lab.page.keyboard.press("ArrowRight")
        lab.page.keyboard.press("ArrowDown")
        focused = lab.find(".lrp-graph").evaluate("() => document.activeElement.dataset.lrpState")
        if focused:
            lab.until(IS_VISIBLE, f'[data-lrp-state="{focused}"] .lrp-box')
