"""Pages come and go, cells run again, kernels end: the program and its text stay, and nothing hidden runs."""

from support.waiting import until

from e2e import axe
from e2e.pages import LabPage, NotebookPage
from e2e.programs import COUNTER, FOLLOWER

RERUNS = 15
GROWTH = 2.5e6  # bytes
ALERT = '[role="alertdialog"]'
TYPED = "The kernel ended before all that was typed"
KEPT = "The lab's last text"
PARTS = """\
import lrp_jupyter, ipywidgets
ipywidgets.HBox([lrp_jupyter.StateGraph('follower'), lrp_jupyter.Variables('follower')])"""


def asked(lab, which="Which text should be kept?"):
    lab.reads(ALERT, which)


def is_answered(lab):
    lab.misses(f"{ALERT}:not([hidden])")


def third(lab):
    lab.type_after("(state rest)", " (state third)")
    lab.sees('[data-lrp-state="m/third"]')


def cell(lab, program):
    """Write a program into the cell, and run it."""
    lab.notebook.write_cell(1, f"%%lrp m\n{program}")
    lab.notebook.run_cell(1)
    lab.ready()


def again(lab, which):
    """Run the cells again after the end of the kernel; the lab asks about the text that was typed.

    What the page has kept it asks a moment after what the kernel had: that is another question.
    """
    lab.notebook.run_cell(0)
    lab.notebook.run_cell(1)
    lab.sees(':scope[data-link="live"]')
    lab.ready()
    asked(lab, which)


# -- pages and cells -------------------------------------------------------------------------------


def test_a_program_stays_when_pages_are_loaded_and_cells_run_again(open_lab):
    lab = open_lab(COUNTER.replace("[1000]", "[9999]"), "m", "%lrp follower", PARTS)
    load_the_page_again(lab)
    run_the_cell_again(lab)
    show_one_program_twice(lab.notebook.open(FOLLOWER, "follower --world line"))


def load_the_page_again(lab):
    third(lab)
    lab.notebook.save()
    tick = lab.tick
    lab.page.reload()
    lab.notebook.ready()
    lab.ready()
    lab.sees('[data-lrp-state="m/third"]')
    assert "(state third)" in lab.text
    assert lab.tick > tick
    assert lab.page.locator(".jp-RenderedSVG img").count() == 0, "the lab replaces its stored picture"
    lab.find(".cm-content").focus()
    lab.page.keyboard.type(" (state fourth)")
    lab.sees('[data-lrp-state="m/fourth"]')
    assert "(state third) (state fourth)" in lab.text, "the cursor was there"


def run_the_cell_again(lab):
    """It patches the running program, costs the page no memory, and asks where both texts have changed."""
    counted = int(lab.value("m/n"))
    program = COUNTER.replace("(state rest)", "(state rest) (state written)")
    cell(lab, program)
    asked(lab)
    lab.sees('[data-lrp-state="m/third"]')
    lab.do("take")
    lab.sees('[data-lrp-state="m/written"]')
    lab.misses('[data-lrp-state="m/third"]')
    cell(lab, program)  # unchanged: the same lab again
    is_answered(lab)
    cell(lab, program.replace("written", "changed"))
    lab.sees('[data-lrp-state="m/changed"]')
    for _ in range(3):
        lab.notebook.run_cell(1)
        lab.ready()
    before = heap(lab.page)
    for _ in range(RERUNS):
        lab.notebook.run_cell(1)
        lab.ready()
    assert heap(lab.page) - before < GROWTH
    assert int(lab.value("m/n")) >= counted


def heap(page):
    """Return the bytes that the page's scripts hold."""
    session = page.context.new_cdp_session(page)
    for _ in range(3):
        session.send("HeapProfiler.collectGarbage")
    used = session.send("Runtime.getHeapUsage")["usedSize"]
    session.detach()
    return used


