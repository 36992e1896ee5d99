"""The clocks that blocks read in a graded run: `time` and `datetime` follow the run, not the computer.

A run of a minute is computed in a second. With the computer's clock, a program would do something else in
each run, and another thing than in the lab.
"""

from __future__ import annotations

import datetime
import time
from collections.abc import Callable, Mapping
from types import ModuleType
from typing import Any, NoReturn

from lrp_jupyter.errors import LRPError
from lrp_jupyter.live.running.notebook_names import with_modules

_BEGINNING = datetime.datetime(2000, 1, 1, tzinfo=datetime.UTC)  # of every run


def with_run_clock(namespace: Mapping[str, Any], seconds: Callable[[], float]) -> dict[str, Any]:
    """Return a copy of a namespace whose blocks read the time of a run from Python's clocks.

    `seconds`: since the run began.
    """
    return with_modules(namespace, _time(seconds), _datetime(seconds))


def _time(seconds: Callable[[], float]) -> ModuleType:
    def now() -> float:
        return _BEGINNING.timestamp() + seconds()

    clocks = {"time": now, "monotonic": seconds, "perf_counter": seconds, "process_time": seconds}
    module = ModuleType("time", time.__doc__)
    vars(module).update(vars(time), **clocks, sleep=_sleep)
    for name, clock in clocks.items():
        setattr(module, f"{name}_ns", lambda clock=clock: round(clock() * 1e9))
    for function in (time.gmtime, time.localtime):
        setattr(module, function.__name__, lambda at=None, f=function: f(now() if at is None else at))
    return module


def _datetime(seconds: Callable[[], float]) -> ModuleType:
    class RunDateTime(datetime.datetime):
        @classmethod
        def now(cls, tz: datetime.tzinfo | None = None) -> Any:
            moment = _BEGINNING + datetime.timedelta(seconds=seconds())
            moment = moment.astimezone(tz) if tz else moment.replace(tzinfo=None)
            return cls.combine(moment.date(), moment.timetz())

        utcnow = today = now

    class RunDate(datetime.date):
        @classmethod
        def today(cls) -> Any:
            return cls.fromordinal(RunDateTime.now().toordinal())

    module = ModuleType("datetime", datetime.__doc__)
    vars(module).update(vars(datetime), datetime=RunDateTime, date=RunDate)
    return module


def _sleep(seconds: float) -> NoReturn:
    raise LRPError(
        "`sleep` holds up the whole program, and a graded run does not wait. Use a state with `ontime`"
        " instead."
    )
