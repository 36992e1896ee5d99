"""The extension of JupyterLab and Notebook 7: the language of cells and files, and labs in tabs."""

import pytest
from support.waiting import until

from e2e.pages import APP, LabPage
from lrp_jupyter import Session, VirtualClock, parse, programs

CELL = """\
%%lrp m --world walls
# a robot's comment
(var pace := [0.2])
(machine m
  (event near [robot.distance.data < pace])
  (state go (running [robot.move(linear=pace)]))
  (state wait)
  (on near go -> wait))
(spawn m go)
"""
PROGRAM = CELL.partition("\n")[2]
COLOURS = """root => Object.fromEntries([...root.querySelectorAll('.cm-line span[class*="tok-"]')].map(
  span => [`${span.textContent} ${span.className.match(/tok-\\w+/)[0]}`, getComputedStyle(span).color]))"""
WORDS = [
    *("machine tok-keyword", "m tok-namespace", "go tok-labelName", "near tok-propertyName"),
    *("0.2 tok-number", "# a robot's comment tok-comment"),
]
CRASH = "import os; os._exit(1)"
END = f"{APP}.content.session.session.kernel.requestExecute({{ code: '{CRASH}' }}), 0"
THEME = "jupyterapp.commands.execute('apputils:change-theme', { theme: 'JupyterLab Dark' })"


def type_in(notebook, index, text):
    """Put the cursor at the end of a cell, and type."""
    notebook.page.locator(".jp-CodeCell").nth(index).locator(".cm-content").click()
    notebook.page.keyboard.press("Control+End")
    notebook.page.keyboard.type(text)


def source(notebook, index):
    return notebook.page.evaluate(
        f"index => {APP}.content.widgets[index].model.sharedModel.getSource()", index
    )


@pytest.mark.parametrize("app", ["lab/tree", "notebooks"])
def test_a_cell_has_the_colours_of_the_lab(open_notebook, app):
    notebook = open_notebook("%load_ext lrp_jupyter", CELL, "x = 'a'", app=app)
    page = notebook.page
    editor = page.locator(".jp-CodeCell").nth(1).locator(".jp-InputArea-editor")
    editor.locator(".lrp-text .tok-keyword").first.wait_for()
    assert page.locator(".lrp-text").count() == 1  # the other cells are Python
    notebook.run_cell(0)
    notebook.begin_cell(1)
    lab = notebook.lab().ready()
    lab.sees(".cm-content .tok-keyword")
    for _ in range(2):
        inside, outside = lab.root.evaluate(COLOURS), editor.evaluate(COLOURS)
        assert [outside[word] for word in WORDS] == [inside[word] for word in WORDS]
        assert len({outside[word] for word in WORDS}) == 5
        page.evaluate(THEME)  # and again in the dark
        lab.sees("css=:scope[data-theme=dark]")


def test_a_cell_is_typed_as_in_the_lab_and_is_python_without_its_first_line(open_notebook):
    notebook = open_notebook("x = 1", "%load_ext lrp_jupyter")
    page, keyboard = notebook.page, notebook.page.keyboard
    type_in(notebook, 0, "")
    keyboard.press("Control+a")
    keyboard.type("%%lrp m\n(mach")
    page.locator(".cm-tooltip-autocomplete li", has_text="machine").click()
    keyboard.type("m")
    keyboard.press("Tab")
    keyboard.type("(sta")
    page.locator(".cm-tooltip-autocomplete li", has_text="state").click()
    keyboard.type("here)\n(on [True] her")
    page.locator(".cm-tooltip-autocomplete li", has_text="here").click()
    keyboard.type(" -> here))")
    assert source(notebook, 0) == "%%lrp m\n(machine m\n  (state here)\n  (on [True] here -> here))"
    keyboard.press("Control+/")
    assert source(notebook, 0).endswith("\n  # (on [True] here -> here))")
    keyboard.press("Control+Home")
    keyboard.press("Delete")
    page.locator(".lrp-text").wait_for(state="detached")
    assert page.evaluate(f"{APP}.content.widgets[0].model.mimeType") == "text/x-ipython"
    keyboard.type("%")
    page.locator(".lrp-text").wait_for()
    assert page.locator(".lrp-text").count() == 1  # `%load_ext` is a line of Python


@pytest.fixture
def desk(page, server, request):
    """JupyterLab with an empty folder of this test."""
    folder = server.root / request.node.name
    folder.mkdir()
    if not page.url.startswith(f"{server.url}/lab"):
        page.goto(f"{server.url}/lab?reset")
        page.wait_for_function("window.jupyterapp?.restored")
    run(page, "filebrowser:open-path", path=folder.name)
    return Desk(page, server, folder)


class Desk:
    def __init__(self, page, server, folder):
        self.page, self.server, self.folder = page, server, folder

    def command(self, name, **arguments):
        run(self.page, name, **arguments)

    def listed(self, name):
        """A file in the browser of files."""
        self.command("filebrowser:refresh")
        return self.page.locator(".jp-DirListing-item", has_text=name)

    def in_front(self, name):
        """Wait until a file is in the tab in front."""
        self.page.wait_for_function(f"name => {APP}?.context?.path.endsWith('/' + name)", arg=name)

    def has(self, name, text):
        """Wait until a file has a text."""
        until(lambda: text in (self.folder / name).read_text(), f"{name} does not get {text!r}")

    def kernels(self):
        return [each["path"] for each in self.server.api("sessions")]


