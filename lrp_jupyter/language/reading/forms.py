"""The grammar of one form: lark checks its tokens; this module describes what was expected instead."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from importlib.resources import files
from typing import Any, NamedTuple

from lark import Lark, Token, UnexpectedToken
from lark.lexer import Lexer

from lrp_jupyter.language.reading.tokens import LEGAL
from lrp_jupyter.language.triggers import FORMS

USAGE = {
    "var": "(var name := [value])",
    "machine": "(machine name …)",
    "state": "(state name …)",
    "onentry": "(onentry [action])",
    "running": "(running [action])",
    "onexit": "(onexit [action])",
    "event": "(event name [condition])",
    "spawn": "(spawn machine state)",
    **{keyword: form.usage for keyword, form in FORMS.items()},
    "effect": "(effect [action])",
    "onpause": "(onpause [action])",
    "onresume": "(onresume [action])",
    "onend": "(onend [action])",
}


class Shape(NamedTuple):
    """The roles of the tokens of a transition; indices count from the keyword, which is 0.

    `trigger`: none for an ``eps``, two for the state of a machine. `hold`: the delay after ``for``.
    """

    trigger: tuple[int, ...]
    hold: int | None
    source: str
    sources: tuple[int, ...]
    destination: int
    name: int | None
    effect: int | None

    @property
    def first_of_source(self) -> int:
        """The first token of the source, which may be a bracket or a `*`."""
        return max((0, *self.trigger, self.hold or 0)) + 1


class Mistake(NamedTuple):
    """The position of the first wrong token of a form, and the tokens allowed there."""

    position: int
    expected: frozenset[str]


class _Tokens(Lexer):
    """A lexer that passes the tokens of a form to lark; the value of each is its index."""

    def __init__(self, lexer_conf: Any) -> None:
        pass

    def lex(self, data: Any, _: Any = None) -> Iterator[Token]:
        """Yield a token for every type."""
        for index, kind in enumerate(data):
            yield Token(kind, index)


_GRAMMAR = files("lrp_jupyter.language").joinpath("grammar.lark").read_text(encoding="utf-8")
_LARK = Lark(_GRAMMAR, parser="lalr", lexer=_Tokens, start=["form", "program"], maybe_placeholders=True)
_REPEATABLE = frozenset(["BLOCK", *(f"{keyword.upper()}_FORM" for keyword in USAGE)])
_SINGLE = frozenset({"VAR", "EVENT", *map(str.upper, FORMS)})  # forms with one block or one effect


@lru_cache(maxsize=4096)
def shape_of(types: tuple[str, ...]) -> Shape | Mistake | None:
    """Parse one form, given by the types of its tokens, the first ``PROGRAM`` for the top level.

    Return None for a valid form that is not a transition.
    """
    shape = _shape(_condensed(types))
    return _shape(types) if isinstance(shape, Mistake) else shape


def _condensed(types: tuple[str, ...]) -> tuple[str, ...]:
    """Return the types without repeated blocks and forms, so that few distinct sequences reach lark."""
    head = next((index for index, kind in enumerate(types) if kind in _REPEATABLE), None)
    if head is None or len(types) - head < 2 or types[0] in _SINGLE:
        return types
    tail = set(types[head:])
    return (*types[:head], *sorted(tail)) if tail <= _REPEATABLE else types


@lru_cache(maxsize=4096)
def _shape(types: tuple[str, ...]) -> Shape | Mistake | None:
    try:
        if types[0] == "PROGRAM":
            _LARK.parse(types[1:], start="program")
            return None
        tree: Any = _LARK.parse(types, start="form")
    except UnexpectedToken as error:
        token: Any = error.token
        position = len(types) if token.type == "$END" else token.value + (types[0] == "PROGRAM")
        return Mistake(position, frozenset(error.accepts or error.expected))
    if tree.data not in FORMS:
        return None
    *head, source, destination, name, effect = tree.children[1:]
    trigger, hold = (*head, None, None)[:2]
    return Shape(
        trigger=() if trigger is None else tuple(t.value for t in trigger.children if t.type != "DOT"),
        hold=None if hold is None else hold.children[1].children[0].value,
        source=source.data,
        sources=tuple(token.value for token in source.scan_values(lambda token: token.type == "NAME")),
        destination=destination.value,
        name=None if name is None else name.value,
        effect=None if effect is None else effect.value,
    )


_WORDS = {
    "BLOCK": "a block `[…]`",
    "INTEGER": "a whole number of milliseconds",
    "ARROW": "`->`",
    "ASSIGN": "`:=`",
    "STAR": "`*`",
    "MINUS": "`-`",
    "LBRACE": "`{`",
    "RBRACE": "`}`",
    "$END": "`)`",
}


_JOINTS = {"DOT": "`.`", "FOR": "`for`"}
"""What may also follow an event: it is expected only where nothing else is."""


def expected_text(keyword: str, before: tuple[str, ...], expected: frozenset[str]) -> str:
    """Return in words what could follow the tokens `before` of a form."""
    words = [] if "NAME" not in expected else [_name_word(keyword, before)]
    words += [word for kind, word in _WORDS.items() if kind in expected]
    words = words or [word for kind, word in _JOINTS.items() if kind in expected]
    forms = [form for form in sorted(LEGAL.get(keyword, ())) if f"{form.upper()}_FORM" in expected]
    words += [f"{article(form)} `{form}`" for form in forms]
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} or {words[-1]}"


def _name_word(keyword: str, before: tuple[str, ...]) -> str:
    if keyword == "spawn":
        return "the machine's name" if len(before) == 1 else "the name of its start state"
    if keyword not in FORMS:
        return "its name"
    if before[-1] == "DOT":
        return "a state of the machine"
    if before[-1] == "FOR":
        return FORMS["ontime"].name
    if before[-1] == "ARROW":
        return "the destination state"
    if "ARROW" in before:
        return "the transition's name"
    if "LBRACE" in before:
        return "a state's name"
    return (FORMS[keyword].name if len(before) == 1 else "") or "the source state"


def article(word: str) -> str:
    """Return `a` or `an`."""
    return "an" if word[0] in "aeio" else "a"


def short(text: str) -> str:
    """Return a piece of the text in one line, and its beginning if it is long."""
    words = " ".join(text.split())
    return words if len(words) < 30 else words[:27] + "…"
