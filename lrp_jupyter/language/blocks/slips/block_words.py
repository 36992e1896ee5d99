"""Words: keywords that are misspelt or of other languages, and those in the wrong place."""

from __future__ import annotations

from difflib import SequenceMatcher
from functools import lru_cache
from keyword import iskeyword, kwlist

from lrp_jupyter.errors import Edit
from lrp_jupyter.language.blocks.slips.code import VALUES, Guess, Guesses, WrongBlock, change, is_value_end
from lrp_jupyter.language.reading.forms import USAGE
from lrp_jupyter.language.reading.tokens import KEYWORDS


def keywords(code: WrongBlock) -> Guesses:
    """Keywords that are misspelt, or those of other languages."""
    for index in code.near():
        token, after = code.tokens[index], code.get(index + 1)
        if token.kind != "name":
            continue
        word = token.text
        if word in ("then", "do") and (not code.begins(index) or code.get(index - 1).text == ":"):
            before = code.get(index - 1)
            colon = "" if ":" in (after.text, before.text) else ":"
            message = f"Python has no `{word}`. {'Write `:`' if colon else 'Remove it'}."
            yield Guess("LRP511", message, token.start, token.end, (Edit(before.end, token.end, colon),))
        if word == "else" and after.text == "if" and after.line == token.line:
            edit = Edit(token.start, after.end, "elif")
            yield Guess("LRP511", "Python writes `else if` in one word. Write `elif`.", *edit[:2], (edit,))
        if word in _DECLARING and after.kind == "name" and code.begins(index):
            message = f"Python has no `{word}`. Write the assignment without it."
            edits = [Edit(token.start, after.start, "")]
            if code.get(index + 2).text == "to":
                message = f"An assignment is written with `=`. Write `{after.text} = …`."
            if code.get(index + 2).text in (":=", "to"):
                edits.append(Edit(code.get(index + 2).start, code.get(index + 2).end, "="))
            yield Guess("LRP511", message, token.start, token.end, tuple(edits))
        if word in _ENDING and code.begins(index) and code.ends(index + 1):
            message = f"Python has no `{word}`; the lines further right belong together. Remove it."
            yield change(token, "", "LRP511", message)
        for meant in _meant(word):
            if meant == word.lower():
                message = f"Keywords are written in lowercase. Write `{meant}`."
            elif word.lower() in _SYNONYMS:
                message = f"Python has no `{word}`. Write `{meant}`."
            else:
                message = f"`{word}` is not a keyword of Python. Did you mean `{meant}`?"
            yield change(token, meant, "LRP511", message)
        for keyword in ("return", "not", "if", "while", "elif", "import"):
            rest = word.removeprefix(keyword)
            if rest != word and rest and not iskeyword(word):
                message = f"A space is missing. Write `{keyword} {rest}`."
                yield change(token, f"{keyword} {rest}", "LRP511", message)


_DECLARING = frozenset({
    "var", "let", "const", "int", "float", "double", "bool", "boolean", "string", "auto", "my", "dim",
    "local", "set", "call", "new",
})  # fmt: skip
_ENDING = frozenset({"end", "endif", "endwhile", "endfor", "fi", "done", "od", "begin"})
_SYNONYMS = {
    "function": "def", "func": "def", "fun": "def", "proc": "def", "sub": "def", "elseif": "elif",
    "elsif": "elif", "elsef": "elif", "foreach": "for", "unless": "if not", "until": "while not",
    "catch": "except", "throw": "raise", "switch": "match", "otherwise": "else", "when": "if", "mod": "%",
    "div": "//", "xor": "!=", "equals": "==", "eq": "==", "of": "in",
}  # fmt: skip


@lru_cache(maxsize=1024)
def _meant(word: str) -> tuple[str, ...]:
    """Return the keywords that a word may be meant for, the most similar first."""
    if iskeyword(word):
        return ()
    small = word.lower()
    if small in _SYNONYMS:
        return (_SYNONYMS[small],)
    if iskeyword(small):
        return (small,)
    found = []
    for keyword in kwlist:
        if keyword in VALUES or abs(len(keyword) - len(small)) > 2:
            continue
        ratio = SequenceMatcher(None, small, keyword).ratio()
        if len(keyword) == 2:
            is_similar = len(small) == 3 and set(small) == set(keyword)
        else:
            is_similar = ratio >= (0.7 if len(keyword) > 3 else 0.79)
        if is_similar or sorted(small) == sorted(keyword):
            found.append((-ratio, keyword))
    return tuple(keyword for _, keyword in sorted(found)[:3])


