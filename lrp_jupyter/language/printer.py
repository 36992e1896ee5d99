"""Printer: from program to text, so that ``parse(to_source(p)) == p``.

The layout is canonical, whatever the original text: variables, events, states, transitions, each in their
order. Comments outside blocks are not part of a program and are not printed; to change a text and keep
them, edit the text (see :mod:`~lrp_jupyter.language.edits.rename`).
"""

from __future__ import annotations

from collections.abc import Iterable

from lrp_jupyter.arguments import A_PROGRAM, check_type
from lrp_jupyter.language.blocks.block_margins import STEP, aligned
from lrp_jupyter.language.program import (
    Action,
    Block,
    Event,
    Machine,
    Program,
    Spawn,
    State,
    Transition,
    Variable,
)
from lrp_jupyter.language.python.scanner import block_end
from lrp_jupyter.language.triggers import Trigger

_WIDTH = 90
_STEP = " " * STEP


def to_source(program: Program) -> str:
    """Return a program as text, in a canonical and readable layout.

    Examples
    --------
    >>> from lrp_jupyter import parse
    >>> print(to_source(parse("(machine m (state a)(state b)(ontime 300 a->b))(spawn m a)")))
    (machine m
      (state a)
      (state b)
      (ontime 300 a -> b))
    <BLANKLINE>
    (spawn m a)
    <BLANKLINE>
    """
    check_type("program", program, Program, A_PROGRAM)
    sections = [
        [_variable(variable, "") for variable in program.variables],
        [_event(event, "") for event in program.events],
        *[[_machine(machine, "")] for machine in program.machines],
        [text for kind, blocks in program.hooks.items() for text in _actions(kind, blocks, "")],
        [_spawn("", spawn) for spawn in program.spawns],
    ]
    return "\n\n".join("\n".join(section) for section in sections if section) + "\n"


def _variable(variable: Variable, indent: str) -> str:
    return _with_block(f"{indent}(var {variable.name} := ", variable.initial, ")")


def _event(event: Event, indent: str) -> str:
    return _with_block(f"{indent}(event {event.name} ", event.condition, ")")


def _machine(machine: Machine, indent: str) -> str:
    inner = indent + _STEP
    parts = [
        *(_variable(variable, inner) for variable in machine.variables),
        *(_event(event, inner) for event in machine.events),
        *(_state(state, inner) for state in machine.states),
        *(_transition(transition, inner) for transition in machine.transitions),
    ]
    return _closed(f"{indent}(machine {machine.name}", parts)


def _state(state: State, indent: str) -> str:
    inner = indent + _STEP
    parts = [
        *(line for keyword, items in state.actions.items() for line in _actions(keyword, items, inner)),
        *(_machine(machine, inner) for machine in state.machines),
    ]
    return _closed(f"{indent}(state {state.name}", parts)


def _transition(transition: Transition, indent: str) -> str:
    head = f"{indent}({transition.kind} "
    name = f" {transition.name}" if transition.name else ""
    text = _with_trigger(head, transition.trigger, " ")
    if transition.hold is not None:
        text = _with_trigger(f"{text}for ", transition.hold, " ")
    text = f"{text}{transition.source_text} -> {transition.destination}{name}"
    for effect in _actions("effect", transition.effect, indent + _STEP):
        text = (
            f"{text}\n{effect}"
            if "\n" in effect or len(text) + len(effect) > _WIDTH
            else f"{text} {effect.lstrip()}"
        )
    return f"{text})"


def _with_trigger(head: str, trigger: Trigger, tail: str) -> str:
    if trigger.block is not None:
        return _with_block(head, trigger.block[1], tail)
    return f"{head}{trigger.text}{tail}" if trigger.text else head


def _actions(keyword: str, actions: Iterable[Action], indent: str) -> list[str]:
    """Return an action form, with several items per line where they fit; nothing if there is none."""
    text = f"{indent}({keyword}"
    found = False
    for action in actions:
        beside = _action(f"{text} ", action)
        added = beside[len(text) :]
        if found and ("\n" in added or len(beside) - beside.rfind("\n") > _WIDTH):
            beside = _action(f"{text}\n{indent}{_STEP}", action)
        text, found = beside, True
    return [f"{text})"] if found else []


def _action(head: str, action: Action) -> str:
    if isinstance(action, Block):
        return _with_block(head, action, "")
    return _spawn(head, action)


def _spawn(head: str, spawn: Spawn) -> str:
    text = f"{head}(spawn {spawn.machine} {spawn.state}"
    for setting in spawn.settings:
        text = _with_block(f"{text} (var {setting.name} := ", setting.initial, ")")
    return f"{text})"


def _closed(head: str, parts: list[str]) -> str:
    return "\n".join([head, *parts]) + ")"


def _with_block(head: str, block: Block, tail: str) -> str:
    """Return a block after `head`, its lines aligned with its first one."""
    line = head[head.rfind("\n") + 1 :]
    base = len(line) - len(line.lstrip())
    whole = f"[{aligned(block.text, len(line) + 1, base)}]"
    if block_end(whole, 0) != len(whole) - 1:  # a comment would swallow the bracket
        whole = f"{whole[:-1]}\n{' ' * len(line)}]"
    return f"{head}{whole}{tail}"
