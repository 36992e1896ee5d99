"""What a newcomer reads: the examples of public docstrings work, and internal members are not listed."""

import doctest
import inspect
import pydoc

import pytest
from support.tables import every

import lrp_jupyter

WITH_EXAMPLES = [
    name for name in lrp_jupyter.__all__ if ">>>" in (inspect.getdoc(getattr(lrp_jupyter, name)) or "")
]


@pytest.mark.slow
@every("name", WITH_EXAMPLES)
def test_the_examples_of_a_docstring_work(name):
    public = getattr(lrp_jupyter, name)
    module = inspect.getmodule(public)
    found = doctest.DocTestFinder(recurse=False).find(public, name, globs=dict(vars(module)))
    runner = doctest.DocTestRunner()
    for each in found:
        runner.run(each)
    assert runner.summarize().attempted
    assert not runner.summarize().failed


def test_what_newcomers_call_first_has_an_example():
    assert {"Session", "Frame", "Interpreter", "VirtualClock", "check", "diff", "parse", "to_source"} <= set(
        WITH_EXAMPLES
    )


@every("name", lrp_jupyter.__all__)
def test_every_public_name_has_help(name):
    assert inspect.getdoc(getattr(lrp_jupyter, name))


def test_the_help_of_a_session_lists_no_internal_members():
    text = pydoc.render_doc(lrp_jupyter.Session, renderer=pydoc.plaintext)
    assert "set_variable(" in text
    assert "from_file(" in text
    for internal in ("submit(", "ask(", "Driver", "Loop"):
        assert f" |  {internal}" not in text
