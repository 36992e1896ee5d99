"""Slips in the Python of blocks: each is one finding with its remedy."""

from __future__ import annotations

import pytest
from checking import found
from hypothesis import given
from hypothesis import strategies as st

from lrp_jupyter.errors import edited
from lrp_jupyter.language import slips
from lrp_jupyter.language.checks import CODES, check
from lrp_jupyter.language.parser import scan
from lrp_jupyter.language.slips import explain


def applied(text: str) -> str:
    """Apply the fix of the only slip of a block."""
    (slip,) = explain(text)
    return edited(text, slip.edits)


@pytest.mark.parametrize(
    ("block", "repaired", "message"),
    [
        ("x := 5", "x = 5", "`:=` belongs outside of blocks. In Python, `=` assigns: write `=`."),
        ("if a && b: c = 1", "if a and b: c = 1", "Python has no `&&`. Write `and`."),
        ("a||b", "a or b", "Python has no `||`. Write `or`."),
        ("!x", "not x", "Python has no `!`. Write `not`."),
        ("x == !y", "x == (not y)", "Python has no `!`. Write `not`."),
        ("x =! 1", "x != 1", "Python has no `=!`. Write `!=`."),
        ("flag =! flag", "flag = not flag", "Python has no `=!`. Write `not`."),
        ("x++", "x += 1", "Python has no `++`. Write `+= 1`."),
        ("x--; y = 2", "x -= 1; y = 2", "Python has no `--`. Write `-= 1`."),
        ("a => b", "a >= b", "Python has no `=>`. Write `>=`."),
        ("a =< b", "a <= b", "Python has no `=<`. Write `<=`."),
        ("a <> b", "a != b", "Python has no `<>`. Write `!=`."),
        ("a ≤ b", "a <= b", "Python does not know `≤`. Write `<=`."),
        ("print(“a”)", 'print("a")', 'Python does not know `“`. Write `"`.'),
        ("robot->stop()", "robot.stop()", "Python has no `->`. Write `.`."),
        ("a ? b : c", "b if a else c", "Python has no `?`. Write `b if a else c`."),
        ("if x { y = 2; }", "if x: y = 2;", "Python has no braces around statements."),
        ("if x {\n  y\n} else {\n  z\n}", "if x:\n  y\nelse:\n  z\n", "Python has no braces"),
        ("x = 1 // go on", "x = 1 # go on", "In a block, `//` does not begin a comment. Write `#`."),
        ("x = 1; y = 2 ; go on", "x = 1; y = 2 # go on", "In a block, `;` does not begin a comment."),
        ("x = 7 // 2; y = 1 // go on", "x = 7 // 2; y = 1 # go on", "In a block, `//` does not begin"),
        ("x = 1 ; go on", "x = 1 # go on", "In a block, `;` does not begin a comment. Write `#`."),
        ("robot.move(linear=0,5)", "robot.move(linear=0.5)", "A decimal number has a point. Write `0.5`."),
        ("if x > 1 then y = 2", "if x > 1: y = 2", "Python has no `then`. Write `:`."),
        ("if x: y\nelse if z: y", "if x: y\nelif z: y", "Python writes `else if` in one word. Write `elif`."),
        ("whille x: y = 1", "while x: y = 1", "`whille` is not a keyword of Python. Did you mean `while`?"),
        ("retrun x", "return x", "`retrun` is not a keyword of Python. Did you mean `return`?"),
        ("Def f(): return 1", "def f(): return 1", "Keywords are written in lowercase. Write `def`."),
        ("set x to 5", "x = 5", "An assignment is written with `=`. Write `x = …`."),
        ("x == 1 & not y", "x == 1 and not y", "`&` combines bits. Write `and`."),
        ("var x = 5", "x = 5", "Python has no `var`. Write the assignment without it."),
        ("if x > 1\n  y = 1", "if x > 1:\n  y = 1", "This `if` needs a `:`. Write it after `if x > 1`."),
        ("if x > 1 y = 1", "if x > 1: y = 1", "This `if` needs a `:`. Write it after `if x > 1`."),
        ("def f:\n  return 1", "def f():\n  return 1", "A function needs parentheses. Write `f()`."),
        ("x = = 1", "x = 1", "`= =` is two signs. Write `=`."),
        ("if x = = 1: y", "if x == 1: y", "`= =` is two signs. Write `==`."),
        ("x = 5 sec", "x = 5", "Python knows no units. Write the number alone: `5`."),
        ("x = 1:", "x = 1", "Only a header such as `if …:` ends with `:`. Remove it."),
        ("f(x\ny = 3", "f(x)\ny = 3", "This `(` is not closed. Write `)` after `(x`."),
        ("abs(x - 1 < 2", "abs(x - 1) < 2", "This `(` is not closed. Write `)` after `x - 1`."),
        ("if (a and b:\n  c", "if (a and b):\n  c", "This `(` is not closed. Write `)` after `a and b`."),
        ("print(xs[0)", "print(xs[0])", "This `[` is not closed. Write `]` after `[0`."),
        ("x = y)", "x = y", "Unmatched `)`: no `(` is open here. Remove it."),
        ("robot.stop)", "robot.stop()", "A `(` is missing after `stop`. Insert it."),
        ('print("hello)', 'print("hello")', 'This string is not closed. Write `"` after `hello`.'),
        ('print(hello")', 'print("hello")', 'This string has no quote at its beginning. Write `"` before'),
        ("print x", "print(x)", "A call needs parentheses. Write `print(x)`."),
        ("robot.move linear=1", "robot.move(linear=1)", "A call needs parentheses."),
        ("f(linear=1 angular=2)", "f(linear=1, angular=2)", "A comma is missing between `1` and `angular`."),
        ("f(linear: 1)", "f(linear=1)", "An argument has its value after `=`. Write `linear=`."),
        ("robot light.data < 3", "robot.light.data < 3", "A `.` is missing between `robot` and `light`."),
        ("if x = 1: y = 2", "if x == 1: y = 2", "`=` assigns. Write `==` to compare."),
        ("x not == 1", "x != 1", "`not` does not negate the sign after it. Write `!=`."),
        ("x = 1\n  y = 2\nz = 3", "x = 1\ny = 2\nz = 3", "This line begins too far right."),
        ("if x:\ny = 2", "if x:\n  y = 2", "This line belongs to the `if` above. Start it further right."),
        ("\n    x = 1\n\ty = 2", "\n    x = 1\n    y = 2", "This line begins with tabs and spaces."),
    ],
)  # fmt: skip
def test_a_slip_is_one_fault_with_its_remedy(block: str, repaired: str, message: str) -> None:
    (slip,) = explain(block)
    assert slip.message.startswith(message)
    assert slip.code in CODES
    assert applied(block) == repaired
    assert explain(repaired) == ()


