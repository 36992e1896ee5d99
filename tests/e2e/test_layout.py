"""The places of the panels: in one screen, the world first, kept as their user left them; light and dark."""

from itertools import combinations, pairwise

import pytest

from e2e import axe
from e2e.pages import APP
from e2e.programs import COUNTER, FOLLOWER

PRINTS = "(machine m (state a (running [print('here'); 1 / 0]))) (spawn m a)"
MANY = "\n".join(f"(machine m{n} (state a)) (spawn m{n} a)" for n in range(9))
DIAMETER = 0.16  # m, of the bundled robot
PANELS = ("editor", "graph", "world", "variables")
TABS = ("robot", "issues", "runs", "breakpoints", "variables")
STACKED = "(panels, stacked) => panels.hasAttribute('data-stacked') === stacked"
FRAMES = "async () => { for (let i = 0; i < 3; i++) await new Promise(requestAnimationFrame); }"
SCREENS = [(1600, 1000), (1900, 1000), (1280, 800), (900, 900), (700, 900)]


def box(lab, part):
    return lab.box(f'[data-lrp="{part}"]')


def in_sight(lab, selector):
    """Wait until an element is wholly in the part of the notebook that can be seen."""
    lab.until(
        "element => { const { left, top, right, bottom } = element.getBoundingClientRect();"
        " const frame = element.closest('.jp-WindowedPanel-outer').getBoundingClientRect();"
        " return left >= frame.left && right <= frame.right && top >= frame.top && bottom <= frame.bottom; }",
        selector,
    )


def cells(lab):
    return lab.page.evaluate(f"{APP}.content.widgets.length")


def places_of(lab):
    return {part: box(lab, part) for part in PANELS}


def nothing_overlaps(lab):
    for (one, a), (other, b) in combinations(places_of(lab).items(), 2):
        assert (
            a["x"] + a["width"] <= b["x"] + 1
            or b["x"] + b["width"] <= a["x"] + 1
            or a["y"] + a["height"] <= b["y"] + 1
            or b["y"] + b["height"] <= a["y"] + 1
        ), (one, other)


def nothing_is_drawn_over_the_output(lab):
    """Where the panel of issues is low, the output gives way."""
    lab.page.set_viewport_size({"width": 1280, "height": 800})
    lab = lab.notebook.open(PRINTS, "prints --world line")
    lab.sees(".lrp-output:not(:empty)")
    lab.sees("[data-lrp-issue]")
    lab.until(
        "issues => { const { bottom, height } = issues.getBoundingClientRect();"
        " const output = issues.nextElementSibling.getBoundingClientRect();"
        " return output.height > 20 && height >= 52 && bottom <= output.top + 0.5; }",
        ".lrp-issues",
    )


def every_panel_is_enlarged_at_its_right(lab):
    """Also the one that has no world to show, and no other buttons."""
    lab.sees('[data-lrp="world"]:not([data-aspect])')
    for part in PANELS:
        head = f'[data-lrp="{part}"] > .lrp-head'
        place, button = lab.box(head), lab.box(f'{head} > [data-lrp-action="enlarge"]')
        assert place["x"] + place["width"] - button["x"] - button["width"] < 8, part


def is_in_reading_order(lab):
    """The tab key goes through a part of the lab before it goes to the next, downwards and to the right."""
    places = ".lrp-panels > :not(.lrp-splitter, [data-away], [data-absent])"
    boxes = lab.find(places).evaluate_all(
        "places => places.map(place => place.getBoundingClientRect()).map(({ x, y }) => [x, y])"
    )
    for (x, y), (next_x, next_y) in pairwise(boxes):
        assert next_y > y or next_x > x, boxes
    assert boxes[0] == min(boxes), boxes


def is_stacked(lab):
    """Where there is little room the world is above the other panels."""
    places = places_of(lab)
    assert min(places, key=lambda part: places[part]["y"]) == "world"
    assert len({place["x"] for place in places.values()}) == 1
    assert lab.root.evaluate("root => root.scrollWidth <= root.clientWidth")
    lab.root.evaluate("root => root.scrollIntoView()")
    in_sight(lab, '[data-lrp-action="stop"]')
    in_sight(lab, ".lrp-status")


