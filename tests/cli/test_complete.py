"""Completion of values, as a shell asks for it."""

import os
import subprocess
import sys

import pytest

from lrp_jupyter import programs


def completed(words: str, cwd) -> list[str]:
    asked = {"_LRP_COMPLETE": "complete_bash", "COMP_WORDS": words, "COMP_CWORD": str(words.count(" "))}
    command = [sys.executable, "-c", "from lrp_jupyter.cli import main; main()"]
    run = subprocess.run(command, env={**os.environ, **asked}, cwd=cwd, capture_output=True, text=True)
    return run.stdout.split("\n")[:-1] if run.stdout.endswith("\n") else run.stdout.split("\n")


@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        ("lrp run foll", {"follower", "follower-paper"}),
        ("lrp check my", set()),
        ("lrp check follower --bridge s", {"sim"}),
        ("lrp check mi", {"mine.lrp"}),
        ("lrp guard --backend m", {"mqtt"}),
        ("lrp guard --backend rosp", {"rospy"}),
        ("lrp graph fold", {"folder/"}),
        ("lrp run follower --world o", {"oval", "other.json"}),
        ("lrp run follower --bridge s", {"sim"}),
        ("lrp run follower --until mo", {"moving"}),
        ("lrp run mine.lrp --set ", {"n=", "k="}),
        ("lrp graph follower --machine follower/", {"follower/looking/lookalgo"}),
        ("lrp grade follower --challenge follow", {"follow the line"}),
        ("lrp programs --show esc", {"escapement"}),
        ("lrp worlds --json ma", {"maze"}),
        ("lrp run follower --noise m", {"motor="}),
        ("lrp explain LRP30", {f"LRP30{n}" for n in range(1, 9)}),
        ("lrp run follower --speed m", {"max"}),
        ("lrp run missing --until ", set()),
    ],
)
def test_a_value_is_completed(words, wanted, tmp_path):
    (tmp_path / "mine.lrp").write_text("(var n := [1]) (machine m (var k := [2]) (state a)) (spawn m a)")
    (tmp_path / "other.json").write_text("{}")
    (tmp_path / "folder").mkdir()
    found = {word for word in completed(words, tmp_path) if word}
    assert found == wanted


def test_the_bundled_programs_are_completed(tmp_path):
    assert set(completed("lrp programs --show ", tmp_path)) - {""} == set(programs.names())
