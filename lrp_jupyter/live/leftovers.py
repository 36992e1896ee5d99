"""What is left of ticks that a rewind has undone, and may make the run go on in another way.

The journal undoes assignments. Objects that were changed in place stay as they are, and so do issues and the
state of the random numbers. So a run that comes from an earlier tick, and never made those ticks, may go on
in another way than the one that went back.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Set as AbstractSet

from lrp_jupyter.language.program import Element, path_text
from lrp_jupyter.live.checkpoints import COPIED, PLAIN, SessionCheckpoint

_RANDOM = "random"


def leftover(rewound: SessionCheckpoint, clean: SessionCheckpoint) -> str:
    """Return in words something that is left; empty if nothing is, as far as that is known.

    `rewound`: the session, when it had gone back.
    `clean`: a run that has come to the same tick from before.
    """
    before, after = rewound.snapshot, clean.snapshot
    left, fresh = before.contents(), after.contents()
    if left.keys() != fresh.keys() or [each.place for each in before.machines] != [
        each.place for each in after.machines
    ]:
        return "a state"
    for path, value in left.items():
        if _differ_inside(value, fresh[path]):
            return f"`{path if isinstance(path, str) else path_text(path)}`"
    if _known(rewound) != _known(clean):
        return "an issue"
    text = before.source[0] if isinstance(before.source, tuple) else _RANDOM
    is_drawn = _RANDOM in text and rewound.random != clean.random  # others may draw from the same generator
    return "the state of the random numbers" if is_drawn else ""


def differ(one: object, other: object) -> bool:
    """Return whether two values differ, as far as that is known: what can be changed may have been."""
    if type(one) not in PLAIN or type(other) not in PLAIN:
        return False
    return one != other and (one == one or other == other)  # not a number is not even itself


def _differ_inside(one: object, other: object) -> bool:
    """Return whether two values differ that nothing has changed since they were copied."""
    kind = type(one)
    if kind in PLAIN or kind is not type(other):
        return differ(one, other) or (kind is not type(other) and {kind, type(other)} <= {*COPIED})
    try:
        if isinstance(one, (list, tuple, deque)) and isinstance(other, (list, tuple, deque)):
            return len(one) != len(other) or any(map(_differ_inside, one, other))
        if isinstance(one, dict) and isinstance(other, dict):
            return _differ_inside([*one.items()], [*other.items()])
        if kind in COPIED:  # what sets contain cannot be changed
            return one != other
    except RecursionError:  # it contains itself, or is nested deeply
        return False
    return False


def _known(checkpoint: SessionCheckpoint) -> AbstractSet[tuple[Element, str, bool]]:
    """Return the issues, which pause a program when they are new."""
    return {(issue.element, issue.kind, issue.resolved) for issue in checkpoint.snapshot.issues}
