"""The places of the panels: in one screen, the world first, kept as their user left them. Keys of the lab."""

from itertools import combinations

import pytest

from e2e import axe
from e2e.pages import APP
from e2e.programs import COUNTER, FOLLOWER

DIAMETER = 0.16  # m, of the bundled robot
PANELS = ("editor", "tree", "graph", "world", "variables", "issues")
SCREENS = [(1280, 800), (1600, 1000), (1900, 1000), (900, 900), (700, 900)]


@pytest.fixture
def screen(page):
    """Set the size of the window."""
    return lambda width, height: page.set_viewport_size({"width": width, "height": height})


@pytest.fixture
def open_follower(open_lab, screen):
    """Open the follower as its user does, by Shift+Enter, in a window of this size."""

    def open_follower(width=1280, height=800, *more):
        screen(width, height)
        lab = open_lab(FOLLOWER, "follower --world line", *more)
        lab.goes_on()
        return lab

    return open_follower


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


def nothing_overlaps(lab):
    for one, other in combinations(PANELS, 2):
        a, b = box(lab, one), box(lab, other)
        assert (
            a["x"] + a["width"] <= b["x"] + 1
            or b["x"] + b["width"] <= a["x"] + 1
            or a["y"] + a["height"] <= b["y"] + 1
            or b["y"] + b["height"] <= a["y"] + 1
        ), (one, other)


# -- places ----------------------------------------------------------------------------------------


def test_everything_is_in_one_screen_beside_the_file_browser(open_follower):
    lab = open_follower(1280, 800)
    lab.root.evaluate("root => root.scrollIntoView()")
    for part in PANELS:
        in_sight(lab, f'[data-lrp="{part}"]')
    nothing_overlaps(lab)


@pytest.mark.parametrize(("width", "height"), [size for size in SCREENS if size[0] >= 1280])
def test_the_world_is_the_widest_picture_and_the_robot_can_be_seen(open_follower, width, height):
    lab = open_follower(width, height)
    canvas = lab.box(".lrp-canvas")
    left, right = lab.place(0, 0)[0], lab.place(1, 0)[0]
    assert DIAMETER * (right - left) >= 24
    assert canvas["width"] >= 0.39 * lab.box()["width"]
    assert canvas["width"] >= box(lab, "graph")["width"]


def test_a_lab_in_a_tab_that_was_away_is_as_it_was(open_follower):
    lab = open_follower()
    lab.pause()
    read = (
        "root => [root.querySelector('.lrp-variables').scrollTop,"
        " root.querySelector('.lrp-graph > g').getAttribute('transform'), root.style.cssText]"
    )
    lab.root.evaluate("root => { root.querySelector('.lrp-variables').scrollTop = 30; }")
    before = lab.root.evaluate(read)
    assert before[0] == 30
    tab = lab.page.evaluate("jupyterapp.shell.currentWidget.id")
    lab.page.evaluate("() => jupyterapp.commands.execute('launcher:create')")
    lab.until("root => root.clientWidth === 0")
    lab.page.evaluate("() => new Promise(done => setTimeout(done, 200))")  # what is observed is reported
    lab.page.evaluate("tab => jupyterapp.shell.activateById(tab)", tab)
    lab.until("root => root.clientWidth > 0")
    lab.page.evaluate("() => new Promise(done => setTimeout(done, 200))")
    assert lab.root.evaluate(read) == before


@pytest.mark.parametrize(("width", "height"), [(900, 900), (700, 900)])
def test_where_there_is_little_room_the_world_is_above_the_other_panels(open_follower, width, height):
    lab = open_follower(width, height)
    places = {part: box(lab, part) for part in PANELS}
    assert min(places, key=lambda part: places[part]["y"]) == "world"
    assert len({place["x"] for place in places.values()}) == 1
    assert lab.root.evaluate("root => root.scrollWidth <= root.clientWidth")
    nothing_overlaps(lab)
    lab.root.evaluate("root => root.scrollIntoView()")
    in_sight(lab, '[data-lrp-action="stop"]')
    in_sight(lab, ".lrp-status")


def test_the_robot_is_in_sight_after_shift_enter(open_notebook, screen):
    screen(1280, 800)
    notebook = open_notebook("%load_ext lrp_jupyter", f"%%lrp follower\n{FOLLOWER}", "1", "2")
    notebook.run_cell(0)
    notebook.page.locator(".jp-CodeCell").nth(1).locator(".cm-content").click()
    notebook.page.keyboard.press("Shift+Enter")
    lab = notebook.lab().ready()
    in_sight(lab, ".lrp-canvas")
    in_sight(lab, '[data-lrp-action="stop"]')


