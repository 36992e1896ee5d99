"""Names in a block that are computed where they are used: events, times and machines.

Each occurrence becomes a call of a free variable, to which the interpreter binds the function that computes
the value. So nothing is computed that is not used, and a function defined in a block has the value of the
moment at which it is called. Paper: §5.1.1.
"""

from __future__ import annotations

import ast
from collections.abc import Sequence
from typing import Any

_SCOPES = (
    *(ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda, ast.ClassDef),
    *(ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp),
)


def value_cell(name: str) -> str:
    """Return the free variable for a name whose value is computed where it is used: no name of Python."""
    return f"{name}()"


def machine_cell(name: str) -> str:
    """Return the free variable for the name of a machine: no name of Python."""
    return f"{name}."


def name_of_cell(cell: str) -> str:
    """Return the name for which a free variable stands; empty if it is an ordinary one."""
    return (
        cell[:-2] if cell.endswith(value_cell("")) else cell[:-1] if cell.endswith(machine_cell("")) else ""
    )


def computed(body: Sequence[ast.stmt], values: frozenset[str], machines: frozenset[str]) -> list[ast.stmt]:
    """Return the statements of a block, modified, with its names of values and of machines as calls."""
    transformer = _Computed(values, machines)
    return [transformer.visit(statement) for statement in body]


class _Computed(ast.NodeTransformer):
    """Replaces the names of `values` and `machines` by calls of their free variables.

    A name that is itself called means a function, and one that an inner function binds is its own.
    """

    def __init__(self, values: frozenset[str], machines: frozenset[str]) -> None:
        self.values, self.machines = values, machines

    def visit_Name(self, node: ast.Name) -> ast.expr:
        """Replace a name that is read."""
        cell = value_cell if node.id in self.values else machine_cell if node.id in self.machines else None
        return node if cell is None or not isinstance(node.ctx, ast.Load) else self._call(node, cell(node.id))

    def visit_Attribute(self, node: ast.Attribute) -> ast.expr:
        """Replace the name of a machine, even if an event is called like it."""
        inner = node.value
        if isinstance(inner, ast.Name) and inner.id in self.machines:
            node.value = self._call(inner, machine_cell(inner.id))
            return node
        self.generic_visit(node)
        return node

    def visit_Call(self, node: ast.Call) -> ast.expr:
        """Leave the name of what is called."""
        function, is_named = node.func, isinstance(node.func, ast.Name)
        self.generic_visit(node)
        if is_named:
            node.func = function
        return node

    def _call(self, node: ast.Name, cell: str) -> ast.expr:
        name = ast.copy_location(ast.Name(cell, ast.Load()), node)
        return ast.copy_location(ast.Call(name, [], []), node)

    def visit(self, node: ast.AST) -> Any:
        """Visit a node; names that a function, class or comprehension binds are its own."""
        if not isinstance(node, _SCOPES):
            return super().visit(node)
        for outside in _evaluated_outside(node):
            outside[:] = [each and self.visit(each) for each in outside]
        for comprehension in getattr(node, "generators", [])[:1]:
            comprehension.iter = self.visit(comprehension.iter)
        bound = frozenset[str]().union(*map(_bound_in, ast.walk(node)))
        _Computed(self.values - bound, self.machines - bound).generic_visit(node)
        return node


def _evaluated_outside(node: ast.AST) -> list[list[Any]]:
    """Return the parts of a function or class that are evaluated where it is defined."""
    arguments = getattr(node, "args", None)
    lists = [getattr(node, name, []) for name in ("decorator_list", "bases", "keywords")]
    if isinstance(arguments, ast.arguments):
        lists += [arguments.defaults, arguments.kw_defaults]
    return lists


def _bound_in(node: ast.AST) -> tuple[str, ...]:
    """Return the names that a node itself binds."""
    if isinstance(node, ast.Name):
        return () if isinstance(node.ctx, ast.Load) else (node.id,)
    if isinstance(node, ast.Global | ast.Nonlocal):
        return tuple(node.names)
    if isinstance(node, ast.alias):
        return ((node.asname or node.name).partition(".")[0],)
    if isinstance(node, ast.keyword):
        return ()
    own = (getattr(node, "arg", None), getattr(node, "name", None), getattr(node, "rest", None))
    return tuple(name for name in own if isinstance(name, str))
