"""A reason reads as sentences, and the reference lists every code; tests/test_codes.py has the programs."""

import json
from pathlib import Path
from typing import NamedTuple

from support.robots import Bare
from support.tables import every

from lrp_jupyter.codes import CODES
from lrp_jupyter.live.reason import EXPLANATIONS
from lrp_jupyter.live.session import Session

REFERENCE = Path(__file__).parents[3] / "notebooks" / "reference" / "language.ipynb"


@every(
    ("code", "said"),
    [
        ("transition-raised", "its condition is `1 / 0 > 1`. ZeroDivisionError: division by zero."),
        ("transition-unknown-event", "`go` (line 2) did not fire at 0.2 s. There is no event `ghost`."),
        ("transition-delay-not-over", "since `a` was entered at 0 s, when `m` started."),
        (
            "command-stopped",
            "given by `a.running` (line 2) at 0.9 s, repeated since 0 s. Then the program",
        ),
    ],
)
def test_a_reason_reads_as_sentences(code, said):
    names = {"text": CODES[code].example}
    exec(CODES[code].script, names)
    names["session"].close()
    assert said in str(names["reason"])


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


class Seen(NamedTuple):
    """A message of a sensor."""

    data: int


def test_a_reading_is_told_by_the_field_that_is_compared_not_by_the_whole_message():
    robot = Bare(lambda robot: robot.add_variable("light", lambda: Seen(42)))
    text = "(machine m (state a) (state b) (on [robot.light.data < 100] a -> b dark)) (spawn m a)"
    with Session(text, robot) as session:
        assert session.run(1, until="b")
        reason = session.why_not("dark")
    assert reason.facts["values"] == {"robot.light.data": 42}
    assert str(reason).endswith("because `robot.light.data < 100` was True (`robot.light.data` was 42).")
