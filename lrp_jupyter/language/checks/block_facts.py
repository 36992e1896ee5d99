"""Facts about a block that depend on its text alone, not on where it is; computed once per text."""

from __future__ import annotations

import ast
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from typing import NamedTuple

from lrp_jupyter.errors import Edit
from lrp_jupyter.language.blocks.names_in_blocks import Use, Uses
from lrp_jupyter.language.checks.misreadings import misreadings
from lrp_jupyter.language.checks.scanned import ScannedBlock, scanned
from lrp_jupyter.language.checks.uses import SIGNS, Other
from lrp_jupyter.language.program import Span
from lrp_jupyter.language.python.block_suite import children
from lrp_jupyter.language.source import Diagnosis

_CONSTANTS: dict[type, str] = {
    bool: "a truth value",
    int: "a number",
    float: "a number",
    str: "a string",
    type(None): "`None`",
}
_DISPLAYS: dict[type[ast.expr], str] = {
    ast.JoinedStr: "a string",
    ast.List: "a list",
    ast.ListComp: "a list",
    ast.Tuple: "a tuple",
    ast.Set: "a set",
    ast.SetComp: "a set",
    ast.Dict: "a dictionary",
    ast.DictComp: "a dictionary",
    ast.Lambda: "a function",
    ast.GeneratorExp: "a generator",
}


class Word(NamedTuple):
    """A name and its span; `nested`: whether it is in a function inside the block."""

    name: str
    span: Span
    nested: bool


class Remark(NamedTuple):
    """A suspicious place, with the range that a fix would replace.

    `name`: the variable that a fix would assign or compare; for a bitwise operator, the operator.
    `last`: whether it is the last statement of the block, and so its value.
    `is_test`: whether what it assigns is a comparison or the like; `edit` is then what stands before that.
    """

    span: Span
    edit: Span | None = None
    name: str = ""
    last: bool = False
    is_test: bool = False


class Inner(NamedTuple):
    """A name that a function in the block assigns for itself only.

    `lost`: the function never reads it; else it reads it before it has a value.
    `edit`: inserts the `nonlocal` that is missing.
    """

    name: str
    span: Span
    lost: bool
    edit: Edit


@dataclass(frozen=True, slots=True)
class Facts:
    """What a block does with names and values; all spans are offsets in its text.

    `reads`: names that it reads and does not bind: variables, or names from outside the program.
    `nonlocals`: names that a function inside declares `nonlocal` and that the block does not bind.
    `binds`: names that it binds (a variable, if there is one in scope; else local to it), with a position.
    `augmented`: names that it updates (``x += 1``) in a scope that does not otherwise bind them.
    `comparisons`, `uncalled`, `bitwise`: statements that only compare, statements that only name a member of
        the robot, and comparisons with a bitwise operator where a logical one was probably meant.
    `valueless`: its last statement, if its value is None for certain.
    `literal`: kind and place of its value, if that is written as a literal.
    `test`: the place of its value, if that is `True` or `False` for certain.
    `texts`: names that it compares with a text, and that text.
    `numbers`: names that it binds, and to nothing but numbers.
    `misread`: Python that means something other than it seems to.
    `inner`: names that functions inside assign without `nonlocal`, and without any use.
    `unread`: names that it assigns and never reads.
    """

    reads: tuple[Word, ...] = ()
    nonlocals: tuple[Word, ...] = ()
    binds: dict[str, Span] = field(default_factory=dict)
    augmented: tuple[Word, ...] = ()
    comparisons: tuple[Remark, ...] = ()
    uncalled: tuple[Remark, ...] = ()
    bitwise: tuple[Remark, ...] = ()
    valueless: Remark | None = None
    literal: tuple[str, Span] | None = None
    test: Span | None = None
    texts: tuple[tuple[str, Other], ...] = ()
    numbers: frozenset[str] = frozenset()
    misread: tuple[Diagnosis, ...] = ()
    inner: tuple[Inner, ...] = ()
    unread: tuple[Word, ...] = ()


