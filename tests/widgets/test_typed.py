"""What a kernel answers while lines are typed, letter by letter: `typed.json`, which the page's tests show.

``UPDATE=1`` writes it.
"""

import json
import os
from pathlib import Path

FILE = Path(__file__).with_name("typed.json")
TEXT = """\
(var pace := [0.2])
(machine rover
  (state driving (running [robot.move(linear=pace)]))
  (state turning (running [robot.move(angular=1)]))
)
(spawn rover driving)
"""
LINES = ["(event bump [robot.bumper.data == 1])", "(on bump driving -> turning)", "(state away)"]
CLOSED = {"(": ")", "[": "]"}


def typed(page):
    """Type the lines below the states, brackets closed at once, and a bracket too many; yield each answer."""
    at = TEXT.index("\n)")
    for line in LINES:
        for letter in f"\n{line}":
            if letter in ")]" and page.text[at : at + 1] == letter:  # typed over
                at += 1
                continue
            text = page.text[:at] + letter + CLOSED.get(letter, "") + page.text[at:]
            at += 1
            yield page.type(text, at=at, meant=letter == "\n")
    yield page.type(page.text[:at] + ")" + page.text[at:], at=at + 1, meant=False)
    yield page.moves(at + 1)
    yield page.type(page.text[:at] + page.text[at + 1 :], at=at, meant=False)


def test_the_recorded_answers_are_those_of_the_kernel(bench):
    page = bench(TEXT, bridge="sim", world="walls").page()
    steps, known = [], [[]]
    for answer in typed(page):
        findings = answer["findings"]
        if findings not in known:
            known.append(findings)
        steps.append(
            {
                "changes": [update["changes"] for update in answer["updates"]],
                "findings": known.index(findings),
                "accepted": answer["accepted"],
                "half_typed": answer["half_typed"],
            }
        )
    rows = [f'"text": {json.dumps(TEXT)}', f'"findings": {json.dumps(known)}']
    rows.append('"steps": [\n' + ",\n".join(json.dumps(step) for step in steps) + "\n]")
    recorded = "{\n" + ",\n".join(rows) + "\n}\n"
    if os.environ.get("UPDATE"):
        FILE.write_text(recorded, "utf-8")
    assert recorded == FILE.read_text("utf-8")
