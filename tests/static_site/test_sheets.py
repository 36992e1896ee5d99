"""Worksheets and cards: they ask what the lessons ask, and give nothing away."""

import re
from html import escape, unescape

import pytest
from support.tables import every
from typer.testing import CliRunner

from lrp_jupyter import Session, check
from lrp_jupyter.cli import app
from lrp_jupyter.cli.lab_command import shipped_notebooks
from lrp_jupyter.errors import LRPError
from lrp_jupyter.files import read_text
from lrp_jupyter.language.parser import parse
from lrp_jupyter.sim.world import BoxSolid, FloorSpec, PathStroke, RobotSpec, World
from lrp_jupyter.site import sheets
from lrp_jupyter.site.lessons import CodeCell, inline_html, read_lessons
from lrp_jupyter.site.sheets import UNPLUGGED, cards, worksheet, write_sheets

LESSONS = read_lessons(shipped_notebooks())
PAGE = read_text(shipped_notebooks() / UNPLUGGED)
PROGRAM = parse(re.search(r"```lrp\n(.*?)```", PAGE, re.DOTALL)[1])


def words(html):
    return " ".join(unescape(re.sub(r"<[^>]*>", " ", html)).split())


def rows(lesson):
    """The rows of the tables that say what one sees."""
    for section in lesson.sections:
        if section.title in ("Investigate", "Modify"):
            for part in section.parts:
                for table in re.findall(r"^\|[^\n|]+\| and see \|\n\|.*\n((?:\|.*\n?)+)", str(part), re.M):
                    yield from (re.split(r"(?<!\\)\|", row)[1:3] for row in table.strip().split("\n"))


def test_the_lessons_have_tables_of_what_is_done_and_seen():
    assert sum(bool(list(rows(lesson))) for lesson in LESSONS) > 10


@every("lesson", LESSONS)
def test_a_worksheet_has_all_that_is_done_and_nothing_that_is_seen(lesson):
    sheet = worksheet(lesson)
    text = words(sheet)
    left_out = ("Questions", "Afterwards you can", "Run", "Investigate", "I can …")
    asked = [section.title for section in lesson.sections if section.title not in left_out]
    shown = [unescape(each) for each in re.findall("<h2>(.*?)</h2>", sheet)]
    assert asked == [each for each in shown if each not in left_out]
    for done, seen in rows(lesson):
        assert words(inline_html(done.strip())) in text
        assert len(seen) < 25 or words(inline_html(seen.strip())) not in text
    for section in lesson.sections:
        for part in section.parts:
            for program in re.findall(r"\*Predict[^\n]*:\n\n```lrp\n(.*?)```", str(part), re.DOTALL):
                assert words(escape(program)) in text
            for answer in re.findall(r"</summary>(.*?)</details>", str(part), re.DOTALL):
                first = answer.strip().split("\n\n")[0]
                assert words(inline_html(first)) not in text
            if isinstance(part, CodeCell):
                printed = ["".join(each.get("text", "")) for each in part.outputs]
                assert not [each for each in printed if each.strip() and each.strip() in text]
    assert "http" not in sheet, "it needs nothing from elsewhere"


def test_a_sheet_of_bugs_has_each_program_and_space_for_how_it_was_found():
    programs = [
        part.program for each in LESSONS[-1].sections for part in each.parts if isinstance(part, CodeCell)
    ]
    sheet = worksheet(LESSONS[-1])
    assert len(programs) == sheet.count("We asked") == sheet.count("The smallest edit") == 8
    assert all(escape(program.strip()) in sheet for program in programs)


def test_a_table_of_cases_has_space_for_an_answer_to_each():
    found = {}
    for lesson in LESSONS:
        for table in re.findall(r'<table class="cases">.*?</table>', worksheet(lesson), re.DOTALL):
            assert table.count("<th>our answer</th>") == 1
            found[lesson.page[:2]] = table.count("<td></td></tr>")
    assert found == {"08": 6, "16": 4}


def test_the_command_writes_a_page_for_each_lesson_and_the_cards(tmp_path):
    result = CliRunner().invoke(app, ["sheets", str(tmp_path / "sheets")])
    assert result.exit_code == 0, result.output
    names = {each.name for each in (tmp_path / "sheets").iterdir()}
    assert names == {*(f"{lesson.page}.html" for lesson in LESSONS), "cards.html"}


def test_where_no_browser_makes_pdf_the_pages_are_there(tmp_path, monkeypatch):
    monkeypatch.setattr(sheets, "_BROWSERS", ())
    result = CliRunner().invoke(app, ["sheets", str(tmp_path), "--pdf"], prog_name="lrp")
    assert result.exit_code == 2
    assert "no browser was found" in " ".join(result.output.split())
    assert (tmp_path / "cards.html").is_file()


def test_a_folder_without_lessons_is_told(tmp_path):
    with pytest.raises(LRPError, match="There is no lesson"):
        write_sheets(tmp_path, tmp_path / "sheets")


def test_there_is_a_card_for_each_state_event_and_transition_with_the_words_of_its_players():
    page = cards(PAGE)
    for kind, elements in (
        ("state", PROGRAM.machines[0].states),
        ("event", PROGRAM.machines[0].events),
        ("transition", PROGRAM.machines[0].transitions),
    ):
        found = re.findall(rf'<div class="card {kind}">.*?</div>', page)
        filled = [each for each in found if "<p>" in each]
        assert len(filled) == len(elements)
        assert len(found) > len(filled), "there are blank ones, too"
    waiting = words(re.search(r'<div class="card state"><span>state</span><h3>waiting.*?</div>', page)[0])
    assert waiting == (
        "state waiting Raise one hand. (onentry [robot.lamp(True)]) Stand still. (running [robot.stop()])"
        " Lower your hand. (onexit [robot.lamp(False)])"
    )


def test_the_program_of_paper_drives_a_robot_between_the_wall_and_the_line():
    assert check(PROGRAM.text) == ()
    world = World(
        size=(3, 1),
        robots=(RobotSpec((1.2, 0.5, 0)),),
        solids=(BoxSolid((2.2, 0.5, 0.1, 1), name="wall"),),
        floor=FloorSpec(strokes=(PathStroke(((0.8, 0), (0.8, 1))),)),
    )
    with Session(PROGRAM.text, "sim", world=world) as session:
        session.run(60)
        fired = list(session.frame.fired.values())
    assert len(fired) == len(PROGRAM.machines[0].transitions)
    assert min(fired) > 1
