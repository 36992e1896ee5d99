"""Evaluate the test of a transition again, with the recorded values."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from time import perf_counter
from types import BuiltinFunctionType, CellType, FunctionType, ModuleType
from typing import Any

from lrp_jupyter.interpreter.history import PastMachine
from lrp_jupyter.interpreter.trace_events import UNSET
from lrp_jupyter.interpreter.tree import is_boolean
from lrp_jupyter.language.blocks.builtin_names import builtin
from lrp_jupyter.language.blocks.expressions import Evaluation, UnknownValueError, evaluate, expression_of
from lrp_jupyter.language.program import Path
from lrp_jupyter.language.resolution import resolve
from lrp_jupyter.language.triggers import Delay
from lrp_jupyter.live.running.checkpoints import PLAIN
from lrp_jupyter.live.running.notebook_names import ABSENT
from lrp_jupyter.live.why.case import Case
from lrp_jupyter.live.why.recorded_robot import RecordedRobot
from lrp_jupyter.live.why.recorded_run import RecordedRun

Lookup = Callable[[str], Any]
_SEARCH = 0.03  # wall seconds to search for the last time a condition was true
_UNCHANGING = (FunctionType, BuiltinFunctionType, ModuleType, type)


def evaluate_again(case: Case) -> Evaluation | Exception | None:
    """Return a test with its parts: from recorded values, or else by running the tick again.

    An exception says why they are unknown; None means that there is no expression.
    """
    if case.tested is None:
        return None
    block, _ = case.tested
    expression = expression_of(block.text)
    problem: Exception | None = None
    if expression is not None:
        written = case.run.history.written(case.tick)
        try:
            return evaluate(expression, _in_scope(case, case.home, written))
        except Exception as error:  # from the expression itself, or because a value is unknown
            problem = error
    again = case.run.again(case.tick, case.element, case.machine.path)
    return problem if again is None else again


def delay_of(case: Case, delay: Delay) -> float | None:
    """Return a delay of a transition in milliseconds; None if it is unknown."""
    value: object
    match delay.amount:
        case int():
            return delay.amount
        case str():
            cell = case.machine.cells.get(str(delay.amount))
            value = case.state.value(cell) if cell is not None else None
        case _ if delay is case.noun.trigger:
            evaluation = evaluate_again(case)
            value = evaluation.value if isinstance(evaluation, Evaluation) else None
        case _:
            try:
                expression = expression_of(delay.amount.text)
                value = expression and evaluate(expression, _in_scope(case, case.machine)).value
            except Exception:  # from the expression itself, or because a value is unknown
                value = None
    return float(value) if isinstance(value, (int, float)) and not isinstance(value, bool) else None


def last_true(case: Case) -> tuple[int | None, int]:
    """Return the last tick before in which a condition was true, tested or not, and the first examined."""
    expression = expression_of(case.tested[0].text) if case.tested is not None else None
    if case.tested is None or expression is None:
        return None, case.tick
    home = case.home
    cells = case.state.cells if home is None else home.cells

    def is_home(tick: int, path: Path) -> bool:
        return not path if home is None else bool(path) and case.run.is_same(home.path, case.tick, path, tick)

    def not_now(name: str) -> Any:
        _computed(case, home, frozenset(), name)
        raise UnknownValueError(f"`{name}` is known for this tick only.")

    end, first = perf_counter() + _SEARCH, case.tick
    for tick, then, value_of in case.run.history.scopes_before(case.tick, is_home):
        if perf_counter() > end:
            break
        alive = set(map(id, then.values()))  # under whatever names they had
        seen = {**then, **{name: cell for name, cell in cells.items() if id(cell) in alive}}
        try:
            value = evaluate(expression, _lookup(case.run, tick, seen, value_of, computed=not_now)).value
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


def watched_machine(case: Case) -> PastMachine | None:
    """Return the machine for whose state a transition waited; None if it was not running."""
    arrow = resolve(case.program).arrow(case.element)
    machine = arrow and arrow.watched.get(case.machine.state[-1])
    return next((each for each in case.machine.inside if machine and each.state[:-1] == machine.path), None)


def _in_scope(case: Case, home: PastMachine | None, written: frozenset[int] = frozenset()) -> Lookup:
    """Return the look-up of names in the scope of a machine, or of the top level, when the tick began."""
    cells = case.state.cells if home is None else home.cells
    computed = partial(_computed, case, home, written)
    return _lookup(case.run, case.tick, cells, case.state.value, written, computed)


def _computed(case: Case, home: PastMachine | None, written: frozenset[int], name: str) -> Any:
    """Return the value of an event, a machine or a time; raise KeyError for any other name."""
    names = resolve(case.program)
    scope = names.top if home is None else names.by_path[home.state[:-1]]
    owner, machines = scope.owner("event", name), scope.machines_called(name)
    if owner is not None:
        expression = expression_of(owner.events[name].condition.text)
        if expression is None:
            raise UnknownValueError(f"The event `{name}` is not a single expression.")
        around = None if owner.noun is None else case.around(owner.path)
        return evaluate(expression, _in_scope(case, around, written)).value
    if machines:
        return _EarlierMachine(case, name, _nearest(case, home, [each.path for each in machines]), written)
    if name == "elapsed":
        return round(case.time - case.machine.entered, 9)
    if name == "dt":
        return round(case.time - case.run.time(case.tick - 1), 9) if case.tick > 1 else 0.0
    raise KeyError(name)


def _nearest(case: Case, home: PastMachine | None, machines: Sequence[Path]) -> PastMachine | None:
    """Return the instance of one of some machines that a block in the scope of `home` meant."""
    found = [each for each in case.state.walk() if each.state[:-1] in machines]
    path = () if home is None else home.path
    for end in range(len(path), -1, -2):
        around = path[: max(end, 0)]
        inside = [each for each in found if each.path[:-2] == around]
        if inside:
            return inside[0]
    return next((each for each in found if len(each.path) == 1), None)


class _EarlierMachine:
    """A machine as a block of another one saw it when a tick began."""

    def __init__(self, case: Case, name: str, machine: PastMachine | None, written: frozenset[int]) -> None:
        self._case, self._name, self._machine, self._written = case, name, machine, written

    @property
    def state(self) -> str | None:
        """The name of its active state; None if it was not running."""
        return None if self._machine is None else self._machine.state[-1]

    def __getattr__(self, name: str) -> Any:
        machine, case = self._machine, self._case
        if machine is None or name not in machine.own:
            raise AttributeError(f"`{self._name}.{name}` had no value.")
        return _in_scope(case, machine, self._written)(name)


def _lookup(
    run: RecordedRun,
    tick: int,
    cells: Mapping[str, CellType],
    value_of: Callable[[CellType], object],
    written: frozenset[int] = frozenset(),
    computed: Lookup | None = None,
) -> Lookup:
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
        with suppress(KeyError):
            if computed is not None:
                return computed(name)
        try:
            return builtin(name)
        except AttributeError:
            raise NameError(f"`{name}` is not defined.") from None

    return lookup


def _is_immutable(value: object) -> bool:
    if isinstance(value, tuple):
        return all(map(_is_immutable, value))
    return isinstance(value, PLAIN)
