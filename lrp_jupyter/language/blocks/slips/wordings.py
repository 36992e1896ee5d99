"""Python's messages about a block, in words for the author of a program: what is wrong, then what to write.

A message without such a sentence is quoted, with the lines of the program's file.
"""

from __future__ import annotations

import re

from lrp_jupyter.language.blocks.slips.code import OPENING

_LINE = re.compile(r"\bline (\d+)")
_QUOTED = re.compile(r"'([^' ]+)'")

PARTNERS = {"else": "if", "elif": "if", "except": "try", "finally": "try"}
"""What begins the statement that a keyword continues."""

_EMPTY = "in {1} has nothing in it. Write what it does below it, further right."
_WORDS = (
    (r"expected ':'", "A `:` is missing here. Insert it."),
    (r"unexpected indent", "This line begins too far right. Start it where the line above starts."),
    (
        r"unindent does not match",
        "This line begins where no line above begins. Start it below the line to which it belongs.",
    ),
    (r"expected an indented block after '([\w*]+)'.* on (line \d+)", f"The `{{0}}` {_EMPTY}"),
    (r"expected an indented block after function(.*) on (line \d+)", f"The `def` {_EMPTY}"),
    (r"expected an indented block after class(.*) on (line \d+)", f"The `class` {_EMPTY}"),
    (r"inconsistent use of tabs", "This line begins with tabs and spaces. Use spaces only."),
    (r"'(.)' was never closed", "This `{0}` is not closed. Write its `{closing}`."),
    (r"unmatched '(.)'", "Unmatched `{0}`: nothing is open here. Remove it."),
    (
        r"closing parenthesis '(.)' does not match opening parenthesis '(.)'",
        "`{0}` does not close `{1}`. Write `{closing}`.",
    ),
    (r"unterminated (?:f-|t-)?string", "This string is not closed. Write its second quote."),
    (r"unterminated triple-quoted", "This string is not closed. Write its three quotes at the end."),
    (
        r"cannot assign to .*Maybe you meant '=='",
        "Only a name can be assigned. Write `==` to compare, or a name before the `=`.",
    ),
    (
        r"cannot assign to|cannot delete|cannot use assignment",
        "Only a name can be assigned. Write one before the `=`.",
    ),
    (r"Maybe you meant '=='", "`=` assigns. Write `==` to compare."),
    (
        r"invalid (?:decimal|hexadecimal|octal|binary) literal",
        "This is neither a number nor a name. Correct it.",
    ),
    (r"leading zeros", "A number does not begin with 0. Remove the zero."),
    (r"invalid (?:non-printable )?character", "Python does not know this character. Remove it."),
    (r"'(break|continue)'", "`{0}` works only in a `for` or `while`. Remove it."),
    (
        r"positional argument follows keyword",
        "After an argument with a name, all others need one, too. Write `name=` before this one.",
    ),
    (r"keyword argument repeated: (\w+)", "`{0}` is passed twice. Remove one of the two."),
    (r"duplicate argument '(\w+)'", "Two parameters have the name `{0}`. Rename one of them."),
    (
        r"no binding for nonlocal '(\w+)'",
        "There is no variable `{0}` around this function. Remove the `nonlocal`, "
        "or declare `(var {0} := [value])`.",
    ),
    (
        r"name '(\w+)' is (?:assigned to|used prior to|used) (?:before )?(nonlocal|global)",
        "`{0}` is used before this `{1}`. Put the `{1}` first.",
    ),
    (r"unexpected character after line continuation", "Nothing may follow a `\\`. Remove it."),
    (
        r"expected 'except' or 'finally'",
        "This `try` has no `except`. Write `except Exception:` below it, and then what to do after an error.",
    ),
    (r"Missing parentheses in call to '(\w+)'", "A call needs parentheses. Write `{0}(…)`."),
    (r"expected '\('", "A `(` is missing here. Write `()` after the name."),
    (r"forgot a comma", "Something is missing here. Write a comma or an operator between the two values."),
    (
        r"too deeply nested|too many nested|too complex|stack overflow",
        "This is nested too deeply. Use several steps.",
    ),
    (r"import \* only", "A block cannot use `import *`. Write the names: `from math import sin, cos`."),
    (r"expected 'else' after 'if' expression", "This `if` needs an `else`, as in `1 if fast else 0`."),
    (r"unexpected EOF|incomplete input", "Something is missing at the end of this line. Complete it."),
)
_TABLE = [(re.compile(pattern), words) for pattern, words in _WORDS]


def in_words(message: str, found: str, line: int) -> str:
    """Return a sentence about an error in a block that begins in a line of the program.

    `found`: what is at the place of the error; empty at the end of a line.
    """
    message = _LINE.sub(lambda number: f"line {int(number[1]) + line - 1}", message)
    for pattern, words in _TABLE:
        if match := pattern.search(message):
            return words.format(*match.groups(), closing=OPENING.get(("", *match.groups())[-1], ""))
    if message == "invalid syntax":
        if not found:
            return "Something is missing at the end of this line. Complete it."
        if found == ":":
            return "Something is missing before this `:`. Complete it."
        if found in PARTNERS:
            return f"This `{found}` has no `{PARTNERS[found]}`. Start it below its `{PARTNERS[found]}`."
        return f"Python does not expect `{found}` here. Correct it, or what comes before it."
    quoted = _QUOTED.sub(r"`\1`", message).rstrip(".")
    return f"This block is not valid Python: {quoted}. Correct it."