def is_side_by_side(lab):
    """The world is the largest picture, and the robot can be seen."""
    left, right = lab.place(0, 0)[0], lab.place(1, 0)[0]
    assert DIAMETER * (right - left) >= 30
    canvas, whole = lab.box(".lrp-canvas"), lab.box()
    assert canvas["width"] * canvas["height"] >= 0.25 * whole["width"] * whole["height"]


def has_a_whole_head(lab):
    """The head of the graph shows its machines beside its tools, and its mode whole or not at all."""
    head = '[data-lrp="graph"] > .lrp-head'
    mode = f"{head} .lrp-select"
    lab.until("select => !select.checkVisibility() || select.offsetWidth >= 56", mode)  # for word and arrow
    assert not lab.find('[data-lrp="tree"]').is_visible()
    names = [lab.box(f'{head} [data-lrp-machine$="{name}"]') for name in ("follower", "lookalgo")]
    ends = [*names, lab.box(f"{head} > .lrp-tools")]
    assert all(a["x"] + a["width"] <= b["x"] + 0.5 for a, b in pairwise(ends))
    lab.until("head => head.scrollWidth <= head.clientWidth", head)


def has_every_tab_in_reach(lab):
    """A mouse comes from the first tab to the last one and back; the name of the one in front is whole."""
    tabs = lab.find(".lrp-tab:not([hidden])").evaluate_all("tabs => tabs.map(tab => tab.dataset.lrpTab)")
    lab.at_rest(".lrp-tab")  # so are the others of the strip
    for tab in (*tabs, *reversed(tabs)):
        left, right, box = seen_of(lab, tab)
        assert right - left >= 12, tab
        lab.page.mouse.click((left + right) / 2, box["y"] + 12)
        lab.sees(f'[data-lrp="{tab}"]:not([data-behind])')
        lab.at_rest(f'[data-lrp-tab="{tab}"]')
        left, right, box = seen_of(lab, tab)
        assert right - left >= box["width"] - 0.5, tab


def seen_of(lab, tab):
    """Return the ends of what is seen of a tab in its strip, beside the buttons in front, and its box."""
    box, strip = lab.box(f'[data-lrp-tab="{tab}"]'), lab.box(".lrp-tab-strip")
    tools = lab.box(".lrp-tabs > .lrp-panel:not([data-behind]) > .lrp-head")
    return max(box["x"], strip["x"]), min(box["x"] + box["width"], tools["x"]), box


def test_every_panel_has_its_place_on_paper_and_in_every_window_light_and_dark(open_lab, page):
    lab = open_lab(FOLLOWER, "follower --world line")
    print_it(lab)
    lab.type_after("(state end", "ing")  # a program with findings shows more
    lab.sees('[data-lrp="issues"]:not([data-behind]) [data-lrp-issue]')  # in front
    lab.open_tab("variables")
    lab.pause()
    for theme, screens in (("dark", SCREENS[:3]), ("light", SCREENS[3:])):  # which differ in colours only
        axe.choose_theme(lab, theme)
        for part in ("editor", "graph", "variables"):
            dark = theme == "dark"
            assert all((colour > 128) is dark for colour in ink(lab, part)), (theme, part)
        for width, height in screens:
            page.set_viewport_size({"width": width, "height": height})
            lab.until(STACKED, ".lrp-panels", width < 1000)
            lab.at_rest('[data-lrp="world"]')
            nothing_overlaps(lab)
            is_in_reading_order(lab)
            if width >= 1280:
                has_a_whole_head(lab)
                has_every_tab_in_reach(lab)
            (is_side_by_side if width >= 1280 else is_stacked)(lab)
        axe.finds_nothing_serious(lab)
    panels = lab.find(".lrp-panels")
    assert panels.evaluate("panels => { panels.scrollTop = 1000; return panels.scrollTop; }") > 0
    page.set_viewport_size({"width": 1280, "height": 800})
    lab.until(STACKED, ".lrp-panels", False)
    assert panels.evaluate("panels => panels.scrollTop") == 0
    lab.root.evaluate("root => root.scrollIntoView()")
    for part in PANELS:
        in_sight(lab, f'[data-lrp="{part}"]')
    for tab in TABS:
        lab.open_tab(tab)
        in_sight(lab, f'[data-lrp="{tab}"]')
    before = lab.box('[data-lrp-state="follower/moving"]')["width"]
    lab.do("graph-menu")
    lab.choose("menu-zoom-in")
    lab.until(f"node => node.getBoundingClientRect().width > {before}", '[data-lrp-state="follower/moving"]')
    open_a_menu_in_a_low_window(lab)
    nothing_is_drawn_over_the_output(lab)
    every_panel_is_enlarged_at_its_right(
        lab.notebook.open("(machine m (state a)) (spawn m a)", "m --bridge none")
    )


