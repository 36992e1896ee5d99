"""What an editor shows and does, asked of a real server as editors do."""

import pytest
from lsprotocol import types as lsp

pytestmark = pytest.mark.slow  # starts the server as a process

WRONG = """\
; world: line
(var pace := [0.2])
(event dark [robot.light.data < 100])
(machine rover
  (state driving (running [robot.move(linear=pace)]))
  (state turning (running [robot.move(anglar=1)]))
  (on dark driving -> turnin)
  (ontime 500 turning -> driving)
(spawn rover driving)
"""


def test_a_program_with_errors_is_corrected_explored_and_renamed_from_an_editor(editor):
    lrp = editor()
    lrp.open(WRONG)
    (error,) = lrp.found()
    assert (error.code, error.severity, error.source) == ("LRP101", lsp.DiagnosticSeverity.Error, "lrp")
    assert lrp.words([error.range]) == ["(machine"]

    (fix, *_) = lrp.actions(error.range.start, error.range.end, [lsp.CodeActionKind.QuickFix])
    assert fix.is_preferred
    lrp.apply(fix.edit)
    assert lrp.codes() == ["LRP521", "LRP303"]

    everything = lrp.actions(lrp.at("(var"), lrp.at("(var"), [lsp.CodeActionKind.Source])
    assert [each.title for each in everything] == ["Fix all that is certain"]
    lrp.apply(lrp.do(lrp.client.code_action_resolve_async(everything[0])).edit)
    assert lrp.codes() == []
    assert "angular=1" in lrp.text
    assert "-> turning)" in lrp.text
