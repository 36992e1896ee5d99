"""Every row of the table of live changes: tests/edits holds the versions and the effect of each edit."""

import re

import pytest
from support.story import HERE, read, robot, run_until
from support.tables import every

from lrp_jupyter.errors import LRPSyntaxError
from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.language.parser import parse

EDITS = sorted((HERE / "edits").glob("*.lrp"))
SEPARATOR = re.compile(r"^;;; (kept|restart|not applied|not a program)(?:: (.*))?\n", re.MULTILINE)


@every("path", EDITS)
def test_an_edit_does_what_the_table_says(path):
    text = path.read_text(encoding="utf-8")
    policy = match[1] if (match := re.search(r"^;;; policy (\w+)\n", text)) else "restart"
    first, *rest = SEPARATOR.split(text)
    story, bot = read(first), robot()
    i = Interpreter(parse(first), bot, on_active_edit=policy)

    def look():
        return tuple("/".join(path) for path in i.active), dict(i.variables)

    run_until(i.step, story, bot, look)
    tick = story.last_tick
    assert len(rest) > 0
    for outcome, reason, version in zip(rest[::3], rest[1::3], rest[2::3], strict=True):
        assert {(issue.code, issue.line) for issue in i.issues if not issue.resolved} == story.issues
        before = i.active, dict(i.variables)
        if outcome == "not a program":
            with pytest.raises(LRPSyntaxError):
                parse(version)
        else:
            patch = i.patch(parse(version))
            assert (patch.applied, patch.restarted) == (outcome != "not applied", outcome == "restart"), patch
            if reason is not None or outcome != "kept":
                assert patch.reason is not None
                assert reason in patch.reason
            else:
                assert patch.reason is None
            assert (i.active == ()) == (outcome == "restart")
        if outcome in ("not applied", "not a program"):
            assert (i.active, dict(i.variables)) == before
        story = read(version)
        if 0 in story.active or 0 in story.values:  # right after the edit, before the next tick
            active, variables = look()
            assert active == story.active[0]
            for name, value in story.values[0].items():
                actual = variables.get(tuple(name.split("/")), "-")
                assert (actual == "-") if value == "-" else (actual == eval(value)), name
        run_until(i.step, story, bot, look, first=tick + 1)
        tick = max(tick, story.last_tick)
    assert {(issue.code, issue.line) for issue in i.issues if not issue.resolved} == story.issues


@every("path", EDITS)
def test_an_edit_is_undone_by_going_back(path):
    text = path.read_text(encoding="utf-8")
    first, *rest = SEPARATOR.split(text)
    i = Interpreter(parse(first), robot())
    for tick in range(3):
        i.step(tick / 10)
    before = i.active, dict(i.variables), i.program.text
    for version in rest[2::3]:
        try:
            i.patch(parse(version))
        except LRPSyntaxError:
            continue
    i.step(0.3)
    i.rewind(1)
    assert (i.active, dict(i.variables), i.program.text) == before
    i.step(0.3)


def test_there_is_an_edit_for_every_row_of_the_table():
    assert len(EDITS) >= 20
