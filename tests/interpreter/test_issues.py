"""The life of an issue: its location, its message, when it is resolved, and how edits affect it."""

import pytest
from support.story import active, started
from support.tables import every

from lrp_jupyter.language.parser import parse

OF_EVERY_KIND = [
    "(var bad := [1 / 0])(machine m (state a) (ontime bad a -> a))(spawn m a)",
    "(machine m (state a (running [\n def f():\n  nonlocal gone\n f()])))(spawn m a)",
    "(machine m (state a) (on nope a -> a))(spawn m a)",
    "(machine m (state a) (on [True] a -> nowhere))(spawn m a)",
    "(machine m (state a) (ontime nope a -> a))(spawn m a)",
    "(machine m (state a (onentry (spawn nope x))))(spawn m a)",
    "(machine m (state a (onentry (spawn n x)) (machine n)))(spawn m a)",
    "(machine m (state a (onentry (spawn n x)) (machine n (state x) (exit [True] x -> no))))(spawn m a)",
    "(machine m (state a))(spawn m a)(spawn m b)(spawn q b)",
    "(machine m (state a))(spawn m a)(spawn m a)",
    "(machine m (state a) (on [1] a -> a))(spawn m a)",
    "(machine m (state a (running [1 / 0])))(spawn m a)",
    "(machine m (state a) (state a))(spawn m a)",
]


def summary(i):
    return [(issue.code, issue.count, issue.resolved) for issue in i.issues]


def with_running(block):
    return f"(var n := [0])(machine m (state a (running [{block}])))(spawn m a)"


@every("end", ["", "\n", "\r\n", "\r"])
def test_columns_are_counted_in_characters_whatever_precedes_in_the_line(end):
    line = "  (machine é (state ß)) (machine m (state a (running ['ü'; 1 / 0])))(spawn m a) "
    text = f"(var é := [0]){end}{line}{end}"
    (issue,) = started(text, 2).issues
    assert (issue.line, issue.column) == parse(text).place(text.index("1 / 0"))
    source, carets = issue.traceback.splitlines()[2:4]
    assert source.strip().endswith(line.strip())
    assert carets.index("~") == source.index("1 / 0")


def test_half_a_character_in_the_line_of_a_fault_stops_nothing():
    i = started("(machine m (state a (running [1 / 0]))) ; \ud800\n(spawn m a)")
    assert summary(i) == [("LRP601", 1, False)]


def test_a_line_of_another_program_of_the_same_name_is_not_shown():
    one = started(with_running("1 / 0; one"))
    started(with_running("1 / 0; another"), 2)
    one.step(0.1)
    assert "1 / 0; one" in one.issues[0].traceback


def test_a_fault_in_a_function_of_an_older_text_is_located_at_the_block_that_calls_it():
    i = started("\n\n\n(var f := [\ndef f(): 1 / 0\nf])(machine m (state a))(spawn m a)", 2)
    i.patch(parse("(var f := [def f(): 1 / 0\nf])(machine m (on [f()] a -> a) (state a))(spawn m a)"))
    i.step(0.2)
    (issue,) = i.issues
    assert (issue.line, issue.element.kind) == (2, "transition")


@every(
    ("block", "code", "message"),
    [
        ("raise ValueError('first\\nsecond')", "LRP601", "ValueError: first"),
        ("\n e = KeyError('x')\n e.add_note('a note')\n raise e", "LRP601", "KeyError: 'x'"),
        ("eval('1 +')", "LRP601", "SyntaxError: invalid syntax"),
        ("raise NameError('by hand')", "LRP601", "NameError: by hand"),
        ("raise NameError", "LRP601", "NameError"),
        ("x = x + 1", "LRP606", "`x` has no value here. Assign one first, or declare `(var x := [value])`."),
        ("w += 1", "LRP606", "`w` has no value here."),
        ("\n def f(): print(y); y = 1\n f()", "LRP606", "`y` has no value here."),
        ("\n for i in (): pass\n print(i)", "LRP606", "`i` has no value here."),
        ("elsewhere()", "LRP601", "NameError: name 'missing' is not defined"),
        ("unbound()", "LRP601", "UnboundLocalError: cannot access local variable"),
        ("nope", "LRP606", "`nope` is not defined here."),
        ("eval('nope')", "LRP606", "`nope` is not known to `eval` or `exec`, which see no variable"),
        ("import sys; sys.exit('enough')", "LRP601", "SystemExit: enough"),
        ("\n class Odd(Exception): pass\n raise Odd", "LRP601", "block.<locals>.Odd"),
        ("\n def f(): f()\n f()", "LRP601", "RecursionError: "),
    ],
)
def test_the_message_is_the_kind_and_first_line_of_the_exception(block, code, message):
    def elsewhere():
        missing  # noqa: B018, F821

    def unbound():
        missing += 1  # noqa: F821, F841

    names = {"elsewhere": elsewhere, "unbound": unbound}
    (issue,) = started(with_running(block), 2, namespace=names).issues
    assert issue.code == code
    assert issue.message.startswith(message)


