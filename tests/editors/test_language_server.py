"""What an editor shows and does, asked of a real server as editors do."""

import subprocess
import sys

import pytest
from lsprotocol import types as lsp
from pygls.exceptions import JsonRpcException
from support.waiting import until

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
    assert [each.title for each in everything] == ["Apply all certain fixes"]
    lrp.apply(lrp.do(lrp.client.code_action_resolve_async(everything[0])).edit)
    assert lrp.codes() == []
    assert "angular=1" in lrp.text
    assert "-> turning)" in lrp.text


PROGRAM = """\
; A rover that turns in the dark — größer 🤖
; world: line
; how fast it drives
(var pace := [0.2])  ; m/s
(event dark [robot.light.data < 100])
(machine rover
  (state driving (running ['🤖'; robot.move(linear=pace)]))
  (state turning
    (running [robot.move(angular=1)]))
  (on dark driving -> turning lost)
  (ontime 500 turning -> driving))
(spawn rover driving)
"""


def test_names_are_explained_found_and_changed_everywhere(editor):
    lrp = editor()
    lrp.open(PROGRAM)
    assert lrp.codes() == []

    assert "**state** `driving` of `rover`" in lrp.hover(lrp.at("driving -> turning"))
    assert "how fast it drives m/s" in lrp.hover(lrp.at("pace)]", 2))
    assert "Leads to another state as soon as" in lrp.hover(lrp.at("on dark", 1))
    assert "brightness of the floor" in lrp.hover(lrp.at("data <"))
    assert "robot.move(linear=0.0, angular=0.0)" in lrp.hover(lrp.at("move(linear"))
    assert lrp.hover(lrp.at("100")) is None
    help_ = lrp.ask("signature_help", lsp.SignatureHelpParams, lrp.at("angular=1", 8))
    assert (help_.signatures[0].label, help_.active_parameter) == ("robot.move(linear=0.0, angular=0.0)", 1)

    definition = lrp.ask("definition", lsp.DefinitionParams, lrp.at("pace)]"))
    assert definition.range.start == lrp.at("pace := ")
    context = lsp.ReferenceContext(include_declaration=False)
    uses = lrp.ask("references", lsp.ReferenceParams, lrp.at("turning\n"), context=context)
    assert lrp.words([each.range for each in uses]) == ["turning"] * 2
    marked = lrp.ask("document_highlight", lsp.DocumentHighlightParams, lrp.at("pace :="))
    assert lrp.words([each.range for each in marked]) == ["pace"] * 2

    place = lrp.ask("prepare_rename", lsp.PrepareRenameParams, lrp.at("pace)]", 2))
    assert lrp.words([place]) == ["pace"]
    lrp.apply(lrp.ask("rename", lsp.RenameParams, lrp.at("pace)]", 2), new_name="größe"))
    assert lrp.text == PROGRAM.replace("pace", "größe")
    assert lrp.codes() == []
    with pytest.raises(JsonRpcException, match="is taken by another state"):
        lrp.ask("rename", lsp.RenameParams, lrp.at("turning\n"), new_name="driving")

    lrp.replace("(on dark driving", "(on   dark  driving")
    options = lsp.FormattingOptions(tab_size=2, insert_spaces=True)
    lrp.apply(lrp.ask("formatting", lsp.DocumentFormattingParams, options=options))
    assert lrp.text == PROGRAM.replace("pace", "größe")


def test_a_text_that_is_being_written_still_has_its_outline_and_completion(editor):
    lrp = editor()
    lrp.open(PROGRAM)
    lrp.replace("  (ontime", "  (on \n  (ontime")
    assert lrp.codes() == ["LRP101", "LRP108"]
    assert lrp.labels(lrp.at("(on \n", 4)) == ["dark"]
    lrp.replace("(on \n", "(on dark turning -> dr\n")
    items = lrp.complete(lrp.at("dr\n", 2))
    assert [each.label for each in items] == ["driving", "turning"]
    lrp.apply([items[0].text_edit])
    assert "(on dark turning -> driving\n" in lrp.text
    lrp.change((len(lrp.text), len(lrp.text), "(st"))
    (found,) = [each for each in lrp.complete(lrp.position(len(lrp.text))) if each.label == "spawn"]
    assert found.insert_text_format == lsp.InsertTextFormat.Snippet
    assert found.text_edit.new_text == "spawn ${1:machine} ${2:state})"

    symbols = lrp.ask("document_symbol", lsp.DocumentSymbolParams)
    assert [each.name for each in symbols] == ["pace", "dark", "rover"]
    assert [each.name for each in symbols[-1].children] == [
        "driving",
        "turning",
        "lost",
        "dark:turning->driving",
        "500:turning->driving",
    ]
    folds = lrp.ask("folding_range", lsp.FoldingRangeParams)
    assert {(0, 2), (5, 11), (7, 8)} <= {(each.start_line, each.end_line) for each in folds}
    options = lsp.FormattingOptions(tab_size=2, insert_spaces=True)
    with pytest.raises(JsonRpcException, match="cannot be formatted"):
        lrp.ask("formatting", lsp.DocumentFormattingParams, options=options)
    with pytest.raises(JsonRpcException, match="nothing can be renamed"):
        lrp.ask("rename", lsp.RenameParams, lrp.at("pace"), new_name="speed")