def test_the_inspector_opens_in_sight_however_far_the_notebook_is_scrolled(open_follower):
    lab = open_follower(1280, 800)
    lab.root.evaluate("root => { root.style.height = '1500px'; root.scrollIntoView({ block: 'end' }); }")
    lab.find('[data-lrp="variables"] .lrp-variable').last.hover()
    lab.find('[data-lrp="variables"] [data-lrp-action="inspect"]').last.click()
    in_sight(lab, ".lrp-inspector")
    in_sight(lab, '[data-lrp-action="close-inspector"]')


# -- sizes, hidden panels ------------------------------------------------------------------------


def test_sizes_and_hidden_panels_are_kept_over_a_reload(open_follower):
    lab = open_follower()
    bar = lab.find('[role="separator"][aria-label="Width of the world"]:visible')
    before = box(lab, "world")["width"]
    bar.focus()
    for _ in range(5):
        bar.press("ArrowRight")
    assert box(lab, "world")["width"] == pytest.approx(before - 0.1 * lab.box()["width"], abs=3)
    lab.do("menu")
    lab.choose("panel-issues")
    assert not lab.find('[data-lrp="issues"]').is_visible()
    left = box(lab, "world")
    lab.notebook.save()
    lab.page.reload()
    lab.notebook.ready()
    lab.notebook.begin_cell(1)
    again = lab.notebook.lab().ready()
    assert box(again, "world")["width"] == pytest.approx(left["width"], abs=1)
    assert not again.find('[data-lrp="issues"]').is_visible()
    again.find('[role="separator"][aria-label="Width of the world"]:visible').dblclick()
    assert box(again, "world")["width"] == pytest.approx(before, abs=3)


def test_the_height_given_to_the_lab_is_kept_as_its_share_of_the_screen(open_follower, screen):
    lab = open_follower(1280, 900)
    lab.root.scroll_into_view_if_needed()
    before = lab.box()
    corner = before["x"] + before["width"] - 4, before["y"] + before["height"] - 4
    lab.page.mouse.move(*corner)
    lab.page.mouse.down()
    lab.page.mouse.move(corner[0], corner[1] - 0.3 * before["height"], steps=4)
    lab.page.mouse.up()
    assert lab.box()["height"] == pytest.approx(0.7 * before["height"], abs=3)
    lab.notebook.save()
    screen(1280, 800)  # the window of another day
    lab.page.reload()
    lab.notebook.ready()
    lab.notebook.begin_cell(1)
    again = lab.notebook.lab().ready()
    assert again.box()["height"] == pytest.approx(0.7 * (before["height"] - 100), abs=3)
    again.do("menu")
    again.choose("usual-sizes")
    assert again.box()["height"] == pytest.approx(before["height"] - 100, abs=3)


def test_the_place_of_a_hidden_panel_goes_to_the_others(open_follower):
    lab = open_follower()
    whole = lab.box(".lrp-panels")
    for part in ("editor", "tree", "graph", "variables", "issues"):
        lab.do("menu")
        lab.choose(f"panel-{part}")
    assert box(lab, "world") == whole


# -- one panel alone, the lab alone ----------------------------------------------------------------


def test_a_double_click_on_its_head_enlarges_a_panel_and_another_returns(open_follower):
    lab = open_follower()
    before = box(lab, "world")
    lab.find('[data-lrp="world"] .lrp-title').dblclick()
    assert box(lab, "world") == lab.box(".lrp-panels")
    assert not lab.find('[data-lrp="editor"]').is_visible()
    lab.find('[data-lrp="world"] .lrp-title').dblclick()
    assert box(lab, "world") == before
    assert lab.find('[data-lrp="editor"]').is_visible()


def test_a_key_enlarges_the_panel_of_the_focus_and_a_button_does(open_follower):
    lab = open_follower()
    for part in PANELS:
        lab.find(f'[data-lrp="{part}"] [data-lrp-action="enlarge"]').focus()
        lab.page.keyboard.press("F9")
        assert box(lab, part) == lab.box(".lrp-panels"), part
        lab.find(f'[data-lrp="{part}"] [data-lrp-action="enlarge"]').click()
        assert lab.find('[role="separator"]:visible').count() == 4


