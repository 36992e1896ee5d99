"""Static checks of the Python in blocks."""

from __future__ import annotations

import pytest
from checking import fixed, found, message

from lrp_jupyter.language.checks import check

FRAME = "(var speed := [0.2])\n(machine m\n  (var time := [1])\n  (state a (onentry {})))\n(spawn m a)"


def action(block: str) -> str:
    """Return a program with an action that sees the variables `speed` and `time`."""
    return FRAME.replace("{}", f"[{block}]")


def condition(block: str) -> str:
    return f"(machine m (var flag := [True]) (state a) (state b) (on [{block}] a -> b))(spawn m a)"


def delay(block: str) -> str:
    return f"(machine m (state a) (state b) (ontime [{block}] a -> b))(spawn m a)"


def initialiser(block: str) -> str:
    return f"(var first := [1])(var x := [{block}])(var later := [2])(machine m (state a))(spawn m a)"


@pytest.mark.parametrize(
    "block",
    [
        "",
        "robot.move(linear=speed)\nprint(max(time, 2))",
        "y = speed\nprint(y)",
        "time += 1; speed = time",
        "y = 0\ny += 1",
        "y: int = 3\nprint(y)",
        "import math, os.path as p\nfrom time import sleep as nap\nprint(math.pi, p, nap)",
        "for i, (j, *k) in []: print(i, j, k)",
        "print([i * j for i in range(3) for j in range(i) if j])",
        "print({i for i in ''}, {i: j for i, j in []})",
        "print((i for i in range(3)), [last := i for i in range(3)], last)",
        "def f(a, /, b=speed, *c, d: int = 1, **e):\n  nonlocal time\n  time += 1\n  return a, b\nf(1)",
        "def f():\n  def g():\n    nonlocal y\n    y += 1\n  y = 0\n  g()\nf()",
        "class C(object):\n  z = 1\n  z += 1\n  def m(self): return __class__, self, speed\nC()",
        "with open('x') as file: print(file)",
        "try: pass\nexcept OSError as error: print(error)",
        "match speed:\n  case [x, *rest]: print(x, rest)\n  case {'k': v, **others}: print(v, others)",
        "match speed:\n  case C if 1: print(C)\n  case 1 | 2 as D: print(D)",
        "f = lambda x, *y: x + speed\nf(1)",
        "print(f'{speed:{time}} {[q for q in (1, 2)]!r} {speed=}')",
        "global shared\nshared = 1\nprint(shared)",
        "if (n := time) > 1: print(n)",
        "async def f():\n  async with x as y: return y\nx = f",
        "x = y = 1\nprint(x, y)",
        "print(__name__, __file__)",
        "'only a string'",
        "1",
        "print\nspeed",
        "return speed",
        "flag = speed == 1",
        "if speed == 1: time = 2",
    ],
)
def test_python_that_works_has_no_findings(block: str) -> None:
    assert check(action(block)) == ()


@pytest.mark.parametrize(
    ("block", "name"),
    [
        ("nowhere", "nowhere"),
        ("print(nowhere)", "nowhere"),
        ("\n      y = 1\n      print('é', nowhere, y)\n  ", "nowhere"),
        ("print(f'é {speed} {nowhere!r}')", "nowhere"),
        ("def f(): return nowhere\nf()", "nowhere"),
        ("class C:\n  z = 1\n  def f(self): return z\nC()", "z"),
        ("[i for i in ()]\nprint(i)", "i"),
        ("print([k for i in k for k in i])", "k"),
        ("nowhere.x = 1", "nowhere"),
        ("nowhere[1] += 1", "nowhere"),
    ],
)
def test_a_name_without_meaning_is_an_error_at_its_place(block: str, name: str) -> None:
    assert found(action(block)) == [("LRP502", name)]


def test_a_name_without_any_likeness_asks_for_a_variable() -> None:
    assert message(action("qqqqq")) == (
        "`qqqqq` is not defined where this block can see it. Declare `(var qqqqq := [value])`."
    )


def test_names_of_the_namespace_are_known() -> None:
    assert found(action("np.zeros(3)")) == [("LRP502", "np")]
    assert check(action("np.zeros(3)"), names={"np": 1}) == ()


@pytest.mark.parametrize(
    ("block", "repaired"),
    [
        ("print(sped)", "print(speed)"),
        ("value = 1; print(vaule)", "value = 1; print(value)"),
        ("prnt(speed)", "print(speed)"),
        ("time = nil", "time = None"),
        ("time = true", "time = True"),
        ("self.move()", "robot.move()"),
        ("tme += 1", "time += 1"),
        ("def f():\n  nonlocal tme\n  return 1\nf()", "def f():\n  nonlocal time\n  return 1\nf()"),
        ("time == 2", "time = 2"),
        ("time == (speed == 2)", "time = (speed == 2)"),
        ("local = [1]\nlocal[0] == 2\nprint(local)", "local = [1]\nlocal[0] = 2\nprint(local)"),
    ],
)
def test_certain_remedies_are_fixes(block: str, repaired: str) -> None:
    assert fixed(action(block)) == action(repaired)


