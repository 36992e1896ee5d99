"""The plain page of a static site: one lab without a notebook, a server or a network.

Loading the page starts Python, which takes its time: tests that need no new page go on in the last one's.
"""

import pytest

from e2e.conftest import WINDOW
from e2e.sites import COUNT, PlainPage, link
from lrp_jupyter import programs

NEWER = """() => new Promise(resolve => {
  indexedDB.open("lrp-texts", 99).onsuccess = ({ target }) => { target.result.close(); resolve(); };
})"""

PRINTED = """async root => {
  dispatchEvent(new Event("beforeprint")); // the editor draws all lines for a moment
  for (let n = 0; n < 3; n++) await new Promise(requestAnimationFrame); // the panels have other sizes
  const box = found => found.getBoundingClientRect();
  const part = name => root.querySelector(`[data-lrp="${name}"]`);
  const panels = ["world", "editor", "graph", "variables", "issues", "goal"].map(part).map(box);
  const shown = panels.filter(({ height }) => height).sort((one, other) => one.top - other.top);
  const [graph, drawing] = [root.querySelector(".lrp-graph"), root.querySelector(".lrp-graph > g")].map(box);
  const printed = {
    panels: shown.length,
    overlaps: shown.some(({ top }, at) => at && top < shown[at - 1].bottom - 1),
    width: Math.min(...shown.map(({ width }) => width)) / box(root).width,
    lines: root.querySelectorAll(".cm-line").length,
    isWhole: drawing.left >= graph.left - 1 && drawing.right <= graph.right + 1
      && drawing.top >= graph.top - 1 && drawing.bottom <= graph.bottom + 1,
    isOnPaper: document.documentElement.scrollHeight >= box(root).bottom + scrollY - 1,
  };
  dispatchEvent(new Event("afterprint"));
  return printed;
}"""


@pytest.fixture
def plain(visitor, site):
    """The page of a visitor, online."""
    visitor.context.set_offline(False)
    return PlainPage(visitor, site)


@pytest.fixture(scope="module")
def other(visitors, site):
    """The page of a visitor with another browser."""
    return PlainPage(visitors(), site)


@pytest.fixture
def counting(plain, request):
    """The page, in which a program of its own counts."""
    return plain.show(link(request.node.name))


def test_a_link_is_enough_for_a_robot_that_drives(plain, simulator):
    lab = plain.show()
    lab.state("follower/moving")
    lab.drives()


def test_on_paper_program_graph_and_world_are_whole_and_one_below_the_other(plain, simulator):
    lab = plain.show()
    lines = len(programs.load("follower").split("\n"))
    for width, height in ((700, 900), (WINDOW["width"], WINDOW["height"])):
        lab.page.set_viewport_size({"width": width, "height": height})
        lab.at_rest(".lrp-canvas")
        lab.at_rest(".lrp-graph .lrp-layer-states")
        lab.page.emulate_media(media="print")
        printed = lab.root.evaluate(PRINTED)
        lab.page.emulate_media(media="screen")
        assert printed.pop("width") > 0.9
        assert printed == {
            "panels": 4,
            "overlaps": False,
            "lines": lines,
            "isWhole": True,
            "isOnPaper": True,
        }


def test_a_program_without_a_robot_has_none(plain):
    lab = plain.show("?program=stopwatch")
    assert not lab.find(".lrp-canvas").is_visible()
    lab.sees('[data-empty="The program runs without a robot."]')


def test_what_was_typed_is_there_when_the_page_is_loaded_again_without_a_network(counting):
    counting.type_after("[n = n + 1]))", "\n  (state rest)")
    counting.state("m/rest")
    counting.stores("(state rest)")
    counting.page.context.set_offline(True)
    counting.again().goes_on()
    counting.state("m/rest")
    assert counting.find('[role="alertdialog"]:not([hidden])').count() == 0


def test_two_tabs_keep_what_is_typed_in_each(plain, site):
    lab = plain.show(link("first"))
    tab = PlainPage(plain.page.context.new_page(), site).show(link("second"))
    tab.type_after("[n = n + 1]))", "\n  (state here)")
    tab.stores("(state here)")
    tab.page.close()
    lab.type_after("[n = n + 1]))", "\n  (state there)")
    lab.stores("(state there)")
    lab.stores("(state here)")


def test_a_shared_link_opens_the_same_program_in_another_browser(counting, other, site):
    counting.page.locator("#share").click()
    counting.says("The link is copied")
    other.show(counting.page.url.removeprefix(f"{site.url}/"))
    other.state("m/count")
    assert other.text == COUNT


def test_a_browser_that_stores_no_more_says_so_when_one_types_and_when_the_page_is_loaded_again(other):
    lab = other.show(link("typed"))
    lab.stores("(state count")
    lab.page.evaluate(NEWER)  # no page of this version can use its storage
    lab.type_after("[n = n + 1]))", "\n  (state rest)")
    lab.says("This browser does not keep what you type here")
    lab.state("m/rest")
    lab.again().says("This browser does not keep what you type here")
    lab.goes_on()


def test_a_block_that_does_not_return_pauses_the_program(counting):
    counting.select("[n = n + 1]")
    counting.page.keyboard.insert_text("[while True: pass]")
    counting.ready("paused")
    counting.reads(":scope", "did not return within")


def test_python_that_does_not_answer_is_started_again_with_the_text(counting):
    counting.select("[n = n + 1]")
    counting.page.keyboard.insert_text("[sum(range(10**15))]")
    counting.page.locator("#restart").click()
    counting.ready("paused")
    counting.reads(":scope", "did not answer and was started again")
    counting.reads(":scope", "sum(range(10**15))")  # in the editor, or offered


def test_the_challenges_are_offered_by_series(plain):
    plain.show()
    groups = plain.page.locator("#picker optgroup")
    labels = groups.evaluate_all("found => found.map(each => each.label)")
    assert labels == ["Programs", "Challenges", "Exercises of the lessons", "Find the bug"]


def test_a_challenge_is_checked_beside_its_robot(plain, simulator):
    lab = plain.show("?challenge=first move")
    lab.do("check")
    lab.sees(".lrp-result[data-state='failed']")
    lab.select("robot.stop()")
    lab.page.keyboard.insert_text("robot.move(linear=0.2)")
    lab.goes_on()
    lab.do("check")
    lab.sees(".lrp-result[data-state='met']")


def test_a_check_that_does_not_return_leaves_a_way_out(plain, simulator):
    lab = plain.show("?challenge=there and back")
    lab.pause()
    lab.select("robot.move(linear=0.2)")
    lab.page.keyboard.insert_text("sum(range(10**16))")
    lab.find('[data-lrp-action="check"]').evaluate("button => button.click()")  # at once
    lab.page.locator("#restart").click()
    lab.reads(":scope", "did not answer and was started again")
    lab.reads(".cm-content", "sum(range(10**16))")


def test_an_address_that_leads_nowhere_is_told(plain):
    plain.show("?program=stopwatch")
    plain.go("#text=%%%")
    plain.says("the link is damaged")
    plain.go("?program=folower")
    plain.says("There is no bundled program folower. Did you mean follower?")
