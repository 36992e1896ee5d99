"""The plain page of a static site: one lab without a notebook, a server or a network."""

import zlib
from base64 import urlsafe_b64encode

import pytest

from e2e.pages import LabPage, comes_true
from e2e.test_site import SiteNotebook, run

COUNT = """\
(var n := [0])
(machine m
  (state count (running [n = n + 1])))
(spawn m count)
"""


STORED = """words => new Promise(resolve => {
  const opening = indexedDB.open("lrp-texts");
  opening.onsuccess = () => {
    const reading = opening.result.transaction("files").objectStore("files").getAll();
    reading.onsuccess = () => {
      opening.result.close();
      const texts = reading.result.map(content => new TextDecoder().decode(content));
      resolve(texts.some(text => text.includes(words)));
    };
  };
})"""

NEWER = """() => new Promise(resolve => {
  indexedDB.open("lrp-texts", 99).onsuccess = ({ target }) => { target.result.close(); resolve(); };
})"""


class PlainPage(LabPage):
    """The page of a visitor."""

    def __init__(self, page, site):
        super().__init__(page)
        self.site = site

    def show(self, address="", status="running"):
        self.page.goto(f"{self.site.url}/{address}")
        return self.ready(status)

    def again(self, status="running"):
        self.page.reload()
        return self.ready(status)

    def stores(self, words):
        """Wait until the browser has stored a text that contains these words."""
        comes_true(self.page, STORED, words)

    def says(self, words):
        """Wait until the line below the title says this."""
        self.page.locator("#status", has_text=words).wait_for()


@pytest.fixture
def plain(visitor, site):
    """The page of a visitor, online."""
    visitor.context.set_offline(False)
    return PlainPage(visitor, site)


@pytest.fixture
def counting(plain, request):
    """The page, in which a program of its own counts."""
    return plain.show(link(request.node.name))


def link(name, text=COUNT):
    """The address of a shared program, as the page makes it."""
    packed = zlib.compress(text.encode(), wbits=-15)
    return f"?program={name}#text={urlsafe_b64encode(packed).decode().rstrip('=')}"


def test_a_link_is_enough_for_a_robot_that_drives(plain, simulator):
    lab = plain.show()
    lab.goes_on()
    lab.state("follower/moving")
    picture = lab.find(".lrp-canvas").evaluate("canvas => canvas.toDataURL()")
    lab.until("(canvas, picture) => canvas.toDataURL() !== picture", ".lrp-canvas", picture)


def test_the_second_visit_needs_no_network(plain):
    plain.show("?program=stopwatch").goes_on()
    plain.page.context.set_offline(True)
    plain.again().goes_on()


def test_what_was_typed_is_there_when_the_page_is_loaded_again(counting):
    counting.type_after("[n = n + 1]))", "\n  (state rest)")
    counting.state("m/rest")
    counting.stores("(state rest)")
    counting.again()
    counting.state("m/rest")
    assert counting.find('[role="alertdialog"]:not([hidden])').count() == 0


def test_two_tabs_keep_what_is_typed_in_each(plain, visitors, site):
    lab = plain.show(link("first"))
    tab = PlainPage(plain.page.context.new_page(), site).show(link("second"))
    tab.type_after("[n = n + 1]))", "\n  (state here)")
    tab.stores("(state here)")
    tab.page.close()
    lab.type_after("[n = n + 1]))", "\n  (state there)")
    lab.stores("(state there)")
    lab.stores("(state here)")


def test_a_browser_that_does_not_store_what_is_typed_says_so(visitors, site):
    page = visitors()
    page.goto(f"{site.url}/site.json")
    page.evaluate(NEWER)  # no page of this version can use its storage
    other = PlainPage(page, site).show("?program=stopwatch")
    other.says("This browser does not keep what you type here")
    other.goes_on()


def test_a_browser_that_stores_no_more_says_so_when_one_types(visitors, site):
    lab = PlainPage(visitors(), site).show(link("typed"))
    lab.stores("(state count")
    lab.page.evaluate(NEWER)
    lab.type_after("[n = n + 1]))", "\n  (state rest)")
    lab.says("This browser does not keep what you type here")
    lab.state("m/rest")


def test_a_shared_link_opens_the_same_program_in_another_browser(counting, visitors, site):
    counting.page.locator("#share").click()
    counting.says("The link is copied")
    shared = counting.page.url
    other = PlainPage(visitors(), site).show(shared.removeprefix(f"{site.url}/"))
    other.state("m/count")
    assert other.text == COUNT


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
    lab.do("check")
    lab.page.locator("#restart").click()
    lab.reads(":scope", "did not answer and was started again")
    assert "sum(range(10**16))" in lab.text


def test_the_program_opens_in_a_notebook_and_runs_there_and_the_next_one_in_one_of_its_own(counting, request):
    plain, name = counting, f"{request.node.name}.ipynb"
    counting.page.locator("#notebook").click()
    counting.page.locator(".jp-Notebook .cm-content", has_text=f"%%lrp {request.node.name}").wait_for()
    lab = run(SiteNotebook(counting.page, counting.site, name).ready())
    assert "(machine m" in lab.text
    lab.goes_on()  # and is left open
    plain.show("?program=stopwatch")
    plain.page.locator("#notebook").click()
    plain.page.locator(".jp-Notebook .cm-content", has_text="%%lrp stopwatch --bridge none").wait_for()


def test_a_program_without_a_robot_has_none(plain):
    lab = plain.show("?program=stopwatch")
    assert not lab.find(".lrp-canvas").is_visible()
    lab.sees('[data-empty="The program runs without a robot."]')


def test_a_program_that_does_not_exist_is_told_with_a_suggestion(plain):
    plain.page.goto(f"{plain.site.url}/?program=folower")
    plain.says("There is no bundled program folower. Did you mean follower?")


def test_a_damaged_link_is_told(plain):
    plain.page.goto(f"{plain.site.url}/#text=%%%")
    plain.says("the link is damaged")
