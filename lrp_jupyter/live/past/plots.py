"""Plots: variables and readings over time, with the values that conditions of the program compare them with.

Ten minutes at 100 Hz take seconds to compute, so only the recorded data is copied between two ticks; the
caller computes the plot from the copy while the robot keeps running.
"""

from __future__ import annotations

import ast
import math
import operator
from bisect import bisect_left
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, product
from typing import Literal, NamedTuple

from lrp_jupyter.language.blocks.expressions import UnknownValueError, evaluate, expression_of, names_in
from lrp_jupyter.language.blocks.names_in_blocks import as_path
from lrp_jupyter.language.lookup import called, find, missing
from lrp_jupyter.language.program import Block, Path, Program, path_text
from lrp_jupyter.language.resolution import Scope, resolve
from lrp_jupyter.live.running.loop import Loop
from lrp_jupyter.live.why.recorded_robot import RecordedRobot

_ROBOT = "robot."
_MOST = 6  # maximum number of thresholds in a plot
_READ = 3  # maximum number of plots of what one condition reads

_Tested = tuple[Block, Scope]


@dataclass(frozen=True, slots=True)
class Threshold:
    """An expression that a condition compares a plotted name with.

    `text`: the expression as written.
    `values`: its value for every sample; None where it is unknown.
    """

    text: str
    values: tuple[float | None, ...]


@dataclass(frozen=True, slots=True)
class Plot:
    """The samples of a variable or a reading, one for each tick.

    `name`: the path of a variable, or ``robot.`` and the path of a reading.
    `kind`: ``number`` or ``truth`` (then values are 0 and 1).
    `times`: seconds of the run.
    `values`: the samples; None where there was no value, or one that is not a number.
    """

    name: str
    kind: Literal["number", "truth"]
    times: tuple[float, ...]
    values: tuple[float | None, ...]
    thresholds: tuple[Threshold, ...] = ()


def plottable(loop: Loop) -> list[str]:
    """Return the names that now have a number or a truth value; called between two ticks."""
    variables = [path_text(path) for path, value in loop.frame.values.items() if _is_number(value)]
    return variables + [_ROBOT + name for name, value in loop.record.readings.items() if _is_number(value)]


def plotting(
    loop: Loop, wanted: Mapping[str, int], tested: Iterable[_Tested] | None = None
) -> Callable[[], list[Plot]]:
    """Copy the samples of each name after a tick; return a function that plots them, on any thread.

    `tested`: the conditions whose comparisons are thresholds; by default those of all transitions.
    """
    if not wanted:
        return list
    program, first = loop.interpreter.program, min(wanted.values())
    conditions = list(_conditions(program) if tested is None else tested)
    machines = _Machines(loop)
    compared = {name: list(_compared(conditions, name, machines)) for name in wanted}
    paths = {as_path(name) for name in wanted if not name.startswith(_ROBOT)}
    paths |= {path for each in compared.values() for other in each for path in other.variables.values()}
    reads = any(name.startswith(_ROBOT) for name in wanted) or any(
        other.reads_robot for each in compared.values() for other in each
    )
    samples = _samples(loop, paths, first, reads)
    columns = [_Column(name, after, compared[name]) for name, after in wanted.items()]

    def plots() -> list[Plot]:
        for sample in samples:  # none is kept, or the garbage collector would visit all again and again
            for column in columns:
                column.add(sample)
        return [column.plot() for column in columns]

    return plots


class _Column:
    """Collects the samples of a name, newest first."""

    def __init__(self, name: str, after: int, compared: Sequence[_Compared]) -> None:
        self._name, self._after = name, after
        self._is_reading = name.startswith(_ROBOT)
        self._path = as_path(name)
        self._times: list[float] = []
        self._values: list[float | None] = []
        self._kinds: set[bool] = set()  # whether its values were truth values
        self._thresholds = [_Followed(each) for each in compared]

    def add(self, sample: _Sample) -> None:
        if sample.tick <= self._after:
            return
        if self._is_reading:
            value = sample.readings.get(self._name.removeprefix(_ROBOT))
        else:
            value = sample.variables.get(self._path)
        if value is not None:
            self._kinds.add(isinstance(value, bool))
        self._times.append(sample.time)
        self._values.append(_number(value))
        for threshold in self._thresholds:
            threshold.add(sample)

    def plot(self) -> Plot:
        is_truth = self._kinds == {True}
        thresholds = () if is_truth else tuple(each.threshold() for each in self._thresholds)
        kind: Literal["number", "truth"] = "truth" if is_truth else "number"
        return Plot(self._name, kind, tuple(self._times[::-1]), tuple(self._values[::-1]), thresholds)


