"""Typical mistakes inside blocks."""

from __future__ import annotations

import re
from collections.abc import Iterator

from .planting import Slip, kind, slip
from .sources import Source


@kind("inside: `:=` for `=`")
def _(source: Source) -> Iterator[Slip]:
    for form in source.all("onentry", "running", "onexit", "onpause", "onresume"):
        for _, start, end in form.of("BLOCK"):
            for match in re.finditer(r"(?<=[\n\[;] )?\b\w+ = (?!=)", source.text[start:end]):
                at = start + match.end() - 2
                before = source.text[start : start + match.start()].rstrip(" ")[-1]
                if before in "[\n;":
                    yield slip(at, at + 1, ":=")


@kind("inside: `true` for `True`")
def _(source: Source) -> Iterator[Slip]:
    for form in source.forms:
        for _, start, end in form.of("BLOCK"):
            for match in re.finditer(r"\b(True|False)\b", source.text[start:end]):
                yield slip(start + match.start(), start + match.end(), match[0].lower())


@kind("inside: missing `)`")
def _(source: Source) -> Iterator[Slip]:
    for form in source.forms:
        for _, start, end in form.of("BLOCK"):
            for match in re.finditer(r"\)", source.text[start:end]):
                if not re.search(r"['\"#]", source.text[start:end]):
                    yield slip(start + match.start(), start + match.end(), "")
