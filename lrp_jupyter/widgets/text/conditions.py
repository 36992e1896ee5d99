"""The conditions of a study: how live a lab is, what it shows, and whether a page can change that."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any, get_args

from lrp_jupyter.arguments import check_choice, check_switch
from lrp_jupyter.errors import LRPError
from lrp_jupyter.widgets.wire.protocol import Edits, GraphMode

CHOICES: dict[str, tuple[str, ...]] = {"edits": get_args(Edits), "graph": get_args(GraphMode)}
"""The words of the conditions that are not switches."""


@dataclass(frozen=True)
class Conditions:
    """See :meth:`Lab.set_conditions <lrp_jupyter.widgets.lab.Lab.set_conditions>`."""

    edits: Edits = "live"
    graph: GraphMode = "live"
    quiet: bool = False
    lock: bool = False

    def __post_init__(self) -> None:
        for name, words in CHOICES.items():
            check_choice(name, getattr(self, name), words)
        check_switch("quiet", self.quiet)
        check_switch("lock", self.lock)

    def switched(self, **changes: Any) -> Conditions:
        """Return the conditions with changes that a page makes, or raise if they are locked."""
        if self.lock:
            raise LRPError(
                "This lab is locked for a study: the page can change neither when edits take effect nor "
                "what is shown of the run."
            )
        return replace(self, **changes)


NAMES = tuple(field.name for field in fields(Conditions))


def given(**named: Any) -> Conditions | None:
    """Return the named conditions, with the defaults of the others; None if none is named."""
    known = {name: value for name, value in named.items() if value is not None}
    return Conditions(**known) if known else None
