"""The forms of the language for those who write them: what completion inserts, and what each means."""

from __future__ import annotations

import json
from functools import cache
from importlib.resources import files
from typing import NamedTuple


class FormText(NamedTuple):
    """The texts about one form, as `forms.json` has them in this order: the lab's page reads it, too.

    `template`: what is written after the bracket; ``#{name}`` is to be filled in.
    `detail`: its purpose in a few words.
    `inside`: the forms that it may stand in, by their names in the page's grammar.
    `usage`: an example of it.
    `doc`: its meaning.
    """

    template: str
    detail: str
    inside: str
    usage: str
    doc: str


@cache
def form_texts() -> dict[str, FormText]:
    """Return the texts by keyword."""
    found = json.loads(files(__package__).joinpath("forms.json").read_text(encoding="utf-8"))
    return {keyword: FormText(*texts) for keyword, texts in found.items()}
