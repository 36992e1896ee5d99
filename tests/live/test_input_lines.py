"""Every input of a recording is read as it was written."""

import json

import pytest

from lrp_jupyter.bridges.interventions import (
    CommandsHeld,
    MembersChanged,
    RobotArmed,
    RobotCommanded,
    RobotStopped,
    WorldLoaded,
)
from lrp_jupyter.language.half_typed import Unmeant
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Element
from lrp_jupyter.live.running import commands as do
from lrp_jupyter.live.running.inputs import EndRun
from lrp_jupyter.live.running.notebook_names import ChangeNames
from lrp_jupyter.live.session import Session
from lrp_jupyter.live.stored.input_lines import INPUTS, input_line, input_of
from lrp_jupyter.sim.world_edits import Become, Draw, SetStart
from lrp_jupyter.sim.world_inputs import PlaceRobot, PlaceSolid, ResetWorld
from lrp_jupyter.sim.worlds import load

PROGRAM = parse("(machine m (state a)) (spawn m a)")
WAITS = Unmeant(parse("(machine m)"), "waits: the state has no name yet", True, Element("state", ("m", "a")))
EXAMPLES = [
    do.Pause("The robot stands at a wall."),
    do.Resume(),
    EndRun(),
    do.ReplaceProgram(PROGRAM),
    do.ReplaceProgram(PROGRAM, WAITS),
    do.Rename("state", ("m", "a"), "b"),
    do.Force(("m", "a")),
    do.Force(("m", "a"), teleport=True),
    do.Fire(("m", "t")),
    do.SetVariable(("m", "n"), "n + 1"),
    do.Assign(("m", "n"), {"far": (1, [2.5, None]), "never": float("inf")}),
    ChangeNames({"old": None}, {"new": [1], "limit": 0.5}),
    do.Rewind(3),
    do.Reset(),
    do.EndProgram(),
    do.Renew(PROGRAM),
    do.SetRate(12.5),
    do.SetPolicy("on_issue", "pause"),
    do.ClearIssues(),
    RobotStopped(),
    RobotArmed(True),
    CommandsHeld(2, lost="The robot does not answer."),
    MembersChanged(({"name": "light", "kind": "variable", "unit": "", "doc": ""},)),
    RobotCommanded("move", {"linear": 0.5, "way": (1, 2)}),
    WorldLoaded(load("line").to_dict()),
    PlaceRobot((0.5, 1.0, 0.0), 1),
    PlaceSolid((0.5, 1.0, 0.0), 2),
    ResetWorld(),
    Draw(((0.5, 1.0), (1.0, 1.0)), 0.03, None),
    Become(load("line")),
]


@pytest.fixture(scope="module")
def loop():
    with Session("", "sim", world="line") as session:
        yield session._loop


@pytest.mark.parametrize("what", EXAMPLES, ids=lambda what: type(what).__name__)
def test_an_input_is_read_as_it_was_written(loop, what):
    line = json.loads(json.dumps(input_line(what, loop)))
    assert repr(input_of(line, parse)) == repr(what)


def test_there_is_an_example_of_every_input():
    assert {type(what) for what in EXAMPLES} == set(INPUTS.values())


def test_an_edit_of_the_world_is_written_as_the_world_that_it_led_to(loop):
    line = input_line(SetStart((0.5, 0.5, 0.0)), loop)
    assert line == {"input": "edit world", "world": loop.bridge.simulated.world_form()}


def test_an_input_that_no_file_can_hold_is_beyond(loop):
    assert input_line(do.Assign(("n",), object), loop)["input"] == "beyond"
    assert input_line(do.Call(print), loop)["input"] == "beyond"
