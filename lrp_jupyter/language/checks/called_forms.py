"""502: calls in a block of what only the forms of a program do: spawn a machine, leave a state, wait."""

from __future__ import annotations

import ast
from functools import lru_cache
from typing import NamedTuple

from lrp_jupyter.language.blocks.slips.block_words import CANNOT_MOVE
from lrp_jupyter.language.checks.scanned import scanned
from lrp_jupyter.language.checks.uses import number_of
from lrp_jupyter.language.program import Span
from lrp_jupyter.language.reading.forms import USAGE
from lrp_jupyter.language.spellings import NOT_SENT, by_word

_SPAWN = "spawn"
_TIMED = "A block cannot wait. Write a transition with a delay"
_ASKED = 'The name of a machine gives its state. Write `machine.state == "name"`.'
_REMEDIES = by_word(
    {
        _SPAWN: "spawn",
        CANNOT_MOVE: "goto go_to transition transition_to change_state set_state switch_state enter_state",
        NOT_SENT: "emit raise_event send_event post_event set_event dispatch trigger fire",
        _TIMED: "after set_timeout start_timer wait delay sleep pause wait_for sleep_ms delay_ms",
        _ASKED: "in_state is_in is_in_state",
    }
)


class FormCall(NamedTuple):
    """A call of what a form does; `root` is the name on which it depends, `span` that of the function.

    `spawned`: the machine and the state that it names, if it is a spawn.
    `number`: its argument, if that is a number.
    """

    word: str
    written: str
    root: str
    span: Span
    whole: Span
    spawned: tuple[str, ...]
    is_alone: bool
    number: float | None

    def remedy(self, is_onentry: bool) -> str:
        """Return what to write instead, in sentences."""
        remedy = _REMEDIES[self.word]
        if remedy == _TIMED:
            usage = USAGE["ontime"]
            if self.number is not None and self.number > 0:
                is_short = self.number < 100 and not self.word.endswith("ms")
                usage = usage.replace("milliseconds", f"{self.number * (1000 if is_short else 1):.0f}")
            return f"{remedy}: `{usage}`."
        if remedy != _SPAWN:
            return f"`{self.written}` is not defined where this block can see it. {remedy}"
        written = f"(spawn {' '.join(self.spawned)})" if len(self.spawned) == 2 else USAGE["spawn"]
        where = "after the `]` of this block" if is_onentry else "in the `onentry` of a state"
        return f"`spawn` is a form of an `onentry`, not Python. Write `{written}` {where}."


@lru_cache(maxsize=20_000)
def form_calls(text: str) -> tuple[FormCall, ...]:
    """Return the calls in a block of what only forms do, by their names alone."""
    block = scanned(text, _REMEDIES)
    if block is None:
        return ()
    found = []
    bound = {use.name for use in block.names.found if use.writes}
    for call in block.nodes:
        if not isinstance(call, ast.Call) or not isinstance(call.func, ast.Name | ast.Attribute):
            continue
        word = call.func.id if isinstance(call.func, ast.Name) else call.func.attr
        written = ast.unparse(call.func)
        root = written.partition(".")[0]
        if word in _REMEDIES and root not in bound:
            names = [root, *map(_named, call.args)] if root != word else [*map(_named, call.args)]
            whole = block.span(call)
            is_alone = text.strip() == text[whole.start : whole.end]
            number = number_of(call.args[0]) if len(call.args) == 1 else None
            span = block.span(call.func)
            found.append(FormCall(word, written, root, span, whole, tuple(names), is_alone, number))
    return tuple(found)


def _named(argument: ast.expr) -> str:
    """Return the name that an argument is, or that it has as its text; else `…`."""
    if isinstance(argument, ast.Constant) and isinstance(argument.value, str):
        return argument.value
    return argument.id if isinstance(argument, ast.Name) else "…"
