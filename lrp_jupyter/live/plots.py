"""Plots: variables and readings over time, with what the conditions of the program compare them with."""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import chain
from typing import Literal, NamedTuple

from lrp_jupyter.errors import UnknownElementError, did_you_mean
from lrp_jupyter.interpreter.by_path import full_path
from lrp_jupyter.language.expressions import UnknownValueError, evaluate, expression_of, names_in
from lrp_jupyter.language.names import as_path
from lrp_jupyter.language.program import Path, Program, path_text
from lrp_jupyter.language.resolution import Scope, resolve
from lrp_jupyter.live.loop import Loop
from lrp_jupyter.live.recorded_robot import RecordedRobot

__all__ = ["Plot", "Threshold", "plots_of", "plots_of_named", "plottable"]

_ROBOT = "robot."
_MOST = 6  # thresholds of a plot


@dataclass(frozen=True, slots=True)
class Threshold:
    """What a condition compares a plotted name with.

    Parameters
    ----------
    text : str
        As it is written.
    values : tuple of float or None
        For every sample; None where it is not known.
    """

    text: str
    values: tuple[float | None, ...]


@dataclass(frozen=True, slots=True)
class Plot:
    """The samples of a variable or a reading, one for each tick.

    Parameters
    ----------
    name : str
        The path of a variable, or ``robot.`` and that of a reading.
    kind : str
        ``number`` or ``truth`` (then values are 0 and 1).
    times : tuple of float
        Seconds of the run.
    values : tuple of float or None
        None where it had no value, or no number.
    thresholds : tuple of Threshold
    """

    name: str
    kind: Literal["number", "truth"]
    times: tuple[float, ...]
    values: tuple[float | None, ...]
    thresholds: tuple[Threshold, ...] = ()


def plottable(loop: Loop) -> list[str]:
    """Return the names of what has a number or a truth value now; between two ticks."""
    variables = [path_text(path) for path, value in loop.frame.values.items() if _is_number(value)]
    readings = loop.bridge.readings_of(loop.moments[-1][2]) if loop.moments else {}
    return variables + [_ROBOT + name for name, value in readings.items() if _is_number(value)]


def plots_of(loop: Loop, wanted: Mapping[str, int]) -> list[Plot]:
    """Return the samples of names; between two ticks.

    Parameters
    ----------
    loop : Loop
    wanted : mapping of str to int
        For each name the tick after which samples are wanted.
    """
    if not wanted:
        return []
    program, first = loop.interpreter.program, min(wanted.values())
    compared = {name: list(_compared(program, name)) for name in wanted}
    paths = {as_path(name) for name in wanted if not name.startswith(_ROBOT)}
    paths |= {path for each in compared.values() for other in each for path in other.variables.values()}
    reads = any(name.startswith(_ROBOT) for name in wanted) or any(
        other.reads_robot for each in compared.values() for other in each
    )
    samples = list(_samples(loop, paths, first, reads))
    samples.reverse()
    plots = []
    for name, after in wanted.items():
        here = [sample for sample in samples if sample.tick > after]
        values = [sample.value(name) for sample in here]
        numbers = tuple(map(_number, values))
        known = [value for value in values if value is not None]
        is_truth = bool(known) and all(isinstance(value, bool) for value in known)
        thresholds = () if is_truth else tuple(Threshold(each.text, each.of(here)) for each in compared[name])
        times = tuple(sample.time for sample in here)
        plots.append(Plot(name, "truth" if is_truth else "number", times, numbers, thresholds))
    return plots


def plots_of_named(loop: Loop, names: Iterable[str]) -> list[Plot]:
    """Return all samples of names that a person has written; between two ticks.

    Raises
    ------
    UnknownElementError
        There is no such variable or reading, or several variables have that name.
    """
    plots = plots_of(loop, {_whole(loop, name): 0 for name in names})
    for plot in plots:
        if plot.times and not _is_known(loop, plot):
            known = plottable(loop)
            hint = (
                did_you_mean(plot.name, known) or f" There are: {', '.join(f'`{name}`' for name in known)}."
            )
            raise UnknownElementError(f"There is no variable or reading `{plot.name}` to plot.{hint}")
    return plots


def _whole(loop: Loop, name: str) -> str:
    """Return the path of a variable that is called by its name only; other names unchanged."""
    path, present = as_path(name), loop.frame.values
    if name.startswith(_ROBOT) or len(path) > 1 or not any(each[-1:] == path for each in present):
        return name
    return path_text(full_path(path, tuple(present)))