def test_a_local_name_of_another_block_is_explained() -> None:
    text = "(machine m (state a\n(onentry [count = 1])\n(running [print(count)])))(spawn m a)"
    assert message(text) == (
        "`count` is not defined where this block can see it. Line 2 sets it for its own block only. "
        "Declare `(var count := [value])` to keep it."
    )


def test_a_variable_of_an_inner_machine_is_explained() -> None:
    text = """
(machine m
  (state a (onentry (spawn n b)) (running [print(time)])
    (machine n (var time := [1]) (state b))))
(spawn m a)"""
    assert message(text).endswith("The variable belongs to `m/a/n`. Declare it further out.")


def test_an_event_read_by_a_block_is_explained() -> None:
    bumping = "(machine m (state a (running [print(bump)])) (state b) (on bump a -> b))"
    text = f"(event bump [robot.b]){bumping}(spawn m a)"
    assert message(text).endswith("It is an event, and only transitions can use events.")


def test_an_initialiser_sees_only_the_variables_before_it() -> None:
    assert check(initialiser("first + 1")) == ()
    assert found(initialiser("later + 1")) == [("LRP502", "later")]
    assert message(initialiser("later + 1")).endswith("The variable is initialised later. Declare it first.")
    assert found(initialiser("x + 1")) == [("LRP502", "x")]


def test_an_initialiser_of_a_hiding_variable_sees_the_outer_one() -> None:
    text = "(var x := [1])(machine m (var x := [x + 1]) (state a))(spawn m a)"
    assert [code for code, _ in found(text)] == ["LRP202"]


def test_pause_actions_see_the_global_variables_only() -> None:
    text = "(onpause [speed = time])(onresume [speed = 1])" + action("")
    assert found(text) == [("LRP502", "time")]


# Changing what has no value


@pytest.mark.parametrize(
    ("block", "name"),
    [
        ("count += 1", "count"),
        ("count += 1\nprint(count)", "count"),
        ("def f():\n  count += 1\nf()", "count"),
        ("def f():\n  time += 1\nf()", "time"),
        ("y = 1\ndef f():\n  y += 1\nf()", "y"),
    ],
)
def test_a_local_name_cannot_be_changed_before_it_has_a_value(block: str, name: str) -> None:
    assert found(action(block)) == [("LRP503", name)]


def test_in_a_function_a_variable_is_changed_with_nonlocal() -> None:
    assert "Write `nonlocal time` first" in message(action("def f():\n  time += 1\nf()"))


def test_a_name_of_the_notebook_cannot_be_changed() -> None:
    (finding,) = check(action("count += 1"), names={"count"})
    assert finding.code == "LRP503"


def test_a_nonlocal_without_a_variable_is_an_error() -> None:
    text = action("def f():\n  nonlocal gone\n  gone = 1\n  return gone\nf()")
    assert found(text) == [("LRP502", "gone")]
    assert "Declare `(var gone := [value])`" in message(text)


# Statements without an effect


@pytest.mark.parametrize(
    "block", ["time == 2", "speed > 1", "time == 2\nprint(1)", "if speed: time == 2", "1 == time"]
)
def test_a_comparison_alone_does_nothing(block: str) -> None:
    ((code, text),) = found(action(block))
    assert code == "LRP504"
    assert text in block


@pytest.mark.parametrize("block", ["1 == time", "speed > 1", "time == 1 == 2", "max(1, 2) == 2"])
def test_a_comparison_that_cannot_assign_has_no_fix(block: str) -> None:
    (finding,) = check(action(block))
    assert finding.fix is None
    assert "write `=`" not in finding.message


def test_a_comparison_with_a_name_of_the_notebook_has_no_fix() -> None:
    (finding,) = check(action("limit == 2"), names=["limit"])
    assert finding.fix is None


def test_the_value_of_a_condition_may_be_a_comparison() -> None:
    assert check(condition("flag == 2")) == ()
    assert found(condition("flag == 1\nflag == 2")) == [("LRP504", "flag == 1")]


def test_a_member_of_the_robot_alone_does_nothing() -> None:
    assert found(action("robot.stop")) == [("LRP507", "robot.stop")]
    assert found(action("speed.real")) == []
    assert check(condition("robot.bumper.data")) == ()
    assert found(condition("robot.stop\nrobot.bumper.data")) == [("LRP507", "robot.stop")]


