"""The challenges of the notebooks answer every typical error with its hint."""

from __future__ import annotations

from dataclasses import replace

import pytest
from e2e.programs import HELLO
from prose import solution
from stored import NOTEBOOKS, read

from lrp_jupyter import grade
from lrp_jupyter.grading.challenges import challenge as challenge_called
from lrp_jupyter.programs import load

CAREFUL = """
(machine careful
  (event bump [robot.bumper.data == 1])
  (state driving (running [robot.move(linear=0.2)]))
  (state stopped)
  (on bump driving -> stopped))
(spawn careful driving)
"""
SQUARE = """
(machine square
  (var corners := [0])
  (state side (running [robot.move(linear=0.2)]))
  (state corner (running [robot.move(angular=1.0)]) (onexit [corners += 1]))
  (state done (onentry [robot.stop()]))
  (on [corners == 4] side -> done)
  (ontime 3000 side -> corner)
  (ontime 1571 corner -> side))
(spawn square side)
"""
STOPPER = """
(var forward := [0.25])
(machine stopper
  (event online [robot.light.data < 128])
  (state driving (running [robot.move(linear=forward)]))
  (state stopped (onentry [robot.stop()]))
  (on online driving -> stopped))
(spawn stopper driving)
"""

MISTAKES = [
    ("edit it live", [HELLO, HELLO.replace("linear=forward", "linear=0.1")], "its `running` changed"),
    ("edit it live", [HELLO, HELLO.replace("driver left)", "driver left")], "Correct the text first"),
    ("bump and stay", CAREFUL.replace("(on bump driving -> stopped)", ""), "kept pushing"),
    (
        "bump and stay",
        CAREFUL.replace("bumper.data == 1", "distance.data"),
        "A condition must be True or False",
    ),
    ("bump and stay", CAREFUL.replace("(spawn careful driving)", ""), "Nothing was active"),
    ("bump and stay", CAREFUL.replace("robot.move(linear=0.2)", ""), "never received a command"),
    ("bump and stay", CAREFUL.replace("(state stopped)", "(state stopped"), "Correct the text first"),
    ("square", SQUARE.replace("1571", "15"), "straight on and turned 0°"),
    ("square", SQUARE.replace("(var corners := [0])", ""), "corners"),
    ("stop at the line", STOPPER.replace("0.25", "0.45"), "never saw the line"),
    ("stop at the line", STOPPER.replace("< 128", "> 128"), "stopped at once"),
    ("stop at the line", STOPPER.replace("light.data", "ligth.data"), "Did you mean `light`?"),
    ("stop at the line", STOPPER.replace("(on online driving -> stopped)", ""), "drove on"),
]


@pytest.mark.parametrize(("challenge", "program", "words"), MISTAKES)
def test_a_typical_mistake_gets_its_hint(challenge: str, program: str | list[str], words: str):
    result = grade(program, challenge)
    assert not result
    assert words in result.hint


@pytest.mark.parametrize(
    ("challenge", "program"),
    [
        ("edit it live", [HELLO, HELLO.replace("[0.2]", "[0.1]")]),
        ("bump and stay", CAREFUL),
        ("square", SQUARE),
        ("stop at the line", STOPPER),
    ],
)
def test_without_the_mistake_it_passes(challenge: str, program: str | list[str]):
    assert grade(program, challenge)


def test_the_lap_in_30_seconds_does_not_depend_on_one_noise():
    """The solution of notebook 08 is not one that luck has found."""
    hidden = solution(read(NOTEBOOKS / "08-playing-with-time.ipynb"))
    assert hidden is not None
    names = {"follower": load("follower")}
    exec(hidden[1], names)
    lap = replace(challenge_called("there and back"), name="a lap in 30 s", seconds=32, hints=())
    assert grade(names["mine"], lap, seeds=5)
