"""What if a variable had other values? The same session, run on from one moment with each of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from typing import overload

from lrp_jupyter.interpreter.rendering import short
from lrp_jupyter.language.program import Path, path_text

_WIDTH, _HEIGHT = 120, 80  # pixels of the picture of a path


@dataclass(frozen=True, slots=True)
class Trial:
    """One run with one value.

    `seconds`: its duration.
    `reached`: seconds until the awaited state was entered, or the condition held; None if that did not
        happen, or nothing was awaited.
    `outcome`: the result of the outcome function at the end.
    `active`: the active states at the end.
    `issues`: the number of issues that were open at the end.
    `path`: the path of the simulated robot, in metres: its position at every tick.
    """

    value: object
    seconds: float
    reached: float | None
    outcome: object
    active: tuple[Path, ...]
    issues: int
    path: tuple[tuple[float, float], ...] = ()

    @property
    def driven(self) -> float:
        """Metres that the robot has driven."""
        return sum(math.dist(a, b) for a, b in zip(self.path, self.path[1:], strict=False))


@dataclass(frozen=True, repr=False)
class Trials(Sequence[Trial]):
    """Runs with different values of one variable; a notebook shows them as a table with the robot's paths."""

    variable: str
    trials: tuple[Trial, ...]
    awaited: str = ""

    @overload
    def __getitem__(self, index: int) -> Trial: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Trial, ...]: ...
    def __getitem__(self, index: int | slice) -> Trial | tuple[Trial, ...]:
        return self.trials[index]

    def __len__(self) -> int:
        return len(self.trials)

    def _rows(self) -> list[list[str]]:
        rows = [[f"`{self.variable}`"]]
        if self.awaited:
            rows[0].append(f"time until {self.awaited}")
        if any(trial.outcome is not None for trial in self):
            rows[0].append("outcome")
        rows[0] += ["active at the end", "issues"]
        if any(trial.path for trial in self):
            rows[0].append("driven")
        for trial in self:
            row = [short(trial.value)]
            if self.awaited:
                row.append("not reached" if trial.reached is None else f"{trial.reached:.1f} s")
            if "outcome" in rows[0]:
                outcome = trial.outcome
                row.append(f"{outcome:.6g}" if isinstance(outcome, float) else short(outcome))
            row += [", ".join(map(path_text, trial.active)) or "nothing", str(trial.issues)]
            if "driven" in rows[0]:
                row.append(f"{trial.driven:.2f} m")
            rows.append(row)
        return rows

    def __str__(self) -> str:
        rows = self._rows()
        widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
        return "\n".join(
            "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
            for row in rows
        )

    __repr__ = __str__

    def _repr_html_(self) -> str:
        head, *rows = self._rows()
        drawn = any(trial.path for trial in self)
        cells = "".join(
            f"<th>{escape(cell.strip('`'))}</th>" for cell in (*head, *(["path"] if drawn else []))
        )
        lines = []
        for row, trial in zip(rows, self, strict=True):
            texts = "".join(f"<td>{escape(cell)}</td>" for cell in row)
            lines.append(f"<tr>{texts}{f'<td>{self._picture(trial)}</td>' if drawn else ''}</tr>")
        return f"<table><thead><tr>{cells}</tr></thead><tbody>{''.join(lines)}</tbody></table>"

    def _picture(self, trial: Trial) -> str:
        """Draw the path of a robot, in the same scale for all trials."""
        points = [point for each in self for point in each.path]
        left, right = min(x for x, _ in points), max(x for x, _ in points)
        low, high = min(y for _, y in points), max(y for _, y in points)
        scale = min((_WIDTH - 8) / max(right - left, 0.1), (_HEIGHT - 8) / max(high - low, 0.1))
        line = " ".join(
            f"{4 + (x - left) * scale:.1f},{_HEIGHT - 4 - (y - low) * scale:.1f}" for x, y in trial.path
        )
        end = line.rpartition(" ")[2].split(",")
        return (
            f'<svg width="{_WIDTH}" height="{_HEIGHT}" role="img" aria-label="Path of the robot">'
            f'<polyline points="{line}" fill="none" stroke="currentColor" stroke-width="1.5"/>'
            f'<circle cx="{end[0]}" cy="{end[1]}" r="3" fill="currentColor"/></svg>'
        )
