"""A bridge's panel as plain data: the lab draws it, the command line answers it.

A bridge opens no window. It says what there is to see (fields, tables), to press (buttons) and to
answer (questions, such as the address of the robot); what a person does comes back to
:meth:`Bridge.answer` and :meth:`Bridge.press`, between two ticks.

Paper: §7.1 (figures 4 and 5), §7.2 (the dialog for the address, the runstop), §7.3.
Deviation: §7.3 lets the bridge open its windows itself; here it describes them, so that the same
bridge serves a notebook, a terminal and a test.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any, Literal

__all__ = ["Button", "Field", "Panel", "Question", "Table"]

Scalar = bool | int | float | str | None


@dataclass(frozen=True, slots=True)
class Field:
    """A labelled value; `member` names the robot's member whose live value is shown instead."""

    label: str
    value: Scalar = None
    member: str = ""
    unit: str = ""


@dataclass(frozen=True, slots=True)
class Button:
    """Something to press: comes back as ``bridge.press(action, *arguments)``.

    The action ``"stop"`` is the runstop: it is ``stop_all`` and works while the program hangs.
    """

    action: str
    label: str
    arguments: tuple[Scalar, ...] = ()
    danger: bool = False


@dataclass(frozen=True, slots=True)
class Question:
    """Something to answer: comes back as ``bridge.answer(key, value)``.

    On the command line the key is the option: ``--host`` answers the question ``host``.
    """

    key: str
    label: str
    value: Scalar = None
    kind: Literal["text", "number", "choice", "yes/no"] = "text"
    choices: tuple[str, ...] = ()
    required: bool = True


@dataclass(frozen=True, slots=True)
class Table:
    """Rows of plain values below columns; `buttons` holds those of each row, if there are any."""

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Scalar, ...], ...] = ()
    buttons: tuple[tuple[Button, ...], ...] = ()


@dataclass(frozen=True, slots=True)
class Panel:
    """Everything that a bridge shows and asks."""

    title: str
    fields: tuple[Field, ...] = ()
    tables: tuple[Table, ...] = ()
    buttons: tuple[Button, ...] = ()
    questions: tuple[Question, ...] = ()

    def as_dict(self) -> dict[str, Any]:
        """Everything as JSON."""
        return dataclasses.asdict(self)