@every(
    ("how", "message"),
    [
        ("BridgeError('The cable: it is out.\\nLook.')", "The cable: it is out."),
        ("BridgeError", "lrp_jupyter.errors.BridgeError"),
        ("Mute", "<exception str() failed>"),
    ],
)
def test_what_this_package_raises_keeps_its_own_sentence(how, message):
    block = f"""
 from lrp_jupyter.errors import BridgeError
 class Mute(BridgeError):
  def __str__(self): 1 / 0
 raise {how}"""
    assert started(with_running(block), 2).issues[0].message == message


def test_an_exception_of_no_module_is_an_issue_too():
    i = started(with_running("raise type('Odd', (ValueError,), {})('because')"))
    assert summary(i) == [("LRP601", 1, False)]
    assert i.issues[0].message == "Odd"
    assert "raise type('Odd'" in i.issues[0].traceback


def test_what_ends_the_program_when_it_is_shown_is_an_issue():
    odd = "\n class Odd:\n  def __repr__(self): raise SystemExit\n Odd()"
    i = started(f"(machine m (state a) (on [{odd}] a -> a) (ontime [{odd}] a -> a))(spawn m a)", 2)
    assert [issue.code for issue in i.issues] == ["LRP602", "LRP607"]
    assert all("not a value of type `Odd`" in issue.message for issue in i.issues)


def test_an_issue_describes_its_last_occurrence():
    i = started(with_running("\n n += 1\n if n < 3: 1 / 0\n {}[n]"))
    assert i.issues[0].line == 3
    i.step(0.1)
    i.step(0.2)
    i.step(0.3)
    (issue,) = i.issues
    assert (issue.line, issue.message, issue.count) == (4, "KeyError: 4", 4)
    assert (issue.first_tick, issue.last_tick, issue.resolved) == (1, 4, False)
    assert "KeyError: 4" in issue.traceback


def test_an_issue_is_located_correctly_when_a_comment_in_its_block_moves_it():
    i = started(with_running("\n n\n 1 / 0"), 2)
    i.patch(parse(with_running("\n n # a comment\n # another\n 1 / 0")))
    i.step(0.2)
    (issue,) = i.issues
    assert (issue.line, issue.count, issue.first_tick) == (4, 3, 1)


@every("text", OF_EVERY_KIND)
def test_another_layout_ends_no_issue(text):
    i = started(text, 2, on_issue="pause")
    before = [(issue.message, issue.resolved) for issue in i.issues]
    assert before
    i.resume()
    i.patch(parse("; a comment\n" + text))
    assert [(issue.message, issue.resolved) for issue in i.issues] == before
    assert all(issue.line > 1 for issue in i.issues)
    assert not i.paused, "none of them has occurred"


@every("text", OF_EVERY_KIND)
def test_pause_on_issue_pauses_at_every_occurrence_and_at_nothing_else(text):
    i = started(text, 3)
    assert not i.paused
    i.on_issue = "pause"
    counts = [issue.count for issue in i.issues]
    for tick in range(3, 12):
        if tick == 8:
            i.reset()
        i.step(tick / 10)
        before, counts = counts, [issue.count for issue in i.issues]
        assert i.paused == (counts != before)
        i.resume()
        assert not i.paused


def test_a_second_definition_keeps_its_place_when_text_comes_between():
    i = started("(var n := [1])\n(var n := [2])")
    i.patch(parse("(var n := [1])\n\n\n(var n := [2])"))
    assert [(issue.line, issue.resolved) for issue in i.issues] == [(4, False)]


def test_every_kind_of_name_can_be_repeated():
    text = """(var n := [1]) (var n := [2]) (event e [True]) (event e [False])
    (machine m (event e [True]) (event e [False]) (state a (machine k) (machine k)) (state a) (state b)
      (on e a -> b))
    (machine m) (spawn m a)"""
    i = started(text, 2)
    assert [issue.element.kind for issue in i.issues] == [
        "variable",
        "event",
        "machine",
        "event",
        "state",
        "machine",
    ]
    assert (active(i), i.variables["n"]) == (["m/b"], 1)


