"""Watch the test of a transition: evaluate it part by part, once, in the tick in which it is tested."""

from __future__ import annotations

import builtins
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from lrp_jupyter.errors import NotAValue
from lrp_jupyter.interpreter.cells import content
from lrp_jupyter.interpreter.events import UNSET
from lrp_jupyter.interpreter.rendering import is_scalar, short
from lrp_jupyter.interpreter.run import Run
from lrp_jupyter.interpreter.tree import Edge
from lrp_jupyter.language.expressions import Evaluation, evaluate, expression_of
from lrp_jupyter.language.resolution import resolve

__all__ = ["Shown", "items", "watch"]


class Shown(str):
    """The text of a value that may change later."""

    __slots__ = ()


def items(evaluation: Evaluation) -> list[tuple[str, object]]:
    """Return the parts with their values, without those that are parts of a robot."""
    return [(text, value) for text, value in evaluation.values.items() if not isinstance(value, NotAValue)]


def watch(run: Run, edge: Edge, seen: Callable[[Evaluation | Exception], object]) -> None:
    """Replace the test of a bound transition by one that shows its parts; of a delay, only show them."""
    scope = resolve(run.program).by_path[edge.plan.site.element.path[:-1]]
    arrow = next(
        each for each in resolve(run.program).arrows[scope] if each.element == edge.plan.site.element
    )
    trigger, owner = arrow.noun.trigger, scope
    block = trigger.block[1] if trigger.block is not None else None
    if block is None and trigger.reference is not None and arrow.owner is not None:
        owner = arrow.owner
        event = owner.events.get(trigger.reference[1])
        block = event.condition if event is not None else None
    expression = expression_of(block.text) if block is not None else None
    if expression is None or owner.path not in run.live:
        return
    visible, test = run.live[owner.path].visible, edge.test
    is_delay = trigger.keyword == "ontime"

    def lookup(name: str) -> Any:
        if name in visible:
            value = content(visible[name].cell)
            if value is UNSET:
                raise NameError(f"`{name}` had no value.")
            return value
        return run.namespace[name] if name in run.namespace else getattr(builtins, name)

    def watched() -> object:
        try:
            evaluation = evaluate(expression, lookup, calls=True)
        except Exception as error:
            seen(error)
            return test()
        values = {
            text: value if is_scalar(value) else Shown(short(value)) for text, value in items(evaluation)
        }
        seen(replace(evaluation, values=values))
        return test() if is_delay else evaluation.value

    edge.test = watched