def plotting_named(
    loop: Loop, names: Iterable[str], event: str | Path | None = None, seconds: float = math.inf
) -> Callable[[], list[Plot]]:
    """Return a function as :func:`plotting` does, for the last samples of names written by a person.

    `event`: the one whose condition has the thresholds and, without names, what is plotted.
    Raises UnknownElementError: several variables have that name. The function raises it if none ever had it.
    """
    program = loop.interpreter.program
    tested = None if event is None else _condition(program, event)
    whole = [_whole(loop, name) for name in names]
    if tested is not None and not whole:
        whole = _read_by(loop, *tested)
    present = {name for name in whole if _is_present(loop, name)}
    readings = [each for each in plottable(loop) if each.startswith(_ROBOT)]
    history = loop.interpreter.history
    first = bisect_left(history.ticks, loop.timing.now - seconds, key=history.time)
    after = history.ticks.start + first - 1
    compute = plotting(loop, dict.fromkeys(whole, after), None if tested is None else [tested])

    def plots() -> list[Plot]:
        found = compute()
        for plot in found:
            had_value = any(value is not None for value in plot.values)
            if plot.times and not had_value and plot.name not in present:
                raise missing([program], ("variable", "reading"), plot.name, others=readings)
        return found

    return plots


def _condition(program: Program, event: str | Path) -> _Tested:
    path = find(program, "event", event).path
    scope = resolve(program).by_path[path[:-1]]
    return scope.events[path[-1]].condition, scope


def _read_by(loop: Loop, block: Block, scope: Scope) -> list[str]:
    """Return the names to plot of a condition, compared readings first; none is in a threshold."""
    tree, known = expression_of(block.text), set(plottable(loop))
    if tree is None:
        return []
    names: dict[str, str] = {}  # by how they are written
    sides: set[str] = set()
    for node in ast.walk(tree):
        text = ast.unparse(node) if isinstance(node, (ast.Name, ast.Attribute)) else ""
        owner = scope.visible.get(text)
        name = text if owner is None else _whole(loop, path_text((*owner.path, text)))
        if name in known:
            names[text] = name
        if isinstance(node, ast.Compare):
            sides.update(ast.unparse(side) for side in (node.left, *node.comparators))
    found: list[str] = []
    covered: set[str] = set()
    for text in sorted(names, key=lambda each: (each not in sides, not each.startswith(_ROBOT))):
        if text not in covered:
            found.append(names[text])
            covered |= {ast.unparse(node) for other in _others(tree, text) for node in ast.walk(other)}
    return found[:_READ]


def _whole(loop: Loop, name: str) -> str:
    """Return the path, as spawned, of a variable; any other name unchanged."""
    values = loop.frame.values
    return path_text(values.path(name)) if as_path(name) in values else name


def _is_present(loop: Loop, name: str) -> bool:
    """Return whether a name is a reading, or a variable that exists or may exist."""
    if name.startswith(_ROBOT):
        return name.removeprefix(_ROBOT) in loop.record.readings
    return as_path(name) in loop.frame.values or bool(called(loop.interpreter.program, "variable", name))


class _Sample(NamedTuple):
    tick: int
    time: float
    variables: Mapping[Path, object]
    readings: Mapping[str, object]
    nodes: Mapping[str, object]


def _samples(loop: Loop, paths: set[Path], after: int, reads: bool) -> Iterator[_Sample]:
    """Return the values of variables and the readings in the ticks after a tick, newest first."""
    record, nodes = loop.record, loop.bridge.nodes.table
    followed = loop.interpreter.history.followed(paths, after)
    moments = record.moments.last(max(0, loop.interpreter.tick - after))
    return (
        _Sample(tick, time, variables, record.readings_of(sensed) if reads else {}, nodes)
        for (tick, variables), (time, _, sensed, _) in zip(followed, moments, strict=False)
    )