def show_one_program_twice(lab):
    """Two labs agree, and so do single parts in a layout of one's own."""
    notebook = lab.notebook
    notebook.run_cell(2)
    other = notebook.lab(1).ready()
    other.type_after("(running [robot.move(linear=back)]))", " (state third)")
    lab.sees('[data-lrp-state="follower/third"]')
    notebook.run_cell(3)
    graph = LabPage(lab.page, root='[data-part="graph"]')
    graph.sees('[data-lrp-state="follower/third"]')
    assert graph.find(".cm-content").count() == 0
    lab.state("follower/looking").dblclick()
    other.sees('[data-lrp-state="follower/looking/lookalgo/lookleft"]')
    lab.pause()
    other.ready("paused")
    other.until("(root, tick) => Number(root.dataset.lrpTick) === tick", argument=lab.tick)
    lab.replace("200", "250")
    LabPage(lab.page, root='[data-part="variables"]').has_value("maxlook", "250")


# -- kernels ---------------------------------------------------------------------------------------


def test_what_was_typed_comes_back_after_the_end_of_a_kernel(open_lab, server):
    lab = open_lab(COUNTER)
    lab.find(".cm-content").press("Control+s")
    lab.notebook.is_saved()
    third(lab)
    restart(lab)
    assert "(state third)" in lab.text
    lab.find(".cm-content").focus()
    lab.page.keyboard.type(" (state fourth)")  # to no kernel
    again(lab, TYPED)
    assert "(state third)" not in lab.text
    lab.do("take")
    lab.sees('[data-lrp-state="m/fourth"]')
    lab.sees('[data-lrp-state="m/third"]')
    is_answered(lab)

    lab.type_after("(state rest)", ") no program")
    lab.sees('[data-lrp-issue^="LRP1"]')
    lab.goes_on()
    lab.notebook.save()
    saved = lab.text
    restart(lab)
    lab.type_after("(state third)", " (state fif")
    lab.page.reload()
    lab.notebook.ready()
    again(lab, TYPED)
    assert lab.text.splitlines() == saved.splitlines()
    lab.do("take")
    lab.reads(".cm-content", "(state rest)) no program (state third) (state fif")
    is_answered(lab)

    lab.replace(") no program", "")
    lab.page.keyboard.press("Delete")
    lab.type_after("(state fif", "th")
    lab.sees('[data-lrp-state="m/fifth"]')
    notebook = lab.notebook
    notebook.save()
    lab.type_after("(state fifth)", " (state sixth)")
    lab.sees('[data-lrp-state="m/sixth"]')
    server.end_kernels()
    notebook.close()
    notebook.show()
    again(lab, KEPT)
    lab.sees('[data-lrp-state="m/fifth"]')
    lab.do("take")
    lab.sees('[data-lrp-state="m/sixth"]')
    until(lambda: (notebook.path.parent / ".lrp" / "m.lrp").read_text() == lab.text, "it is kept")


def restart(lab):
    lab.notebook.restart_kernel()
    lab.sees(':scope[data-link="dead"]')
    lab.reads(".lrp-notes", "Run %load_ext lrp_jupyter, then the cell again,")


# -- texts of others, files and versions -----------------------------------------------------------


def test_a_text_of_others_is_asked_about_and_a_file_is_not_replaced_unasked(page, server, request):
    notebook = NotebookPage(page, server, f"{request.node.name}/notebook.ipynb")
    server.write(notebook.name, ["%load_ext lrp_jupyter", f"%%lrp demo\n{COUNTER}"])
    folder = notebook.path.parent / ".lrp"
    folder.mkdir()
    stranger = "(machine m (state a (onentry [open('owned', 'w')])) (state b)) (spawn m a)" + " " * 400 + ";"
    for name in ("demo", "name"):
        (folder / f"{name}.lrp").write_text(stranger)
    notebook.show()
    notebook.run_cell(0)
    notebook.run_cell(1)
    lab = notebook.lab().ready()
    refuse_a_hidden_text(lab)
    refuse_a_hidden_text(lab.notebook.open("", "name"))
    lab = notebook.open(COUNTER, "m")
    return_to_a_version(lab)
    take_what_was_changed_outside(lab, folder / "m.lrp")
    save_over_a_file(lab)
    say_that_a_text_is_not_kept(lab, folder)


