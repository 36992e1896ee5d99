"""The names of a block: what it reads and assigns, with exact positions.

Python's own scoping decides which of them can be variables of the program: a name that an inner function,
lambda, class or comprehension binds is its own.
"""

from __future__ import annotations

import ast
import re
import unicodedata
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from itertools import chain, pairwise
from operator import attrgetter
from typing import Any, NamedTuple

from lrp_jupyter.language.program import Path, line_starts
from lrp_jupyter.language.python.block_suite import children
from lrp_jupyter.language.python.python_parser import parse_python
from lrp_jupyter.language.python.scanner import fields, line_end, string_end

_Function = ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda
_Comprehension = ast.ListComp | ast.SetComp | ast.DictComp | ast.GeneratorExp
WORD = re.compile(r"(?:\w|[^\x00-\x7f\s])+")
_WORD_OR_QUOTE = re.compile(rf"{WORD.pattern}|['\"#]")
_CONVERSION = re.compile(r"(?:=\s*)?(?:![A-Za-z]\s*)?\Z")


class Written(NamedTuple):
    """A word of the source and its range, in characters."""

    word: str
    start: int
    end: int


class Member(NamedTuple):
    """The name after the dot of another one, and the strings that it is compared with."""

    name: Written
    strings: tuple[Written, ...] = ()


class Use(NamedTuple):
    """One occurrence of a name; `start` is an offset in the source, in characters."""

    name: str
    start: int
    length: int
    writes: bool
    scope: PythonScope
    imported: str = ""  # the module's whole name in `import x.y`
    called: bool = False
    member: Member | None = None

    @property
    def owner(self) -> PythonScope | None:
        """The scope that the name belongs to; None if it is a global of Python."""
        return self.scope.owner(self.name)


@dataclass(eq=False)
class PythonScope:
    """The block itself (`outer` is None), or a function, class or comprehension in it."""

    outer: PythonScope | None = None
    is_class: bool = False
    is_comprehension: bool = False
    bound: set[str] = field(default_factory=set)
    outer_names: set[str] = field(default_factory=set)  # declared `nonlocal`
    global_names: set[str] = field(default_factory=set)

    def owner(self, name: str) -> PythonScope | None:
        """Return the scope that a name used here belongs to; the block itself if no other binds it."""
        scope = self
        while True:
            if name in scope.global_names:
                return None
            if scope.outer is None:
                return scope
            hidden = scope.is_class and scope is not self  # from its methods
            if name in scope.bound and name not in scope.outer_names and not hidden:
                return scope
            scope = scope.outer


class Uses(NamedTuple):
    """Every name of a block, in no particular order, and those in `global` statements with their offsets."""

    scope: PythonScope
    found: list[Use]
    global_places: list[tuple[str, int]]


def uses(tree: ast.Module, source: str) -> Uses:
    """Return every name of a source, whose tree is given."""
    visitor = _Visitor(source, 0)
    scope = PythonScope()
    visitor.visit_all(tree.body, scope)
    return Uses(scope, visitor.found, visitor.global_places)


class Offsets:
    """Positions of the nodes of a tree in its source, in characters."""

    def __init__(self, source: str) -> None:
        self.source = source
        self.starts = line_starts(source)
        self._is_ascii = source.isascii()
        self._characters: dict[int, list[int]] = {}  # of a line: for each of its bytes, the character

    def start_of(self, node: ast.AST) -> int:
        """Return the offset in the source at which a node begins."""
        return self.offset(node.lineno, node.col_offset)  # type: ignore[attr-defined]

    def end_of(self, node: ast.AST) -> int:
        """Return the offset in the source at which a node ends."""
        return self.offset(node.end_lineno, node.end_col_offset)  # type: ignore[attr-defined]

    def offset(self, line: int, column: int) -> int:
        """Return the offset of a position of the tree, whose columns are bytes of UTF-8."""
        start = self.starts[line - 1]
        if self._is_ascii:
            return start + column
        characters = self._characters.get(line)
        if characters is None:
            here = self.source[start : line_end(self.source, start)]
            characters = [i for i, character in enumerate(here) for _ in character.encode()]
            characters.append(len(here))
            self._characters[line] = characters
        return start + characters[column]


