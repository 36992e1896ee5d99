"""The walks of CONTRIBUTING are those of the program: every function named is called, in that order."""

import re
from collections import defaultdict
from itertools import dropwhile
from pathlib import Path

from support.trace import Call, traced
from support.waiting import until

from lrp_jupyter import Lab
from lrp_jupyter.widgets import registry
from lrp_jupyter.widgets.wire.changes import difference
from lrp_jupyter.widgets.wire.packing import packed, unpacked

TEXT = (Path(__file__).parents[1] / ".github" / "CONTRIBUTING.md").read_text(encoding="utf-8")
TOUR = dict(
    part.split("\n", 1)
    for part in TEXT.split("\n## A contributor's tour\n")[1].split("\n## ")[0].split("\n### ")[1:]
)
PROGRAM = """
(machine m
  (event dark [robot.light.data < limit[0]])
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


def lost(walk: str, calls: list[Call]) -> list[list[str]]:
    """What is missing of each leg, in the thread that goes farthest."""
    threads = defaultdict(list)
    for call in calls:
        threads[call.thread].append(call)
    left = [min((after(leg, each) for each in threads.values()), key=len, default=leg) for leg in legs(walk)]
    return [leg for leg in left if leg]


def test_the_walks_are_the_ways_of_the_program(tmp_path, monkeypatch):
    assert all(map(legs, TOUR)), "every walk names functions"
    monkeypatch.chdir(tmp_path)
    with traced() as calls:
        lab = Lab(PROGRAM, bridge="sim", namespace={"limit": (limit := [0])})
        lab.session.pause()

        def page(**message: object) -> None:
            lab._handle_custom_msg({"json": packed({"view": "v", **message})}, [])

        def hear(content: dict[str, str], _: object) -> None:
            message = unpacked(content)
            if message["type"] == "frame":
                page(type="credit", frame=message["frame"])

        def walk(heading: str, mark: int) -> None:
            until(lambda: not lost(heading, calls[mark:]), lambda: lost(heading, calls[mark:]))

        monkeypatch.setattr(lab, "send", hear)
        page(type="hello", part="lab")
        until(lambda: after(["View.send"], calls) == [])
        typed, *others = TOUR
        mark, revision = len(calls), lab._connection.texts.revision
        updates = [difference(PROGRAM, PROGRAM.replace("(state a)", "(state a) (state c)")).json()]
        page(type="text", seq=1, base=revision, updates=updates)
        walk(typed, mark)
        mark, limit[0] = len(calls), 300  # however many ticks there were before the pause: dark now
        lab.session.step()
        for each in others:
            walk(each, mark)
        for connection in list(registry.running()):
            registry.forget(connection)
