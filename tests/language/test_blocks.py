from __future__ import annotations

import ast
import json
import sysconfig
import traceback
import warnings
from collections.abc import Iterator
from pathlib import Path
from types import CellType
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.tables import every

from lrp_jupyter.language.blocks import block as blocks
from lrp_jupyter.language.blocks.block import (
    bind,
    block_names,
    compile_block,
    facts_of,
    faults_of,
    read,
)
from lrp_jupyter.language.blocks.names_in_blocks import Offsets, words
from lrp_jupyter.language.checks import block_facts as facts
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Block
from lrp_jupyter.language.python.block_suite import DEEPEST, parse_block, parse_suite
from lrp_jupyter.language.python.scanner import block_end

CORPUS = json.loads((Path(__file__).parent / "blocks.json").read_text(encoding="utf-8"))["blocks"]


def block_in(source: str) -> Block:
    """The first action of a program that holds nothing else, its place as in a real text."""
    return parse(source).machines[0].states[0].running[0]


def run(text: str, namespace: dict[str, Any] | None = None, **variables: Any) -> tuple[Any, dict[str, Any]]:
    """Run a block with some variables; return its value and theirs."""
    cells = {name: CellType(value) for name, value in variables.items()}
    cells |= {"robot": CellType("the robot"), "print": CellType(print)}
    code = compile_block(Block(text), variables.keys(), "<test>")
    value = bind(code, {} if namespace is None else namespace, cells)()
    return value, {name: cells[name].cell_contents for name in variables}


# Ends


@every("case", CORPUS)
def test_a_block_ends_where_the_corpus_expects(case: dict[str, Any]) -> None:
    assert block_end(case["text"], 0) == case["end"]


@every("case", CORPUS)
def test_a_block_ends_at_the_same_place_inside_a_text(case: dict[str, Any]) -> None:
    end = case["end"]
    assert block_end("rb" + case["text"], 2) == (end if end < 0 else end + 2)


def library() -> Iterator[Path]:
    root = Path(sysconfig.get_path("stdlib"))
    for folder in (root, *(root / name for name in ("asyncio", "email", "json", "test", "unittest"))):
        yield from sorted(folder.glob("*.py"))


def test_every_file_of_the_standard_library_ends_where_it_ends() -> None:
    wrong = []
    for path in library():
        text = f"[{path.read_text(encoding='utf-8', errors='replace')}\n]"
        if block_end(text, 0) != len(text) - 1:
            try:
                ast.parse(text[1:-1])
            except (SyntaxError, ValueError):
                continue  # a file that is wrong on purpose
            wrong.append(path.name)
    assert wrong == []


@given(st.text("[](){}'\"f#\\\n\r:!a=N"))
def test_the_end_of_a_block_is_a_closing_bracket_or_none(text: str) -> None:
    text = f"[{text}"
    end = block_end(text, 0)
    assert end == -1 or text[end] == "]"


def test_f_strings_nested_deeper_than_python_allows_do_not_exhaust_the_stack() -> None:
    assert block_end("[" + "f'{" * 1_000, 0) == -1
    assert block_end("[f'" + "{a:" * 1_000 + "]", 0) == -1
    assert block_end("[f'{a:{b\n]", 0) == len("[f'{a:{b\n")


# Layout

LAYOUTS = [
    "if a:\n  b = 1\nelse:\n  b = 2",
    "\n  if a:\n    b = 1\n  else:\n    b = 2\n",
    "if a:\n        b = 1\n     else:\n        b = 2 # done\n",
    "\n\n# a comment ]\nif a: b = 1\nelse: b = 2",
    "\tif a:\r\n\t\tb = 1\r\n\telse:\r\n\t\tb = 2\r\n",
    "if a: # so \\\n  b = 1\nelse:\n# oddly placed\n  b = 2",
    "if \\\na:\n  b = (\n1)\nelse:\n  b = 2",
]


@every("text", LAYOUTS)
def test_any_layout_of_the_same_code_means_the_same(text: str) -> None:
    assert ast.dump(parse_block(text)) == ast.dump(parse_block(LAYOUTS[0]))


def test_a_block_may_begin_with_a_line_that_encloses_the_others() -> None:
    assert run("for i in (1, 2):\n a += i", a=0) == (None, {"a": 3})


