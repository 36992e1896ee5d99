"""The wording of values, commands and restarts in answers."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from typing import Any

from lrp_jupyter.bridges.message import Twist
from lrp_jupyter.errors import sentence_of
from lrp_jupyter.interpreter.facts import Commanded
from lrp_jupyter.interpreter.rendering import scalar_of, short
from lrp_jupyter.interpreter.watched_test import Shown, items
from lrp_jupyter.language.blocks.expressions import Evaluation, UnknownValueError
from lrp_jupyter.language.program import Block
from lrp_jupyter.language.python.python_parser import parse_python


def number_text(value: float) -> str:
    """Return a number with at most three decimals."""
    return f"{round(value, 3):g}" if abs(value) < 1e6 else f"{value:.0f}"


def time_text(seconds: float) -> str:
    """Return a time of the run, to the millisecond."""
    return f"{number_text(seconds)} s"


def plain_values(evaluation: Evaluation) -> dict[str, object]:
    """Return the values of the parts of an evaluation as plain data, by their texts."""
    return {text: _plain(value) for text, value in items(evaluation)}


def _plain(value: object) -> object:
    """Return a value itself if it is a number, a text or None, else a short text."""
    if isinstance(value, Shown):
        return str(value)
    return value if isinstance(value, (int, float, str, type(None))) else short(value)


def decided_text(evaluation: Evaluation) -> str:
    """Say the value of the part that decides; below a `not` it is the opposite of the whole."""
    return _rounded(scalar_of(evaluation.decided), _decides(evaluation))


def values_text(evaluation: Evaluation) -> str:
    """Say the values within the part that decides; empty if there are none."""
    tree = _decides(evaluation)
    parts = [ast.unparse(node) for node in ast.walk(tree) if isinstance(node, ast.expr)]
    shown = [
        f"`{text}` was {_rounded(value, tree)}"
        for text, value in items(evaluation)
        if text in parts and text != evaluation.decides
    ]
    return f" ({listed(shown, 'and')})" if shown else ""


def _decides(evaluation: Evaluation) -> ast.expr:
    tree: ast.Expression = parse_python(evaluation.decides, mode="eval")
    return tree.body


def _rounded(value: object, tree: ast.expr) -> str:
    """Return a value as text; a number with six digits, unless it is compared for equality."""
    exact = any(isinstance(node, (ast.Eq, ast.NotEq)) for node in ast.walk(tree))
    if isinstance(value, Shown):
        return str(value)
    return f"{value:.6g}" if type(value) is float and not exact else short(value)


def listed(texts: list[str], word: str) -> str:
    """Return texts as a list in a sentence: ``a, b or c``."""
    return f" {word} ".join([", ".join(texts[:-1]), texts[-1]] if len(texts) > 1 else texts)


def block_text(block: Block) -> str:
    """Return a block for use in a sentence; if it has several lines, only the first."""
    first, *more = block.text.strip().splitlines() or [""]
    return f"`{first.rstrip()} …`" if more else f"`{first}`"


def unknown_text(problem: Exception | None) -> str:
    """Say why the values of a condition are unknown; None stands for one that is not an expression."""
    if isinstance(problem, UnknownValueError):
        return str(problem)
    return "the block is more than one expression." if problem is None else sentence_of(problem)


def restart_text(restart: Commanded) -> str:
    """Say why the program restarted, without a full stop."""
    return "it was reset" if restart.text == "reset" else restart.text.rstrip(".")


def call_text(name: str, arguments: Mapping[str, Any]) -> str:
    """Return a command of the robot as written in a program."""
    given = [
        f"{key}={short(value) if isinstance(value, str) else _plain(value)}"
        for key, value in given_arguments(arguments).items()
    ]
    return f"`robot.{name}({', '.join(given)})`"


def given_arguments(arguments: Mapping[str, Any]) -> dict[str, Any]:
    """Return the arguments of a command; for a velocity, the nonzero ones in their short form."""
    if arguments.keys() != Twist.FIELDS.keys():
        return dict(arguments)
    short_forms = {path: word for word, path in Twist.WORDS.items()}
    parts = dict(_flat(arguments))
    given = {short_forms.get(path, path): value for path, value in parts.items() if value != 0}
    return given or dict.fromkeys(Twist.WORDS, 0.0)


def _flat(arguments: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in arguments.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value
