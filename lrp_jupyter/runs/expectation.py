"""What is expected of a kept run: one line that a person writes, such as ``reaches m/end, never touches``.

========================  ======================================================================
``as recorded``           the same states are entered at the same times; ``until 12 s``: up to then
``reaches STATE``         the state is entered; ``within 30 s``: by then
``never enters STATE``    the state is not entered; ``never STATE`` is short for it
``never touches``         the simulated robot touches nothing; ``never touches NAME``: not NAME
``meets CHALLENGE``       the criteria of a challenge are met
========================  ======================================================================

Several are separated by commas, and all of them have to hold.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import NamedTuple

from lrp_jupyter.errors import LRPError
from lrp_jupyter.grading.challenges import Challenge
from lrp_jupyter.grading.challenges import load as load_challenge

AS_RECORDED = "as recorded"
_FORMS = (
    ("as recorded", re.compile(r"as recorded(?: until (?P<time>\S+) ?s)?")),
    ("touches", re.compile(r"never touches(?: `?(?P<name>[^`,]+)`?)?")),
    ("never", re.compile(r"never (?:enters )?`?(?P<name>[\w/]+)`?")),
    ("reaches", re.compile(r"reaches `?(?P<name>[\w/]+)`?(?: within (?P<time>\S+) ?s)?")),
    ("meets", re.compile(r"meets (?P<name>`[^`]+`|[^`,]+)")),
)


class ExpectedPart(NamedTuple):
    """One thing that is expected.

    `kind`: ``as recorded``, ``reaches``, ``never`` (enters), ``touches`` (never) or ``meets``.
    `name`: of the state, solid or challenge; empty for any solid.
    `time`: in seconds of the run; None if there is no limit.
    """

    kind: str
    name: str = ""
    time: float | None = None

    def __str__(self) -> str:
        limit = "" if self.time is None else f"{self.time:g} s"
        match self.kind:
            case "as recorded":
                return f"as recorded until {limit}" if limit else AS_RECORDED
            case "reaches":
                return f"reaches {self.name} within {limit}" if limit else f"reaches {self.name}"
            case "never":
                return f"never enters {self.name}"
            case "touches":
                return f"never touches {self.name}".rstrip()
        return f"meets `{self.name}`" if "," in self.name else f"meets {self.name}"


@dataclass(frozen=True)
class Expectation:
    """What is expected of a run: everything in `parts`."""

    parts: tuple[ExpectedPart, ...] = (ExpectedPart("as recorded"),)

    def __str__(self) -> str:
        return ", ".join(map(str, self.parts))

    @property
    def challenges(self) -> dict[str, Challenge]:
        """The challenges whose criteria are to be met, as they are named here.

        Raises LRPError: there is no such challenge.
        """
        return {part.name: load_challenge(part.name) for part in self.parts if part.kind == "meets"}


def expectation(text: str) -> Expectation:
    """Return the expectation that a line describes; an empty one stands for ``as recorded``.

    Raises
    ------
    LRPError
        It cannot be read; the message says what can be written.
    """
    parts = [_part(each.strip()) for each in re.findall(r"(?:`[^`]*`|[^,])+", text) if each.strip()]
    return Expectation(tuple(parts)) if parts else Expectation()


def _part(text: str) -> ExpectedPart:
    plain = " ".join(text.split())
    for kind, form in _FORMS:
        found = form.fullmatch(plain)
        if found is not None:
            given = found.groupdict()
            return ExpectedPart(
                kind, (given.get("name") or "").strip("` "), _seconds(given.get("time"), plain)
            )
    raise LRPError(
        f"`{plain}` is not something that can be expected of a run. Write `as recorded`, `reaches STATE`, "
        "`reaches STATE within 30 s`, `never enters STATE`, `never touches`, `meets CHALLENGE`, or several "
        "of these, separated by commas."
    )


def _seconds(text: str | None, part: str) -> float | None:
    if text is None:
        return None
    try:
        seconds = float(text)
    except ValueError:
        seconds = -1.0
    if not 0 <= seconds < 1e7:
        raise LRPError(f"`{text}` in `{part}` is not a number of seconds.")
    return seconds
