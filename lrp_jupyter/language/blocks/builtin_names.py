"""The names that blocks use without defining or importing them, besides Python's own."""

import builtins
import math

PROVIDED = frozenset({"robot", "print", "degrees"})
TIME_TEXTS = {
    "elapsed": "Seconds since the state was entered; in a condition, the state that it leaves.",
    "dt": "Seconds since the last tick: `x = x + speed * dt` is right at any rate. 0 in the first tick.",
}
TIMES = frozenset(TIME_TEXTS)
"""Names of times in seconds, computed where they are used: since the state was entered, since the last tick.

A variable of the program or a name of the notebook that is called like one hides it.
"""


def degrees(angle: float) -> float:
    """Convert an angle from degrees to radians.

    ``robot.move(angular=degrees(45))`` turns by 45 degrees per second. A variable of the program or a name of
    the notebook that is called ``degrees`` hides it. Python's ``math.degrees`` is the inverse.
    """
    return math.radians(angle)


def builtin(name: str) -> object:
    """Return the value of a name that only Python or LRP defines; raise AttributeError if neither does."""
    return degrees if name == "degrees" else getattr(builtins, name)
