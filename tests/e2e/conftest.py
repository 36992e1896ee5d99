"""A real JupyterLab and a real browser: one server for all tests, a page and a kernel for each."""

import importlib.util
import json
import os
import shutil
import socket
import subprocess
import sys
import time
from pathlib import Path
from urllib.request import Request, urlopen

import pytest

FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
WAIT = 20_000  # ms that anything may take on a busy machine
DIRECTORIES = (
    "JUPYTERLAB_SETTINGS_DIR",
    "JUPYTERLAB_WORKSPACES_DIR",
    "JUPYTER_CONFIG_DIR",
    "JUPYTER_RUNTIME_DIR",
    "JUPYTER_DATA_DIR",
    "IPYTHONDIR",
)
QUIET = {
    "@jupyterlab/apputils-extension/notification.jupyterlab-settings": {"fetchNews": "false"},
    "@jupyterlab/docmanager-extension/plugin.jupyterlab-settings": {"autosave": False},
}
# jupyter_server leaves Nagle's algorithm on, which adds tens of milliseconds to each answer.
CONFIG = """
import socket
from jupyter_server.services.kernels.websocket import KernelWebsocketHandler

before = KernelWebsocketHandler.open

async def open(self, *arguments, **options):
    self.ws_connection.stream.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    await before(self, *arguments, **options)

KernelWebsocketHandler.open = open
"""


def lacking():
    """Say what the machine lacks for these tests; empty if nothing."""
    missing = [name for name in ("jupyterlab", "playwright") if importlib.util.find_spec(name) is None]
    return ", ".join(missing + ([] if shutil.which("chromium") else ["chromium"]))


def pytest_collection_modifyitems(items):
    here = Path(__file__).parent
    for item in items:
        if here in Path(item.fspath).parents:
            item.add_marker(pytest.mark.browser)
            if lacking() and not os.environ.get("CI"):
                item.add_marker(pytest.mark.skip(reason=f"there is no {lacking()}"))


class Server:
    def __init__(self, url, root):
        self.url, self.root = url, root

    def api(self, path, method="GET"):
        with urlopen(Request(f"{self.url}/api/{path}", method=method), timeout=10) as answer:
            text = answer.read()
        return json.loads(text) if text else None

    def write(self, name, cells):
        """Write a notebook."""
        notebook = {
            "cells": [
                {
                    "cell_type": "code",
                    "id": f"cell-{index}",
                    "metadata": {},
                    "source": source,
                    "outputs": [],
                    "execution_count": None,
                }
                for index, source in enumerate(cells)
            ],
            "metadata": {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}},
            "nbformat": 4,
            "nbformat_minor": 5,
        }
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(notebook))
        return path


@pytest.fixture(scope="session")
def server(tmp_path_factory):
    home = tmp_path_factory.mktemp("jupyter")
    root = home / "notebooks"
    root.mkdir()
    env = {**os.environ, **{name: str(home / name.lower()) for name in DIRECTORIES}, "PYTHONWARNINGS": ""}
    env.pop("JUPYTER_PATH", None)
    for name in DIRECTORIES:
        Path(env[name]).mkdir()
    (Path(env["JUPYTER_CONFIG_DIR"]) / "jupyter_server_config.py").write_text(CONFIG)
    for name, settings in QUIET.items():
        file = Path(env["JUPYTERLAB_SETTINGS_DIR"]) / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(json.dumps(settings))
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    log = (home / "log").open("w")
    process = subprocess.Popen(
        [
            sys.executable,
            "-m",
            "jupyterlab",
            "--no-browser",
            "--allow-root",
            "--ServerApp.ip=127.0.0.1",
            f"--ServerApp.port={port}",
            "--ServerApp.port_retries=0",
            "--IdentityProvider.token=",
            "--ServerApp.password=",
            "--ServerApp.disable_check_xsrf=True",
            f"--ServerApp.root_dir={root}",
            "--LabApp.expose_app_in_browser=True",
        ],
        env=env,
        stdout=log,
        stderr=subprocess.STDOUT,
    )
    server = Server(f"http://127.0.0.1:{port}", root)
    try:
        wait_for(lambda: answers(server), 60)
        yield server
    finally:
        process.terminate()
        try:
            process.wait(20)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        log.close()


def answers(server):
    try:
        return server.api("status") is not None
    except OSError:
        return False


def wait_for(condition, seconds):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "it did not come"
        time.sleep(0.1)


@pytest.fixture(scope="session")
def browser(server):
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
        yield browser
        browser.close()


@pytest.fixture
def page(browser, server):
    context = browser.new_context(viewport={"width": 1600, "height": 1000})
    context.set_default_timeout(WAIT)
    page = context.new_page()
    page.errors = []
    page.on("pageerror", lambda error: page.errors.append(str(error)))
    yield page
    context.close()
    for session in server.api("sessions"):
        server.api(f"sessions/{session['id']}", "DELETE")
    assert page.errors == []


@pytest.fixture
def open_notebook(page, server, request):
    """Write a notebook, open it, run all its cells."""

    def open_notebook(*cells, run=True):
        name = f"{request.node.name}/notebook.ipynb"
        server.write(name, cells)
        return show(name, run)

    def show(name, run):
        page.goto(f"{server.url}/lab/tree/{name}?reset")
        page.wait_for_function(
            "window.jupyterapp?.shell?.currentWidget?.sessionContext?.session?.kernel?.status === 'idle'"
        )
        if run:
            page.evaluate("window.jupyterapp.commands.execute('notebook:run-all-cells')")
        return page

    open_notebook.again = show
    return open_notebook


@pytest.fixture
def open_lab(open_notebook):
    """Open a notebook with a lab, and wait until it runs."""

    def open_lab(program, line="follower", *more):
        page = open_notebook("%load_ext lrp_jupyter", f"%%lrp {line}\n{program}", *more)
        page.wait_for_selector('[data-lrp="lab"][data-lrp-status="running"]')
        return page

    return open_lab
