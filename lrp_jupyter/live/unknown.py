"""Errors about names that a program does not have, or has for something else."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from lrp_jupyter.errors import UnknownElementError
from lrp_jupyter.language.forms import article
from lrp_jupyter.language.names import as_path
from lrp_jupyter.language.program import Path, Program, path_text
from lrp_jupyter.language.resolution import resolve

_KINDS = ("transition", "state", "event", "variable", "machine")
_MOST = 8  # names that are listed


def unknown(
    noun: str,
    kinds: Iterable[str],
    wanted: str | Path,
    programs: Iterable[Program],
    remedies: Mapping[str, str] | None = None,
    others: Iterable[str] = (),
) -> UnknownElementError:
    """Return the error that there is no such element: what the name is instead, or which names there are.

    `noun`: what is wanted, in words: ``state``, ``transition, state or command``.
    `kinds`: the kinds of elements that this can be.
    `remedies`: what to do if the name is that of another kind of element, as a sentence.
    `others`: names, not of elements, that can be meant as well.
    """
    path = as_path(wanted)
    text = path_text(path)
    elements = [each for program in programs for each in resolve(program).elements() if each.path]
    known = list(dict.fromkeys(each.shown[-1] for kind in kinds for each in elements if each.kind == kind))
    for kind in _KINDS:
        if any(each.kind == kind and path in (each.path, each.path[-1:], each.shown) for each in elements):
            remedy = (remedies or {}).get(kind) or _listed(noun, known)
            return UnknownElementError(
                f"`{text}` is {article(kind)} {kind}, not {article(noun)} {noun}. {remedy}"
            )
    message = f"There is no {noun} `{text}`."
    return UnknownElementError.missing(message, text, [*known, *others], _listed(noun, known))


def _listed(noun: str, known: list[str]) -> str:
    """Say which names there are."""
    if not known:
        return f"The program has no {noun}."
    if len(known) == 1:
        return f"There is only `{known[0]}`."
    more = ", …" if len(known) > _MOST else ""
    return f"There are: {', '.join(f'`{name}`' for name in known[:_MOST])}{more}."
