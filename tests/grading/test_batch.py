"""Many programs and seeds at once: what hangs, crashes or cannot be read costs only itself."""

import csv
import io
import json
import os
import zipfile
import zlib
from base64 import urlsafe_b64encode
from pathlib import Path
from xml.etree import ElementTree

import pytest

from lrp_jupyter.errors import FileError
from lrp_jupyter.grading.attempt import Attempt, Job
from lrp_jupyter.grading.batch import grade_all
from lrp_jupyter.grading.challenges import Challenge, challenge
from lrp_jupyter.grading.criteria import Criterion, drives, no_faults
from lrp_jupyter.grading.grade import Grade, grade, jobs_of
from lrp_jupyter.grading.marks import grade_class
from lrp_jupyter.grading.marks_forms import as_json
from lrp_jupyter.grading.submissions import Submission, find_submissions
from lrp_jupyter.grading.workers import HowRun, run_jobs
from lrp_jupyter.sim.worlds import load
from lrp_jupyter.spreadsheets import csv_text

DRIVE = "(machine m (state driving (running [robot.move(linear=0.2)]))) (spawn m driving)"
SLOW = DRIVE.replace("0.2", "0.02")  # which drives 20 cm in ten seconds
HANG = DRIVE.replace("robot.move(linear=0.2)", "while True: pass")
CRASH = DRIVE.replace("robot.move(linear=0.2)", "import os; os.abort()")
FIRST = challenge("first move")


@pytest.mark.slow
def test_a_program_that_hangs_or_crashes_costs_only_its_own_grade_and_one_run():
    texts = [DRIVE, HANG, CRASH, "(machine", SLOW]
    good, hung, crashed, invalid, slow = grade_all(texts, FIRST, 3, HowRun(limit=3))
    assert good == grade(DRIVE, FIRST, 3)
    assert slow == grade(SLOW, FIRST, 3)
    assert 0 < slow.points < 10
    assert [[each.ended for each in one.attempts] for one in (hung, crashed, invalid)] == [
        ["time"],
        ["crash"],
        ["text"],
    ]
    assert [one.runs for one in (hung, crashed, invalid)] == [3, 3, 3]


def test_a_batch_reports_its_progress_up_to_all_runs_also_those_that_need_not_be_made():
    grade_all([FIRST.beginning], FIRST, 3)
    seen = []
    grade_all([DRIVE, CRASH], FIRST, 3, progress=lambda done, of: seen.append((done, of)))
    assert seen[0] == (0, 6)
    assert seen[-1] == (6, 6)
    assert seen == sorted(seen)


def test_equal_programs_are_run_once_and_what_one_begins_with_once_in_a_process(monkeypatch):
    monkeypatch.setattr("lrp_jupyter.grading.grade._starters", [])
    totals = []
    for _ in range(2):
        first, second = grade_all([DRIVE, DRIVE], FIRST, 2, progress=lambda _, of: totals.append(of))
        assert first == second
    assert list(dict.fromkeys(totals)) == [4, 2]


@pytest.mark.slow
def test_the_second_run_of_a_program_waits_for_its_first_while_others_run():
    limits = {HANG: 3, DRIVE: 60, SLOW: 60}
    jobs = [Job((text,), FIRST, load("empty"), seed, limits[text]) for seed in (0, 1) for text in limits]
    made = dict(run_jobs(jobs, HowRun(processes=3), stop_at_end=True))
    assert sorted(made) == [0, 1, 2, 4, 5]  # of what hangs, one run only


def test_runs_that_were_not_made_earn_nothing():
    whole = Attempt("empty", 0, 1.0, (), share=1.0)
    stopped = Attempt("empty", 1, 0.0, (), ended="time")
    late = Attempt("empty", 2, 1.0, (), share=1.0)  # made at the same time
    result = Grade.of(FIRST, {2: late, 0: whole, 1: stopped}, jobs_of(DRIVE, FIRST, 4)[1])
    assert result.attempts == (whole, stopped)
    assert result.points == 2.5


def test_a_fault_of_a_criterion_costs_one_run_and_is_told_apart_from_a_failure():
    def judge(run):
        if run.seconds > 1 and run.driven < 0.1:
            raise ZeroDivisionError("our own mistake")
        return True, ""

    task = Challenge("odd", "", ("empty",), (Criterion("is judged", judge), drives(0.3), no_faults()), 5)
    good, bad = grade_all([DRIVE, SLOW], task, 1)
    assert good.passed
    assert bad.attempts[0].ended == "fault"
    assert bad.attempts[0].verdicts[0].reason.startswith("ZeroDivisionError: our own mistake.\nTraceback")


