"""The exceptions of the package travel by pickle and by copy, and tell what can have been meant."""

import copy
import pickle
from collections.abc import Iterator

import pytest
from support.tables import every

import lrp_jupyter.bridges.ev3
import lrp_jupyter.bridges.ros
import lrp_jupyter.cli
import lrp_jupyter.widgets.lab  # noqa: F401  (with the others, it defines every exception of the package)
from lrp_jupyter import Session
from lrp_jupyter.errors import (
    Edit,
    Finding,
    Fix,
    LRPError,
    LRPSyntaxError,
    UnknownElementError,
    did_you_mean,
)
from lrp_jupyter.graph.state_graph import find_machine
from lrp_jupyter.language.edits import drawing
from lrp_jupyter.language.edits.initials import with_initial
from lrp_jupyter.language.edits.rename import rename

FIX = Fix("Close it", (Edit(8, 8, ")"),))
FINDINGS = (
    Finding("LRP101", "error", "It is not closed.", 1, 1, 1, 9, FIX),
    Finding("LRP401", "hint", "Unused.", 2, 1, 2, 9),
)


def kinds(base: type[LRPError] = LRPError) -> Iterator[type[LRPError]]:
    yield base
    for kind in base.__subclasses__():
        yield from kinds(kind)


@every("travel", [lambda error: pickle.loads(pickle.dumps(error)), copy.copy, copy.deepcopy])
@every("kind", list(kinds()))
def test_an_exception_survives_pickle_and_copy_with_its_fields(kind, travel):
    error = kind(FINDINGS if kind is LRPSyntaxError else "There is no state `a`.")
    if kind is UnknownElementError:
        error = kind("There is no state `a`.", ("m/b", "n/b"))
    arrived = travel(error)
    assert type(arrived) is kind
    assert str(arrived) == str(error)
    assert arrived.args == error.args
    assert vars(arrived) == vars(error)


def test_the_message_of_a_syntax_error_lists_its_findings():
    assert str(LRPSyntaxError(FINDINGS)) == (
        "1:1: LRP101 error: It is not closed.\n2:1: LRP401 hint: Unused."
    )


@every(
    ("name", "known", "meant"),
    [
        ("ligth", ["name", "light"], " Did you mean `light`?"),
        ("bmup", ["bump"], " Did you mean `bump`?"),
        ("GO", ["to", "go"], " Did you mean `go`?"),
        ("move", ["name", "beep"], ""),
        ("bump", ["bump"], ""),
        ("light", ["light", "lights"], " Did you mean `lights`?"),
        ("world", ["rate", "on_issue"], ""),
    ],
)
def test_only_a_close_name_is_suggested(name, known, meant):
    assert did_you_mean(name, known) == meant


TWINS = "".join(
    f"""(machine {name} (var speed := [1]) (event bump [False]) (state driving) (state turning)
        (eps driving -> turning turned))"""
    for name in ("left", "right")
)
PROGRAM = f"(var goal := [2]) {TWINS} (spawn left driving) (spawn right driving)"


@pytest.mark.parametrize(
    ("ask", "candidates"),
    [
        (lambda s: s.why("driving"), ("left/driving", "right/driving")),
        (lambda s: s.why("drivin"), ("driving",)),
        (lambda s: s.why_not("turned"), ("left/turned", "right/turned")),
        (lambda s: s.why_not("turnd"), ("turned",)),
        (lambda s: s.why_not("driving"), ()),
        (lambda s: s.why("robot.stopp"), ("stop",)),
        (lambda s: s.pause_when("driving"), ("left/driving", "right/driving")),
        (lambda s: s.pause_when(fires="turnd"), ("turned",)),
        (lambda s: s.pause_when(fires="driving"), ()),
        (lambda s: s.run(1, until="drivin"), ("driving",)),
        (lambda s: s.variables["speed"], ("left/speed", "right/speed")),
        (lambda s: s.set_variable("gaol", 1), ("goal",)),
        (lambda s: s.set_variable("x" * 9, 1), ()),
        (lambda s: s.plots(["gaol"])[0], ("goal",)),
        (lambda s: s.rename("state", "left/drivin", "x"), ("left/driving",)),
        (lambda s: s.fire("turned"), ("left/turned", "right/turned")),
        (lambda s: s.fire("turnd"), ("turned",)),
        (lambda s: s.fire("driving"), ()),
        (lambda s: s.interpreter.fire("left/turnd"), ("left/turned",)),
        (lambda s: s.interpreter.teleport_to("left/drivin"), ("left/driving",)),
        (lambda s: find_machine(s.program, ["lefft"]), ("left",)),
        (lambda s: with_initial(s.text, ("speed",), "1"), ("left/speed", "right/speed")),
        (lambda s: with_initial(s.text, ("gaol",), "1"), ("goal",)),
        (lambda s: rename(s.program, "event", ("left", "bmup"), "x"), ("left/bump",)),
        (lambda s: drawing.new_state(s.text, ("lefft",), "x"), ("left",)),
        (lambda s: drawing.new_transition(s.text, ("left",), "drivin", "turning", ""), ("left/driving",)),
        (lambda s: drawing.retarget(s.text, ("left", "turned"), "source", "drivin"), ("driving",)),
        (lambda s: drawing.retarget(s.text, ("left", "turnd"), "source", "driving"), ("left/turned",)),
    ],
)
def test_an_unknown_element_tells_what_can_have_been_meant(ask, candidates):
    with Session(PROGRAM, "sim") as session:
        session.run(0.3)
        with pytest.raises(UnknownElementError) as raised:
            ask(session)
    assert raised.value.candidates == candidates
    assert all(f"`{each}`" in str(raised.value) for each in candidates)
