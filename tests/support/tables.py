"""A table of cases in one test: every row is tried, and those that fail are reported together."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable
from functools import wraps
from typing import Any

import pytest


def every(names: str | tuple[str, ...], rows: Iterable[Any]) -> Callable[[Any], Any]:
    """Call a test with every row, as `pytest.mark.parametrize` does, but as one test.

    Fixtures are the same for all rows.
    """
    columns, table = (names,) if isinstance(names, str) else names, tuple(rows)
    assert table, "an empty table tests nothing"

    def decorate(test: Any) -> Any:
        @wraps(test)
        def with_every_row(**fixtures: Any) -> None:
            failed: list[BaseException] = []
            for row in table:
                values = (row,) if isinstance(names, str) else row
                try:
                    test(**fixtures, **dict(zip(columns, values, strict=True)))
                except (Exception, pytest.fail.Exception) as failure:
                    failure.add_note(f"Row: {values!r:.1000}")
                    failed.append(failure)
            if failed:
                raise BaseExceptionGroup(f"{len(failed)} of {len(table)} rows", failed)

        signature = inspect.signature(test)
        rest = [each for each in signature.parameters.values() if each.name not in columns]
        with_every_row.__signature__ = signature.replace(parameters=rest)  # type: ignore[attr-defined]
        return with_every_row

    return decorate
