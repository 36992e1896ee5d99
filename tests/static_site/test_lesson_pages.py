"""The pages of the lessons, as `lrp site` writes them; `tests/e2e/test_lesson_pages.py` opens them."""

import json
import re
from html import unescape
from urllib.parse import unquote

import pytest

from lrp_jupyter.cli.lab_command import shipped_notebooks
from lrp_jupyter.site.lesson_pages import FOLDER, write_lessons
from lrp_jupyter.site.lessons import CodeCell, read_lessons

ROOT = shipped_notebooks()
LESSONS = read_lessons(ROOT)


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """The text of each page, by its name."""
    folder = tmp_path_factory.mktemp("site")
    write_lessons(LESSONS, folder, "abc")
    return {page.stem: page.read_text(encoding="utf-8") for page in (folder / FOLDER).iterdir()}


def test_each_lesson_is_a_page_that_leads_to_the_next_and_back(pages):
    names = [lesson.page for lesson in LESSONS]
    assert set(pages) == {*names, "index"}
    at, visited = names[0], []
    while at:
        visited.append(at)
        after = re.search(r'<a href="([^"]+)\.html" rel="next">', pages[at])
        if after:
            assert f'<a href="{at}.html" rel="prev">' in pages[after[1]]
        at = after and after[1]
    assert visited == names == re.findall(r'<li><a href="([^"]+)\.html">', pages["index"])


def test_each_program_of_a_lesson_is_a_lab_of_its_page(pages):
    for lesson in LESSONS:
        cells = [part for each in lesson.sections for part in each.parts if isinstance(part, CodeCell)]
        wanted = [
            json.loads(unescape(each)) for each in re.findall(r'data-wanted="([^"]*)"', pages[lesson.page])
        ]
        assert [each["text"] for each in wanted] == [
            each.program for each in cells if each.program is not None
        ]
        for each, cell in zip(wanted, (cell for cell in cells if cell.program is not None), strict=True):
            head = cell.source.partition("\n")[0]
            assert each["program"] == head.split()[1]
            assert ("challenge" in each) == ("--challenge" in head)
            assert each["folder"] == lesson.name


def test_what_a_lab_needs_is_defined_before_it_runs(pages):
    *_, wanted = re.findall(r'data-wanted="([^"]*)"', pages["12-safe-live-editing"])
    setup = json.loads(unescape(wanted))["setup"]
    assert "class Careful(SimBridge)" in setup
    assert "%" not in setup.split("\n")[0], "magics are Jupyter's"


def test_what_a_lab_needs_runs_where_no_other_lab_does(pages, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for page in pages.values():
        for wanted in re.findall(r'data-wanted="([^"]*)"', page):
            names = {}
            exec(json.loads(unescape(wanted))["setup"], names)
            assert "Lab" not in names, "its module needs ipywidgets"


def test_no_link_of_a_page_leads_nowhere(pages):
    for page in pages.values():
        for link in re.findall(r'href="([^"#]+)"', page):
            if link.startswith("../jupyter/"):
                assert (ROOT / unquote(link.partition("?path=")[2])).is_file(), link
            elif link.endswith(".html") and not link.startswith("../"):
                assert link.removesuffix(".html") in pages, link
            else:
                assert re.match(r"data:,$|\.\./[\w.]+(\?v=abc)?$|https://", link), link
