"""``lrp language-server``: what an editor asks and is told about the programs that are open in it."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import Any

from lsprotocol import types as lsp
from pygls.exceptions import JsonRpcException
from pygls.lsp.server import LanguageServer
from pygls.uris import to_fs_path

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.editors.call_signatures import signature_at
from lrp_jupyter.editors.finding_marks import ALL, QUICK, fix_all, fixes, marks
from lrp_jupyter.editors.hover_cards import card
from lrp_jupyter.editors.live_hints import hints
from lrp_jupyter.editors.live_reader import LiveReader
from lrp_jupyter.editors.outline_symbols import folds, outline, selection
from lrp_jupyter.editors.program_text import AssumedRobot, ProgramText
from lrp_jupyter.editors.semantic_colours import KINDS, MODIFIERS, encoded
from lrp_jupyter.editors.word_options import WordOption, complete
from lrp_jupyter.errors import LRPError, LRPSyntaxError
from lrp_jupyter.language.edits.format import formatting
from lrp_jupyter.language.edits.rename import rename_edits

_TOGETHER = 0.01  # s in which changes are collected before the text is checked
_REFRESH = 0.25  # s between two times that live values are shown
_KINDS = {
    "keyword": lsp.CompletionItemKind.Keyword,
    "event": lsp.CompletionItemKind.Event,
    "machine": lsp.CompletionItemKind.Class,
    "state": lsp.CompletionItemKind.EnumMember,
    "variable": lsp.CompletionItemKind.Variable,
    "property": lsp.CompletionItemKind.Property,
    "function": lsp.CompletionItemKind.Function,
    "method": lsp.CompletionItemKind.Method,
    "class": lsp.CompletionItemKind.Class,
    "namespace": lsp.CompletionItemKind.Module,
}


class CannotBeDoneError(JsonRpcException):
    """What is asked for cannot be done; the message says why."""

    CODE = -32803  # RequestFailed
    MESSAGE = "It cannot be done."


class ProgramServer(LanguageServer):
    """The server, with the texts that are open. `robot`: for which they are checked, if it is named."""

    def __init__(self, robot: Bridge | None = None) -> None:
        # whole texts: for pygls, other characters end lines, too, and it moves the places of changes
        super().__init__("lrp", version("lrp-jupyter"), lsp.TextDocumentSyncKind.Full)
        self._robot = robot
        self._open: dict[str, ProgramText] = {}
        self._due: set[str] = set()
        self._runs = LiveReader(self._hear)
        self._loop: asyncio.AbstractEventLoop | None = None
        self._is_stale = False  # whether live values are to be shown soon

    def text(self, uri: str) -> ProgramText:
        """Return an open text."""
        try:
            return self._open[uri]
        except KeyError:
            raise CannotBeDoneError(f"`{uri}` is not open.") from None

    def opened(self, uri: str, text: str, number: int | None) -> None:
        """Keep a text that was opened or saved, and mark what is found in it."""
        file = _file_of(uri)
        robot = AssumedRobot(self._robot, file and file.parent)
        self._open[uri] = ProgramText(text, number, self._encoding, robot)
        self.mark(uri)
        if file is not None:
            self._loop = asyncio.get_running_loop()
            self._runs.open(file)

    def changed(self, uri: str, text: str, number: int) -> None:
        """Keep a text after a change, and mark what is found in it soon."""
        self._open[uri] = ProgramText(text, number, self._encoding, self.text(uri).robot)
        if uri not in self._due:
            self._due.add(uri)
            asyncio.get_running_loop().call_later(_TOGETHER, self.mark, uri)

    def mark(self, uri: str) -> None:
        """Tell what is found in a text."""
        self._due.discard(uri)
        text = self._open.get(uri)
        if text is not None:
            self._tell(uri, marks(text), text.version)

    def closed(self, uri: str) -> None:
        """Forget a text."""
        file = _file_of(uri)
        if file is not None:
            self._runs.close(file)
        if self._open.pop(uri, None):
            self._tell(uri, [], None)

    def live_hints(self, uri: str) -> list[lsp.InlayHint]:
        """Return what a run of the file of a text shows in it."""
        file = _file_of(uri)
        return hints(self.text(uri), None if file is None else self._runs.news(file))

    def _hear(self, _: Path) -> None:
        """Have live values shown soon; called on another thread."""
        if self._loop is not None and not self._is_stale:
            self._is_stale = True
            with suppress(RuntimeError):  # it ends
                self._loop.call_soon_threadsafe(self._loop.call_later, _REFRESH, self._refresh)

    def _refresh(self) -> None:
        self._is_stale = False
        workspace = self.client_capabilities.workspace
        if workspace and workspace.inlay_hint and workspace.inlay_hint.refresh_support:
            self.workspace_inlay_hint_refresh(None)

    def _tell(self, uri: str, found: list[lsp.Diagnostic], number: int | None) -> None:
        self.text_document_publish_diagnostics(lsp.PublishDiagnosticsParams(uri, found, number))

    @property
    def _encoding(self) -> str:
        return str(getattr(self.workspace.position_encoding, "value", self.workspace.position_encoding))


def _file_of(uri: str) -> Path | None:
    path = to_fs_path(uri) if uri.startswith("file:") else None
    return Path(path) if path and "\0" not in path else None


def language_server(robot: Bridge | None = None) -> ProgramServer:
    """Return a server with all that it answers."""
    server = ProgramServer(robot)
    for method, (function, options) in _FEATURES.items():
        server.feature(method, options)(partial(function, server))
    return server


# -- texts -----------------------------------------------------------------------------------------------


def _did_open(server: ProgramServer, asked: lsp.DidOpenTextDocumentParams) -> None:
    document = asked.text_document
    server.opened(document.uri, document.text, document.version)


def _did_change(server: ProgramServer, asked: lsp.DidChangeTextDocumentParams) -> None:
    server.changed(asked.text_document.uri, asked.content_changes[-1].text, asked.text_document.version)


def _did_save(server: ProgramServer, asked: lsp.DidSaveTextDocumentParams) -> None:
    text = server.text(asked.text_document.uri)
    server.opened(asked.text_document.uri, text.text, text.version)  # its world may be another one now


def _did_close(server: ProgramServer, asked: lsp.DidCloseTextDocumentParams) -> None:
    server.closed(asked.text_document.uri)


# -- questions -------------------------------------------------------------------------------------------


def _completion(server: ProgramServer, asked: lsp.CompletionParams) -> lsp.CompletionList:
    text = server.text(asked.text_document.uri)
    offset = text.at.offset(asked.position)
    found = complete(text, offset)
    place = text.at.range(found.begin, offset)
    capability = server.client_capabilities.text_document
    item = capability and capability.completion and capability.completion.completion_item
    snippets = bool(item and item.snippet_support)
    items = [_item(each, index, place, snippets) for index, each in enumerate(found.options)]
    return lsp.CompletionList(False, items)


def _item(option: WordOption, index: int, place: lsp.Range, snippets: bool) -> lsp.CompletionItem:
    is_snippet = "$" in option.snippet
    plain = option.label.replace("…", "")
    written = option.snippet if option.snippet and (snippets or not is_snippet) else plain
    return lsp.CompletionItem(
        option.label,
        kind=_KINDS.get(option.kind, lsp.CompletionItemKind.Text),
        detail=option.detail or None,
        documentation=lsp.MarkupContent(lsp.MarkupKind.Markdown, option.info) if option.info else None,
        sort_text=f"{index:04}",
        insert_text_format=lsp.InsertTextFormat.Snippet
        if is_snippet and snippets
        else lsp.InsertTextFormat.PlainText,
        text_edit=lsp.TextEdit(place, written),
    )


def _hover(server: ProgramServer, asked: lsp.HoverParams) -> lsp.Hover | None:
    text = server.text(asked.text_document.uri)
    found = card(text, text.at.offset(asked.position))
    if found is None:
        return None
    told, span = found
    return lsp.Hover(lsp.MarkupContent(lsp.MarkupKind.Markdown, told), text.at.range(*span))


def _signature(server: ProgramServer, asked: lsp.SignatureHelpParams) -> lsp.SignatureHelp | None:
    text = server.text(asked.text_document.uri)
    found = signature_at(text, text.at.offset(asked.position))
    if found is None:
        return None
    told = lsp.MarkupContent(lsp.MarkupKind.Markdown, found.doc)
    parameters = [lsp.ParameterInformation(name) for name in found.parameters]
    active = found.active if found.active >= 0 else None
    return lsp.SignatureHelp([lsp.SignatureInformation(found.label, told, parameters)], 0, active)


def _definition(server: ProgramServer, asked: lsp.DefinitionParams) -> lsp.Location | None:
    text = server.text(asked.text_document.uri)
    symbol = text.symbol(text.at.offset(asked.position))
    place = asked.text_document.uri
    return None if symbol is None else lsp.Location(place, text.at.range(*symbol.definition))


def _references(server: ProgramServer, asked: lsp.ReferenceParams) -> list[lsp.Location]:
    uses = _uses(server, asked, asked.context.include_declaration)
    return [lsp.Location(asked.text_document.uri, each) for each in uses]


def _highlights(server: ProgramServer, asked: lsp.DocumentHighlightParams) -> list[lsp.DocumentHighlight]:
    return [lsp.DocumentHighlight(each) for each in _uses(server, asked, True)]


def _uses(
    server: ProgramServer, asked: lsp.ReferenceParams | lsp.DocumentHighlightParams, all_: bool
) -> list[lsp.Range]:
    text = server.text(asked.text_document.uri)
    symbol = text.symbol(text.at.offset(asked.position))
    if symbol is None:
        return []
    spans = {*symbol.references, *([symbol.definition] if all_ else [])}
    return [text.at.range(*span) for span in sorted(spans)]


def _prepare_rename(server: ProgramServer, asked: lsp.PrepareRenameParams) -> lsp.Range | None:
    text = server.text(asked.text_document.uri)
    offset = text.at.offset(asked.position)
    symbol = text.symbol(offset)
    return None if symbol is None else text.at.range(*text.span(symbol, offset))


def _rename(server: ProgramServer, asked: lsp.RenameParams) -> lsp.WorkspaceEdit:
    text = server.text(asked.text_document.uri)
    if text.program is None:
        raise CannotBeDoneError("The text has errors, so nothing can be renamed. Correct them first.")
    symbol = text.symbol(text.at.offset(asked.position))
    if symbol is None:
        raise CannotBeDoneError("Nothing here can be renamed. Place the cursor on a name.")
    try:
        edits = rename_edits(text.program, symbol.element.kind, symbol.element.path, asked.new_name)
    except (ValueError, LRPError) as error:
        raise CannotBeDoneError(str(error)) from None
    return lsp.WorkspaceEdit({asked.text_document.uri: [text.at.edit(edit) for edit in edits]})


def _formatting(server: ProgramServer, asked: lsp.DocumentFormattingParams) -> list[lsp.TextEdit]:
    text = server.text(asked.text_document.uri)
    try:
        return [text.at.edit(edit) for edit in formatting(text.text)]
    except LRPSyntaxError:
        raise CannotBeDoneError(
            "The text has errors, so it cannot be formatted. Correct them first."
        ) from None


def _actions(server: ProgramServer, asked: lsp.CodeActionParams) -> list[lsp.CodeAction]:
    text = server.text(asked.text_document.uri)
    found = fixes(asked.text_document.uri, text, *text.at.span(asked.range))
    only = asked.context.only
    return [each for each in found if only is None or any(_is_kind(each.kind, kind) for kind in only)]


def _is_kind(kind: Any, wanted: str) -> bool:
    return not wanted or (kind + ".").startswith(wanted + ".")  # f"{kind}" would be its name in Python


def _resolve_action(server: ProgramServer, action: lsp.CodeAction) -> lsp.CodeAction:
    if action.edit is None and isinstance(action.data, dict):
        uri = str(action.data["uri"])
        action.edit = fix_all(uri, server.text(uri))
    return action


def _symbols(server: ProgramServer, asked: lsp.DocumentSymbolParams) -> list[lsp.DocumentSymbol]:
    return outline(server.text(asked.text_document.uri))


def _folds(server: ProgramServer, asked: lsp.FoldingRangeParams) -> list[lsp.FoldingRange]:
    return [*folds(server.text(asked.text_document.uri))]


def _selections(server: ProgramServer, asked: lsp.SelectionRangeParams) -> list[lsp.SelectionRange]:
    text = server.text(asked.text_document.uri)
    return [selection(text, text.at.offset(each)) for each in asked.positions]


def _colours(server: ProgramServer, asked: lsp.SemanticTokensParams) -> lsp.SemanticTokens:
    return lsp.SemanticTokens(encoded(server.text(asked.text_document.uri)))


def _hints(server: ProgramServer, asked: lsp.InlayHintParams) -> list[lsp.InlayHint]:
    return server.live_hints(asked.text_document.uri)


_FEATURES: dict[str, tuple[Any, Any]] = {
    lsp.TEXT_DOCUMENT_DID_OPEN: (_did_open, None),
    lsp.TEXT_DOCUMENT_DID_CHANGE: (_did_change, None),
    lsp.TEXT_DOCUMENT_DID_SAVE: (_did_save, None),
    lsp.TEXT_DOCUMENT_DID_CLOSE: (_did_close, None),
    lsp.TEXT_DOCUMENT_COMPLETION: (_completion, lsp.CompletionOptions(["(", ".", "'", '"'])),
    lsp.TEXT_DOCUMENT_HOVER: (_hover, None),
    lsp.TEXT_DOCUMENT_SIGNATURE_HELP: (_signature, lsp.SignatureHelpOptions(["(", ","])),
    lsp.TEXT_DOCUMENT_DEFINITION: (_definition, None),
    lsp.TEXT_DOCUMENT_REFERENCES: (_references, None),
    lsp.TEXT_DOCUMENT_DOCUMENT_HIGHLIGHT: (_highlights, None),
    lsp.TEXT_DOCUMENT_PREPARE_RENAME: (_prepare_rename, None),
    lsp.TEXT_DOCUMENT_RENAME: (_rename, lsp.RenameOptions(prepare_provider=True)),
    lsp.TEXT_DOCUMENT_FORMATTING: (_formatting, None),
    lsp.TEXT_DOCUMENT_CODE_ACTION: (
        _actions,
        lsp.CodeActionOptions([QUICK, ALL], resolve_provider=True),
    ),
    lsp.CODE_ACTION_RESOLVE: (_resolve_action, None),
    lsp.TEXT_DOCUMENT_DOCUMENT_SYMBOL: (_symbols, None),
    lsp.TEXT_DOCUMENT_FOLDING_RANGE: (_folds, None),
    lsp.TEXT_DOCUMENT_SELECTION_RANGE: (_selections, None),
    lsp.TEXT_DOCUMENT_INLAY_HINT: (_hints, None),
    lsp.TEXT_DOCUMENT_SEMANTIC_TOKENS_FULL: (_colours, lsp.SemanticTokensLegend([*KINDS], [*MODIFIERS])),
}
