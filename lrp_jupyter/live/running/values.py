"""The texts of the variables in frames, rendered on the loop's thread in a small share of its time.

A value is rendered on this thread and between two ticks, because foreign code must not run on two threads at
a time. Scalars are rendered for every frame. Any other value whose rendering was slow is rendered again
later, so that rendering takes about a twentieth of the loop's time however many frames there are; until then
a frame shows its earlier text. All texts are current while the program is paused, and in frames made by a
caller that runs the loop itself: these are the same on every machine, however busy it is.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from contextlib import AbstractContextManager, suppress
from time import perf_counter

from lrp_jupyter.errors import name_of
from lrp_jupyter.interpreter.rendering import is_scalar, of_type, render
from lrp_jupyter.language.program import Path, path_text

_SPACING = 20.0
"""Time between two renderings of a value, in multiples of the time that those of one frame take."""


def numbers_of(values: Iterable[tuple[Path, object]]) -> dict[Path, float]:
    """Return the variables that are numbers which a float can hold."""
    numbers: dict[Path, float] = {}
    for path, value in values:
        kind = type(value)
        if issubclass(kind, (int, float)) and kind is not bool:
            with suppress(OverflowError):
                numbers[path] = (int if issubclass(kind, int) else float).__float__(value)  # type: ignore[arg-type]
    return numbers


class ValueTexts:
    """The last text of each variable, and when it may be rendered again; `calling` is the context of that."""

    def __init__(self, calling: Callable[[str], AbstractContextManager[None]]) -> None:
        self._calling = calling
        self._known: dict[Path, tuple[str, float]] = {}
        self._endless: dict[int, type] = {}  # by id, because a metaclass may define `==`

    def of(self, values: Iterable[tuple[Path, object]], now: bool, foreign: bool = True) -> dict[Path, str]:
        """Return the texts of all variables.

        `now`: whether every text must be current.
        `foreign`: whether foreign code may run; if not, the type is shown for a value without a text.
        """
        texts: dict[Path, str] = {}
        known: dict[Path, tuple[str, float]] = {}
        wall, spent = perf_counter(), 0.0
        for path, value in values:
            if is_scalar(value):
                texts[path] = render(value)
                continue
            text, due = self._known.get(path, ("", 0.0))
            if not foreign:
                text = text or render(value, of_type)
            elif now or wall >= due or id(type(value)) in self._endless:
                start = perf_counter()
                with self._calling(f"{path_text(path)}.__repr__"):
                    text = render(value, self._repr)
                end = perf_counter()
                spent += end - start
                due = end + _SPACING * spent
            texts[path] = text
            known[path] = text, due
        self._known = known
        return texts

    def _repr(self, value: object) -> str:
        """Return the text of a value by its own ``__repr__``, unless that had to be interrupted earlier."""
        kind = type(value)
        if id(kind) in self._endless:
            return f"<{name_of(kind)}: not shown, because `__repr__` did not return>"
        try:
            return repr(value)
        except (Exception, SystemExit):
            raise
        except BaseException:  # an interruption
            self._endless[id(kind)] = kind
            raise
