"""A real JupyterLab and a real browser: one server and one browser for these tests, a kernel for each.

They end with the last test of this folder, because Playwright runs an event loop in the main
thread as long as it lives, and other tests have one of their own.
"""

import os
from collections import deque
from functools import partial
from pathlib import Path

import pytest
from static_site import pyodide
from static_site.site import built

from e2e.jupyter import FLAGS, chromium, jupyter, lacking
from e2e.pages import NotebookPage, close_all, forget

WAIT = 120_000  # ms: it only ends a test that hangs
WINDOW = {"width": 1600, "height": 1000}
ALONE = "--host-resolver-rules=MAP * ~NOTFOUND , EXCLUDE 127.0.0.1"


def pytest_collection_modifyitems(items):
    here = Path(__file__).parent
    for item in items:
        if here in Path(item.fspath).parents:
            item.add_marker(pytest.mark.browser)
            missing = lacking(*needed_by(item))
            if missing and not os.environ.get("CI"):
                item.add_marker(pytest.mark.skip(reason=f"there is no {missing}"))


def needed_by(item):
    """Return the packages of other notebooks that a test names in its mark `host`."""
    return [name for mark in item.iter_markers("host") for name in mark.args]


@pytest.fixture(scope="package")
def server(tmp_path_factory):
    assert not lacking(), f"there is no {lacking()}"
    with jupyter(tmp_path_factory.mktemp("jupyter")) as server:
        yield server


@pytest.fixture(scope="package")
def playwright():
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        yield playwright


@pytest.fixture(scope="package")
def context(playwright):
    """A browser whose cache knows JupyterLab after the first test."""
    browser = playwright.chromium.launch(executable_path=chromium(), args=FLAGS)
    context = browser.new_context(viewport=WINDOW)
    context.set_default_timeout(WAIT)
    yield context
    browser.close()


@pytest.fixture(scope="package")
def site(tmp_path_factory):
    """A static site that holds all that it needs."""
    if pyodide.lacking():
        assert not os.environ.get("CI"), f"there is no {pyodide.lacking()}"
        pytest.skip(f"there is no {pyodide.lacking()}")
    with built(tmp_path_factory.mktemp("site")) as site:
        assert not (os.environ.get("CI") and site.without_simulator), site.without_simulator
        yield site


@pytest.fixture
def simulator(site):
    """Skip a test that needs a robot where the site has none."""
    if site.without_simulator:
        pytest.skip(site.without_simulator)


@pytest.fixture(scope="package")
def alone(playwright):
    """A browser that knows no name of the network."""
    browser = playwright.chromium.launch(executable_path=chromium(), args=[*FLAGS, ALONE])
    yield browser
    browser.close()


@pytest.fixture(scope="package")
def visitors(alone, site):
    """Open pages of new visitors, who ask for nothing but the site."""
    contexts, asked = [], []

    def visitor():
        context = alone.new_context(viewport=WINDOW, permissions=["clipboard-write"])
        contexts.append(context)
        context.set_default_timeout(WAIT)
        context.on("request", lambda request: asked.append(request.url))
        context.on("requestfailed", lambda request: _said.append(f"failed: {request.url}, {request.failure}"))
        context.on("console", lambda message: _said.append(f"{message.type}: {message.text}"))
        context.on("weberror", lambda error: _said.append(f"not caught: {error.error}"))
        return context.new_page()

    yield visitor
    for each in contexts:
        each.close()
    assert [url for url in asked if not url.startswith((site.url, "blob:", "data:"))] == []
    assert f"{site.url}/python/pyodide.asm.wasm" in asked


@pytest.fixture(scope="package")
def visitor(visitors):
    """The page of one visitor, whose browser knows the site after the first test."""
    return visitors()


_said = deque(maxlen=30)  # what pages of the site wrote to their consoles, and what they could not load


@pytest.fixture
def page(context, server):
    """A page of JupyterLab: that of the last test, with nothing open, if it ended well."""
    page = context.pages[-1] if context.pages else context.new_page()
    page.set_viewport_size(WINDOW)
    errors = []
    note = partial(_note, errors)
    page.on("pageerror", note)
    yield page
    page.remove_listener("pageerror", note)
    if not close_all(page):
        page.close()
    server.end_kernels()
    assert errors == []


def _note(errors, error):
    if "blob:" in str(error.stack):  # the lab's module; JupyterLab and Notebook have faults of their own
        errors.append(str(error.stack))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item):
    report = yield
    if report.when == "call" and report.failed:
        browsers = {item.funcargs[name] for name in ("alone", "browser") if name in item.funcargs}
        if "context" in item.funcargs:
            browsers.add(item.funcargs["context"].browser)
        contexts = [context for browser in browsers for context in browser.contexts]
        for page in [page for context in contexts for page in context.pages]:
            report.sections.append(("what a page shows", _shown(page)))
            if page.context is item.funcargs.get("context"):
                if "server" in item.funcargs:
                    page.screenshot(path=item.funcargs["server"].root.parent / f"{item.name}.png")
                forget(page)
                page.close()
        if "alone" in item.funcargs:
            report.sections.append(("what the pages of the site said", "\n".join(_said)))
    return report


def _shown(page):
    labs = page.locator('[data-lrp="lab"]').evaluate_all("labs => labs.map(lab => ({...lab.dataset}))")
    return "\n".join([page.url, *map(str, labs), page.locator("body").inner_text()])


@pytest.fixture
def open_notebook(page, server, request):
    """Write a notebook and open it."""

    def open_notebook(*cells, app="lab/tree"):
        notebook = NotebookPage(page, server, f"{request.node.name}/notebook.ipynb")
        server.write(notebook.name, cells)
        return notebook.show(app)

    return open_notebook


@pytest.fixture
def open_lab(open_notebook):
    """Open a notebook with a lab in its second cell, and wait until it runs."""

    def open_lab(program, line="m", *more, **where):
        notebook = open_notebook("%load_ext lrp_jupyter", f"%%lrp {line}\n{program}", *more, **where)
        notebook.run_cell(0)
        notebook.begin_cell(1)
        return notebook.lab().ready()

    return open_lab
