"""Every code of a reason: a small program gives it, it is explained, and the reference has it."""

import json
from pathlib import Path

import pytest
from planted import LateRobot

from lrp_jupyter.interpreter.reasons import CODES
from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.reason import EXPLANATIONS
from lrp_jupyter.live.session import Session

REFERENCE = Path(__file__).parents[2] / "notebooks" / "reference" / "language.ipynb"
HOP = "(machine m (state a) (state b) {}) (spawn m a)"
NESTED = """
(machine m
  (state a (onentry (spawn first x) (spawn second x))
    (machine first (state x) (state y) {})
    (machine second (state x) (state y) (eps x -> y go)))
  (state b)
  {})
(spawn m a)
"""
DRIVE = "(machine m (state a ({} [robot.move(linear={})]))) (spawn m a)"


def late(hardware):
    return lambda: {"bridge": LateRobot(hardware)}


def simulated():
    return {"bridge": "sim", "world": "empty"}


def ask(text, question, do=lambda session: None, robot=dict, at=None, seconds=1):
    """Run a program, do something, and ask `why_not` about a transition, or `why` about anything else."""
    with Session(text, clock=VirtualClock(), **robot()) as session:
        session.run(seconds)
        do(session)
        return session.why_not("go", at) if question == "go" else session.why(question, at)


def pause(session):
    session.resume()  # `run` has left it neither paused nor running
    session.pause()


def reset(session):
    session.reset()
    session.run(0.5)


TRANSITIONS = {
    "fired": (HOP.format("(eps a -> b go)"), "go", {"at": 2}),
    "source-inactive": (HOP.format("(eps a -> b go)"), "go", {"at": 3}),
    "machine-not-running": (
        "(machine m (state a (machine n (state x) (eps x -> x go)))) (spawn m a)",
        "go",
        {"at": 3},
    ),
    "earlier-fired": (HOP.format("(eps a -> a) (eps a -> b go)"), "go", {"at": 3}),
    "outer-fired": (NESTED.format("", "(eps a -> b)"), "go", {"at": 2}),
    "exit-took-parent": (NESTED.format("(exit [True] x -> b)", ""), "go", {"at": 2}),
    "condition-false": (HOP.format("(on [1 > 2] a -> b go)"), "go", {"at": 3}),
    "not-boolean": (HOP.format("(on [1] a -> b go)"), "go", {"at": 3}),
    "raised": (HOP.format("(on [1 / 0 > 1] a -> b go)"), "go", {"at": 3}),
    "no-data": (HOP.format("(on [robot.scan.data > 1] a -> b go)"), "go", {"at": 3, "robot": late(False)}),
    "delay-not-over": (HOP.format("(ontime 9000 a -> b go)"), "go", {"at": 3}),
    "unknown-event": (HOP.format("(on ghost a -> b go)"), "go", {"at": 3}),
    "unknown-destination": (HOP.format("(eps a -> nowhere go)"), "go", {"at": 3}),
    "paused": (HOP.format("(on [False] a -> b go)"), "go", {"do": pause}),
    "not-in-program": (
        HOP.format(""),
        "go",
        {"at": 3, "do": lambda session: session.edit(HOP.format("(eps a -> b go)"))},
    ),
}


STATES = {
    "fired": (HOP.format("(eps a -> b go)"), "b", {}),
    "spawned": (HOP.format(""), "a", {}),
    "forced": (HOP.format(""), "b", {"do": lambda session: session.teleport_to("m/b")}),
    "restarted": (HOP.format(""), "a", {"do": reset}),
    "never": (HOP.format(""), "b", {}),
}
COMMANDS = {
    "commanded": (DRIVE.format("running", 0.2), "robot.move", {"robot": simulated, "at": 5}),
    "limited": (DRIVE.format("running", 9), "robot.move", {"robot": late(False), "at": 5}),
    "disarmed": (DRIVE.format("running", 0.2), "robot.move", {"robot": late(True)}),
    "watchdog": (DRIVE.format("onentry", 0.2), "robot.move", {"robot": simulated}),
    "stopped": (DRIVE.format("running", 0.2), "robot.move", {"robot": simulated, "do": pause}),
    "never": (HOP.format(""), "robot.move", {"robot": simulated}),
}
ASKED = {"transition": TRANSITIONS, "state": STATES, "command": COMMANDS}


def test_every_code_is_explained_and_has_a_program():
    assert tuple(EXPLANATIONS["transition"]) == CODES
    assert {kind: set(codes) for kind, codes in ASKED.items()} == {
        kind: set(codes) for kind, codes in EXPLANATIONS.items()
    }


@pytest.mark.parametrize(("kind", "code"), [(kind, code) for kind, codes in ASKED.items() for code in codes])
def test_a_small_program_gives_it(kind, code):
    text, question, options = ASKED[kind][code]
    reason = ask(text, question, **options)
    assert reason.code == code
    assert str(reason)[0] in "`T"
    assert str(reason).endswith(".")
    assert all(line > 0 for line in reason.facts["lines"])


@pytest.mark.parametrize(
    ("kind", "code", "said"),
    [
        ("transition", "raised", "its condition is `1 / 0 > 1`. ZeroDivisionError: division by zero."),
        ("transition", "unknown-event", "`go` (line 1) did not fire at 0.2 s. There is no event `ghost`."),
        ("transition", "delay-not-over", "since `a` was entered at 0 s, when `m` started."),
        (
            "command",
            "stopped",
            "given by `a.running` (line 1) at 0.9 s, repeated since 0.1 s. Then the program",
        ),
    ],
)
def test_a_reason_reads_as_sentences(kind, code, said):
    text, question, options = ASKED[kind][code]
    assert said in str(ask(text, question, **options))


def test_an_explanation_is_a_sentence():
    for codes in EXPLANATIONS.values():
        for text in codes.values():
            assert text[0].isupper()
            assert text.endswith(".")


def test_the_reference_lists_them_all():
    notebook = json.loads(REFERENCE.read_text(encoding="utf-8"))
    tables = "".join(
        "".join(output["data"]["text/markdown"])
        for cell in notebook["cells"]
        for output in cell.get("outputs", ())
        if "text/markdown" in output.get("data", {})
    )
    for kind, codes in EXPLANATIONS.items():
        for code, text in codes.items():
            assert f"| {kind} | `{code}` | {text} |" in tables
