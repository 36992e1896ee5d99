"""A reader of Smalltalk: of expressions, not of classes and methods."""

from __future__ import annotations

import re
from collections.abc import Iterator
from keyword import iskeyword
from typing import NamedTuple

from lrp_jupyter.language.python.scanner import LINE_END

LONGEST = 6_000
"""Characters of a block that is read."""
_DEEPEST = 30
"""Brackets inside brackets."""
_MOST = 30
"""Messages or operators one after the other."""

UNARY = frozenset({
    "not", "abs", "negated", "squared", "sqrt", "isNil", "notNil", "isEmpty", "notEmpty", "truncated",
    "rounded", "asInteger", "asString", "printString", "even", "odd",
})  # fmt: skip
"""Messages without an argument that any object may understand."""
KEYWORD = frozenset({
    "ifTrue:", "ifFalse:", "ifTrue:ifFalse:", "ifFalse:ifTrue:", "ifNil:", "ifNotNil:", "whileTrue:",
    "whileFalse:", "timesRepeat:", "to:do:", "to:by:do:", "do:", "collect:", "select:", "and:", "or:",
    "max:", "min:", "between:and:", "at:", "at:put:", "show:", "raisedTo:",
})  # fmt: skip
"""Messages with arguments that any object may understand."""
COMMANDS = frozenset({"read", "stop", "beep"})
"""Messages without an argument that are methods of a robot, not readings."""
_VALUES = {"true": "True", "false": "False", "nil": "None"}
_TRUTHS = frozenset({"True", "False"})
_COMPARISONS = frozenset({"=", "==", "~=", "~~", "<", ">", "<=", ">="})


class SmalltalkName(NamedTuple):
    """A variable, or an attribute as Python writes it: ``robot.light``."""

    text: str


class Literal(NamedTuple):
    """A value, in Python: `kind` is ``number``, ``text``, ``truth``, or empty."""

    text: str
    kind: str


class Send(NamedTuple):
    """A message without arguments, or one with `arguments` after the colons of its `selector`."""

    receiver: Node
    selector: str
    arguments: tuple[Node, ...] = ()


class Operation(NamedTuple):
    """Operands with the operators between them, which all bind alike."""

    operands: tuple[Node, ...]
    operators: tuple[str, ...]


class Cascade(NamedTuple):
    """Several messages to one receiver."""

    messages: tuple[Send, ...]


class Binding(NamedTuple):
    """``name := value``."""

    name: str
    value: Node


class Return(NamedTuple):
    """``^ value``."""

    value: Node


class Statement(NamedTuple):
    """A statement, and the comments before it."""

    node: Node
    comments: tuple[str, ...] = ()


class Closure(NamedTuple):
    """A block of Smalltalk with its parameters."""

    parameters: tuple[str, ...]
    statements: tuple[Statement, ...]


Node = SmalltalkName | Literal | Send | Operation | Cascade | Binding | Return | Closure


class Smalltalk(NamedTuple):
    """What is written in Smalltalk, at ``text[start:end]``."""

    statements: tuple[Statement, ...]
    start: int
    end: int


class _Token(NamedTuple):
    kind: str
    text: str
    start: int
    end: int
    line: int


_TOKEN = re.compile(
    r"""(?P<blank>\s+)|(?P<comment>"[^"]*")|(?P<string>'(?:[^']|'')*')"""
    r"""|(?P<number>\d+r[0-9A-Z]+|\d+(?:\.\d+)?(?:e-?\d+)?)(?!\w)"""
    r"""|(?P<keyword>[^\W\d]\w*:)(?!=)|(?P<name>[^\W\d]\w*(?:\.[^\W\d]\w*)*)|(?P<symbol>\#[^\W\d][\w:]*)"""
    r"""|(?P<assign>:=)|(?P<parameter>:\s*[^\W\d]\w*)"""
    r"""|(?P<sign>==|~=|~~|<=|>=|//|\\\\|[-+*/<>=&|,])|(?P<mark>[()\[\].;^])"""
)
_NOTHING = _Token("end", "", -1, -1, -1)


class _NotSmalltalkError(Exception):
    """The text cannot be read."""


