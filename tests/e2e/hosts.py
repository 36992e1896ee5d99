"""Every notebook that can run here, with a lab and a second part of it: opened, and loaded again."""

import os
import socket
from contextlib import contextmanager

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
SETTINGS = "[tool.marimo.runtime]\nauto_instantiate = true\n[tool.marimo.display]\ntheme = '{theme}'\n"


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
def marimo(page, home, mode, theme="light", notebook=MARIMO):
    """Show the lab in marimo: `mode` is ``run`` or ``edit``."""
    (home / "notebook.py").write_text(notebook)
    (home / "pyproject.toml").write_text(SETTINGS.format(theme=theme))
    port = free_port()
    env = {**os.environ, "XDG_CONFIG_HOME": str(home), "MARIMO_SKIP_UPDATE_CHECK": "1", "PYTHONWARNINGS": ""}
    arguments = (mode, "--headless", "--no-token", "--host=127.0.0.1", f"--port={port}", "notebook.py")
    with serving("marimo", *arguments, home=home, answers=lambda: listens(port), env=env):
        page.goto(f"http://127.0.0.1:{port}")
        yield Host(page, page.reload)


@contextmanager
def voila(page, home):
    """Show the lab in Voila, which runs a notebook for each visit."""
    (home / "notebooks").mkdir()
    notebook = write_notebook(home / "notebooks/notebook.ipynb", [OPEN, GRAPH])
    port = free_port()
    arguments = (str(notebook), "--no-browser", "--Voila.ip=127.0.0.1", f"--port={port}")
    with serving("voila", *arguments, home=home, answers=lambda: listens(port), env=private(home)):
        page.goto(f"http://127.0.0.1:{port}")
        yield Host(page, page.reload)


def listens(port):
    """Return whether a server has its port open."""
    try:
        socket.create_connection(("127.0.0.1", port), timeout=20).close()
    except OSError:
        return False
    return True
