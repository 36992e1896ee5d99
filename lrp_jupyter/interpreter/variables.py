"""The variables of a run, by path: read and assigned from outside."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

from lrp_jupyter.errors import LRPError, UnknownElementError
from lrp_jupyter.interpreter.by_path import full_path
from lrp_jupyter.interpreter.cells import Slot, content, put
from lrp_jupyter.interpreter.linker import compiled
from lrp_jupyter.interpreter.run import Run
from lrp_jupyter.interpreter.trace_events import UNSET
from lrp_jupyter.interpreter.tree import (
    Activation,
    Call,
    Environment,
    bind_code,
    is_boolean,
    not_boolean,
)
from lrp_jupyter.language.blocks.block import facts_of, faults_of
from lrp_jupyter.language.blocks.expressions import expression_of
from lrp_jupyter.language.blocks.names_in_blocks import as_path
from lrp_jupyter.language.program import Block, Element, Path, Program, path_text
from lrp_jupyter.language.python.python_parser import parse_python
from lrp_jupyter.language.resolution import PlacedBlock, resolve

EXPRESSION = "<expression>"  # the file name, in tracebacks, of an expression that is assigned


class VariableMapping(Mapping[Path, object]):
    """The existing variables and their values; keys are those of ``ByPath``.

    Variables without a value (their initialiser failed) are absent.
    """

    def __init__(self, run: Run) -> None:
        self._run = run

    def __getitem__(self, path: Path | str) -> object:
        environment, name = find_variable(self._run, path)
        value = content(environment.own[name].cell)
        if value is UNSET:
            raise UnknownElementError(f"The variable `{path_text(as_path(path))}` has no value.")
        return value

    def __iter__(self) -> Iterator[Path]:
        return (path for path, _ in self.pairs())

    def pairs(self) -> list[tuple[Path, object]]:
        """Return all paths and values at once, in one walk over the machines."""
        return [
            ((*environment.path, name), value)
            for environment in (self._run.globals, *self._run.walk())  # in the order of a tick
            for name, slot in environment.own.items()
            if (value := content(slot.cell)) is not UNSET
        ]

    def path(self, wanted: Path | str) -> Path:
        """Return the path of a variable, with a value or not, for its path or its unambiguous name.

        Raises UnknownElementError: if there is no such variable now, or several have that name.
        """
        environment, name = find_variable(self._run, wanted)
        return (*environment.path, name)

    def __len__(self) -> int:
        return len(self.pairs())

    def __repr__(self) -> str:
        return repr({path_text(path): value for path, value in self.pairs()})


def find_variable(run: Run, path: Path | str) -> tuple[Environment, str]:
    """Return the environment that holds a variable now, and the variable's name.

    Raises UnknownElementError: if there is no such variable now, or several have that name.
    """
    known = {(*home.path, own): home for home in run.live.values() for own in home.own}
    found = full_path(path, known, run.program)
    return known[found], found[-1]


def assign(run: Run, path: Path | str, value: object) -> None:
    """Assign a value to a variable.

    Raises UnknownElementError: if there is no such variable now.
    """
    environment, name = find_variable(run, path)
    slot = environment.own[name]
    run.log_cell(slot.cell)
    slot.cell.cell_contents = value
    run.assigned += 1
    slot.assigned = run.now, run.assigned


class Outdated(NamedTuple):
    """A variable was computed from another one that has since been assigned by hand.

    `source`: the other variable, by path as spawned.
    `computed`: when it was computed, in seconds.
    `initial`: its initialiser, if it is an expression; otherwise empty.
    """

    source: Path
    computed: float
    initial: str


def outdated(run: Run) -> dict[Path, Outdated]:
    """Return the variables whose source has been assigned by hand since they were computed, by path."""
    found: dict[Path, Outdated] = {}
    if not run.assigned:
        return found
    paths = {slot: (*each.path, name) for each in run.live.values() for name, slot in each.own.items()}
    for environment in run.live.values():
        machine = environment.defined
        variables = run.plan.machines[machine].variables if machine else run.plan.variables
        settings = environment.settings(run.plan) if isinstance(environment, Activation) else None
        for variable in variables:
            slot = environment.own.get(variable.name)
            if slot is None:  # the program restarts at the next tick
                continue
            setting = (settings or {}).get(variable.name)
            home = environment if setting is None else environment.parent or run.globals
            source = setting or variable
            for name in source.initial.reads:
                read = home.visible.get(name)
                if read in paths and max(slot.computed, slot.assigned) < read.assigned:
                    text = source.noun.initial.text.strip()
                    initial = text if expression_of(text) is not None else ""
                    found[paths[slot]] = Outdated(paths[read], slot.computed[0], initial)
    return found


def evaluate(run: Run, path: Path | str, expression: str) -> object:
    """Return the value of a Python expression, evaluated in a variable's scope.

    Raises UnknownElementError: if there is no such variable now.
    Raises Exception: the expression raised it.
    """
    environment, block = find_variable(run, path)[0], Block(check_expression(expression))
    return _bound(run, block, Element("machine", environment.defined), environment, EXPRESSION)()


def _bound(run: Run, block: Block, element: Element, environment: Environment, filename: str) -> Call:
    """Bind an expression, or the block of an event, in the scope of a machine, or of the top level.

    `element`: the event, or the machine.
    Raises SyntaxError: a variable that it declares `nonlocal` is missing.
    """
    names = resolve(run.program)
    scope = names.by_path[environment.defined]
    place = PlacedBlock(element, 0, block, "condition", scope, scope.visible)
    return bind_code(run, compiled(place, names, filename, "expression"), environment)


class BlockTest:
    """A block that is tested repeatedly in the scope of a machine: an expression, or the block of an event.

    It is compiled and bound again when the program or the variables of that scope change. What it assigns is
    undone: looking at a run does not change it.

    `element`: the event, or the machine in whose scope it is; that of the top level has no path.
    `inside`: the states around its instance that is meant, by path of definition; None for any instance.
    `filename`: the file name in tracebacks.
    """

    def __init__(
        self,
        block: Block,
        element: Element = Element("machine", ()),  # noqa: B008  (a frozen value)
        inside: tuple[Path, ...] | None = None,
        filename: str = EXPRESSION,
    ) -> None:
        self._block = block
        self._element = element
        self._machine = element.path if element.kind == "machine" else element.path[:-1]
        self._inside = inside
        self._filename = filename
        self._bound: dict[Path, tuple[Program, dict[str, Slot], Call]] = {}

    def results(self, run: Run) -> dict[Path, bool | BaseException]:
        """Return whether it is True now, or why that is unknown, in each instance that runs and is meant."""
        found = [each for each in run.live.values() if each.defined == self._machine] if run.started else []
        if self._inside is not None:
            around = resolve(run.program).around
            found = [each for each in found if around(each.path) == self._inside]
        return {each.path: self._result(run, each) for each in found}

    def _result(self, run: Run, environment: Environment) -> bool | BaseException:
        before = [(slot.cell, content(slot.cell)) for slot in environment.visible.values()]
        try:
            return self._is_true(self._test(run, environment))
        except KeyboardInterrupt:
            raise
        except BaseException as error:
            return error
        finally:
            for cell, value in before:
                if content(cell) is not value:
                    put(cell, value)

    def _test(self, run: Run, environment: Environment) -> Call:
        bound = self._bound.get(environment.path)
        if bound is None or bound[0] is not run.program or bound[1] is not environment.visible:
            call = _bound(run, self._block, self._element, environment, self._filename)
            self._bound[environment.path] = bound = run.program, environment.visible, call
        return bound[2]

    def _is_true(self, test: Call) -> bool:
        value = test()
        if not is_boolean(value):
            raise LRPError(not_boolean(value))
        return bool(value)


def check_expression(expression: str) -> str:
    """Return an expression without surrounding whitespace.

    Raises SyntaxError: it is not a Python expression.
    """
    text = expression.strip()
    if not facts_of(text).valid:
        raise SyntaxError(faults_of(text)[0].message)
    try:
        parse_python(text, EXPRESSION, "eval")
    except SyntaxError:
        what = f"`{text}` is not an expression" if text else "The expression is empty"
        raise SyntaxError(f"{what}. Write a value, such as `2 * 3`.") from None
    return text
