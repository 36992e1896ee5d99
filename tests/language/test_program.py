"""The nouns: places in the text, and what they are beyond values."""

import pickle

from support.tables import every

from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Block, Element, Name, Span

TEXT = "(var é := [1])\r\n(machine ü (state a (running [1 / 0])))\r(spawn ü a)\n"


@every("word", ["é", "(machine", "1 / 0", "(spawn", "a)\n"])
def test_a_place_is_a_line_and_a_column_in_characters(word):
    offset = TEXT.index(word)
    lines = TEXT.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    line, column = parse(TEXT).place(offset)
    assert lines[line - 1][column - 1 :].startswith(word.strip())


@every(
    ("text", "name"),
    [
        ("(machine a (state s)) (machine b (state s)) (spawn b s) (spawn a s)", "b"),
        ("(spawn gone s) (machine a (state s)) (machine b (state s))", "a"),
        ("(var n := [1])", ""),
    ],
)
def test_the_main_machine_is_the_one_that_is_spawned_first(text, name):
    assert parse(text).main == name


def test_compiled_code_counts_columns_in_bytes_and_a_program_in_characters():
    program = parse(TEXT)
    assert program.place_of_bytes(1, 0) == (1, 1)
    assert program.place_of_bytes(1, len(b"(var \xc3\xa9 ")) == (1, 8)
    assert program.place_of_bytes(2, len("(machine ü (".encode())) == (2, 13)
    assert program.place_of_bytes(4, 50) == (4, 1), "behind the end"
    assert program.place_of_bytes(5, 0) is None


def test_a_program_survives_pickling_with_its_places():
    program = parse(TEXT)
    copy = pickle.loads(pickle.dumps(program))
    assert copy == program
    assert (copy.machines[0].name, copy.machines[0].name.span) == ("ü", Span(25, 26))
    assert (copy.text, copy.place(30)) == (program.text, program.place(30))


def test_a_name_is_a_string_that_knows_its_place():
    name = Name("a", Span(3, 4))
    assert (name == "a", hash(name) == hash("a"), name.span) == (True, True, (3, 4))


def test_a_block_is_equal_to_nothing_but_a_block_that_means_the_same():
    assert Block("a+1") == Block(" a + 1 # a comment\n")
    assert hash(Block("a+1")) == hash(Block(" a + 1"))
    assert Block("a+1") != Block("a+2")
    assert Block("a+1") != "a+1"


def test_a_block_put_together_by_hand_that_is_not_python_means_its_text():
    assert Block("a +") == Block("a +")
    assert Block("a +") != Block("a  +")
    assert Block("a +").meaning == "a +"


def test_elements_read_as_words():
    assert str(Element("state", ("m", "a"))) == "state `m/a`"
    assert str(Element("onpause", ())) == "onpause"


@every("noun", [parse(TEXT), parse(TEXT).machines[0]])
def test_a_program_and_a_machine_show_themselves(noun):
    shown = noun._repr_mimebundle_()
    assert "ü" in shown["text/plain"]