def read(text: str) -> Smalltalk | None:
    """Return what a block holds if all of it is Smalltalk and something in it cannot be anything else."""
    if len(text) > LONGEST:
        return None
    try:
        reader = _SmalltalkReader(text)
        statements = reader.statements("end")
    except _NotSmalltalkError:
        return None
    if not reader.is_sure or not statements:
        return None
    return Smalltalk(statements, reader.tokens[0].start, reader.tokens[-1].end)


def _tokens(text: str) -> Iterator[_Token]:
    position = line = 0
    while position < len(text):
        match = _TOKEN.match(text, position)
        if match is None:
            raise _NotSmalltalkError
        kind: str = match.lastgroup  # type: ignore[assignment]
        if kind != "blank":
            yield _Token(kind, match[0], match.start(), match.end(), line)
        line += len(LINE_END.findall(match[0]))
        position = match.end()


class _SmalltalkReader:
    """Reads one text; `is_sure`: something in it can only be Smalltalk."""

    def __init__(self, text: str) -> None:
        self.tokens = list(_tokens(text))
        self.index = self.depth = 0
        self.comments: list[str] = []
        self.is_sure = False
        self.parameters: list[str] = []

    @property
    def token(self) -> _Token:
        """The next token that is not a comment."""
        while self.index < len(self.tokens) and self.tokens[self.index].kind == "comment":
            self.comments.append(self.tokens[self.index].text[1:-1])
            self.index += 1
        return self.tokens[self.index] if self.index < len(self.tokens) else _NOTHING

    def take(self, text: str = "") -> _Token:
        """Return the next token, which must be a text if one is given, and go on to the one after it."""
        token = self.token
        if token is _NOTHING or text not in ("", token.text):
            raise _NotSmalltalkError
        self.index += 1
        return token

    def statements(self, closing: str) -> tuple[Statement, ...]:
        """Read statements up to a bracket, or to the end."""
        if self.token.text == "|":
            self._temporaries()
        found: list[Statement] = []
        assigns = False
        while closing not in (self.token.kind, self.token.text):
            node = self._statement()
            found.append(Statement(node, tuple(self.comments)))
            self.comments.clear()
            assigns = assigns or isinstance(node, Binding)
            if self.token.text != ".":
                break
            while self.token.text == ".":
                self.take()
            self.is_sure = self.is_sure or assigns  # statements that end with a point
        if closing not in (self.token.kind, self.token.text):
            raise _NotSmalltalkError
        if self.comments and found:
            found[-1] = found[-1]._replace(comments=(*found[-1].comments, *self.comments))
            self.comments.clear()
        return tuple(found)

    def _temporaries(self) -> None:
        self.take("|")
        while self.token.kind == "name":
            self._name(self.take())
        self.take("|")
        self.is_sure = True

    def _statement(self) -> Node:
        if self.token.text != "^":
            return self._expression()
        self.take()
        self.is_sure = True
        return Return(self._expression())

    def _expression(self) -> Node:
        self.depth += 1
        if self.depth > _DEEPEST:
            raise _NotSmalltalkError
        start = self.index
        token = self.token
        if token.kind == "name":
            self.take()
            if self.token.kind == "assign":
                self.take()
                node: Node = Binding(self._name(token), self._expression())
                self.depth -= 1
                return node
            self.index = start
        node = self._cascade(self._arguments(self._operation()))
        self.depth -= 1
        return node

    def _cascade(self, first: Node) -> Node:
        if self.token.text != ";":
            return first
        if not isinstance(first, Send):
            raise _NotSmalltalkError
        messages = [first]
        while self.token.text == ";":
            self.take()
            if self.token.kind == "name":
                messages.append(Send(first.receiver, self._name(self.take())))
            else:
                sent = self._arguments(first.receiver)
                if not isinstance(sent, Send) or sent is first.receiver:
                    raise _NotSmalltalkError
                messages.append(sent)
        self.is_sure = self.is_sure or all(message.arguments for message in messages[:2])
        return Cascade(tuple(messages))

    def _arguments(self, receiver: Node) -> Node:
        """Read a message with arguments, if there is one."""
        selector = ""
        arguments: list[Node] = []
        while self.token.kind == "keyword":
            selector += self.take().text
            arguments.append(self._operation())
        if not arguments:
            return receiver
        told = selector in KEYWORD or root(receiver) in ("robot", *self.parameters)
        self.is_sure = self.is_sure or told or any(isinstance(each, Closure) for each in arguments)
        return Send(receiver, selector, tuple(arguments))

    def _operation(self) -> Node:
        operands = [self._unary()]
        operators: list[str] = []
        while self.token.kind == "sign":
            if len(operators) == _MOST:
                raise _NotSmalltalkError
            operators.append(self.take().text)
            operands.append(self._unary())
        return Operation(tuple(operands), tuple(operators)) if operators else operands[0]

    def _unary(self) -> Node:
        node = self._primary()
        sent: list[str] = []
        # A word in the next line is a forgotten sign rather than another message, in any language.
        while self.token.kind == "name" and self.token.line == self.tokens[self.index - 1].line:
            if len(sent) == _MOST:
                raise _NotSmalltalkError
            sent.append(self._name(self.take(), is_message=True))
            node = Send(node, sent[-1])
            if len(sent) > 1 and sent[-2] in COMMANDS | {"move", *UNARY} and sent[-1] not in UNARY:
                raise _NotSmalltalkError
        if sent and self.token.text in _COMPARISONS and sent[-1] == "not":
            pass  # `x not == 1` is a slip in Python; in Smalltalk it would compare a truth with a number
        elif sent and (sent[-1] in UNARY or (len(sent) > 1 and root(node) == "robot")):
            self.is_sure = True
        return node

    def _primary(self) -> Node:
        token = self.take()
        if token.text == "(":
            node = self._expression()
            self.take(")")
            return node
        if token.text == "[":
            return self._closure()
        if token.kind == "name":
            word = _VALUES.get(token.text, token.text)
            if word in _VALUES.values():
                return Literal(word, "truth" if word in _TRUTHS else "")
            return SmalltalkName(self._name(token, is_dotted=True))
        if token.text == "-" and self.token.kind == "number" and self.token.start == token.end:
            return Literal(f"-{_number(self.take().text)}", "number")
        if token.kind == "number":
            return Literal(_number(token.text), "number")
        if token.kind == "string":
            return Literal(repr(token.text[1:-1].replace("''", "'")), "text")
        if token.kind == "symbol":
            return Literal(repr(token.text[1:]), "text")
        raise _NotSmalltalkError

    def _closure(self) -> Node:
        parameters = []
        while self.token.kind == "parameter":
            parameters.append(self.take().text[1:].strip())
        if parameters:
            self.is_sure = True
            if self.token.text != "]":
                self.take("|")
        self.depth += 1
        if self.depth > _DEEPEST:
            raise _NotSmalltalkError
        self.parameters += parameters
        comments, self.comments = self.comments, []
        statements = self.statements("]")
        inside = [comment for each in statements for comment in each.comments]
        self.comments = comments + inside  # above the statement in which the block is
        self.take("]")
        del self.parameters[len(self.parameters) - len(parameters) :]
        self.depth -= 1
        return Closure(tuple(parameters), tuple(each._replace(comments=()) for each in statements))

    def _name(self, token: _Token, is_message: bool = False, is_dotted: bool = False) -> str:
        words = token.text.split(".")
        if (len(words) > 1 and not is_dotted) or words[0] in ("match", "case"):
            raise _NotSmalltalkError
        if any(map(iskeyword, words)) and not (is_message and token.text == "not"):
            raise _NotSmalltalkError
        return token.text


def _number(text: str) -> str:
    base, mark, digits = text.partition("r")
    if not mark:
        return text
    try:
        return str(int(digits, int(base)))
    except ValueError:
        raise _NotSmalltalkError from None


def root(node: Node) -> str:
    """Return the variable to which messages without arguments are sent; empty if it is none."""
    while isinstance(node, Send) and not node.arguments:
        node = node.receiver
    return node.text if isinstance(node, SmalltalkName) else ""
