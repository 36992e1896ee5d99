"""Typical mistakes outside blocks."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from itertools import pairwise

from lrp_jupyter.language.reading.tokens import LEGAL, Token

from .planting import Slip, kind, slip
from .sources import Form, Source

ACTIONS = ("onentry", "running", "onexit", "onpause", "onresume", "onend")
TRANSITIONS = ("on", "ontime", "eps", "exit")
DEFINITIONS = ("var", "event", "machine", "state")


# Signs


def _signs(name: str, token: str, wrong: str) -> None:
    @kind(name)
    def _(source: Source) -> Iterator[Slip]:
        for form in source.forms:
            for _, start, end in form.of(token):
                yield slip(start, end, wrong)


_signs("assign: `=`", "ASSIGN", "=")
_signs("assign: `==`", "ASSIGN", "==")
_signs("assign: `:`", "ASSIGN", ":")
_signs("assign: `=:`", "ASSIGN", "=:")
_signs("assign: nothing", "ASSIGN", " ")
_signs("arrow: `>`", "ARROW", ">")
_signs("arrow: `=>`", "ARROW", "=>")
_signs("arrow: `-`", "ARROW", "-")
_signs("arrow: `→`", "ARROW", "→")
_signs("arrow: `-->`", "ARROW", "-->")
_signs("arrow: `to`", "ARROW", " to ")
_signs("arrow: nothing", "ARROW", " ")
_signs("arrow: `- >`", "ARROW", "- >")


# Keywords


def _keyword(form: Form, source: Source) -> tuple[int, int]:
    end = form.tokens[0][2]
    return end - len(form.keyword), end


def _keywords(name: str, change: Callable[[str], list[str]], *only: str) -> None:
    @kind(name)
    def _(source: Source) -> Iterator[Slip]:
        for form in source.all(*only) if only else source.forms:
            for wrong in change(form.keyword):
                if wrong != form.keyword and wrong not in LEGAL:
                    yield slip(*_keyword(form, source), wrong)


_keywords("keyword: capitals", lambda word: [word.upper(), word.capitalize()])
_keywords(
    "keyword: camel case", lambda word: [word[:2] + word[2:].capitalize()], "onentry", "onexit", "ontime"
)
_keywords(
    "keyword: a letter missing",
    lambda word: [word[:at] + word[at + 1 :] for at in range(1, len(word))],
    *DEFINITIONS, *ACTIONS, "spawn", "ontime", "exit",
)  # fmt: skip
_keywords(
    "keyword: a letter twice", lambda word: [word[:at] + word[at - 1 :] for at in range(1, len(word) + 1)]
)
_keywords(
    "keyword: letters swapped",
    lambda word: [word[:at] + word[at + 1] + word[at] + word[at + 2 :] for at in range(len(word) - 1)],
    *DEFINITIONS, *ACTIONS, "spawn", "ontime", "exit",
)  # fmt: skip
_keywords("keyword: plural", lambda word: [word + "s"], *DEFINITIONS)
OTHERS = {
    "ontime": ["after", "timeout", "wait", "onTimeout", "delay"],
    "onentry": ["entry", "enter", "onenter", "start"],
    "onexit": ["leave", "onleave"],
    "running": ["run", "do", "loop", "while", "run-always"],
    "var": ["let", "variable", "def", "const", "set"],
    "machine": ["statemachine", "fsm", "automaton"],
    "event": ["condition", "trigger", "when"],
    "on": ["transition", "when", "if"],
    "spawn": ["start", "run", "launch"],
    "eps": ["epsilon", "always", "goto"],
    "state": ["node", "mode"],
}
_keywords("keyword: of another language", lambda word: OTHERS.get(word, []))


@kind("keyword: missing")
def _(source: Source) -> Iterator[Slip]:
    for form in source.all("state", "machine", "event", "var", "spawn"):
        start, end = _keyword(form, source)
        yield slip(start, end, "")


@kind("module: `import` or `export`")
def _(source: Source) -> Iterator[Slip]:
    for form in source.forms:
        if form.around == "program":
            for text in (
                "(import follower)\n",
                "(import follower from tools)\n",
                "(export speed)\n",
                "import robot\n",
            ):
                yield slip(form.start, form.start, text)


# Names


def _names(source: Source, *keywords: str) -> Iterator[tuple[Form, Token]]:
    for form in source.all(*keywords) if keywords else source.forms:
        for token in form.of("NAME"):
            yield form, token


def _everywhere(source: Source, old: str, new: str) -> tuple[tuple[int, int, str], ...]:
    """The edits that write a name differently outside blocks."""
    return tuple(
        (start, end, new)
        for form in source.forms
        for _, start, end in form.of("NAME")
        if source.text[start:end] == old
    )


@kind("name: in braces")
def _(source: Source) -> Iterator[Slip]:
    for form, token in _names(source):
        start, end = token[1:]
        inside = source.text.rfind("{", form.start, start) > source.text.rfind("}", form.start, start)
        arrow = form.of("ARROW")
        is_source = (
            arrow
            and start < arrow[0][1]
            and (form.keyword == "eps" or token is not form.of("NAME")[0] or form.of("BLOCK", "INTEGER"))
        )
        if not inside and not (is_source and form.keyword != "exit"):
            yield slip(start, end, f"{{{source.text[start:end]}}}")


@kind("name: in quotes")
def _(source: Source) -> Iterator[Slip]:
    for _, (_, start, end) in _names(source):
        for quote in "\"'":
            yield slip(start, end, f"{quote}{source.text[start:end]}{quote}")


@kind("name: in square brackets")
def _(source: Source) -> Iterator[Slip]:
    for _, (_, start, end) in _names(source, "state", "spawn", "machine"):
        yield slip(start, end, f"[{source.text[start:end]}]")


@kind("name: with `-`, once")
def _(source: Source) -> Iterator[Slip]:
    for _, (_, start, end) in _names(source):
        name = source.text[start:end]
        if "_" in name.strip("_"):
            yield slip(start, end, name.replace("_", "-"))


@kind("name: with `-`, everywhere")
def _(source: Source) -> Iterator[Slip]:
    for _, (_, start, end) in _names(source, "state", "event", "machine"):
        name = source.text[start:end]
        if "_" in name.strip("_"):
            yield Slip(_everywhere(source, name, name.replace("_", "-")))


@kind("name: with `.`")
def _(source: Source) -> Iterator[Slip]:
    for _, (_, start, end) in _names(source):
        name = source.text[start:end]
        if "_" in name.strip("_"):
            yield slip(start, end, name.replace("_", "."))


@kind("name: two words")
def _(source: Source) -> Iterator[Slip]:
    for _, (_, start, end) in _names(source, "state", "event", "machine", "var"):
        name = source.text[start:end]
        if "_" in name.strip("_"):
            yield slip(start, end, name.replace("_", " "))


@kind("name: leading digit")
def _(source: Source) -> Iterator[Slip]:
    for _, (_, start, end) in _names(source, "state", "event", "machine", "spawn", *TRANSITIONS):
        yield slip(start, end, "2" + source.text[start:end])


@kind("name: with a sign")
def _(source: Source) -> Iterator[Slip]:
    for _, (_, _, end) in _names(source):
        for sign in "!?:.$%":
            yield slip(end, end, sign)


@kind("name: missing")
def _(source: Source) -> Iterator[Slip]:
    for form in source.all(*DEFINITIONS):
        _, start, end = form.of("NAME")[0]
        yield slip(start, end, "")


@kind("commas")
def _(source: Source) -> Iterator[Slip]:
    for form in source.forms:
        tokens = [token for token in form.tokens if token[0] in ("NAME", "BLOCK", "INTEGER", "RBRACE")]
        for (_, _, end), (_, start, _) in pairwise(tokens):
            if not source.text[end:start].strip():
                yield slip(end, end, ",")


# Delays


def _delays(name: str, *shapes: str) -> None:
    @kind(name)
    def _(source: Source) -> Iterator[Slip]:
        for form in source.all("ontime"):
            for _, start, end in form.of("INTEGER"):
                amount = int(source.text[start:end])
                for shape in shapes:
                    if shape == "seconds" and amount % 100 == 0:
                        yield slip(start, end, f"{amount / 1000:g}s")
                    elif shape == "point" and amount % 100 == 0:
                        yield slip(start, end, f"{amount / 1000:.1f}")
                    elif shape == "ms":
                        yield slip(start, end, f"{amount}ms")
                        yield slip(start, end, f"{amount} ms")


_delays("delay: `2s`", "seconds")
_delays("delay: `0.5`", "point")
_delays("delay: `500ms`", "ms")


# Comments


@kind("comment: `//`")
def _(source: Source) -> Iterator[Slip]:
    starts = _free_lines(source)
    for start in starts:
        yield slip(start, start, "// drives on\n")
    for match in _comments(source):
        yield slip(match.start(), match.end(), "//")


@kind("comment: `/* */`")
def _(source: Source) -> Iterator[Slip]:
    for start in _free_lines(source):
        yield slip(start, start, "/* drives on (as before) */\n")
    for form in source.forms:
        if form.column >= 0 and form.keyword != "var":
            yield slip(form.start, form.start, "/* slowly */ ")


@kind("comment: `--`")
def _(source: Source) -> Iterator[Slip]:
    for start in _free_lines(source):
        yield slip(start, start, "-- drives on, as before\n")


def _free_lines(source: Source) -> list[int]:
    """The offsets of lines that begin with a form."""
    return [form.start - form.column for form in source.forms if form.column >= 0]


def _comments(source: Source) -> Iterator[re.Match[str]]:
    """The beginnings of comments between forms, that contain no brackets or quotes."""
    blocks = [token[1:] for token in source.tokens if token[0] == "BLOCK"]
    for match in re.finditer(r"[;#](?= [^\r\n(){}\[\]'\"`]*[\r\n])", source.text):
        line = source.text[source.text.rfind("\n", 0, match.start()) + 1 : match.start()]
        if not any(start < match.start() < end for start, end in blocks) and not re.search("[;#]", line):
            yield match


# Brackets of forms


def _multiline(source: Source, form: Form) -> bool:
    return source.line(form.start) != source.line(form.end)


def _left_open(source: Source, form: Form) -> tuple[int, ...]:
    """Where a missing `)` is reported: where it was, or at a form that it leaves open."""
    return (form.last, *(other.start for other in source.forms if other.start <= form.start < other.end))


@kind("bracket: `)` missing")
def _(source: Source) -> Iterator[Slip]:
    for form in source.forms:
        if form.column >= 0 or form.around in ("program", "machine"):
            yield slip(form.last, form.end, "", *_left_open(source, form))


@kind("bracket: `)` missing within a line")
def _(source: Source) -> Iterator[Slip]:
    for form in source.forms:
        if form.column < 0 and form.around not in ("program", "machine"):
            yield slip(form.last, form.end, "", *_left_open(source, form))


@kind("bracket: `)` missing at the end")
def _(source: Source) -> Iterator[Slip]:
    last = source.forms[-1]
    yield slip(last.last, last.end, "", last.last, last.start)
    for form in source.all("machine"):
        if source.text[form.last - 1] == ")":
            yield slip(form.last, form.end, "", *_left_open(source, form))


@kind("bracket: surplus `)`")
def _(source: Source) -> Iterator[Slip]:
    for form in source.forms:
        yield slip(form.end, form.end, ")")


@kind("bracket: `)` too early, as an editor closes it")
def _(source: Source) -> Iterator[Slip]:
    for form in source.forms:
        space = source.text.find(" ", source.text.find(" ", form.start) + 1, form.last)
        if form.keyword in ("event", "var", "on", "ontime", "exit", "eps") and space > 0:
            yield slip(space, space, ")")


@kind("bracket: surplus `(`")
def _(source: Source) -> Iterator[Slip]:
    for form in source.forms:
        if form.keyword != "machine":
            yield slip(form.start, form.start, "(")


@kind("bracket: `(` missing")
def _(source: Source) -> Iterator[Slip]:
    for form in source.forms:
        yield slip(form.start, form.start + 1, "")


@kind("bracket: form in `[ ]`")
def _(source: Source) -> Iterator[Slip]:
    for form in source.all("state", "event", "var", "spawn", *TRANSITIONS):
        if not form.of("BLOCK") and not form.forms:
            yield Slip(((form.start, form.start + 1, "["), (form.last, form.end, "]")))


@kind("bracket: form in `{ }`")
def _(source: Source) -> Iterator[Slip]:
    for form in source.forms:
        yield Slip(((form.start, form.start + 1, "{"), (form.last, form.end, "}")))


@kind("bracket: `]` for `)`")
def _(source: Source) -> Iterator[Slip]:
    for form in source.forms:
        if form.keyword in (*TRANSITIONS, "spawn") or (form.keyword == "state" and not form.forms):
            yield slip(form.last, form.end, "]", form.last, form.start)


# Brackets of blocks


def _blocks(source: Source, *keywords: str) -> Iterator[tuple[Form, int, int]]:
    for form in source.all(*keywords) if keywords else source.forms:
        for _, start, end in form.of("BLOCK"):
            yield form, start, end


@kind("block: `]` missing")
def _(source: Source) -> Iterator[Slip]:
    for _, start, end in _blocks(source):
        yield slip(end - 1, end, "", end - 1, start)


@kind("block: `[` missing")
def _(source: Source) -> Iterator[Slip]:
    for _, start, end in _blocks(source):
        if "\n" not in source.text[start:end]:
            yield slip(start, start + 1, "")


@kind("block: surplus `]`")
def _(source: Source) -> Iterator[Slip]:
    for _, _, end in _blocks(source):
        yield slip(end, end, "]")


@kind("block: surplus `[`")
def _(source: Source) -> Iterator[Slip]:
    for _, start, _ in _blocks(source):
        yield slip(start, start, "[")


@kind("block: `[ ]` both missing")
def _(source: Source) -> Iterator[Slip]:
    for _, start, end in _blocks(source):
        if "\n" not in source.text[start:end]:
            yield Slip(((start, start + 1, ""), (end - 1, end, "")))


@kind("block: in `( )`")
def _(source: Source) -> Iterator[Slip]:
    for _, start, end in _blocks(source):
        if "\n" not in source.text[start:end] and "#" not in source.text[start:end]:
            yield Slip(((start, start + 1, "("), (end - 1, end, ")")))


@kind("block: in `{ }`")
def _(source: Source) -> Iterator[Slip]:
    for _, start, end in _blocks(source):
        if "#" not in source.text[start:end]:
            yield Slip(((start, start + 1, "{"), (end - 1, end, "}")))


@kind("block: `]` and `)` swapped")
def _(source: Source) -> Iterator[Slip]:
    for _, start, end in _blocks(source, *ACTIONS):
        if source.text[end : end + 1] == ")" and "\n" not in source.text[start:end]:
            yield slip(end - 1, end + 1, ")]")


@kind("block: straight in a state")
def _(source: Source) -> Iterator[Slip]:
    for form in source.all("running", "onentry", "onexit"):
        if len(form.of("BLOCK")) == 1 and not form.forms:
            _, start, end = form.of("BLOCK")[0]
            comment = source.text[form.tokens[0][2] : start] + source.text[end : form.last]
            if not comment.strip():
                yield slip(form.start, form.end, source.text[start:end])


@kind("block: a `#` swallows the `]`")
def _(source: Source) -> Iterator[Slip]:
    for _, _, end in _blocks(source):
        yield slip(end - 1, end - 1, "  # as fast as it can", end - 1)


@kind("block: a `;` comment in it")
def _(source: Source) -> Iterator[Slip]:
    for _, start, end in _blocks(source, *ACTIONS):
        if "\n" not in source.text[start:end]:
            yield slip(end - 1, end - 1, "  ; so it goes\n    ", start)


@kind("block: unclosed string")
def _(source: Source) -> Iterator[Slip]:
    for _, start, end in _blocks(source):
        for match in re.finditer(
            r"(?<![\"'\w])([\"'])(?!\1)[^\"'\r\n\\#]*\1(?![\"'])", source.text[start:end]
        ):
            yield slip(start + match.end() - 1, start + match.end(), "")
    for _, start, end in _blocks(source, "onentry", "onexit"):
        if not re.search("['\"#\n]", source.text[start:end]):
            for said in ('print("here")', 'print("Hello, world")', 'robot.say("on it")'):
                right = f"{source.text[: start + 1]}{said}; {source.text[start + 1 :]}"
                quote = right.index('")', start)
                yield Slip(((quote, quote + 1, ""),), (), right)


@kind("block: empty")
def _(source: Source) -> Iterator[Slip]:
    for _, start, end in _blocks(source, "var", "event", *TRANSITIONS):
        yield slip(start + 1, end - 1, "")


# Forms and their parts


def _moved(form: Form, source: Source, to: int) -> Slip:
    text = source.text[form.start : form.end]
    return Slip(((form.start, form.end, ""), (to, to, f"\n{text}\n")), (to,))


@kind("form: outside its machine")
def _(source: Source) -> Iterator[Slip]:
    tops = [form for form in source.all("machine") if form.around == "program"]
    for machine in tops:
        for form in machine.forms:
            if (
                form.keyword in ("state", *TRANSITIONS)
                and "#" not in source.text[form.start - 2 : form.start]
            ):
                text = source.text[form.start : form.end]
                edits = ((form.start, form.end, ""), (machine.end, machine.end, f"\n{text}\n"))
                wrong_line = machine.end
                yield Slip(edits, (wrong_line,))


@kind("form: action in the machine")
def _(source: Source) -> Iterator[Slip]:
    for state in source.all("state"):
        for form in state.forms:
            if form.keyword in ("running", "onentry", "onexit"):
                text = source.text[form.start : form.end]
                yield Slip(((form.start, form.end, ""), (state.end, state.end, " " + text)), (state.end,))


@kind("form: transition in the state")
def _(source: Source) -> Iterator[Slip]:
    for machine in source.all("machine"):
        for state in machine.forms:
            for form in machine.forms:
                if state.keyword == "state" and form.keyword in TRANSITIONS and form.start >= state.end:
                    text = source.text[form.start : form.end]
                    yield Slip(
                        ((form.start, form.end, ""), (state.last, state.last, " " + text)), (state.last,)
                    )


@kind("form: variable or event in the state")
def _(source: Source) -> Iterator[Slip]:
    for machine in source.all("machine"):
        states = [form for form in machine.forms if form.keyword == "state"]
        for form in machine.forms:
            if form.keyword in ("var", "event") and states:
                at = states[0].of("NAME")[0][2]
                text = source.text[form.start : form.end]
                yield Slip(((form.start, form.end, ""), (at, at, " " + text)), (at,))


@kind("form: spawn in `running`")
def _(source: Source) -> Iterator[Slip]:
    for form in source.all("onentry"):
        if form.forms and not form.of("BLOCK"):
            yield slip(*_keyword(form, source), "running")


@kind("form: spawn straight in the state")
def _(source: Source) -> Iterator[Slip]:
    for form in source.all("onentry"):
        if len(form.forms) == 1 and not form.of("BLOCK"):
            inner = form.forms[0]
            yield slip(form.start, form.end, source.text[inner.start : inner.end])


@kind("form: spawn in the machine")
def _(source: Source) -> Iterator[Slip]:
    tops = [form for form in source.all("spawn") if form.around == "program"]
    for spawn in tops:
        for machine in source.all("machine"):
            if machine.around == "program" and machine.end < spawn.start:
                name = source.word(machine.of("NAME")[0])
                if source.word(spawn.of("NAME")[0]) == name:
                    text = source.text[spawn.start : spawn.end]
                    edits = ((machine.last, machine.last, "\n  " + text), (spawn.start, spawn.end, ""))
                    yield Slip(edits, (machine.last,))


@kind("parts: event after the arrow")
def _(source: Source) -> Iterator[Slip]:
    for form in source.all("on", "exit", "ontime"):
        if len(form.of("ARROW")) == 1 and len(form.of("BLOCK")) <= 1:
            first = form.tokens[1]
            if len(form.of("NAME")) >= 2 and source.text[first[2]] in " \n":
                text = source.word(first)
                if len(form.of("NAME")) == (3 if first[0] == "NAME" else 2):
                    yield Slip(
                        ((first[1], first[2] + 1, ""), (form.last, form.last, " " + text)), (form.start,)
                    )


@kind("parts: spawn's names swapped")
def _(source: Source) -> Iterator[Slip]:
    for form in source.all("spawn"):
        first, second = form.of("NAME")
        if source.word(first) != source.word(second):
            yield Slip(((*first[1:], source.word(second)), (*second[1:], source.word(first))))


@kind("parts: event and source swapped")
def _(source: Source) -> Iterator[Slip]:
    for form in source.all("on", "ontime"):
        names = form.of("NAME")
        if form.types[1:4] == ("NAME", "NAME", "ARROW"):
            edits = (*names[0][1:], source.word(names[1])), (*names[1][1:], source.word(names[0]))
            yield Slip(edits)


@kind("parts: block before the name")
def _(source: Source) -> Iterator[Slip]:
    for form in source.all("event"):
        name, block = form.of("NAME", "BLOCK")
        yield Slip(((*name[1:], source.word(block)), (*block[1:], source.word(name))))


@kind("parts: two blocks in an event")
def _(source: Source) -> Iterator[Slip]:
    for _, _, end in _blocks(source, "event", "var"):
        yield slip(end, end, " [True]", end)


@kind("parts: spawn without its state")
def _(source: Source) -> Iterator[Slip]:
    for form in source.all("spawn"):
        (_, _, end), (_, _, last) = form.of("NAME")
        yield slip(end, last, "", end - 1)


@kind("parts: no block")
def _(source: Source) -> Iterator[Slip]:
    for form, start, end in _blocks(source, "event", "var", "running", "onexit"):
        if len(form.of("BLOCK")) == 1:
            yield slip(start, end, "", start, form.start, form.last)


@kind("parts: no destination")
def _(source: Source) -> Iterator[Slip]:
    for form in source.all(*TRANSITIONS):
        arrow = form.of("ARROW")[0]
        after = [token for token in form.of("NAME") if token[1] > arrow[1]]
        if len(after) == 1:
            yield slip(arrow[2], after[0][2], "", arrow[2])


@kind("parts: no source")
def _(source: Source) -> Iterator[Slip]:
    for form in source.all("on", "ontime"):
        arrow = form.of("ARROW")[0]
        before = [token for token in form.tokens[1:] if token[1] < arrow[1]]
        if len(before) == 2:
            yield slip(before[1][1], before[1][2], "", before[1][1], before[0][1])


@kind("parts: no event")
def _(source: Source) -> Iterator[Slip]:
    for form in source.all("on", "ontime"):
        first = form.tokens[1]
        yield slip(first[1], first[2], "", first[1])


@kind("spawn missing")
def _(source: Source) -> Iterator[Slip]:
    tops = [form for form in source.all("spawn") if form.around == "program"]
    if len(tops) == 1:
        yield slip(tops[0].start, tops[0].end, "", 0, tops[0].start)


# Other notations: the right text has what is meant


def _instead(source: Source, start: int, end: int, right: str, wrong: str) -> Slip:
    text = f"{source.text[:start]}{right}{source.text[end:]}"
    return Slip(((start, start + len(right), wrong),), (start,), text)


def _events(name: str, right: str, wrong: str) -> None:
    @kind(name)
    def _(source: Source) -> Iterator[Slip]:
        for form in source.all("on", "exit"):
            kind_of, start, end = form.tokens[1]
            event = source.text[start:end]
            if kind_of == "NAME" and form.types[2] == "NAME":
                yield _instead(source, start, end, right.format(event), wrong.format(event))


_events("notation: guard", "[{} and 1 < 2]", "{} [1 < 2]")
_events("notation: guard without brackets", "[{} and 1 < 2]", "{} if 1 < 2")
_events("notation: guard in round brackets", "[{} and (1 < 2 or 3)]", "{} (1 < 2 or 3)")
_events("notation: `!`", "[not {}]", "!{}")
_events("notation: two events", "[{0} or {0}]", "{0} || {0}")


def _effects(name: str, wrong: str) -> None:
    @kind(name)
    def _(source: Source) -> Iterator[Slip]:
        for form in source.all(*TRANSITIONS):
            if "EFFECT_FORM" not in form.types:
                yield _instead(source, form.last, form.last, " (effect [print(1)])", wrong)


_effects("notation: `/` before an effect", " / print(1)")
_effects("notation: `do` for an effect", " (do [print(1)])")
_effects("notation: `actions` for an effect", " (actions [print(1)])")


@kind("effect: behind its transition")
def _(source: Source) -> Iterator[Slip]:
    for form in source.all(*TRANSITIONS):
        if "EFFECT_FORM" not in form.types and not form.forms:
            yield _instead(source, form.last, form.end, " (effect [print(1)]))", ") (effect [print(1)])")


@kind("effect: before the destination")
def _(source: Source) -> Iterator[Slip]:
    for form in source.all(*TRANSITIONS):
        if not form.forms:
            _, start, end = form.of("ARROW")[0]
            words = source.text[end : form.last].rstrip()
            if ";" not in words:
                right = f"->{words} (effect [print(1)])"
                yield _instead(source, start, form.last, right, f"-> (effect [print(1)]){words}")


@kind("effect: two")
def _(source: Source) -> Iterator[Slip]:
    for form in source.all(*TRANSITIONS):
        if not form.forms:
            two = " (effect [print(1)]) (effect [print(2)])"
            yield _instead(source, form.last, form.last, " (effect [print(1)] [print(2)])", two)


# Variables that a spawn sets, times for which a condition holds, and states of machines


def _settings(name: str, wrong: str) -> None:
    @kind(f"setting: {name}")
    def _(source: Source) -> Iterator[Slip]:
        for form in source.all("spawn"):
            machine = source.word(form.of("NAME")[0])
            for variable in _variables(source, machine) if form.around == "onentry" else ():
                right = f" (var {variable} := [-1]))"
                yield _instead(source, form.last, form.end, right, wrong.format(variable))


def _named(source: Source, machine: str) -> Iterator[Form]:
    return (form for form in source.all("machine") if source.word(form.of("NAME")[0]) == machine)


def _variables(source: Source, machine: str) -> list[str]:
    inner = [form for each in _named(source, machine) for form in each.forms if form.keyword == "var"]
    return [source.word(form.of("NAME")[0]) for form in inner]


_settings("behind the spawn", ") (var {} := [-1])")
_settings("no block", " (var {} := -1))")
_settings("`name=value`", " {}=-1)")
_settings("`name := [value]`", " {} := [-1])")
_settings("without `var`", " ({} := [-1]))")
_settings("`:name value`", " :{} -1)")
_settings("`set`", " (set {} [-1]))")
_settings("in square brackets", " [{} = -1])")


def _holds(name: str, wrong: str, last: str = "") -> None:
    @kind(f"time: {name}")
    def _(source: Source) -> Iterator[Slip]:
        for form in source.all("on", "exit"):
            _, start, end = form.tokens[1]
            if "FOR" not in form.types and "DOT" not in form.types and not form.forms:
                word, rest = source.text[start:end], source.text[end : form.last].rstrip()
                if ";" not in rest:
                    slip_of = wrong.format(word) + rest + last
                    yield _instead(source, start, form.last, f"{word} for 500{rest}", slip_of)


_holds("no `for`", "{} 500")
_holds("`during`", "{} during 500")
_holds("`for` with a unit", "{} for 0.5s")
_holds("`(for …)`", "{} (for 500)")
_holds("before the condition", "for 500 {}")
_holds("behind the destination", "{}", " for 500")
_holds("no delay", "{} for")


@kind("time: `ontime` for a condition that holds")
def _(source: Source) -> Iterator[Slip]:
    for form in source.all("on"):
        _, start, end = form.tokens[1]
        if form.types[1] == "NAME" and not {"FOR", "DOT"} & set(form.types):
            word, (first, _) = source.text[start:end], _keyword(form, source)
            yield _instead(source, first, end, f"on {word} for 500", f"ontime {word} for 500")


def _states(name: str, wrong: str, right: str = "{}.{}") -> None:
    @kind(f"state of a machine: {name}")
    def _(source: Source) -> Iterator[Slip]:
        for outer in source.all("machine"):
            spawned = {
                source.word(state.of("NAME")[0]): source.word(spawn.of("NAME")[0])
                for state in outer.forms
                for action in state.forms
                for spawn in action.forms
                if spawn.keyword == "spawn"
            }
            for form in outer.forms:
                if form.keyword != "on" or form.types[1] not in ("NAME", "BLOCK") or form.types[2] != "NAME":
                    continue
                _, start, end = form.tokens[1]
                machine = spawned.get(source.word(form.tokens[2]), "")
                for inner in _named(source, machine):
                    names = [
                        source.word(each.of("NAME")[0]) for each in inner.forms if each.keyword == "state"
                    ]
                    for state in names:
                        pair = machine, state
                        yield _instead(source, start, end, right.format(*pair), wrong.format(*pair))


_states("`m/s`", "{}/{}")
_states("`m::s`", "{}::{}")
_states("`m s`", "{} {}")
_states("in quotes", '"{}.{}"')
_states("in round brackets", "({}.{})")
_states("`not`", "not {}.{}", '[{}.state != "{}"]')
_states("as Python", '{}.state == "{}"', '[{}.state == "{}"]')


@kind("notation: transition as a drawing")
def _(source: Source) -> Iterator[Slip]:
    for form in source.all("on", "eps"):
        if form.types in (
            ("OPEN", "NAME", "NAME", "ARROW", "NAME", "CLOSE"),
            ("OPEN", "NAME", "ARROW", "NAME", "CLOSE"),
        ):
            *event, first, _, last = map(source.word, form.tokens[1:-1])
            after = source.text[form.end :].partition("\n")[0].strip(" )")
            if form.column >= 0 and not after:
                yield slip(form.start, form.end, " : ".join([f"{first} --> {last}", *event]))


@kind("notation: `entry /`")
def _(source: Source) -> Iterator[Slip]:
    for form in source.all("onentry", "onexit"):
        yield slip(*_keyword(form, source), f"{form.keyword[2:]} /")


@kind("notation: `always` for `eps`")
def _(source: Source) -> Iterator[Slip]:
    for form in source.all("eps"):
        yield slip(*_keyword(form, source), "always")


# References and definitions


def _misspelt(word: str) -> list[str]:
    if len(word) < 3:
        return []
    middle = len(word) // 2
    return [
        word[:middle] + word[middle + 1 :],
        word[:middle] + word[middle - 1 :],
        word + "e" if word[-1] != "e" else word[:-1],
        word[: middle - 1] + word[middle] + word[middle - 1] + word[middle + 1 :],
        word.capitalize() if word.islower() else word.lower(),
    ]


def _references(name: str, find: Callable[[Form], list[Token]]) -> None:
    @kind(name)
    def _(source: Source) -> Iterator[Slip]:
        names = {source.word(token) for form in source.forms for token in form.of("NAME")}
        for form in source.forms:
            for token in find(form):
                for wrong in _misspelt(source.word(token)):
                    if wrong not in names and wrong != source.word(token):
                        yield slip(*token[1:], wrong)


def _after_arrow(form: Form) -> list[Token]:
    if form.keyword not in TRANSITIONS:
        return []
    arrow = form.of("ARROW")[0]
    return [token for token in form.of("NAME") if token[1] > arrow[1]][:1]


def _before_arrow(form: Form) -> list[Token]:
    if form.keyword not in TRANSITIONS:
        return []
    arrow = form.of("ARROW")[0]
    names = [token for token in form.of("NAME") if token[1] < arrow[1]]
    return [token for token in names if token is not form.tokens[1] or form.keyword == "eps"]


def _trigger(*keywords: str) -> Callable[[Form], list[Token]]:
    return lambda form: [form.tokens[1]] if form.keyword in keywords and form.tokens[1][0] == "NAME" else []


_references("unknown: destination", _after_arrow)
_references("unknown: source", _before_arrow)
_references("unknown: event", _trigger("on", "exit"))
_references("unknown: delay", _trigger("ontime"))
_references("unknown: machine", lambda form: form.of("NAME")[:1] if form.keyword == "spawn" else [])
_references("unknown: start state", lambda form: form.of("NAME")[1:] if form.keyword == "spawn" else [])


@kind("defined twice")
def _(source: Source) -> Iterator[Slip]:
    for form in source.all("state", "event", "var"):
        text = source.text[form.start : form.end]
        if "#" not in text.rpartition("\n")[2] and ";" not in text:
            yield slip(form.end, form.end, "\n" + text, form.end)
