"""The lab in each notebook that can run here: the same page, the same promises."""

import pytest

from e2e import hosts
from e2e.conftest import WAIT, WINDOW

PARTS = ("controls", "editor", "tree", "graph", "world", "variables", "issues", "timeline")
COLOURS = """canvas => {
  const { width, height } = canvas;
  const { data } = canvas.getContext('2d').getImageData(0, 0, width, height);
  const colours = new Set();
  for (let at = 0; at < data.length; at += 4)
    if (data[at + 3] === 255) colours.add(data.slice(at, at + 3).join());
  return colours.size > 20 && [...colours];
}"""


@pytest.fixture(
    scope="module",
    params=[
        "JupyterLab",
        "Notebook",
        pytest.param("marimo run", marks=pytest.mark.host("marimo")),
        pytest.param("marimo edit", marks=pytest.mark.host("marimo")),
        pytest.param("Voila", marks=pytest.mark.host("voila")),
    ],
)
def host(request, context, server, tmp_path_factory):
    """A notebook with a lab and its state graph; the lab as the test before has left it."""
    page = context.new_page()
    page.set_viewport_size(WINDOW)
    page.set_default_timeout(WAIT)
    app, _, mode = request.param.partition(" ")
    if app == "marimo":
        opened = hosts.marimo(page, tmp_path_factory.mktemp(mode), mode)
    elif app == "Voila":
        opened = hosts.voila(page, tmp_path_factory.mktemp("voila"))
    else:
        opened = hosts.jupyter(page, server, "lab/tree" if app == "JupyterLab" else "notebooks")
    with opened as host:
        host.name = request.param
        yield host
        page.close()
    server.end_kernels()


def test_all_parts_are_there(host):
    lab = host.lab.ready()
    for part in PARTS:
        lab.sees(f'[data-lrp="{part}"]')
    lab.is_active("m/count")


def test_the_world_has_its_colours(host):
    colours = host.lab.ready().until(COLOURS, ".lrp-canvas")
    assert "255,255,255" in colours  # the floor
    assert any(len(set(colour.split(","))) == 3 for colour in colours)  # the robot, which is blue


def test_what_is_typed_is_in_the_graph_of_the_lab_and_in_its_other_part(host):
    lab = host.lab.ready()
    lab.type_after("(state rest)", " (state third)")
    for part in (lab, host.graph):
        part.sees('[data-lrp-state="m/third"]')
    assert "(state rest) (state third)" in lab.text


def test_a_menu_is_used_by_the_pointer_and_the_keyboard(host):
    lab = host.lab.ready()
    lab.do("world-menu")
    lab.choose("grid")
    lab.misses('[role="menu"]')
    lab.do("world-menu")
    lab.page.keyboard.press("Escape")
    lab.misses('[role="menu"]')
    focus = "root => root.getRootNode().activeElement?.dataset.lrpAction === 'world-menu'"
    assert lab.until(focus)


def test_the_program_pauses_and_goes_on_in_both_parts(host):
    lab = host.lab.ready().pause()
    host.graph.ready("paused")
    tick = lab.tick
    lab.do("run")
    lab.ready().goes_on()
    assert lab.tick > tick


def test_a_page_that_is_loaded_again_shows_the_lab(host):
    lab = host.lab.ready()
    lab.goes_on()
    lab.type_after("(state rest)", " (state fourth)")
    lab.sees('[data-lrp-state="m/fourth"]')
    tick = lab.tick
    host.reload()
    lab = host.lab.ready()
    if host.name == "Voila":
        assert lab.tick < tick  # the visit has a kernel of its own
    else:
        lab.sees('[data-lrp-state="m/fourth"]')
        assert lab.tick > tick
    lab.goes_on()
