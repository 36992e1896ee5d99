"""What is handed in by a link: as a page of a site makes it, in a list, and as mail programs leave it."""

import csv
import zlib
from base64 import urlsafe_b64encode
from urllib.parse import quote

import pytest
from support.tables import every
from typer.testing import CliRunner

from lrp_jupyter.cli import app
from lrp_jupyter.errors import FileError
from lrp_jupyter.grading.challenges import challenge
from lrp_jupyter.grading.handing_in import programs_in
from lrp_jupyter.grading.submissions import find_submissions

# as Chromium has made it, with the button Hand in of lesson 0
MADE = (
    "http://127.0.0.1:45953/?program=slower&challenge=half+the+speed#text=XZA9bsMwDIV3neKNVhEoRbPZyNQrZAsyqDZ"
    "rEdCPQcnO9cvaRYF2EUg-8nukBtwCQcpHaZiEN6rgDI-RZYzk8B58nglNmxYps_iEZ-BI4AZZcz2hFlV921v-cIpymhkQfPzc1boQTf33"
    "ZFprQybWqkCoNi-aF4FGedKXY3S4cSJETtx6vCFxXhtVp8RRkZF0r_4f3Jhu83LE6K-4v7rLwwIYkM5V1eTHwJmOFcUAnTo2Os7lPGtFa3"
    "pY1gT3_R6XykadquTluqNP0E9Zo6YXvBxu9mF11hqrJnXxz_xj8Uu25gs"
)
DRIVE = "(machine m (state driving (running [robot.move(linear=0.2)])))\n(spawn m driving)\n"


def link(text, query="?challenge=first+move"):
    packed = urlsafe_b64encode(zlib.compress(text.encode(), wbits=-15)).decode().rstrip("=")
    return f"https://example.org/lrp/{query}#text={packed}"


def test_a_link_of_the_page_is_a_program():
    [found] = programs_in(MADE)
    assert (found.before, found.challenge, found.program) == ("", "half the speed", "slower")
    assert "(machine driver\n  (state circling" in found.text


@every(
    "written",
    [
        link("ä"),
        f"<{link('ä')}>",
        f"[InternetShortcut]\r\nURL={link('ä')}\r\n",
        f'<a href="{link("ä")}">my program</a>',
        f"https://safe.example/?url={quote(link('ä'), safe='')}&data=05",
    ],
)
def test_a_link_is_found_as_programs_write_it(written):
    [found] = programs_in(written)
    assert (found.before.removeprefix("<a href=").strip('"='), found.text) == ("", "ä")


@every("damaged", [MADE[:-30], MADE.replace("#text=X", "#text=_"), link("ä")[:-1]])
def test_a_damaged_link_is_told(damaged):
    with pytest.raises(FileError, match="The link of `Anna` is damaged"):
        programs_in(f"Anna: {damaged}")


def test_a_link_that_would_unpack_to_too_much_is_refused():
    with pytest.raises(FileError, match="is damaged"):
        programs_in(link("x" * 2_000_000))


def test_a_text_without_a_link_has_none():
    assert programs_in(f"{DRIVE}; see https://example.org/#text\n") == []


def test_a_list_of_links_is_a_class(tmp_path):
    listed, marks = tmp_path / "links.txt", tmp_path / "marks.csv"
    lines = [
        f"Anna Berg\t{link(DRIVE)}",
        "",
        f"Ben: {link('(machine m')}",
        link(DRIVE),
        "Carl is ill",
        "Dora: https://example.org/lrp/",
    ]
    listed.write_text("\n".join(lines), encoding="utf-8")
    result = CliRunner().invoke(app, ["grade", str(listed), "--challenge", "first move", "--out", str(marks)])
    assert result.exit_code == 0, result.output
    rows = {row["student"]: row for row in csv.DictReader(marks.read_text("utf-8-sig").splitlines())}
    assert {name: row["passed"] for name, row in rows.items()} == {
        "Anna Berg": "yes",
        "Ben": "no",
        "line 4": "yes",
        "Carl is ill": "no",
        "Dora: https://example.org/lrp/": "no",
    }
    assert "Line 5 of `links.txt` has no link that contains a program." in rows["Carl is ill"]["first_reason"]
    assert rows["Anna Berg"]["file"].endswith("links.txt, line 1")


def test_the_entry_of_a_student_may_be_a_text_with_links(tmp_path):
    (tmp_path / "anna.url").write_text(f"[InternetShortcut]\nURL={link(DRIVE)}\n", encoding="utf-8")
    (tmp_path / "ben.txt").write_text(f"My program: {link(DRIVE)}\nBye, Ben\n", encoding="utf-8")
    two = f"{link('(machine a)')}\n{link(DRIVE)}\n{link('(machine b)', '?challenge=maze')}\n"
    (tmp_path / "carl.txt").write_text(two, encoding="utf-8")
    found = find_submissions([tmp_path], challenge("first move"))
    assert [(each.student, each.text) for each in found] == [
        (name, DRIVE) for name in ("anna", "ben", "carl")
    ]


def test_a_list_among_the_entries_of_a_folder_is_no_student(tmp_path):
    (tmp_path / "links.txt").write_text(f"Anna {link(DRIVE)}\nBen {link(DRIVE)}\n", encoding="utf-8")
    [found] = find_submissions([tmp_path], challenge("first move"))
    assert found.text is None
    assert "has the links of several students. Mark it alone" in found.problem
