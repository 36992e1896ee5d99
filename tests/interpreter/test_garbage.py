"""What an edit leaves behind: nothing for the garbage collector, which stops the loop, and little else."""

import gc
import weakref

import pytest

from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.interpreter.linker import link
from lrp_jupyter.language.checks import check
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.resolution import resolve

MACHINES = 10
TEXT = "(var speed := [0]) (machine part (var w := [1]) (state x) (state y) (ontime 100 x -> y))\n"
TEXT += "\n".join(
    f"(machine m{n} (var v := [0]) (var f := [lambda: elapsed + v]) (event e [v > 3])\n"
    f" (state a (running [v = v + 1]) (onentry (spawn inner x))\n"
    f"  (machine inner (state x) (exit eps x -> b)))\n"
    f" (state b (onentry (spawn missing b) (spawn part x (var w := [v]))) (onexit [v = elapsed + f()]))\n"
    f" (on part.y for 200 b -> a (effect [v = part.w])) (on [e and dt > 5 or part.state == 'z'] * -> a)\n"
    f" (on e a -> b) (ontime 100 b -> a))\n(spawn m{n} a)"
    for n in range(MACHINES)
)


def edited(number):
    return TEXT.replace("speed := [0]", f"speed := [{number}]")


@pytest.fixture
def no_collections():
    gc.collect()
    gc.disable()
    yield
    gc.enable()


def edit(interpreter, number):
    """Do what a session does for a keystroke; a tick follows."""
    program = parse(edited(number))
    check(program)
    link(program)
    assert interpreter.patch(program).applied
    interpreter.step(interpreter.now + 0.1)


@pytest.mark.slow
@pytest.mark.usefixtures("no_collections")
def test_a_replaced_program_is_gone_without_a_collection():
    i = Interpreter(parse(edited(1)))
    i.step(0.0)
    for number in range(2, 5):
        edit(i, number)
    gc.collect()
    old = [weakref.ref(i.program), weakref.ref(resolve(i.program))]
    for number in range(5, 8):
        edit(i, number)
    assert [ref() for ref in old] == [None, None]
    assert gc.collect() < 100


@pytest.mark.slow
def test_the_journal_keeps_the_text_of_earlier_programs_and_not_their_objects():
    i = Interpreter(parse(edited(1)))
    i.step(0.0)
    for number in range(8):
        edit(i, number)
    gc.collect()
    before = len(gc.get_objects())
    for number in range(8, 20):
        edit(i, number)
    gc.collect()
    assert len(gc.get_objects()) - before < 12 * 300  # a program and its plan have some 2,000
    i.rewind(11)
    assert i.program.text == edited(8)
    assert i.program == parse(edited(8))
    i.rewind(5)
    i.step(i.now + 0.1)
    assert i.program.text == edited(3)


@pytest.mark.slow
def test_after_the_last_edit_that_the_journal_keeps_nothing_grows():
    i = Interpreter(parse(edited(1)), journal=12)
    i.step(0.0)
    for number in range(18):
        edit(i, number)
    gc.collect()
    before = len(gc.get_objects())
    for number in range(18):  # the same blocks again: what is known of their texts stays
        edit(i, number)
    gc.collect()
    assert len(gc.get_objects()) - before < 100