def test_panels_are_enlarged_hidden_resized_and_kept(open_notebook, page):
    page.set_viewport_size({"width": 1280, "height": 800})
    notebook = open_notebook("%load_ext lrp_jupyter", f"%%lrp follower --world line\n{FOLLOWER}", "1", "2")
    notebook.run_cell(0)
    page.locator(".jp-CodeCell").nth(1).locator(".cm-content").click()
    page.keyboard.press("Shift+Enter")
    lab = notebook.lab().ready()
    in_sight(lab, ".lrp-canvas")
    in_sight(lab, '[data-lrp-action="stop"]')
    page.set_viewport_size({"width": 1280, "height": 900})
    keep_keys_from_the_notebook(lab)
    enlarge_panels(lab)
    fill_the_window(lab)
    leave_the_tab(lab)
    inspect_in_sight(lab)
    resize_and_reload(lab)
    push_nothing_by_notes(lab.notebook.open(COUNTER, "m"))
    list_machines_where_the_graph_has_room(lab.notebook.open(MANY, "many --world oval"))


def list_machines_where_the_graph_has_room(lab):
    """Many machines are listed above the graph, and beside it where it is wide and low."""
    for width, height, arrangement, side, length, least in (
        (1280, 900, "work", "y", "height", 180),
        (1920, 1080, "work", "x", "width", 250),
        (1920, 1080, "demo", "x", "width", 200),
    ):
        lab.page.set_viewport_size({"width": width, "height": height})
        lab.do("menu")
        lab.choose(f"arrange-{arrangement}")
        lab.at_rest('[data-lrp="graph"]')
        tree, graph = box(lab, "tree"), box(lab, "graph")
        assert graph[side] == pytest.approx(tree[side] + tree[length], abs=1), (width, arrangement)
        assert graph["height"] > least
    lab.do("menu")
    lab.choose("arrange-work")


def ink(lab, part):
    """Red, green and blue of a part's text."""
    color = lab.sees(f'[data-lrp="{part}"]').evaluate("part => getComputedStyle(part).color")
    return [float(number) for number in color[color.index("(") + 1 : -1].split(",")[:3]]


def open_a_menu_in_a_low_window(lab):
    """A long menu is in sight, also when the lab fills the window."""
    lab.page.set_viewport_size({"width": 1280, "height": 500})
    lab.until("lab => document.querySelector('.jp-WindowedPanel-outer').clientHeight < 400")
    lab.find('[data-lrp-action="menu"]').focus()  # no click: it would have to be scrolled to
    lab.root.evaluate("lab => lab.scrollIntoView({ block: 'start' })")
    inside = (
        "menu => { const around = document.querySelector('.jp-WindowedPanel-outer').getBoundingClientRect();"
        " const seen = menu.closest('[popover]') ? { top: 0, bottom: innerHeight } : around;"
        " const { top, bottom, height } = menu.getBoundingClientRect();"
        " return top >= seen.top && bottom <= seen.bottom && height > 300; }"
    )
    lab.page.keyboard.press("Enter")
    lab.until(inside, '[role="menu"]')
    lab.page.keyboard.press("Escape")
    lab.page.keyboard.press("Shift+F9")
    lab.page.keyboard.press("Enter")
    lab.until(inside, '[role="menu"]')


