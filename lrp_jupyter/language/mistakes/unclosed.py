"""Blocks whose `]` is missing, or hidden by a comment or a string."""

from __future__ import annotations

import re
from itertools import islice

from lrp_jupyter.errors import Edit
from lrp_jupyter.language.mistakes.text_draft import Correction, Corrections, DraftForm, TextDraft, is_python
from lrp_jupyter.language.python.scanner import LINE_END, block_end, brackets, line_end, strings
from lrp_jupyter.language.reading.tokens import ACTIONS, FORM_LINE
from lrp_jupyter.language.triggers import FORMS

_LONGEST_STRING = 200
_LONGEST_BLOCK = 2_000  # characters of a block that is parsed for each place of a missing quote
_TRIED = 10  # blocks that lack a quote, and places for a missing `]`
_SOURCE = re.compile(r"\s+(?:\w+|\*|(?:\*\s*-\s*)?\{[^{}]*\})\s*->")
_BLOCK = re.compile(r"(?<=[\w)\]\"'])\s+(?=\[)")
"""Between two blocks; a subscript follows its value without a space."""
_NOWHERE = re.compile(r"(?!)")
_JOINED = re.compile(r"\"\"\s*\"\"|\"\"\w|[\w\])]\"\"")
_LOADED = re.compile(r"(?<![\w.])(?<!for )[^\W\d]\w*(?!\w|\s*:?=[^=])")
_BOUND = re.compile(r"\bfor (\w+)|(\w+) :?=(?!=)")
_PREFIX = re.compile(r"\b[rbuftRBUFT]{1,2}(?=\"\")")


def doubled(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Blocks with a `[` too many."""
    start, inside = form.items[at].start, draft.word(form.items[at])[1:].strip()
    inner = block_end(inside, 0) if inside.startswith("[") else -1
    is_list = inner != len(inside) - 1 or not inside.strip("[] ") or "," in inside
    if inner > 0 and not (form.keyword == "var" and is_list):
        message = "This `[` is one too many. Remove it."
        edit = Edit(start, start + 1, "")
        yield Correction("LRP103", message, start, start + 1, (edit,), form.items, hides=True)


def ends(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Blocks whose `]` is missing at a place that is certain; elsewhere the parser reports it."""
    text, start, end = draft.text, form.items[at].start, form.items[at].end
    after = _SOURCE if form.keyword in FORMS else _BLOCK if form.keyword in ACTIONS else _NOWHERE
    for place in islice(after.finditer(text, start, end), _TRIED):
        following = block_end(text, place.end()) if after is _BLOCK else len(text)
        is_next = after is _SOURCE or is_python(text[place.end() + 1 : following])
        if is_next and is_python(text[start + 1 : place.start()]):
            end = place.start()
            break
    else:
        if block_end(f"{text[start:end]}]", 0) != end - start or text[end : end + 1] != ")":
            return
    first, last, code, message = unclosed(text, start, end)
    yield Correction(code, message, first, last, (Edit(end, end, "]"),), form.items, hides=True)


def hidden(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Comments that hide the `]` of their block: they belong to the end of the line."""
    text, start = draft.text, form.items[at].start
    found = FORM_LINE.search(text, start)
    opened = 0
    for offset, char in brackets(text, start, found.start() if found else None):
        if char == "#":
            stop = line_end(text, offset)
            depth = 0
            for place in range(offset, stop):
                depth += (text[place] == "[") - (text[place] == "]")
                if depth < 0:
                    before = len(text[:offset].rstrip(" \t"))
                    edits = Edit(before, place, ""), Edit(stop, stop, f"  {text[offset:place].rstrip()}")
                    message = "This comment hides the `]` after it. Put the `]` before the `#`."
                    yield Correction("LRP116", message, offset, stop, edits, form.items, hides=True)
                    return
        elif char == ")" and opened == 1:
            return
        elif char != '"':
            opened += 1 if char in "([{" else -1


def quotes(draft: TextDraft, form: DraftForm, at: int) -> Corrections:
    """Strings that lack a quote, if it is clear where."""
    text, (start, stop) = draft.text, (form.items[at].start, form.items[at].end)
    if form.items[at].kind == "UNCLOSED":
        found = FORM_LINE.search(text, start)
        stop = found.start() if found else len(text)
    line, stop = start, min(stop, start + _LONGEST_BLOCK)
    while line < stop:
        last = min(line_end(text, line), stop)
        for quote in "\"'":
            odd = text.count(quote, line, last) % 2
            if odd and quote * 3 not in text[line:last]:
                if draft.quotes < _TRIED:
                    draft.quotes += 1
                    yield from _quote(draft, form, start, (line, last, stop), quote)
                return
        line = last + 1


def _quote(
    draft: TextDraft, form: DraftForm, start: int, line: tuple[int, int, int], quote: str
) -> Corrections:
    """Yield the quote that makes a line of a block Python, with the shortest string."""
    text, (begin, last, stop) = draft.text, line
    known = draft.known(start).union(_LOADED.findall(text, start, begin))
    found = []
    first = text.index(quote, begin)
    for at in range(begin + 1, min(last, first + _LONGEST_STRING) + 1):
        closes = text.count(quote, begin, at) % 2 == 1
        may_open = text[at : at + 1].isalnum() and text[at - 1] in " ([{,="
        if not (at == last or text[at] in ")]},;:" if closes else may_open):
            continue
        whole = text[start:at] + quote + text[at:stop]
        end = block_end(whole, 0)
        if end < 0 or not is_python(whole[1:end]):
            continue
        code, contents = _without_strings(whole[: end + 1])
        code = _PREFIX.sub("", code)
        known.update(map("".join, _BOUND.findall(code)))
        if known.issuperset(_LOADED.findall(code)) and not _JOINED.search(code):
            opening = text.rindex(quote, begin, at) if closes else at
            size = (at if closes else text.index(quote, at)) - opening
            found.append((not all(map(_is_balanced, contents)), size, at, opening))
    if found:
        _, _, at, opening = min(found)
        message = f"This string is not closed. Write `{quote}` at its end."
        if opening == at:
            word = re.split(r"\W", text[at:last], maxsplit=1)[0]
            message = f"This string has no quote at its beginning. Write `{quote}` before `{word}`."
        yield Correction("LRP514", message, opening, last, (Edit(at, at, quote),), form.items, hides=True)


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
