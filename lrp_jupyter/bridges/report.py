"""What the conformance tests found out about a bridge, to read."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Outcome", "Report"]


@dataclass(frozen=True, slots=True)
class Outcome:
    """One check: what it is about, and what is wrong (empty if nothing)."""

    check: str
    problem: str = ""

    @property
    def passed(self) -> bool:
        """Whether the bridge keeps it."""
        return not self.problem


@dataclass(frozen=True, slots=True)
class Report:
    """What `check_bridge` found; printed, it is a list to read."""

    bridge: str
    outcomes: tuple[Outcome, ...]

    @property
    def passed(self) -> bool:
        """Whether the bridge keeps everything."""
        return all(outcome.passed for outcome in self.outcomes)

    @property
    def problems(self) -> tuple[Outcome, ...]:
        """The checks that failed."""
        return tuple(outcome for outcome in self.outcomes if not outcome.passed)

    def __bool__(self) -> bool:
        return self.passed

    def __str__(self) -> str:
        good = len(self.outcomes) - len(self.problems)
        lines = [f"{self.bridge}: {good} of {len(self.outcomes)} checks passed"]
        for outcome in self.outcomes:
            lines.append(f"  {'ok  ' if outcome.passed else 'FAIL'}  {outcome.check}")
            if outcome.problem:
                lines.append(f"        {outcome.problem}")
        return "\n".join(lines)

    __repr__ = __str__