def test_lines_of_a_string_are_not_moved() -> None:
    value, _ = run("\n      x = '''\n  a\n'''\n      x")
    assert value == "\n  a\n"


def test_a_line_left_of_the_first_one_is_an_error() -> None:
    with pytest.raises(SyntaxError, match="unindent"):
        parse_block("\n    a\n  b")
    with pytest.raises(SyntaxError, match="unindent"):
        parse_block("\n \f  a\n \fb")


def test_blocks_without_code_are_empty() -> None:
    for text in ("", "  ", "# nothing\n", "\n\n  # nothing\n  "):
        assert parse_block(text).body == []
        assert facts_of(text).empty


# Values and variables


@every(
    ("text", "value"),
    [
        ("1 + 1", 2),
        ("x = 3; x * 2", 6),
        ("x = 3", None),
        ("", None),
        ("# nothing\n", None),
        ("return 5\n1", 5),
        ("import math\nmath.floor(2.5)", 2),
        ("def f(n): return n and n + f(n - 1)\nf(3)", 6),
        ("class C:\n  x = 1\nC.x", 1),
        ("[y := 4 for _ in (1,)]; y", 4),
        ("(lambda *a, **k: (a, k))(1, b=2)", ((1,), {"b": 2})),
        ("def g():\n  yield 1\nlist(g())", [1]),
        ("robot", "the robot"),
        ("print = 1; print", 1),
    ],
)
def test_the_value_of_a_block_is_that_of_its_last_expression(text: str, value: object) -> None:
    assert run(text)[0] == value


@every(
    ("text", "after"),
    [
        ("v = 2", 2),
        ("v += 2", 3),
        ("v: int = 2", 2),
        ("v: int", 1),
        ("if v: v: int = 2", 2),
        ("(v): int = 2", 2),
        ("w: int = 2", 1),
        ("class C:\n  v: int = 2", 1),
        ("def f():\n  v: int = 2\nf()", 1),
        ("[v := 2 for _ in (1,)]", 2),
        ("[v for v in (2,)]", 1),
        ("def f():\n  nonlocal v; v = 2\nf()", 2),
        ("def f():\n  v = 2\nf()", 1),
        ("for v in (1, 2): pass", 2),
        ("import math as v\nv = v.floor(2.5)", 2),
        ("def v(): pass\nv = 2", 2),
        ("match 2:\n  case v: pass", 2),
        ("nonlocal v\nv = 2", 2),
    ],
)
def test_a_block_assigns_variables_by_plain_name(text: str, after: int) -> None:
    assert run(text, v=1)[1] == {"v": after}


def test_names_of_the_namespace_are_visible_and_nothing_is_written_into_it() -> None:
    namespace = {"double": lambda number: 2 * number}
    assert run("x = double(v)\nx", namespace, v=4)[0] == 8
    assert namespace.keys() == {"double"}


def test_a_variable_wins_over_a_name_of_the_namespace() -> None:
    assert run("v", {"v": 1}, v=2)[0] == 2


def test_a_block_has_a_cell_only_for_the_names_it_uses() -> None:
    code = compile_block(Block("a + len('b')"), ["a", "b"], "<test>")
    assert code.co_freevars == ("a",)
    assert (code.co_name, code.co_qualname) == ("block", "block")


def test_a_deleted_variable_is_unset() -> None:
    cells = {"v": CellType(1)}
    bind(compile_block(Block("del v"), ["v"], "<test>"), {}, cells)()
    with pytest.raises(ValueError, match="empty"):
        _ = cells["v"].cell_contents


def test_python_does_not_warn_of_a_block() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert run(r"'\d' is 1")[0] is False


def test_functions_and_classes_of_a_block_have_no_names_of_ours() -> None:
    text = "class C:\n  def f(self): pass\n  text = 'outer.<locals>.block'\n"
    value, _ = run(text + "(C.f.__qualname__, C.__qualname__, C.text)")
    assert value == ("block.<locals>.C.f", "block.<locals>.C", "outer.<locals>.block")
    assert run("def f(): return 'outer.<locals>.x'\n(f.__qualname__, f())")[0] == (
        "block.<locals>.f",
        "outer.<locals>.x",
    )


# Places