def _is_known(loop: Loop, plot: Plot) -> bool:
    """Return whether a plotted name is, or was, that of a variable or a reading."""
    if any(value is not None for value in plot.values):
        return True
    if plot.name.startswith(_ROBOT):
        return plot.name.removeprefix(_ROBOT) in loop.bridge.readings_of(loop.moments[-1][2])
    path, names = as_path(plot.name), resolve(loop.interpreter.program)
    scope = names.by_path.get(names.defined(path[:-1]))
    return path in loop.frame.values or (scope is not None and path[-1] in scope.variables)


class _Sample(NamedTuple):
    tick: int
    time: float
    variables: Mapping[Path, object]
    readings: Mapping[str, object]
    nodes: Mapping[str, object]

    def value(self, name: str) -> object:
        if name.startswith(_ROBOT):
            return self.readings.get(name.removeprefix(_ROBOT))
        return self.variables.get(as_path(name))


def _samples(loop: Loop, paths: set[Path], after: int, reads: bool) -> Iterator[_Sample]:
    """Yield the values of variables and the readings in the ticks after a tick, the last one first."""
    bridge, now = loop.bridge, loop.interpreter.tick
    nodes = bridge.nodes.table
    for tick, variables in loop.interpreter.history.followed(paths, after):
        place = tick - now - 1
        if -place > len(loop.moments):
            return
        time, _, sensed = loop.moments[place]
        yield _Sample(tick, time, variables, bridge.readings_of(sensed) if reads else {}, nodes)


class _Compared(NamedTuple):
    """An expression with which a condition compares a name."""

    text: str
    tree: ast.expr
    variables: dict[str, Path]

    def of(self, samples: list[_Sample]) -> tuple[float | None, ...]:
        """Return its values."""
        if isinstance(self.tree, ast.Constant):
            return (_number(self.tree.value),) * len(samples)
        values: list[float | None] = []
        before: list[object] | None = None
        reads_robot = self.reads_robot
        for sample in samples:
            now = [sample.variables.get(path) for path in self.variables.values()]
            is_same = before is not None and all(map(operator.is_, now, before))
            values.append(values[-1] if is_same and not reads_robot else self._at(sample))
            before = now
        return tuple(values)

    @property
    def reads_robot(self) -> bool:
        """Whether its value depends on readings."""
        return "robot" in names_in(self.tree)

    def _at(self, sample: _Sample) -> float | None:
        def lookup(name: str) -> object:
            if name == "robot":
                return RecordedRobot(sample.readings, sample.nodes)
            path = self.variables.get(name)
            if path is None or path not in sample.variables:
                raise UnknownValueError(name)
            return sample.variables[path]

        try:
            return _number(evaluate(self.tree, lookup).value)
        except Exception:  # whatever the expression of the user raises
            return None


def _compared(program: Program, name: str) -> Iterator[_Compared]:
    """Yield what the conditions of a program compare a name with."""
    is_reading, path = name.startswith(_ROBOT), as_path(name)
    written = name if is_reading else path[-1]
    seen: set[object] = set()
    for arrow in chain.from_iterable(resolve(program).arrows.values()):
        if arrow.tested is None:
            continue
        block, scope = arrow.tested
        tree = expression_of(block.text)
        if tree is None or not (is_reading or _means(scope, path)):
            continue
        for other in _others(tree, written):
            variables = {
                each: (*scope.visible[each].path, each) for each in names_in(other) if each in scope.visible
            }
            key = ast.unparse(other), tuple(sorted(variables.items()))
            if key not in seen and len(seen) < _MOST:
                seen.add(key)
                yield _Compared(key[0], other, variables)


def _means(scope: Scope, path: Path) -> bool:
    """Return whether the bare name of a variable means it in a scope."""
    owner = scope.visible.get(path[-1])
    return owner is not None and owner.path == path[:-1]


def _others(tree: ast.expr, written: str) -> Iterator[ast.expr]:
    """Yield what stands on the other side of comparisons with a name."""
    for node in ast.walk(tree):
        if not isinstance(node, ast.Compare):
            continue
        sides = [node.left, *node.comparators]
        texts = [ast.unparse(side) for side in sides]
        for index, text in enumerate(texts):
            for beside in (index - 1, index + 1):
                if text == written and 0 <= beside < len(sides) and texts[beside] != written:
                    yield sides[beside]


def _is_number(value: object) -> bool:
    return isinstance(value, (bool, int, float))


def _number(value: object) -> float | None:
    """Return a value as a number that can be drawn."""
    if not _is_number(value):
        return None
    try:
        number = float(value)  # type: ignore[arg-type]
    except OverflowError:
        return None
    return number if math.isfinite(number) else None
