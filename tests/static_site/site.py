"""A static site as ``lrp site --offline`` builds it, on a web server that knows only files."""

import json
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread

from lrp_jupyter.cli.lab_command import shipped_notebooks
from lrp_jupyter.site.build import build_site
from static_site import pyodide


@dataclass(frozen=True)
class Site:
    folder: Path
    url: str
    without_simulator: str
    """Why the simulator cannot run in it, or an empty text."""


class Files(SimpleHTTPRequestHandler):
    extensions_map = SimpleHTTPRequestHandler.extensions_map | {
        ".mjs": "text/javascript",
        ".wasm": "application/wasm",
    }

    def log_message(self, *_):
        pass


@contextmanager
def built(work):
    """Build a site in a folder and serve it."""
    work.mkdir(exist_ok=True)
    reason = pyodide.make(work / "pyodide")
    folder = work / "site"
    build_site(folder, shipped_notebooks(), offline=True, pyodide=work / "pyodide")
    _expose(folder / "jupyter/jupyter-lite.json")
    with served(folder) as url:
        yield Site(folder, url, reason)


@contextmanager
def served(folder):
    with ThreadingHTTPServer(("127.0.0.1", 0), partial(Files, directory=folder)) as server:
        server.daemon_threads = True
        thread = Thread(target=server.serve_forever)
        thread.start()
        try:
            yield f"http://127.0.0.1:{server.server_port}"
        finally:
            server.shutdown()
            thread.join()


def _expose(config):
    """Have JupyterLab's interfaces in the page, as the tests of the real JupyterLab have them."""
    settings = json.loads(config.read_text(encoding="utf-8"))
    settings["jupyter-config-data"]["exposeAppInBrowser"] = "true"
    config.write_text(json.dumps(settings), encoding="utf-8")