def test_bitwise_operators_in_a_comparison_become_logical_ones() -> None:
    assert fixed(condition("robot.b.data == 1 & flag")) == condition("robot.b.data == 1 and flag")
    assert fixed(condition("robot.b.data < 1 | flag")) == condition("robot.b.data < 1 or flag")
    assert found(condition("robot.b.data == 1 & flag")) == [("LRP509", "robot.b.data == 1 & flag")]


@pytest.mark.parametrize(
    "block",
    [
        "robot.b & 1 == 1",
        "robot.b == (1 & flag)",
        "robot.b == robot.c & 7",
        "robot.b == 1 + 2",
        "f'{1 == 1 & flag}' == '1'",
    ],
)
def test_bits_that_are_meant_are_left_alone(block: str) -> None:
    assert check(condition(block)) == ()


# Values


@pytest.mark.parametrize("block", ["import math", "for x in []: x == 1", "if flag: True", "return", "pass"])
def test_a_condition_that_ends_in_a_statement_has_no_value(block: str) -> None:
    assert ("LRP505", block) in found(condition(block))


def test_an_assignment_in_place_of_a_condition_becomes_a_comparison() -> None:
    assert fixed(condition("flag = 2")) == condition("flag == 2")
    assert fixed(condition("robot.state = 2")) == condition("robot.state == 2")


@pytest.mark.parametrize("block", ["flag += 1", "a, b = 1, 2", "a = b = 1", "flag: int = 2"])
def test_other_statements_at_the_end_have_no_fix(block: str) -> None:
    (finding,) = check(condition(block))
    assert (finding.code, finding.fix) == ("LRP505", None)


@pytest.mark.parametrize(
    "block",
    [
        "if flag: return True\nFalse",
        "if flag: return True\nprint(1)\nx = 1",
        "raise ValueError",
        "return flag",
    ],
)
def test_a_block_that_may_return_a_value_is_left_alone(block: str) -> None:
    assert check(condition(block)) == ()


def test_a_return_inside_a_function_is_not_that_of_the_block() -> None:
    assert found(condition("def f(): return True")) == [("LRP505", "def f(): return True")]


def test_a_delay_that_ends_in_a_statement_has_no_fix() -> None:
    (finding,) = check(delay("x = 5"))
    assert (finding.code, finding.fix) == ("LRP505", None)


def test_a_variable_that_ends_in_a_statement_is_none() -> None:
    assert found(initialiser("y = 2")) == [("LRP506", "y = 2")]
    assert check(initialiser("y = 2\ny")) == ()
    assert check(initialiser("None")) == ()


@pytest.mark.parametrize(
    "block",
    [
        "1",
        "-1.5",
        "'yes'",
        "f'{flag}'",
        "None",
        "...",
        "b''",
        "[flag]",
        "(flag, 1)",
        "{flag}",
        "{}",
        "lambda: flag",
    ],
)
def test_a_literal_that_is_not_a_truth_value_is_not_a_condition(block: str) -> None:
    assert found(condition(block)) == [("LRP508", block)]


@pytest.mark.parametrize("block", ["True", "not 1", "flag", "robot.b or 1", "if flag: return True\n1"])
def test_what_may_be_a_truth_value_is_left_alone(block: str) -> None:
    assert check(condition(block)) == ()


def test_a_comparison_instead_of_a_delay_becomes_a_condition() -> None:
    for block in ("robot.b == 1", "not robot.b", "robot.b > 1 and not robot.c"):
        assert found(delay(block)) == [("LRP508", block)]
        assert fixed(delay(block)) == delay(block).replace("ontime", "on")
    for block in ("robot.b > 1 and 500", "500 * (robot.b > 1)", "500 if robot.b == 1 else 5"):
        assert check(delay(block)) == ()


def test_a_delay_is_a_number() -> None:
    assert (
        message(delay("'5'"))
        == "A delay must be a number, not a string. Write an expression that returns one."
    )
    assert found(delay("True")) == [("LRP508", "True")]
    for block in ("5", "-5", "2.5", "1000 * 2"):
        assert check(delay(block)) == ()


# What Python accepts, and means something else


