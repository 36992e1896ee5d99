from __future__ import annotations

import pytest
from hypothesis import given
from programs import programs

from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.printer import to_source
from lrp_jupyter.language.program import Block, Program


@pytest.mark.slow
@given(programs)
def test_a_printed_program_reads_as_the_same_program_and_is_printed_as_before(program: Program) -> None:
    source = to_source(program)
    assert parse(source) == program
    assert to_source(parse(source)) == source


def test_a_block_that_is_not_python_is_printed_to_the_letter() -> None:
    assert to_source(Program(onpause=(Block("1 +\n  2 +"),))) == "(onpause [1 +\n  2 +])\n"


def test_a_block_is_laid_out_below_its_first_line() -> None:
    text = "(machine m (state s (running [  a = 1\n # so\n b = '''\n x'''  ] [\nfor i in a:\n  print(i)\n])))"
    assert (
        to_source(parse(text))
        == """\
(machine m
  (state s
    (running [a = 1
              # so
              b = '''
 x''']
      [
        for i in a:
          print(i)])))
"""
    )


def test_items_that_fit_are_in_one_line() -> None:
    text = "(machine m (state s (onentry (spawn n a) [b] (spawn o c))))"
    assert "    (onentry (spawn n a) [b] (spawn o c))" in to_source(parse(text))
    long = parse(text.replace("b", "b" * 80))
    assert parse(to_source(long)) == long
    assert max(map(len, to_source(long).splitlines())) < 100
