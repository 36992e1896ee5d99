"""A JupyterLab of its own, and other servers: private directories, a free port, ended when they are left."""

import json
import os
import shutil
import socket
import subprocess
import sys
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from urllib.request import Request, urlopen

from support.waiting import until

FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
DIRECTORIES = (
    "JUPYTERLAB_SETTINGS_DIR",
    "JUPYTERLAB_WORKSPACES_DIR",
    "JUPYTER_CONFIG_DIR",
    "JUPYTER_RUNTIME_DIR",
    "JUPYTER_DATA_DIR",
    "IPYTHONDIR",
    "XDG_STATE_HOME",
)
QUIET = {
    "@jupyterlab/apputils-extension/notification.jupyterlab-settings": {"fetchNews": "false"},
    "@jupyterlab/docmanager-extension/plugin.jupyterlab-settings": {"autosave": False},
}
EXTENSION = Path(__file__).parents[2] / "js/labextension"
CONFIG = "from lrp_jupyter.cli.lab_command import send_at_once; send_at_once()"  # as `lrp lab` does


def chromium():
    """Return the path of the browser, or None; the one without windows costs a fifth less."""
    return shutil.which("chromium-headless-shell") or shutil.which("chromium")


def lacking(*others):
    """Return what this machine lacks of what all these tests need, or of other packages; or an empty text."""
    needed = ("jupyterlab", "notebook", "playwright", *others)
    missing = [name for name in needed if find_spec(name) is None]
    return ", ".join(missing + ([] if chromium() else ["chromium"]))


class Server:
    def __init__(self, url, root):
        self.url, self.root = url, root

    def api(self, path, method="GET"):
        with urlopen(Request(f"{self.url}/api/{path}", method=method), timeout=20) as answer:
            text = answer.read()
        return json.loads(text) if text else None

    def answers(self):
        try:
            return self.api("status") is not None
        except OSError:
            return False

    def end_kernels(self):
        for session in self.api("sessions"):
            self.api(f"sessions/{session['id']}", "DELETE")

    def write(self, name, cells):
        """Write a notebook of code cells."""
        return write_notebook(self.root / name, cells)


def write_notebook(path, cells):
    """Write a notebook of code cells."""
    cells = [
        {
            "cell_type": "code",
            "id": f"cell-{index}",
            "metadata": {},
            "source": source,
            "outputs": [],
            "execution_count": None,
        }
        for index, source in enumerate(cells)
    ]
    kernel = {"name": "python3", "display_name": "Python 3", "language": "python"}
    content = {"cells": cells, "metadata": {"kernelspec": kernel}, "nbformat": 4, "nbformat_minor": 5}
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(content))
    return path


def private(home):
    """Return an environment in which Jupyter writes only into a directory."""
    env = {**os.environ, **{name: str(home / name.lower()) for name in DIRECTORIES}, "PYTHONWARNINGS": ""}
    env.pop("JUPYTER_PATH", None)
    for name in DIRECTORIES:
        Path(env[name]).mkdir()
    extensions = Path(env["JUPYTER_DATA_DIR"], "labextensions")
    extensions.mkdir()
    (extensions / "lrp-jupyter").symlink_to(EXTENSION)
    env["JUPYTER_PREFER_ENV_PATH"] = "0"  # that of this checkout, before what is installed
    return env


def free_port():
    """Return a port of this machine that is free now."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return free.getsockname()[1]


@contextmanager
def serving(module, *arguments, home, answers, **options):
    """Run a module as a server in a process, which is yielded when it answers, until the context is left.

    It runs in the folder `home`, because some extensions of Jupyter write into the current one.
    """
    with (home / "log").open("w") as log:
        command = [sys.executable, "-m", module, *arguments]
        process = subprocess.Popen(command, cwd=home, stdout=log, stderr=subprocess.STDOUT, **options)
        try:
            until(lambda: process.poll() is not None or answers(), f"{module} does not answer")
            assert process.poll() is None, f"{module} ended: {(home / 'log').read_text()[-2000:]}"
            yield process
        finally:
            process.terminate()  # it ends its kernels
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


@contextmanager
def jupyter(home, app=("jupyterlab", "--ServerApp.root_dir"), settings=QUIET):
    """Run a server of JupyterLab and Notebook in a directory of its own.

    `app` is a module with its arguments, of which the last names the option for the folder of notebooks.
    """
    root = home / "notebooks"
    root.mkdir(parents=True)
    env = private(home)
    (Path(env["JUPYTER_CONFIG_DIR"]) / "jupyter_server_config.py").write_text(CONFIG)
    for name, values in settings.items():
        file = Path(env["JUPYTERLAB_SETTINGS_DIR"]) / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(json.dumps(values))
    port = free_port()
    command = [
        *(*app[:-1], f"{app[-1]}={root}", "--no-browser"),
        *("--ServerApp.ip=127.0.0.1", f"--ServerApp.port={port}", "--ServerApp.port_retries=0"),
        *("--IdentityProvider.token=", "--ServerApp.password=", "--ServerApp.disable_check_xsrf=True"),
        *("--ServerApp.answer_yes=True", "--ServerApp.allow_root=True"),
        *("--LabApp.expose_app_in_browser=True", "--JupyterNotebookApp.expose_app_in_browser=True"),
    ]
    server = Server(f"http://127.0.0.1:{port}", root)
    with serving(*command, home=home, answers=server.answers, env=env):
        yield server
