from __future__ import annotations

import re
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from programs import programs
from support.tables import every

from lrp_jupyter.errors import UnknownElementError
from lrp_jupyter.language.edits.rename import references, rename, symbols
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.printer import to_source
from lrp_jupyter.language.program import Program, Span


def renamed(text: str, kind: str, path: str, new_name: str) -> str:
    return rename(parse(text), kind, tuple(path.split("/")), new_name)


def marked(text: str) -> tuple[str, str]:
    """The text with every «old» as `old`, and as `new`."""
    plain = text.replace("«", "").replace("»", "")
    parts = text.replace("«", "»").split("»")
    return plain, "".join("new" if index % 2 else part for index, part in enumerate(parts))


CASES = [
    (
        "state",
        "m/old",
        "(machine m (state «old») ; old\r\n (state b (machine old (state old)))\r\n"
        " (on e «old» -> «old» old) (on e *-{«old» b}->b)\n (event e [old])) (spawn m «old»)",
    ),
    (
        "machine",
        "m/a/old",
        "(machine m (state a (onentry (spawn «old» old)) (machine «old» (state old)))"
        "(state b (onentry (spawn old old)))) (machine old (state old)) (spawn old old)",
    ),
    (
        "machine",
        "old",
        "(machine m (state a (onentry (spawn old s)) (machine old (state s)))"
        "(state b (onentry (spawn «old» s)))) (machine «old» (state s)) (spawn «old» s)",
    ),
    (
        "event",
        "old",
        "(event «old» [old]) (machine m (on «old» old -> old) (on [«old»] a -> b)"
        "(state s (machine n (exit «old» a -> b))) (state t (machine n (event old [1]) (on old a -> b))))",
    ),
    ("transition", "m/old", "(machine m (on old old -> old «old») (eps old -> old other))"),
    (
        "variable",
        "old",
        "(var «old» := [1]) (var b := [«old»]) (event old [f'{«old»}' + 'old' # old\n])"
        "(machine m (ontime «old» old -> old) (state s (onentry [«old» = «old».old] (spawn old old)))"
        "  (state t (running [def f(old): return old\ndef g():\n  nonlocal «old»; «old» = 1\n"
        "[old for old in «old»]])))"
        "(machine n (var old := [«old»]) (ontime old a -> b) (state s (onexit [old = 1]))) (onpause [«old»])",
    ),
    (
        "variable",
        "n/old",
        "(var old := [1]) (machine n (var first := [old]) (var «old» := [old]) (var last := [«old»])"
        "(state s (running [import math; «old» = old1])))",
    ),
    (
        "state",
        "m/old",
        "(machine m (state «old») (state s (onentry (spawn n a))"
        " (machine n (state old) (exit e old -> «old»)))"
        "(state t (onentry (spawn nothing old))))",
    ),
    (
        "state",
        "m/s/n/old",
        "(machine m (state old) (state s (onentry (spawn n «old»)) "
        "(machine n (state «old») (exit e «old» -> old))))",
    ),
    (
        "state",
        "move/old",
        "(machine move (state «old») (on e «old» -> «old»)) (event e [move.state == '«old»' and 'old'])"
        "(machine m (state s (onentry (spawn move «old»))) (on move . «old» for 5 s -> old)"
        " (on [move.state in ['old ', \"«old»\"] or r'old' != move.state != '«old»'] s -> old)"
        " (on other.old s -> old) (on [other.state == 'old' or move.old == 'old'] s -> old)"
        " (on [f'{move.state == \"«old»\"}' == 'old'] s -> old)"
        " (eps s -> t (effect [match move.state:\n case '«old»' | 'other': old = 'old'])))"
        "(machine other (state old))",
    ),
    (
        "machine",
        "old",
        "(machine «old» (var old := [1]) (state old)) (event e [«old».state == 'old' or «old».old and old()])"
        "(machine m (state s (onentry (spawn «old» old (var old := [«old».state]))))"
        " (on «old».old s -> old old)) (spawn «old» old)",
    ),
    (
        "variable",
        "move/old",
        "(var old := [1]) (machine move (var «old» := [old]) (state s (running [«old» += 1])))"
        "(machine m (state t (onentry (spawn move s (var «old» := [old]) (var other := [move.«old»]))))"
        " (on [move.«old» > old and robot.old and old.old] t -> t (effect [old = move . «old».old])))",
    ),
    ("variable", "m/old", "(machine m (var «old» := [1]) (on old for «old» old -> old old))"),
    (
        "event",
        "old",
        "(event «old» [1]) (machine m (on [«old» and old() and (lambda old: old)(old=«old»)] a -> b)"
        " (on «old» for [«old»] a -> b (effect [x = «old»])) (eps a -> b (effect [old = old]))"
        " (state a (running [[old for old in x], «old»])))",
    ),
    (
        "machine",
        "old",
        "(machine «old» (state s)) (event old [«old»]) (machine m (event e [old and «old».state]))",
    ),
]


