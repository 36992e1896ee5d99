"""Sweeps: a program with other initial values of its variables, each graded with many seeds.

``sweep(program, "there and back", search=[0.4, 0.8, 1.2], seeds=30)`` answers which values are the fastest,
and which are the most robust.
"""

from __future__ import annotations

import json
import math
import statistics
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from html import escape
from itertools import product
from numbers import Integral, Real
from typing import Any, NamedTuple

from lrp_jupyter.arguments import check_type
from lrp_jupyter.errors import UnknownElementError
from lrp_jupyter.grading.batch import Progress, grade_all
from lrp_jupyter.grading.challenges import Challenge, challenge
from lrp_jupyter.grading.grade import Grade, namespace_of, text_of
from lrp_jupyter.grading.heatmap import by_run, by_values
from lrp_jupyter.grading.progress import shown_progress
from lrp_jupyter.grading.workers import HowRun
from lrp_jupyter.language.edits.initials import with_initial
from lrp_jupyter.spreadsheets import csv_text

Value = bool | int | float | str


class SweepPoint(NamedTuple):
    """The grade of a program with certain initial values.

    Parameters
    ----------
    values : tuple
        One for each variable of the sweep.
    grade : Grade
    """

    values: tuple[Value, ...]
    grade: Grade

    @property
    def passed(self) -> int:
        """How many runs passed."""
        return self.grade.runs_passed

    @property
    def share(self) -> float:
        """The share of the runs that passed, 0 to 1."""
        return self.passed / self.grade.runs

    @property
    def times(self) -> tuple[float, ...]:
        """The times after which the runs that passed were done, in seconds."""
        return tuple(attempt.seconds for attempt in self.grade.attempts if attempt.passed)

    @property
    def median(self) -> float | None:
        """The median of the times; None if no run passed."""
        return statistics.median(self.times) if self.times else None

    @property
    def worst(self) -> float | None:
        """The longest of the times; None if no run passed."""
        return max(self.times, default=None)