@pytest.mark.parametrize(
    ("block", "message"),
    [
        ("x = 1 +", "Something is missing after `+`. Complete it, or remove the `+`."),
        ("else: x = 1", "This `else` has no `if`. Start it below its `if`."),
        ("break", "`break` works only in a `for` or `while`. Remove it."),
        ("f(a=1, 2)", "After an argument with a name, all others need one, too."),
        ("f(a=1, a=2)", "`a` is passed twice. Remove one of the two."),
    ],
)  # fmt: skip
def test_without_a_certain_remedy_there_is_no_fix(block: str, message: str) -> None:
    (finding,) = check(f"(machine m (state a (running [{block}\n])))\n(spawn m a)")
    assert finding.message.startswith(message)
    assert finding.fix is None


def test_lines_in_a_message_are_those_of_the_file() -> None:
    text = "(machine m\n\n (state a (running [\n   if True:\n   ])))\n(spawn m a)"
    (finding,) = check(text)
    assert "The `if` in line 4 has nothing in it." in finding.message


def test_several_slips_are_each_at_their_place() -> None:
    text = "(machine m (state a (running [x := 1\n  if x && x: y = 1\n  print x\n  z = (1])))(spawn m a)"
    assert found(text) == [("LRP510", ":="), ("LRP510", "&&"), ("LRP517", "print x"), ("LRP513", "(")]


def test_a_condition_that_cannot_assign_is_meant_to_compare() -> None:
    text = "(machine m (state a) (state b) (on [not x = 1] a -> b))(spawn m a)"
    (finding,) = check(text)
    assert (finding.code, finding.message) == ("LRP516", "`=` assigns. Write `==` to compare.")


def test_a_string_that_swallows_the_end_of_its_block_is_the_fault() -> None:
    text = '(machine m (state a (running [print("hi)])))\n(spawn m a)'
    (finding,) = check(text)
    assert (finding.code, finding.line) == ("LRP514", 1)
    assert finding.fix


def test_a_bracket_that_takes_the_end_of_its_block_is_the_fault() -> None:
    text = "(var xs := [[1]])\n(machine m (state a (running [print(xs[0)])))\n(spawn m a)"
    (finding,) = check(text)
    assert (finding.code, finding.line) == ("LRP513", 2)
    assert finding.fix


