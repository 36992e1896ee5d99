"""From text to program: every error of a text at once, each at its own place.

The text is cut into tokens, brackets are matched, and then every form is read alone, innermost first. A form
that is wrong is reported and left out; those around it are read as if it were right.

Paper: §3.1, §3.2.
"""

from __future__ import annotations

import unicodedata
from bisect import bisect_right
from collections import defaultdict
from collections.abc import Iterable
from difflib import get_close_matches
from keyword import iskeyword
from typing import Any, NamedTuple

from lrp_jupyter.errors import LRPSyntaxError
from lrp_jupyter.language import blocks
from lrp_jupyter.language.forms import USAGE, Mistake, Shape, expected_text, shape_of
from lrp_jupyter.language.program import (
    Block,
    Event,
    Finding,
    Machine,
    Name,
    Program,
    Span,
    Spawn,
    State,
    Transition,
    Variable,
    line_starts,
)
from lrp_jupyter.language.repair import Bracket, repair
from lrp_jupyter.language.tokens import KEYWORDS, LEGAL, Token, tokenize

__all__ = ["DEEPEST", "parse", "scan"]

DEEPEST = 100
"""So many forms may stand in one another."""

Node = "Variable | Machine | Event | Spawn | State | Transition | Block | _Actions"


def parse(text: str, filename: str = "<lrp>") -> Program:
    """Read a program.

    Parameters
    ----------
    text : str
    filename : str
        Shown in tracebacks.

    Raises
    ------
    LRPSyntaxError
        The text is not a program; its ``findings`` are all the errors, in order of place.
    """
    program, findings = scan(text, filename)
    if program is None:
        raise LRPSyntaxError(findings)
    return program


def scan(text: str, filename: str = "<lrp>") -> tuple[Program | None, tuple[Finding, ...]]:
    """Read a program and never raise: None, and all errors in order of place, if the text is none."""
    return _Reader(text, filename).read()


class _Item(NamedTuple):
    """One token of a form, or a form inside it, with what it means (None if that was wrong)."""

    type: str
    start: int
    end: int
    node: Node | Name | int | None = None


class _Frame:
    """A form that is being read."""

    __slots__ = ("declared", "items", "keyword", "start")

    def __init__(self, start: int, keyword: str, end: int) -> None:
        self.start = start
        self.keyword = keyword
        self.items = [_Item(keyword.upper(), start, end)]
        self.declared: list[tuple[Span, str]] = []  # names that blocks inside declare `global`


