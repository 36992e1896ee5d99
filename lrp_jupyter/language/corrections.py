"""Corrections of a text that is spelt in ways of other languages, or has a slip of the pen.

A text that is not a program is read once more, token by token, with regard to the form around each of them.
Where it is clear what was meant (``=`` for ``:=``, ``(State``, ``2s``, ``//`` before a comment, Python in the
wrong brackets), the text is corrected, and the parser reads the corrected text. So one mistake is one error,
and what would follow from it is not reported. Where a correction is certain, it is that error's fix.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Callable
from keyword import iskeyword
from typing import NamedTuple

from lrp_jupyter.errors import Edit
from lrp_jupyter.language.blocks import facts_of
from lrp_jupyter.language.bracketing import Bracketing
from lrp_jupyter.language.draft import LONGEST, OpenForm, Piece, is_python
from lrp_jupyter.language.forms import USAGE, Mistake, shape_of, short
from lrp_jupyter.language.keywords import Keywords
from lrp_jupyter.language.parts import Parts
from lrp_jupyter.language.scanner import LINE_END, line_end
from lrp_jupyter.language.source import Diagnosis
from lrp_jupyter.language.spellings import AMOUNT, ARROWS, MODULES, SIGN, UNITS
from lrp_jupyter.language.tokens import KEYWORDS, LEGAL, keyword_of
from lrp_jupyter.language.triggers import FORMS

_NAMED = frozenset({"event", "machine", "state", "var"})
_AFTER_NAME = frozenset({"ASSIGN", "BLOCK"})
_FIRST_WORD = re.compile(r"\s*([^\W\d]\w*)")


class Corrected(NamedTuple):
    """A corrected text, the errors of the original, and the way back.

    `found`: at offsets of the original text, as are their edits.
    `moved`: returns an error of the corrected text with its offsets in the original.
    """

    text: str
    found: list[Diagnosis]
    moved: Callable[[Diagnosis], Diagnosis]


def correct(text: str) -> Corrected | None:
    """Correct what is clear in a text that is not a program; return None if nothing is."""
    walk = _Walk(text)
    walk.run()
    if not walk.edits:
        return None
    corrected, origin = _applied(text, walk.edits)
    return Corrected(corrected, walk.found, lambda diagnosis: _moved(diagnosis, origin))


def _moved(diagnosis: Diagnosis, origin: Callable[[int], int]) -> Diagnosis:
    """Return an error of a corrected text at its place in the original; no fix may touch a correction."""
    edits = tuple([Edit(origin(start), origin(end), new) for start, end, new in diagnosis.edits])
    if [end - start for start, end, _ in edits] != [end - start for start, end, _ in diagnosis.edits]:
        edits = ()
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


class _Walk(Keywords, Bracketing, Parts):
    """One reading of a text."""

    def run(self) -> None:
        """Read all tokens."""
        index = 0
        while index < len(self.tokens):
            index = self._token(index)
        for frame in self.frames:
            self._commas(frame)

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
        if kind == "NAME" and frame.keyword == "program" and self.text[start:end] in MODULES:
            return self._bare_module(index)
        python = kind != "UNOPENED" and self._python(index, frame)
        if python:
            return python
        if kind in ("NAME", "INTEGER", "QUOTED"):
            return self._name(index, frame)
        if kind == "LBRACE":
            return self._braces(index, frame)
        if kind in ("ARROW", "ASSIGN", "MINUS") or SIGN.match(self.text, start):
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
        frame.items.append(Piece("BLOCK" if kind == "UNOPENED" else kind, start, end))
        return index + 1

    def _spaced(self, offset: int) -> bool:
        return not self.text[offset : offset + 1].strip() or self.text[offset] in ")]}"

    def _complete(self, frame: OpenForm) -> bool:
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
        message = f"Comments begin with `;`, not with `{sign}`. Write `;`."
        if sign != "/*":
            self._add(start, end, "LRP114", message, Edit(start, start + 2, ";"))
            return index + 1
        edits = [Edit(start, start + 2, ";")]
        if word.endswith("*/") and len(word) > 3:
            after = self.text[end : line_end(self.text, end)]
            edits.append(Edit(end - 2, end, "" if not after.strip() else "\n"))
            word = word[:-2]
        edits += [Edit(start + line.end(), start + line.end(), "; ") for line in LINE_END.finditer(word)]
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
            self.frames.append(OpenForm(word, start))
            return index + 1
        names = self._names_in_brackets(index, frame)
        if names:
            return names
        python = self._parenthesised(index, frame)
        if python:
            return python
        if not word and self._kind(index + 1) == "OPEN":
            return self._doubled(index)
        if word in MODULES and frame.keyword == "program":
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
            self.frames.append(OpenForm(inferred, start))
            if word:
                self.frames[-1].items.append(Piece("NAME", end - len(word), end))
            return index + 1
        self.frames.append(OpenForm(word, start))
        return index + 1

    def _lost(self, index: int, frame: OpenForm) -> bool:
        """Insert the `(` that is missing before a keyword; return whether it is."""
        kind, start, end = self.tokens[index]
        word = self.text[start:end]
        if kind != "NAME" or word not in LEGAL.get(frame.keyword, ()):
            return False
        if frame.keyword in ("machine", "state") and not frame.items:
            return False
        if self.missing < 0 and self._fits(word, self._types(index + 1)):
            self.missing += 1
            message = f"A `(` is missing before `{word}`. Insert it."
            self._add(start, end, "LRP101", message, Edit(start, start, "("))
            self.frames.append(OpenForm(word, start))
            return True
        return self.missing == 0 and self._bracketless(index, word)

    def _fits(self, keyword: str, types: tuple[str, ...]) -> bool:
        return not isinstance(shape_of((keyword.upper(), *types)), Mistake)

    def _bracketless(self, index: int, word: str) -> bool:
        """Put a form without brackets that ends with its line, or with the form around it, into brackets."""
        start = self.starts[index]
        stop = line_end(self.text, start)
        types = []
        last = end = index
        for at in range(index + 1, min(len(self.tokens), index + LONGEST)):
            kind, first, final = self.tokens[at]
            if kind in ("OPEN", "CLOSE") or first >= stop:
                break
            types.append(kind)
            last, end = at, final
        if last == index or not self._fits(word, tuple(types)):
            return False
        message = f"This form has no brackets. Write `{USAGE[word]}`."
        self._add(start, end, "LRP101", message, Edit(start, start, "("), Edit(end, end, ")"))
        self.frames.append(OpenForm(word, start))
        return True

    def _names_in_brackets(self, index: int, frame: OpenForm) -> int:
        """Remove the round brackets from names of states and events; return the index after them, or 0."""
        named = frame.keyword in _NAMED and not frame.items
        if not named and frame.keyword not in FORMS and frame.keyword != "spawn":
            return 0
        close = index + 1
        while self._kind(close) == "NAME" or (
            self._kind(close) == "INTEGER" and frame.keyword == "ontime" and not frame.items
        ):
            close += 1
        start = self.starts[index]
        inside = self.text[start + 1 : self.tokens[close][1]].split() if self._kind(close) == "CLOSE" else []
        condition = frame.keyword in ("on", "exit") and not frame.items
        if not inside or (condition and inside[0] not in self.events) or (named and len(inside) > 1):
            return 0
        if named and inside[0] in LEGAL.get(frame.keyword, ()):
            return 0
        end = self.tokens[close][2]
        if frame.keyword in FORMS and len(inside) > 1 and self.states.issuperset(inside):
            return self._grouped(start, end, " ".join(inside), frame, close + 1)
        if len(inside) > 2:
            return 0
        return self._unwrapped(start, end, inside, frame, close + 1)

    def _grouped(self, start: int, end: int, names: str, frame: OpenForm, following: int) -> int:
        """Put the sources of a transition, which are in other brackets, into braces."""
        names = f"{{{names}}}"
        message = f"Several sources are written in braces. Write `{names}`."
        self._add(start, end, "LRP110", message, Edit(start, end, names))
        frame.items += [Piece(kind, start, end) for kind in ("LBRACE", "NAME", "RBRACE")]
        return following

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
                self.frames.append(OpenForm("()", start))
                return index + 1
        return index + 1

    def _module(self, index: int) -> int:
        """Remove a form that imports or exports."""
        _, start, end = self.tokens[index]
        close = next((token for token in self.tokens[index:] if token[0] == "CLOSE"), None)
        end = close[2] if close else end
        word = keyword_of(self.text, self.tokens[index])
        what = "everything is visible already" if word == "export" else "copy what you need into this text"
        message = f"LRP has no modules: a program is one text. Remove this `{word}`; {what}."
        self._add(start, end, "LRP113", message, Edit(start, end, ""))
        return self._after(end)

    def _bare_module(self, index: int) -> int:
        """Report a line that imports, as in Python; it may be needed in a block, so there is no fix."""
        start = self.starts[index]
        end = line_end(self.text, start)
        message = "LRP has no modules, and Python's are imported inside a block. Move this into a block."
        self._add(start, end, "LRP113", message, Edit(start, end, ""), certain=False)
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
            self.frames[-1].items.append(Piece(kind, frame.start, end, frame.keyword))

    def _commas(self, frame: OpenForm) -> None:
        if frame.commas:
            start, end, _ = frame.commas[0]
            message = "Parts are separated by spaces, not by commas. Remove the comma."
            if len(frame.commas) > 1:
                message = message.replace("the comma.", "the commas.")
            self._add(start, end, "LRP104", message, *frame.commas)

    def _block(self, index: int) -> int:
        _, start, end = self.tokens[index]
        frame = self.frames[-1]
        inside = self.text[start + 1 : end - 1]
        keyword = is_form(inside, frame.keyword)
        if keyword:
            self._form(start, end, keyword)
            return index + 1
        named = not frame.items if frame.keyword in _NAMED else frame.keyword == "spawn"
        named = named and (frame.keyword not in ("var", "event") or self._kind(index + 1) in _AFTER_NAME)
        words = inside.split()
        source = frame.keyword in FORMS and (frame.items or frame.keyword == "eps")
        if source and len(words) > 1 and self.states.issuperset(words):
            return self._grouped(start, end, " ".join(words), frame, index + 1)
        if named or (frame.keyword in FORMS and frame.items and inside.strip() in self.states):
            names = inside.split()
            if 0 < len(names) <= self._most_names(frame) and all(map(str.isidentifier, names)):
                return self._unwrapped(start, end, names, frame, index + 1)
        if self.missing > 0 and inside.rstrip().endswith(")") and not facts_of(inside).valid:
            shorter = inside.rstrip()[:-1]
            if is_python(shorter):
                at = start + 1 + len(shorter)
                message = "The block ends before the form: `]` comes before `)`. Swap them."
                self._add(at, end, "LRP103", message, Edit(at, end, "])"))
                self.missing -= 1
                frame.items.append(Piece("BLOCK", start, at))
                self._close(end)
                return index + 1
        frame.items.append(Piece("BLOCK", start, end))
        if not facts_of(inside).valid and self._lacks_quote(start, end):
            return len(self.tokens)
        return index + 1

    # Names and signs

    def _name(self, index: int, frame: OpenForm) -> int:
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
        arrow = re.search(f"[{ARROWS}]+", word)
        if arrow and kind == "NAME":
            return self._pointed(index, last, frame, arrow)
        if kind == "NAME" and last == index and (word.isascii() or word.isidentifier()):
            frame.items.append(Piece("NAME", start, end))
            return index + 1
        if kind == "QUOTED":
            word = word[1:-1].strip()
        self._misspelt(start, end, word, kind, frame)
        return last + 1

    def _misspelt(self, start: int, end: int, word: str, kind: str, frame: OpenForm) -> None:
        """Correct a name that is not one, wherever it is written in this way."""
        frame.items.append(Piece("NAME", start, end))
        written = self.text[start:end]
        if kind == "QUOTED" and frame.keyword == "ontime" and word.isdecimal():
            frame.items[-1] = Piece("INTEGER", start, end)
            message = f"Delays are written without quotation marks. Write `{word}`."
            self._add(start, end, "LRP108", message, Edit(start, end, word))
            return
        name = self._valid(word)
        if not name or (
            kind == "INTEGER" and word.isdecimal() and frame.keyword in KEYWORDS - {"state", "machine"}
        ):
            frame.items[-1] = Piece(kind if kind != "QUOTED" else "NAME", start, end)
            return
        parts = re.split(r"\W+", word)
        if (
            frame.keyword == "spawn"
            and len(parts) == 2
            and parts[0] in self.machines
            and parts[1] in self.states
        ):
            name = " ".join(parts)
            frame.items.append(frame.items[-1])
            message = f"The machine and its state are two words. Write `{name}`."
            self._add(start, end, "LRP110", message, Edit(start, end, name))
            return
        if kind == "QUOTED":
            message = f"Names are written without quotation marks. Write `{name}`."
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

    def _lacks_arrow(self, minus: int, frame: OpenForm) -> bool:
        """Return whether a `-` in a transition must be its arrow."""
        if frame.keyword not in FORMS or "ARROW" in frame.types or "SIGN" in frame.types:
            return False
        return not any(token[0] == "ARROW" for token in self._rest(minus + 1))

    def _pointed(self, index: int, last: int, frame: OpenForm, arrow: re.Match[str]) -> int:
        """Read a word that contains an arrow of Unicode."""
        start = self.tokens[index][1]
        if arrow.start():
            frame.items.append(Piece("NAME", start, start + arrow.start()))
        begin, end = start + arrow.start(), start + arrow.end()
        frame.items.append(Piece("SIGN", begin, end))
        rest = self.tokens[last][2]
        if rest > end:
            frame.items.append(Piece("NAME", end, rest))
        return last + 1

    def _delay(self, index: int, frame: OpenForm) -> int:
        """Read a delay, with a unit or a point."""
        _, start, end = self.tokens[index]
        word = self.text[start:end]
        unit = self.tokens[index + 1] if index + 1 < len(self.tokens) else None
        last = index
        amount = AMOUNT.fullmatch(word)
        if amount and unit and unit[0] == "NAME" and not amount[2]:
            following = self._word(unit)
            if following.lower() in UNITS and following not in self.states:
                last, end = index + 1, unit[2]
                amount = AMOUNT.fullmatch(word + following)
        frame.items.append(Piece("INTEGER", start, end))
        if word.isdecimal() and word.isascii() and last == index:
            return index + 1
        if not amount or amount[2].lower() not in UNITS:
            return last + 1
        number = float(amount[1].replace("_", ""))
        factor = UNITS[amount[2].lower()] or (1000 if number % 1 or (number < 20 and "." in word) else 1)
        if not number * factor < 1e15:
            return last + 1
        meant = str(round(number * factor))
        message = f"`{self.text[start:end]}` is not a whole number of milliseconds. Write `{meant}`."
        self._add(start, end, "LRP108", message, Edit(start, end, meant))
        return last + 1

    def _sign(self, index: int, frame: OpenForm) -> int:
        """Read an arrow or an assignment, right or wrong, as one sign."""
        _, start, end = self.tokens[index]
        last = index
        star = index > 0 and self._kind(index - 1) == "STAR"
        if self._kind(index) == "MINUS" and star:
            arrow = self._kind(index + 1) == "ARROW" and self.starts[index + 1] == end
            if self._kind(index + 1) == "LBRACE" or not (arrow or self._lacks_arrow(index, frame)):
                frame.items.append(Piece("MINUS", start, end))
                return index + 1
        while last + 1 < len(self.tokens):
            kind, first, final = self.tokens[last + 1]
            touching = first == end or (first == end + 1 and self.text[end] == " ")
            if (
                not touching
                or not SIGN.fullmatch(self.text, first, final)
                or (kind == "NAME" and first != end)
            ):
                break
            last, end = last + 1, final
        word = self.text[start:end]
        kind = {"->": "ARROW", ":=": "ASSIGN"}.get(word, "SIGN")
        frame.items.append(Piece(kind, start, end))
        return last + 1

    def _braces(self, index: int, frame: OpenForm) -> int:
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
            if len(inside) <= self._most_names(frame) and not source:
                return self._unwrapped(start, end, [self._word(each) for each in inside], frame, close + 1)
        elif self._kind(index + 1) == "NAME" and self._word(self.tokens[index + 1]) in LEGAL.get(
            frame.keyword, ()
        ):
            return self._form_in_braces(index)
        frame.items.append(Piece("LBRACE", start, start + 1))
        return index + 1

    def _most_names(self, frame: OpenForm) -> int:
        """Return how many names may be in brackets where only names belong."""
        return 2 if frame.keyword == "spawn" and not frame.items else 1

    def _unwrapped(self, start: int, end: int, names: list[str], frame: OpenForm, following: int) -> int:
        """Remove the brackets round names or a delay; return the index after them."""
        plain = " ".join(names)
        before = "" if self.text[start - 1 : start].isspace() else " "
        what = (
            "Delays are written without brackets"
            if plain.isdecimal()
            else "Names are written without brackets here"
        )
        message = f"{what}. Write `{plain}`."
        self._add(start, end, "LRP110", message, Edit(start, end, before + plain))
        frame.items += [Piece("NAME", start, end)] * len(names)
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
        message = f"A form is written in round brackets. Write `({keyword} …)`."
        edits = Edit(start, start + 1, "("), Edit(end - 1, end, ")")
        self._add(start, end, "LRP104", message, *edits)
        self.frames[-1].items.append(Piece(f"{keyword.upper()}_FORM", start, end, keyword))


def is_form(inside: str, around: str) -> str:
    """Return the keyword of a form that is written in the brackets of a block, or an empty text."""
    found = _FIRST_WORD.match(inside)
    keyword = found[1] if found else ""
    return keyword if keyword in LEGAL.get(around, ()) and not is_python(inside) else ""
