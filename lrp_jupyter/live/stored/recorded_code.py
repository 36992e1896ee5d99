"""Whether the code of a recording, which a replay executes, was recorded by this user.

The first line of a recording identifies its run. For each run, as for a kept text (``own.py``), a hash of the
code that this user has recorded is stored, and updated with every further program and expression. A recording
that was truncated, renamed or compressed still counts as the user's own; one whose code was changed does not.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from lrp_jupyter.own import digest, is_own, note_own

_RUN = ("text", "unmeant", "expression")
"""The fields of an input that are executed."""


class RecordedCode:
    """The code of the lines of a recording, one after the other."""

    def __init__(self) -> None:
        self._place = self._digest = ""

    def add(self, line: Mapping[str, Any]) -> int:
        """Add the code of a line; return how many characters it has."""
        if not self._place:
            code = json.dumps(line, sort_keys=True)
            self._place = f"recording {code}"
        elif "input" in line and any(field in line for field in _RUN):
            code = json.dumps({field: line.get(field) for field in _RUN}, sort_keys=True)
        else:
            return 0
        self._digest = digest(self._digest + code)
        return len(code)

    def note(self, line: Mapping[str, Any]) -> None:
        """Add the code of a line that this user records."""
        if self.add(line):
            note_own(self._place, self._digest)

    def is_own(self) -> bool:
        """Return whether this user recorded the code added so far."""
        return is_own(self._place, self._digest)
