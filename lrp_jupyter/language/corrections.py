"""Corrections of a text that is spelt in ways of other languages, or has a slip of the pen.

A text that is not a program is read once more, token by token, with regard to the form around each of them.
Where it is clear what was meant (``=`` for ``:=``, ``(State``, ``2s``, ``//`` before a comment, Python in the
wrong brackets), the text is corrected, and the parser reads the corrected text. So one mistake is one error,
and what would follow from it is not reported. Where a correction is certain, it is that error's fix.
"""

from __future__ import annotations

import builtins
import re
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Iterable
from difflib import get_close_matches
from keyword import iskeyword, kwlist
from typing import NamedTuple

from lrp_jupyter.errors import Edit
from lrp_jupyter.language.blocks import facts_of
from lrp_jupyter.language.forms import USAGE, Mistake, Shape, shape_of, short
from lrp_jupyter.language.scanner import block_end, brackets, line_end
from lrp_jupyter.language.source import Diagnosis
from lrp_jupyter.language.tokens import FORM_LINE, KEYWORDS, LEGAL, Token, keyword_of, tokenize
from lrp_jupyter.language.triggers import FORMS

__all__ = ["Corrected", "correct", "is_form"]

_ACTIONS = frozenset({"onentry", "running", "onexit", "onpause", "onresume"})
_OTHERS: dict[str, tuple[str, ...]] = {
    word: tuple(meant.split())
    for meant, words in {
        "var": "let variable const def define set int float global param parameter constant assign",
        "event": "condition trigger sensor guard signal",
        "machine": "statemachine fsm automaton sm",
        "state": "node mode",
        "spawn": "launch instantiate",
        "onentry": "entry enter onenter onstart init entryaction",
        "onexit": "leave onleave exitaction",
        "running": "doactivity during always whilerunning action",
        "ontime": "after timeout wait delay timer ontimeout every sleep timed",
        "onpause": "pause",
        "onresume": "resume",
        "eps": "epsilon immediate",
        "exit": "return break",
        "on eps": "transition trans goto arrow edge go move",
        "on": "when if event",
        "spawn onentry": "start begin",
        "spawn running": "run loop do execute while",
        "onexit exit": "end finish stop",
    }.items()
    for word in words.split()
}
"""What keywords of other languages are called here, by the words without `_` and capitals."""
_MODULES = frozenset({"import", "export", "from", "include", "require", "use", "using", "module"})
_FOLLOWERS = {"onentry": ("entry", "enter", "start"), "onexit": ("exit", "leave", "end"), "ontime": ("time",)}
_FOLLOWERS |= {"onpause": ("pause",), "onresume": ("resume",)}
_ARROWS = "→⇒⟶⟹➔➜➝➞←⇐"
_SIGN = re.compile(rf"[=:<>~\-{_ARROWS}]+")
_ARROW_WORDS = frozenset({"to", "into", "then", "goto", "zu", "nach"})
_ASSIGN_WORDS = frozenset({"is", "be", "equals", "becomes", "to"})
_UNITS = {
    "ms": 1,
    "msec": 1,
    "msecs": 1,
    "millis": 1,
    "milliseconds": 1,
    "millisecond": 1,
    "s": 1000,
    "sec": 1000,
    "secs": 1000,
    "second": 1000,
    "seconds": 1000,
    "min": 60_000,
    "minute": 60_000,
    "minutes": 60_000,
    "": 0,
}
_AMOUNT = re.compile(r"([0-9][0-9_]*(?:\.[0-9]*)?(?:[eE][0-9]+)?)([a-zA-Z]*)")
_WORDS = re.compile(r"[^\W\d]\w*(?:\s+[^\W\d]\w*)*")


class Corrected(NamedTuple):
    """A corrected text, the errors of the original, and the way back.

    Parameters
    ----------
    text : str
    found : list of Diagnosis
        At offsets of the original text, as are their edits.
    moved : callable
        Returns an error of the corrected text with its offsets in the original.
    """

    text: str
    found: list[Diagnosis]
    moved: Callable[[Diagnosis], Diagnosis]


def correct(text: str) -> Corrected:
    """Correct what is clear in a text that is not a program."""
    origin: Callable[[int], int] = _same
    found: list[Diagnosis] = []
    for _ in range(_ROUNDS):  # what one round corrects may have hidden something else
        walk = _Walk(text)
        walk.run()
        if not walk.edits:
            break
        found += [_moved(diagnosis, origin) for diagnosis in walk.found]
        text, back = _applied(text, walk.edits)
        origin = _chained(origin, back)
    return Corrected(text, found, lambda diagnosis: _moved(diagnosis, origin))


_ROUNDS = 3


def _same(offset: int) -> int:
    return offset


def _chained(first: Callable[[int], int], second: Callable[[int], int]) -> Callable[[int], int]:
    return lambda offset: first(second(offset))


def _moved(diagnosis: Diagnosis, origin: Callable[[int], int]) -> Diagnosis:
    edits = tuple(Edit(origin(start), origin(end), new) for start, end, new in diagnosis.edits)
    start, end = origin(diagnosis.start), origin(diagnosis.end)
    return diagnosis._replace(start=start, end=max(start, end), edits=edits)


def _applied(text: str, edits: list[Edit]) -> tuple[str, Callable[[int], int]]:
    """Apply edits that do not overlap; return the text, and the map of its offsets back."""
    pieces = []
    olds, news = [0], [0]
    position = length = 0
    for start, end, new in sorted(edits):
        if start < position:
            continue
        pieces += [text[position:start], new]
        length += start - position + len(new)
        position = end
        news += [length - len(new), length]
        olds += [start, end]
    pieces.append(text[position:])

    def back(offset: int) -> int:
        at = bisect_right(news, offset) - 1
        if at % 2:  # in the new text of an edit
            return min(olds[at] + offset - news[at], olds[at + 1])
        return olds[at] + offset - news[at]

    return "".join(pieces), back