def test_another_key_lets_the_lab_fill_the_window(open_follower):
    lab = open_follower()
    lab.find(".cm-content").focus()
    lab.page.keyboard.press("Shift+F9")
    assert lab.box() == {"x": 0, "y": 0, "width": 1280, "height": 800}
    lab.page.keyboard.type("; typed")
    assert "; typed" in lab.text
    lab.page.keyboard.press("Shift+F9")
    assert lab.box()["width"] < 900
    lab.page.keyboard.type(" on")
    assert "; typed on" in lab.text


@pytest.mark.parametrize(("width", "height"), SCREENS)
def test_the_head_of_the_graph_shows_its_title_and_its_mode_whole(open_follower, width, height):
    lab = open_follower(width, height)
    title, mode = '[data-lrp="graph"] .lrp-title', '[data-lrp="graph"] .lrp-select'
    lab.until("select => select.offsetWidth >= 56", mode)  # with less the arrow lies on its word
    assert lab.box(title)["x"] + lab.box(title)["width"] <= lab.box(mode)["x"]
    lab.do("graph-menu")
    before = lab.box('[data-lrp-state="follower/moving"]')["width"]
    lab.choose("menu-zoom-in")
    lab.until(f"node => node.getBoundingClientRect().width > {before}", '[data-lrp-state="follower/moving"]')


def test_the_title_of_the_breakpoints_is_whole_in_a_low_panel(open_follower):
    lab = open_follower(1280, 800)
    panel, title = box(lab, "issues"), lab.box(".lrp-breakpoint-list > summary")
    assert title["y"] + title["height"] <= panel["y"] + panel["height"] + 0.5


# -- keys ------------------------------------------------------------------------------------------


def test_keys_on_the_controls_do_not_reach_the_notebook(open_follower):
    lab = open_follower(1280, 800, "1", "2")
    for action in ("reset", "follow", "zoom-fit"):
        lab.do(action)
        for key in ("x", "a", "b", "d", "d", "ArrowDown", "m", "z"):
            lab.page.keyboard.press(key)
    lab.goes_on()
    assert cells(lab) == 4
    assert lab.page.evaluate(f"{APP}.content.activeCellIndex") == 1


def test_arrow_keys_move_the_rate_after_a_click_on_it(open_follower):
    lab = open_follower()
    lab.do("rate")
    slider = lab.sees('[data-lrp-action="rate"]')
    before = int(slider.input_value())
    lab.page.keyboard.press("ArrowRight")
    lab.page.keyboard.press("ArrowRight")
    assert int(slider.input_value()) == before + 2


# -- notes -----------------------------------------------------------------------------------------


def test_notes_push_nothing(open_lab):
    lab = open_lab(COUNTER)
    before = {part: box(lab, part) for part in PANELS}
    lab.replace("n = n + 1", "n = n + 2")  # in the active state
    lab.sees(".lrp-notice:not([hidden])")
    lab.do("hold")
    lab.replace("(state rest)", "(state rest) (state more)")
    lab.sees('.lrp-note:not([hidden]) [data-lrp-action="apply"]')
    lab.do("menu")
    lab.choose("versions")
    lab.sees('form[aria-label="Versions"]:not([hidden])')
    assert {part: box(lab, part) for part in PANELS} == before


def test_a_restart_is_counted_and_its_reason_can_be_read_later(open_lab):
    lab = open_lab(COUNTER)
    lab.replace("n = n + 1", "n = n + 2")
    lab.sees(".lrp-notice:not([hidden])")
    lab.sees(".lrp-notice[hidden]")
    summary = lab.sees(".lrp-restarts summary")
    summary.focus()
    summary.press("Enter")
    lab.reads(".lrp-restart-list", "is active and its running changed")


# -- axe -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_axe_finds_nothing_serious_at_any_size_nor_in_a_panel_alone(open_lab, screen, theme):
    lab = open_lab(COUNTER)
    axe.choose_theme(lab, theme)
    for width, height in SCREENS:
        screen(width, height)
        axe.finds_nothing_serious(lab)
    for part in PANELS:
        lab.find(f'[data-lrp="{part}"] [data-lrp-action="enlarge"]').click()
        axe.finds_nothing_serious(lab)
        lab.find(f'[data-lrp="{part}"] [data-lrp-action="enlarge"]').click()