@dataclass(frozen=True)
class Sweep:
    """The result of :func:`sweep`. ``print(result)`` shows a table; in a notebook there is also a map.

    Parameters
    ----------
    challenge : str
    variables : tuple of str
    points : tuple of SweepPoint
        One for each combination of values; those of the last variable change fastest.
    noisy : bool
        Whether the robot has noise in this challenge: only then do seeds differ in more than random numbers
        of the program.
    """

    challenge: str
    variables: tuple[str, ...]
    points: tuple[SweepPoint, ...] = field(repr=False)
    noisy: bool = True

    @property
    def axes(self) -> tuple[tuple[Value, ...], ...]:
        """The values of each variable, in their order."""
        return tuple(
            tuple(dict.fromkeys(point.values[axis] for point in self.points))
            for axis in range(len(self.variables))
        )

    @cached_property
    def fastest(self) -> SweepPoint | None:
        """Of those with which the most runs pass, the one with the shortest median time; None if none do."""
        passing = [point for point in self._top() if point.median is not None]
        return min(passing, key=lambda point: point.median or 0.0, default=None)

    @cached_property
    def most_robust(self) -> SweepPoint | None:
        """Of those with which the most runs pass, the one furthest from all others; None if none pass.

        With one variable this is the middle of the longest row of neighbours with which the most runs pass.
        With several, the shortest way along any axis to a value with which fewer pass counts first.
        """
        top = {point.values: point for point in self._top()}
        places = {
            values: index
            for index, values in zip(
                product(*map(range, map(len, self.axes))), product(*self.axes), strict=True
            )
        }
        inside = {places[values] for values in top}

        def depth(point: SweepPoint) -> tuple[float, ...]:
            ways = [_ways(places[point.values], axis, inside) for axis in range(len(self.variables))]
            nearest = [min(way) for way in ways]
            return min(nearest), sum(nearest), sum(map(sum, ways)), -(point.median or 0.0)

        return max(top.values(), key=depth, default=None)

    def _top(self) -> list[SweepPoint]:
        """Return the points at which the most runs pass; none if none do."""
        most = max((point.share for point in self.points), default=0.0)
        return [point for point in self.points if point.share == most > 0]

    def __str__(self) -> str:
        columns, rows = self.table()
        cells = [[*columns], *([_shown(each) for each in row] for row in rows)]
        widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
        lines = [
            "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
            for row in cells
        ]
        return "\n".join([self.title, *lines, *self.notes()])

    @property
    def title(self) -> str:
        """What was swept, in a line."""
        runs = self.points[0].grade.runs if self.points else 0
        return f"{self.challenge}: {', '.join(self.variables)}, {runs} runs each"

    def notes(self) -> Iterator[str]:
        """Yield the conclusions as sentences."""
        if self.fastest is None or self.most_robust is None:
            yield "No run passed."
            return
        for what, point in (("Fastest", self.fastest), ("Most robust", self.most_robust)):
            values = ", ".join(
                f"{name} = {value!r}" for name, value in zip(self.variables, point.values, strict=True)
            )
            share = f"{point.passed} of {point.grade.runs} runs passed"
            yield f"{what}: {values} ({share}, median {point.median:.1f} s, worst {point.worst:.1f} s)."
        if not self.noisy:
            yield "The robot has no noise in this challenge, so runs with different seeds may be equal."

    def table(self) -> tuple[tuple[str, ...], list[tuple[object, ...]]]:
        """Return the columns and rows of the table; times in seconds, None where no run passed."""
        columns = (*self.variables, "passed", "runs", "points", "median_s", "worst_s", "remark")
        return columns, [
            (
                *point.values,
                *(point.passed, point.grade.runs, point.grade.points),
                *(None if time is None else round(time, 2) for time in (point.median, point.worst)),
                self.remark(point),
            )
            for point in self.points
        ]

    def remark(self, point: SweepPoint) -> str:
        """Return ``fastest``, ``most robust``, both, or nothing."""
        words = ["fastest"] * (point is self.fastest) + ["most robust"] * (point is self.most_robust)
        return ", ".join(words)

    def csv(self) -> str:
        """Return the table for a spreadsheet."""
        return csv_text(*self.table())

    def to_json(self) -> str:
        """Return everything that is known of every run."""
        data = {
            "challenge": self.challenge,
            "variables": self.variables,
            "points": [
                {
                    "values": point.values,
                    "passed": point.passed,
                    "runs": point.grade.runs,
                    "points": point.grade.points,
                    "median": point.median,
                    "worst": point.worst,
                    "remark": self.remark(point),
                    "attempts": [each.to_dict() for each in point.grade.attempts],
                }
                for point in self.points
            ],
        }
        return json.dumps(data, ensure_ascii=False, indent=1) + "\n"

    def svg(self) -> str:
        """Return a heat map: of one variable each run, coloured by time; of two the shares that passed.

        Raises
        ------
        ValueError
            There are more than two variables.
        """
        remarks = [self.remark(point) for point in self.points]
        grades = [point.grade for point in self.points]
        if len(self.variables) == 1:
            (values,) = self.axes
            return by_run(self.title, self.variables[0], list(map(_shown, values)), grades, remarks)
        if len(self.variables) == 2:
            first, second = (list(map(_shown, axis)) for axis in self.axes)
            shares = [point.share for point in self.points]
            return by_values(self.title, self.variables, (first, second), shares, remarks)
        raise ValueError(
            f"A map has one or two variables, not {len(self.variables)}. Sweep fewer, or use the table."
        )

    def _repr_html_(self) -> str:
        columns, rows = self.table()
        head = "".join(f"<th>{escape(each)}</th>" for each in columns)
        body = "".join(
            "<tr>" + "".join(f"<td>{escape(_shown(each))}</td>" for each in row) + "</tr>" for row in rows
        )
        notes = "".join(f"<p>{escape(note)}</p>" for note in self.notes())
        title = f"<p><b>{escape(self.title)}</b></p>"
        return (
            f"{self.svg() if len(self.variables) <= 2 else title}{notes}"
            f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
        )


def _ways(place: tuple[int, ...], axis: int, inside: set[tuple[int, ...]]) -> list[int]:
    """Return how many steps one can go down and up an axis without leaving a set of places."""
    ways = []
    for step in (-1, 1):
        count = 0
        while (*place[:axis], place[axis] + step * (count + 1), *place[axis + 1 :]) in inside:
            count += 1
        ways.append(count)
    return ways


def _shown(value: object) -> str:
    return "" if value is None else f"{value:g}" if isinstance(value, float) else str(value)


