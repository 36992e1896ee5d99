"""A class of fifty is graded in one go: each entry has a mark, a page, and points in Moodle and Canvas."""

import csv
import io
import json
import re
import xml.dom.minidom
import zipfile

import pytest
from support.school_class import FIRST, SECOND, STUDENTS, canvas, make, worksheet

from lrp_jupyter.errors import FileError
from lrp_jupyter.grading.challenges import challenge
from lrp_jupyter.grading.class_page import class_page
from lrp_jupyter.grading.feedback import write_feedback
from lrp_jupyter.grading.grade import Grade
from lrp_jupyter.grading.gradebooks import fill_in
from lrp_jupyter.grading.marks import Mark, Marks, grade_class
from lrp_jupyter.grading.marks_forms import FORMS
from lrp_jupyter.grading.similarity import alike, groups_of
from lrp_jupyter.grading.submissions import Submission, find_submissions
from lrp_jupyter.grading.summary import summaries
from lrp_jupyter.grading.workers import HowRun

pytestmark = pytest.mark.slow  # grades a whole class

READ = {"both", "first", "guess", "given", "weak", "text", "hang", "crash"}


@pytest.fixture(scope="module")
def school(tmp_path_factory):
    """The marks of the class, and what is expected of each student."""
    folder = tmp_path_factory.mktemp("class")
    kinds = make(folder)
    return grade_class(find_submissions([folder]), seeds=1, how=HowRun(limit=3)), kinds


def rows(text, separator=","):
    return list(csv.DictReader(io.StringIO(text.removeprefix("\ufeff")), delimiter=separator))


def test_every_entry_of_the_class_has_the_marks_that_it_deserves(school):
    marks, kinds = school
    found = {each.student: each for each in marks.students}
    assert sorted(found) == sorted(STUDENTS)
    assert marks.names == (FIRST, SECOND)
    for name, student in found.items():
        kind, passed = kinds[name], {each.grade.challenge for each in student.marks if each.grade.passed}
        ended = {run.ended for each in student.marks for run in each.grade.attempts} - {""}
        assert passed == {"both": {FIRST, SECOND}, "first": {FIRST}, "guess": {FIRST}}.get(kind, set()), name
        assert student.is_read == (kind != "unread"), name
        assert bool(student.marks[0].notes) == (kind in ("guess", "crash")), name
        assert all(each.submission.as_given for each in student.marks) == (kind == "given"), name
        assert ended == {"text": {"text"}, "unread": {"text"}, "hang": {"time"}, "crash": {"crash"}}.get(
            kind, set()
        )
        assert 0 <= student.points < 20 or kind == "both", name
        if kind in ("given", "unread"):
            assert student.points == 0, name
        if kind == "unread":
            assert re.fullmatch(r"[A-Z`].*[.?]", student.marks[0].reason), name


def test_the_marks_are_written_in_every_form(school):
    marks, kinds = school
    table = rows(marks.table())
    assert [row["student"] for row in table] == [each.student for each in marks.students]
    assert {row[SECOND] for row in table if kinds[row["student"]] == "both"} == {"10"}
    assert {row[SECOND] for row in table if kinds[row["student"]] == "first"} == {""}
    german = rows(FORMS[".csv"](marks, ";"), ";")
    english = rows(FORMS[".csv"](marks, ","))
    assert [row["points"].replace(",", ".") for row in german] == [row["points"] for row in english]
    assert any("," in row["points"] for row in german)
    assert len(json.loads(FORMS[".json"](marks, ","))["submissions"]) == len(marks.marks)
    assert len(
        xml.dom.minidom.parseString(FORMS[".xml"](marks, ",")).getElementsByTagName("testsuite")
    ) == len(marks.marks)


def test_the_summary_says_what_fails_and_who_needs_help(school):
    marks, kinds = school
    first, second = summaries(marks)
    assert first.passed == sum(kind in ("both", "first", "guess") for kind in kinds.values())
    assert {*first.as_given} == {name for name, kind in kinds.items() if kind == "given"}
    assert first.criteria == {"gets 30 cm away from its start": first.passed}
    assert first.failures[0].criterion == "gets 30 cm away from its start"
    assert first.failures[0].hint
    assert set(first.no_progress) >= {
        name for name, kind in kinds.items() if kind in ("hang", "crash", "text")
    }
    (group,) = groups_of(second.alike)
    assert {name for name, kind in kinds.items() if kind == "both"} <= {*group}  # one is in disguise
    page = class_page(marks)
    assert all(name.replace("'", "&#x27;") in page for name in STUDENTS)
    assert str(second).count("Alike by") == 1
    same = second._replace(alike=tuple(pair for pair in second.alike if pair.share == 1))
    assert "  Alike by 100%: " in str(same)


