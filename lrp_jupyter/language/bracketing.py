"""Python whose square brackets are wrong, missing, or hidden by a comment or a string."""

from __future__ import annotations

import re
from itertools import islice
from keyword import iskeyword

from lrp_jupyter.errors import Edit
from lrp_jupyter.language.draft import LONGEST, OpenForm, Piece, TextDraft, is_python
from lrp_jupyter.language.scanner import LINE_END, block_end, brackets, line_end, strings
from lrp_jupyter.language.spellings import AMOUNT, SIGN
from lrp_jupyter.language.tokens import FORM_LINE, LEGAL, keyword_of
from lrp_jupyter.language.triggers import FORMS

_ACTIONS = frozenset({"onentry", "running", "onexit", "onpause", "onresume"})
_WORDS = re.compile(r"[^\W\d]\w*(?:\s+[^\W\d]\w*)*")
_LONGEST_STRING = 200
_LONGEST_BLOCK = 2_000  # characters of a block that is parsed for each place of a missing quote
_TRIED = 10  # blocks that lack a quote, and places for a missing `]`
_SOURCE = re.compile(r"\s+(?:\w+|\*|(?:\*\s*-\s*)?\{[^{}]*\})\s*->")
_BLOCK = re.compile(r"(?<=[\w)\]\"'])\s+(?=\[)")
"""Between two blocks; a subscript follows its value without a space."""
_DOES = re.compile(r"[=<>(\[]")
_HYPHENS = re.compile(r"\w+(?:-\w+)+")
_JOINED = re.compile(r"\"\"\s*\"\"|\"\"\w|[\w\])]\"\"")
_LOADED = re.compile(r"(?<![\w.])[^\W\d]\w*(?!\w|\s*=[^=])")