def sweep(
    program: Any,
    what: str | Challenge,
    values: Mapping[str, Iterable[Any]] | None = None,
    /,
    *,
    seeds: int | Iterable[int] = 30,
    namespace: dict[str, Any] | None = None,
    limit: float = 60,
    memory: float = 1000,
    processes: int | None = None,
    scheduler: str | None = None,
    **variables: Iterable[Any],
) -> Sweep:
    """Grade a program with all combinations of other initial values of its variables.

    Parameters
    ----------
    program : str, Program, Session or Lab
    what : str or Challenge
        A challenge or its name; the noise of its robot is different with every seed.
    values : mapping of str to iterable, optional
        Values by variable, for variables that cannot be keywords: ``{"follower/looking/lookalgo/time": …}``.
    seeds : int or iterable of int
        Number of runs in each world, or their seeds.
    namespace : dict, optional
        Names available to the blocks; default: those of the session or lab, if one is given.
    limit, memory : float
        Seconds and megabytes that one run may need, as in :func:`grade`.
    processes : int, optional
        How many runs at a time; default: one for each processor.
    scheduler : str, optional
        The address of a Dask scheduler, whose workers make the runs, or ``"local"`` for a cluster on this
        machine; needs the extra ``batch``.
    **variables : iterable of number, str or bool
        Values by variable.

    Returns
    -------
    Sweep

    Raises
    ------
    LRPSyntaxError
        The text is not a valid program.
    UnknownElementError
        There is no such variable, or several have that name.
    LRPError
        There is no such challenge, or the cluster cannot be reached.

    Examples
    --------
    >>> text = "(var v := [0.1]) (machine m (state a (running [robot.move(linear=v)]))) (spawn m a)"
    >>> result = sweep(text, "first move", v=[0.05, 0.1, 0.15], seeds=2)
    >>> result.fastest.values
    (0.15,)
    """
    check_type("what", what, (str, Challenge), "the name of a challenge or a Challenge")
    task = challenge(what) if isinstance(what, str) else what
    axes = {name: _checked(name, each) for name, each in {**(values or {}), **variables}.items()}
    if not axes:
        raise ValueError("A sweep needs a variable with its values, as in `search=[0.4, 0.8, 1.2]`.")
    names = namespace_of(program) if namespace is None else namespace
    how = HowRun(limit, memory, processes, scheduler, names)
    with shown_progress("sweep") as progress:
        return sweep_axes(text_of(program), task, axes, seeds, how, progress)


def sweep_axes(
    text: str,
    task: Challenge,
    axes: Mapping[str, Sequence[Value]],
    seeds: int | Iterable[int],
    how: HowRun,
    progress: Progress,
) -> Sweep:
    """Grade a text with all combinations of the values of its variables; see :func:`sweep`."""
    combinations = list(product(*axes.values()))
    texts = []
    for values in combinations:
        changed = text
        for name, value in zip(axes, values, strict=True):
            try:
                changed = with_initial(changed, name, repr(value))
            except UnknownElementError as error:
                raise UnknownElementError(f"`{name}` cannot be swept: {error}", error.candidates) from None
        texts.append(changed)
    grades = grade_all(texts, task, seeds, how, progress)
    points = tuple(map(SweepPoint, combinations, grades))
    return Sweep(task.name, tuple(axes), points, task.noise is not None)


def _checked(name: str, values: Iterable[Any]) -> tuple[Value, ...]:
    """Return the values of a variable, each once, as values that Python can read again.

    Raises TypeError, ValueError: one is neither a number, a text nor a truth value, or there is none.
    """
    if isinstance(values, str) or not isinstance(values, Iterable):
        raise TypeError(f"`{name}` must be a list of values, as in `{name}=[0.4, 0.8, 1.2]`.")
    checked: dict[Value, None] = {}
    for value in values:
        if isinstance(value, (bool, str)):
            checked[value] = None
        elif isinstance(value, Integral):  # NumPy's too
            checked[int(value)] = None
        elif isinstance(value, Real):
            if not math.isfinite(value):
                raise ValueError(
                    f"`{name}` cannot be {value!r}: that is not a number that a program can hold."
                )
            checked[float(value)] = None
        else:
            kind = type(value).__name__
            raise TypeError(f"`{name}` can be numbers, texts and truth values, not {kind}.")
    if not checked:
        raise ValueError(f"`{name}` has no values. Give it some, as in `{name}=[0.4, 0.8, 1.2]`.")
    return tuple(checked)
