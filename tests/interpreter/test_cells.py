import dis

from hypothesis import given
from support.wild import program

from lrp_jupyter.interpreter.cells import writes_of
from lrp_jupyter.interpreter.linker import BlockPlan, link
from lrp_jupyter.language.blocks.block import compile_block
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Block


def writes(text, names="abc"):
    own, inner = writes_of(compile_block(Block(text), frozenset(names), "<test>"))
    return "".join(own), "".join(sorted(inner))


def test_a_block_writes_what_it_assigns_in_whatever_way():
    assert writes("a = 1") == ("a", "")
    assert writes("a + b") == ("", "")
    assert writes("for a in b: pass") == ("a", "")
    assert writes("(a := b)") == ("a", "")
    assert writes("del a") == ("a", "")
    assert writes("import os as a") == ("a", "")
    assert writes("try: pass\nexcept E as a: pass") == ("a", "")
    assert writes("x = 1; a, (b, *c) = x") == ("abc", "")
    assert writes("a.x = 1; b[0] = 2") == ("", "")


def test_what_a_function_in_a_block_writes_is_distinguished():
    assert writes("def f():\n  nonlocal a\n  a = 1\nb = f") == ("b", "a")
    assert writes("def f():\n  def g():\n    nonlocal a\n    a = 1") == ("", "a")
    assert writes("def f():\n  a = 1\n  def g():\n    nonlocal a\n    a = 2") == ("", "")
    assert writes("class A:\n  nonlocal b\n  b = 1") == ("", "b")
    assert writes("f = lambda: a") == ("", "")


def test_a_block_with_more_variables_than_fit_into_one_byte():
    names = [f"v{number:03}" for number in range(300)]
    text = "; ".join(f"{name} = x" for name in names[150:])
    code = compile_block(Block("x = 1; print(" + ", ".join(names) + "); " + text), frozenset(names), "<test>")
    assert writes_of(code).own == tuple(names[150:])


@given(program)
def test_what_blocks_write_agrees_with_the_disassembler(text):
    for machine in link(parse(text)).machines.values():
        for state in machine.states.values():
            for plan in (*state.onentry, *state.running, *state.onexit):
                if isinstance(plan, BlockPlan):
                    code = plan.code
                    stores = {
                        step.argval
                        for step in dis.get_instructions(code)
                        if step.opname in ("STORE_DEREF", "DELETE_DEREF")
                    }
                    assert set(writes_of(code).own) == stores & set(code.co_freevars)