@every(
    ("text", "line", "caret"),
    [
        ("1 / é", 3, "1 / é"),
        (" 'ß😀', 1 / é", 3, "1 / é"),
        ("x = 1\n              1 /  é", 4, "1 /  é"),
        ("x = 1\r\n    'ß', 1 /  é", 4, "1 /  é"),
        ("\n  x = 1; 'ß', 1 / é", 4, "1 / é"),
        ("if True:\n\tx = 'ß', [1 / é]", 4, "1 / é"),
        ("def f(): return 'ß', 1 / é\nf()", 3, "1 / é"),
        ("\n  def f():\n    return 1 / é\n  f()", 5, "1 / é"),
        ("['ß', [1 / é for _ in (1,)]]", 3, "1 / é"),
    ],
)
def test_a_traceback_shows_line_and_column_of_the_text(text: str, line: int, caret: str) -> None:
    source = f"(var é := [0])\n(machine m\n  (state 'ß' (running [{text}])))".replace("'ß' (", "ß (", 1)
    code = compile_block(block_in(source), ["é"], "program.lrp")
    with pytest.raises(ZeroDivisionError) as caught:
        bind(code, {}, {"é": CellType(0)})()
    frame = traceback.extract_tb(caught.value.__traceback__)[-1]
    assert (frame.filename, frame.lineno, frame.end_lineno) == ("program.lrp", line, line)
    row = source.replace("\r\n", "\n").split("\n")[line - 1].encode()
    assert row[frame.colno : frame.end_colno].decode() == caret


def test_the_same_block_in_another_line_is_compiled_for_that_line() -> None:
    first, second = (compile_block(Block("1/0", line=line), [], "a.lrp") for line in (3, 30))
    assert (first.co_firstlineno, second.co_firstlineno) == (3, 30)


# Faults


@every(
    ("text", "at", "word"),
    [
        ("a +", "+", "Something is missing after `+`"),
        ("a = yield", "yield", "`yield`"),
        ("await a", "await", "`await`"),
        ("yield from a", "yield", "`yield`"),
        ("def f(a=(yield)): pass", "yield", "`yield`"),
        ("def f(a, *, b: (yield)): pass", "yield", "`yield`"),
        ("def f() -> (yield): pass", "yield", "`yield`"),
        ("@(yield)\ndef f(): pass", "yield", "`yield`"),
        ("@(yield)\nclass C: pass", "yield", "`yield`"),
        ("lambda a=(yield): a", "yield", "`yield`"),
        ("class C:\n  x = [(await a) for a in b]", "await", "`await`"),
        ("[a async for a in b]", "[a", "outside of an asynchronous function"),
        ("é = 1; break", "break", "`break` works only in"),
        ("\n  a = 1\n  ö = (1", "(1", "`(` is not closed"),
        ("\n  é, (1 = 2)", "= 2", "Only a name can be assigned"),
        ("def f(a, a): pass", "a): pass", "Two parameters have the name `a`"),
        ("x = '\0'", "\0'", "does not know this character"),
        ("\nx = '\ud800'", "\ud800'", "does not know this character"),
        ("x" + ".y" * 100_000, "x", "nested too deeply"),
        ("x" + " + 1" * 500, "x", "nested too deeply"),
        ("if x: pass\n" + "elif x: pass\n" * 100, "if", "nested too deeply"),
        ("(" * 300, "(", "nested too deeply"),
        ("from math import *", "*", "import *"),
    ],
)
def test_a_fault_of_a_block_is_at_its_token(text: str, at: str, word: str) -> None:
    assert not facts_of(text).valid
    fault = faults_of(text)[0]
    assert word in fault.message
    assert text[fault.start :].startswith(at)
    assert fault.start <= fault.end <= len(text)


def test_yield_and_await_are_fine_inside_a_function() -> None:
    assert facts_of("async def f(): await a\ndef g(): yield\nlambda: (yield)").valid


def test_a_nonlocal_whose_variable_is_gone_is_known_only_when_compiled() -> None:
    text = "\ndef f():\n  nonlocal gone; gone = 1"
    assert facts_of(text).valid
    with pytest.raises(SyntaxError, match="gone") as caught:
        compile_block(Block(text, line=7), ["a"], "a.lrp")
    assert (caught.value.filename, caught.value.lineno) == ("a.lrp", 9)


# Names


