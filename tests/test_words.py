"""The wording of what users read, as far as it can be checked mechanically."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

import lrp_jupyter

PACKAGE = Path(lrp_jupyter.__file__).parent
AS_PYTHON = {"AttributeError", "IndentationError", "SyntaxError"}  # worded as Python words them
BEGINNINGS = ("`", "'", '"', "{", "-", "%", "lrp: ")


def messages(path: Path) -> Iterator[tuple[int, str]]:
    """Yield the texts with which a module raises, with ``{}`` for what is inserted."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if not isinstance(node, ast.Raise) or not isinstance(node.exc, ast.Call):
            continue
        if isinstance(node.exc.func, ast.Name) and node.exc.func.id in AS_PYTHON:
            continue
        for argument in node.exc.args[-1:]:
            text = literal(argument)
            if text:
                yield node.lineno, text


def literal(node: ast.expr) -> str:
    if isinstance(node, ast.Constant):
        return node.value if isinstance(node.value, str) else ""
    if isinstance(node, ast.JoinedStr):
        return "".join(literal(part) if isinstance(part, ast.Constant) else "{}" for part in node.values)
    return ""


def is_sentence(text: str) -> bool:
    begins = text[0].isupper() or text.startswith(BEGINNINGS)
    return begins and text.rstrip("`").endswith((".", "?", ":", "…", "{}"))


def test_messages_that_are_raised_are_sentences():
    found = [(path, *each) for path in sorted(PACKAGE.rglob("*.py")) for each in messages(path)]
    assert len(found) > 200
    assert [each for each in found if not is_sentence(each[2])] == []


@pytest.mark.parametrize("text", ["there is no state `a`.", "There is no state `a`", "cannot go back"])
def test_a_fragment_is_not_a_sentence(text):
    assert not is_sentence(text)
