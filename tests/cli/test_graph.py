import json
import xml.etree.ElementTree as ET

import pytest


def test_a_picture_of_all_machines_goes_to_stdout(lrp):
    result = lrp("graph", "follower")
    root = ET.fromstring(result.stdout)
    machines = [g.get("data-lrp-machine") for g in root.iter("{http://www.w3.org/2000/svg}g")]
    assert [name for name in machines if name] == ["follower", "follower/looking/lookalgo"]


def test_one_machine_is_drawn_by_its_path(lrp):
    result = lrp("graph", "follower", "--machine", "follower/looking/lookalgo")
    assert "lookleft" in result.stdout
    assert "bumpback" not in result.stdout


@pytest.mark.parametrize(
    ("name", "begins"),
    [("g.dot", "digraph"), ("g.gv", "digraph"), ("g.mmd", "stateDiagram-v2"), ("g.svg", "<svg")],
)
def test_the_name_of_the_output_determines_the_format(lrp, tmp_path, name, begins):
    result = lrp("graph", "stopwatch", "-o", tmp_path / name)
    assert (result.exit_code, result.stdout) == (0, "")
    assert (tmp_path / name).read_text(encoding="utf-8").startswith(begins)


@pytest.mark.parametrize("form", ["dot", "mermaid"])
def test_one_machine_is_written_for_other_tools_too(lrp, form):
    text = lrp("graph", "stopwatch", "--machine", "finger", "--format", form).stdout
    assert "pressing" in text
    assert "counting" not in text


def test_json_is_the_layout_that_the_notebook_draws(lrp):
    drawings = json.loads(lrp("graph", "follower", "--format", "json").stdout)
    assert [each["name"] for each in drawings] == ["follower", "lookalgo"]
    assert (
        json.loads(lrp("graph", "follower", "--format", "json", "--machine", "follower").stdout)
        == drawings[0]
    )


def test_a_machine_that_does_not_exist_is_a_sentence(lrp):
    result = lrp("graph", "follower", "--machine", "folower")
    assert result.exit_code == 2
    assert result.stderr.startswith("lrp: ")
    assert "`follower`" in result.stderr


def test_a_text_that_is_not_a_program_is_not_drawn(lrp, program):
    result = lrp("graph", program("(machine m"))
    assert result.exit_code == 1
    assert "LRP101" in result.stderr


def test_an_output_that_cannot_be_written_is_a_sentence(lrp, tmp_path):
    result = lrp("graph", "follower", "-o", tmp_path / "no" / "g.svg")
    assert result.exit_code == 2
    assert (
        result.stderr == f"lrp: `{tmp_path / 'no' / 'g.svg'}` cannot be written: No such file or directory.\n"
    )


def test_a_format_that_cannot_be_drawn_is_refused(lrp, tmp_path):
    result = lrp("graph", "stopwatch", "-o", tmp_path / "picture.png")
    assert (result.exit_code, result.stderr) == (
        2,
        "lrp: A graph cannot be written as `.png`. Name the file `picture.svg`, `.dot`, `.mmd` or `.json`,"
        " or choose a `--format`.\n",
    )
    assert not (tmp_path / "picture.png").exists()
    assert lrp("graph", "stopwatch", "-o", tmp_path / "picture.txt", "--format", "dot").exit_code == 0
    assert lrp("graph", "stopwatch", "-o", tmp_path / "picture").exit_code == 0
    assert (tmp_path / "picture").read_text().startswith("<svg")
