"""A bridge's panel as plain data: the lab draws it, the command line answers it.

A bridge opens no window. Its panel lists what is shown and filled in (fields, tables), what is pressed
(buttons) and what is answered before it can connect (questions, such as the address of the robot). What
a person does is passed to :meth:`Bridge.press` and :meth:`Bridge.answer`, between two ticks.

Paper: §7.1 (figures 4 and 5), §7.2 (the dialog for the address, the runstop), §7.3.
Deviation: in §7.3 the bridge opens its windows itself; here it describes them, so that the same
bridge serves a notebook, a terminal and a test.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any, Literal

from lrp_jupyter.errors import BridgeError


@dataclass(frozen=True, slots=True)
class Field:
    """A value that is shown (kind ``"value"``) or an input; the inputs are sent with each button.

    A text may have `choices` as well: they are offered. Choosing one of them presses the button `press`,
    with the choice as its row.
    """

    key: str
    label: str
    kind: Literal["text", "number", "choice", "switch", "value"] = "value"
    value: str = ""
    choices: tuple[str, ...] = ()
    unit: str = ""
    press: str = ""


@dataclass(frozen=True, slots=True)
class Button:
    """A button; pressing it calls ``bridge.press(key, row, values)``."""

    key: str
    label: str


STOP = Button("stop", "Stop robot")
"""The runstop: every bridge knows it, and it works while the program hangs."""


@dataclass(frozen=True, slots=True)
class Table:
    """A table of texts; `keys` name the rows, each row has all the `buttons`."""

    key: str
    title: str
    columns: tuple[str, ...]
    keys: tuple[str, ...] = ()
    rows: tuple[tuple[str, ...], ...] = ()
    buttons: tuple[Button, ...] = ()

    def __post_init__(self) -> None:
        if len(self.keys) != len(self.rows) or any(len(row) != len(self.columns) for row in self.rows):
            raise ValueError(
                f"The table {self.key!r} needs a key for each row, and a text for each column of it."
            )


@dataclass(frozen=True, slots=True)
class Question:
    """A question of the bridge; the answer calls ``bridge.answer(key, value)``.

    On the command line the key is the option: ``--host`` answers the question ``host``. In the lab the
    answer is sent with a button.
    """

    key: str
    text: str
    default: str = ""
    button: str = "Connect"


@dataclass(frozen=True, slots=True)
class Panel:
    """All that a bridge shows and asks."""

    title: str
    fields: tuple[Field, ...] = ()
    tables: tuple[Table, ...] = ()
    buttons: tuple[Button, ...] = (STOP,)
    questions: tuple[Question, ...] = ()

    def as_dict(self) -> dict[str, Any]:
        """Return a JSON form."""
        return dataclasses.asdict(self)


def number_in(text: str, label: str) -> float:
    """Return the number that a person wrote, with a point or a comma, into the field of a label."""
    try:
        return float(text.replace(",", "."))
    except ValueError:
        raise BridgeError(f"`{label}` must be a number, not {text!r}.") from None