class Bracketing(TextDraft):
    """The part of the corrections that is about blocks."""

    def _wants(self, frame: OpenForm) -> bool:
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
            elif char == '"':
                return -1
        return -1

    def _parenthesised(self, index: int, frame: OpenForm) -> int:
        """Put Python in round brackets into square ones; return the index after it, or 0."""
        start = self.tokens[index][1]
        if not self._wants(frame):
            return 0
        close = self._end_of_python(start + 1)
        if close < 0 or self.text[close] == "}" or not is_python(self.text[start + 1 : close]):
            return 0
        after = self._after(close + 1)
        if self.text[close] == "]":
            if self.missing <= 0:
                return 0
            self.missing -= 1
            message = "This block begins with `(` and ends with `]`. Write `[`."
            self._add(start, start + 1, "LRP115", message, Edit(start, start + 1, "["))
            frame.items.append(Piece("BLOCK", start, close + 1))
            return after
        if frame.keyword in ("var", "event") and self._kind(after) != "CLOSE":
            return self._bare(start, frame)
        self._wrong_brackets(start, close, "( )")
        frame.items.append(Piece("BLOCK", start, close + 1))
        return after

    def _wrong_brackets(self, start: int, close: int, which: str) -> None:
        message = f"Python is written in square brackets, not in `{which}`. Write `[…]` here."
        self._add(
            start, close + 1, "LRP115", message, Edit(start, start + 1, "["), Edit(close, close + 1, "]")
        )

    def _bare(self, start: int, frame: OpenForm) -> int:
        """Put Python from here to the end of the form into brackets; return the index after it, or 0."""
        end = self._end_of_python(start)
        part = self._before_part(start, end, frame)
        end = part or end
        python = self.text[start:end].rstrip() if end > 0 else ""
        if end < 0 or self.text[end] == "}" or not is_python(python):
            return 0
        if self.text[end] == "]":
            message = "A `[` is missing here, before the Python that ends with `]`. Insert it."
            self._add(start, line_end(self.text, start), "LRP103", message, Edit(start, start, "["))
            end += 1
        else:
            self._unbracketed(start, start + len(python))
        frame.items.append(Piece("BLOCK", start, start + len(python)))
        return self._after(end)

    def _before_part(self, start: int, end: int, frame: OpenForm) -> int:
        """Return the offset of the first `spawn` or block after Python that has no brackets, or 0."""
        if frame.keyword not in _ACTIONS:
            return 0
        first = self._after(start) + 1
        for token in self.tokens[first : min(self._after(end), first + LONGEST)]:
            spaced = self.text[token[1] - 1].isspace()
            is_part = token[0] == "BLOCK" or (
                token[0] == "OPEN" and keyword_of(self.text, token) in LEGAL.get(frame.keyword, ())
            )
            if spaced and is_part and is_python(self.text[start : token[1]].rstrip()):
                return token[1]
        return 0

    def _quoted(self, start: int, end: int, frame: OpenForm) -> bool:
        """Change quotation marks round Python into square brackets; return whether it is Python."""
        python = self.text[start + 1 : end - 1]
        if frame.keyword == "var" or not is_python(python) or not _DOES.search(python):
            return False
        message = "Python is written in square brackets, not in quotation marks. Write `[…]` here."
        edits = Edit(start, start + 1, "["), Edit(end - 1, end, "]")
        self._add(start, end, "LRP115", message, *edits)
        frame.items.append(Piece("BLOCK", start, end))
        return True

    def _unbracketed(self, start: int, end: int) -> None:
        message = "Python is written in square brackets. Write `[…]` around this."
        self._add(start, end, "LRP115", message, Edit(start, start, "["), Edit(end, end, "]"))

    def _python(self, index: int, frame: OpenForm) -> int:
        """Correct Python that has braces or no brackets; return the index after it, or 0."""
        kind, start, end = self.tokens[index]
        if not self._wants(frame) or kind in ("BLOCK", "OTHER"):
            return 0
        if kind == "QUOTED" and self._quoted(start, end, frame):
            return index + 1
        if SIGN.match(self.text, start) and kind != "MINUS":
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
            if is_python(inside) and not (frame.keyword == "var" and set(inside) & set(":,")):
                self._wrong_brackets(start, close, "{ }")
                frame.items.append(Piece("BLOCK", start, close + 1))
                return self._after(close + 1)
        if frame.keyword in FORMS:
            return self._bare_condition(index, frame)
        if frame.keyword == "var" and frame.types == ("NAME",) and kind == "NAME":
            return 0  # `(var x is 5)` and `(var max speed := [1])`
        if frame.keyword == "event" and kind == "NAME" and self._kind(index + 1) == "BLOCK":
            return 0
        return self._bare(start, frame)

    def _bare_condition(self, index: int, frame: OpenForm) -> int:
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
        if _HYPHENS.fullmatch(python) and python.replace("-", "_") in self.events | self.hyphened:
            return 0
        if not is_python(python) or AMOUNT.fullmatch(python) or "," in python or "\n" in python:
            return 0
        self._unbracketed(start, end)
        frame.items.append(Piece("BLOCK", start, end))
        return source

    def _unclosed(self, index: int) -> int:
        """Close a block whose `]` is missing, or hidden by a comment or a string."""
        _, start, end = self.tokens[index]
        frame = self.frames[-1]
        frame.items.append(Piece("BLOCK", start, end))
        if self._ends_round(index):
            return index + 2
        form = FORM_LINE.search(self.text, start)
        stop = form.start() if form else len(self.text)
        if self._lacks_quote(start, stop):
            return len(self.tokens)  # the rest is read again, when the string is closed
        self._find_end(start, end, stop, frame)
        return index + 1

    def _ends_round(self, index: int) -> bool:
        """Change the `)` after a block without its `]` into that, if the text has a `)` too many."""
        _, start, end = self.tokens[index]
        if self.missing >= 0 or self._kind(index + 1) != "CLOSE" or not is_python(self.text[start + 1 : end]):
            return False
        close = self.starts[index + 1]
        self.missing += 1
        message = "A block ends with `]`, not with `)`. Write `]`."
        self._add(close, close + 1, "LRP103", message, Edit(close, close + 1, "]"))
        return True

    def _find_end(self, start: int, end: int, stop: int, frame: OpenForm) -> None:
        opened = 0
        for offset, char in brackets(self.text, start, stop):
            if char == "#":
                if self._hidden_by_comment(offset):
                    return
            elif char in "([{":
                opened += 1
            elif char == ")" and opened == 1:
                break
            elif char != '"':
                opened -= 1
        self._missing_end(start, end, frame)

    def _missing_end(self, start: int, end: int, frame: OpenForm) -> None:
        """Report the missing `]` of a block, if its place is certain; else the parser does."""
        inside = self.text[start + 1 : end].strip()
        if inside.startswith("["):
            inner = block_end(inside, 0)
            is_list = inner != len(inside) - 1 or not inside.strip("[] ") or "," in inside
            if inner > 0 and not (frame.keyword == "var" and is_list):
                message = "This `[` is one too many. Remove it."
                self._add(start, start + 1, "LRP103", message, Edit(start, start + 1, ""))
                return
        after = _SOURCE if frame.keyword in FORMS else _BLOCK if frame.keyword in _ACTIONS else None
        for found in islice(after.finditer(self.text, start, end), _TRIED) if after else ():
            following = block_end(self.text, found.end()) if after is _BLOCK else len(self.text)
            is_next = after is _SOURCE or is_python(self.text[found.end() + 1 : following])
            if is_next and is_python(self.text[start + 1 : found.start()]):
                end = found.start()
                self._add(*unclosed(self.text, start, end), Edit(end, end, "]"))
                return
        closes = block_end(f"{self.text[start:end]}]", 0) == end - start
        if closes and self.text[end : end + 1] == ")":
            self._add(*unclosed(self.text, start, end), Edit(end, end, "]"))

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

    def _lacks_quote(self, start: int, stop: int) -> bool:
        """Write the quote that a string in a block lacks, if it is clear where; return whether it is."""
        limit, stop = min(stop, start + _LONGEST_STRING), min(stop, start + _LONGEST_BLOCK)
        line = start
        while line < limit:
            last = min(line_end(self.text, line), stop)
            for quote in "\"'":
                odd = self.text.count(quote, line, last) % 2
                if odd and quote * 3 not in self.text[line:last] and self.quotes < _TRIED:
                    self.quotes += 1
                    return self._quote(start, line, last, stop, quote)
            line = last + 1
        return False

    def _quote(self, start: int, line: int, last: int, stop: int, quote: str) -> bool:
        """Write a quote into a line of a block so that it is Python, with the shortest string."""
        known = self._known(start).union(_LOADED.findall(self.text, start, line))
        found = []
        first = self.text.index(quote, line)
        for at in range(line + 1, min(last, first + _LONGEST_STRING) + 1):
            closes = self.text.count(quote, line, at) % 2 == 1
            if not (self._may_close(at, last) if closes else self._may_open(at)):
                continue
            whole = self.text[start:at] + quote + self.text[at:stop]
            end = block_end(whole, 0)
            if end < 0 or not is_python(whole[1:end]):
                continue
            code, contents = _without_strings(whole[: end + 1])
            if known.issuperset(_LOADED.findall(code)) and not _JOINED.search(code):
                opening = self.text.rindex(quote, line, at) if closes else at
                size = (at if closes else self.text.index(quote, at)) - opening
                found.append((not all(map(_is_balanced, contents)), size, at, opening))
        if not found:
            return False
        _, _, at, opening = min(found)
        message = f"This string is not closed. Write `{quote}` at its end."
        if opening == at:
            word = re.split(r"\W", self.text[at:last], maxsplit=1)[0]
            message = f"This string has no quote at its beginning. Write `{quote}` before `{word}`."
        self._add(opening, last, "LRP514", message, Edit(at, at, quote))
        return True

    def _may_close(self, at: int, last: int) -> bool:
        return at == last or self.text[at] in ")]},;:"

    def _may_open(self, at: int) -> bool:
        return self.text[at : at + 1].isalnum() and self.text[at - 1] in " ([{,="


def _without_strings(text: str) -> tuple[str, list[str]]:
    """Return Python with an empty string for each string, and their contents."""
    code, contents, position = "", [], 0
    for start, end in strings(text):
        code += text[position:start] + '""'
        contents.append(text[start + 1 : end - 1])
        position = end
    return code + text[position:], contents


def unclosed(text: str, start: int, end: int) -> tuple[int, int, str, str]:
    """Return place, code and message of the error that a block from `start` lacks its `]` at `end`."""
    lines = LINE_END.split(text[:start])
    if not LINE_END.search(text, start, end):
        message = "This `[` is not closed. Put its `]` after the Python that it opens."
        return start, start + 1, "LRP103", message
    message = f"The `[` in line {len(lines)} is not closed. Put its `]` here."
    return end - 1, end, "LRP103", message


def _is_balanced(text: str) -> bool:
    depth = 0
    for char in text:
        depth += (char in "([{") - (char in ")]}")
        if depth < 0:
            return False
    return not depth
