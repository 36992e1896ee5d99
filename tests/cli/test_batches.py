"""``lrp grade`` with the programs of a class."""

import csv
import json
import subprocess
import sys
from pathlib import Path

import pytest

from lrp_jupyter.cli.batches import parse_axes

DRIVE = "(machine m (state driving (running [robot.move(linear=0.2)]))) (spawn m driving)"
CRASH = DRIVE.replace("robot.move(linear=0.2)", "import os; os.abort()")


@pytest.fixture
def group(tmp_path):
    folder = tmp_path / "group"
    folder.mkdir()
    (folder / "ada.lrp").write_text(DRIVE)
    (folder / "bob.lrp").write_text(CRASH)
    (folder / "carl.lrp").write_bytes(b"\0")
    return folder


@pytest.mark.slow
def test_a_class_is_graded_into_files_and_listed(lrp, group, tmp_path, monkeypatch):
    monkeypatch.setattr("lrp_jupyter.grading.grade._starters", [])
    out = [tmp_path / f"marks.{suffix}" for suffix in ("csv", "json", "xml")]
    options = [word for path in out for word in ("--out", path)]
    result = lrp("grade", group, "--challenge", "first move", "--seeds", "2", *options)
    assert result.exit_code == 0
    with out[0].open(encoding="utf-8-sig", newline="") as file:
        assert [row["points"] for row in csv.DictReader(file)] == ["10", "0.0", "0.0"]
    assert len(json.loads(out[1].read_text("utf-8"))["submissions"]) == 3
    assert out[2].read_text("utf-8").startswith("<?xml")
    rows = [line.split() for line in result.stdout.splitlines()]
    assert rows[1][:4] == ["ada", "10", "of", "10"]
    assert "first move: 1 of 3 passed; 3.3 of 10 points on average" in result.stdout
    assert "grading: 6 of 6 runs" in result.stderr


@pytest.mark.slow
def test_a_class_with_several_challenges_is_a_table_and_goes_into_pages_and_a_gradebook(lrp, tmp_path):
    folder = tmp_path / "class"
    folder.mkdir()
    (folder / "Ada Lovelace.lrp").write_text(f"; challenge: first move\n{DRIVE}")
    (folder / "Bob.lrp").write_text(f"; challenge: lamp\n{DRIVE}")
    (folder / "Carl.pdf").write_bytes(b"%PDF")
    book = folder / "Grades.csv"  # in the folder of the class, as what is written
    book.write_text("Identifier;Full name;Grade;Maximum Grade\nParticipant 1;Ada Lovelace;;20,00\n")
    where = {"--table": "points.csv", "--feedback": "pages", "--out": "marks.html"}
    options = [word for option, name in where.items() for word in (option, folder / name)]
    command = ("grade", folder, "--seeds", "1", "--gradebook", book, "--separator", ";", *options)
    lrp(*command)
    result = lrp(*command)  # what was written is no submission
    assert result.exit_code == 0, result.output
    rows = [line.split() for line in result.stdout.splitlines()]
    assert rows[0] == ["student", "first", "move", "lamp", "points", "notes"]
    assert rows[1] == ["Ada", "Lovelace", "10", "10", "of", "20"]
    assert rows[3][:5] == ["Carl", "0", "of", "20", "`Carl.pdf`"]
    assert "\nNot graded: Carl\n" in result.stdout
    assert f"written: {folder / 'Grades-marked.csv'}, rows with points: 1" in result.stdout
    assert "No row was found for Bob, Carl." in " ".join(result.stdout.split())
    assert "Participant 1;Ada Lovelace;10,0;20,00" in (folder / "Grades-marked.csv").read_text()
    assert (
        (folder / "points.csv").read_text("utf-8-sig").startswith("student;first move;lamp;points;out_of\n")
    )
    assert sorted(path.name for path in (folder / "pages").iterdir()) == [
        "Ada Lovelace.html",
        "Bob.html",
        "Carl.html",
    ]


