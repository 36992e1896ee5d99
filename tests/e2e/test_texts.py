"""What was typed or kept survives reruns, ends of kernels and other programs; nothing hidden runs."""

import pytest

from e2e import axe
from e2e.pages import NotebookPage
from e2e.programs import COUNTER

RERUNS = 30
GROWTH = 5e6  # bytes


def heap(page):
    """Return the bytes that the page's scripts hold."""
    session = page.context.new_cdp_session(page)
    for _ in range(3):
        session.send("HeapProfiler.collectGarbage")
    used = session.send("Runtime.getHeapUsage")["usedSize"]
    session.detach()
    return used


def test_a_cell_that_is_run_again_thirty_times_costs_the_page_no_memory(open_lab):
    lab = open_lab(COUNTER)
    for _ in range(3):
        lab.notebook.run_cell(1)
        lab.ready()
    before = heap(lab.page)
    for _ in range(RERUNS):
        lab.notebook.run_cell(1)
        lab.ready()
    grown = heap(lab.page) - before
    assert grown < GROWTH


# -- after the end of a kernel ---------------------------------------------------------------------


def again(lab):
    """Run the cells again after the end of the kernel."""
    lab.notebook.run_cell(0)
    lab.notebook.run_cell(1)
    lab.sees(':scope[data-link="live"]')
    lab.ready()


def test_a_text_that_is_not_a_program_comes_back_after_the_kernel_ended(open_lab):
    lab = open_lab(COUNTER)
    lab.type_after("(state rest)", ") third")
    lab.sees('[data-lrp-issue^="LRP1"]')
    lab.goes_on()
    lab.notebook.restart_kernel()
    lab.sees(':scope[data-link="dead"]')
    again(lab)
    lab.reads('[role="alertdialog"]', "Which text should be kept?")
    assert lab.text == COUNTER
    lab.do("take")
    lab.reads(".cm-content", "(state rest)) third")
    lab.misses('[role="alertdialog"]:not([hidden])')


def test_what_is_typed_after_the_kernel_ended_comes_back_in_the_next_view(open_lab):
    lab = open_lab(COUNTER)
    lab.type_after("(state rest)", " (state third)")
    lab.sees('[data-lrp-state="m/third"]')
    lab.notebook.restart_kernel()
    lab.sees(':scope[data-link="dead"]')
    lab.find(".cm-content").focus()
    lab.page.keyboard.type(" (state fourth)")
    again(lab)
    lab.reads('[role="alertdialog"]', "Which text should be kept?")
    lab.do("take")
    lab.sees('[data-lrp-state="m/fourth"]')
    lab.sees('[data-lrp-state="m/third"]')
    lab.misses('[role="alertdialog"]:not([hidden])')


def test_what_is_typed_after_the_kernel_ended_survives_a_reload_of_the_page(open_lab):
    lab = open_lab(COUNTER)
    lab.find(".cm-content").press("Control+s")
    lab.notebook.is_saved()
    lab.notebook.restart_kernel()
    lab.sees(':scope[data-link="dead"]')
    lab.type_after("(state rest)", " (state third")
    lab.page.reload()
    lab.notebook.ready()
    again(lab)
    lab.reads('[role="alertdialog"]', "Which text should be kept?")
    lab.do("take")
    lab.reads(".cm-content", "(state third")


# -- texts of others -------------------------------------------------------------------------------


@pytest.fixture
def open_given(page, server, request):
    """Open a notebook beside a kept text that came with the folder."""

    def open_given(text, source):
        notebook = NotebookPage(page, server, f"{request.node.name}/notebook.ipynb")
        server.write(notebook.name, ["%load_ext lrp_jupyter", source])
        folder = notebook.path.parent / ".lrp"
        folder.mkdir()
        (folder / "demo.lrp").write_text(text)
        notebook.show()
        notebook.run_cell(0)
        notebook.run_cell(1)
        lab = notebook.lab().ready()
        lab.notebook = notebook
        return lab

    return open_given