@every(("kind", "path", "text"), CASES)
def test_a_definition_and_what_refers_to_it_change_together(kind: str, path: str, text: str) -> None:
    before, after = marked(text)
    assert renamed(before, kind, path, "new") == after


@every(("kind", "path", "text"), CASES)
def test_the_inverse_rename_restores_the_text(kind: str, path: str, text: str) -> None:
    before, after = marked(text)
    outer = path.rpartition("/")[0]
    assert renamed(after, kind, f"{outer}/new" if outer else "new", "old") == before


@every(("kind", "path", "text"), CASES)
def test_every_place_of_an_element_leads_to_it(kind: str, path: str, text: str) -> None:
    before, _ = marked(text)
    spans = []
    shift = 0
    for part in text.split("«")[1:]:
        start = text.index("«" + part, spans[-1][1] + shift if spans else 0) - shift
        spans.append(Span(start, start + part.index("»")))
        shift += 2
    for span in spans:
        found = references(parse(before), span.start + 1)
        assert found is not None
        assert (found.element.kind, found.element.path) == (kind, tuple(path.split("/")))
        assert sorted({found.definition, *found.references}) == spans


def test_two_machines_of_a_name_in_one_place_cannot_be_renamed() -> None:
    text = (
        "(machine m (state a (onentry (spawn n s)) (machine n (state s)))"
        "(state b (onentry (spawn n s)) (machine n (state s))) (on n.s {a b} -> a))"
    )
    for kind, path in (("machine", "m/a/n"), ("state", "m/b/n/s")):
        with pytest.raises(ValueError, match="is not the only one that line 1 can mean"):
            renamed(text, kind, path, "new")


def test_a_place_that_means_nothing_leads_nowhere() -> None:
    program = parse("(var a := [len]) (spawn m s)")
    assert [references(program, program.text.index(word)) for word in ("len", "m s", "s)")] == [None] * 3


def test_an_import_keeps_the_module_and_gets_another_name() -> None:
    text = "(var math := [0]) (machine m (state s (onentry [import math; math.pi])))"
    assert renamed(text, "variable", "math", "m") == (
        "(var m := [0]) (machine m (state s (onentry [import math as m; m.pi])))"
    )


def test_the_same_name_changes_nothing() -> None:
    assert renamed("(var a := [1])", "variable", "a", "a") == "(var a := [1])"


def test_a_program_without_a_text_is_printed_first() -> None:
    program = parse("(machine  m (state  a))")
    bare = Program(machines=program.machines)
    assert rename(bare, "state", ("m", "a"), "b") == "(machine m\n  (state b))\n"


