"""Blocks: Python between square brackets, from text to a function bound to the program's variables.

A block is any Python, in any layout: it may begin in the middle of a line and continue on others. It is
never dedented as text, which would change its strings. Instead its lines are kept as they are, and a prefix
(an indentation, and a header above it if the other lines are indented too) makes the whole a Python suite.
Then the positions in the tree are mapped back to those of the code, so a traceback shows the line and the
column of the program's text.

To access the program's variables, the block becomes the inner one of two functions. The outer one, never
called, has the variables as parameters, so the compiler makes them free variables of the inner one, and
:func:`bind` passes it a cell for each. That is as fast as local variables, and nothing is written into any
namespace. Paper: §5.2, where classes are generated instead.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Collection, Iterator, Mapping
from functools import lru_cache
from types import CellType, CodeType, FunctionType
from typing import Any, NamedTuple

from lrp_jupyter.language.blocks.builtin_names import PROVIDED
from lrp_jupyter.language.blocks.companions import COMPANIONS, with_companions
from lrp_jupyter.language.blocks.computed_names import computed, machine_cell, value_cell
from lrp_jupyter.language.blocks.names_in_blocks import WORD, Offsets, Uses, normal, uses
from lrp_jupyter.language.blocks.slips import brief, explain, fault_of
from lrp_jupyter.language.blocks.smalltalk import smalltalk
from lrp_jupyter.language.program import Block, Span
from lrp_jupyter.language.python.block_suite import Suite, children, no_warnings, parse_suite
from lrp_jupyter.language.python.python_parser import asked_again, parse_python
from lrp_jupyter.language.python.scanner import LINE_END
from lrp_jupyter.language.source import Diagnosis

_SIMPLE = frozenset(
    {ast.Expr, ast.Assign, ast.AugAssign, ast.If, ast.Pass}
    | {ast.Name, ast.Attribute, ast.Subscript, ast.Slice, ast.Constant, ast.keyword}
    | {ast.BoolOp, ast.BinOp, ast.UnaryOp, ast.Compare, ast.IfExp, ast.List, ast.Tuple, ast.Dict, ast.Set}
    | {ast.Load, ast.Store}
    | {*ast.operator.__subclasses__(), *ast.unaryop.__subclasses__()}
    | {*ast.boolop.__subclasses__(), *ast.cmpop.__subclasses__()}
)
"""Nodes that the compiler never rejects if the parser accepts them."""
SHORT = 400
"""Maximum length in characters of a block whose tree, which is large, is cached."""
_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)
_DEFINITIONS = (*_FUNCTIONS, ast.ClassDef)


class Declared(NamedTuple):
    """A name in a `global` statement, and its range in the block's text."""

    name: str
    start: int
    end: int


class BlockFacts(NamedTuple):
    """Facts about a block that the parser needs."""

    empty: bool
    valid: bool
    globals: tuple[Declared, ...]


class ParsedBlock(NamedTuple):
    """A parsed block, shared by all users; the tree must not be modified."""

    tree: ast.Module
    suite: Suite
    source: str
    uses: Uses


def read(text: str) -> ParsedBlock:
    """Return the tree and names of a block, or raise SyntaxError; only short ones are cached."""
    return _read_short(text) if len(text) <= SHORT else _read(text)


def _read(text: str) -> ParsedBlock:
    tree, suite = parse_suite(text)
    source = suite.source(text)
    return ParsedBlock(tree, suite, source, uses(tree, source))


_read_short = lru_cache(maxsize=1024)(_read)


@lru_cache(maxsize=20_000)
def facts_of(text: str) -> BlockFacts:
    """Return whether a block is empty, whether it is valid Python, and what it declares `global`."""
    try:
        tree, suite, source, found = read(text)
        if not _is_simple(tree, source):
            if _generator_fault(tree, suite, source):
                return BlockFacts(False, False, ())
            _check(text, frozenset().union(*(use.scope.outer_names for use in found.found)))
    except SyntaxError:
        return BlockFacts(False, False, ())
    shift = suite.shift
    places = [Declared(name, start + shift, start + shift + len(name)) for name, start in found.global_places]
    return BlockFacts(not tree.body, True, tuple(places))


@lru_cache(maxsize=512)
def faults_of(
    text: str, line: int = 1, column: int = 0, is_condition: bool = False, is_brief: bool = False
) -> tuple[Diagnosis, ...]:
    """Return the errors of a block that is not valid Python, as `explain` or, if `is_brief`, `brief` does."""
    try:
        tree, suite, source, found = read(text)
    except SyntaxError:
        foreign = smalltalk(text, column, is_condition)
        if foreign is not None:
            return (foreign,)
        return brief(text, line) if is_brief else explain(text, line, column, is_condition)
    fault = _generator_fault(tree, suite, source)
    if fault is not None:
        return (fault,)
    try:
        _check(text, frozenset().union(*(use.scope.outer_names for use in found.found)))
    except SyntaxError as error:
        return (fault_of(error, text, line),)
    return ()