# -- submissions -----------------------------------------------------------------------------------


@pytest.fixture
def hand_in(tmp_path):
    """Write files into the folder of a class."""

    def write(files):
        for name, content in files.items():
            path = tmp_path / name
            path.parent.mkdir(parents=True, exist_ok=True)
            data = content if isinstance(content, bytes) else content.encode()
            path.write_bytes(data)
        return tmp_path

    return write


def notebook(*cells):
    return json.dumps({"cells": [{"cell_type": "code", "source": cell.splitlines(True)} for cell in cells]})


def found(folder, task=FIRST):
    return {each.student: each.text or each.problem for each in find_submissions([folder], task)}


def test_a_folder_has_a_file_or_a_folder_for_each_student(hand_in):
    folder = hand_in({
        "ada.lrp": "1",
        "bob/square.lrp": "2",
        "Carl Cu_4711_assignsubmission_file_/deep/mine.lrp": "3",
        "Dora D_12_assignsubmission_file_my.lrp": "4",
        "eve/first-move/first-move.ipynb": notebook("%%lrp a\n5"),
        "frida_99_12345_mine.lrp": "6",
        ".hidden/x.lrp": "no", "eve/first-move/.ipynb_checkpoints/y.lrp": "no", "__MACOSX/x": "",
    })  # fmt: skip
    expected = {"Carl Cu": "3", "Dora D": "4", "ada": "1", "bob": "2", "eve": "5", "frida": "6"}
    assert found(folder) == expected
    numbers = {each.student: each.number for each in find_submissions([folder], FIRST) if each.number}
    assert numbers == {"Carl Cu": "4711", "Dora D": "12", "frida": "99"}


def test_every_entry_has_a_row_and_what_is_no_program_says_why(hand_in):
    folder = hand_in({
        "ada.TXT": "1", "bob.LRP": "2", "carl": "3", "dora.lrp.txt": "4",
        "eve.ipynb.json": notebook("%%lrp x\n5"),
        "frida.zip": zipped({"a/b/mine.lrp": "6", "__MACOSX/mine.lrp": "no", "report.pdf": "%PDF"}),
        "gina/inner.zip": zipped({"more.zip": zipped({"mine.lrp": "7"})}),
        "hans.docx": b"PK", "ida/report.pdf": b"%PDF", "jo.zip": b"PK not", "kim.zip": zipped({}),
        "lea.rar": b"Rar!", "mia.lrp": " \n", "nina.lrp": b"\0\1\2", "olaf.ipynb": notebook("%%lrp x\n"),
        "pia.zip": LOCKED,
        "bomb.zip": zipped({"big.lrp": " " * 40_000_000}),
        "both/mine.lrp": "8", "both/notes.txt": "no",
    })  # fmt: skip
    (folder / "quin").mkdir()
    (folder / "marks.csv").write_text("of the teacher's")
    rows = {each.student: each for each in find_submissions([folder], FIRST, None, [folder / "marks.csv"])}
    texts = {student: row.text for student, row in rows.items() if row.text is not None}
    assert "".join(texts.values()) == "12834567"  # in the order of the entries
    assert {student: row.problem for student, row in rows.items() if row.text is None} == {
        "hans": NO_PROGRAM.format("hans.docx"),
        "ida": NO_PROGRAM.format("report.pdf"),
        "jo": f"`jo.zip` cannot be unpacked: It is damaged, or not a zip file. {AGAIN}",
        "kim": "`kim.zip` is an empty zip file.",
        "lea": "`lea.rar` is an archive that cannot be opened here. Unpack it, or pack it as `.zip`.",
        "mia": "`mia.lrp` is empty. Open the program in the lab, save it again, and hand in that.",
        "nina": "`nina.lrp` is not a text: it has bytes that no text has. Save the program as text again.",
        "olaf": "`olaf.ipynb` has an empty `%%lrp` cell. Save the notebook again, with the lab open. "
        "Begin the cell to be graded with `%%lrp first-move --challenge 'first move'`.",
        "pia": f"`a.lrp` cannot be unpacked: It is encrypted. {AGAIN}",
        "bomb": f"`big.lrp` cannot be unpacked: It contains more than 32 MB. {AGAIN}",
        "quin": "`quin` is an empty folder.",
    }


AGAIN = "Pack it again, or hand in the file itself."
NO_PROGRAM = (
    "`{}` is not a program. Hand in the notebook, or the file that Save… in the menu More of the lab writes."
)


