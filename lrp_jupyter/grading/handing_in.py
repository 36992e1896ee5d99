"""What is handed in without a file: a code of a text, to be written down, and a link with a program in it."""

from __future__ import annotations

import hashlib
import re
import zlib
from base64 import urlsafe_b64decode
from functools import lru_cache
from typing import NamedTuple
from urllib.parse import parse_qs, unquote

from lrp_jupyter.errors import FileError

_LINK = re.compile(
    r"https?://[^\s?#<>\"']*(?:\?(?P<query>(?:(?!https?://)[^\s#<>\"'])*))?#text=(?P<packed>[\w-]+)"
)
_LONGEST = 1_000_000  # characters of a program
_SYMBOLS = "0123456789ABCDEFGHJKMNPQRSTVWXYZ"  # without those that are easily taken for others
_LENGTH = 8
_ROUNDS = 2000  # so that trying millions of texts until one has a given code takes too long


@lru_cache(64)
def code_of(text: str) -> str:
    """Return the hand-in code of a text, such as ``K7M2-QX9D``; white space does not matter."""
    digest = "".join(text.split()).encode("utf-8", "surrogatepass")
    for _ in range(_ROUNDS):
        digest = hashlib.sha256(digest).digest()
    number = int.from_bytes(digest[:_LENGTH])
    code = "".join(_SYMBOLS[number >> 5 * place & 31] for place in range(_LENGTH))
    return f"{code[:4]}-{code[4:]}"


class Linked(NamedTuple):
    """A program in a link that a page of a site has made.

    `before`: what stands before the link in its line, such as the name of a student.
    `challenge`: the one that it is for; empty if the link names none.
    `program`: its name; may be empty.
    """

    before: str
    challenge: str
    program: str
    text: str


def programs_in(text: str) -> list[Linked]:
    """Return the programs in the links of a text, such as a mail, a list or an Internet shortcut.

    Raises FileError: a link is damaged.
    """
    return [_linked(line, found) for line in map(_plain, text.splitlines()) for found in _LINK.finditer(line)]


def names_in(text: str) -> list[tuple[str, bool]]:
    """Return, for each line of a list of links, what stands before its link, and whether there is one.

    A line without a link is returned as it is. A text with fewer than two links is not a list: it has none.
    """
    lines = [line.strip() for line in text.splitlines()]
    found = [_LINK.search(_plain(line)) for line in lines]
    if sum(each is not None for each in found) < 2:
        return []
    return [
        (line, False) if link is None else (_before(_plain(line), link), True)
        for line, link in zip(lines, found, strict=True)
    ]


def _before(line: str, found: re.Match[str]) -> str:
    """Return what stands before a link, without what programs put around it."""
    return re.split("https?://|URL=|<[^<>]*$", line[: found.start()])[0].strip(" \t,;:\"'|-")


def _plain(line: str) -> str:
    """Return a line as it was before a mail program put its link into one of its own."""
    return unquote(line) if "%23text%3D" in line else line


def _linked(line: str, found: re.Match[str]) -> Linked:
    before = _before(line, found)
    try:
        packed = urlsafe_b64decode(found["packed"] + "=" * (-len(found["packed"]) % 4))
        inflate = zlib.decompressobj(wbits=-15)
        text = inflate.decompress(packed, _LONGEST).decode()
        if not inflate.eof or inflate.unused_data:
            raise ValueError("It is cut off or has more than a program, or is too long.")
    except (ValueError, zlib.error) as error:
        whose = f" of `{before}`" if before else ""
        raise FileError(
            f"The link{whose} is damaged, so the program in it cannot be read. Ask for it again, copied as a"
            " whole."
        ) from error
    asked = parse_qs(found["query"] or "")
    challenge, program = (asked.get(key, [""])[0] for key in ("challenge", "program"))
    return Linked(before, challenge, program, text)
