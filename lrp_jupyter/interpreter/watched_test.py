"""Watch the test of a transition: evaluate it part by part, once, in the tick in which it is tested."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

from lrp_jupyter.errors import NotAValue
from lrp_jupyter.interpreter.cells import content
from lrp_jupyter.interpreter.rendering import is_scalar, scalar_of, short
from lrp_jupyter.interpreter.run import Run
from lrp_jupyter.interpreter.trace_events import UNSET
from lrp_jupyter.interpreter.tree import Context, Edge, held, provided
from lrp_jupyter.language.blocks.builtin_names import builtin
from lrp_jupyter.language.blocks.expressions import Evaluation, evaluate, expression_of
from lrp_jupyter.language.resolution import resolve


class Shown(str):
    """The text of a value that may change later."""

    __slots__ = ()


def items(evaluation: Evaluation) -> list[tuple[str, object]]:
    """Return the parts with their values, except for parts of a robot, and for what only leads to a value."""
    values = evaluation.values
    return [
        (text, scalar_of(value))
        for text, value in values.items()
        if not (isinstance(value, NotAValue) or _leads(text, value, values))
    ]


def _leads(text: str, value: object, values: Iterable[str]) -> bool:
    """Return whether a value says nothing, as a message does of which a field is compared."""
    return not is_scalar(scalar_of(value)) and any(other.startswith(f"{text}.") for other in values)


def _shown(value: object) -> object:
    """Return a value if it is immutable, otherwise its text."""
    value = scalar_of(value)
    return value if is_scalar(value) else Shown(short(value))


def watch(run: Run, edge: Edge, seen: Callable[[Evaluation | Exception], object]) -> None:
    """Replace the test of a bound transition by one that shows its parts; for a delay, only show them."""
    arrow = resolve(run.program).arrow(edge.plan.site.element)
    if arrow is None or arrow.tested is None:
        return
    block, scope = arrow.tested
    expression = expression_of(block.text)
    if expression is None:
        return
    home = edge.act.around(scope.path)
    at, visible, test = Context(home, home.visible, edge.act), home.visible, edge.test
    is_delay = arrow.noun.trigger.keyword == "ontime"

    def lookup(name: str) -> Any:
        if name in visible:
            value = content(visible[name].cell)
            if value is UNSET:
                raise NameError(f"`{name}` had no value.")
            return value
        if name in run.namespace:
            return run.namespace[name]
        found = provided(run, name, at)
        return builtin(name) if found is None else found()

    def watched() -> object:
        edge.test = test  # its state may be entered again in the same tick
        try:
            evaluation = evaluate(expression, lookup, calls=True)
        except Exception as error:
            seen(error)
            return test()
        values = {text: _shown(value) for text, value in items(evaluation)}
        seen(replace(evaluation, values=values, decided=_shown(evaluation.decided)))
        hold, value = arrow.noun.hold, evaluation.value
        if is_delay:
            return test()
        return value if hold is None else held(run, edge.act, edge.plan, hold, lambda: value)()

    edge.test = watched