def _is_simple(tree: ast.Module, source: str) -> bool:
    """Return whether the block is certainly valid once parsed, so that it need not be compiled."""
    if "__debug__" in source or not source.isascii():
        return False
    level: list[ast.AST] = [*tree.body]
    while level:
        for node in level:
            kind = node.__class__
            if kind is ast.Call:
                names = [keyword.arg for keyword in node.keywords if keyword.arg]  # type: ignore[attr-defined]
                if len(names) != len(set(names)):
                    return False
            elif kind not in _SIMPLE:
                return False
        level = children(level)
    return True


class MemberPlace(NamedTuple):
    """The name after the dot of another one, and the strings that it is compared with."""

    name: str
    span: Span
    strings: tuple[tuple[str, Span], ...]


class Place(NamedTuple):
    """A place where a block uses a name that is not one of its inner functions: it may be a variable.

    `imported`: the module's whole name where it is bound by ``import x.y``, else empty.
    `computed`: whether it means an event or a machine if no variable is called so: it is read, not called.
    `member`: what follows its dot.
    """

    name: str
    span: Span
    imported: str
    computed: bool
    member: MemberPlace | None


def block_names(block: Block) -> list[Place]:
    """Return the names of a block, in order of their positions in the program's text."""
    return [_moved_place(block, place) for place in _names(block.text)]


def _moved_place(block: Block, place: Place) -> Place:
    member = place.member
    if member is not None:
        strings = tuple([(text, block.at(span)) for text, span in member.strings])
        member = MemberPlace(member.name, block.at(member.span), strings)
    return place._replace(span=block.at(place.span), member=member)


@lru_cache(maxsize=20_000)
def _names(text: str) -> tuple[Place, ...]:
    _, suite, _, (block, found, _) = read(text)
    places = []

    def span(start: int, end: int) -> Span:
        return Span(start + suite.shift, end + suite.shift)

    for use in found:
        if use.owner is block:
            member = None
            if use.member is not None:
                name, strings = use.member
                compared = tuple([(each.word, span(each.start, each.end)) for each in strings])
                member = MemberPlace(name.word, span(name.start, name.end), compared)
            computed = not use.called and use.name not in block.bound
            whole = span(use.start, use.start + use.length)
            places.append(Place(use.name, whole, use.imported, computed, member))
    return tuple(sorted(places, key=lambda place: place.span.start))


def _check(text: str, names: frozenset[str]) -> None:
    """Compile a block for its errors, whose columns the compiler counts in bytes, unlike the parser."""
    try:
        _function(text, 0, names)
    except SyntaxError as error:
        lines = LINE_END.split(text)

        def characters(line: int | None, column: int | None) -> int:
            here = lines[min(line or 1, len(lines)) - 1]
            return len(here.encode()[: (column or 1) - 1].decode(errors="ignore")) + 1

        error.offset = characters(error.lineno, error.offset)
        error.end_offset = characters(error.end_lineno, error.end_offset)
        raise


def _generator_fault(tree: ast.Module, suite: Suite, source: str) -> Diagnosis | None:
    """Return the fault of a `yield` or `await` that would make the block a generator or coroutine."""
    nodes: list[ast.AST] = [*tree.body]
    for node in nodes:  # grows while it is walked
        if isinstance(node, ast.Yield | ast.YieldFrom | ast.Await):
            word = "await" if isinstance(node, ast.Await) else "yield"
            message = f"`{word}` is not allowed in a block. Use it only inside a `def`."
            start = Offsets(source).start_of(node) + suite.shift
            return Diagnosis(start, start + len(word), "LRP501", message)
        nodes += _outside(node) if isinstance(node, _FUNCTIONS) else children([node])
    return None


def _outside(node: ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda) -> Iterator[ast.AST]:
    """Yield the parts of a function that are evaluated where it is defined."""
    yield node.args
    if not isinstance(node, ast.Lambda):
        yield from node.decorator_list
        yield from filter(None, [node.returns])


def words_of(block: Block) -> frozenset[str]:
    """Return the words of a block, those in strings and comments included."""
    return _words(block.text)


def compile_block(
    block: Block,
    names: Collection[str],
    filename: str,
    name: str = "block",
    values: frozenset[str] = frozenset(),
    machines: frozenset[str] = frozenset(),
) -> CodeType:
    """Compile a block for :func:`bind`.

    Its free variables are among `names`, the variables in its scope, and `PROVIDED`; its lines and columns
    are the program's. `filename` and `name` are those in tracebacks. A name among `values` means a value that
    is computed where it is used, one among `machines` a machine: their free variables, named by
    :func:`value_cell` and :func:`machine_cell`, hold functions that return them.

    Raises SyntaxError: a `nonlocal` whose variable was removed, which the parser cannot know. `lineno` is the
        program's.
    """
    seen = frozenset([word for word in _words(block.text) if word in names])
    try:
        return _placed(block.text, block.before, seen, block.line, filename, name, values, machines)
    except SyntaxError as error:
        error.lineno = (error.lineno or 1) + block.line - 1
        error.end_lineno = (error.end_lineno or 1) + block.line - 1
        error.filename = filename
        raise


