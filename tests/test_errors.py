"""The exceptions of the package travel by pickle and by copy; only close names are suggested."""

import copy
import pickle
from collections.abc import Iterator

import pytest

import lrp_jupyter.bridges.ev3
import lrp_jupyter.bridges.ros
import lrp_jupyter.cli
import lrp_jupyter.widgets.lab  # noqa: F401  (with the others, it defines every exception of the package)
from lrp_jupyter.errors import Edit, Finding, Fix, LRPError, LRPSyntaxError, did_you_mean

FIX = Fix("Close it", (Edit(8, 8, ")"),))
FINDINGS = (
    Finding("LRP101", "error", "It is not closed.", 1, 1, 1, 9, FIX),
    Finding("LRP401", "hint", "Unused.", 2, 1, 2, 9),
)


def kinds(base: type[LRPError] = LRPError) -> Iterator[type[LRPError]]:
    yield base
    for kind in base.__subclasses__():
        yield from kinds(kind)


@pytest.mark.parametrize(
    "travel", [lambda error: pickle.loads(pickle.dumps(error)), copy.copy, copy.deepcopy]
)
@pytest.mark.parametrize("kind", list(kinds()), ids=lambda kind: kind.__name__)
def test_an_exception_survives_pickle_and_copy_with_its_fields(kind, travel):
    error = kind(FINDINGS if kind is LRPSyntaxError else "There is no state `a`.")
    arrived = travel(error)
    assert type(arrived) is kind
    assert str(arrived) == str(error)
    assert arrived.args == error.args
    assert vars(arrived) == vars(error)


def test_the_message_of_a_syntax_error_lists_its_findings():
    assert str(LRPSyntaxError(FINDINGS)) == (
        "1:1: LRP101 error: It is not closed.\n2:1: LRP401 hint: Unused."
    )


@pytest.mark.parametrize(
    ("name", "known", "meant"),
    [
        ("ligth", ["name", "light"], " Did you mean `light`?"),
        ("bmup", ["bump"], " Did you mean `bump`?"),
        ("GO", ["to", "go"], " Did you mean `go`?"),
        ("move", ["name", "beep"], ""),
        ("world", ["rate", "on_issue"], ""),
    ],
)
def test_only_a_close_name_is_suggested(name, known, meant):
    assert did_you_mean(name, known) == meant