def conditions(code: WrongBlock) -> Guesses:
    """Conditions that are written like a statement: `if x > 1:`."""
    if not code.is_condition or not code.tokens:
        return
    first, second, last = code.tokens[0], code.get(1), code.tokens[-1]
    edits = []
    if first.text.lower() == "unless" and second.start >= 0:
        end = code.get(len(code.tokens) - 2).end if last.text in (":", "then") else last.end
        pair = (Edit(first.start, second.start, "not ("), Edit(end, last.end, ")"))
        message = f"Python has no `{first.text}`. Write `not (…)`."
        yield Guess("LRP511", message, first.start, first.end, pair)
    if first.text.lower() in ("if", "when", "while", "until") and second.start >= 0:
        edits.append(Edit(first.start, second.start, ""))
    if last.text in (":", "then"):
        edits.append(Edit(code.get(len(code.tokens) - 2).end, last.end, ""))
    if edits:
        word = first if edits[0].start == first.start else last
        message = f"A condition is written without `{word.text}`. Remove it."
        yield Guess("LRP511", message, word.start, word.end, tuple(edits))


def forms(code: WrongBlock) -> Guesses:
    """Forms of the program inside a block."""
    for index in code.near():
        token, word, name = code.tokens[index], code.get(index + 1), code.get(index + 2)
        is_form = token.text == "(" and word.text in KEYWORDS and (name.kind == "name" or name.text == "[")
        if is_form:
            start, end, shown = token.start, code.tokens[code.partner(index, across_lines=True)].end, word
        elif token.text in _FORMS and code.begins(index) and code.is_gap(index) and code.ends(index + 2):
            start, end, shown = token.start, word.end, token
        else:
            continue
        what = f"`({shown.text} …)` is a form of the program, not Python"
        message = f"{what}. Put it after the `]` of this block."
        if shown.text in _JUMPS:
            message = CANNOT_MOVE
        rest = code.text[end:].partition("\n")[0].strip()
        instead = "pass; " if rest[:1] not in ("", "#", ";", ")", "]") else "pass"
        yield Guess("LRP510", message, start, shown.end, (Edit(start, end, instead),), False, is_form)


CANNOT_MOVE = f"A block cannot change the state. Write a transition: `{USAGE['on']}`."
_JUMPS = frozenset({"state", "goto", "go", "transition", "enter", "switch"})
"""Words with which other languages change the state."""
_FORMS = KEYWORDS | _JUMPS


def negated(code: WrongBlock) -> Guesses:
    """`not` in the wrong place."""
    for index in code.near():
        token, before, after = code.tokens[index], code.get(index - 1), code.get(index + 1)
        if token.text != "not":
            continue
        if before.text == "is" and after.text in _OPPOSITE:
            meant = _OPPOSITE[after.text]
            message = f"`is not` and `{after.text}` do not go together. Write `{meant}`."
            yield Guess("LRP517", message, before.start, after.end, (Edit(before.start, after.end, meant),))
        if after.text in _OPPOSITE:
            meant = _OPPOSITE[after.text]
            message = f"`not` does not negate the sign after it. Write `{meant}`."
            yield Guess("LRP517", message, token.start, after.end, (Edit(token.start, after.end, meant),))
        if before.text in ("&", "|"):
            meant = "and" if before.text == "&" else "or"
            yield change(before, meant, "LRP517", f"`{before.text}` combines bits. Write `{meant}`.")
        if is_value_end(before):
            yield change(token, "and not", "LRP517", "Something is missing before `not`. Write `and not`.")
            yield change(token, "!=", "LRP517", "`not` does not compare. Write `!=`.")
        end = code.get(code.chain_end(index + 1) - 1).end
        shown = code.piece(token.start, end)
        edits = (Edit(token.start, token.start, "("), Edit(end, end, ")"))
        yield Guess("LRP517", f"This `not` needs parentheses. Write `({shown})`.", token.start, end, edits)
    for index in code.near():
        token, after = code.tokens[index], code.get(index + 1)
        if token.text == "is" and after.text in _OPPOSITE:
            message = f"`is` and `{after.text}` do not go together. Write `{after.text}`."
            yield Guess("LRP517", message, token.start, after.end, (Edit(token.start, after.start, ""),))


_OPPOSITE = {"==": "!=", "=": "!=", "!=": "==", "<": ">=", ">": "<=", "<=": ">", ">=": "<"}
