"""The documentation is built without a warning, and every link in it leads somewhere."""

from __future__ import annotations

import re
import subprocess
import sys
from collections import defaultdict
from html.parser import HTMLParser
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple
from urllib.parse import unquote, urlsplit

import pytest

import lrp_jupyter
import lrp_jupyter.testing
from lrp_jupyter.codes import CODES
from lrp_jupyter.grading.challenges import challenges
from lrp_jupyter.language.deviations import DEVIATIONS

ROOT = Path(__file__).parent.parent
SOURCES = ROOT / "notebooks"
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(find_spec("myst_nb") is None, reason="the extra `docs` is not installed"),
]


class Page(HTMLParser):
    """The links, the anchors and the text of a page."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.links: list[str] = []
        self.anchors: set[str] = set()
        self.text = ""
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if name == "id" and value:
                self.anchors.add(value)
            elif value and (name, tag) in {
                ("href", "a"),
                ("href", "link"),
                ("src", "img"),
                ("src", "script"),
            }:
                self.links.append(value)

    def handle_data(self, data: str) -> None:
        self.text += data


class Site(NamedTuple):
    """A built documentation, with the text of each page in one line."""

    folder: Path
    pages: dict[Path, Page]

    def text(self, name: str) -> str:
        return " ".join(self.pages[self.folder / name].text.split())


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Site:
    folder = tmp_path_factory.mktemp("documentation")
    command = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-b", "html", SOURCES, folder]
    command += ["-d", tmp_path_factory.mktemp("doctrees")]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    return Site(folder, {path: Page(path) for path in sorted(folder.rglob("*.html"))})


def wrong(page: Path, link: str, pages: dict[Path, Page]) -> str:
    """Say what is wrong with a link; empty if it leads somewhere, or out of these pages."""
    parts = urlsplit(link)
    if parts.scheme:
        return "" if parts.scheme in ("http", "https") and parts.netloc else "has no valid address"
    target = (page.parent / unquote(parts.path)).resolve() if parts.path else page
    if not target.is_file():
        return "leads to no file"
    if parts.fragment and unquote(parts.fragment) not in pages[target].anchors:
        return "leads to no anchor"
    return ""


def test_every_link_leads_somewhere(site: Site):
    found = defaultdict(set)
    for path, page in site.pages.items():
        for link in page.links:
            if problem := wrong(path, link, site.pages):
                found[str(path.relative_to(site.folder))].add(f"{link} {problem}")
    assert not found
    assert sum(len(page.links) for page in site.pages.values()) > 1000


@pytest.mark.parametrize("link", ["nothing.html", "index.html#nothing", "https:nothing", "ftp://example.org"])
def test_a_link_that_leads_nowhere_is_found(site: Site, link: str):
    assert wrong(site.folder / "index.html", link, site.pages)


def test_every_code_has_its_address(site: Site):
    page = site.pages[site.folder / "errors.html"]
    assert set(CODES) <= page.anchors
    text = site.text("errors.html")
    for code in CODES.values():
        assert f"{code.code}: {code.title.replace('`', '')}" in text


def test_every_notebook_is_a_page_with_its_pictures(site: Site):
    for notebook in SOURCES.rglob("*.ipynb"):
        if notebook.parent.name.startswith("."):
            continue
        page = site.pages[site.folder / notebook.relative_to(SOURCES).with_suffix(".html")]
        assert any(link.endswith(".svg") for link in page.links), notebook.name
        assert "Traceback" not in page.text or "Traceback" in notebook.read_text(encoding="utf-8")


def test_every_public_name_is_described(site: Site):
    anchors = site.pages[site.folder / "api.html"].anchors
    assert {f"lrp_jupyter.{name}" for name in lrp_jupyter.__all__} <= anchors
    assert "lrp_jupyter.Session.set_variable" in anchors
    assert {f"lrp_jupyter.testing.{name}" for name in lrp_jupyter.testing.__all__} <= anchors
    assert "lrp_jupyter.testing.RobotStub.table" in anchors


def test_what_the_package_knows_is_listed(site: Site):
    departures, teachers = site.text("departures.html"), site.text("teachers.html")
    for deviation in DEVIATIONS:
        assert deviation.reason.replace("`", "") in departures
    for challenge in challenges():
        assert challenge.name in teachers
    assert "robot.move(linear=0.0, angular=0.0)" in site.text("robots.html")
    assert not [path.name for path, page in site.pages.items() if "generated:" in page.text]


def test_nothing_is_loaded_from_elsewhere(site: Site):
    for path in site.pages:
        text = path.read_text(encoding="utf-8")
        assert not re.findall(r'<(?:script|img|link rel="stylesheet")[^>]+(?:src|href)="https?:', text)
