from __future__ import annotations

from hypothesis import given
from programs import programs

from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.printer import to_source
from lrp_jupyter.language.program import Program


@given(programs)
def test_a_printed_program_reads_as_the_same_program(program: Program) -> None:
    assert parse(to_source(program)) == program


@given(programs)
def test_printing_a_printed_program_changes_nothing(program: Program) -> None:
    source = to_source(program)
    assert to_source(parse(source)) == source