@every(
    ("text", "kind", "path", "name", "message"),
    [
        ("(var a := [1])", "variable", "a", "1b", "is not a valid name"),
        ("(var a := [1])", "variable", "a", "class", "word of Python"),
        ("(var a := [1])", "variable", "a", "__debug__", "word of Python"),
        ("(var a := [1])(var b := [1])", "variable", "a", "b", "is taken by another variable"),
        ("(machine m (state a)(state b))", "state", "m/a", "b", "another state"),
        ("(machine m (eps a -> b t)(eps b -> a u))", "transition", "m/t", "u", "another transition"),
        ("(event a [1])(event a [2])", "event", "a", "b", "is defined twice"),
        ("(machine m (eps a -> b))", "transition", "m/eps:a->b", "t", "has no name of its own"),
        ("(machine m (eps a -> gone)\n(state a)(state b))", "state", "m/b", "gone", "else in line 1"),
        ("(var a := [1])(event e [a > max])", "variable", "a", "max", "something else in line 1"),
        ("(var a := [1])(event e [b = a])", "variable", "a", "b", "something else"),
        ("(var a := [1])(event e [(lambda b: a)(1)])", "variable", "a", "b", "in an inner function"),
        (
            "(var a := [1])(event e [[a for b in c]])",
            "variable",
            "a",
            "b",
            "already means something else in line",
        ),
        ("(var a := [1])(machine m (var b := [1])(event e [a]))", "variable", "a", "b", "something else"),
        ("(var a := [1])(machine m (var b := [1])(event e [a]))", "variable", "m/b", "a", "something else"),
        ("(event a [1])(machine m (event b [1])(on a s -> t))", "event", "a", "b", "something else"),
        ("(var a := [1])(event e [import a.b])", "variable", "a", "c", "`import a.b` assigns `a`"),
        (
            "(var a := [1])(event e [def f(b):\n nonlocal a; a = b])",
            "variable",
            "a",
            "b",
            "is not valid everywhere",
        ),
        ("(event a [1])(event e [a and b])", "event", "a", "b", "something else"),
        ("(event a [1])(event e [b = a])", "event", "a", "b", "something else"),
        ("(event a [1])(var b := [1])(event e [a])", "event", "a", "b", "something else"),
        ("(event a [1])(var b := [1])(event e [a])", "variable", "b", "a", "something else"),
        ("(var a := [1])(event e [elapsed > a])", "variable", "a", "elapsed", "something else"),
        ("(machine n (var a := [1]))(event e [n.a])", "variable", "n/a", "state", "something else"),
        ("(machine n (state s))(var b := [1])(event e [n.state])", "machine", "n", "b", "something else"),
        (
            "(machine n (state a)(state b))(event e [n.state == 'a'])(machine m (event e [n.state == 'b']))",
            "state",
            "n/a",
            "b",
            "another state",
        ),
        ("(machine n (state a))(event e [n.state in ('a', 'b')])", "state", "n/a", "b", "something else"),
        (
            "(machine n (exit e s -> a)) (machine m (state a)(state s (onentry (spawn n s))))"
            "(machine o (state a)(state s (onentry (spawn n s))))",
            "state",
            "m/a",
            "b",
            "not the only one",
        ),
    ],
)
def test_a_rename_that_would_change_a_meaning_is_refused(
    text: str, kind: str, path: str, name: str, message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        renamed(text, kind, path, name)


@every(
    ("kind", "path"),
    [("state", "m/b"), ("state", "m"), ("machine", "m/a/n"), ("running", "m/a"), ("transition", "m/t")],
)
def test_an_unknown_element_is_reported(kind: str, path: str) -> None:
    with pytest.raises(UnknownElementError):
        renamed("(machine m (state a (running [1])))", kind, path, "x")


def test_names_of_states_may_be_words_of_python() -> None:
    assert renamed("(machine m (state a))", "state", "m/a", "class") == "(machine m (state class))"


def attempt(text: str, kind: str, path: tuple[str, ...]) -> str | None:
    """Rename, unless a name is defined twice or two machines are left by the same `exit`."""
    try:
        return rename(parse(text), kind, path, "fresh")
    except ValueError as error:
        if re.search("is defined twice|not the only one", str(error)):
            return None
        raise


@given(programs, st.data())
def test_a_renamed_program_differs_in_that_name_only_and_can_be_renamed_back(
    program: Program, data: st.DataObject
) -> None:
    text = to_source(program)
    found: list[Any] = symbols(parse(text))[0]
    if not found:
        return
    symbol = data.draw(st.sampled_from(found))
    kind, path = symbol.element
    new = attempt(text, kind, path)
    if new is None:
        return
    assert new.replace("fresh", "") != new
    old = str(text[slice(*symbol.definition)])
    if [each.element for each in found].count(symbol.element) > 1:  # transitions may share a name
        with pytest.raises(ValueError, match="already means something else in line"):
            rename(parse(new), kind, (*path[:-1], "fresh"), old)
    else:
        assert rename(parse(new), kind, (*path[:-1], "fresh"), old) == text