def names(text: str) -> list[tuple[str, int]]:
    found = [(name, start - 1, end - 1) for name, (start, end), *_ in block_names(Block(text))]
    for name, start, end in found:
        assert text[start:end] == name
    return [(name, start) for name, start, _ in found]


@every(
    "text",
    [
        "«w» = «v»",
        "\n    «w» = 'é'; «v»\n    «ß» = «v»",
        "f'{«v»}' 'a' f'''{\n«v» !r:{«v»}}''' # f'{v}'",
        "f'{«v» = }' f'{«v» == 1} {«v»:>{«v»}}' rf'\\{«v»}'",
        "f'{[v for v in «v»]}' f'{f\"{«v»}\"}'",
        "def «f»(v, *, w=«v»): return v, «x»",
        "def «f»(*v, **w) -> «v»: return v, w",
        "def «f»():\n  nonlocal «v», «w»\n  «v» = «w»",
        "def «f»():\n  global g\n  return g, «v»",
        "lambda v: v + «w»",
        "[v for v in «v» if v for w in v]",
        "{v: w for v, w in «v»}, {v for v in «v»}, (v for v in «v»)",
        "[(«v» := w) for w in «x»]",
        "class «C»(«v»):\n  v = 1\n  w = v\n  def f(self): return «v»",
        "@«v»\nclass «C»: pass",
        "@«v»\nasync def «f»(): pass",
        "import «v»",
        "import «v».path",
        "import os.path as «v»",
        "from os import path, sep as «v»".replace("path,", "«path»,"),
        "try: «v»()\nexcept (ValueError, TypeError) as «v»: «v»".replace(
            "(ValueError, TypeError)", "(«ValueError», «TypeError»)"
        ),
        "try: pass\nexcept: pass",
        "match «v»:\n  case [«x», *«y»]: pass\n  case {'k': «a», **«b»}: pass\n  case 1 as «c»: pass",
        "match «v»:\n  case {**«b»}: pass\n  case [*_]: pass\n  case {}: pass\n  case _: pass",
        "with «v» as «w»: pass",
        "('a' # it's ]\n f'{«v»}' '{')",
        "import os as «o», sys as «s»",
        "«f»(v=«v»).v['v']",
    ],
)
def test_every_name_of_a_block_is_found_at_its_place(text: str) -> None:
    expected = []
    plain = ""
    for index, part in enumerate(text.replace("«", "»").split("»")):
        if index % 2:
            expected.append((part, len(plain)))
        plain += part
    assert names(plain) == expected


def test_a_block_nested_as_deeply_as_may_be_is_read_by_all() -> None:
    block = Block("x" + " + 1" * (DEEPEST - 5))
    assert facts_of(block.text).valid
    assert [place.name for place in block_names(block)] == ["x"]
    assert block.meaning
    assert run(block.text, x=0)[0] == DEEPEST - 5


def test_words_are_those_of_code() -> None:
    assert list(words("a # b\n'c' d", 0)) == [(0, "a"), (10, "d")]


def test_a_name_is_read_called_or_bound_and_its_member_is_compared() -> None:
    text = (
        "é = 'x'; m.state == 'a' != m.b; f(m . # .c\n c, f'{m.state in (\"b\", 1)!r}'); "
        "r'd' == m.state\nmatch m.state:\n  case 'e' | 'f' as g: pass"
    )
    places = block_names(Block(text))
    assert {place.name for place in places if not place.computed} == {"é", "f", "g"}
    written = " " + text
    members = [place.member for place in places if place.member]
    assert [(member.name, written[slice(*member.span)]) for member in members] == [
        *(("state", "state"), ("b", "b"), ("c", "c"), ("state", "state"), ("state", "state")),
        ("state", "state"),
    ]
    compared = [[(string, written[slice(*span)]) for string, span in member.strings] for member in members]
    assert compared == [[("a", "a")], [("a", "a")], [], [("b", "b")], [], [("e", "e"), ("f", "f")]]


def test_names_are_known_by_what_is_done_with_them() -> None:
    text = "a = b; c += 1\ndef f():\n  d = 1\n  [e for e in d]\nimport os.path"
    block, found, _ = read(text).uses
    own = [use for use in found if use.owner is block]
    assert {use.name for use in own if use.writes} == {"a", "c", "f", "os"}
    assert {use.name for use in own if not use.writes} == {"b"}
    assert {use.name for use in found} - {use.name for use in own} == {"d", "e"}
    assert [place.imported for place in block_names(Block(text)) if place.imported] == ["os.path"]