@pytest.mark.parametrize(
    ("block", "repaired", "code"),
    [
        ("time = 0,5", "time = 0.5", "LRP518"),
        ("time += 0,25", "time += 0.25", "LRP518"),
        ("time = 5,", "time = 5", "LRP518"),
        ("time: 5", "time = 5", "LRP518"),
        ("time =+ 1", "time += 1", "LRP518"),
        ("time =- 1", "time -= 1", "LRP518"),
        ("++time", "time += 1", "LRP518"),
        ("time = speed ^ 2", "time = speed ** 2", "LRP518"),
        ("x = [1]; x[0] = 0,5; print(x)", "x = [1]; x[0] = 0.5; print(x)", "LRP518"),
        ("if speed == 1 or 2: time = 1", "if speed == 1 or speed == 2: time = 1", "LRP527"),
        ("if speed is 1: time = 1", "if speed == 1: time = 1", "LRP528"),
        ("if robot.b is not 'é': time = 1", "if robot.b != 'é': time = 1", "LRP528"),
        ("time <- 2", "time = 2", "LRP504"),
        ("def f():\n  time = 1\nf()", "def f():\n  nonlocal time\n  time = 1\nf()", "LRP529"),
        ("def f(): time = 1\nf()", "def f(): nonlocal time; time = 1\nf()", "LRP529"),
        ("def f():\n  time = time + 1\nf()", "def f():\n  nonlocal time\n  time = time + 1\nf()", "LRP503"),
        ("def f():\n  'é'\n  time += 1\nf()", "def f():\n  'é'\n  nonlocal time\n  time += 1\nf()", "LRP503"),
        ("tiem = 2", "time = 2", "LRP530"),
        ("if speed > 1:\n  retrun\nprint(1)", "if speed > 1:\n  return\nprint(1)", "LRP502"),
    ],
)  # fmt: skip
def test_python_that_means_something_else_is_found(block: str, repaired: str, code: str) -> None:
    (finding,) = check(action(block))
    assert finding.code == code
    assert fixed(action(block)) == action(repaired)
    assert check(action(repaired)) == ()


@pytest.mark.parametrize(
    "block",
    [
        "x = 1, 2\nprint(x)",
        "x = (5,)\nprint(x)",
        "x, y = 0,1\nprint(x, y, {(1,2): 3}[1,2])",
        "x = -1; y = +1\nprint(x, y)",
        "x: int = 5\nprint(x)",
        "if speed == 1 or time: print(1)",
        "if speed is None or speed is True: print(1)",
        "print(5 ^ 6, time ^ speed)",
        "def f(time): time += 1; return time\nf(1)",
        "def f():\n  time = 1\n  return time\nf()",
        "def f():\n  for time in []: pass\nf()",
        "def f():\n  nonlocal time\n  time = 1\nf()",
        "class C:\n  time = 1\nC()",
        "qqqqq = 1",
        "tiem = 2\nprint(tiem)",
    ],
)
def test_python_that_means_what_it_seems_to_has_no_findings(block: str) -> None:
    assert check(action(block)) == ()


def test_a_comparison_that_is_meant_to_assign_defines_its_name() -> None:
    assert fixed(action("total == 0\ntotal += 1\nprint(total)")) == action(
        "total = 0\ntotal += 1\nprint(total)"
    )
    assert found(condition("total == 0")) == [("LRP502", "total")]


def test_a_decimal_comma_in_a_condition_is_one_finding() -> None:
    assert fixed(condition("x < 0,5"), ["x"]) == condition("x < 0.5")


def test_a_condition_that_assigns_a_comparison_is_the_comparison() -> None:
    assert fixed(condition("near = x < 2"), ["x"]) == condition("x < 2")
    (finding,) = check(condition("flag = not x"), ["x"])
    assert finding.message == "This condition only assigns and has no value. Write the test alone: `not x`."
    assert finding.fix is None  # it may be meant as well: `flag` is a variable


def test_a_local_name_that_another_block_reads_is_reported_there_only() -> None:
    text = "(var time := [1])(machine m (state a (onentry [tiem = 2]) (running [print(tiem)])))(spawn m a)"
    assert found(text) == [("LRP502", "tiem")]


# Variables and texts


def counting(test: str, action: str = "n += 1") -> str:
    machine = f"(machine m (state a (running [{action}])) (on [{test}] a -> b) (state b))"
    return f"(var n := [0])\n{machine}\n(spawn m a)"


def test_a_variable_that_is_a_number_is_never_equal_to_a_text() -> None:
    assert found(counting('n == "3"')) == [("LRP526", '"3"')]
    assert fixed(counting('n == "3"')) == counting("n == 3")
    assert found(counting('"three" < n')) == [("LRP525", '"three"')]
    assert message(counting('n != "3"')) == (
        "`n` is a number, always different from a text. Write `3` without quotes."
    )


@pytest.mark.parametrize("action", ["n = 2 * n", "n = len([1])", "n = -1", "n = robot.a - robot.b"])
def test_a_variable_to_which_numbers_are_assigned_is_a_number(action: str) -> None:
    assert found(counting('n == "3"', action)) == [("LRP526", '"3"')]


@pytest.mark.parametrize(
    "action",
    ["n = 'x'", "n = str(n)", "n = robot.a", "for n in 'ab': pass", "n, o = 1, 2", "n = 2 * robot.a"],
)
def test_a_variable_to_which_anything_is_assigned_may_be_a_text(action: str) -> None:
    assert check(counting('n == "3"', action)) == ()
    assert check(counting('n == "3"').replace("[0]", "['']").replace("n += 1", "n += 'a'")) == ()
