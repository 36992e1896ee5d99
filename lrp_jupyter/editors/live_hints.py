"""What a run shows at the ends of lines: the values of variables and events, and what is active."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from lsprotocol import types as lsp

from lrp_jupyter.editors.live_news import LiveNews
from lrp_jupyter.editors.program_text import ProgramText
from lrp_jupyter.language.program import Event, Machine, Path, Program, Variable, path_text

_LONGEST, _DIGITS = 60, 4
_NUMBER = re.compile(r"'(?:\\.|[^'\\])*'|\"(?:\\.|[^\"\\])*\"|(?<![\w.])\d+\.\d+(?:e[+-]?\d+)?(?![\w.])")


def hints(text: ProgramText, news: LiveNews | None) -> list[lsp.InlayHint]:
    """Return what a run shows in a text, at the end of each line that defines something."""
    if news is None:
        return []
    lines: dict[int, tuple[lsp.Position, list[str]]] = {}
    for offset, name, shown in _shown(text.sketched, news):
        place = text.at.line_end(offset)
        lines.setdefault(place.line, (place, []))[1].append(f"{name}{shown}")
    return [_hint(place, told) for place, told in lines.values()]


def _hint(place: lsp.Position, told: list[str]) -> lsp.InlayHint:
    label = ", ".join(told) if len(told) > 1 else told[0].partition(" ")[2]
    return lsp.InlayHint(place, label, padding_left=True)


def _shown(program: Program, news: LiveNews) -> Iterator[tuple[int, str, str]]:
    """Yield where something is shown, the name that it belongs to, and what it is."""
    owners: list[tuple[Path, Program | Machine]] = [((), program), *program.walk()]
    known = {**news["events"], **news["variables"]}
    for path, owner in owners:
        nouns: tuple[Variable | Event, ...] = (*owner.variables, *owner.events)
        for noun in nouns:
            yield from _values(noun.span.end, str(noun.name), known.get(_in(path, noun.name), {}))
        for state in owner.states if isinstance(owner, Machine) else ():
            places = differences([*news["states"].get(_in(path, state.name), ())])
            if places:
                where = f" ({', '.join(places)})" if len(places) > 1 else ""
                how = "" if news["status"] == "running" else f", {news['status']}"
                yield state.name.span.end, str(state.name), f" ● active{how}{where}"


def _values(offset: int, name: str, values: dict[str, str]) -> Iterator[tuple[int, str, str]]:
    texts = [_short(text) for text in values.values()]
    if len(texts) > 1:
        texts = [f"{place}: {text}" for place, text in zip(differences([*values]), texts, strict=True)]
    if texts:
        yield offset, name, f" = {', '.join(texts)}"


def _in(path: Sequence[str], name: str) -> str:
    return path_text((*path, str(name)))


def _short(text: str) -> str:
    """Return a value for reading: numbers with as many digits as a person needs, and not endless."""
    text = _NUMBER.sub(_with_few_digits, text)
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 1]}…"


def _with_few_digits(found: re.Match[str]) -> str:
    digits = re.sub(r"e.*|\D", "", found[0]).strip("0")
    return found[0] if found[0][0] in "'\"" or len(digits) <= _DIGITS else f"{float(found[0]):#.{_DIGITS}g}"


def differences(paths: Sequence[str]) -> list[str]:
    """Return what tells paths apart: each without the names with which all of them begin and end."""
    parts = [path.split("/") for path in paths]
    least = min(map(len, parts), default=0)
    before = next((at for at in range(least) if len({each[at] for each in parts}) > 1), least)
    backwards = range(1, least - before + 1)
    after = next((at for at in backwards if len({each[-at] for each in parts}) > 1), least - before + 1) - 1
    return ["/".join(each[before : len(each) - after]) or each[-1] for each in parts]
