"""Every notebook that can run here, with a lab and a second part of it, and what each of them promises."""

import os
import socket
from contextlib import contextmanager, suppress

from e2e.jupyter import free_port, private, serving, write_notebook
from e2e.pages import LabPage, NotebookPage
from e2e.programs import COUNTER

OPEN = f'import lrp_jupyter\nlab = lrp_jupyter.Lab("""{COUNTER}""", name="m")\nlab'
GRAPH = "lrp_jupyter.StateGraph(lab)"
MARIMO = f'''\
import marimo

app = marimo.App(width="full")


@app.cell
def _():
    import marimo as mo

    import lrp_jupyter

    return lrp_jupyter, mo


@app.cell
def _(lrp_jupyter, mo):
    program = lrp_jupyter.Lab("""{COUNTER}""", name="m", namespace=globals())
    lab = mo.ui.anywidget(program)
    lab
    return lab, program


@app.cell
def _(lrp_jupyter, program):
    lrp_jupyter.StateGraph(program)
    return


@app.cell
def _(lab, mo):
    import threading

    loops = sum(thread.name == "lrp m" for thread in threading.enumerate())
    mo.plain_text(f"{{lab.frame.active[0]}}, {{lab.frame.status}}, {{loops}} loop")
    return
'''
SETTINGS = "[tool.marimo.runtime]\nauto_instantiate = true\n[tool.marimo.display]\ntheme = 'light'\n"


PARTS = ("controls", "editor", "graph", "world", "variables", "issues", "timeline")
COLOURS = """canvas => {
  const { width, height } = canvas;
  const { data } = canvas.getContext('2d').getImageData(0, 0, width, height);
  const colours = new Set();
  for (let at = 0; at < data.length; at += 4)
    if (data[at + 3] === 255) colours.add(data.slice(at, at + 3).join());
  return colours.size > 20 && [...colours];
}"""


class Host:
    """A notebook in a page."""

    def __init__(self, page, reload):
        self.page, self.reload = page, reload

    @property
    def lab(self):
        return LabPage(self.page)

    @property
    def graph(self):
        """The second part of the lab."""
        return LabPage(self.page, root='.lrp-lab[data-part="graph"]')

    def prints(self, text):
        """Wait until the notebook shows a text."""
        self.page.wait_for_function("text => document.body.innerText.includes(text)", arg=text)

    def works(self):
        """Use the lab in the ways that every host promises; return it."""
        lab = self.lab.ready()
        for part in PARTS:
            lab.sees(f'[data-lrp="{part}"]')
        lab.is_active("m/count")
        colours = lab.until(COLOURS, ".lrp-canvas")
        assert "255,255,255" in colours  # the floor
        assert any(len(set(colour.split(","))) == 3 for colour in colours)  # the robot, which is blue

        lab.type_after("(state rest)", " (state third)")
        for part in (lab, self.graph):
            part.sees('[data-lrp-state="m/third"]')
        assert "(state rest) (state third)" in lab.text

        lab.do("world-menu")
        lab.choose("grid")
        lab.misses('[role="menu"]')
        lab.do("world-menu")
        lab.page.keyboard.press("Escape")
        lab.misses('[role="menu"]')
        assert lab.until("root => root.getRootNode().activeElement?.dataset.lrpAction === 'world-menu'")

        tick = lab.pause().tick
        self.graph.ready("paused")
        lab.do("run")
        lab.ready().goes_on()
        assert lab.tick > tick
        return lab

    def shows_it_again(self):
        """Load the page again: the lab of the running kernel is back."""
        tick = self.lab.tick
        self.reload()
        lab = self.lab.ready()
        lab.sees('[data-lrp-state="m/third"]')
        assert lab.tick > tick
        lab.goes_on()


@contextmanager
def jupyter(page, server, app):
    """Show the lab in JupyterLab or Jupyter Notebook, whose server runs already."""
    notebook = NotebookPage(page, server, f"every-host/{app.replace('/', '-')}.ipynb")
    server.write(notebook.name, [OPEN, GRAPH])
    notebook.show(app)
    notebook.begin_cell(0)
    LabPage(page).ready()
    notebook.begin_cell(1)

    def reload():
        notebook.save()
        page.reload()
        notebook.ready()

    yield Host(page, reload)


@contextmanager
def marimo(home, mode, **notebooks):
    """Serve notebooks by ``marimo run`` or ``marimo edit``; yield what shows one of them in a page."""
    for name, text in notebooks.items():
        (home / f"{name}.py").write_text(text)
    (home / "pyproject.toml").write_text(SETTINGS)
    env = {**os.environ, "XDG_CONFIG_HOME": str(home), "MARIMO_SKIP_UPDATE_CHECK": "1", "PYTHONWARNINGS": ""}
    arguments = (mode, "--headless", "--no-token", "--host=127.0.0.1", "--port={port}", ".")
    with listening("marimo", *arguments, home=home, env=env) as (url, _):

        def show(page, name):
            page.goto(f"{url}/?file={name}.py")
            return Host(page, page.reload)

        yield show


@contextmanager
def voila(home):
    """Serve a notebook by Voila; yield its folder, its address and the process."""
    (home / "notebooks").mkdir()
    cells = [
        "%load_ext lrp_jupyter",
        f"%%lrp m\n{COUNTER}",
        "import lrp_jupyter",
        "lrp_jupyter.StateGraph('m')",
    ]
    notebook = write_notebook(home / "notebooks/demo.ipynb", cells)
    arguments = (str(notebook), "--no-browser", "--Voila.ip=127.0.0.1", "--port={port}")
    with listening("voila", *arguments, home=home, env=private(home)) as (url, process):
        yield notebook.parent, url, process


@contextmanager
def listening(module, *arguments, home, env):
    """Run a module as a server; yield its address and its process when its port is open."""
    port = free_port()

    def is_open():
        with suppress(OSError):
            socket.create_connection(("127.0.0.1", port), timeout=20).close()
            return True
        return False

    arguments = [each.format(port=port) for each in arguments]
    with serving(module, *arguments, home=home, answers=is_open, env=env) as process:
        yield f"http://127.0.0.1:{port}", process
