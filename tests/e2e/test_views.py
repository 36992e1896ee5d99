"""Pages come and go, cells run again, kernels end: the program and its text stay."""

from e2e.pages import LabPage
from e2e.programs import COUNTER, FOLLOWER


def test_a_reloaded_page_shows_the_running_program_its_text_and_the_cursor(open_lab):
    lab = open_lab(COUNTER)
    lab.type_after("(state rest)", " (state third)")
    lab.sees('[data-lrp-state="m/third"]')
    lab.notebook.save()
    tick = lab.tick
    lab.page.reload()
    lab.notebook.ready()
    lab.ready()
    lab.sees('[data-lrp-state="m/third"]')
    assert "(state third)" in lab.text
    assert lab.tick > tick
    lab.find(".cm-content").focus()
    lab.page.keyboard.type(" (state fourth)")
    lab.sees('[data-lrp-state="m/fourth"]')
    assert "(state third) (state fourth)" in lab.text


def test_two_views_of_one_lab_agree(open_lab):
    lab = open_lab(FOLLOWER, "follower --world line", "%lrp follower")
    lab.notebook.run_cell(2)
    other = lab.notebook.lab(1).ready()
    other.type_after("(running [robot.move(linear=back)]))", " (state third)")
    lab.sees('[data-lrp-state="follower/third"]')
    lab.state("follower/looking").dblclick()
    other.sees('[data-lrp-state="follower/looking/lookalgo/lookleft"]')
    lab.pause()
    other.ready("paused")
    assert other.tick == lab.tick


def test_a_cell_run_again_with_a_changed_text_patches_the_running_program(open_lab):
    lab = open_lab(COUNTER)
    lab.goes_on()
    counted = int(lab.value("m/n"))
    lab.notebook.write_cell(1, "%%lrp m\n" + COUNTER.replace("(state rest)", "(state rest) (state third)"))
    lab.notebook.run_cell(1)
    lab.ready()
    lab.sees('[data-lrp-state="m/third"]')
    assert int(lab.value("m/n")) >= counted
    lab.notebook.run_cell(1)  # unchanged: the same lab again
    lab.ready()
    assert int(lab.value("m/n")) >= counted


def test_where_cell_and_lab_both_changed_the_lab_asks_which_text_it_is(open_lab):
    lab = open_lab(COUNTER)
    lab.type_after("(state rest)", " (state typed)")
    lab.sees('[data-lrp-state="m/typed"]')
    lab.notebook.write_cell(1, "%%lrp m\n" + COUNTER.replace("(state rest)", "(state rest) (state written)"))
    lab.notebook.run_cell(1)
    lab.ready()
    lab.reads('[role="alertdialog"]', "Which text should be kept?")
    lab.sees('[data-lrp-state="m/typed"]')
    lab.do("take")
    lab.sees('[data-lrp-state="m/written"]')
    lab.misses('[data-lrp-state="m/typed"]')


def test_a_restarted_kernel_is_reported_and_the_lab_offers_the_typed_text(open_lab):
    lab = open_lab(COUNTER)
    lab.type_after("(state rest)", " (state third)")
    lab.sees('[data-lrp-state="m/third"]')
    lab.notebook.restart_kernel()
    lab.sees(':scope[data-link="dead"]')
    lab.reads(".lrp-notes", "Run the cell again")
    assert "(state third)" in lab.text
    lab.notebook.run_cell(0)
    lab.notebook.run_cell(1)
    lab.sees(':scope[data-link="live"]')
    lab.ready()
    lab.reads('[role="alertdialog"]', "Which text should be kept?")
    assert "(state third)" not in lab.text
    lab.do("take")
    lab.sees('[data-lrp-state="m/third"]')
    assert "(state third)" in lab.text


def test_a_saved_and_reopened_notebook_offers_the_typed_text(open_lab, server):
    lab = open_lab(COUNTER)
    lab.type_after("(state rest)", " (state third)")
    lab.sees('[data-lrp-state="m/third"]')
    notebook = lab.notebook
    notebook.save()
    server.end_kernels()
    notebook.close()
    notebook.show()
    notebook.run_cell(0)
    notebook.run_cell(1)
    lab.ready()
    lab.reads('[role="alertdialog"]', "Which text should be kept?")
    lab.do("take")
    lab.sees('[data-lrp-state="m/third"]')
    lab.goes_on()
    assert (notebook.path.parent / ".lrp" / "m.lrp").read_text() == lab.text


def test_single_parts_show_the_same_session_in_a_layout_of_ones_own(open_lab):
    parts = "import lrp_jupyter, ipywidgets\n"
    parts += "ipywidgets.HBox([lrp_jupyter.StateGraph('m'), lrp_jupyter.Variables('m')])"
    lab = open_lab(COUNTER, "m", parts)
    lab.notebook.run_cell(2)
    graph = LabPage(lab.page, root='[data-part="graph"]')
    graph.is_active("m/count")
    assert graph.find(".cm-content").count() == 0
    variables = LabPage(lab.page, root='[data-part="variables"]')
    variables.sees('[data-lrp-variable="m/n"]')
    lab.replace("[1000]", "[0]")
    graph.is_active("m/rest")
    variables.has_value("limit", "0")


def test_notebook_7_runs_the_lab_too(open_notebook):
    notebook = open_notebook("%load_ext lrp_jupyter", f"%%lrp m\n{COUNTER}", app="notebooks")
    notebook.run_cell(0)
    notebook.run_cell(1)
    lab = notebook.lab().ready()
    lab.goes_on()
    lab.type_after("(state rest)", " (state third)")
    lab.sees('[data-lrp-state="m/third"]')