class _Compared(NamedTuple):
    """An expression with which a condition compares a name."""

    text: str
    tree: ast.expr
    variables: dict[str, Path]

    @property
    def reads_robot(self) -> bool:
        """Whether its value depends on readings."""
        return "robot" in names_in(self.tree)

    def at(self, sample: _Sample) -> float | None:
        """Return its value."""

        def lookup(name: str) -> object:
            if name == "robot":
                return RecordedRobot(sample.readings, sample.nodes)
            path = self.variables.get(name)
            if path is None or path not in sample.variables:
                raise UnknownValueError(name)
            return sample.variables[path]

        try:
            return _number(evaluate(self.tree, lookup).value)
        except Exception:  # any exception of the user's expression
            return None


class _Followed:
    """Collects the values of an expression, newest first."""

    def __init__(self, compared: _Compared) -> None:
        self._compared = compared
        self._reads_robot = compared.reads_robot
        self._values: list[float | None] = []
        self._before: list[object] | None = None  # the values of its variables in the previous sample

    def add(self, sample: _Sample) -> None:
        now = [sample.variables.get(path) for path in self._compared.variables.values()]
        is_same = self._before is not None and all(map(operator.is_, now, self._before))
        self._values.append(
            self._values[-1] if is_same and not self._reads_robot else self._compared.at(sample)
        )
        self._before = now

    def threshold(self) -> Threshold:
        return Threshold(self._compared.text, tuple(self._values[::-1]))


def _conditions(program: Program) -> Iterator[_Tested]:
    """Yield the conditions of all transitions."""
    for arrow in chain.from_iterable(resolve(program).arrows.values()):
        if arrow.tested is not None:
            yield arrow.tested


class _Machines:
    """Where machines run, as spawned, and where they find the variables that they see."""

    def __init__(self, loop: Loop) -> None:
        self.defined = resolve(loop.interpreter.program).defined
        self._running: dict[Path, dict[Path, None]] = {}
        for path in loop.frame.active:
            for end in range(1, len(path), 2):
                self._running.setdefault(self.defined(path[:end]), {})[path[:end]] = None

    def paths(self, scope: Scope) -> list[Path]:
        """Return the paths of the instances of a machine that run, or else where it is defined."""
        return list(self._running.get(scope.path, [scope.path]))

    def paths_inside(self, machine: Path, owner: Scope, scope: Scope) -> list[Path]:
        """Return the paths of the instances of a machine in one whose variables they see."""
        found = [path for path in self.paths(scope) if path[: len(machine)] == machine]
        return found or [(*machine, *scope.path[len(owner.path) :])]

    def variable(self, machine: Path, owner: Scope, name: str) -> Path:
        """Return the path of a variable that a machine sees."""
        around = (machine[:end] for end in range(len(machine), 0, -2))
        found = next((path for path in around if self.defined(path) == owner.path), owner.path)
        return (*found, name)


def _compared(conditions: Iterable[_Tested], name: str, machines: _Machines) -> Iterator[_Compared]:
    """Yield the expressions that conditions compare a name with."""
    is_reading, path = name.startswith(_ROBOT), as_path(name)
    written, machine = (name, ()) if is_reading else (path[-1], path[:-1])
    defined = machines.defined(machine)
    seen: set[object] = set()
    for block, scope in conditions:
        visible = scope.visible
        owner = None if is_reading else visible.get(written)
        tree = expression_of(block.text)
        if tree is None or not (is_reading or (owner is not None and owner.path == defined)):
            continue
        places = machines.paths(scope) if owner is None else machines.paths_inside(machine, owner, scope)
        for here, other in product(places, _others(tree, written)):
            used = [each for each in names_in(other) if each in visible]
            variables = {each: machines.variable(here, visible[each], each) for each in used}
            key = ast.unparse(other), tuple(sorted(variables.items()))
            if key not in seen and len(seen) < _MOST:
                seen.add(key)
                yield _Compared(key[0], other, variables)


def _others(tree: ast.expr, written: str) -> Iterator[ast.expr]:
    """Yield the other sides of comparisons with a name."""
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
