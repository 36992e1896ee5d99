"""Completion of values, as a shell asks for it."""

import os
import subprocess
import sys

import pytest

from lrp_jupyter import programs
from lrp_jupyter.grading.challenges import BUNDLED, EXERCISES


def asked(words: str) -> dict[str, str]:
    """Return how a shell asks for what follows some words."""
    return {"_LRP_COMPLETE": "complete_bash", "COMP_WORDS": words, "COMP_CWORD": str(words.count(" "))}


@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        ("lrp run foll", {"follower", "follower-paper"}),
        ("lrp check my", set()),
        ("lrp check follower --bridge sim", {"sim"}),
        ("lrp check mi", {"mine.lrp"}),
        ("lrp guard --backend m", {"mqtt"}),
        ("lrp guard --backend rosp", {"rospy"}),
        ("lrp graph fold", {"folder/"}),
        ("lrp run follower --world o", {"oval", "other.json"}),
        ("lrp run follower --bridge sim", {"sim"}),
        ("lrp run follower --until mo", {"moving"}),
        ("lrp run mine.lrp --set ", {"n=", "k="}),
        ("lrp graph follower --machine follower/", {"follower/looking/lookalgo"}),
        ("lrp grade follower --challenge follow", {"follow the line"}),
        ("lrp grade follower --challenge ", {each.name for each in BUNDLED}),
        (
            "lrp grade follower --challenge exe",
            {each.name for each in EXERCISES if each.name.startswith("exe")},
        ),
        ("lrp programs --show esc", {"escapement"}),
        ("lrp worlds --json ma", {"maze"}),
        ("lrp run follower --noise m", {"motor="}),
        ("lrp explain LRP30", {f"LRP30{n}" for n in range(1, 10)}),
        ("lrp run follower --speed m", {"max"}),
        ("lrp run follower --on-active-edit k", {"keep"}),
        ("lrp run missing --until ", set()),
    ],
)
def test_a_value_is_completed(lrp, here, words, wanted):
    (here / "mine.lrp").write_text("(var n := [1]) (machine m (var k := [2]) (state a)) (spawn m a)")
    (here / "other.json").write_text("{}")
    (here / "folder").mkdir()
    assert set(filter(None, lrp(env=asked(words)).stdout.splitlines())) == wanted


def test_the_command_itself_completes_the_bundled_programs():
    command = [sys.executable, "-c", "from lrp_jupyter.cli import main; main()"]
    environment = os.environ | asked("lrp programs --show ")
    run = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert set(run.stdout.split()) == set(programs.names())