@pytest.mark.slow
def test_several_files_are_a_class_and_one_file_is_explained(lrp, group, tmp_path):
    result = lrp("grade", group / "ada.lrp", group / "bob.lrp", "--challenge", "first move")
    assert (result.exit_code, "1 of 2 passed" in result.stdout) == (0, True)
    result = lrp("grade", group / "bob.lrp", "--challenge", "first move", "--out", tmp_path / "a.json")
    assert (result.exit_code, "runs to its end: The program crashed" in result.stdout) == (1, True)
    assert json.loads((tmp_path / "a.json").read_text("utf-8"))["submissions"][0]["student"] == "bob"


def test_one_file_that_cannot_be_read_is_a_sentence(lrp, group):
    result = lrp("grade", group / "carl.lrp", "--challenge", "first move")
    assert result.exit_code == 2
    assert result.stderr.startswith("lrp: `")
    assert "is not a text" in result.stderr


def test_one_file_in_another_encoding_is_graded_in_the_challenge_that_it_names_and_a_guess_is_told(
    lrp, group
):
    (group / "dora.lrp").write_bytes(f"; für später\n; challenge: first move\n{DRIVE}".encode("cp1252"))
    result = lrp("grade", group / "dora.lrp", "--seeds", "1")
    assert (result.exit_code, "first move: passed" in result.stdout) == (0, True)
    assert "Note: `dora.lrp` is not UTF-8 and was read as Windows-1252" in result.stdout


@pytest.mark.parametrize(
    ("out", "words"),
    [
        ("marks.xls", "the name must end with `.csv`, `.json`, `.xml` or `.html`."),
        ("nowhere/marks.csv", "there is no such folder. Create it first."),
    ],
)
def test_a_file_that_could_not_be_written_is_refused_before_anything_runs(lrp, group, tmp_path, out, words):
    result = lrp("grade", group, "--challenge", "first move", "--out", tmp_path / out)
    assert (result.exit_code, result.stdout) == (2, "")
    assert words in result.stderr


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (
            ["--feedback", "nowhere/pages"],
            "`nowhere/pages` cannot be written: there is no such folder around it.",
        ),
        (["--gradebook", "nowhere.csv"], "`nowhere.csv` is not a file. Name the table that you downloaded."),
        (["--table", "table.json"], "the name must end with `.csv`."),
        (["--separator", "ab"], "--separator takes one character"),
    ],
)
def test_a_wrong_option_for_a_class_is_a_sentence_before_anything_runs(lrp, group, here, options, words):
    result = lrp("grade", group, "--challenge", "first move", *options)
    assert (result.exit_code, result.stdout) == (2, "")
    assert words in " ".join(result.stderr.replace("│", " ").split())


@pytest.mark.slow
def test_an_unreachable_cluster_is_a_sentence(lrp, group):
    result = lrp("grade", group, "--challenge", "first move", "--scheduler", "nonsense://here")
    assert result.exit_code == 2
    assert "There is no Dask scheduler at `nonsense://here`" in result.stderr


# -- lrp sweep -------------------------------------------------------------------------------------

SWEPT = "(var v := [0.1]) (machine m (state a (running [robot.move(linear=v)]))) (spawn m a)"


def test_a_sweep_prints_a_table_and_writes_files(lrp, program, tmp_path):
    files = [tmp_path / name for name in ("table.csv", "all.json", "map.svg")]
    options = ["--out", files[0], "--out", files[1], "--map", files[2]]
    result = lrp(
        "sweep",
        program(SWEPT),
        "--set",
        "v=0.02:0.2:4",
        "--challenge",
        "first move",
        "--seeds",
        "1",
        *options,
    )
    assert result.exit_code == 0
    rows = [line.split() for line in result.stdout.splitlines()]
    assert [row[0] for row in rows[1:5]] == ["0.02", "0.08", "0.14", "0.2"]
    assert "Fastest: v = 0.2 (1 of 1 runs passed" in result.stdout
    with files[0].open(encoding="utf-8-sig", newline="") as file:
        assert [row["passed"] for row in csv.DictReader(file)] == ["0", "1", "1", "1"]
    assert len(json.loads(files[1].read_text("utf-8"))["points"]) == 4
    assert files[2].read_text("utf-8").startswith("<svg")