def test_an_editor_without_snippets_inserts_what_can_be_read(editor):
    lrp = editor(capabilities=lsp.ClientCapabilities())
    lrp.open(PROGRAM)
    (effect,) = lrp.complete(lrp.at(" lost", 5))
    assert effect.text_edit.new_text == "(effect [])"


def test_a_selection_grows_from_the_word_to_the_text(editor):
    lrp = editor()
    lrp.open(PROGRAM)
    (found,) = lrp.ask("selection_range", lsp.SelectionRangeParams, positions=[lrp.at("linear")])
    texts = []
    while found is not None:
        texts += lrp.words([found.range])
        found = found.parent
    assert texts[:3] == [
        "linear",
        "['🤖'; robot.move(linear=pace)]",
        "(running ['🤖'; robot.move(linear=pace)])",
    ]
    assert texts[-1] == PROGRAM


def test_the_end_of_a_file_and_of_the_server(editor):
    lrp = editor()
    lrp.open(WRONG)
    assert lrp.found()
    document = lsp.DidCloseTextDocumentParams(lrp.document)
    lrp.tell(lrp.client.text_document_did_close, document)
    until(lambda: not lrp.marks.diagnostics)
    with pytest.raises(JsonRpcException, match=r"my\.lrp` is not open\."):
        lrp.ask("document_symbol", lsp.DocumentSymbolParams)


def test_a_change_is_made_where_it_was_typed_whatever_stands_above(editor):
    lrp = editor()
    lrp.open("; a page\f and \x0b other \x85 ends \u2028 of lines 🤖\n(machine m (state s) (state t))")
    lrp.replace("(state t", "(stat t")
    (error,) = lrp.found()
    assert lrp.words([error.range]) == ["stat"]


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "utf-32"])
def test_the_units_that_the_client_counts_are_agreed_on(editor, encoding):
    lrp = editor(encodings=[lsp.PositionEncodingKind(encoding)])
    assert lrp.able.position_encoding == encoding
    lrp.open("(event ä [1]) (event 🤖 [2])")
    (error,) = lrp.found()
    assert (
        error.range.start.character
        == len("(event ä [1]) (event ".encode(encoding.replace("16", "16-le").replace("32", "32-le")))
        // {"utf-8": 1, "utf-16": 2, "utf-32": 4}[encoding]
    )


def test_a_world_that_no_program_may_name_is_marked_where_it_stands(editor):
    lrp = editor()
    lrp.open(PROGRAM.replace("world: line", "world: ../secret.json"))
    (error,) = lrp.found()
    assert lrp.words([error.range]) == ["; world: ../secret.json"]
    assert "only `--world` chooses another file" in error.message
    lrp.replace("../secret.json", "maze")
    assert lrp.found() == ()


def test_a_program_that_is_saved_is_checked_for_the_world_that_its_file_now_has(editor, tmp_path):
    lrp = editor()
    lrp.open(PROGRAM.replace("world: line", "world: mine.json").replace("linear=", "liner="))
    assert lrp.codes() == []
    command = [sys.executable, "-m", "lrp_jupyter", "worlds", "--json", "line"]
    (tmp_path / "mine.json").write_bytes(subprocess.run(command, stdout=subprocess.PIPE).stdout)
    lrp.save()
    until(lambda: lrp.codes() == ["LRP521"])


def test_findings_are_for_the_robot_that_is_named(editor):
    lrp = editor(command=("language-server", "--bridge", "none"))
    lrp.open(PROGRAM.replace("robot.light.data", "robot.no.such"))
    assert lrp.codes() == []


def test_findings_have_the_address_of_their_explanation_where_the_documentation_is(editor, monkeypatch):
    monkeypatch.setenv("LRP_DOCS", "https://example.org/lrp")
    lrp = editor()
    lrp.open(WRONG)
    (error,) = lrp.found()
    assert error.code_description.href == "https://example.org/lrp/errors.html#LRP101"
    assert "LRP101" in lrp.hover(error.range.start)
