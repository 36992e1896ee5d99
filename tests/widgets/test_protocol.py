import ast
import re
import struct
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lrp_jupyter.widgets import protocol

PYTHON = Path(protocol.__file__).parent
TYPESCRIPT = Path(__file__).parents[2] / "js" / "src"
FILES = ("nouns", "protocol")
SIMPLE = {"str": "string", "int": "number", "float": "number", "bool": "boolean", "None": "null"}


def as_typescript(node: ast.expr) -> str:
    match node:
        case ast.Constant(value=None):
            return "null"
        case ast.Constant(value=str() as word):
            return f'"{word}"'
        case ast.Name(id=name):
            return SIMPLE.get(name, name)
        case ast.BinOp(left=left, right=right):
            return f"{as_typescript(left)} | {as_typescript(right)}"
        case ast.Subscript(value=ast.Name(id="Literal"), slice=ast.Tuple(elts=words)):
            return " | ".join(map(as_typescript, words))
        case ast.Subscript(value=ast.Name(id="Literal"), slice=word):
            return as_typescript(word)
        case ast.Subscript(value=ast.Name(id="list"), slice=item):
            return f"{as_typescript(item)}[]"
        case ast.Subscript(value=ast.Name(id="dict"), slice=ast.Tuple(elts=[_, item])):
            return f"Record<string, {as_typescript(item)}>"
        case ast.Subscript(value=ast.Name(id="tuple"), slice=ast.Tuple(elts=items)):
            return f"[{', '.join(map(as_typescript, items))}]"
    raise AssertionError(f"no TypeScript for {ast.unparse(node)}")


def field(statement: ast.AnnAssign) -> tuple[str, str]:
    name = ast.unparse(statement.target)
    match statement.annotation:
        case ast.Subscript(value=ast.Name(id="NotRequired"), slice=inner):
            return f"{name}?", as_typescript(inner)
        case plain:
            return name, as_typescript(plain)


def python_nodes() -> Iterator[ast.stmt]:
    for name in FILES:
        yield from ast.parse((PYTHON / f"{name}.py").read_text()).body


def python_types() -> dict[str, object]:
    found: dict[str, object] = {}
    for node in python_nodes():
        match node:
            case ast.ClassDef(name=name, bases=[ast.Name(id="TypedDict")], body=body):
                found[name] = dict(field(line) for line in body if isinstance(line, ast.AnnAssign))
            case ast.Assign(targets=[ast.Name(id=name)], value=value) if (
                name[0].isupper() and name != "Layout"
            ):
                found[name] = as_typescript(value)
    return found


def typescript_types() -> dict[str, object]:
    files = "\n".join((TYPESCRIPT / f"{name}.ts").read_text() for name in FILES)
    text = re.sub(r"/\*.*?\*/", "", files, flags=re.S)
    found: dict[str, object] = {}
    for name, body in re.findall(r"export interface (\w+) \{(.*?)\n\}", text, re.S):
        found[name] = dict(re.findall(r"^  (\w+\??): (.*);$", body, re.M))
    for name, body in re.findall(r"export type (\w+) =(.*?);\n", text, re.S):
        if name != "Layout":
            found[name] = " ".join(body.split()).removeprefix("| ")
    return found


def test_python_and_typescript_name_the_same_messages_with_the_same_fields():
    python, typescript = python_types(), typescript_types()
    assert len(python) > 50
    assert python.keys() == typescript.keys()
    for name, fields in python.items():
        assert fields == typescript[name], name


def test_every_class_is_explained():
    for node in python_nodes():
        if isinstance(node, ast.ClassDef):
            assert ast.get_docstring(node), node.name


@given(st.text(alphabet="ab \n\r𝄞é"), st.data())
def test_offsets_survive_the_way_to_lines_and_back(text, data):
    start = data.draw(st.integers(0, len(text)))
    end = data.draw(st.integers(start, len(text)))
    there = protocol.range_of(text, start, end)
    assert protocol.offset_of(text, there["line"], there["column"]) == start
    assert protocol.offset_of(text, there["end_line"], there["end_column"]) == end


def test_columns_count_characters_outside_the_basic_plane_once():
    assert protocol.range_of("𝄞𝄞x", 2, 3) == {"line": 1, "column": 3, "end_line": 1, "end_column": 4}


def test_a_place_behind_the_text_is_its_end():
    assert protocol.offset_of("ab\ncd", 9, 1) == 5
    assert protocol.offset_of("ab\ncd", 2, 99) == 5


def test_the_poses_of_one_robot_take_36_bytes():
    robot = (0.5, 1.0, 0.25, True, True, 0.125, [128.0], [float("inf")])
    buffer = protocol.pack_poses(7.5, [robot])
    assert len(buffer) == 36
    assert struct.unpack("<d7f", buffer) == (7.5, 0.5, 1.0, 0.25, 3.0, 0.125, 128.0, float("inf"))


@pytest.mark.parametrize(("bumper", "pen", "flags"), [(True, False, 1.0), (False, True, 2.0)])
def test_bumper_and_pen_are_bits_of_their_own(bumper, pen, flags):
    buffer = protocol.pack_poses(0.0, [(0, 0, 0, bumper, pen, 0, [], [])])
    assert struct.unpack("<d5f", buffer)[4] == flags


def test_pushed_solids_follow_the_robots():
    buffer = protocol.pack_poses(0.0, [(0, 0, 0, False, False, 0, [], [])], [(1, 2, 0.5)])
    assert struct.unpack("<d8f", buffer)[-3:] == (1, 2, 0.5)
