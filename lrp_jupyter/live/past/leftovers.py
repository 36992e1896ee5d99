"""Effects of undone ticks that a rewind leaves behind, which may change how the run continues.

The journal undoes assignments, but not in-place changes of objects, issues, or the state of the random
numbers. A run that reaches a tick without having executed the undone ticks may therefore continue differently
from one that was rewound to it.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Set as AbstractSet

from lrp_jupyter.language.program import Element, path_text
from lrp_jupyter.live.running.checkpoints import COPIED, PLAIN, SessionCheckpoint

_RANDOM = "random"


def leftover(rewound: SessionCheckpoint, clean: SessionCheckpoint) -> str:
    """Return what a rewind left behind, beside a run that came to the tick from an earlier one; or ""."""
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
    is_drawn = _RANDOM in text and rewound.random != clean.random  # others may use the generator
    return "the state of the random numbers" if is_drawn else ""


def differ(one: object, other: object) -> bool:
    """Return whether two values are known to differ; mutable objects may have been changed since."""
    if type(one) not in PLAIN or type(other) not in PLAIN:
        return False
    return one != other and (one == one or other == other)  # NaN does not equal itself


def _differ_inside(one: object, other: object) -> bool:
    """Return whether two values differ, neither of which has changed since it was copied."""
    kind = type(one)
    if kind in PLAIN or kind is not type(other):
        return differ(one, other) or (kind is not type(other) and {kind, type(other)} <= {*COPIED})
    try:
        if isinstance(one, (list, tuple, deque)) and isinstance(other, (list, tuple, deque)):
            return len(one) != len(other) or any(map(_differ_inside, one, other))
        if isinstance(one, dict) and isinstance(other, dict):
            return _differ_inside([*one.items()], [*other.items()])
        if kind in COPIED:  # elements of sets are immutable
            return one != other
    except RecursionError:  # it contains itself, or is nested deeply
        return False
    return False


def _known(checkpoint: SessionCheckpoint) -> AbstractSet[tuple[Element, str, bool]]:
    """Return the issues; a new one pauses the program."""
    return {(issue.element, issue.kind, issue.resolved) for issue in checkpoint.snapshot.issues}