def test_a_name_in_another_form_of_the_same_letters_is_the_same_name() -> None:
    assert [place[:3] for place in block_names(Block("\ufb01n"))] == [("fin", (1, 3), "")]


# -- speed -------------------------------------------------------------------------------------------


SIMPLE = [
    "robot.light.data > 5 and left5",
    "turn = left * speed\nrobot.move(angular=turn, linear=1)",
    "f(**a, **b)",
    "f(a=1, a=2)",
    "x += {1: [2], **c}[a:b, 3]",
    "(a, b)[0].c = [c, d] = not -e",
    "if a == 1:\n  pass\nelse:\n  b",
    "__debug__ = 1",
    "x.__debug__ = 1",
    "f(__debug__=1)",
    "__d\uff45bug__ = 1",
    "*a",
    "a = *b",
    "del a",
    "break",
    "if a:\n  continue",
    "a: int = 4\nglobal a",
    "[a for a in b if (a := 1)]",
]


@every("text", SIMPLE)
def test_a_block_that_needs_no_compiler_to_be_judged_compiles(text):
    tree, suite = parse_suite(text)
    if blocks._is_simple(tree, suite.source(text)):
        blocks._check(text, frozenset())
        assert facts_of(text).valid


def test_only_what_is_plain_needs_no_compiler_to_be_judged():
    simple = [
        blocks._is_simple(tree, suite.source(text)) for text in SIMPLE for tree, suite in [parse_suite(text)]
    ]
    assert simple == [True] * 3 + [False] + [True] * 3 + [False] * (len(SIMPLE) - 7)


def test_parser_names_and_checks_share_one_reading_of_a_block(monkeypatch):
    text = "shared = 'one reading' and other"
    read = []

    def counted(text, original=blocks.parse_suite):
        read.append(text)
        return original(text)

    monkeypatch.setattr(blocks, "parse_suite", counted)
    assert facts_of(text).valid
    assert [place.name for place in block_names(Block(text))] == ["shared", "other"]
    assert facts.facts_of(text).binds.keys() == {"shared"}
    assert read == [text]
    compile_block(Block(text), ("shared",), "f")
    assert read == [text, text]  # the compiler gets a tree of its own, which it changes


def test_trees_of_long_blocks_are_not_kept():
    text = "kept = 1\n" * 100
    assert len(text) > blocks.SHORT
    assert blocks.read(text).tree is not blocks.read(text).tree
    assert blocks.read("kept = 1").tree is blocks.read("kept = 1").tree


class Counted(str):
    """A text that counts how many of its characters are copied."""

    copied = 0

    def __getitem__(self, key):
        part = super().__getitem__(key)
        Counted.copied += len(part)
        return part


@every("unit", ["x=1;", "é=1;"])
def test_finding_the_places_of_one_long_line_costs_as_much_as_the_line_is_long(unit):
    source = Counted(unit * 500 + "\n")
    tree = ast.parse(str(source))
    Counted.copied = 0
    offsets = Offsets(source)
    places = [(offsets.start_of(node), offsets.end_of(node)) for node in tree.body]
    assert Counted.copied <= len(source)
    assert places == [(4 * n, 4 * n + 3) for n in range(500)]


COMPUTED = {
    "near": True,
    "(lambda near=near: near)()": True,
    "[near for near in [near]]": [True],
    "[x for x in [1] if near]": [1],
    "f'{near!r}'": "True",
    "(lambda near: near)(3)": 3,
    "near()": "called",
    "move.state": "machine",
    "(lambda: move.state)()": "machine",
}


@every("source", list(COMPUTED))
def test_a_name_is_computed_where_a_block_reads_it_and_not_where_it_is_another(source: str) -> None:
    code = compile_block(Block(source), (), "<lrp>", "b", frozenset({"near"}), frozenset({"move"}))
    machine = type("Machine", (), {"state": "machine"})
    cells = {"near()": CellType(lambda: True), "move.": CellType(lambda: machine)}
    assert bind(code, {"near": lambda: "called"}, cells)() == COMPUTED[source]