@lru_cache(maxsize=20_000)
def facts_of(text: str) -> Facts:
    """Return the facts about a block; empty for one that is not valid Python."""
    places = scanned(text)
    if places is None:
        return Facts()
    tree, found = places.tree, places.names
    values = _Values(tree.body, places)
    changed = {places.span(node.target) for node in values.changes}
    augmented = _augmented(found, changed, places)
    block = found.scope
    free = [use for use in found.found if use.owner is block]
    unbound = [use for use in free if not use.writes and use.name not in block.bound]
    declared = {(use.scope, use.name): use for use in reversed(unbound) if use.name in use.scope.outer_names}
    written = block.bound - {word.name for word in augmented}
    others = {use.name for use in free if use.writes and use.start not in values.numbers[use.name]}
    return Facts(
        reads=tuple(_word(use, places) for use in unbound if use.name not in use.scope.outer_names),
        nonlocals=tuple(_word(use, places) for use in declared.values()),
        binds={use.name: _word(use, places).span for use in free if use.writes and use.name in written},
        augmented=augmented,
        comparisons=tuple(values.comparisons),
        uncalled=tuple(values.uncalled),
        bitwise=tuple(values.bitwise),
        valueless=values.valueless(),
        literal=values.literal(),
        test=values.test(),
        texts=tuple(values.texts),
        numbers=frozenset(values.numbers) - others,
        misread=misreadings(tree, places, places.shift),
        inner=tuple(_inner(values.functions, found, places)),
        unread=tuple(_unread(tree.body, free, found, places)),
    )


def _word(use: Use, places: ScannedBlock) -> Word:
    start = use.start + places.shift
    return Word(use.name, Span(start, start + use.length), use.scope.outer is not None)


def _augmented(found: Uses, changed: set[Span], places: ScannedBlock) -> tuple[Word, ...]:
    """Return the names that are updated in a scope that never binds them first."""
    writes = defaultdict(list)
    for use in found.found:
        scope = use.scope
        if use.writes and not (scope.is_class or use.name in scope.outer_names | scope.global_names):
            writes[scope, use.name].append(_word(use, places))
    return tuple(
        word for words in writes.values() if all(word.span in changed for word in words) for word in words
    )


def _inner(
    functions: list[ast.FunctionDef | ast.AsyncFunctionDef], found: Uses, places: ScannedBlock
) -> Iterator[Inner]:
    """Yield the names that functions assign by a statement of their own body, to no effect."""
    by_start = {each.start: each for each in found.found if each.writes}
    for function in functions:
        first = next((each for each in function.body if not _is_text(each)), function.body[0])
        start = places.start_of(first)
        line = places.source.rfind("\n", 0, start) + 1
        margin = places.source[line:start]
        after = "; " if margin.strip() else f"\n{margin}"
        seen: set[str] = set()
        for statement in _statements(function.body):
            target: ast.expr
            if isinstance(statement, ast.AugAssign):
                target = statement.target
            elif isinstance(statement, ast.Assign) and len(statement.targets) == 1:
                target = statement.targets[0]
            else:
                continue
            use = by_start.get(places.start_of(target)) if isinstance(target, ast.Name) else None
            if use is None or use.name in seen or use.name in use.scope.outer_names | use.scope.global_names:
                continue
            seen.add(use.name)
            mine = [each for each in found.found if each.owner is use.scope and each.name == use.name]
            reads = [each.start for each in mine if not each.writes]
            writes = [each.start for each in mine if each.writes]
            changes = isinstance(statement, ast.AugAssign) and min([*writes, *reads]) == use.start
            itself = [at for at in reads if places.start_of(statement) < at < places.end_of(statement)]
            changes |= bool(itself) and min(writes) == use.start and min(reads) == itself[0]
            if changes or not (reads or isinstance(statement, ast.AugAssign)):
                at = start + places.shift
                edit = Edit(at, at, f"nonlocal {use.name}{after}")
                yield Inner(use.name, _word(use, places).span, not changes, edit)


