"""Evaluate the test of a transition again, with the recorded values."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from time import perf_counter
from types import BuiltinFunctionType, CellType, FunctionType, ModuleType
from typing import Any

from lrp_jupyter.interpreter.history import PastState
from lrp_jupyter.interpreter.trace_events import UNSET
from lrp_jupyter.interpreter.tree import is_boolean
from lrp_jupyter.language.blocks.builtin_names import builtin
from lrp_jupyter.language.blocks.expressions import Evaluation, UnknownValueError, evaluate, expression_of
from lrp_jupyter.language.program import Path
from lrp_jupyter.language.triggers import Delay
from lrp_jupyter.live.running.checkpoints import PLAIN
from lrp_jupyter.live.running.notebook_names import ABSENT
from lrp_jupyter.live.why.case import Case
from lrp_jupyter.live.why.earlier_names import Names
from lrp_jupyter.live.why.recorded_robot import RecordedRobot
from lrp_jupyter.live.why.recorded_run import RecordedRun

_SEARCH = 0.03  # wall seconds to search for the last time a condition was true
_UNCHANGING = (FunctionType, BuiltinFunctionType, ModuleType, type)


def evaluate_again(case: Case) -> Evaluation | Exception | None:
    """Return a test with its parts: from recorded values, or else by running the tick again.

    An exception says why they are unknown; None means that there is no expression.
    """
    if case.tested is None:
        return None
    block, scope = case.tested
    expression = expression_of(block.text)
    problem: Exception | None = None
    if expression is not None:
        cells, written = _cells(case.state, scope.path), case.run.history.written(case.tick)
        try:
            return evaluate(expression, _lookup(case.run, case.tick, cells, case.state.value, written))
        except Exception as error:  # from the expression itself, or because a value is unknown
            problem = error
    again = case.run.again(case.tick, case.element)
    return problem if again is None else again


def delay_of(case: Case) -> float | None:
    """Return the delay of a transition in milliseconds; None if it is unknown."""
    trigger = case.noun.trigger
    assert isinstance(trigger, Delay)
    value: object
    match trigger.amount:
        case int():
            return trigger.amount
        case str():
            cell = case.machine.cells.get(str(trigger.amount))
            value = case.state.value(cell) if cell is not None else None
        case _:
            evaluation = evaluate_again(case)
            value = evaluation.value if isinstance(evaluation, Evaluation) else None
    return float(value) if isinstance(value, (int, float)) and not isinstance(value, bool) else None


def last_true(case: Case) -> tuple[int | None, int]:
    """Return the last tick before in which a condition was true, tested or not, and the first examined."""
    expression = expression_of(case.tested[0].text) if case.tested is not None else None
    if case.tested is None or expression is None:
        return None, case.tick
    machine = case.tested[1].path
    cells = _cells(case.state, machine)
    moves = case.run.loop.interpreter.moves

    def machine_at(tick: int) -> Path:
        return Names(moves, tick).of("machine", machine, case.tick) if machine else machine

    end, first = perf_counter() + _SEARCH, case.tick
    for tick, then, value_of in case.run.history.scopes_before(case.tick, machine_at):
        if perf_counter() > end:
            break
        alive = set(map(id, then.values()))  # under whatever names they had
        seen = {**then, **{name: cell for name, cell in cells.items() if id(cell) in alive}}
        try:
            value = evaluate(expression, _lookup(case.run, tick, seen, value_of)).value
        except UnknownValueError:
            break
        except Exception:  # from the expression itself
            value = False
        first = tick
        if is_boolean(value) and value:
            return tick, tick
    else:
        first = case.run.history.ticks.start
    return None, first


def _lookup(
    run: RecordedRun,
    tick: int,
    cells: Mapping[str, CellType],
    value_of: Callable[[CellType], object],
    written: frozenset[int] = frozenset(),
) -> Callable[[str], Any]:
    record, nodes = run.loop.record, run.loop.bridge.nodes.table
    changes = [change for completed, change in run.changes if completed >= tick]
    readings = record.readings_of(record.moment(tick).sensed)

    def lookup(name: str) -> Any:
        if name == "robot":
            return RecordedRobot(readings, nodes)
        if name in cells:
            if id(cells[name]) in written:
                raise UnknownValueError(f"`{name}` was also assigned in this tick.")
            value = value_of(cells[name])
            if value is UNSET:
                raise NameError(f"`{name}` had no value.")
            if not _is_immutable(value):
                raise UnknownValueError(f"`{name}` may have been changed in place.")
            return value
        if (value := record.names.value_before(name, changes)) is not ABSENT:
            if not (_is_immutable(value) or isinstance(value, _UNCHANGING)):
                raise UnknownValueError(f"`{name}` may have been changed since.")
            return value
        try:
            return builtin(name)
        except AttributeError:
            raise NameError(f"`{name}` is not defined.") from None

    return lookup


def _cells(state: PastState, machine: Path) -> Mapping[str, CellType]:
    """Return the variables in the scope of a machine that ran, or of the top level."""
    found = next((each for each in state.walk() if each.state[:-1] == machine), None)
    return state.cells if found is None else found.cells


def _is_immutable(value: object) -> bool:
    if isinstance(value, tuple):
        return all(map(_is_immutable, value))
    return isinstance(value, PLAIN)