def test_a_sweep_shows_what_is_wrong_with_a_text_that_is_not_a_program(lrp, program):
    result = lrp("sweep", program("(var v := [1]"), "--set", "v=1,2", "--challenge", "first move")
    assert result.exit_code == 1
    assert "my.lrp:1:1: error LRP101" in result.stderr


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--set", "w=1,2"], "`w` cannot be swept: There is no variable `w`. There is only `v`."),
        (["--set", "v=1:2"], "takes FROM:TO:COUNT"),
        (["--set", "v=1:2:1"], "a count of 2 to 1,000"),
        (["--set", "v=1:inf:3"], "takes FROM:TO:COUNT"),
        (["--set", "v=fast"], "takes numbers, or texts in quotation marks"),
        (["--set", "v"], "--set takes NAME=VALUE"),
        (["--set", "v=1", "--set", "v=2"], "is given twice"),
        (
            ["--set", "a=1", "--set", "b=1", "--set", "c=1", "--map", "m.svg"],
            "--map draws one or two variables",
        ),
        (["--set", "v=1", "--map", "m.png"], "the name must end with `.svg`."),
        (["--set", "v=1", "--out", "m.txt"], "the name must end with `.csv` or `.json`."),
    ],
)
def test_a_wrong_option_of_a_sweep_is_a_sentence(lrp, program, options, words):
    result = lrp("sweep", program(SWEPT), "--challenge", "first move", *options)
    assert result.exit_code == 2
    assert words in " ".join(result.stderr.replace("│", " ").split())


def test_values_of_a_sweep_are_steps_without_rounding_noise_or_a_list():
    assert parse_axes(["v=0.4:1.2:9"]) == {"v": (0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2)}
    assert parse_axes(["m/a/v=1, 2.5", "w='a'"]) == {"m/a/v": (1, 2.5), "w": ("a",)}


def test_fewer_seeds_than_the_challenge_has_are_remarked(lrp, group):
    arguments = ("grade", group / "ada.lrp", "--challenge", "first move", "--seeds")
    assert "with 1 a program may pass by luck" in lrp(*arguments, "1").stdout
    assert "luck" not in lrp(*arguments, "3").stdout


@pytest.mark.parametrize("command", [["grade"], ["sweep", "--set", "v=1,2"]], ids=["grade", "sweep"])
def test_a_file_of_python_code_is_a_challenge_only_if_the_command_names_it(lrp, program, here, command):
    Path("evil.py").write_text("open('ran', 'w').close()")
    name = program("; Waits.\n; challenge: evil.py\n(var v := [0]) (machine m (state a)) (spawn m a)").name
    refused = lrp(*command, name)
    assert (refused.exit_code, Path("ran").exists()) == (2, False)
    assert refused.stderr.startswith(f"lrp: `{name}`, line 2: There is no challenge `evil.py`.")
    assert refused.stderr.endswith("; only `--challenge` chooses a file.\n")
    lrp(*command, name, "--challenge", "evil.py")
    assert Path("ran").exists()


@pytest.mark.slow
def test_no_module_of_the_folder_that_is_graded_is_imported(group):
    """A student's, or the teacher's own: by the command `lrp`, which does not look there itself."""
    for name in ("random", "json", "sitecustomize", "usercustomize", "lrp_jupyter"):
        (group / f"{name}.py").write_text("open('ran', 'w').close()")
    command = [sys.executable, "-P", "-c", "from lrp_jupyter.cli import main; main()", "grade", "."]
    command += ["--challenge", "first move", "--seeds", "1"]
    graded = subprocess.run(command, cwd=group, capture_output=True, text=True, check=False)
    assert (graded.returncode, (group / "ran").exists()) == (0, False)
    listed = graded.stdout.split()
    assert listed[listed.index("ada") + 1] == "10"