def test_every_student_gets_a_page_that_moodle_can_give_back(school, tmp_path):
    marks, kinds = school
    files = write_feedback(marks, tmp_path / "pages")
    assert len({*files}) == len(STUDENTS)
    pages = {file.name.partition("_")[0]: file.read_text("utf-8") for file in files}
    assert files[0].name == "Ada Lovelace_1000_assignsubmission_file_feedback.html"
    for name, kind in kinds.items():
        page = pages[name.replace("'", "'")]
        assert (
            page.count("<svg")
            == page.count("</svg>")
            == (kind == "given") * page.count("<svg") + (kind == "weak")
        ), name
        assert not re.search(r"""(src|href)=|url\((?!#)""", page), name  # it needs no other file
        assert "(running" not in page, name  # and has no solution
        assert not [other for other in STUDENTS if other != name and other in page]
        assert ("What was handed in cannot be graded." in page) == (kind == "unread"), name
        assert ("Hint:" in page) or kind not in ("weak", "text"), name


@pytest.mark.parametrize("separator", [",", ";"])
def test_moodle_gets_its_worksheet_back_with_grades_and_comments(school, tmp_path, separator):
    marks, kinds = school
    book = tmp_path / "Grades.csv"
    book.write_bytes(worksheet(separator).encode())
    filled = fill_in(book, marks)
    before, after = rows(worksheet(separator), separator), rows(filled.text, separator)
    point = "," if separator == ";" else "."
    expected = {"both": f"100{point}0", "first": f"50{point}0", "given": f"0{point}0", "unread": ""}
    for old, new in zip(before, after, strict=True):
        kind = kinds.get(new["Full name"], "absent")
        assert {**new, "Grade": "", "Feedback comments": ""} == old
        assert new["Grade"] == expected.get(kind, "" if kind == "absent" else new["Grade"]), new
        assert bool(new["Feedback comments"]) == (kind != "absent")
    assert filled.rows == sum(kind in READ for kind in kinds.values())
    (note,) = filled.notes
    assert note.startswith("No grade was entered for ")


def test_canvas_gets_the_points_of_each_assignment_by_the_names_in_another_order(school, tmp_path):
    marks, kinds = school
    book = tmp_path / "gradebook.csv"
    book.write_text(canvas(), "utf-8")
    after = rows(fill_in(book, marks).text)
    assert after[0]["First Move (77)"] == "5.00"
    found = {row["Student"]: (row["First Move (77)"], row["Bump and Turn (78)"]) for row in after[1:]}
    for name, kind in kinds.items():
        first, _, last = name.partition(" ")
        points = {"both": ("5.0", "10.0"), "first": ("5.0", ""), "unread": ("", "")}
        assert found[f"{last}, {first}"] == points.get(kind, found[f"{last}, {first}"])
    whole = rows(fill_in(book, marks, "First Move").text)[1]
    assert (whole["Student"], whole["First Move (77)"], whole["Bump and Turn (78)"]) == (
        "Lovelace, Ada",
        "5.0",
        "",
    )


# -- one by one ------------------------------------------------------------------------------------


def graded(*students, challenge_name=FIRST):
    """Return marks without runs: of half of the points for students, given by name, entry and number."""
    task = challenge(challenge_name)
    grade = Grade(task.name, (), task.points)
    marks = (
        Mark(Submission(name, "x.lrp", "text", entry=entry, number=number), grade)
        for name, entry, number in students
    )
    return Marks((task,), tuple(marks))


def test_a_row_is_found_by_its_number_or_by_a_name_that_only_one_student_has(tmp_path):
    book = tmp_path / "g.csv"
    book.write_text(
        "Identifier,Full name,Grade,Maximum Grade,Grade can be changed\n"
        "Participant 7,Kim Lee,,10,Yes\nParticipant 8,Kim Lee,,10,Yes\nParticipant 9,ÖZ Carla,,10,Yes\n"
        "Participant 10,Ann Other,,10,Yes\nParticipant 11,Bo Locked,,10,No\n"
    )
    marks = graded(
        ("Kim Lee", "Kim Lee_8_assignsubmission_file", "8"),
        ("Carla Öz", "Carla Öz", ""),
        ("Kim Lee", "Kim Lee.lrp", ""),
        ("Ann Other", "annother_999_4_x.lrp", "999"),
        ("Bo Locked", "bo", ""),
        ("Not There", "not", ""),
    )
    filled = fill_in(book, marks)
    assert [row["Grade"] for row in rows(filled.text)] == ["0.0", "0.0", "0.0", "0.0", ""]
    assert filled.notes == (
        "Moodle does not let you change the grades of Bo Locked.",
        "There is no column for comments. Switch on *Feedback comments* in the assignment.",
        "No row was found for Not There. Enter their points yourself.",
    )