class _Item(NamedTuple):
    """A part of a form: its type, ``text[start:end]``, and the keyword of a nested form."""

    kind: str
    start: int
    end: int
    keyword: str = ""


class _Frame:
    """A form being read."""

    __slots__ = ("commas", "items", "keyword", "start")

    def __init__(self, keyword: str, start: int) -> None:
        self.keyword = keyword
        self.start = start
        self.items: list[_Item] = []
        self.commas: list[Edit] = []

    @property
    def types(self) -> tuple[str, ...]:
        """The types of its first parts: more than any form that can be corrected has."""
        return tuple([item.kind for item in self.items[:_LONGEST]])


class _Walk:
    """One reading of a text; `edits` correct it, `found` are the errors."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.tokens = tokenize(text)
        self.starts = [token[1] for token in self.tokens]
        kinds = [token[0] for token in self.tokens]
        self.missing = kinds.count("OPEN") - kinds.count("CLOSE")  # number of `)`
        self.names: dict[str, int] = {}
        self.events: set[str] = set()
        self.states: set[str] = set()
        for index, (kind, start, end) in enumerate(self.tokens):
            if kind == "NAME":
                name = text[start:end]
                self.names[name] = self.names.get(name, 0) + 1
                if index and self.tokens[index - 1][0] == "OPEN":
                    keyword = keyword_of(text, self.tokens[index - 1]).lower()
                    if keyword == "event":
                        self.events.add(name)
                    elif keyword == "state":
                        self.states.add(name)
        self.frames = [_Frame("program", 0)]
        self.edits: list[Edit] = []
        self.found: list[Diagnosis] = []
        self.misspelt: set[str] = set()

    def run(self) -> None:
        """Read all tokens."""
        index = 0
        while index < len(self.tokens):
            index = self._token(index)
        for frame in self.frames:
            self._commas(frame)

    # Helpers

    def _add(self, start: int, end: int, code: str, message: str, *edits: Edit, certain: bool = True) -> None:
        """Register an error and the edits that correct it; they are its fix if they are certain."""
        self.found.append(Diagnosis(start, end, code, message, edits if certain else ()))
        self.edits += edits

    def _after(self, offset: int) -> int:
        """Return the index of the first token from an offset on."""
        return bisect_left(self.starts, offset)

    def _word(self, token: Token | _Item) -> str:
        return self.text[token[1] : token[2]]

    def _kind(self, index: int) -> str:
        return self.tokens[index][0] if index < len(self.tokens) else ""

    def _rest(self, index: int) -> list[Token]:
        """Return the tokens of the form up to its `)` or the next form."""
        rest = []
        for token in self.tokens[index : index + 12]:
            if token[0] in ("OPEN", "CLOSE"):
                break
            rest.append(token)
        return rest

    # Tokens

    def _token(self, index: int) -> int:
        kind, start, end = self.tokens[index]
        frame = self.frames[-1]
        if kind == "OPEN":
            return self._open(index)
        if kind == "CLOSE":
            if len(self.frames) > 1:
                self._close(end)
            return index + 1
        if kind == "COMMENT":
            return self._comment(index)
        if kind == "UNCLOSED":
            return self._unclosed(index)
        if kind == "BLOCK":
            return self._block(index)
        if self._lost(index, frame):
            return index + 1
        python = kind != "UNOPENED" and self._python(index, frame)
        if python:
            return python
        if kind in ("NAME", "INTEGER", "QUOTED"):
            return self._name(index, frame)
        if kind == "LBRACE":
            return self._braces(index, frame)
        if kind in ("ARROW", "ASSIGN", "MINUS") or _SIGN.match(self.text, start):
            return self._sign(index, frame)
        if kind == "STRAY" and self.text[start] == ",":
            frame.commas.append(Edit(start, end, "" if self._spaced(end) else " "))
            return index + 1
        if kind == "STRAY" and self.text[start] == "]" and self.missing > 0 and self._complete(frame):
            message = "This form ends with `)`, not with `]`. Write `)`."
            self._add(start, end, "LRP104", message, Edit(start, end, ")"))
            self.missing -= 1
            self._close(end)
            return index + 1
        if kind == "STRAY":
            return self._stray(index)
        frame.items.append(_Item("BLOCK" if kind == "UNOPENED" else kind, start, end))
        return index + 1

    def _spaced(self, offset: int) -> bool:
        return not self.text[offset : offset + 1].strip() or self.text[offset] in ")]}"

    def _complete(self, frame: _Frame) -> bool:
        if frame.keyword not in KEYWORDS:
            return False
        types = (frame.keyword.upper(), *frame.types)
        return not isinstance(shape_of(types), Mistake)

    def _stray(self, index: int) -> int:
        """Report characters that mean nothing, one error for those in a row."""
        last = index
        while last + 1 < len(self.tokens) and self._kind(last + 1) == "STRAY":
            if self.text[self.tokens[last + 1][1]] == "]":
                break
            last += 1
        start, end = self.tokens[index][1], self.tokens[last][2]
        word = short(self.text[start : min(end, start + 40)])
        message = f"`{word}` is not part of the language. Remove it."
        if word == "]":
            message = "Unmatched `]`: there is no open block here. Remove it."
        self._add(start, end, "LRP104", message, Edit(start, end, ""))
        return last + 1

    def _comment(self, index: int) -> int:
        """Turn a comment of another language into one with `;`."""
        _, start, end = self.tokens[index]
        word = self.text[start:end]
        sign = word[:2]
        message = f"A comment begins with `;` here, not with `{sign}`. Write `;`."
        if sign != "/*":
            self._add(start, end, "LRP114", message, Edit(start, start + 2, ";"))
            return index + 1
        edits = [Edit(start, start + 2, ";")]
        if word.endswith("*/") and len(word) > 3:
            after = self.text[end : line_end(self.text, end)]
            edits.append(Edit(end - 2, end, "" if not after.strip() else "\n"))
            word = word[:-2]
        edits += [Edit(start + line.end(), start + line.end(), "; ") for line in _LINE_END.finditer(word)]
        self._add(start, end, "LRP114", message, *edits)
        return index + 1

    # Forms

    def _open(self, index: int) -> int:
        token = self.tokens[index]
        _, start, end = token
        frame = self.frames[-1]
        word = keyword_of(self.text, token)
        follower = self._follower(index, word)
        if word in KEYWORDS and not follower:
            self.frames.append(_Frame(word, start))
            return index + 1
        python = self._parenthesised(index, frame)
        if python:
            return python
        if not word and self._kind(index + 1) == "OPEN":
            return self._doubled(index)
        if word in _MODULES and frame.keyword == "program":
            return self._module(index)
        if follower:
            last = self._after(follower[1])
            self._keyword(end - len(word), self.tokens[last - 1][2], follower[0], start)
            return last
        meant, certain = self._meant(index, word, frame.keyword)
        if meant:
            self._keyword(end - len(word), end, meant, start, certain)
            return index + 1
        inferred = self._inferred(index, word, frame.keyword)
        if inferred:
            message = f"The keyword is missing after this `(`. Write `{USAGE[inferred]}`."
            self._add(start, start + 1, "LRP106", message, Edit(start + 1, start + 1, f"{inferred} "))
            self.frames.append(_Frame(inferred, start))
            if word:
                self.frames[-1].items.append(_Item("NAME", end - len(word), end))
            return index + 1
        self.frames.append(_Frame(word, start))
        return index + 1

    def _keyword(self, start: int, end: int, meant: str, opened: int, certain: bool = True) -> None:
        word = self.text[start:end]
        what = f"`{word}` is not a keyword"
        if word.lower() == meant:
            what = "Keywords are written in small letters"
        remedy = f"Write `{meant}`" if word.lower() == meant or not certain else f"Did you mean `{meant}`?"
        message = f"{what}. {remedy.rstrip('.')}" + ("" if remedy.endswith("?") else ".")
        self._add(start, end, "LRP106", message, Edit(start, end, meant), certain=certain)
        if any(keyword.startswith(word) for keyword in KEYWORDS):
            self.found[-1] = self.found[-1]._replace(prefix=True)
        self.frames.append(_Frame(meant, opened))

    def _follower(self, index: int, word: str) -> tuple[str, int] | None:
        """Return the keyword meant by two words, as in ``(on entry […])``, and the offset after them."""
        if word.lower() not in ("on", "state"):
            return None
        joined = self._word(self.tokens[index + 1]) in ("-", ".") if self._kind(index + 1) else False
        second = index + 1 + joined
        if self._kind(second) != "NAME":
            return None
        name, after = self._word(self.tokens[second]).lower(), self._kind(second + 1)
        if word == "state":
            meant = "machine" if name == "machine" and after == "NAME" else ""
        else:
            meant = next((meant for meant, words in _FOLLOWERS.items() if name in words), "")
            timed = after == "INTEGER" or (joined and after == "NAME")
            if not (timed if meant == "ontime" else after in ("BLOCK", "OPEN", "UNCLOSED")):
                meant = ""
        return (meant, self.tokens[second][2]) if meant else None

    def _meant(self, index: int, word: str, around: str) -> tuple[str, bool]:
        """Return the keyword that a word probably stands for, and whether that is certain."""
        if not word:
            return "", False
        legal = sorted(LEGAL.get(around, KEYWORDS))
        plain = word.lower().replace("_", "")
        if plain in KEYWORDS:
            return plain, True
        meant = [keyword for keyword in _OTHERS.get(plain, ()) if keyword in legal]
        if len(meant) > 1 or (meant and meant[0] in FORMS):
            meant = [self._kind_of_transition(index, meant)]
        inferred = self._inferred(index, word, around)
        close = _closest(plain, legal, 0.6) or _closest(plain, KEYWORDS, 0.8)
        for keyword in (*meant[:1], close):
            if keyword and not (inferred and isinstance(self._shape(keyword, index), Mistake)):
                return keyword, True
        if inferred:
            return "", False
        other = next(iter(_OTHERS.get(plain, ())), "")
        return other, False

    def _kind_of_transition(self, index: int, meant: list[str]) -> str:
        """Return which of several keywords fits the rest of a form."""
        rest = self._rest(index + 1)
        if meant[0] not in FORMS or not rest:
            return meant[0]
        if rest[0][0] == "INTEGER":
            return "ontime"
        arrow = next((at for at, token in enumerate(rest) if token[0] == "ARROW"), None)
        return "eps" if arrow == 1 or rest[0][0] == "LBRACE" else meant[0]

    def _types(self, index: int) -> tuple[str, ...]:
        """Return the types of the parts from a token on, up to the `)` of their form."""
        types = []
        depth = 0
        for at in range(index, len(self.tokens)):
            kind = self.tokens[at][0]
            if kind == "CLOSE":
                if not depth:
                    break
                depth -= 1
            elif kind == "OPEN":
                if not depth:
                    types.append(f"{keyword_of(self.text, self.tokens[at]).upper()}_FORM")
                depth += 1
            elif not depth:
                types.append(kind)
            if len(types) > _LONGEST:
                break
        return tuple(types)

    def _shape(self, keyword: str, index: int) -> Shape | Mistake | None:
        """Return the shape of the form that begins with a token, with another keyword."""
        return shape_of((keyword.upper(), *self._types(index + 1)))

    def _inferred(self, index: int, word: str, around: str) -> str:
        """Return the only keyword with which a form without one would be right; else an empty text."""
        types = (*(["NAME"] if word else []), *self._types(index + 1))
        if len(types) < (1 if around == "machine" else 2):
            return ""
        found = [
            keyword
            for keyword in sorted(LEGAL.get(around, ()))
            if not isinstance(shape_of((keyword.upper(), *types)), Mistake)
        ]
        if "machine" in found and "STATE_FORM" not in types:
            found.remove("machine")
        if "on" in found and types[0] != "INTEGER":
            return "on"
        return found[0] if len(found) == 1 else ""

    def _lost(self, index: int, frame: _Frame) -> bool:
        """Insert the `(` that is missing before a keyword; return whether it is."""
        kind, start, end = self.tokens[index]
        word = self.text[start:end]
        if self.missing >= 0 or kind != "NAME" or word not in LEGAL.get(frame.keyword, ()):
            return False
        if frame.keyword in ("machine", "state") and not frame.items:
            return False
        if isinstance(shape_of((word.upper(), *self._types(index + 1))), Mistake):
            return False
        self.missing += 1
        message = f"A `(` is missing before `{word}`. Insert it."
        self._add(start, end, "LRP101", message, Edit(start, start, "("))
        self.frames.append(_Frame(word, start))
        return True

    def _doubled(self, index: int) -> int:
        """Remove a `(` before another one, with its `)` if it has one."""
        _, start, end = self.tokens[index]
        end = start + 1
        message = "This `(` is one too many. Remove it."
        if self.missing > 0:
            self.missing -= 1
            self._add(start, end, "LRP102", message, Edit(start, end, ""))
            return index + 1
        depth = 0
        for kind, first, last in self.tokens[index:]:
            depth += (kind == "OPEN") - (kind == "CLOSE")
            if not depth:
                edits = Edit(start, end, ""), Edit(first, last, "")
                self._add(start, end, "LRP102", "These brackets are doubled. Remove one pair.", *edits)
                self.frames.append(_Frame("()", start))
                return index + 1
        return index + 1

    def _module(self, index: int) -> int:
        """Remove a form that imports or exports."""
        _, start, end = self.tokens[index]
        close = next((token for token in self.tokens[index:] if token[0] == "CLOSE"), None)
        end = close[2] if close else end
        word = self.text[start + 1 : end].split()[0]
        remedy = "Copy what you need into this text" if word != "export" else "Everything is visible already"
        message = (
            f"LRP has no modules: a program is one text. {remedy}, and remove this `{word.rstrip(')')}`."
        )
        self._add(start, end, "LRP113", message, Edit(start, end, ""))
        return self._after(end)

    def _close(self, end: int) -> None:
        frame = self.frames.pop()
        self._commas(frame)
        if frame.keyword == "()":  # a doubled bracket, removed
            self.frames[-1].items += frame.items
            return
        if frame.keyword in FORMS:
            self._transition(frame)
        elif frame.keyword in ("var", "event", "spawn"):
            self._definition(frame)
        elif frame.keyword in ("state", "machine"):
            self._container(frame)
        if frame.keyword in KEYWORDS:
            kind = f"{frame.keyword.upper()}_FORM"
            self.frames[-1].items.append(_Item(kind, frame.start, end, frame.keyword))

    def _commas(self, frame: _Frame) -> None:
        if frame.commas:
            start, end, _ = frame.commas[0]
            message = "Parts are separated by spaces, not by commas. Remove the comma."
            if len(frame.commas) > 1:
                message = message.replace("the comma.", "the commas.")
            self._add(start, end, "LRP104", message, *frame.commas)

    # Python in the wrong brackets, or in none

    def _wants(self, frame: _Frame) -> bool:
        """Return whether a block could be next in a form."""
        types = frame.types
        if frame.keyword == "var":
            return types in (("NAME", "ASSIGN"), ("NAME", "SIGN"), ("NAME",))
        if frame.keyword == "event":
            return types in (("NAME",), ("NAME", "ASSIGN"), ("NAME", "SIGN"))
        return frame.keyword in _ACTIONS or (frame.keyword in ("on", "exit", "ontime") and not types)

    def _end_of_python(self, start: int) -> int:
        """Return the offset of the bracket that closes what is around Python from an offset on; or -1."""
        form = FORM_LINE.search(self.text, start)
        opened = 0
        for offset, char in brackets(self.text, start, form.start() if form else None):
            if char in "([{":
                opened += 1
            elif char in ")]}":
                if not opened:
                    return offset
                opened -= 1
            else:
                return -1
        return -1

    def _parenthesised(self, index: int, frame: _Frame) -> int:
        """Put Python in round brackets into square ones; return the index after it, or 0."""
        start = self.tokens[index][1]
        if not self._wants(frame):
            return 0
        close = self._end_of_python(start + 1)
        if close < 0 or self.text[close] != ")" or not _is_python(self.text[start + 1 : close]):
            return 0
        after = self._after(close + 1)
        if frame.keyword in ("var", "event") and self._kind(after) != "CLOSE":
            return self._bare(start, frame)
        self._wrong_brackets(start, close, "( )")
        frame.items.append(_Item("BLOCK", start, close + 1))
        return after

    def _wrong_brackets(self, start: int, close: int, which: str) -> None:
        message = f"Python stands in square brackets, not in `{which}`. Write `[…]` here."
        self._add(
            start, close + 1, "LRP115", message, Edit(start, start + 1, "["), Edit(close, close + 1, "]")
        )

    def _bare(self, start: int, frame: _Frame) -> int:
        """Put Python from here to the end of the form into brackets; return the index after it, or 0."""
        end = self._end_of_python(start)
        python = self.text[start:end].rstrip() if end > 0 else ""
        if end < 0 or self.text[end] != ")" or not _is_python(python):
            return 0
        self._unbracketed(start, start + len(python))
        frame.items.append(_Item("BLOCK", start, start + len(python)))
        return self._after(end)

    def _unbracketed(self, start: int, end: int) -> None:
        message = "Python stands in square brackets. Write `[…]` around this."
        self._add(start, end, "LRP115", message, Edit(start, start, "["), Edit(end, end, "]"))

    def _python(self, index: int, frame: _Frame) -> int:
        """Correct Python that has braces or no brackets; return the index after it, or 0."""
        kind, start, _ = self.tokens[index]
        if not self._wants(frame) or kind in ("BLOCK", "OTHER"):
            return 0
        if _SIGN.match(self.text, start) and kind != "MINUS":
            return 0
        if kind == "LBRACE":
            close = self._end_of_python(start + 1)
            inside = self.text[start + 1 : close] if close > 0 else ""
            names = _WORDS.fullmatch(inside.strip())
            if (
                close < 0
                or self.text[close] != "}"
                or (names and frame.keyword in FORMS and not iskeyword(names[0]))
            ):
                return 0
            if _is_python(inside) and not (frame.keyword == "var" and set(inside) & set(":,")):
                self._wrong_brackets(start, close, "{ }")
                frame.items.append(_Item("BLOCK", start, close + 1))
                return self._after(close + 1)
        if frame.keyword in FORMS:
            return self._bare_condition(index, frame)
        if frame.keyword == "var" and frame.types == ("NAME",) and kind == "NAME":
            return 0  # `(var x is 5)` and `(var max speed := [1])`
        if frame.keyword == "event" and kind == "NAME" and self._kind(index + 1) == "BLOCK":
            return 0
        return self._bare(start, frame)

    def _bare_condition(self, index: int, frame: _Frame) -> int:
        """Put the condition of a transition into brackets; return the index after it, or 0."""
        arrow = index
        while self._kind(arrow) not in ("ARROW", ""):
            if self._kind(arrow) == "CLOSE" and arrow > index + 12:
                return 0
            arrow += 1
        source = arrow - 1
        if self._kind(source) == "RBRACE":
            while source > index and self._kind(source) != "LBRACE":
                source -= 1
            if self._kind(source - 1) == "MINUS" and self._kind(source - 2) == "STAR":
                source -= 2
        if source <= index + 1 or self._kind(source) not in ("NAME", "STAR", "LBRACE"):
            return 0
        start, end = self.tokens[index][1], self.tokens[source - 1][2]
        python = self.text[start:end]
        if not _is_python(python) or _AMOUNT.fullmatch(python) or python.endswith(",") or "\n" in python:
            return 0
        self._unbracketed(start, end)
        frame.items.append(_Item("BLOCK", start, end))
        return source

    # Blocks

    def _block(self, index: int) -> int:
        _, start, end = self.tokens[index]
        frame = self.frames[-1]
        inside = self.text[start + 1 : end - 1]
        keyword = is_form(inside, frame.keyword)
        if keyword:
            self._form(start, end, keyword)
            return index + 1
        if frame.keyword in ("machine", "state", "spawn") and not (frame.keyword != "spawn" and frame.items):
            name = _WORDS.fullmatch(inside.strip())
            if name and " " not in name[0]:
                return self._unwrapped(start, end, inside.strip(), frame, index + 1)
        if self.missing > 0 and inside.rstrip().endswith(")") and not facts_of(inside).valid:
            shorter = inside.rstrip()[:-1]
            if _is_python(shorter):
                at = start + 1 + len(shorter)
                message = "The block ends before the form: `]` comes before `)`. Swap them."
                self._add(at, end, "LRP103", message, Edit(at, end, "])"))
                self.missing -= 1
                frame.items.append(_Item("BLOCK", start, at))
                self._close(end)
                return index + 1
        frame.items.append(_Item("BLOCK", start, end))
        return index + 1

    def _unclosed(self, index: int) -> int:
        """Close a block whose `]` is missing, or hidden by a comment or a string."""
        _, start, end = self.tokens[index]
        frame = self.frames[-1]
        form = FORM_LINE.search(self.text, start)
        self._find_end(start, end, form.start() if form else len(self.text), frame)
        frame.items.append(_Item("BLOCK", start, end))
        return index + 1

    def _find_end(self, start: int, end: int, stop: int, frame: _Frame) -> None:
        opened = 0
        for offset, char in brackets(self.text, start, stop):
            if char == "#":
                if self._hidden_by_comment(offset):
                    return
            elif char == '"':
                if self._hidden_by_string(start, offset, stop):
                    return
            elif char in "([{":
                opened += 1
            elif char == ")" and opened == 1:
                break
            else:
                opened -= 1
        self._missing_end(start, end, frame)

    def _missing_end(self, start: int, end: int, frame: _Frame) -> None:
        """Report the missing `]` of a block, if its place is certain; else the parser does."""
        inside = self.text[start + 1 : end].strip()
        if inside.startswith("["):
            inner = block_end(inside, 0)
            is_list = inner != len(inside) - 1 or not inside.strip("[] ") or "," in inside
            if inner > 0 and not (frame.keyword == "var" and is_list):
                message = "This `[` is one too many. Remove it."
                self._add(start, start + 1, "LRP103", message, Edit(start, start + 1, ""))
                return
        source = _SOURCE.search(self.text, start, end) if frame.keyword in FORMS else None
        if source and _is_python(self.text[start + 1 : source.start()]):
            end = source.start()
        closes = block_end(f"{self.text[start:end]}]", 0) == end - start
        if closes and (source or self.text[end : end + 1] == ")"):
            message = "This `[` is not closed. Put its `]` after the Python that it opens."
            self._add(start, start + 1, "LRP103", message, Edit(end, end, "]"))

    def _hidden_by_comment(self, offset: int) -> bool:
        """Move a comment that hides a `]` to the end of its line; return whether it does."""
        stop = line_end(self.text, offset)
        depth = 0
        for at in range(offset, stop):
            depth += (self.text[at] == "[") - (self.text[at] == "]")
            if depth < 0:
                break
        else:
            return False
        before = len(self.text[:offset].rstrip(" \t"))
        comment = self.text[offset:at].rstrip()
        message = "This comment hides the `]` after it. Put the `]` before the `#`."
        self._add(offset, stop, "LRP116", message, Edit(before, at, ""), Edit(stop, stop, f"  {comment}"))
        return True

    def _hidden_by_string(self, start: int, offset: int, stop: int) -> bool:
        """Close a string that ends with its line and hides a `]`; return whether it is clear where."""
        quote = self.text[offset]
        last = line_end(self.text, offset)
        known = self._known()
        found = []
        for at in range(offset + 1, min(last, offset + _LONGEST_STRING)):
            if self.text[at] in ")]},;:":
                closed = self.text[start:at] + quote + self.text[at:stop]
                end = block_end(closed, 0)
                words = _LOADED.findall(closed[at - start + 1 : end])
                if end > 0 and known.issuperset(words) and _is_python(closed[1:end]):
                    found.append(at)
        if not found:
            return False
        sensible = [at for at in found if _is_balanced(self.text[offset + 1 : at])] or found
        message = f"This string is not closed. Write `{quote}` at its end."
        edit = Edit(sensible[-1], sensible[-1], quote)
        self._add(offset, line_end(self.text, offset), "LRP514", message, edit, certain=len(sensible) == 1)
        return True

    def _known(self) -> set[str]:
        """Return the names that are used anywhere in the text, and Python's own."""
        words = {
            word for token in self.tokens if token[0] == "BLOCK" for word in _WORD.findall(self._word(token))
        }
        return words | set(self.names) | set(kwlist) | set(dir(builtins)) | {"robot"}

    # Names and signs

    def _name(self, index: int, frame: _Frame) -> int:
        """Read a name with what touches it: ``have-rest``, ``2fast``, ``a!``, ``"a"``, ``500 ms``."""
        kind, start, end = self.tokens[index]
        if kind == "INTEGER" and frame.keyword == "ontime" and not frame.items:
            return self._delay(index, frame)
        last = index
        while last + 1 < len(self.tokens) and self.tokens[last + 1][1] == end:
            following, _, next_end = self.tokens[last + 1]
            word = self._word(self.tokens[last + 1])
            joins = following in ("NAME", "INTEGER") or (
                following == "STRAY" and word in "!?.$%&@|'\"`^~+/\\"
            )
            if following == "STRAY" and word == ":" and frame.keyword not in ("var", "event"):
                joins = not frame.items
            if following == "MINUS":
                joins = self._kind(last + 2) in ("NAME", "INTEGER") and (
                    self.tokens[last + 2][1] == next_end and not self._lacks_arrow(last + 1, frame)
                )
            if not joins or kind == "QUOTED":
                break
            last, end = last + 1, next_end
        word = self.text[start:end]
        arrow = re.search(f"[{_ARROWS}]+", word)
        if arrow and kind == "NAME":
            return self._pointed(index, last, frame, arrow)
        if kind == "NAME" and last == index and (word.isascii() or word.isidentifier()):
            frame.items.append(_Item("NAME", start, end))
            return index + 1
        if kind == "QUOTED":
            word = word[1:-1].strip()
        self._misspelt(start, end, word, kind, frame)
        return last + 1

    def _misspelt(self, start: int, end: int, word: str, kind: str, frame: _Frame) -> None:
        """Correct a name that is not one, wherever it is written in this way."""
        frame.items.append(_Item("NAME", start, end))
        written = self.text[start:end]
        name = self._valid(word)
        if not name or (
            kind == "INTEGER" and word.isdecimal() and frame.keyword in KEYWORDS - {"state", "machine"}
        ):
            frame.items[-1] = _Item(kind if kind != "QUOTED" else "NAME", start, end)
            return
        if kind == "QUOTED":
            message = f"Names have no quotation marks. Write `{name}`."
        elif word[0].isdigit():
            message = f"A name begins with a letter or `_`. Write `{name}`."
        else:
            message = f"A name has letters, digits and `_`. Write `{name}`."
        edit = Edit(start, end, name)
        if written in self.misspelt:  # reported where it is first
            self.edits.append(edit)
            for at, found in enumerate(self.found):
                if found.code == "LRP110" and self.text[found.start : found.end] == written:
                    self.found[at] = found._replace(edits=(*found.edits, edit))
                    return
        self.misspelt.add(written)
        self._add(start, end, "LRP110", message, edit)

    def _valid(self, word: str) -> str:
        """Return the valid name that is most like a word; empty if there is none."""
        name = re.sub(r"\W+", "_", word).strip("_") if not word.isidentifier() else word
        if name[:1].isdigit():
            digits = re.match(r"\d+", name)[0]  # type: ignore[index]
            rest = name[len(digits) :].strip("_")
            name = rest if rest in self.names else f"{rest}{digits}" if rest else ""
        return name if name.isidentifier() and not iskeyword(name) else ""

    def _lacks_arrow(self, minus: int, frame: _Frame) -> bool:
        """Return whether a `-` in a transition must be its arrow."""
        if frame.keyword not in FORMS or "ARROW" in frame.types or "SIGN" in frame.types:
            return False
        return not any(token[0] == "ARROW" for token in self._rest(minus + 1))

    def _pointed(self, index: int, last: int, frame: _Frame, arrow: re.Match[str]) -> int:
        """Read a word that contains an arrow of Unicode."""
        start = self.tokens[index][1]
        if arrow.start():
            frame.items.append(_Item("NAME", start, start + arrow.start()))
        begin, end = start + arrow.start(), start + arrow.end()
        frame.items.append(_Item("SIGN", begin, end))
        rest = self.tokens[last][2]
        if rest > end:
            frame.items.append(_Item("NAME", end, rest))
        return last + 1

    def _delay(self, index: int, frame: _Frame) -> int:
        """Read a delay, with a unit or a point."""
        _, start, end = self.tokens[index]
        word = self.text[start:end]
        unit = self.tokens[index + 1] if index + 1 < len(self.tokens) else None
        last = index
        amount = _AMOUNT.fullmatch(word)
        if amount and unit and unit[0] == "NAME" and not amount[2]:
            following = self._word(unit)
            if following.lower() in _UNITS and following not in self.states:
                last, end = index + 1, unit[2]
                amount = _AMOUNT.fullmatch(word + following)
        frame.items.append(_Item("INTEGER", start, end))
        if word.isdecimal() and word.isascii() and last == index:
            return index + 1
        if not amount or amount[2].lower() not in _UNITS:
            return last + 1
        number = float(amount[1].replace("_", ""))
        factor = _UNITS[amount[2].lower()] or (1000 if number % 1 or (number < 20 and "." in word) else 1)
        if not number * factor < 1e15:
            return last + 1
        meant = str(round(number * factor))
        message = f"`{self.text[start:end]}` is not a whole number of milliseconds. Write `{meant}`."
        self._add(start, end, "LRP108", message, Edit(start, end, meant))
        return last + 1

    def _sign(self, index: int, frame: _Frame) -> int:
        """Read an arrow or an assignment, right or wrong, as one sign."""
        _, start, end = self.tokens[index]
        last = index
        star = index > 0 and self._kind(index - 1) == "STAR"
        if self._kind(index) == "MINUS" and star:
            arrow = self._kind(index + 1) == "ARROW" and self.starts[index + 1] == end
            if self._kind(index + 1) == "LBRACE" or not (arrow or self._lacks_arrow(index, frame)):
                frame.items.append(_Item("MINUS", start, end))
                return index + 1
        while last + 1 < len(self.tokens):
            kind, first, final = self.tokens[last + 1]
            touching = first == end or (first == end + 1 and self.text[end] == " ")
            if (
                not touching
                or not _SIGN.fullmatch(self.text, first, final)
                or (kind == "NAME" and first != end)
            ):
                break
            last, end = last + 1, final
        word = self.text[start:end]
        kind = {"->": "ARROW", ":=": "ASSIGN"}.get(word, "SIGN")
        frame.items.append(_Item(kind, start, end))
        return last + 1

    def _braces(self, index: int, frame: _Frame) -> int:
        """Read braces: of a source, round a name, or instead of the brackets of a form."""
        _, start, _ = self.tokens[index]
        close = index + 1
        while self._kind(close) in ("NAME", "STRAY"):
            close += 1
        inside = [token for token in self.tokens[index + 1 : close] if token[0] == "NAME"]
        if self._kind(close) == "RBRACE" and inside:
            first = self._word(inside[0])
            if first in LEGAL.get(frame.keyword, ()) and len(inside) > 1:
                return self._form_in_braces(index)
            end = self.tokens[close][2]
            source = frame.keyword in ("on", "ontime", "eps") and "ARROW" not in frame.types
            source = source and (frame.keyword == "eps" or bool(frame.items) or len(inside) > 1)
            source = source and "SIGN" not in frame.types
            if len(inside) == 1 and not source:
                return self._unwrapped(start, end, first, frame, close + 1)
        elif self._kind(index + 1) == "NAME" and self._word(self.tokens[index + 1]) in LEGAL.get(
            frame.keyword, ()
        ):
            return self._form_in_braces(index)
        frame.items.append(_Item("LBRACE", start, start + 1))
        return index + 1

    def _unwrapped(self, start: int, end: int, name: str, frame: _Frame, following: int) -> int:
        """Remove the brackets round a name."""
        message = f"A name has no brackets here. Write `{name}`."
        self._add(start, end, "LRP110", message, Edit(start, end, name))
        frame.items.append(_Item("NAME", start, end))
        return following

    def _form_in_braces(self, index: int) -> int:
        """Put a form in braces into round brackets; the next round reads it."""
        depth = 0
        for at in range(index, len(self.tokens)):
            depth += (self._kind(at) == "LBRACE") - (self._kind(at) == "RBRACE")
            if not depth:
                self._form(self.tokens[index][1], self.tokens[at][2], self._word(self.tokens[index + 1]))
                return at + 1
        return index + 1

    def _form(self, start: int, end: int, keyword: str) -> None:
        """Put a form into round brackets."""
        message = f"A form stands in round brackets. Write `({keyword} …)`."
        edits = Edit(start, start + 1, "("), Edit(end - 1, end, ")")
        self._add(start, end, "LRP104", message, *edits)
        self.frames[-1].items.append(_Item(f"{keyword.upper()}_FORM", start, end, keyword))

    # Forms as a whole

    def _transition(self, frame: _Frame) -> None:
        """Correct the arrow of a transition and the order of its parts."""
        items = frame.items
        if "ARROW" not in frame.types:
            items = self._arrow(frame)
        types = tuple([item.kind for item in items])
        arrow = _source_length(types)
        if frame.keyword != "eps" and arrow and types[arrow:-1] == ("ARROW", "NAME"):
            self._trigger_last(frame, items[0], items[arrow + 1], items[-1])
        if types[:1] == ("INTEGER",) and frame.keyword == "on" and len(types) > 3:
            self._change_keyword(frame, "ontime", "A time is tested by `ontime`")
        elif frame.keyword == "eps" and "ARROW" in types[2:3] and types[0] in ("NAME", "BLOCK", "INTEGER"):
            meant = "ontime" if types[0] == "INTEGER" else "on"
            if types[1] in ("NAME", "STAR"):
                self._change_keyword(frame, meant, "An `eps` has neither an event nor a delay")

    def _trigger_last(self, frame: _Frame, first: _Item, destination: _Item, trigger: _Item) -> None:
        """Move the event or delay of a transition from its end to its beginning."""
        word = self._word(trigger)
        if trigger.kind == "NAME" and (
            word in self.states or (word not in self.events and frame.keyword != "ontime")
        ):
            return
        what = "The delay" if frame.keyword == "ontime" else "The event"
        message = f"{what} comes before the states. Write `{USAGE[frame.keyword]}`."
        edits = Edit(first.start, first.start, f"{word} "), Edit(destination.end, trigger.end, "")
        self._add(trigger.start, trigger.end, "LRP108", message, *edits)

    def _change_keyword(self, frame: _Frame, meant: str, reason: str) -> None:
        start = self.text.find(frame.keyword, frame.start)
        end = start + len(frame.keyword)
        message = f"{reason}. Write `{meant}`."
        if start >= 0:
            self._add(start, end, "LRP108", message, Edit(start, end, meant))
            frame.keyword = meant

    def _arrow(self, frame: _Frame) -> list[_Item]:
        """Correct or insert the arrow of a transition; return the items with it."""
        items = frame.items
        first = 0 if frame.keyword == "eps" else 1
        for at, item in enumerate(items):
            wrong = item.kind in ("SIGN", "ASSIGN", "MINUS") or (
                at > 0
                and item.kind == "NAME"
                and self._word(item) in _ARROW_WORDS
                and self._word(item) not in self.states
                and at + 1 < len(items)
            )
            if wrong and not (item.kind == "MINUS" and items[at - 1].kind == "STAR"):
                message = f"The arrow to the destination is `->`, not `{self._word(item)}`. Write `->`."
                tight = self.text[item.start - 1 : item.start] + self.text[item.end : item.end + 1]
                arrow = "->" if tight.isspace() or item.kind != "NAME" else " -> "
                certain = "<" not in self._word(item)
                self._add(
                    item.start,
                    item.end,
                    "LRP104",
                    message,
                    Edit(item.start, item.end, arrow),
                    certain=certain,
                )
                return [*items[:at], item._replace(kind="ARROW"), *items[at + 1 :]]
        source = _source_length(frame.types[first:])
        at = first + source
        if source and len(items) > at and items[at].kind == "NAME" and len(items) <= at + 2:
            if frame.keyword == "eps" and len(items) > at + 1:
                return items
            before, after = items[at - 1].end, items[at].start
            message = "The arrow `->` is missing before the destination. Insert it."
            self._add(after, items[at].end, "LRP108", message, Edit(before, before, " ->"))
            return [*items[:at], _Item("ARROW", before, before), *items[at:]]
        return items

    def _definition(self, frame: _Frame) -> None:
        """Correct signs and the order of parts in `var`, `event` and `spawn`."""
        items, types, keyword = frame.items, frame.types, frame.keyword
        usage = f"Write `{USAGE[keyword]}`."
        if keyword == "var" and types == ("NAME", "BLOCK"):
            at = items[0].end
            message = f"`:=` is missing between the name and its value. {usage}"
            edit = Edit(at, at, " :=" if self.text[at].isspace() else " := ")
            self._add(*items[1][1:3], "LRP108", message, edit)
        elif keyword == "var" and len(types) == 3 and types[0] == "NAME" and types[2] == "BLOCK":
            sign = items[1]
            word = self._word(sign)
            if sign.kind in ("SIGN", "ARROW", "MINUS") or word in _ASSIGN_WORDS:
                message = f"A variable gets its value with `:=`, not with `{word}`. Write `:=`."
                self._add(sign.start, sign.end, "LRP104", message, Edit(sign.start, sign.end, ":="))
        elif keyword != "var" and len(types) == 3 and types[1] in ("SIGN", "ASSIGN", "ARROW", "MINUS"):
            sign = items[1]
            message = f"There is no `{self._word(sign)}` in `{keyword}`. {usage}"
            self._add(sign.start, sign.end, "LRP104", message, Edit(sign.start, sign.end, " "))
        elif types in (("BLOCK", "NAME"), ("BLOCK", "ASSIGN", "NAME")) and keyword != "spawn":
            block, name = items[0], items[-1]
            message = f"The name comes before the block. {usage}"
            edits = Edit(*block[1:3], self._word(name)), Edit(*name[1:3], self._word(block))
            self._add(block.start, block.end, "LRP108", message, *edits)
        elif types[:2] == ("NAME", "NAME") and keyword != "spawn":
            self._two_words(frame)

    def _two_words(self, frame: _Frame) -> None:
        names = []
        for item in frame.items:
            if item.kind != "NAME":
                break
            names.append(item)
        name = "_".join(map(self._word, names))
        start, end = names[0].start, names[-1].end
        if name in self.names:
            message = f"A name is one word. Write `{name}`."
            self._add(start, end, "LRP110", message, Edit(start, end, name))

    def _container(self, frame: _Frame) -> None:
        """Correct what stands straight in a state or a machine."""
        if frame.types[:2] == ("NAME", "NAME"):
            self._two_words(frame)
        if frame.keyword != "state":
            return
        for item in frame.items:
            if item.kind == "BLOCK":
                message = (
                    "A state has actions in forms that say when they run. "
                    "Write `(running […])` or `(onentry […])`."
                )
                edits = Edit(item.start, item.start, "(running "), Edit(item.end, item.end, ")")
                self._add(item.start, item.end, "LRP117", message, *edits, certain=False)


