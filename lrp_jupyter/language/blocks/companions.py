"""`robot.order.new` and `robot.order.age`: what is known of a reading beside its value.

In Python the value comes first, and asking for it fails before the first message, when `new` is empty and not
unknown. So a block asks the robot for the whole dotted name. A robot that has no such reading takes the names
one by one, as Python does.
"""

from __future__ import annotations

import ast
from collections.abc import Sequence

COMPANIONS = ("new", "age")
"""Last names of such readings: the messages since the last tick, and the seconds since the last one."""


def asked_at_once(node: ast.expr) -> str | None:
    """Return what is asked of `robot` in one go, ``order.new``; None for any other expression."""
    if not (isinstance(node, ast.Attribute) and node.attr in COMPANIONS and isinstance(node.ctx, ast.Load)):
        return None
    names = []
    inner: ast.expr = node
    while isinstance(inner, ast.Attribute):
        names.append(inner.attr)
        inner = inner.value
    is_robot = isinstance(inner, ast.Name) and inner.id == "robot" and len(names) > 1
    return ".".join(reversed(names)) if is_robot else None


def with_companions(body: Sequence[ast.stmt]) -> list[ast.stmt]:
    """Return the statements of a block, modified, that ask for each such reading at once."""
    return [_AtOnce().visit(statement) for statement in body]


class _AtOnce(ast.NodeTransformer):
    def visit_Attribute(self, node: ast.Attribute) -> ast.expr:
        """Join the names after `robot`."""
        path = asked_at_once(node)
        if path is None:
            self.generic_visit(node)
            return node
        robot: ast.expr = node.value
        while isinstance(robot, ast.Attribute):
            robot = robot.value
        node.value, node.attr = robot, path
        return node