def refuse_a_hidden_text(lab):
    """A text that came with the folder does not run before it is chosen."""
    owned = lab.notebook.path.parent / "owned"
    asked(lab, "that you have not written here")
    lab.goes_on()
    assert not owned.exists()
    lab.find(f"{ALERT} summary").press("Enter")
    lab.reads(f"{ALERT} pre", "open('owned', 'w')")
    for part in (ALERT, f"{ALERT} pre"):
        assert lab.find(part).evaluate("part => part.scrollWidth <= part.clientWidth")  # the whole line
    lab.find('[data-lrp-action="keep-text"]').press("Enter")
    is_answered(lab)
    lab.notebook.run_cell(1)
    lab.ready().goes_on()
    assert not owned.exists()


def take_what_was_changed_outside(lab, file):
    third(lab)
    until(lambda: "(state third)" in file.read_text(), "it is kept")
    outside = COUNTER.replace("(state rest)", "(state rest) (state outside)")
    file.write_text(outside)
    lab.type_after("(state third)", " (state fourth)")
    lab.sees('[data-lrp-state="m/fourth"]')
    asked(lab, "was changed outside this lab")
    lab.find(f"{ALERT} summary").press("Enter")
    lab.reads(f"{ALERT} ins", "(state outside)")
    lab.reads(f"{ALERT} del", "(state fourth)")
    assert lab.find(f"{ALERT} ins").count() == 1
    axe.finds_nothing_serious(lab)
    lab.goes_on()
    assert file.read_text() == outside
    lab.do("take")
    lab.sees('[data-lrp-state="m/outside"]')
    lab.misses('[data-lrp-state="m/fourth"]')


def return_to_a_version(lab):
    """A deleted text is returned to by keys alone."""
    text = lab.text
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
    for theme in ("dark", "light"):
        axe.choose_theme(lab, theme)
        axe.finds_nothing_serious(lab)
    lab.find('[aria-label="Version"]').focus()
    press("Tab")
    press("Enter")
    lab.reads(".lrp-verdict", "runs")
    assert lab.text == text


def save_over_a_file(lab):
    """Saving asks before it replaces a file."""
    file = lab.notebook.path.parent / "other.lrp"
    file.write_text("precious")
    press = lab.page.keyboard.press
    for answer, text in (("Escape", "precious"), ("Enter", lab.text)):
        lab.do("menu")
        lab.choose("save")
        lab.find('[aria-label="File"]').fill("other.lrp")
        press("Enter")
        lab.until("button => button === document.activeElement", '[data-lrp-action="replace-file"]')
        press(answer)
        lab.misses('[data-lrp-action="replace-file"] >> visible=true')
        assert file.read_text() == text


def say_that_a_text_is_not_kept(lab, folder):
    """It is marked beside the name, and the reason is in view in the window of a small laptop."""
    lab.page.set_viewport_size({"width": 1280, "height": 800})
    folder.rename(folder.with_name("away"))
    folder.write_text("a file")
    lab.type_after("(state rest)", " (state last)")
    mark = lab.sees('[data-lrp-action="unkept"]:not([hidden])')
    assert mark.inner_text() == "Not kept"
    mark.press("Enter")
    lab.reads(".lrp-toast", "is a file")
    toast = lab.box(".lrp-toast")
    assert toast["y"] + toast["height"] < 800, "it is in view"
    folder.unlink()
    lab.find('[data-lrp-action="unkept"]').wait_for(state="hidden")
    assert "(state last)" in (folder / "m.lrp").read_text()