@pytest.mark.parametrize("source", [f"%%lrp demo\n{COUNTER}", "%%lrp demo"], ids=["cell", "name"])
def test_a_hidden_text_of_a_stranger_does_not_run_before_it_is_chosen(open_given, source):
    stranger = "(machine m (state a (onentry [open('owned', 'w')])) (state b)) (spawn m a)" + " " * 400 + ";"
    lab = open_given(stranger, source)
    owned = lab.notebook.path.parent / "owned"
    lab.reads('[role="alertdialog"]', "that you have not written here")
    lab.goes_on()
    assert not owned.exists()
    lab.find('[role="alertdialog"] summary').press("Enter")
    lab.reads('[role="alertdialog"] pre', "open('owned', 'w')")
    shown, note = '[role="alertdialog"] pre', '[role="alertdialog"]'
    assert lab.find(shown).evaluate("text => text.scrollWidth <= text.clientWidth")  # the whole line
    assert lab.find(note).evaluate("note => note.scrollWidth <= note.clientWidth")
    lab.find('[data-lrp-action="keep-text"]').press("Enter")
    lab.misses('[role="alertdialog"]:not([hidden])')
    lab.notebook.run_cell(1)
    lab.ready().goes_on()
    assert not owned.exists()


def test_a_file_that_was_changed_outside_is_asked_about_and_not_overwritten(open_lab):
    lab = open_lab(COUNTER)
    lab.type_after("(state rest)", " (state third)")
    lab.sees('[data-lrp-state="m/third"]')
    lab.goes_on()
    file = lab.notebook.path.parent / ".lrp" / "m.lrp"
    outside = COUNTER.replace("(state rest)", "(state rest) (state outside)")
    file.write_text(outside)
    lab.type_after("(state third)", " (state fourth)")
    lab.sees('[data-lrp-state="m/fourth"]')
    lab.reads('[role="alertdialog"]', "was changed outside this lab")
    lab.find('[role="alertdialog"] summary').press("Enter")
    lab.reads('[role="alertdialog"] ins', "(state outside)")
    lab.reads('[role="alertdialog"] del', "(state fourth)")
    assert lab.find('[role="alertdialog"] ins').count() == 1
    axe.finds_nothing_serious(lab)
    lab.goes_on()
    assert file.read_text() == outside
    lab.do("take")
    lab.sees('[data-lrp-state="m/outside"]')
    lab.misses('[data-lrp-state="m/fourth"]')


# -- versions and files ----------------------------------------------------------------------------


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_a_deleted_text_is_returned_to_by_keys_alone(open_lab, theme):
    lab = open_lab(COUNTER)
    axe.choose_theme(lab, theme)
    press = lab.page.keyboard.press
    lab.find(".cm-content").focus()
    press("Control+a")
    press("Delete")
    lab.reads(".lrp-verdict", "missing from the new text")
    lab.find('[data-lrp-action="menu"]').focus()
    press("Enter")
    press("v")
    lab.until("item => item === document.activeElement", '[role="menu"] [data-lrp-action="versions"]')
    press("Enter")
    lab.until("list => list === document.activeElement", '[aria-label="Version"]')
    lab.reads('form[aria-label="Versions"] pre', "(state count")
    axe.finds_nothing_serious(lab)
    press("Tab")
    press("Enter")
    lab.reads(".lrp-verdict", "runs")
    assert lab.text == COUNTER


def test_saving_asks_before_it_replaces_a_file(open_lab):
    lab = open_lab(COUNTER)
    file = lab.notebook.path.parent / "other.lrp"
    file.write_text("precious")
    press = lab.page.keyboard.press
    for answer, text in (("Escape", "precious"), ("Enter", COUNTER)):
        lab.do("menu")
        lab.choose("save")
        lab.find('[aria-label="File"]').fill("other.lrp")
        press("Enter")
        lab.until("button => button === document.activeElement", '[data-lrp-action="replace-file"]')
        press(answer)
        lab.misses('[data-lrp-action="replace-file"] >> visible=true')
        assert file.read_text() == text


@pytest.fixture
def small_window(page):
    """The window of a small laptop, in which the lab is stacked and higher than the window."""
    page.set_viewport_size({"width": 1280, "height": 800})
    return page


def test_a_text_that_cannot_be_kept_is_marked_beside_the_name(open_lab, small_window):
    lab = open_lab(COUNTER)
    lab.goes_on()
    folder = lab.notebook.path.parent / ".lrp"
    folder.rename(folder.with_name("away"))
    folder.write_text("a file")
    lab.type_after("(state rest)", " (state third)")
    mark = lab.sees('[data-lrp-action="unkept"]:not([hidden])')
    assert mark.inner_text() == "Not kept"
    mark.press("Enter")
    lab.reads(".lrp-toast", "is a file")
    toast = lab.box(".lrp-toast")
    assert toast["y"] + toast["height"] < small_window.viewport_size["height"], "it is in view"
    folder.unlink()
    lab.find('[data-lrp-action="unkept"]').wait_for(state="hidden")
    assert "(state third)" in (folder / "m.lrp").read_text()
