"""``lrp test`` runs kept runs again: a line for each, an exit code, a file for a CI service."""

import gzip
import os
import shutil
from pathlib import Path
from xml.etree import ElementTree

import pytest
from runs.conftest import LAPS

from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.session import Session

HASTY = LAPS.replace("2000", "1900")


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    """The recording of a run of `LAPS`."""
    with Session(LAPS, "sim", VirtualClock(), world="line", name="laps") as session:
        session.run(3)
        return session.keep("one", tmp_path_factory.mktemp("kept") / "laps.runs")


@pytest.fixture
def beside(kept, tmp_path, program, monkeypatch):
    """The present folder: a program, and the folder of its runs."""
    monkeypatch.chdir(tmp_path)
    program(LAPS, "laps.lrp")
    program(LAPS, "empty.lrp")
    shutil.copytree(kept.parent, "laps.runs")
    Path("empty.runs").mkdir()
    return tmp_path


@pytest.mark.parametrize(
    ("text", "arguments", "code", "words"),
    [
        (LAPS, ["laps.lrp"], 0, ["✓ one (3.0 s, as recorded)\n1 of 1 run passed.\n"]),
        (LAPS, ["laps.lrp", "laps.runs/one.lrplog", "laps.runs"], 0, ["1 of 1 run passed.\n"]),
        (LAPS, ["-", "laps.runs"], 0, ["1 of 1 run passed.\n"]),
        (HASTY, ["laps.lrp"], 1, ["✗ one (3.0 s, as recorded): differs at 1.9 s: `aside` is", "0 of 1 run"]),
        (LAPS, ["laps.lrp", "laps.lrp"], 1, ["✗ laps.lrp (as recorded): ", "is not a recording"]),
        (LAPS, ["laps.lrp", "--coverage"], 0, ["Reached: 2 of 3 states", "Never entered: `laps/away`."]),
        ("(machine", ["laps.lrp"], 1, ["error LRP"]),
        (LAPS, ["-"], 2, ["No runs are kept beside the standard input. Name a folder of runs"]),
        (LAPS, ["empty.lrp"], 2, ["There is no recording in `empty.runs`."]),
        (LAPS, ["laps.lrp", "nowhere"], 2, ["`nowhere` does not exist."]),
        (LAPS, ["nothing.lrp", "laps.runs"], 2, ["`nothing.lrp` is neither"]),
        (LAPS, ["follower"], 2, ["there is no folder `follower.runs`"]),
    ],
)
def test_the_exit_code_and_the_lines_say_what_came_of_the_runs(beside, lrp, text, arguments, code, words):
    beside.joinpath("laps.lrp").write_text(text)
    result = lrp("test", *arguments, input=text)
    assert result.exit_code == code
    for each in words:
        assert each in result.output


def test_recordings_of_strangers_cost_the_others_nothing_and_are_named_in_print(beside, kept, lrp):
    data, folder = kept.read_bytes(), beside / "strange"
    folder.mkdir()
    for name, content in {
        "cut.lrplog": data[: len(data) // 2],
        "packed.lrplog.gz": gzip.compress(data),
        "unpacked.lrplog.gz": data,
        "empty.lrplog": b"",
        "later.lrplog": data.replace(b'"lrplog":3', b'"lrplog":4', 1),
        "two\nlines\x1b[31m.lrplog": data,
        os.fsdecode(b"half\xff.lrplog"): data,
    }.items():
        (folder / name).write_bytes(content)
    (folder / "away.lrplog").symlink_to("nowhere")
    (folder / "folder.lrplog").mkdir()
    result = lrp("test", "laps.lrp", "strange", "--junit", "out.xml")
    assert result.exit_code == 1
    passed = {line[2:].partition(" (")[0] for line in result.output.splitlines() if line[0] == "✓"}
    assert passed == {"cut", "packed", "two<U+000A>lines<U+001B>[31m", "half<U+DCFF>"}
    assert "4 of 9 runs passed.\n" in result.output
    suite = ElementTree.parse("out.xml").getroot()
    cases = suite.findall("testcase")
    assert (suite.tag, suite.get("tests"), suite.get("failures")) == ("testsuite", "9", "5")
    assert {case.get("name") for case in cases if case.find("failure") is None} == passed
    assert all(case.get("classname") == "laps.lrp" and float(case.get("time")) >= 0 for case in cases)


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"one = ", "cannot be read: Invalid value"),
        (b"one = 3", "what is expected of `one` must be a text in quotation marks."),
        (b"\xff", "is not valid UTF-8"),
    ],
)
def test_a_file_of_what_is_expected_that_cannot_be_read_ends_it_and_is_named(beside, lrp, content, reason):
    (beside / "laps.runs" / "expected.toml").write_bytes(content)
    result = lrp("test", "laps.lrp")
    assert (result.exit_code, "expected.toml" in result.output) == (2, True)
    assert reason in result.output