_LONGEST = 40
_LONGEST_STRING = 200
_LINE_END = re.compile(r"\r\n|\r|\n")
_WORD = re.compile(r"[^\W\d]\w*")
_SOURCE = re.compile(r"\s+(?:\w+|\*|(?:\*\s*-\s*)?\{[^{}]*\})\s*->")
_LOADED = re.compile(r"(?<![\w.])[^\W\d]\w*(?!\w|\s*=[^=])")
_FIRST_WORD = re.compile(r"\s*([^\W\d]\w*)")


def is_form(inside: str, around: str) -> str:
    """Return the keyword of a form that stands in the brackets of a block, or an empty text."""
    found = _FIRST_WORD.match(inside)
    keyword = found[1] if found else ""
    return keyword if keyword in LEGAL.get(around, ()) and not _is_python(inside) else ""


def _source_length(types: tuple[str, ...]) -> int:
    """Return the number of items in the source at the beginning of some types; 0 if there is none."""
    if types[:1] == ("NAME",):
        return 1
    if types[:1] == ("STAR",) and types[1:2] != ("MINUS",):
        return 1
    if "RBRACE" in types and types[0] in ("LBRACE", "STAR"):
        return types.index("RBRACE") + 1
    return 0


def _is_python(text: str) -> bool:
    """Return whether a text is Python that does something."""
    facts = facts_of(text)
    return facts.valid and not facts.empty


def _is_balanced(text: str) -> bool:
    depth = 0
    for char in text:
        depth += (char in "([{") - (char in ")]}")
        if depth < 0:
            return False
    return not depth


def _closest(word: str, known: Iterable[str], cutoff: float) -> str:
    """Return the keyword of which a word is a misspelling, else an empty text."""
    swapped = [keyword for keyword in known if sorted(keyword) == sorted(word)]
    return next(iter(swapped or get_close_matches(word, sorted(known), 1, cutoff)), "")