def bind(code: CodeType, namespace: dict[str, Any], cells: Mapping[str, CellType]) -> Callable[[], object]:
    """Return a compiled block as a function whose globals are `namespace`, into which nothing is written."""
    closure = tuple([cells[name] for name in code.co_freevars])
    return FunctionType(code, namespace, code.co_name, None, closure)


@lru_cache(maxsize=20_000)
def _words(text: str) -> frozenset[str]:
    return frozenset(map(normal, WORD.findall(text)))


@lru_cache(maxsize=20_000)
def _placed(
    text: str,
    before: int,
    names: frozenset[str],
    line: int,
    filename: str,
    name: str,
    values: frozenset[str],
    machines: frozenset[str],
) -> CodeType:
    code = _moved(_function(text, before, names, values, machines), line - 1, filename)
    return code.replace(co_name=name, co_qualname=name)


def _moved(code: CodeType, lines: int, filename: str) -> CodeType:
    """Return a code object with its lines, and those of nested ones, shifted."""
    constants: list[object] = [
        _moved(each, lines, filename) if isinstance(each, CodeType) else each for each in code.co_consts
    ]
    if "__qualname__" in code.co_names:  # the body of a class, which names it
        name = code.co_qualname
        constants = [name.removeprefix(_OUTSIDE) if constant == name else constant for constant in constants]
    return code.replace(
        co_firstlineno=code.co_firstlineno + lines,
        co_filename=filename,
        co_consts=tuple(constants),
        co_qualname=code.co_qualname.removeprefix(_OUTSIDE),
    )


@lru_cache(maxsize=20_000)
def _function(
    text: str,
    before: int,
    names: frozenset[str],
    values: frozenset[str] = frozenset(),
    machines: frozenset[str] = frozenset(),
) -> CodeType:
    """Compile a block whose first line has so many bytes before it; its lines count from 1."""
    tree, suite = parse_suite(text)  # not the cached one, because it is modified
    found = read(text).uses
    bound = found.scope.bound
    assigned = sorted(bound & names)
    body: list[ast.stmt] = [_Plain(names).visit(each) for each in tree.body] if assigned else tree.body
    if not _words(text).isdisjoint(COMPANIONS) and "robot" not in names and not _binds(found, "robot"):
        body = with_companions(body)
    if values or machines:
        body = computed(body, values - bound, machines - bound)
        names = names.union(map(value_cell, values), map(machine_cell, machines))
    if body and isinstance(body[-1], ast.Expr):
        last = body[-1]
        body[-1] = ast.copy_location(ast.Return(last.value), last)
    module: ast.Module = parse_python(_OUTER)
    outer: ast.FunctionDef = module.body[0]  # type: ignore[assignment]
    inner: ast.FunctionDef = outer.body[0]  # type: ignore[assignment]
    outer.args.args = [ast.arg(name, lineno=1, col_offset=0) for name in sorted(names | PROVIDED)]
    above = suite.header.count("\n")
    columns = before + suite.skipped - len(suite.indent)
    for statement in body:
        _move(statement, above, columns)
    inner.lineno = 1
    if assigned:
        body.insert(0, ast.Nonlocal(assigned, lineno=1, col_offset=0))
    inner.body = body or inner.body
    with no_warnings():
        code = asked_again(compile, module, "<lrp>", "exec", dont_inherit=True)
    return _inner(_inner(code))


def _binds(found: Uses, name: str) -> bool:
    """Return whether a block, or a function in it, gives a name a value of its own."""
    return any(use.writes and use.name == name for use in found.found)


_OUTER = "def outer():\n def block(): pass"
_OUTSIDE = "outer.<locals>."


def _inner(code: CodeType) -> CodeType:
    return next(constant for constant in code.co_consts if isinstance(constant, CodeType))


def _move(statement: ast.stmt, above: int, columns: int) -> None:
    """Map the positions of a statement's nodes back: lines up, columns of the first line sideways."""
    level: list[Any] = [statement]
    while level:
        for node in level:
            if "lineno" not in node._attributes:
                continue
            if node.lineno == above + 1:
                node.col_offset = max(node.col_offset + columns, 0)
            if node.end_lineno == above + 1:
                node.end_col_offset = max(node.end_col_offset + columns, 0)
            node.lineno -= above
            node.end_lineno -= above
        level = children(level)


class _Plain(ast.NodeTransformer):
    """Replaces `x: int = 4` by a plain assignment where `x` is a variable, because Python would reject it."""

    def __init__(self, names: frozenset[str]) -> None:
        self.names = names

    def visit_AnnAssign(self, node: ast.AnnAssign) -> ast.stmt:
        if not (node.simple and isinstance(node.target, ast.Name) and node.target.id in self.names):
            return node
        new = ast.Assign([node.target], node.value) if node.value else ast.Pass()
        return ast.copy_location(new, node)

    def visit(self, node: ast.AST) -> Any:
        return node if isinstance(node, _DEFINITIONS) else super().visit(node)
