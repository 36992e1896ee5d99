"""A real client of the language server, over the pipes of a real process."""

import asyncio
import os
import sys
import threading
from contextlib import suppress
from pathlib import Path

from lsprotocol import types as lsp
from pygls.lsp.client import LanguageClient

from support.waiting import until

PATIENCE = 60  # s for one answer


class EditorClient:
    """An editor with one file, whose requests are made one after the other."""

    def __init__(self, path, command=("language-server",), encodings=None, capabilities=None):
        self.path = Path(path)
        self.uri = self.path.as_uri()
        self.text, self.version = "", 0
        self.marks = None  # of the text's last version that was checked
        self.refreshed = 0
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, daemon=True)
        self._thread.start()
        self.client = LanguageClient("test", "1")
        self.client.feature(lsp.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)(lambda told: self._marked(told))
        self.client.feature(lsp.WORKSPACE_INLAY_HINT_REFRESH)(lambda _: self._refreshed())
        self.do(self.client.start_io(sys.executable, "-m", "lrp_jupyter", *command))
        capabilities = capabilities or lsp.ClientCapabilities(
            workspace=lsp.WorkspaceClientCapabilities(
                inlay_hint=lsp.InlayHintWorkspaceClientCapabilities(refresh_support=True)
            ),
            text_document=lsp.TextDocumentClientCapabilities(
                completion=lsp.CompletionClientCapabilities(
                    completion_item=lsp.ClientCompletionItemOptions(snippet_support=True)
                )
            ),
            general=lsp.GeneralClientCapabilities(position_encodings=encodings),
        )
        asked = lsp.InitializeParams(capabilities, process_id=os.getpid(), root_uri=self.path.parent.as_uri())
        self.able = self.do(self.client.initialize_async(asked)).capabilities
        self.tell(self.client.initialized, lsp.InitializedParams())

    def _marked(self, told):
        self.marks = told

    def _refreshed(self):
        self.refreshed += 1

    def do(self, coroutine):
        return asyncio.run_coroutine_threadsafe(coroutine, self._loop).result(PATIENCE)

    def tell(self, function, *arguments):
        async def call():
            function(*arguments)

        self.do(call())

    @property
    def document(self):
        return lsp.TextDocumentIdentifier(self.uri)

    def open(self, text):
        self.text, self.version = text, 1
        item = lsp.TextDocumentItem(self.uri, "lrp", 1, text)
        self.tell(self.client.text_document_did_open, lsp.DidOpenTextDocumentParams(item))

    def change(self, *edits):
        """Change the text, one edit after the other: ``(start, end, new)`` in characters."""
        changes = []
        in_parts = self.able.text_document_sync.change == lsp.TextDocumentSyncKind.Incremental
        for start, end, new in edits:
            place = lsp.Range(self.position(start), self.position(end))
            self.text = self.text[:start] + new + self.text[end:]
            part = lsp.TextDocumentContentChangePartial(place, new)
            changes.append(part if in_parts else lsp.TextDocumentContentChangeWholeDocument(self.text))
        self.version += 1
        document = lsp.VersionedTextDocumentIdentifier(self.version, self.uri)
        self.tell(self.client.text_document_did_change, lsp.DidChangeTextDocumentParams(document, changes))

    def replace(self, old, new):
        start = self.text.index(old)
        self.change((start, start + len(old), new))

    def save(self):
        self.tell(self.client.text_document_did_save, lsp.DidSaveTextDocumentParams(self.document))

    def found(self):
        """The findings of the present text."""
        until(lambda: self.marks is not None and self.marks.version == self.version, "no findings came")
        return self.marks.diagnostics

    def codes(self):
        return [each.code for each in self.found()]

    def position(self, offset):
        """The position of a character, counted here on its own: in UTF-16."""
        line = self.text.count("\n", 0, offset)
        begin = self.text.rfind("\n", 0, offset) + 1
        return lsp.Position(line, len(self.text[begin:offset].encode("utf-16-le")) // 2)

    def at(self, word, plus=0):
        return self.position(self.text.index(word) + plus)

    def words(self, ranges):
        return [self.text[self.offset(each.start) : self.offset(each.end)] for each in ranges]

    def offset(self, position):
        lines = self.text.split("\n")
        before = sum(len(line) + 1 for line in lines[: position.line])
        units = lines[position.line].encode("utf-16-le")[: 2 * position.character]
        return before + len(units.decode("utf-16-le"))

    def apply(self, edits):
        """Apply the edits of an answer, as an editor does, and tell so."""
        if isinstance(edits, lsp.WorkspaceEdit):
            edits = edits.changes[self.uri]
        spans = [(self.offset(e.range.start), self.offset(e.range.end), e.new_text) for e in edits]
        self.change(*sorted(spans, reverse=True))

    def ask(self, name, kind, position=None, **others):
        place = {} if position is None else {"position": position}
        return self.do(
            getattr(self.client, f"text_document_{name}_async")(
                kind(text_document=self.document, **place, **others)
            )
        )

    def complete(self, position):
        return self.ask("completion", lsp.CompletionParams, position).items

    def labels(self, position):
        return [each.label for each in self.complete(position)]

    def hover(self, position):
        found = self.ask("hover", lsp.HoverParams, position)
        return found and found.contents.value

    def actions(self, start, end, only=None):
        asked = {"range": lsp.Range(start, end), "context": lsp.CodeActionContext([], only)}
        return self.ask("code_action", lsp.CodeActionParams, **asked)

    def hints(self):
        whole = lsp.Range(lsp.Position(0, 0), self.position(len(self.text)))
        return self.ask("inlay_hint", lsp.InlayHintParams, range=whole)

    def close(self):
        with suppress(Exception):
            self.do(self.client.shutdown_async(None))
            self.tell(self.client.exit, None)
        with suppress(Exception):
            self.do(self.client.stop())
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(PATIENCE)
        self._loop.close()
