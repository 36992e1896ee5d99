"""The walks of CONTRIBUTING are those of the program: every function named is called, in that order."""

import re
from collections import defaultdict
from collections.abc import Callable
from itertools import dropwhile
from pathlib import Path

import pytest
from support.tables import every
from support.trace import Call, traced
from support.waiting import until

from lrp_jupyter import Lab
from lrp_jupyter.widgets import registry
from lrp_jupyter.widgets.changes import difference
from lrp_jupyter.widgets.plain import packed, unpacked

TEXT = (Path(__file__).parents[1] / ".github" / "CONTRIBUTING.md").read_text(encoding="utf-8")
TOUR = dict(
    part.split("\n", 1)
    for part in TEXT.split("\n## A contributor's tour\n")[1].split("\n## ")[0].split("\n### ")[1:]
)
PROGRAM = """
(machine m
  (event dark [robot.light.data < 300])
  (state a)
  (state b (running [fail]))
  (on dark a -> b))
(spawn m a)
"""


def legs(walk: str) -> list[list[str]]:
    """The functions of the kernel in a walk, each with its module if it is named, thread by thread."""
    found: list[list[str]] = [[]]
    for row in re.findall(r"^\|(.*?)\|.*\|$", TOUR[walk], re.MULTILINE)[2:]:
        names = re.findall("`(.*?)`", row)
        if not names:  # a rule
            found.append([])
        found[-1] += names
    return [leg for leg in found if leg and ".ts: " not in "".join(leg)]


def is_named(call: Call, name: str) -> bool:
    path, function = name.split(": ") if ": " in name else ("", name)
    return call.path.endswith(path) and f".{call.function}".endswith(f".{function}")


def after(leg: list[str], calls: list[Call]) -> list[str]:
    """The functions of a leg from the first one that is not called after those before it."""
    rest = iter(calls)
    return list(dropwhile(lambda name: any(is_named(call, name) for call in rest), leg))


@pytest.fixture(scope="module")
def steps(tmp_path_factory) -> list[dict[int, list[Call]]]:
    """The calls by thread while a letter is typed, and while a transition fires into a block that fails."""
    with pytest.MonkeyPatch.context() as patch, traced() as calls:
        patch.chdir(tmp_path_factory.mktemp("lab"))
        lab = Lab(PROGRAM, bridge="sim", namespace={})
        lab.session.pause()

        def calls_of(act: Callable[[], object]) -> dict[int, list[Call]]:
            """The calls until the view was sent a frame that differs."""
            mark, threads = len(calls), defaultdict(list)
            act()
            until(lambda: after(["difference", "View.send"], calls[mark:]) == [])
            for call in calls[mark:]:
                threads[call.thread].append(call)
            return threads

        def page(**message: object) -> None:
            lab._handle_custom_msg({"json": packed({"view": "v", **message})}, [])

        def hear(content: dict[str, str], _: object) -> None:
            message = unpacked(content)
            if message["type"] == "frame":
                page(type="credit", frame=message["frame"])

        patch.setattr(lab, "send", hear)
        page(type="hello", part="lab")
        until(lambda: after(["View.send"], calls) == [])
        revision = lab._connection.texts.revision
        typed = difference(PROGRAM, PROGRAM.replace("(state a)", "(state a) (state c)")).json()
        steps = [
            calls_of(lambda: page(type="text", seq=1, base=revision, updates=[typed])),
            calls_of(lab.session.step),
        ]
        for connection in list(registry.running()):
            registry.forget(connection)
    return steps


@every("walk", TOUR)
def test_a_walk_is_the_way_of_the_program(walk, steps):
    threads = steps[walk != "A keystroke changes the graph"].values()
    for leg in legs(walk):
        assert min((after(leg, calls) for calls in threads), key=len) == []