def keep_keys_from_the_notebook(lab):
    """Keys on the controls do not reach the notebook, but move what they are on."""
    before = cells(lab)
    lab.find('[data-lrp-action="reset"]').click()
    active = lab.page.evaluate(f"{APP}.content.activeCellIndex")
    for action in ("reset", "follow", "zoom-fit"):
        lab.do(action)
        for key in ("x", "a", "b", "d", "d", "ArrowDown", "m", "z"):
            lab.page.keyboard.press(key)
    lab.goes_on()
    assert cells(lab) == before
    assert lab.page.evaluate(f"{APP}.content.activeCellIndex") == active
    lab.do("rate")
    slider = lab.sees('[data-lrp-action="rate"]')
    rate = int(slider.input_value())
    lab.page.keyboard.press("ArrowRight")
    lab.page.keyboard.press("ArrowRight")
    assert int(slider.input_value()) == rate + 2


def enlarge_panels(lab):
    """A key enlarges the panel of the focus; a double click does, too, and selects no text."""
    for part in PANELS:
        lab.find(f'[data-lrp="{part}"] [data-lrp-action="enlarge"]').focus()
        lab.page.keyboard.press("F9")
        place = lab.box(".lrp-tabs") if part == "variables" else box(lab, part)
        assert place == lab.box(".lrp-panels"), part
        axe.finds_nothing_serious(lab)
        lab.find(f'[data-lrp="{part}"] [data-lrp-action="enlarge"]').click()
        assert lab.find('[role="separator"]:visible').count() == 3
    before = box(lab, "world")
    lab.find('[data-lrp="world"] .lrp-title').dblclick()
    assert box(lab, "world") == lab.box(".lrp-panels")
    assert lab.page.evaluate("getSelection().toString()") == ""
    assert not lab.find('[data-lrp="editor"]').is_visible()
    lab.find('[data-lrp="world"] .lrp-title').dblclick()
    assert box(lab, "world") == before
    assert lab.find('[data-lrp="editor"]').is_visible()


def fill_the_window(lab):
    lab.find(".cm-content").focus()
    lab.page.keyboard.press("Control+End")
    lab.page.keyboard.press("Shift+F9")
    assert lab.box() == {"x": 0, "y": 0, "width": 1280, "height": 900}
    lab.page.keyboard.type("; typed")
    lab.reads(".cm-content", "; typed")
    lab.page.keyboard.press("Shift+F9")
    assert lab.box()["width"] < 900
    lab.page.keyboard.type(" on")
    lab.reads(".cm-content", "; typed on")


def leave_the_tab(lab):
    """A lab in a tab that was away is as it was."""
    lab.pause()
    read = (
        "root => [root.querySelector('.cm-scroller').scrollTop,"
        " root.querySelector('.lrp-graph > g').getAttribute('transform'), root.style.cssText]"
    )
    lab.root.evaluate("root => { root.querySelector('.cm-scroller').scrollTop = 300; }")
    lab.do("zoom-fit")  # an active state out of sight would be followed
    lab.at_rest(".lrp-graph > g")
    before = lab.root.evaluate(read)
    assert before[0] > 100
    tab = lab.page.evaluate("jupyterapp.shell.currentWidget.id")
    lab.page.evaluate("() => jupyterapp.commands.execute('launcher:create')")
    lab.until("root => root.clientWidth === 0")
    lab.page.evaluate(FRAMES)  # what is observed is reported
    lab.page.evaluate("tab => jupyterapp.shell.activateById(tab)", tab)
    lab.until("root => root.clientWidth > 0")
    lab.page.evaluate(FRAMES)
    assert lab.root.evaluate(read) == before
    lab.do("run")
    lab.ready("running")


def inspect_in_sight(lab):
    """The inspector opens in sight, however far the notebook is scrolled."""
    height = lab.root.evaluate("root => root.style.height")
    lab.root.evaluate("root => { root.style.height = '1500px'; root.scrollIntoView({ block: 'end' }); }")
    lab.find('[data-lrp="variables"] .lrp-variable').last.hover()
    lab.find('[data-lrp="variables"] [data-lrp-action="inspect"]').last.click()
    in_sight(lab, ".lrp-inspector")
    in_sight(lab, '[data-lrp-action="close-inspector"]')
    lab.do("close-inspector")
    lab.root.evaluate("(root, height) => { root.style.height = height; }", height)