def _statements(body: list[ast.stmt]) -> Iterator[ast.AST]:
    """Yield the statements of a function, those of functions and classes inside left out."""
    waiting: list[ast.AST] = list(reversed(body))
    while waiting:
        node = waiting.pop()
        if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef | ast.expr):
            yield node
            waiting += reversed(children([node]))


def _is_text(statement: ast.stmt) -> bool:
    return isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)


def _unread(body: list[ast.stmt], free: list[Use], found: Uses, places: ScannedBlock) -> Iterator[Word]:
    """Yield the names that a block assigns by a plain statement, and reads nowhere."""
    read = {use.name for use in found.found if not use.writes}
    by_start = {use.start: use for use in free if use.writes and use.name not in read}
    for statement in ast.walk(ast.Module(body, [])) if by_start else ():
        if isinstance(statement, ast.Assign) and len(statement.targets) == 1:
            use = by_start.get(places.start_of(statement.targets[0]))
            if use is not None and isinstance(statement.targets[0], ast.Name):
                yield _word(use, places)


class _Values:
    """Finds statements of a block without an effect or a value."""

    def __init__(self, body: list[ast.stmt], places: ScannedBlock) -> None:
        self.places = places
        self.last = body[-1] if body else None
        self.returns = False
        self.changes: list[ast.AugAssign] = []
        self.comparisons: list[Remark] = []
        self.uncalled: list[Remark] = []
        self.bitwise: list[Remark] = []
        self.functions: list[ast.FunctionDef | ast.AsyncFunctionDef] = []
        self.texts: list[tuple[str, Other]] = []
        self.numbers: dict[str, set[int]] = defaultdict(set)  # where they are bound to one
        waiting: list[tuple[ast.AST, bool]] = [(statement, False) for statement in reversed(body)]
        while waiting:
            node, nested = waiting.pop()
            self._inspect(node, nested)
            nested = nested or isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda)
            if not isinstance(node, ast.JoinedStr):  # positions inside one are wrong before Python 3.12
                waiting += [(child, nested) for child in children([node])]

    def _inspect(self, node: ast.AST, nested: bool) -> None:
        if isinstance(node, ast.Expr):
            self._statement(node)
        elif isinstance(node, ast.Compare):
            self._comparison(node)
        elif isinstance(node, ast.AugAssign):
            if isinstance(node.target, ast.Name):
                self.changes.append(node)
                self.numbers[node.target.id].add(self.places.start_of(node.target))
        elif isinstance(node, ast.Assign):
            target = node.targets[0]
            if isinstance(target, ast.Name) and len(node.targets) == 1 and _is_number(node.value, target.id):
                self.numbers[target.id].add(self.places.start_of(target))
        elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            self.functions.append(node)
        elif isinstance(node, ast.Return):
            self.returns |= not nested and node.value is not None

    def _statement(self, node: ast.Expr) -> None:
        value, span, last = node.value, self.places.span(node.value), node is self.last
        if isinstance(value, ast.Compare):
            name = _root(value.left)
            single = len(value.ops) == 1 and isinstance(value.ops[0], ast.Eq)
            edit = self.places.between(value.left, "==", value.comparators[0]) if single and name else None
            right = value.comparators[0]
            if name and isinstance(value.ops[0], ast.Lt) and isinstance(right, ast.UnaryOp):  # `x <- 5`
                edit = self.places.between(value.left, "<-", right.operand)
            self.comparisons.append(Remark(span, edit, name, last))
        elif isinstance(value, ast.Attribute) and _root(value) == "robot":
            self.uncalled.append(Remark(span, last=last))

    def _comparison(self, node: ast.Compare) -> None:
        """Register comparisons such as `a == 1 & b`, where a bitwise operation of a literal is unlikely."""
        before = node.left
        for index, operand in enumerate(node.comparators):
            written = SIGNS.get(type(node.ops[index]))
            for name, text in ((before, operand), (operand, before)):
                if written and isinstance(name, ast.Name) and _kind(text) == "a string":
                    value = text.value if isinstance(text, ast.Constant) else None
                    self.texts.append((name.id, Other(written, "text", self.places.span(text), value)))
            if isinstance(operand, ast.BinOp) and isinstance(operand.left, ast.Constant):
                sign = {ast.BitAnd: "&", ast.BitOr: "|"}.get(type(operand.op))
                if sign and not self.places.between(before, "(", operand):
                    edit = self.places.between(operand.left, sign, operand.right)
                    self.bitwise.append(Remark(self.places.span(node), edit, sign))
            before = operand

    def valueless(self) -> Remark | None:
        """Return the last statement, if the block's value is None for certain."""
        last = self.last
        if last is None or self.returns or isinstance(last, ast.Expr | ast.Raise):
            return None
        span = self.places.span(last)
        if isinstance(last, ast.Assign) and len(last.targets) == 1 and _root(last.targets[0]):
            target = last.targets[0]
            if isinstance(target, ast.Name) and _is_test(last.value):
                before = Span(span.start, self.places.start_of(last.value) + self.places.shift)
                return Remark(span, before, _root(target), last=True, is_test=True)
            return Remark(span, self.places.between(target, "=", last.value), _root(target), last=True)
        return Remark(span, last=True)

    def literal(self) -> tuple[str, Span] | None:
        """Return the kind and place of the block's value, if that is a literal."""
        if self.returns or not isinstance(self.last, ast.Expr):
            return None
        kind = _kind(self.last.value)
        return (kind, self.places.span(self.last)) if kind else None

    def test(self) -> Span | None:
        """Return the place of the block's value, if that is `True` or `False` for certain."""
        if self.returns or not isinstance(self.last, ast.Expr) or not _is_truth(self.last.value):
            return None
        return self.places.span(self.last)