def zipped(files):
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return data.getvalue()


def locked(data):
    """Return a zip file whose files say that they are encrypted."""
    local, central = data.index(b"PK\3\4") + 6, data.index(b"PK\1\2") + 8
    flagged = bytearray(data)
    flagged[local] |= 1
    flagged[central] |= 1
    return bytes(flagged)


LOCKED = locked(zipped({"a.lrp": "1"}))


def test_a_class_may_be_one_zip_file_as_moodle_sends_it_or_in_a_folder_in_it(hand_in):
    files = {"Ada A_1_assignsubmission_file/mine.lrp": "1", "Bob B_2_assignsubmission_file/mine.lrp": "2"}
    folder = hand_in(
        {"a.zip": zipped(files), "b.zip": zipped({f"class/{name}": files[name] for name in files})}
    )
    assert found(folder / "a.zip") == found(folder / "b.zip") == {"Ada A": "1", "Bob B": "2"}


def link_to(text, query="?challenge=first+move&program=mine"):
    packed = zlib.compress(text.encode(), wbits=-15)
    return f"https://example.org/lrp/{query}#text={urlsafe_b64encode(packed).decode().rstrip('=')}"


def test_links_and_texts_that_were_pasted_into_moodle_are_programs(hand_in):
    link = link_to(DRIVE)
    folder = hand_in({
        "ada.url": f"[InternetShortcut]\r\nURL={link}\r\n",
        "bob.txt": f"This is mine:\n{link}",
        "Carl C_7_assignsubmission_onlinetext/onlinetext.html":
            f'<p>see <a href="{link.replace("&", "&amp;")}">it</a>',
        "Dora D_8_assignsubmission_onlinetext/onlinetext.html":
            "<p>; challenge: first move</p><p>(machine m (state&nbsp;a<br>"
            "(running [robot.move(linear=0.2)])))</p><div>(spawn m a)</div>",
        "eve.html": '<body class="jp-Notebook">',
        "frida.txt": link[:-9],
    })  # fmt: skip
    rows = {each.student: each for each in find_submissions([folder])}
    texts = {name: row.text for name, row in rows.items()}
    assert texts["ada"] == texts["bob"] == texts["Carl C"] == DRIVE
    assert {row.challenge for name, row in rows.items() if name < "Z" or name in ("ada", "bob")} == {
        "first move"
    }
    assert grade(texts["Dora D"], "first move", 1).passed
    assert rows["eve"].problem.endswith("Hand in the notebook itself, `NAME.ipynb`.")
    assert "The link is damaged" in rows["frida"].problem


def test_a_list_of_links_has_a_row_for_each_line(hand_in):
    lines = [
        f"Ada Lovelace   {link_to(DRIVE)}", "", f"Bob, {link_to('1')}",
        f"Ada Lovelace: {link_to('2', '?challenge=lap')}",
        f"Carl  {link_to(DRIVE)[:-9]}", "Dora was ill",
    ]  # fmt: skip
    path = hand_in({"links.txt": "\n".join(lines)}) / "links.txt"
    rows = [
        (each.student, each.challenge, each.text or each.problem[:22]) for each in find_submissions([path])
    ]
    assert rows == [
        ("Ada Lovelace", "first move", DRIVE),
        ("Ada Lovelace", "lap", "2"),
        ("Bob", "first move", "1"),
        ("Carl", "", "The link of `Carl` is "),
        ("Dora was ill", "", "Line 6 of `links.txt` "),
    ]


@pytest.mark.parametrize(
    ("data", "read_as"),
    [
        ("ü".encode("utf-16"), ""),
        ("ü".encode("utf-8-sig"), ""),
        ("ü".encode("utf-32"), ""),
        ("ü; machine".encode("utf-16-le"), "UTF-16"),
        ("ü; machine".encode("utf-16-be"), "UTF-16"),
        ("ü; “machine”".encode("cp1252"), "Windows-1252"),
        ("ü\x81".encode("latin-1"), "Latin-1"),
    ],
)
def test_a_program_in_another_encoding_is_read_and_a_guess_is_noted(hand_in, data, read_as):
    (submission,) = find_submissions([hand_in({"ada.lrp": data}) / "ada.lrp"], FIRST)
    assert submission.text.startswith("ü")
    assert [each for each in submission.notes if f"was read as {read_as}, which is a guess" in each] == list(
        submission.notes
    )
    assert bool(submission.notes) == bool(read_as)