class _Reader:
    """Reads one text. Collects findings as offsets, so that places are looked up only when there are any."""

    def __init__(self, text: str, filename: str) -> None:
        self.text = text
        self.filename = filename
        self.starts = line_starts(text)
        self.line = 1  # of the block read last
        self.findings: list[tuple[int, int, str, str]] = []

    def read(self) -> tuple[Program | None, tuple[Finding, ...]]:
        """Return the program, or None and the findings."""
        tokens = tokenize(self.text)
        keywords = [self._keyword(tokens, index) for index in range(len(tokens))]
        extra, unclosed = self._match(tokens, keywords)
        program = None if extra is None else self._build(tokens, keywords, extra, unclosed)
        if self.findings:
            return None, tuple(self._finding(*finding) for finding in sorted(set(self.findings)))
        return program, ()

    def report(self, start: int, end: int, code: str, message: str) -> None:
        """Note an error at a range of the text."""
        self.findings.append((start, end, code, message))

    def _finding(self, start: int, end: int, code: str, message: str) -> Finding:
        place = Program(text=self.text).place
        return Finding(code, "error", message, *place(start), *place(max(start, end)))

    def _keyword(self, tokens: list[Token], index: int) -> str | None:
        """Return the keyword of the form that begins at a token; None if none begins there."""
        if tokens[index].type != "OPEN":
            return None
        if index + 1 < len(tokens) and tokens[index + 1].type == "NAME":
            return self.text[tokens[index + 1].start : tokens[index + 1].end]
        return ""

    # Brackets

    def _match(
        self, tokens: list[Token], keywords: list[str | None]
    ) -> tuple[frozenset[int] | None, dict[int, int]]:
        """Find the ``)`` to leave out, and those to put in: their number by the token before which."""
        around = ["program"]
        sound = True
        for token, keyword in zip(tokens, keywords, strict=True):
            if keyword is not None:
                if len(around) > DEEPEST:
                    message = f"Forms are nested too deeply here; at most {DEEPEST} may stand in one another."
                    self.report(token.start, token.end, "LRP111", message)
                    return None, {}
                if keyword in KEYWORDS and (around[-1] in KEYWORDS or around[-1] == "program"):
                    sound = sound and keyword in LEGAL.get(around[-1], ())
                around.append(keyword)
            elif token.type == "CLOSE":
                if len(around) > 1:
                    around.pop()
                else:
                    sound = False
        if sound and len(around) == 1:
            return frozenset(), {}
        indices = [index for index, token in enumerate(tokens) if token.type in ("OPEN", "CLOSE")]
        found = repair([self._bracket(tokens[index], keywords[index]) for index in indices])
        extra = frozenset(indices[index] for index in found.extra)
        for index in extra:
            message = "This `)` closes nothing that is open; remove it."
            self.report(tokens[index].start, tokens[index].end, "LRP102", message)
        closing: dict[int, int] = {}
        indices.append(len(tokens))
        for opening, before in found.unclosed:
            start, index = indices[opening], indices[before]
            closing[index] = closing.get(index, 0) + 1
            if tokens[index - 1].type == "UNCLOSED":
                continue  # the bracket was probably lost together with the block's
            name = keywords[start]
            message = (
                f"The `(` of this `{name}` is not closed; put its `)`"
                if name
                else "This `(` is not closed; put its `)`"
            )
            line, _ = self._place(tokens[index - 1].end)
            self.report(
                tokens[start].start, tokens[start].end, "LRP101", f"{message} at the end of line {line}."
            )
        return extra, closing

    def _place(self, offset: int) -> tuple[int, int]:
        line = bisect_right(self.starts, offset)
        return line, offset - self.starts[line - 1] + 1

    def _bracket(self, token: Token, keyword: str | None) -> Bracket:
        line, column = self._place(token.start)
        before = self.text[self.starts[line - 1] : token.start]
        indent = len(before) - len(before.lstrip())
        name = "" if keyword is None else keyword if keyword in KEYWORDS else "?"
        return Bracket(name, -1 if before.strip() else column - 1, indent)

    # Forms

    def _build(
        self, tokens: list[Token], keywords: list[str | None], extra: frozenset[int], closing: dict[int, int]
    ) -> Program | None:
        frames = [_Frame(0, "program", 0)]
        is_keyword = False
        for index, token in enumerate(tokens):
            for _ in range(closing.get(index, 0)):
                self._finish(frames, tokens[index - 1].end)
            kind, start, end = token
            if is_keyword:
                is_keyword = False
            elif kind == "OPEN":
                keyword = keywords[index]
                is_keyword = bool(keyword)
                frames.append(_Frame(start, keyword or "", tokens[index + 1].end if keyword else end))
            elif kind == "CLOSE":
                if index not in extra:
                    self._finish(frames, end)
            elif kind == "STRAY":
                self._stray(start, end)
            else:
                frames[-1].items.append(self._item(token, frames[-1]))
        for _ in range(closing.get(len(tokens), 0)):
            self._finish(frames, len(self.text))
        return self._program(frames[0])

    def _item(self, token: Token, frame: _Frame) -> _Item:
        kind, start, end = token
        text = self.text[start:end]
        if kind == "NAME":
            return _Item(kind, start, end, self._name(text, start, end))
        if kind == "BLOCK" or kind == "UNCLOSED":
            return _Item("BLOCK", start, end, self._block(token, text, frame))
        if kind == "INTEGER":
            if text.isdecimal() and len(text) < 16:
                return _Item(kind, start, end, int(text))
            message = (
                f"`{text}` is no whole number of milliseconds; write digits only, or a block: `[{text}]`."
            )
            self.report(start, end, "LRP108", message)
            return _Item(kind, start, end, 0)
        return _Item(kind, start, end)

    def _stray(self, start: int, end: int) -> None:
        char = self.text[start:end]
        what = "This `]` closes nothing that is open" if char == "]" else f"`{char}` means nothing here"
        self.report(start, end, "LRP104", f"{what}; remove it.")

    def _name(self, text: str, start: int, end: int) -> Name:
        if not text.isascii():
            text = unicodedata.normalize("NFKC", text)  # as Python does
            if not text.isidentifier():
                self.report(start, end, "LRP110", f"`{text}` is no name; use letters, digits and `_`.")
        return Name(text, Span(start, end))

    def _block(self, token: Token, text: str, frame: _Frame) -> Block | None:
        _, start, end = token
        if token.type == "UNCLOSED":
            self.report(
                start,
                start + 1,
                "LRP103",
                "This `[` is not closed; put its `]` behind the Python that it opens.",
            )
            return None
        starts = self.starts
        while self.line < len(starts) and starts[self.line] <= start:
            self.line += 1
        line_start = starts[self.line - 1]
        block = Block(
            text[1:-1], Span(start, end), self.line, start + 2 - line_start, self.text[line_start : start + 1]
        )
        facts = blocks.facts_of(block.text)
        if facts.fault:
            message, first, last = facts.fault
            self.report(start + 1 + first, start + 1 + last, "LRP501", message)
        frame.declared += [
            (Span(start + 1 + first, start + 1 + last), name) for name, first, last in facts.globals
        ]
        return block

    def _finish(self, frames: list[_Frame], end: int) -> None:
        """Close the innermost form and hand it to the one around it."""
        frame = frames.pop()
        around = frames[-1]
        around.declared += frame.declared
        if frame.keyword not in KEYWORDS:
            self._unknown(frame, around.keyword)
            return
        shape = self._shape(frame, end)
        node = None if isinstance(shape, Mistake) else self._node(frame, shape, Span(frame.start, end))
        around.items.append(_Item(f"{frame.keyword.upper()}_FORM", frame.start, end, node))

    def _unknown(self, frame: _Frame, around: str) -> None:
        legal = sorted(LEGAL.get(around, KEYWORDS))
        start, end = frame.start, frame.items[0].end
        if not frame.keyword:
            self.report(start, start + 1, "LRP106", f"A keyword must follow this `(`: {_either(legal)}.")
            return
        close = get_close_matches(frame.keyword, legal, 1) or get_close_matches(frame.keyword, KEYWORDS, 1)
        hint = f"did you mean `{close[0]}`?" if close else f"write {_either(legal)}."
        self.report(end - len(frame.keyword), end, "LRP106", f"`{frame.keyword}` is no keyword; {hint}")

    def _shape(self, frame: _Frame, end: int) -> Shape | Mistake | None:
        """Hold a form against the grammar; what may not stand in it at all is reported and left out."""
        items = frame.items
        while True:
            types = tuple([item.type for item in items])
            shape = shape_of(types)
            if not isinstance(shape, Mistake):
                return shape
            index = shape.index
            if index < len(items):
                found = items[index]
                keyword = found.type.removesuffix("_FORM").lower()
                if keyword in KEYWORDS and keyword not in LEGAL.get(frame.keyword, ()):
                    self._misplaced(found, keyword, frame.keyword)
                    del items[index]
                    continue
                if frame.keyword == "program":
                    self._outside(items, index)
                    continue
            self._mistaken(frame, types, shape, end)
            return shape

    def _misplaced(self, found: _Item, keyword: str, around: str) -> None:
        homes = [home for home, legal in LEGAL.items() if keyword in legal]
        where = "at the top level" if around == "program" else f"in `{around}`"
        right = " or ".join("at the top level" if home == "program" else f"in a `{home}`" for home in homes)
        start = self.text.index(keyword, found.start)
        message = f"`{keyword}` cannot stand {where}; it belongs {right}."
        self.report(start, start + len(keyword), "LRP107", message)

    def _outside(self, items: list[_Item], index: int) -> None:
        """Report what stands outside every form, once for a run of it."""
        stop = index
        while stop < len(items) and not items[stop].type.endswith("_FORM"):
            stop += 1
        start, end = items[index].start, items[stop - 1].end
        self.report(
            start,
            end,
            "LRP105",
            "This stands outside every form; put it into one, or behind `;` as a comment.",
        )
        del items[index:stop]

    def _mistaken(self, frame: _Frame, types: tuple[str, ...], mistake: Mistake, end: int) -> None:
        index, expected = mistake
        what = expected_text(frame.keyword, types[:index], expected)
        usage = f"write `{USAGE[frame.keyword]}`"
        if index < len(frame.items):
            start, stop = frame.items[index].start, frame.items[index].end
            found = self.text[start:stop].split("\n")[0]
            found = found if len(found) < 30 else found[:27] + "…"
            self.report(start, stop, "LRP108", f"Expected {what} instead of `{found}`; {usage}.")
        else:
            message = f"`{frame.keyword}` lacks {what} here; {usage}."
            self.report(end - 1, end, "LRP108", message)

    # Nodes

    def _node(self, frame: _Frame, shape: Shape | None, span: Span) -> Node | None:
        items = frame.items
        keyword = frame.keyword
        if shape is not None:
            return self._transition(keyword, items, shape, span)
        nodes = [item.node for item in items[1:]]
        if keyword == "state":
            return self._state(items, span)
        if keyword == "machine":
            return self._machine(frame, span)
        if keyword == "var":
            self._filled(items[3], "the variable's value")
            name = items[1].node
            if iskeyword(str(name)) or name == "__debug__":
                message = f"`{name}` is a word of Python; give the variable another name."
                self.report(items[1].start, items[1].end, "LRP110", message)
            return Variable(name, items[3].node, span)  # type: ignore[arg-type]
        if keyword == "event":
            self._filled(items[2], "the event's condition")
            return Event(nodes[0], nodes[1], span)  # type: ignore[arg-type]
        if keyword == "spawn":
            return Spawn(nodes[0], nodes[1], span)  # type: ignore[arg-type]
        return _Actions(tuple(nodes))  # type: ignore[arg-type]

    def _filled(self, item: _Item, what: str) -> None:
        if isinstance(item.node, Block) and blocks.facts_of(item.node.text).empty:
            self.report(item.start, item.end, "LRP109", f"This block is empty; write {what} into it.")

    def _transition(self, kind: str, items: list[_Item], shape: Shape, span: Span) -> Transition:
        trigger = None
        if shape.trigger is not None:
            trigger = items[shape.trigger].node
            self._filled(
                items[shape.trigger], "the delay in milliseconds" if kind == "ontime" else "the condition"
            )
        if kind == "eps" and shape.source == "every":
            message = "`eps` cannot leave every state: it would fire at every tick; name its sources, as in `eps {a b} -> c`."
            star = next(item for item in items if item.type == "STAR")
            self.report(star.start, star.end, "LRP112", message)
        return Transition(
            kind,  # type: ignore[arg-type]
            trigger,  # type: ignore[arg-type]
            tuple([items[index].node for index in shape.sources]),  # type: ignore[misc]
            shape.source in ("every", "but"),
            items[shape.destination].node,  # type: ignore[arg-type]
            None if shape.name is None else items[shape.name].node,  # type: ignore[arg-type]
            span,
        )

    def _state(self, items: list[_Item], span: Span) -> State:
        actions: dict[str, tuple[Block | Spawn, ...]] = {
            "ONENTRY_FORM": (),
            "RUNNING_FORM": (),
            "ONEXIT_FORM": (),
        }
        machines = []
        for kind, _, _, node in items[2:]:
            if kind == "MACHINE_FORM":
                machines.append(node)
            elif isinstance(node, _Actions):
                actions[kind] += node.items
        return State(items[1].node, *actions.values(), tuple(machines), span)  # type: ignore[arg-type]

    def _machine(self, frame: _Frame, span: Span) -> Machine:
        parts = _parts(frame.items[2:])
        self._declared(frame, parts["VAR_FORM"])
        transitions = [
            item.node
            for item in frame.items
            if item.type in ("ON_FORM", "ONTIME_FORM", "EPS_FORM", "EXIT_FORM")
        ]
        return Machine(
            frame.items[1].node,  # type: ignore[arg-type]
            parts["VAR_FORM"],
            parts["EVENT_FORM"],
            parts["STATE_FORM"],
            tuple(transitions),  # type: ignore[arg-type]
            span,
        )

    def _program(self, frame: _Frame) -> Program:
        self._shape(frame, len(self.text))
        parts = _parts(frame.items)
        self._declared(frame, parts["VAR_FORM"])
        pauses: dict[str, tuple[Block, ...]] = {}
        for kind in ("ONPAUSE_FORM", "ONRESUME_FORM"):
            pauses[kind] = tuple(block for node in parts[kind] if node is not None for block in node.items)
        return Program(
            parts["VAR_FORM"],
            parts["EVENT_FORM"],
            parts["MACHINE_FORM"],
            parts["SPAWN_FORM"],
            pauses["ONPAUSE_FORM"],
            pauses["ONRESUME_FORM"],
            self.text,
            self.filename,
        )

    def _declared(self, frame: _Frame, variables: tuple[Variable | None, ...]) -> None:
        """Report the blocks that declare one of these variables `global`."""
        names = {variable.name for variable in variables if variable}
        for span, name in frame.declared:
            if name in names:
                message = (
                    f"`{name}` is a variable of the program, not a global of Python; remove this `global`."
                )
                self.report(*span, "LRP501", message)


class _Actions(NamedTuple):
    """What an action form holds; the forms of a state with the same keyword add up."""

    items: tuple[Block | Spawn, ...]


def _parts(items: list[_Item]) -> dict[str, Any]:
    parts: dict[str, list[Any]] = defaultdict(list)
    for item in items:
        parts[item.type].append(item.node)
    return defaultdict(tuple, {kind: tuple(nodes) for kind, nodes in parts.items()})


def _either(words: Iterable[str]) -> str:
    *head, last = [f"`{word}`" for word in sorted(words)]
    return f"{', '.join(head)} or {last}" if head else last