class _Visitor(Offsets):
    """Walks a tree; `shift` is added to every offset (for the expressions inside f-strings)."""

    def __init__(self, source: str, shift: int, found: list[Use] | None = None) -> None:
        super().__init__(source)
        self.shift = shift
        self.found: list[Use] = [] if found is None else found
        self.global_places: list[tuple[str, int]] = []
        self._compared: dict[ast.expr, list[Written]] = {}

    def register(
        self,
        name: str,
        start: int,
        writes: bool,
        scope: PythonScope,
        imported: str = "",
        called: bool = False,
        member: Member | None = None,
    ) -> None:
        """Register an occurrence of a name."""
        if writes:
            scope.bound.add(name)
        _, begin, end = self.written(name, start)
        self.found.append(Use(name, begin, end - begin, writes, scope, imported, called, member))

    def written(self, name: str, start: int) -> Written:
        """Return a name with its range."""
        match = WORD.match(self.source, start)
        end = match.end() if match else start + len(name)
        return Written(name, start + self.shift, end + self.shift)

    def word(self, name: str, start: int) -> int:
        """Return the offset of the first word `name` of code at or after `start`."""
        return next((offset for offset, word in words(self.source, start) if word == name), start)

    def visit_all(self, nodes: Iterable[ast.AST | None], scope: PythonScope) -> None:
        for node in nodes:
            if node is not None:
                self.visit(node, scope)

    def visit(self, node: ast.AST, scope: PythonScope) -> None:
        """Register the names of a node and of everything in it."""
        method = _METHODS.get(type(node).__name__)
        if method is not None:
            method(self, node, scope)
        else:
            self.visit_all(children([node]), scope)

    # Names

    def on_name(self, node: ast.Name, scope: PythonScope) -> None:
        self.register(node.id, self.start_of(node), not isinstance(node.ctx, ast.Load), scope)

    def on_attribute(self, node: ast.Attribute, scope: PythonScope) -> None:
        inner = node.value
        if not isinstance(inner, ast.Name):
            self.visit(inner, scope)
            return
        name = self.written(node.attr, self.word(node.attr, self.end_of(inner)))
        member = Member(name, tuple(self._compared.pop(node, ())))
        self.register(inner.id, self.start_of(inner), False, scope, member=member)

    def on_call(self, node: ast.Call, scope: PythonScope) -> None:
        function = node.func
        if isinstance(function, ast.Name):
            self.register(function.id, self.start_of(function), False, scope, called=True)
        else:
            self.visit(function, scope)
        self.visit_all([*node.args, *node.keywords], scope)

    def on_compare(self, node: ast.Compare, scope: PythonScope) -> None:
        operands = [node.left, *node.comparators]
        for one, other in [*pairwise(operands), *pairwise(reversed(operands))]:
            self._compare(one, getattr(other, "elts", [other]))
        self.visit_all(operands, scope)

    def on_match(self, node: ast.Match, scope: PythonScope) -> None:
        cases = [case.pattern for case in node.cases]
        every = chain.from_iterable(getattr(case, "patterns", [case]) for case in cases)
        self._compare(node.subject, [getattr(pattern, "value", None) for pattern in every])
        self.visit_all([node.subject, *node.cases], scope)

    def _compare(self, one: ast.expr, others: Iterable[ast.AST | None]) -> None:
        """Note the strings that an expression is compared with, without their quotes."""
        if not isinstance(one, ast.Attribute):
            return
        for other in others:
            if isinstance(other, ast.Constant) and isinstance(other.value, str):
                start, end = self.start_of(other), self.end_of(other)
                if self.source[start + 1 : end - 1] == other.value:
                    places = (start + 1 + self.shift, end - 1 + self.shift)
                    self._compared.setdefault(one, []).append(Written(other.value, *places))

    def on_global(self, node: ast.Global, scope: PythonScope) -> None:
        scope.global_names.update(node.names)
        start = self.start_of(node)
        for name in node.names:
            start = self.word(name, start + 1)
            self.global_places.append((name, start))

    def on_nonlocal(self, node: ast.Nonlocal, scope: PythonScope) -> None:
        scope.outer_names.update(node.names)
        start = self.start_of(node)
        for name in node.names:
            start = self.word(name, start + 1)
            self.register(name, start, False, scope)

    def on_alias(self, node: ast.alias, scope: PythonScope) -> None:
        start = self.start_of(node)
        if node.asname:
            self.register(node.asname, self.word_after("as", node.asname, start), True, scope)
        elif node.name != "*":
            self.register(node.name.partition(".")[0], start, True, scope, imported=node.name)

    def word_after(self, keyword: str, name: str, start: int) -> int:
        """Return the offset of `name` after the word `keyword`."""
        return self.word(name, self.word(keyword, start) + len(keyword))

    def on_handler(self, node: ast.ExceptHandler, scope: PythonScope) -> None:
        self.visit_all([node.type], scope)
        if node.name:
            start = self.end_of(node.type) if node.type else self.start_of(node)
            self.register(node.name, self.word_after("as", node.name, start), True, scope)
        self.visit_all(node.body, scope)

    def on_capture(self, node: ast.MatchAs, scope: PythonScope) -> None:
        self.visit_all([node.pattern], scope)
        if node.name:
            start = self.start_of(node)
            if node.pattern:
                start = self.word("as", self.end_of(node.pattern)) + 2
            self.register(node.name, self.word(node.name, start), True, scope)

    def on_star(self, node: ast.MatchStar, scope: PythonScope) -> None:
        if node.name:
            self.register(node.name, self.word(node.name, self.start_of(node)), True, scope)

    def on_mapping(self, node: ast.MatchMapping, scope: PythonScope) -> None:
        self.visit_all([*node.keys, *node.patterns], scope)
        if node.rest:
            start = self.end_of(node.patterns[-1]) if node.patterns else self.start_of(node)
            self.register(node.rest, self.word(node.rest, start), True, scope)

    # Scopes

    def on_function(self, node: ast.FunctionDef | ast.AsyncFunctionDef, scope: PythonScope) -> None:
        self.visit_all(node.decorator_list, scope)
        self.register(node.name, self.word_after("def", node.name, self.start_of(node)), True, scope)
        self.function(node, scope, node.body, [node.returns])

    def on_lambda(self, node: ast.Lambda, scope: PythonScope) -> None:
        self.function(node, scope, [node.body], [])

    def function(
        self, node: _Function, scope: PythonScope, body: Iterable[ast.AST], outside: list[ast.expr | None]
    ) -> None:
        arguments = node.args
        around = _type_scope(node, scope)
        inner = PythonScope(around)
        parameters = [*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs]
        parameters += [extra for extra in (arguments.vararg, arguments.kwarg) if extra]
        for parameter in parameters:
            self.register(parameter.arg, self.start_of(parameter), True, inner)
            self.visit_all([parameter.annotation], around)
        self.visit_all([*outside, *getattr(node, "type_params", ())], around)
        self.visit_all([*arguments.defaults, *arguments.kw_defaults], scope)
        self.visit_all(body, inner)

    def on_class(self, node: ast.ClassDef, scope: PythonScope) -> None:
        self.visit_all(node.decorator_list, scope)
        self.register(node.name, self.word_after("class", node.name, self.start_of(node)), True, scope)
        around = _type_scope(node, scope)
        self.visit_all([*node.bases, *node.keywords, *getattr(node, "type_params", ())], around)
        self.visit_all(node.body, PythonScope(around, is_class=True))

    def on_comprehension(self, node: _Comprehension, scope: PythonScope) -> None:
        inner = PythonScope(scope, is_comprehension=True)
        first, *others = node.generators
        self.visit(first.iter, scope)
        self.visit_all([first.target, *first.ifs, *others], inner)
        parts = ast.iter_child_nodes(node)
        self.visit_all([part for part in parts if not isinstance(part, ast.comprehension)], inner)

    def on_walrus(self, node: ast.NamedExpr, scope: PythonScope) -> None:
        self.visit(node.value, scope)
        while scope.is_comprehension and scope.outer:
            scope = scope.outer
        self.visit(node.target, scope)

    def on_formatted(self, node: ast.JoinedStr, scope: PythonScope) -> None:
        """Parse the expressions of an f-string separately: before Python 3.12 their positions are wrong."""
        for start, end in fields(self.source, self.start_of(node), self.end_of(node)):
            expression = _CONVERSION.sub("", self.source[start:end])
            source = f"({expression}\n)"
            inner = _Visitor(source, self.shift + start - 1, self.found)
            inner.visit(parse_python(source), scope)