def test_the_line_ends_of_an_old_mac_end_lines(hand_in):
    text = (
        "; challenge: first move\r(machine m (state a (running [robot.move(linear=0.2)])))\r(spawn m a) ; x\r"
    )
    (submission,) = find_submissions([hand_in({"ada.lrp": text}) / "ada.lrp"])
    assert submission.challenge == "first move"
    assert grade(submission.text, submission.challenge, 1).passed


def test_of_several_files_of_a_student_the_one_for_the_challenge_counts(hand_in):
    folder = hand_in({
        "ada/first_move.lrp": "1", "ada/square.lrp": "2",
        "bob/a.lrp": "1", "bob/b.lrp": "2",
        "carl/a.ipynb": notebook("%%lrp x --challenge square\n1"),
        "carl/b.ipynb": notebook("%%lrp x --challenge first-move\n2"),
    })  # fmt: skip
    texts = found(folder)
    assert (texts["ada"], texts["carl"]) == ("1", "2")
    assert texts["bob"].startswith("There are several programs: `a.lrp`, `b.lrp`. Name the one")


@pytest.mark.parametrize(
    ("cells", "text"),
    [
        (["import lrp_jupyter", "%%lrp x --world line\n(machine a)"], "(machine a)"),
        (["%%lrp x\n1", '%%lrp y --challenge "first move" --rate 20\n2\n'], "2\n"),
        (["%%lrp x --challenge=first-move\n1", "%%lrp x --challenge=first-move\n2"], "2"),
        (["%%lrp x\n1", "%%lrp x\n"], "1"),
        (["%%lrp x\n1", "%%lrp y\n2"], "has 2 `%%lrp` cells, and none is for this challenge."),
        (["print(1)", "%lrp examples"], "has no `%%lrp` cell."),
        (['%%lrp "x\n1'], "1"),
    ],
)
def test_the_cell_for_the_challenge_is_the_program_of_a_notebook(hand_in, cells, text):
    folder = hand_in({"ada.ipynb": notebook(*cells)})
    assert found(folder)["ada"].endswith(text) or text in found(folder)["ada"]


def lab_in(source, text, **about):
    """Return the cell of a notebook whose output is a lab, as Jupyter saves it."""
    output = {
        "output_type": "execute_result",
        "data": {"image/svg+xml": "<svg/>", "text/plain": text.splitlines(True)},
        "metadata": {"lrp_jupyter": {"program": "x", **about}},
    }
    plot = {"output_type": "display_data", "data": {"image/png": ""}, "metadata": {}}
    return {"cell_type": "code", "source": source, "outputs": [plot, output]}


def test_a_lab_without_a_cell_of_its_own_is_saved_with_its_text(hand_in):
    mine = lab_in("Lab(challenge='first move')", "1\n", challenge="first move")
    other = lab_in("Lab('follower')", "2")
    cell = lab_in("%%lrp x --challenge square\n3", "4", challenge="square")
    blank = lab_in("%%lrp x --challenge 'first move'\n", "5", challenge="first move")
    odd = [{**mine, "outputs": 1}, lab_in("", "6", challenge=7), {**mine, "outputs": [1, {"metadata": 1}]}]
    folder = hand_in({
        "ada.ipynb": json.dumps({"cells": [other, mine, cell]}),
        "bob.ipynb": json.dumps({"cells": [other]}),
        "carl.ipynb": json.dumps({"cells": [blank, *odd]}),
    })  # fmt: skip
    assert found(folder) == {"ada": "1\n", "bob": "2", "carl": "5"}
    assert found(folder, challenge("square"))["ada"] == "3"


def test_a_submission_in_which_nothing_was_changed_says_so(hand_in):
    beginning = f"{FIRST.beginning}\n\n"
    folder = hand_in({"ada.lrp": beginning, "bob.lrp": "(machine a)", "dora.lrp": DRIVE})
    given = hand_in({"given/lesson.ipynb": notebook("%%lrp x\n(machine  a)\n")}) / "given/lesson.ipynb"

    def as_given(*given):
        files = sorted(folder.glob("*.lrp"))
        return [each.student for each in find_submissions(files, FIRST, *given) if each.as_given]

    assert as_given() == ["ada"]
    assert as_given(given) == ["bob"]


@pytest.mark.parametrize("content", ["{", "[]", '{"cells": [1]}', b"\xff\xfe"])
def test_a_notebook_that_cannot_be_read_says_so(hand_in, content):
    (submission,) = find_submissions([hand_in({"ada.ipynb": content}) / "ada.ipynb"], FIRST)
    assert submission.text is None
    assert "ada.ipynb` is not" in submission.problem


