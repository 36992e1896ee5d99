"""What is typed is in the notebook when it is saved, and in what is made of it, read, and handed in."""

import base64
import json
import re
from xml.etree import ElementTree

import pytest

from e2e.conftest import WAIT
from e2e.pages import APP
from e2e.programs import COUNTER, SQUARE
from e2e.test_hosts import STORED, converted, is_one_line, is_whole, source_of
from lrp_jupyter.grading.challenges import challenge
from lrp_jupyter.grading.grade import grade
from lrp_jupyter.grading.submissions import find_submissions

NOT_SAVED = '[data-lrp-action="unkept"]:not([hidden])'


def on_disk(notebook, index=1):
    """Return the source of a cell, and the data of its first output, as they are in the file."""
    cell = json.loads(notebook.path.read_text())["cells"][index]
    texts = {kind: "".join(text) for kind, text in cell["outputs"][0]["data"].items()}
    return "".join(cell["source"]), texts


def words_in(picture):
    return "".join(ElementTree.fromstring(picture).itertext())


def is_dirty(notebook):
    return notebook.page.evaluate(f"{APP}.context.model.dirty")


def has_saved(lab, *words):
    """Save at once; everything saved of the program is of its text, the picture as soon as it is drawn."""
    text = lab.text
    lab.notebook.save()
    lab.page.wait_for_function(
        f"words => {{ const {{ data }} = {APP}.context.model.sharedModel.cells[1].outputs[0];"
        " return words.every(word => data['image/svg+xml'].includes(word)); }",
        arg=words,
    )
    lab.notebook.is_saved()
    source, output = on_disk(lab.notebook)
    assert source == f"%%lrp m\n{text}".rstrip("\n")
    assert output["text/plain"].rstrip("\n") == text.rstrip("\n")
    assert set(output) == {"image/svg+xml", "text/plain"}
    assert all(word in words_in(output["image/svg+xml"]) for word in words)


def test_the_text_and_its_picture_are_saved_wherever_the_notebook_is_read(
    open_lab, server, context, tmp_path
):
    lab = open_lab(COUNTER, "m", "'other'")
    notebook = lab.notebook
    notebook.save()
    given = on_disk(notebook)
    lab.type_after("(state rest)", " (state third)")
    assert is_dirty(notebook), "Jupyter saves it now and then, and asks before it is closed"
    is_one_line(lab.page)
    assert source_of(notebook) == given[0]
    has_saved(lab, "third")
    leave_the_steps_of_jupyter_alone(lab)
    load_the_page_again(lab)
    save_what_is_no_program(lab)
    overwrite_nothing_unasked(lab)
    read_it_without_a_kernel(lab, server)
    convert_it_without_a_network(lab, context, tmp_path)


def leave_the_steps_of_jupyter_alone(lab):
    """What is undone in the notebook is what was done there."""
    page, notebook = lab.page, lab.notebook
    page.locator(".jp-CodeCell").nth(2).locator(".cm-content").click()
    page.keyboard.type("1 + ")
    lab.type_after("(state third)", " (state fourth)")
    has_saved(lab, "third", "fourth")
    page.locator(".jp-CodeCell").nth(2).locator(".cm-content").click()
    page.keyboard.press("Control+z")
    page.wait_for_function(f"!{APP}.content.widgets[2].model.sharedModel.getSource().includes('+')")
    assert source_of(notebook) == f"%%lrp m\n{lab.text}".rstrip("\n")


def load_the_page_again(lab):
    """The lab is there again, in place of its picture; nothing has changed, and the cell asks nothing."""
    notebook = lab.notebook
    notebook.save()
    lab.page.reload()
    notebook.ready()
    lab.ready()
    lab.sees('[data-lrp-state="m/fourth"]')
    assert lab.page.locator(STORED).count() == 0
    assert not is_dirty(notebook)
    is_one_line(lab.page)
    notebook.run_cell(1)
    lab.ready().goes_on()
    assert lab.find('[role="alertdialog"]').is_hidden()
    lab.sees('[data-lrp-state="m/fourth"]')


def save_what_is_no_program(lab):
    lab.type_after("(state fourth)", " (state fif")
    has_saved(lab, "fourth")
    lab.page.keyboard.type("th)")
    has_saved(lab, "fifth")


def overwrite_nothing_unasked(lab):
    """A cell that was edited, too, is not written into; the user is told, and says which text it is."""
    notebook = lab.notebook
    edited = source_of(notebook).replace("(state third)", "(state edited)")
    notebook.write_cell(1, edited)
    lab.type_after("(state fifth)", " (state sixth)")
    lab.sees(NOT_SAVED).press("Enter")
    lab.reads(".lrp-toast", "the cell above has a different text")
    lab.page.evaluate("document.activeElement.blur()")
    is_whole(lab.page)
    notebook.save()
    assert on_disk(notebook)[0] == edited
    lab.do("menu")
    lab.choose("write-cell")
    lab.misses(NOT_SAVED)
    has_saved(lab, "sixth")


def read_it_without_a_kernel(lab, server):
    notebook, page = lab.notebook, lab.page
    notebook.close()
    server.end_kernels()
    notebook.show()
    image = page.locator(STORED)
    image.wait_for()
    assert image.evaluate("image => image.naturalWidth") > 100
    assert "model not found" not in page.locator(".jp-Notebook").inner_text()
    assert "(state sixth)" in source_of(notebook)


def convert_it_without_a_network(lab, context, tmp_path):
    offline = context.browser.new_context(offline=True)
    offline.set_default_timeout(WAIT)
    page = offline.new_page()
    html = converted(lab.notebook.path, tmp_path / "saved")
    page.goto(html.as_uri())
    image = page.locator(".jp-OutputArea-output img")
    image.wait_for()
    assert image.evaluate("image => image.naturalWidth") > 100
    (picture,) = re.findall(r'src="data:image/svg\+xml;base64,([^"]+)"', html.read_text())
    assert "sixth" in words_in(base64.b64decode(picture))
    offline.close()


@pytest.mark.parametrize("app", ["lab/tree", "notebooks"])
def test_what_is_handed_in_is_what_was_typed(open_lab, app):
    """The text is in the file when the notebook is saved or closed, and graded as in the lab."""
    lab = open_lab("", "square --challenge square", app=app)
    notebook, page = lab.notebook, lab.page
    lab.find(".cm-content").press("Control+a")
    page.keyboard.insert_text(SQUARE)
    lab.sees('[data-lrp-state="m/corner"]')
    if app == "notebooks":
        notebook.save()
    else:
        page.evaluate(f"void {APP}.close()")
        page.locator(".jp-Dialog .jp-mod-accept:has-text('Save')").click()
        page.wait_for_function(f"{APP}?.context?.path !== '{notebook.name}'")
    task = challenge("square")
    (handed_in,) = find_submissions([notebook.path.parent], task)
    assert handed_in.text.rstrip("\n") == SQUARE.rstrip("\n")
    assert not handed_in.as_given
    (named,) = find_submissions([notebook.path])
    assert (named.text, named.challenge) == (handed_in.text, "square")
    assert grade(handed_in.text, task).points == task.points
