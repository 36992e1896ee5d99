"""What a debugger finds at an issue: the place of the fault, and all that is in scope there."""

import gc
import pdb
import weakref
from io import StringIO

from interpreter.test_issues import OF_EVERY_KIND
from support.story import started
from support.tables import every

from lrp_jupyter.language.parser import parse

NESTED = """(var p := [6])
(machine m (var q := [{}])
  (state a (onentry (spawn k s) [state])
    (machine k (var r := [[1, 2]])
      (state s (running [x = 3
                         deep(lambda y: helper(y, x))]))
      (on far s -> s)))
  (event far [later]))
(var own := [0])
(spawn m a)"""


def helper(p, x):
    raise ValueError(p, x)


def run(i, issue, typed):
    """Debug an issue with Python's own debugger; return what it prints, without the prompts."""
    shown = StringIO()
    debugger = pdb.Pdb(stdin=StringIO(typed), stdout=shown)
    debugger.reset()
    debugger.interaction(None, i.traceback_of(issue, i.assign))
    return shown.getvalue().replace("(Pdb) ", "")


@every("text", OF_EVERY_KIND)
def test_everything_in_scope_is_seen_at_an_issue_of_any_kind(text):
    i = started(f"(var seen := [5]){text}(var later := [robot])", 2)
    for issue in i.issues:
        trace = i.traceback_of(issue, i.assign)
        while trace.tb_next is not None:
            trace = trace.tb_next
        frame = trace.tb_frame
        assert (frame.f_code.co_filename, trace.tb_lineno, frame.f_lineno) == ("<lrp>", *[issue.line] * 2)
        expected = {} if issue.kind == "defined twice" else {"seen": 5}
        assert {**expected, **frame.f_locals} == dict(frame.f_locals)


def test_each_frame_has_its_own_names_and_behind_them_those_of_the_program():
    names = {"deep": lambda call: call("y"), "helper": helper}
    i = started(NESTED, 2, namespace=names)
    unknown, fault, state = (
        next(issue for issue in i.issues if word in issue.message)
        for word in ("later", "ValueError", "`state`")
    )
    shown = run(i, fault, "p p, x, q, state\nu\np y, x, p, q, r, own, state\nu\np call\nu\np x, p\nq\n")
    assert "('y', 3, {}, 'm/a/k/s')\n" in shown
    assert "('y', 3, 6, {}, [1, 2], 0, 'm/a/k/s')\n" in shown
    assert "(3, 6)\n" in shown
    assert "r" not in dict(i.traceback_of(unknown, i.assign).tb_frame.f_locals)
    assert run(i, unknown, "p q, state\nq\n").endswith("({}, 'm/a/k/s')\n"), "the state that tests it"
    assert run(i, state, "p state\nq\n").endswith("'m/a'\n")


def test_what_a_debugger_assigns_is_an_assignment_between_two_ticks():
    i = started("(var p := [0]) (var q := [1]) (machine m (state a (running [1 / p])))(spawn m a)", 2)
    assert run(i, i.issues[0], "!q += 4\n!state = q\np state\nq\n").endswith("5\n")
    assert i.variables["q"] == 5
    i.step(0.2)
    assert i.variables["q"] == 5
    i.rewind(1)
    assert i.variables["q"] == 1, "it came after that tick"
    assert "not a variable that exists now" in run(i, i.issues[0], "!robot = 1\nq\n")


def test_a_variable_is_gone_with_its_machine_but_its_last_value_is_seen():
    i = started(
        "(machine m (state a (onentry (spawn k s)) (machine k (var r := [1]) (state s (onexit [1 / 0]))))"
        "(state b) (eps a -> b))(spawn m a)",
        2,
    )
    assert run(i, i.issues[0], "p r, state\nq\n").endswith("(1, 'm/a/k/s')\n")
    assert "`r` is not a variable that exists now" in run(i, i.issues[0], "!r = 2\nq\n")


def test_the_line_moves_with_the_text():
    text = "(var p := [7])\n(machine m (state a (running [x = 1\n  x / 0])))(spawn m a)"
    i = started(text, 2)
    i.patch(parse("\n\n" + text))
    assert run(i, i.issues[0], "p p, x\nq\n").startswith("> <lrp>(5)a.running()\n-> x / 0")


def test_one_exception_is_kept_of_an_issue_and_none_after_it_is_cleared():
    class FaultError(Exception):
        pass

    alive = weakref.WeakSet()

    def fail():
        error = FaultError()
        alive.add(error)
        raise error

    i = started("(machine m (state a (running [fail()])))(spawn m a)", 20, namespace={"fail": fail})
    gc.collect()
    assert len(alive) == 1
    assert i.traceback_of(i.issues[0], i.assign) is not None
    (issue,) = i.issues
    i.issues.clear()
    gc.collect()
    assert (len(alive), i.traceback_of(issue, i.assign)) == (0, None)