def test_a_link_out_of_the_folder_is_not_followed(hand_in, tmp_path):
    folder = hand_in({"class/ada.lrp": "1", "secret.lrp": "no"}) / "class"
    (folder / "bob.lrp").symlink_to(tmp_path / "secret.lrp")
    assert found(folder) == {
        "ada": "1",
        "bob": "`bob.lrp` is a link, which is not followed. Put the file itself there.",
    }


def test_whatever_a_student_hands_in_the_others_are_read(tmp_path, hand_in):
    deep = hand_in({"ada.lrp": "1", "bob/a.lrp": "2"}) / "deep"
    here = os.open(tmp_path, os.O_RDONLY)
    for _ in range(250):  # longer than a path may be
        os.mkdir("d" * 20, dir_fd=here)
        here, above = os.open("d" * 20, os.O_RDONLY, dir_fd=here), here
        os.close(above)
    os.close(here)
    (tmp_path / ("d" * 20)).rename(deep)
    os.mkfifo(tmp_path / "pipe.lrp")
    (tmp_path / "long.lrp").write_text("(" * 1_000_001)
    Path(os.fsdecode(os.fsencode(tmp_path) + b"/\xff\x1b[2J\n.lrp")).write_text("3")
    read = found(tmp_path)
    assert (read.pop("ada"), read.pop("bob"), read.pop("<U+DCFF><U+001B>[2J<U+000A>")) == ("1", "2", "3")
    assert {name: problem.rpartition("`")[2] for name, problem in read.items()} == {
        "deep": " cannot be read: File name too long.",
        "pipe": " cannot be read: It is a device or a pipe, not a file.",
        "long": " has more than 1,000,000 characters. Let it be shorter.",
    }


def test_a_folder_without_submissions_is_an_error(tmp_path):
    with pytest.raises(FileError, match="There is no submission in"):
        find_submissions([tmp_path], FIRST)
    with pytest.raises(FileError, match="neither a file nor a folder"):
        find_submissions([tmp_path / "nowhere"], FIRST)


# -- marks -----------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def marks():
    submissions = [
        Submission("Ada", "ada.lrp", DRIVE),
        Submission("=cmd|' /C calc'!A0", "bob.lrp", SLOW, as_given=True),
        Submission("Carl \x01", "carl.lrp", None, "`carl.lrp` cannot be read."),
    ]
    return grade_class(submissions, FIRST, 2)


def test_the_table_of_marks_has_a_row_for_each_submission(marks):
    text = marks.csv()
    assert text.startswith("\ufeffstudent,")
    ada, bob, carl = csv.DictReader(io.StringIO(text.removeprefix("\ufeff")))
    assert (ada["points"], ada["out_of"], ada["passed"], ada["runs_passed"]) == ("10", "10", "yes", "2")
    assert (ada["first_reason"], ada["first_hint"]) == ("", "")
    assert [each["as_given"] for each in (ada, bob, carl)] == ["no", "yes", "no"]
    assert 0 < float(bob["points"]) < 10
    assert bob["first_reason"].startswith("gets 30 cm away from its start")
    assert (carl["points"], carl["runs"], carl["first_reason"]) == (
        "0.0",
        "2",
        "`carl.lrp` cannot be read.",
    )


def test_a_name_that_would_be_a_formula_is_a_text_in_a_spreadsheet(marks):
    assert "\n'=cmd" in marks.csv().replace("\r", "")
    assert csv_text(["a"], [[-1.5], ["-1.5"]]).split() == ["\ufeffa", "-1.5", "'-1.5"]


def test_the_json_of_marks_has_every_run(marks):
    data = json.loads(as_json(marks))
    attempts = data["submissions"][0]["attempts"]
    assert [Attempt.from_dict({k: v for k, v in each.items() if k != "passed"}) for each in attempts] == list(
        marks.marks[0].grade.attempts
    )


def test_the_junit_file_has_a_test_for_each_run(marks):
    root = ElementTree.fromstring(marks.junit())
    suites = [{key: suite.get(key) for key in ("tests", "failures", "errors")} for suite in root]
    assert suites == [
        {"tests": "2", "failures": "0", "errors": "0"},
        {"tests": "2", "failures": "2", "errors": "0"},
        {"tests": "1", "failures": "0", "errors": "1"},
    ]
    assert "it was at most 20 cm away" in root[1][0][0].get("message")
