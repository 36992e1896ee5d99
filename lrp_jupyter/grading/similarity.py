"""How much of two programs is alike, whatever their names, comments and layout.

A program is the tree that the parser makes of it, in which all that its author has named has the same name.
Compared are the parts of the trees, each with its numbers and without them, but not what was given out. So it
does not matter in which order the states of a machine are written, and numbers that were changed cost a half.
"""

from __future__ import annotations

import ast
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from itertools import combinations
from typing import NamedTuple

from lrp_jupyter.grading.notes import LONGEST
from lrp_jupyter.language.parser import scan
from lrp_jupyter.language.program import Block, Name
from lrp_jupyter.language.python.block_suite import parse_block

_LEAST = 16  # parts of one's own: shorter programs are alike anyway
_SMALLEST = 3  # words of a part that counts
_NUMBER = re.compile(r"\b\d[\d.e+-]*")
_PLACES = ("span", "text", "filename")


class Alike(NamedTuple):
    """Two programs that are alike.

    `share`: of the parts of both that are in the other one too, 0 to 1.
    """

    first: str
    second: str
    share: float


def alike(programs: Mapping[str, str], given: str = "", least: float = 0.8) -> list[Alike]:
    """Return the pairs of programs of which at least a share is alike, most alike first.

    Programs that are not valid or too long, or to which little was added, are not compared.

    `programs`: texts, by what they are called.
    `given`: the text that was given out.
    """
    common = parts_of(given)
    own = {name: parts_of(text) - common for name, text in programs.items()}
    sizes = {name: count for name, found in own.items() if (count := found.total()) >= _LEAST}
    pairs = []
    for first, second in combinations(sizes, 2):
        both = sizes[first] + sizes[second]
        if 2 * min(sizes[first], sizes[second]) < least * both:
            continue
        share = 2 * (own[first] & own[second]).total() / both
        if share >= least:
            pairs.append(Alike(first, second, share))
    return sorted(pairs, key=lambda pair: -pair.share)


def groups_of(pairs: Iterable[Alike]) -> list[tuple[str, ...]]:
    """Return who is in pairs that hang together, the largest group first."""
    groups: list[dict[str, None]] = []
    for first, second, _ in pairs:
        joined = {first: None, second: None}
        apart = [group for group in groups if not group.keys() & joined.keys()]
        for group in groups:
            if group not in apart:
                joined = {**group, **joined}
        groups = [*apart, joined]
    return sorted(map(tuple, groups), key=len, reverse=True)


def parts_of(text: str) -> Counter[str]:
    """Return the parts of a program, and how often it has each; none if it is not valid, or too long."""
    program, _ = scan(text) if len(text) <= LONGEST else (None, ())
    found: Counter[str] = Counter()
    if program is not None:
        _tree(program, frozenset(_named(program)), found)
    return found


def _named(value: object) -> Iterator[str]:
    """Yield the names that the author of a program has chosen."""
    if isinstance(value, Name):
        yield str(value)
    elif isinstance(value, Block):
        for node in ast.walk(parse_block(value.text)):
            if isinstance(node, ast.Name) and not isinstance(node.ctx, ast.Load):
                yield node.id
    else:
        for part in _parts(value):
            yield from _named(part)


def _tree(value: object, named: frozenset[str], found: Counter[str]) -> str:
    """Return the tree of a part of a program as text, and count it and all that is in it."""
    if isinstance(value, Name) or (isinstance(value, ast.Name) and value.id in named):
        return "name"
    if isinstance(value, Block):
        return _tree(parse_block(value.text).body, named, found)
    if isinstance(value, ast.Name):
        return value.id
    if isinstance(value, ast.Expr):
        return _tree(value.value, named, found)
    inner = [_tree(part, named, found) for part in _parts(value)]
    if not isinstance(value, tuple | list | ast.AST) and not is_dataclass(value):
        return "name" if value in named else repr(value)
    if isinstance(value, tuple | list):
        return " ".join(sorted(inner) if isinstance(value, tuple) else inner)
    tree = f"{type(value).__name__}({' '.join(filter(None, inner))})"
    if tree.count(" ") + tree.count("(") >= _SMALLEST:
        found[tree] += 1
        found[_NUMBER.sub("number", tree)] += 1
    return tree


def _parts(value: object) -> list[object]:
    if isinstance(value, tuple | list):
        return list(value)
    if isinstance(value, ast.AST):
        return [part for _, part in ast.iter_fields(value) if part is not None]
    if is_dataclass(value):
        return [getattr(value, each.name) for each in fields(value) if each.name not in _PLACES]
    return []
