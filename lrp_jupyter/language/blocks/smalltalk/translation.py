"""From Smalltalk to Python."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from lrp_jupyter.language.blocks.smalltalk.syntax import (
    COMMANDS,
    KEYWORD,
    Binding,
    Cascade,
    Closure,
    Literal,
    Node,
    Operation,
    Return,
    Send,
    Smalltalk,
    SmalltalkName,
    Statement,
    root,
)
from lrp_jupyter.language.python.scanner import LINE_END


class UntranslatableError(Exception):
    """What it is in Python is not known."""


class _Written(NamedTuple):
    """An expression: its text, how tightly it binds, and what it certainly is (a kind, or empty)."""

    text: str
    level: int
    kind: str = ""


_CHOICE, _OR, _AND, _NOT, _COMPARISON, _BITS_OR, _BITS_AND, _SUM, _PRODUCT, _SIGN, _POWER, _ATOM = range(12)

_SIGNS = {
    "*": ("*", _PRODUCT), "/": ("/", _PRODUCT), "//": ("//", _PRODUCT), "\\\\": ("%", _PRODUCT),
    "+": ("+", _SUM), "-": ("-", _SUM), ",": ("+", _SUM),
    "=": ("==", _COMPARISON), "==": ("==", _COMPARISON), "~=": ("!=", _COMPARISON), "~~": ("!=", _COMPARISON),
    "<": ("<", _COMPARISON), ">": (">", _COMPARISON), "<=": ("<=", _COMPARISON), ">=": (">=", _COMPARISON),
    "&": ("and", _AND), "|": ("or", _OR),
}  # fmt: skip
_BITS = {"&": _BITS_AND, "|": _BITS_OR}
_EQUALITY = frozenset({"=", "==", "~=", "~~"})

_UNARY = {
    "not": ("not {}", _NOT, _NOT, "truth"),
    "abs": ("abs({})", _CHOICE, _ATOM, "number"),
    "negated": ("-{}", _SIGN, _SIGN, "number"),
    "squared": ("{} ** 2", _ATOM, _POWER, "number"),
    "sqrt": ("{} ** 0.5", _ATOM, _POWER, "number"),
    "isNil": ("{} is None", _BITS_OR, _COMPARISON, "truth"),
    "notNil": ("{} is not None", _BITS_OR, _COMPARISON, "truth"),
    "isEmpty": ("not {}", _NOT, _NOT, "truth"),
    "notEmpty": ("len({}) > 0", _CHOICE, _COMPARISON, "truth"),
    "truncated": ("int({})", _CHOICE, _ATOM, "number"),
    "rounded": ("round({})", _CHOICE, _ATOM, "number"),
    "asInteger": ("int({})", _CHOICE, _ATOM, "number"),
    "asString": ("str({})", _CHOICE, _ATOM, "text"),
    "printString": ("repr({})", _CHOICE, _ATOM, "text"),
    "even": ("{} % 2 == 0", _PRODUCT, _COMPARISON, "truth"),
    "odd": ("{} % 2 == 1", _PRODUCT, _COMPARISON, "truth"),
}
"""Messages: in Python, how tightly the receiver must bind, how tightly the whole binds, its kind."""
_METHODS = {"startAtSpeed:": "start_at_speed", "startAtPower:": "start_at_power"}
"""Messages with one argument to a motor, which are methods."""
_WORDS = {"linear_x": "linear", "angular_z": "angular"}
"""Fields of the message of `move` that have a shorter name."""


def written(found: Smalltalk, text: str, column: int, is_condition: bool) -> tuple[str, bool]:
    """Return the same in Python, its lines below `column`, and whether nothing else can be meant.

    Raises UntranslatableError.
    """
    writer = _Translation(is_condition)
    lines: list[tuple[int, str]] = []
    for statement in found.statements:
        lines += writer.statement(statement, 0, statement is found.statements[-1])
    is_flat = not any(depth or line.startswith("#") for depth, line in lines)
    if is_flat and not LINE_END.search(text, found.start, found.end):
        return "; ".join(line for _, line in lines), writer.is_certain
    return f"\n{' ' * column}".join("    " * depth + line for depth, line in lines), writer.is_certain


class _Translation:
    def __init__(self, is_condition: bool) -> None:
        self.is_condition = is_condition
        self.is_certain = True

    # Statements

    def statement(self, statement: Statement, depth: int, is_last: bool) -> Iterator[tuple[int, str]]:
        """Yield the lines of a statement with their depths."""
        for comment in statement.comments:
            yield from ((depth, f"# {line.strip()}") for line in LINE_END.split(comment))
        node = statement.node
        if isinstance(node, Cascade):
            if root(node.messages[0].receiver) == "":
                raise UntranslatableError
            for message in node.messages:
                yield from self._simple(message, depth, False)
        else:
            yield from self._simple(node, depth, is_last and self.is_condition)

    def _simple(self, node: Node, depth: int, is_tested: bool) -> Iterator[tuple[int, str]]:
        if isinstance(node, Binding):
            names = ""
            while isinstance(node, Binding):
                names += f"{node.name} = "
                node = node.value
            yield depth, names + self.write(node).text
        elif isinstance(node, Return):
            yield depth, f"return {self.write(node.value).text}"
        elif isinstance(node, Send) and node.selector in _CONTROL and not is_tested:
            yield from self._control(node, depth)
        elif isinstance(node, Operation) and not is_tested and (assigned := _assigned(node)):
            yield depth, f"{node.operands[0].text} = {self.write(assigned).text}"  # type: ignore[union-attr]
        elif isinstance(node, Send) and root(node) == "Transcript" and node.selector == "cr":
            yield depth, "print()"
        elif isinstance(node, Send) and root(node.receiver) == "Transcript" and node.selector == "show:":
            yield depth, f"print({self.write(node.arguments[0]).text})"
        else:
            yield depth, self.write(node, is_tested=is_tested).text

    def _control(self, node: Send, depth: int) -> Iterator[tuple[int, str]]:
        receiver, selector, arguments = node
        if selector in ("whileTrue:", "whileFalse:"):
            test = self.write(_value_of(receiver))
            shown = test.text if selector == "whileTrue:" else f"not {_at_least(test, _NOT)}"
            yield depth, f"while {shown}:"
        elif selector == "timesRepeat:":
            yield depth, f"for _ in range({self.write(receiver).text}):"
        elif selector == "to:do:":
            last = _at_least(self.write(arguments[0]), _SUM)
            yield depth, f"for {_parameter(arguments[1])} in range({self.write(receiver).text}, {last} + 1):"
        elif selector == "do:":
            yield depth, f"for {_parameter(arguments[0])} in {self.write(receiver).text}:"
        else:
            test = self.write(receiver)
            is_negated = selector.startswith("ifFalse:")
            yield depth, f"if {f'not {_at_least(test, _NOT)}' if is_negated else test.text}:"
            if len(arguments) > 1:
                yield from self._body(arguments[0], depth + 1)
                yield depth, "else:"
        yield from self._body(arguments[-1], depth + 1)

    def _body(self, node: Node, depth: int) -> Iterator[tuple[int, str]]:
        if not isinstance(node, Closure):
            raise UntranslatableError
        if not node.statements:
            yield depth, "pass"
        for statement in node.statements:
            yield from self.statement(statement, depth, False)

    # Expressions

    def write(self, node: Node, is_tested: bool = False) -> _Written:
        """Return an expression; `is_tested`: it is used as a condition."""
        if isinstance(node, SmalltalkName):
            return _Written(node.text, _ATOM)
        if isinstance(node, Literal):
            return _Written(node.text, _SIGN if node.text[0] == "-" else _ATOM, node.kind)
        if isinstance(node, Operation):
            return self._operation(node, is_tested)
        if isinstance(node, Send):
            return self._keyword(node) if node.arguments else self._unary(node)
        raise UntranslatableError

    def _unary(self, node: Send) -> _Written:
        receiver = self.write(node.receiver)
        if node.selector not in _UNARY:
            if root(node) != "robot":
                raise UntranslatableError
            call = "()" if node.selector in COMMANDS else ""
            return _Written(f"{receiver.text}.{node.selector}{call}", _ATOM)
        pattern, inner, level, kind = _UNARY[node.selector]
        if node.selector == "rounded":
            self.is_certain = False  # 2.5 becomes 2 in Python and 3 in Smalltalk
        return _Written(pattern.format(_at_least(receiver, inner)), level, kind)

    def _keyword(self, node: Send) -> _Written:
        receiver, selector, arguments = node
        if root(receiver) == "robot" and selector not in KEYWORD:
            return self._command(node)
        if selector in ("and:", "or:"):
            operands = self.write(receiver), self.write(_value_of(arguments[0]))
            return self._applied("&" if selector == "and:" else "|", *operands, True)
        if selector in ("ifTrue:ifFalse:", "ifFalse:ifTrue:"):
            yes, no = (self.write(_value_of(each)) for each in arguments)
            if selector == "ifFalse:ifTrue:":
                yes, no = no, yes
            test = _at_least(self.write(receiver), _OR)
            return _Written(f"{_at_least(yes, _OR)} if {test} else {no.text}", _CHOICE)
        first, *others = (self.write(each) for each in (receiver, *arguments))
        if selector in ("max:", "min:"):
            return _Written(f"{selector[:-1]}({first.text}, {others[0].text})", _ATOM, "number")
        if selector == "raisedTo:":
            return _Written(f"{_at_least(first, _ATOM)} ** {_at_least(others[0], _SIGN)}", _POWER, "number")
        if selector == "between:and:":
            low, middle, high = (_at_least(each, _BITS_OR) for each in (others[0], first, others[1]))
            return _Written(f"{low} <= {middle} <= {high}", _COMPARISON, "truth")
        raise UntranslatableError

    def _command(self, node: Send) -> _Written:
        """Return what a robot is told: a message that a block fills, or a method with one argument."""
        receiver, selector, arguments = node
        if len(arguments) > 1:
            raise UntranslatableError
        path, (argument,) = self.write(receiver).text, arguments
        if isinstance(argument, Closure):
            name = selector[:-1]
            fields = self._fields(argument)
            if name == "move":
                fields = {_WORDS.get(field, field): value for field, value in fields.items()}
            shown = ", ".join(f"{field}={value}" for field, value in fields.items())
            return _Written(f"{path}.{name}({shown})", _ATOM)
        if selector not in _METHODS:
            self.is_certain = False
        return _Written(f"{path}.{_METHODS.get(selector, selector[:-1])}({self.write(argument).text})", _ATOM)

    def _fields(self, block: Closure) -> dict[str, str]:
        """Return the fields that a block sets of its one parameter: ``[:msg | msg linear x: 1]``."""
        fields: dict[str, str] = {}
        for statement in block.statements:
            node = statement.node
            for message in node.messages if isinstance(node, Cascade) else (node,):
                if not isinstance(message, Send) or len(message.arguments) != 1:
                    raise UntranslatableError
                path = self._path(message.receiver, block)
                field = "_".join([*path, message.selector[:-1]])
                if field in fields:
                    raise UntranslatableError
                fields[field] = self.write(message.arguments[0]).text
        return fields

    def _path(self, node: Node, block: Closure) -> list[str]:
        path: list[str] = []
        while isinstance(node, Send) and not node.arguments:
            path.insert(0, node.selector)
            node = node.receiver
        if (node.text if isinstance(node, SmalltalkName) else "",) != block.parameters:
            raise UntranslatableError
        return path

    # Operators

    def _operation(self, node: Operation, is_tested: bool) -> _Written:
        """Return operands with their operators, from left to right, as Smalltalk computes.

        `robot light data > lightlim + 10` would then add 10 to a truth value. Where the order from left to
        right makes no sense, the author must have meant that of mathematics, which is Python's.
        """
        operands = [self.write(each) for each in node.operands]
        if _is_sensible(operands, node.operators):
            whole = operands[0]
            *before, last = zip(node.operators, operands[1:], strict=True)
            for sign, operand in before:
                whole = self._applied(sign, whole, operand, False)
            return self._applied(last[0], whole, last[1], is_tested)
        return self._usual(operands, list(node.operators), is_tested)

    def _usual(self, operands: Sequence[_Written], signs: Sequence[str], is_tested: bool) -> _Written:
        """Return operands with their operators in the order of mathematics."""
        if not signs:
            return operands[0]
        loosest = min(_SIGNS[sign][1] for sign in signs)
        at = max(index for index, sign in enumerate(signs) if _SIGNS[sign][1] == loosest)
        left = self._usual(operands[: at + 1], signs[:at], False)
        right = self._usual(operands[at + 1 :], signs[at + 1 :], False)
        return self._applied(signs[at], left, right, is_tested)

    def _applied(self, sign: str, left: _Written, right: _Written, is_tested: bool) -> _Written:
        python, level = _SIGNS[sign]
        kinds = {left.kind, right.kind}
        if sign in _BITS:
            kind = "truth"
            if "number" in kinds:  # of integers, it combines the bits
                python, level, kind = sign, _BITS[sign], "number"
            elif "truth" not in kinds and not is_tested:
                self.is_certain = False
        elif sign == ",":
            kind = "text"
            self.is_certain = self.is_certain and kinds == {"text"}
        else:
            kind = "truth" if level == _COMPARISON else "number"
        inner = level + 1 if level == _COMPARISON else level  # Python chains comparisons
        return _Written(f"{_at_least(left, inner)} {python} {_at_least(right, level + 1)}", level, kind)


_CONTROL = frozenset({
    "ifTrue:", "ifFalse:", "ifTrue:ifFalse:", "ifFalse:ifTrue:", "whileTrue:", "whileFalse:", "timesRepeat:",
    "to:do:", "do:",
})  # fmt: skip


def _at_least(python: _Written, level: int) -> str:
    return python.text if python.level >= level else f"({python.text})"


def _is_sensible(operands: Sequence[_Written], signs: Sequence[str]) -> bool:
    """Return whether nothing is computed with truths, or compared in size, from left to right."""
    kind = operands[0].kind
    for sign, operand in zip(signs, operands[1:], strict=True):
        level = _SIGNS[sign][1]
        if sign not in _BITS and sign not in _EQUALITY and "truth" in (kind, operand.kind):
            return False
        if level == _COMPARISON:
            kind = "truth"
        elif sign in _BITS:
            kind = "truth" if "number" not in (kind, operand.kind) else "number"
        else:
            kind = "number"
    return True


def _assigned(node: Operation) -> Node | None:
    """Return what a comparison without a use assigns: `nobump = false` is meant to change `nobump`."""
    first, *others = node.operands
    if node.operators[0] != "=" or not isinstance(first, SmalltalkName) or "." in first.text:
        return None
    return Operation(tuple(others), node.operators[1:]) if node.operators[1:] else others[0]


def _value_of(node: Node) -> Node:
    """Return the one expression in a block."""
    if isinstance(node, Closure) and not node.parameters and len(node.statements) == 1:
        return node.statements[0].node
    raise UntranslatableError


def _parameter(node: Node) -> str:
    if isinstance(node, Closure) and len(node.parameters) == 1:
        return node.parameters[0]
    raise UntranslatableError