_MEASURES = frozenset({"abs", "float", "int", "len", "round"})
_OF_NUMBERS = ast.Sub | ast.Div | ast.FloorDiv | ast.Pow


def _is_number(node: ast.expr, known: str) -> bool:
    """Return whether an expression is certainly a number, if the name `known` is one."""
    if isinstance(node, ast.UnaryOp):
        return not isinstance(node.op, ast.Not) and _is_number(node.operand, known)
    if isinstance(node, ast.BinOp):
        both = _is_number(node.left, known) and _is_number(node.right, known)
        return both or isinstance(node.op, _OF_NUMBERS)
    if isinstance(node, ast.Call):
        return isinstance(node.func, ast.Name) and node.func.id in _MEASURES
    return _kind(node) == "a number" or (isinstance(node, ast.Name) and node.id == known)


def _is_test(node: ast.expr) -> bool:
    """Return whether an expression is a comparison, a negation, or begins with one."""
    if isinstance(node, ast.BoolOp):
        return _is_test(node.values[0])
    return isinstance(node, ast.Compare) or (isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not))


def _is_truth(node: ast.expr) -> bool:
    """Return whether the value of an expression is certainly `True` or `False`."""
    return all(map(_is_truth, node.values)) if isinstance(node, ast.BoolOp) else _is_test(node)


def _root(node: ast.expr) -> str:
    """Return the first name of an assignable expression, ``msg`` of ``msg.linear.x``; else an empty text."""
    while isinstance(node, ast.Attribute | ast.Subscript):
        node = node.value
    return node.id if isinstance(node, ast.Name) else ""


def _kind(node: ast.expr) -> str | None:
    """Return what kind of value a literal has; None for any other expression."""
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.UAdd):
        return _kind(node.operand)
    if isinstance(node, ast.Constant):
        return _CONSTANTS.get(type(node.value), "a constant")
    return _DISPLAYS.get(type(node))