def run(page, name, **arguments):
    page.evaluate(
        "async ([name, args]) => { await jupyterapp.commands.execute(name, args); }", [name, arguments]
    )


def test_a_new_program_is_its_file_until_its_tab_is_closed(desk):
    page = desk.page
    (desk.folder / "other.lrp").write_text(PROGRAM)
    desk.listed("other.lrp").wait_for()
    desk.command("launcher:create", cwd=desk.folder.name)
    page.locator(".jp-LauncherCard", has_text="LRP Program").filter(visible=True).click()
    desk.in_front("untitled.lrp")
    lab = LabPage(page).ready()
    lab.is_active("rover/driving")
    icons = page.locator(".jp-DirListing-item:not(.jp-mod-selected) .lrp-file-icon")
    strokes = icons.evaluate_all("icons => icons.map(icon => getComputedStyle(icon).stroke)")
    assert strokes == ["rgb(31, 120, 180)"]  # whatever the styles of the lab
    lab.type_after("(machine rover", "\n(state third)")
    lab.sees('[data-lrp-state="rover/third"]')
    desk.has("untitled.lrp", "(machine rover\n  (state third)\n")
    lab.type_after("(state third", " (")  # an invalid program
    desk.has("untitled.lrp", "(state third ()")

    tick = lab.tick
    page.reload()
    lab = LabPage(page).ready()
    assert lab.tick > tick
    lab.select(" ()")
    page.keyboard.press("Delete")
    desk.has("untitled.lrp", "(state third)\n")
    assert lab.find('[role="alertdialog"]').is_hidden()
    assert desk.kernels() == [f"{desk.folder.name}/untitled.lrp.lab"]

    before = lab.root.element_handle()
    page.evaluate(END)
    page.wait_for_function("before => !before.isConnected", arg=before)
    lab = LabPage(page).ready("paused")  # it may be what has ended the kernel
    lab.reads(":scope", "and this is a new one.")

    desk.server.end_kernels()
    page.reload()
    lab = LabPage(page).ready("paused")
    assert "(state third)" in lab.text
    desk.command("application:close")
    until(lambda: not desk.kernels(), "the kernel has not ended")
    assert page.locator(".jp-Dialog").count() == 0


def test_a_tab_connects_again_that_does_not_hear_its_new_kernel(desk):
    """As happens where the first connection leads to the ports of the old one."""
    (desk.folder / "mine.lrp").write_text(PROGRAM)
    page, opened, deaf = desk.page.context.new_page(), [], []

    def connect(socket):
        kernel, is_deaf = socket.connect_to_server(), len(opened) in deaf
        opened.append(kernel)
        kernel.on_message(lambda message: is_deaf or socket.send(message))

    page.route_web_socket("**/channels?*", connect)
    page.goto(f"{desk.server.url}/lab?reset")
    page.wait_for_function("window.jupyterapp?.restored")
    run(page, "docmanager:open", path=f"{desk.folder.name}/mine.lrp", factory="LRP Lab")
    LabPage(page).ready()
    deaf.append(len(opened))  # the next one
    page.evaluate(END)
    LabPage(page).ready("paused")
    assert len(opened) > deaf[0] + 1
    page.close()


def test_a_program_is_edited_in_a_lab_and_in_an_editor_at_once(desk):
    page = desk.page
    (desk.folder / "mine.lrp").write_text(PROGRAM)
    desk.listed("mine.lrp").dblclick()  # the editor, as of every text
    desk.in_front("mine.lrp")
    page.locator(".jp-FileEditor .lrp-text .tok-keyword").first.wait_for()
    page.get_by_role("button", name="Open in the Lab").click()
    lab = LabPage(page).ready()
    desk.command("docmanager:open", path=f"{desk.folder.name}/mine.lrp", factory="Editor")
    editor = page.locator(".jp-FileEditor .cm-content")
    editor.click()
    page.keyboard.press("Control+Home")
    page.keyboard.type("; from the editor\n")
    desk.listed("mine.lrp").click(button="right")
    page.locator(".lm-Menu-item", has_text="Open in the Lab").click()  # which is open
    lab.reads(".cm-content", "; from the editor")
    lab.type_after("; from the editor", ", and from the lab")
    page.wait_for_function("document.querySelector('.jp-FileEditor')?.innerText.includes('and from the lab')")
    desk.has("mine.lrp", "; from the editor, and from the lab\n")
    assert len(desk.kernels()) == 1


def test_a_recording_opens_at_its_end_and_a_strangers_not_unasked(desk):
    name = "run.lrplog.gz"
    with Session(parse(programs.load("follower")), "sim", VirtualClock(), world="line") as session:
        session.record_until_closed(desk.folder / name)
        session.start()
        session.run(5)
    desk.listed(name).dblclick()
    desk.in_front(name)
    desk.page.get_by_text("contains a program that you have not recorded here").wait_for()
    desk.page.get_by_role("button", name="Run it").click()
    lab = LabPage(desk.page).ready("paused")
    assert lab.tick == 50
    lab.reads(".lrp-name", "run")
    lab.sees('[data-lrp="timeline"]')


def test_notebook_shows_a_program_in_the_lab(page, server):
    (server.root / "shown.lrp").write_text(PROGRAM)
    page.goto(f"{server.url}/edit/shown.lrp?factory=LRP Lab")
    lab = LabPage(page).ready()
    lab.type_after("(state wait)", " (state third)")
    lab.sees('[data-lrp-state="m/third"]')
    until(lambda: "third" in (server.root / "shown.lrp").read_text(), "the file is not written")
