"""The notebooks of a static site: Python, the simulator and the lab in a browser without a network."""

import shutil

import pytest

from e2e.pages import APP, NotebookPage, comes_true
from lrp_jupyter.cli.lab import shipped_notebooks
from lrp_jupyter.site.build import build_site

PANELS = ("editor", "tree", "graph", "world", "variables", "issues", "timeline")
COUNT = """\
(var n := [0])
(machine m
  (state count (running [n = n + 1])))
(spawn m count)
"""


class SiteNotebook(NotebookPage):
    """A notebook in JupyterLite."""

    def __init__(self, page, site, name):
        self.page, self.site, self.name = page, site, name

    def show(self):
        self.command("docmanager:open", path=self.name)
        return self.ready()

    def run_all(self):
        """Run all cells to their ends; return the errors of each."""
        self.page.evaluate("() => { void jupyterapp.commands.execute('notebook:run-all-cells'); }")
        return self.errors()

    def errors(self):
        """Wait for the ends of all cells; return what went wrong."""
        code = f"{APP}.content.widgets.filter(cell => cell.model.type === 'code')"
        error = "cell => cell.model.sharedModel.outputs.some(output => output.output_type === 'error')"
        self.page.wait_for_function(
            f"(cells => cells.every(cell => cell.model.executionCount) || cells.some({error}))({code})"
        )
        return self.page.evaluate(
            f"{code}.flatMap(cell => cell.model.sharedModel.outputs)"
            ".filter(output => output.output_type === 'error')"
            ".map(output => `${output.ename}: ${output.evalue}`)"
        )


@pytest.fixture
def jupyter(visitor, site):
    """JupyterLite, with nothing open and no kernel."""
    if not visitor.url.startswith(f"{site.url}/jupyter/lab"):
        visitor.goto(f"{site.url}/jupyter/lab/index.html")
        visitor.wait_for_function("window.jupyterapp?.shell?.currentWidget")
    yield visitor
    visitor.evaluate(CLOSE)


CLOSE = """async () => {
  for (const widget of [...jupyterapp.shell.widgets("main")]) widget.dispose();
  await jupyterapp.serviceManager.sessions.shutdownAll();
}"""


@pytest.fixture
def notebook(jupyter, site):
    """Open a notebook of the site."""
    return lambda name: SiteNotebook(jupyter, site, name).show()


@pytest.fixture
def lab(jupyter, site, request):
    """Write a notebook into the browser's storage, and run its lab."""

    def lab(program):
        name = f"{request.node.name}.ipynb"  # of its own: the browser keeps the texts of a name
        cells = ["%load_ext lrp_jupyter", f"%%lrp {request.node.name} --bridge none\n{program}"]
        jupyter.evaluate(WRITE, [name, cells])
        return run(SiteNotebook(jupyter, site, name).show())

    return lab


WRITE = """async ([path, sources]) => {
  const cells = sources.map((source, index) => (
    { cell_type: "code", id: `cell-${index}`, source, metadata: {}, outputs: [], execution_count: null }));
  const metadata = { kernelspec: { name: "python", display_name: "Python", language: "python" } };
  const content = { cells, metadata, nbformat: 4, nbformat_minor: 5 };
  await jupyterapp.serviceManager.contents.save(path, { type: "notebook", format: "json", content });
}"""


STORES = """async ([path, part]) => {
  try {
    const options = { type: "file", format: "text", content: true };
    return (await jupyterapp.serviceManager.contents.get(path, options)).content.includes(part);
  } catch {
    return false; // there is no such file yet
  }
}"""


def run(notebook):
    """Run the first two code cells, of which the second has a lab."""
    first, second = notebook.page.evaluate(
        f"{APP}.content.widgets.flatMap((cell, at) => cell.model.type === 'code' ? [at] : []).slice(0, 2)"
    )
    notebook.run_cell(first)
    notebook.begin_cell(second)
    lab = notebook.lab().ready()
    lab.notebook = notebook
    return lab