def test_a_table_that_a_spreadsheet_has_saved_in_its_own_encoding_is_read_and_that_is_noted(tmp_path):
    book = tmp_path / "g.csv"
    book.write_bytes(
        "ID;Vollständiger Name;Bewertung;Bestwertung\nTeilnehmer/in9;Carla Öz;;10,00\n".encode("cp1252")
    )
    filled = fill_in(book, graded(("Carla Öz", "oez.lrp", "")))
    assert filled.text.endswith("Teilnehmer/in9;Carla Öz;0,0;10,00\n")
    assert "was read as Windows-1252, which is a guess" in filled.notes[0]


@pytest.mark.parametrize(
    ("text", "column", "words"),
    [
        (
            "a,b\n1,2\n",
            None,
            "is neither Moodle's grading worksheet nor Canvas's gradebook: its columns are `a`, `b`.",
        ),
        ("x\n", None, "is not a table"),
        (
            "Student,ID,Section,Lap (1)\n",
            None,
            "has no column for `first move`. Choose one with `--column NAME`",
        ),
        ("Student,ID,Section,Lap (1)\n", "lapse", "has no column `lapse`. Choose one of `Student`"),
    ],
)
def test_a_table_that_cannot_be_filled_in_says_what_to_do(tmp_path, text, column, words):
    book = tmp_path / "g.csv"
    book.write_text(text)
    with pytest.raises(FileError, match=re.escape(words)):
        fill_in(book, graded(("Ada", "ada", "")), column)


ONE = """
(machine m (var n := [0])
  (state ahead (running [robot.move(linear=0.2)]) (onexit [n = n + 1]))
  (state left (running [robot.move(angular=0.5)]))
  (state end)
  (event four [n > 3])
  (on four left -> end) (ontime 3000 ahead -> left) (ontime 3142 left -> ahead))
(spawn m ahead)
"""
OTHER = """
(var count := [4])
(machine square
  (state side (onentry [count -= 1]) (running [robot.move(linear=0.25)]))
  (state corner (running [robot.move(angular=1)]))
  (ontime 2400 side -> corner)
  (on [abs(robot.gyro.data) > 90] corner -> side)
  (on [count < 1] * -> side))
(spawn square side)
"""


def test_programs_are_alike_whatever_their_names_comments_layout_and_order():
    disguised = re.sub(r"\b(m|n|ahead|left|end|four)\b", r"x_\1", ONE).replace("  (state x_end)\n", "")
    disguised = disguised.replace("(event", "(state x_end) ; the last\n (event")
    other_numbers = ONE.replace("0.2", "0.21").replace("3000", "2857").replace("0.5", "0.4")
    programs = {"one": ONE, "two": disguised, "three": other_numbers, "four": OTHER, "bad": ONE[:-3]}
    shares = {(first, second): share for first, second, share in alike(programs, least=0.01)}
    assert shares["one", "two"] == 1
    assert 0.5 < shares["one", "three"] < 0.9
    assert shares["one", "four"] < 0.3
    assert not any("bad" in pair for pair in shares)
    assert alike(programs, given=ONE, least=0.01) == []  # only one of them has added anything to it


DRIVES = "(machine m (state a (running [robot.move(linear=0.2)]))) (spawn m a)"


@pytest.mark.parametrize(
    "rest", ["<![", "<!--", "<?", "</", "<a href='", "<", "<!-- < -->", "<!DOCTYPE html>"]
)
def test_a_page_with_half_a_tag_is_read_and_holds_up_no_one(rest, tmp_path):
    """The parser fails at some halves of tags, and takes hours for many of others."""
    (tmp_path / "ada.html").write_text(f"<p>; challenge: first move</p><p>{DRIVES}</p>{rest * 2_000}")
    (found,) = find_submissions([tmp_path])
    assert (found.challenge, found.problem) == ("first move", "")
    assert DRIVES in found.text


def test_a_zip_file_with_very_many_files_is_not_opened_for_each(tmp_path):
    with zipfile.ZipFile(tmp_path / "ada.zip", "w") as archive:
        for number in range(2_001):
            archive.writestr(f"{number}.lrp", DRIVES)
    (found,) = find_submissions([tmp_path], challenge("first move"))
    assert "It has more than 2,000 files." in found.problem


def test_a_student_with_a_very_long_name_has_a_page_and_moodle_knows_whose_it_is(tmp_path):
    names = ["\N{GRINNING FACE}" * 140, "A" * 300]
    moodle = Submission(names[1], "a.lrp", entry=f"{names[1]}_1000_assignsubmission_file", number="1000")
    marks = Marks(
        (), tuple(Mark(each, Grade("")) for each in (Submission(names[0], "b.lrp", entry="b"), moodle))
    )
    first, second = write_feedback(marks, tmp_path / "pages")
    assert first.stem == names[0][:37]
    assert second.stem == f"{'A' * 150}_1000_assignsubmission_file_feedback"
