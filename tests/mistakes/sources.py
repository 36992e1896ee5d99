"""The correct programs into which mistakes are planted: all bundled ones, and others in different styles."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from functools import cached_property, lru_cache
from pathlib import Path
from typing import NamedTuple

from lrp_jupyter import programs
from lrp_jupyter.language.parser import scan
from lrp_jupyter.language.reading.tokens import Token, keyword_of, tokenize

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
_CODE = re.compile(r"```(?:lrp)?\n(.*?)```", re.DOTALL)


class Form(NamedTuple):
    """A form of a correct program, by the offsets of its text.

    Its tokens are those directly in it: names, signs, blocks and its brackets; a nested form is left out.
    """

    keyword: str
    start: int
    end: int
    around: str
    column: int
    """Of its bracket, if that begins a line, else -1."""
    tokens: tuple[Token, ...]
    forms: tuple[Form, ...]

    @property
    def last(self) -> int:
        """The offset of its ``)``."""
        return self.end - 1

    @property
    def types(self) -> tuple[str, ...]:
        """The types of its tokens."""
        return tuple(token[0] for token in self.tokens)

    def of(self, *kinds: str) -> list[Token]:
        """Its tokens of some kinds."""
        return [token for token in self.tokens if token[0] in kinds]


class Source:
    """A correct program with its forms."""

    def __init__(self, name: str, text: str) -> None:
        self.name = name
        self.text = text

    @cached_property
    def tokens(self) -> list[Token]:
        return tokenize(self.text)

    @cached_property
    def forms(self) -> list[Form]:
        """All forms, each after those that it contains."""
        found: list[Form] = []
        opened: list[tuple[str, int, list[Token], list[Form]]] = [("program", 0, [], [])]
        for token in self.tokens:
            kind, start, end = token
            if kind == "OPEN":
                opened.append((keyword_of(self.text, token), start, [token], []))
            elif kind == "CLOSE":
                keyword, first, tokens, inner = opened.pop()
                before = self.text[
                    max(self.text.rfind("\n", 0, first), self.text.rfind("\r", 0, first)) + 1 : first
                ]
                column = -1 if before.strip() else len(before)
                form = Form(keyword, first, end, opened[-1][0], column, (*tokens, token), tuple(inner))
                opened[-1][3].append(form)
                found.append(form)
            else:
                opened[-1][2].append(token)
        return found

    def all(self, *keywords: str) -> Iterator[Form]:
        """The forms with some keywords."""
        return (form for form in self.forms if form.keyword in keywords)

    def word(self, token: Token) -> str:
        """The text of a token."""
        return self.text[token[1] : token[2]]

    def line(self, offset: int) -> int:
        """The line of an offset, from 1."""
        return line_of(self.text, offset)


def line_of(text: str, offset: int) -> int:
    return len(re.split(r"\r\n|\r|\n", text[:offset]))


def _texts() -> Iterator[tuple[str, str]]:
    for name in programs.names():
        yield name, programs.load(name)
    for folder in (ROOT / "tests" / "programs", HERE / "programs"):
        for path in sorted(folder.glob("*.lrp")):
            yield path.stem, path.read_bytes().decode()
    for path in sorted((ROOT / "notebooks").rglob("*.ipynb")):
        if ".ipynb_checkpoints" in path.parts:
            continue
        for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
            text = "".join(cell["source"])
            if text.startswith("%%lrp"):
                yield path.stem, text.partition("\n")[2]
            elif "solution" in text:
                for index, code in enumerate(_CODE.findall(text)):
                    yield f"{path.stem}, solution {index}", code


@lru_cache(maxsize=1)
def sources() -> tuple[Source, ...]:
    """All correct programs that start something."""
    found = []
    for name, text in _texts():
        program, _ = scan(text)
        if program is not None and program.spawns and program.machines:
            found.append(Source(name, text))
    return tuple(found)