def test_the_first_notebook_drives_a_robot_in_the_browser(notebook, simulator):
    lab = run(notebook("00-hello-live-robot.ipynb"))
    lab.goes_on()
    for part in PANELS:
        lab.sees(f'[data-lrp="{part}"]')
    assert lab.find('[data-lrp-action="pause"]').is_visible()
    picture = lab.find(".lrp-canvas").evaluate("canvas => canvas.toDataURL()")
    lab.until("(canvas, picture) => canvas.toDataURL() !== picture", ".lrp-canvas", picture)


def test_a_typed_state_appears_in_the_graph_of_the_running_program_which_can_be_paused_and_stopped(lab):
    lab = lab(COUNT)
    lab.goes_on()
    lab.type_after("[n = n + 1]))", "\n  (state rest)")
    lab.state("m/rest")
    lab.goes_on()
    lab.pause()
    lab.do("run")
    lab.ready()
    lab.do("stop")
    lab.ready("paused")


def test_a_typed_text_is_kept_and_offered_after_the_page_was_loaded_again(lab):
    lab = lab(COUNT)
    lab.type_after("[n = n + 1]))", "\n  (state rest)")
    lab.state("m/rest")
    file = f".lrp/{lab.notebook.name.removesuffix('.ipynb')}.lrp"
    comes_true(lab.page, STORES, [file, "(state rest)"])
    lab.notebook.save()
    lab.page.reload()
    lab = run(lab.notebook.ready())
    lab.reads('[role="alertdialog"]', "Which text should be kept?")
    lab.do("take")
    lab.state("m/rest")


def test_a_block_that_does_not_return_pauses_the_program_and_leaves_the_page_alive(lab):
    lab = lab(COUNT)
    lab.goes_on()
    lab.select("[n = n + 1]")
    lab.page.keyboard.insert_text("[while True: pass]")
    lab.ready("paused")
    lab.reads(":scope", "did not return within")
    lab.select("while True: pass")
    lab.page.keyboard.insert_text("n = n + 2")
    lab.do("run")
    lab.ready().goes_on()


@pytest.mark.parametrize("name", ["00-hello-live-robot", "03-time-is-a-condition", "07-line-follower-live"])
def test_a_notebook_runs_from_its_first_cell_to_its_last(name, notebook, simulator):
    assert notebook(f"{name}.ipynb").run_all() == []


def test_a_challenge_is_graded_in_the_browser(notebook, simulator):
    opened = notebook("01-states-and-events.ipynb")
    passed = opened.page.evaluate(
        KERNEL,
        f"from lrp_jupyter import grade\nprint(grade({BUMPER!r}, 'bump and stay').passed)",
    )
    assert passed == "True\n"


def test_a_site_is_replaced_by_the_next_one_even_without_the_package_index(site, tmp_path, monkeypatch):
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    monkeypatch.setenv("PIP_FIND_LINKS", str(site.folder / "python"))
    folder = tmp_path / "site"
    folder.mkdir()
    for name in (".lrp-site", "old.txt"):
        shutil.copy(site.folder / ".lrp-site", folder / name)
    build_site(folder, shipped_notebooks(), offline=True, pyodide=site.folder / "python")
    assert not (folder / "old.txt").exists()
    wheels = {each.name for each in (site.folder / "python").iterdir()}
    assert {each.name for each in (folder / "python").iterdir()} == wheels


BUMPER = """
(machine careful
  (event bump [robot.bumper.data == 1])
  (state driving
    (running [robot.move(linear=0.2)]))
  (state stopped
    (onentry [robot.stop()]))
  (on bump driving -> stopped))
(spawn careful driving)
"""
KERNEL = """async code => {
  const kernel = jupyterapp.shell.currentWidget.sessionContext.session.kernel;
  const future = kernel.requestExecute({ code, store_history: false });
  let text = "";
  future.onIOPub = ({ header, content }) => {
    if (header.msg_type === "stream") text += content.text;
    if (header.msg_type === "error") text += `${content.ename}: ${content.evalue}`;
  };
  await future.done;
  return text;
}"""
