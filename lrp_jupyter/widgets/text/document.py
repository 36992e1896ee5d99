"""The authoritative text that all views of a lab share, with its numbered updates.

A page changes the text that it knows, of a certain revision, and need not wait: its changes are mapped over
those that others have made since (`TextChanges.map`), each becomes the next update, and every view gets all
updates in their order. A view with unsent changes maps the others' changes over them, and so arrives at the
same text.
"""

from __future__ import annotations

import re
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice
from secrets import token_hex

from lrp_jupyter.widgets.wire.changes import TextChanges, difference, from_units, to_units

_MOST_UPDATES = 5_000
_MOST_CHARACTERS = 2_500_000  # inserted by all updates together
_LINE_END = re.compile(r"\r\n|\r|\n")


@dataclass(frozen=True)
class Update:
    """Changes that made the next revision."""

    view: str  # that made them; empty for the kernel
    changes: TextChanges


class Document:
    """See the module's docstring."""

    def __init__(self, text: str = "") -> None:
        self.name = token_hex(8)  # distinguishes this document from that of another kernel
        self.revision = 1
        self.text = text  # as the program has it: in characters, with its own line ends
        self.units = to_units(text)  # as the editor has it
        self.told = 1  # the revision that all views have been sent; the updates after it are always kept
        self._line_end = _line_end(text) or "\n"
        self._updates: deque[Update] = deque()
        self._characters = 0

    def since(self, revision: int) -> list[Update]:
        """Return the updates after a revision; a ValueError if they are not known, or no longer."""
        if not self.knows(revision):
            raise ValueError(f"The updates since revision {revision} are not known.")
        return list(islice(self._updates, len(self._updates) - (self.revision - revision), None))

    def knows(self, revision: int) -> bool:
        """Return whether the updates after a revision are known."""
        return self.revision - len(self._updates) <= revision <= self.revision

    def replace(self, text: str) -> list[TextChanges]:
        """Continue with another text; return the changes that lead to it."""
        units = to_units(text)
        self._line_end = _line_end(text) or self._line_end
        changes = [] if units == self.units else [difference(self.units, units)]
        for each in changes:
            self._add(Update("", each))
        self.text, self.units = text, units
        return changes

    def merge(
        self, view: str, base: int, changes: Sequence[TextChanges]
    ) -> tuple[list[TextChanges], list[TextChanges]]:
        """Turn a view's successive changes of the text of a revision into the next updates, and return these.

        Also return what others have changed since that revision, for a place in the view's text. Raises
        ValueError: they are not changes of that text, or it is no longer known.
        """
        since = self.since(base)
        if any(update.view == view for update in since):
            raise ValueError("The view does not know its own changes.")
        others = [update.changes for update in since]
        length = others[0].length if others else len(self.units)
        merged = []
        for own in changes:
            if own.length != length:
                raise ValueError("The changes are not of this text.")
            length = own.new_length
            mapped, theirs = own, []
            for other in others:
                theirs.append(other.map(mapped, first=True))
                mapped = mapped.map(other)
            others = theirs
            merged.append(mapped)
        for each in merged:
            self._add(Update(view, each))
        if merged:
            self.text = from_units(self.units, self._line_end)
        return merged, others

    def offset(self, place: int) -> int:
        """Return the offset in `text` of a place in `units`."""
        return len(from_units(self.units[:place], self._line_end))

    def with_line_ends(self, text: str) -> str:
        """Return another text with the line ends of this one."""
        return from_units(to_units(text), self._line_end)

    def _add(self, update: Update) -> None:
        self.units = update.changes.apply(self.units)
        self.revision += 1
        self._updates.append(update)
        self._characters += _inserted(update)
        while self.knows(self.told - 1) and self._is_long():
            self._characters -= _inserted(self._updates.popleft())

    def _is_long(self) -> bool:
        return len(self._updates) > _MOST_UPDATES or self._characters > _MOST_CHARACTERS


def _inserted(update: Update) -> int:
    return sum(len(text or "") for _, text in update.changes.sections)


def _line_end(text: str) -> str:
    """Return the line end of a text: that of a page if it has several, an empty text if it has none."""
    ends = set(_LINE_END.findall(text)) if "\r" in text else {"\n"} if "\n" in text else set()
    return ends.pop() if len(ends) == 1 else "\n" if ends else ""