def resize_and_reload(lab):
    """Sizes and hidden panels are kept; a height is kept as its share of the screen."""
    bar = lab.find('[role="separator"][aria-label="Width of the world"]:visible')
    usual = box(lab, "world")["width"]
    bar.focus()
    for _ in range(5):
        bar.press("ArrowLeft")
    assert box(lab, "world")["width"] == pytest.approx(usual - 0.1 * lab.box()["width"], abs=3)
    lab.do("menu")
    lab.choose("panel-robot")
    assert not lab.find('[data-lrp-tab="robot"]').is_visible()
    left = box(lab, "world")["width"]
    lab.root.scroll_into_view_if_needed()
    before = lab.box()
    corner = before["x"] + before["width"] - 4, before["y"] + before["height"] - 4
    lab.page.mouse.move(*corner)
    lab.page.mouse.down()
    lab.page.mouse.move(corner[0], corner[1] - 0.1 * before["height"], steps=4)
    lab.page.mouse.up()
    assert lab.box()["height"] == pytest.approx(0.9 * before["height"], abs=3)
    lab.notebook.save()
    lab.page.set_viewport_size({"width": 1280, "height": 880})  # the window of another day
    lab.page.reload()
    lab.notebook.ready()
    lab.notebook.begin_cell(1)
    lab.ready()
    assert lab.box()["height"] == pytest.approx(0.9 * (before["height"] - 20), abs=3)
    assert box(lab, "world")["width"] == pytest.approx(left, abs=1)
    assert not lab.find('[data-lrp-tab="robot"]').is_visible()
    lab.do("menu")
    lab.choose("usual-sizes")
    assert lab.box()["height"] == pytest.approx(before["height"] - 20, abs=3)
    lab.find('[role="separator"][aria-label="Width of the world"]:visible').dblclick()
    assert box(lab, "world")["width"] == pytest.approx(usual, abs=3)
    whole = lab.box(".lrp-panels")
    others = ("editor", "tree", "graph", "variables", "issues", "runs", "breakpoints")
    for part in others:  # the place of hidden ones goes to the others
        lab.do("menu")
        lab.choose(f"panel-{part}")
    assert box(lab, "world") == whole


def push_nothing_by_notes(lab):
    """Notes push nothing; restarts are counted, and the reason can be read."""
    for part in ("editor", "tree", "graph", "variables", "robot", "issues", "breakpoints"):
        lab.do("menu")
        lab.choose(f"panel-{part}")
    before = places_of(lab)
    lab.replace("n = n + 1", "n = n + 2")  # in the active state
    lab.sees(".lrp-notice:not([hidden])")
    lab.do("hold")
    lab.replace("(state rest)", "(state rest) (state more)")
    lab.sees('.lrp-note:not([hidden]) [data-lrp-action="apply"]')
    lab.do("menu")
    lab.choose("versions")
    lab.sees('form[aria-label="Versions"]:not([hidden])')
    assert places_of(lab) == before
    lab.page.keyboard.press("Escape")
    lab.sees(".lrp-restarts:visible")
    summary = lab.sees(".lrp-restarts summary")
    summary.focus()
    summary.press("Enter")
    lab.reads(".lrp-restart-list", "is active and its running changed")


def print_it(lab):
    """Its program, its graph and its world are whole, and one below the other."""
    lab.page.evaluate("dispatchEvent(new Event('beforeprint'))")  # as the browser does
    lab.page.emulate_media(media="print")
    try:
        lines = FOLLOWER.count("\n") + 1
        lab.until(
            "(editor, lines) => editor.querySelectorAll('.cm-line').length === lines", ".cm-content", lines
        )
        parts = [lab.box(part) for part in (".cm-content", ".lrp-graph", ".lrp-canvas")]
        tops = sorted((part["y"], part["y"] + part["height"]) for part in parts)
        assert all(end <= begin for (_, end), (begin, _) in pairwise(tops))
        assert lab.find(".lrp-button:visible").count() == 0
    finally:
        lab.page.emulate_media(media="screen")
        lab.page.evaluate("dispatchEvent(new Event('afterprint'))")
