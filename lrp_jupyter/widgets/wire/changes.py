r"""Sets of changes to a text, and the merging of changes that were made at the same time.

A `TextChanges` describes the whole text section by section: each stays, or is replaced. It corresponds to
CodeMirror's `ChangeSet`, in its JSON form (`Sections`), and is mapped over another one with the same result,
so that kernel and pages arrive at the same text. With changes `a` and `b` of one text,
``b.map(a).apply(a.apply(text)) == a.map(b, first=True).apply(b.apply(text))``.

Texts here are as in the editor: sequences of UTF-16 units, with ``\n`` at the end of a line. A character
outside the basic plane is therefore two characters of a Python string.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from lrp_jupyter.language.edits.text_difference import Section, text_difference

Sections = list[int | list[int | str]]
"""A number of units that stay, or a list: the number of units to delete, and the lines in their place."""

_ASTRAL = re.compile("[\U00010000-\U0010ffff]")
_PAIR = re.compile("[\ud800-\udbff][\udc00-\udfff]")


@dataclass(frozen=True)
class TextChanges:
    """Changes to a text of a certain length."""

    sections: tuple[Section, ...]
    """For each section of the text its length, and the text in its place; None if it stays."""

    @classmethod
    def of(cls, sections: Iterable[Section]) -> TextChanges:
        """Return the changes in their normal form, in which neighbouring sections of a kind are one."""
        found: list[Section] = []
        for length, text in sections:
            if not length and not text:
                continue
            last = found[-1] if found else (1, "-")
            if not text and text == last[1]:
                found[-1] = last[0] + length, text
            elif not length and last[0] == 0 and text and last[1]:
                found[-1] = 0, last[1] + text
            else:
                found.append((length, text))
        return cls(tuple(found))

    @classmethod
    def from_json(cls, sections: Sections) -> TextChanges:
        """Return what a page has sent; a ValueError if it is not a set of changes."""
        found: list[Section] = []
        for each in sections:
            length, *lines = each if isinstance(each, list) else [each]
            if not isinstance(length, int) or length < 0 or (not length and not any(lines) and not lines[1:]):
                raise ValueError("A section must have a length.")
            if not all(isinstance(line, str) and not re.search("[\r\n]", line) for line in lines):
                raise ValueError("A section must consist of lines.")
            found.append((length, to_units("\n".join(map(str, lines))) if isinstance(each, list) else None))
        return cls(tuple(found))

    def json(self) -> Sections:
        """Return the form that the page reads."""
        return [
            length if text is None else [length, *(from_units(text).split("\n") if text else [])]
            for length, text in self.sections
        ]

    @property
    def length(self) -> int:
        """The length of the text to which it applies."""
        return sum(length for length, _ in self.sections)

    @property
    def new_length(self) -> int:
        """The length of the text that results."""
        return sum(length if text is None else len(text) for length, text in self.sections)

    @property
    def is_empty(self) -> bool:
        """Whether it changes nothing."""
        return all(text is None for _, text in self.sections)

    def apply(self, text: str) -> str:
        """Return the text after the changes."""
        parts, at = [], 0
        for length, instead in self.sections:
            parts.append(text[at : at + length] if instead is None else instead)
            at += length
        return "".join(parts)

    def map(self, other: TextChanges, first: bool = False) -> TextChanges:
        """Return these changes for the text in which others of the same text were made.

        `first`: whether text that both insert at the same place goes in the order self, other.
        """
        return TextChanges.of(_mapped(_SectionReader(self.sections), _SectionReader(other.sections), first))

    def map_place(self, place: int, after: bool = False) -> int:
        """Return the position of a place after the changes; at an insertion, before or after it."""
        old = new = 0
        for length, text in self.sections:
            end = old + length
            if text is None:
                if place < end or (place == end and not after):
                    return new + place - old
                new += length
            elif place < end or (place == end and not after):
                return new if place == old or not after else new + len(text)
            else:
                new += len(text)
            old = end
        return new + place - old


class _SectionReader:
    """Reads sections, also in pieces: `left` is the rest of the present one, `text` its replacement."""

    def __init__(self, sections: Iterable[Section]) -> None:
        self._sections = iter(sections)
        self.next()

    def next(self) -> None:
        """Go to the next section."""
        section = next(self._sections, None)
        self.is_done = section is None
        self.left, self.text = section or (0, None)
        self.is_whole = True
        self.is_written = False  # whether only the rest of what the text replaces is to be deleted

    def skip(self, length: int) -> None:
        """Read a piece of the present section, or all of it."""
        if length == self.left:
            self.next()
        else:
            self.left -= length
            self.is_whole = False


def _mapped(mine: _SectionReader, other: _SectionReader, first: bool) -> Iterator[Section]:
    """Read two sets of changes side by side; yield the sections of the first one after the second one."""
    while not (mine.is_done and other.is_done):
        if mine.text is None and other.text is None:  # both leave it
            length = min(mine.left, other.left)
            if not length:
                raise ValueError("The changes are not of one text.")
            yield length, None
            mine.skip(length)
            other.skip(length)
        elif other.text is not None and _comes_first(other, mine, first):
            yield len(other.text), None
            left = other.left
            while left:
                if mine.is_done:
                    raise ValueError("The changes are not of one text.")
                piece = min(mine.left, left)
                if mine.text is not None and not mine.is_written and mine.left <= piece:
                    yield 0, mine.text  # the text that it replaces is gone
                    mine.is_written = True
                mine.skip(piece)
                left -= piece
            other.next()
        else:
            assert mine.text is not None
            kept, left = 0, mine.left
            while left:  # up to the next text of the other one
                if other.is_done:
                    raise ValueError("The changes are not of one text.")
                if other.text is None:
                    piece = min(left, other.left)
                    kept += piece
                    left -= piece
                    other.skip(piece)
                elif other.text == "" and other.left < left:
                    left -= other.left
                    other.next()
                else:
                    break
            yield kept, "" if mine.is_written else mine.text
            mine.is_written = True
            mine.skip(mine.left - left)


def _comes_first(other: _SectionReader, mine: _SectionReader, first: bool) -> bool:
    """Return whether a replacement comes before what the other side has at the same place."""
    if mine.text is None or mine.is_written:
        return True
    return mine.is_whole and (other.left < mine.left or (other.left == mine.left and not first))


def difference(old: str, new: str) -> TextChanges:
    """Return small changes that turn one text into another."""
    return TextChanges.of(text_difference(old, new))


# -- between characters and units --------------------------------------------------------------------


def with_line_feeds(text: str) -> str:
    """Return a text with the line ends of a page."""
    return text.replace("\r\n", "\n").replace("\r", "\n") if "\r" in text else text


def to_units(text: str) -> str:
    r"""Return a text as the editor has it: UTF-16 units, ``\n`` at the end of a line."""
    text = with_line_feeds(text)
    return text if text.isascii() else _ASTRAL.sub(_split, text)


def _split(found: re.Match[str]) -> str:
    number = ord(found[0]) - 0x10000
    return chr(0xD800 + (number >> 10)) + chr(0xDC00 + (number & 0x3FF))


def from_units(units: str, line_end: str = "\n") -> str:
    """Return a text as Python and files have it."""
    if not units.isascii():
        units = _PAIR.sub(lambda found: found[0].encode("utf-16", "surrogatepass").decode("utf-16"), units)
    return units if line_end == "\n" else units.replace("\n", line_end)
