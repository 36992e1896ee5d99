"""What a teacher may want to read in a program: what reaches beyond its robot and its variables.

Such a program may be right, and most are. But one that imports what judges it, or looks into objects, may
have changed its own marks: programs run in the process that judges them.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator

from lrp_jupyter.language.checks.scanned import ScannedBlock
from lrp_jupyter.language.parser import scan
from lrp_jupyter.language.resolution import resolve

LONGEST = 30_000
"""Characters of a program that is looked through: a longer one could hold up a class."""
_USUAL = frozenset(
    {"bisect", "cmath", "collections", "dataclasses", "decimal", "enum", "fractions", "functools", "heapq"}
    | {"itertools", "math", "numbers", "operator", "random", "re", "statistics", "string", "typing"}
)
"""Modules that only compute."""
_CLOCK = "imports `{}`, whose clock is that of the run when it is graded"
_MODULES = {"time": _CLOCK, "datetime": _CLOCK, "lrp_jupyter": "imports `{}`, which judges the program"}
_LOOKS_UP = "looks up a name with `{}`"
_NAMES = {
    "open": "opens a file with `{}`",
    **dict.fromkeys(("eval", "exec", "compile"), "runs a text as Python with `{}`"),
    **dict.fromkeys(("getattr", "setattr", "delattr", "vars", "globals", "locals"), _LOOKS_UP),
}
_WAYS_OUT = {
    **dict.fromkeys(("attrgetter", "methodcaller", "get_field", "get_type_hints"), _LOOKS_UP),
    **dict.fromkeys(("sys", "builtins", "bltns", "inspect"), "reaches another module with `.{}`"),
}
"""What leads from the usual modules to everything else."""
_FRAME = re.compile("(gi|ag|cr|tb|f)_(frame|back|locals|globals|builtins)")


def notes_about(texts: Iterable[str]) -> tuple[str, ...]:
    """Return a sentence for each thing of note in programs; none for what is not a valid program."""
    found: dict[str, int] = {}
    texts = list(texts)
    for text in texts:
        program, _ = scan(text) if len(text) <= LONGEST else (None, ())
        for place in resolve(program).all_blocks if program else ():
            block = ScannedBlock(place.block.text)
            for node in block.nodes:
                for note in _notes(node, block, place.visible):
                    at = place.block.at(block.span(node)).start
                    found.setdefault(note, text.count("\n", 0, at) + 1)
    too_long = any(len(text) > LONGEST for text in texts)
    unread = f"The program has more than {LONGEST:,} characters, so it was not looked through. Read it."
    return (*[unread] * too_long, *(f"Line {line} {note}." for note, line in found.items()))


def _notes(node: ast.AST, block: ScannedBlock, variables: Iterable[str]) -> Iterator[str]:
    match node:
        case ast.Import():
            yield from (_import(alias.name) for alias in node.names if alias.name not in _USUAL)
        case ast.ImportFrom() if node.module not in _USUAL:
            yield _import(node.module or ".")
        case ast.ImportFrom():
            yield from (
                _WAYS_OUT[alias.name].format(alias.name) for alias in node.names if alias.name in _WAYS_OUT
            )
        case ast.MatchClass():
            yield from (f"uses `.{name}`" for name in node.kwd_attrs if name.startswith("_"))
        case ast.Attribute() if node.attr.startswith("_"):
            yield f"uses `.{node.attr}`"
        case ast.Attribute() if _FRAME.fullmatch(node.attr):
            yield f"looks into frames with `.{node.attr}`"
        case ast.Attribute() if node.attr in _WAYS_OUT:
            yield _WAYS_OUT[node.attr].format(node.attr)
        case ast.Attribute(ctx=ast.Store() | ast.Del()):
            root = ast.unparse(node).partition(".")[0]
            if root == "robot" or root in block.imported or not root.isidentifier():
                yield f"changes `{ast.unparse(node)}`"
        case ast.Name() if node.id in variables or node.id in block.stored:
            pass
        case ast.Name() if node.id in _NAMES:
            yield _NAMES[node.id].format(node.id)
        case ast.Name() if node.id.startswith("_"):
            yield f"uses `{node.id}`"
        case ast.Constant(value=str(text)) if "__" in text:
            yield "has a text with `__`"


def _import(module: str) -> str:
    return _MODULES.get(module.partition(".")[0], "imports `{}`").format(module)
