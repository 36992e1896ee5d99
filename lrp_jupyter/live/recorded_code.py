"""The code of a recording, which is run when the recording is: whether it is this user's own.

The first line of a recording is that of one run only. For it is noted, as for a kept text (``own.py``), what
this user recorded: a hash over the code up to there, with every program and expression that is added. A
recording that was cut off, renamed or compressed is still one's own; one whose code was changed is not.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from lrp_jupyter.own import digest, is_own, note_own

_RUN = ("text", "unmeant", "expression")
"""The fields of an input that are run."""


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
        """Return whether this user has recorded the code up to here."""
        return is_own(self._place, self._digest)