_METHODS: dict[str, Callable[[_Visitor, Any, PythonScope], None]] = {
    "Name": _Visitor.on_name,
    "Attribute": _Visitor.on_attribute,
    "Call": _Visitor.on_call,
    "Compare": _Visitor.on_compare,
    "Match": _Visitor.on_match,
    "Global": _Visitor.on_global,
    "Nonlocal": _Visitor.on_nonlocal,
    "alias": _Visitor.on_alias,
    "ExceptHandler": _Visitor.on_handler,
    "MatchAs": _Visitor.on_capture,
    "MatchStar": _Visitor.on_star,
    "MatchMapping": _Visitor.on_mapping,
    "FunctionDef": _Visitor.on_function,
    "AsyncFunctionDef": _Visitor.on_function,
    "Lambda": _Visitor.on_lambda,
    "ClassDef": _Visitor.on_class,
    "ListComp": _Visitor.on_comprehension,
    "SetComp": _Visitor.on_comprehension,
    "DictComp": _Visitor.on_comprehension,
    "GeneratorExp": _Visitor.on_comprehension,
    "NamedExpr": _Visitor.on_walrus,
    "JoinedStr": _Visitor.on_formatted,
    "TemplateStr": _Visitor.on_formatted,
}


def _type_scope(node: ast.AST, scope: PythonScope) -> PythonScope:
    """Return a scope for the type parameters of a definition, from Python 3.12 on."""
    inner = PythonScope(scope)
    inner.bound.update(map(attrgetter("name"), getattr(node, "type_params", ())))
    return inner


def words(source: str, start: int) -> Iterator[tuple[int, str]]:
    """Yield the words of code, strings and comments left out, from an offset on."""
    position = start
    while match := _WORD_OR_QUOTE.search(source, position):
        position = match.end()
        if match[0] == "#":
            position = line_end(source, position)
        elif match[0] in "'\"":
            position, _ = string_end(source, match.start(), start)
        else:
            yield match.start(), normal(match[0])


def normal(name: str) -> str:
    """Return a name as Python normalizes it (NFKC)."""
    return name if name.isascii() else unicodedata.normalize("NFKC", name)


def as_path(path: str | Path) -> Path:
    """Return a path as a tuple of names as the parser makes them; it may be written as ``"m/a"``."""
    try:
        names = [normal(name) for name in (path.strip("/").split("/") if isinstance(path, str) else path)]
        return tuple(names) or ("",)
    except (TypeError, AttributeError):
        kind = "None" if path is None else type(path).__name__
        message = f"A path is a text such as `m/a`, or a tuple of names, not {kind}."
        raise TypeError(message) from None