def test_a_condition_that_is_true_for_numpy_ends_the_issue():
    numpy = pytest.importorskip("numpy")
    text = """(var n := [0])
      (machine m (state a) (on [n += 1; return 5 if n < 2 else np.bool_(0)] a -> a))(spawn m a)"""
    i = started(text, namespace={"np": numpy})
    assert summary(i) == [("LRP602", 1, False)]
    i.step(0.1)
    assert summary(i) == [("LRP602", 1, True)]


def test_a_condition_without_a_value_does_not_resolve_the_issue():
    text = "(var n := [0])(machine m (state a) (on [n += 1; return 5 if n == 1 else None] a -> a))(spawn m a)"
    i = started(text, 3)
    assert summary(i) == [("LRP602", 3, False)]


def test_issues_of_what_a_rewind_removes_are_resolved_and_the_others_go_back_with_the_text():
    i = started(with_running("1 / 0"), 2)
    i.patch(parse("(machine k (state x (running [nope])))(spawn k x)\n" + with_running("1 / 0")))
    i.step(0.2)
    assert [(issue.line, issue.resolved) for issue in i.issues] == [(2, False), (1, False)]
    i.rewind(1)
    assert [(issue.line, issue.resolved) for issue in i.issues] == [(1, False), (1, True)]
    assert active(i) == ["m/a"]


def test_issues_keep_their_history_when_what_they_concern_is_renamed():
    text = """(machine m
      (state a (running [1 / 0]) (onentry (spawn q x))
        (machine k (state s)))
      (on nope a -> b) (on [5] a -> a)
      (ontime ["x"] a -> a)
      (on [True] a -> nowhere) (state b))(spawn m a)"""
    i = started(text, 2, on_issue="pause")
    codes = [issue.code for issue in i.issues]
    i.resume()
    i.rename("state", "m/a", "begin")
    i.rename("machine", "m", "much-longer".replace("-", "_"))
    i.step(0.2)
    assert (
        [issue.code for issue in i.issues]
        == codes
        == ["LRP605", "LRP603", "LRP602", "LRP607", "LRP604", "LRP601"]
    )
    assert [issue.count for issue in i.issues] == [1, 3, 3, 3, 3, 3]
    assert not any(issue.resolved for issue in i.issues)
    assert {issue.element.path[0] for issue in i.issues} == {"much_longer"}
    assert i.paused, "some have occurred again"
    line = i.program.text.splitlines()[1]
    assert i.issues[-1].column == line.index("1 / 0") + 1
    i.rewind(1)
    assert [issue.element.path[0] for issue in i.issues if not issue.resolved] == ["m"] * 6
    assert i.issues[-1].column == i.program.text.splitlines()[1].index("1 / 0") + 1


def test_an_issue_of_a_renamed_definition_is_over_when_that_runs_well():
    i = started(with_running("1 / n"))
    i.rename("variable", "n", "number")
    i.set_variable("number", "1")
    i.step(0.1)
    assert summary(i) == [("LRP601", 1, True)]


def test_pause_on_issue_pauses_again_when_an_issue_is_reopened():
    i = started(with_running("n += 1; 1 / (n % 2)"), 2, on_issue="pause")
    assert i.paused
    i.resume()
    i.step(0.2)
    assert (i.paused, i.issues[0].resolved) == (False, True)
    i.step(0.3)
    assert (i.paused, i.issues[0].resolved, i.issues[0].count) == (True, False, 2)


def test_pause_on_issue_keeps_the_traceback_and_runs_the_actions_of_a_pause():
    seen = []
    i = started(with_running("1 / 0") + "(onpause [n = 7])", ticks=0, on_issue="pause")
    i.observe(lambda event: seen.append(event.kind))
    i.step(0.0)
    assert (seen[-2:], seen.count("issue")) == (["paused", "changed"], 1)
    assert (i.variables["n"], isinstance(i.issues.raised(i.issues[0]).error, ZeroDivisionError)) == (7, True)


def test_an_issue_found_by_an_edit_pauses_too():
    i = started(with_running("n"), 2, on_issue="pause")
    i.patch(parse("(var k := [1 / 0])" + with_running("n")))
    assert i.paused
    assert i.tick == 2