SIGNS = ["=", ":=", ":", "(", ")", "[", "]", "{", "}", '"', "'", "&&", "!", ",", ";", "#", "“", "\\", "f'{"]
WORDS = ["x", "robot.move", "if ", "else", "print ", "1", "0,5", "then ", "é", "for i in "]
PIECES = st.sampled_from([*SIGNS, *WORDS, " ", "\n", "\n  ", "\t", "\r\n"])


@given(st.lists(PIECES, max_size=25).map("".join), st.booleans())
def test_any_text_is_explained(text: str, is_condition: bool) -> None:
    for slip in explain(text, 3, 7, is_condition):
        assert 0 <= slip.start <= slip.end <= len(text)
        assert all(0 <= start <= end <= len(text) for start, end, _ in slip.edits)
        assert slip.message.endswith((".", "?"))
    scan(f"(var x := [{text}])")


@pytest.mark.parametrize(
    ("block", "repaired"),
    [
        ("if x > 1: then y = 2", "if x > 1: y = 2"),
        ("if x = y: z = 1", "if x == y: z = 1"),
        ("x = 3, y = 4", "x = 3; y = 4"),
        ("var x := 3", "x = 3"),
        ("x = y²", "x = y**2"),
        ("f(a=1; b=2)", "f(a=1, b=2)"),
        ("robot.move[linear=0.2]", "robot.move(linear=0.2)"),
        ("robot.move{linear=0.2}", "robot.move(linear=0.2)"),
        ("print('it's far')", 'print("it\'s far")'),
        ("if x == 1:: y = 2", "if x == 1: y = 2"),
    ],
)
def test_more_slips_have_remedies(block: str, repaired: str) -> None:
    assert applied(block) == repaired


@pytest.mark.parametrize(
    ("block", "repaired"),
    [
        ("if x > 1", "x > 1"),
        ("if x > 1 then", "x > 1"),
        ("x > 1:", "x > 1"),
        ("x := 1", "x == 1"),
        ("x = 1 and y = 2", "x == 1 and y == 2"),
        ("unless x > 1", "not (x > 1)"),
    ],
)
def test_a_condition_is_no_statement(block: str, repaired: str) -> None:
    (slip,) = explain(block, is_condition=True)
    for start, end, new in sorted(slip.edits, reverse=True):
        block = block[:start] + new + block[end:]
    assert block == repaired


@pytest.mark.parametrize(
    ("block", "message"),
    [
        ("for (i = 0; i < 3; i++) print(i)", "Python counts with `range`. Write `for i in range(3):`."),
        ("for i = 1 to 10: print(i)", "Python counts with `range`. Write `for i in range(3):`."),
        ("if x is less than 3: y = 1", "Python compares with signs. Write `<`, `>` or `==`."),
        ("if x > 1 and < 5: y = 1", "`and` and `or` join whole comparisons."),
        (
            "(spawn m a)",
            "`(spawn …)` is a form of the program, not Python. Put it after the `]` of this block.",
        ),
        ("goto home", "A block cannot change the state. Write a transition:"),
        ("state home", "A block cannot change the state. Write a transition:"),
        ("max speed = 3", "A name cannot contain spaces. Write `max_speed`, or a sign between"),
        ("x = 3 apples", "Two statements are in one line. Write `;` before `apples`, or a new line."),
        ("len(x) = 3", "Only a name can be assigned."),
        ("if: y = 2", "Something is missing before this `:`. Complete it."),
    ],
)
def test_what_no_single_change_repairs_is_explained(block: str, message: str) -> None:
    (slip,) = explain(block)
    assert slip.message.startswith(message)
    assert slip.edits == ()


def test_two_slips_in_one_line_are_two_faults() -> None:
    assert [slip.message for slip in explain("if x && y || z: a = 1")] == [
        "Python has no `&&`. Write `and`.",
        "Python has no `||`. Write `or`.",
    ]


def test_the_search_for_remedies_is_bounded() -> None:
    text = "".join(f"(onpause [print x{i}])\n" for i in range(100))
    findings = scan(text)[1]
    assert len([finding for finding in findings if finding.fix]) == 20
    (slip,) = explain("x y " * 10_000)
    assert slip.edits == ()


def test_a_quote_inside_does_not_join_two_strings() -> None:
    (slip,) = explain('print("on guard, after, edges, "edges")')
    assert "'" not in {edit.text for edit in slip.edits}


def test_the_search_for_the_remedy_of_one_block_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    parsed = []
    error = slips._error
    monkeypatch.setattr(slips, "_error", lambda text: parsed.append(len(text)) or error(text))
    assert slips.explain("(((" + "a b, " * 1000)
    assert sum(parsed) < 500_000
