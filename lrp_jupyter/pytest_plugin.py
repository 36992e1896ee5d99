"""A pytest plugin: a test that fails also says what the sessions that it used did.

It imports no other module of this package: sessions are in use only where a test has imported them.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from typing import Any
from weakref import WeakKeyDictionary

import pytest

_BEFORE = pytest.StashKey[Mapping[Any, int]]()


def _sessions() -> list[Any]:
    runner = sys.modules.get("lrp_jupyter.live.runner")
    return [] if runner is None else sorted(runner.sessions, key=lambda session: session.name)


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Note how far the sessions of earlier tests have come."""
    item.stash[_BEFORE] = WeakKeyDictionary({each: each.interpreter.tick for each in _sessions()})


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Iterator[None]:
    """Add a section for every session that a failed test has used."""
    result: Any = yield
    test = result.get_result()
    if test.failed:
        before = item.stash.get(_BEFORE, {})
        used = [each for each in _sessions() if before.get(each) != each.interpreter.tick]
        test.sections += [(f"lrp: {session.name}", _report(session)) for session in used]


def _report(session: Any) -> str:
    from lrp_jupyter.testing import report

    try:
        return report(session)
    except Exception as error:  # the failure of the test is shown, whatever else fails
        return f"The session cannot be asked: {error}"
