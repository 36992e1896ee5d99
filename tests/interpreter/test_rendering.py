"""Values as text: like `repr` where that is short, bounded where it is not."""

import array
import tracemalloc
from collections import Counter, OrderedDict, defaultdict, deque

from hypothesis import given
from hypothesis import strategies as st
from support.tables import every

from lrp_jupyter.errors import NoDataYet
from lrp_jupyter.interpreter.faults import kind_and_message
from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.interpreter.rendering import LONGEST, render, short
from lrp_jupyter.language.parser import parse

SCALARS = st.integers(-(10**9), 10**9) | st.text(max_size=8) | st.floats() | st.booleans() | st.none()


@given(
    st.recursive(
        SCALARS | st.binary(max_size=8) | st.complex_numbers(),
        lambda inner: (
            st.lists(inner, max_size=3)
            | st.tuples(inner, inner)
            | st.tuples(inner)
            | st.dictionaries(st.text(max_size=3), inner, max_size=2)
        ),
        max_leaves=6,
    )
)
def test_a_short_value_of_pythons_own_types_is_shown_as_its_repr(value):
    text = render(value)
    assert text == repr(value) or "..." in text


@every(
    ("value", "text"),
    [
        ({3, 1, 2}, "{1, 2, 3}"),
        (set(), "set()"),
        (frozenset({"b", "a"}), "frozenset({'a', 'b'})"),
        (deque([1, 2]), "deque([1, 2])"),
        (OrderedDict(a=1), "OrderedDict({'a': 1})"),
        (defaultdict(list, a=[1]), "defaultdict({'a': [1]})"),
        (Counter("aab"), "Counter({'a': 2, 'b': 1})"),
        (array.array("i", [1, 2]), "array('i', [1, 2])"),
        (bytearray(b"ab"), "bytearray(b'ab')"),
        ([1] * 13, "[1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, ... 1 more]"),
        ([[[[1]]]], "[[[[...]]]]"),
        ({(2, "b"), (1, "c"), None}, "{(1, 'c'), (2, 'b'), None}"),
    ],
)
def test_collections_are_shown_by_their_first_items(value, text):
    assert render(value) == text


def test_the_text_of_a_long_collection_says_how_much_more_there_is():
    assert render(["x" * 150] * 20).endswith(", ... 17 more]")
    assert len(render([["x" * 150] * 20] * 20)) == LONGEST


@every(
    "value",
    [
        bytearray(10**6),
        bytes(10**6),
        "ä" * 10**6,
        list(range(10**5)),
        OrderedDict.fromkeys(range(10**5)),
        dict.fromkeys(range(10**5)),
        set(range(10**5)),
        deque(range(10**5)),
        array.array("d", bytes(8 * 10**5)),
        1 << 10**6,
    ],
)
def test_the_work_does_not_grow_with_the_value(value):
    tracemalloc.start()
    try:
        assert len(render(value)) <= LONGEST
        assert tracemalloc.get_traced_memory()[1] < 50_000, "its repr takes far more"
    finally:
        tracemalloc.stop()


def must_not_run(*_):
    raise AssertionError("This must not run.")


class Odd:
    __repr__ = must_not_run


def test_a_message_runs_no_foreign_code():
    assert short(Odd()) == "a value of type `Odd`"
    assert short([Odd()]) == "[<Odd>]"
    assert short("x" * 100).endswith("…")


def test_of_a_value_nothing_but_its_repr_runs():
    reserved = type("Reserved", (type,), {"__getattribute__": must_not_run})
    text = type("Text", (str,), {"__len__": must_not_run, "__str__": must_not_run})("text")
    value = reserved("Value", (), {"__repr__": lambda self: text, "__lt__": must_not_run})()
    assert render(value) == "text"
    assert render({value, reserved("Other", (), {"__repr__": lambda self: text})()}) == "{text, text}"


def test_of_an_exception_nothing_but_its_text_is_asked():
    text = type("Text", (str,), {"__len__": must_not_run})("There is no data.")
    error = type("Late", (NoDataYet,), {"__str__": lambda self: text})()
    assert kind_and_message(parse(""), error) == ("no data yet", "There is no data.")


def test_no_more_is_asked_for_its_repr_than_is_shown():
    calls = []
    counted = type("Counted", (), {"__repr__": lambda self: calls.append(self) or "value"})()
    render([[[counted] * 12] * 12] * 12)
    assert len(calls) <= LONGEST / len("value")


class Stranger(type):
    @property
    def __module__(cls):
        raise AttributeError("__module__")

    @property
    def __name__(cls):
        raise SystemExit

    def __eq__(cls, other):
        raise SystemExit

    def __hash__(cls):
        raise SystemExit


def never(*_):
    raise SystemExit


BLOCK = """
from dataclasses import dataclass
from enum import Enum, IntEnum
def pid(e, k=1, *rest, least, **more): return e
class Pid:
    def out(self, e): return e
    @classmethod
    def make(cls, k): return cls()
@dataclass
class Pose:
    x: float = 0
class Light(Enum):
    RED = 1
class Level(IntEnum):
    LOW = 1
VALUE
"""


@every(
    ("value", "text"),
    [
        ("pid", "pid(e, k, *rest, least, **more)"),
        ("lambda: 1", "lambda: …"),
        ("lambda a, *, b: 1", "lambda a, *, b: …"),
        ("Pid", "class Pid"),
        ("Light", "class Light"),
        ("[Light.RED, Level.LOW]", "[Light.RED, Level.LOW]"),
        ("Pid()", "<Pid object>"),
        ("Pid().out", "Pid.out(e)"),
        ("Pid.make", "Pid.make(k)"),
        ("Pose(1)", "Pose(x=1)"),
        ("__import__('types').MethodType(len, [1])", "list.builtin_function_or_method(…)"),
    ],
)
def test_what_a_block_defines_is_shown_as_its_text_names_it(value, text):
    i = Interpreter(parse(f"(var v := [{BLOCK.replace('VALUE', value)}]) (machine m (state a)) (spawn m a)"))
    i.step(0.0)
    assert not i.issues
    assert render(i.variables["v"]) == text


STRANGE = {
    "class without a module": Stranger("Strange", (), {"__repr__": never}),
    "repr": type("Strange", (), {"__repr__": never}),
    "class": type("Strange", (), {"__class__": property(never)}),
    "bool": type("Strange", (), {"__bool__": never, "__len__": never}),
    "eq": type("Strange", (), {"__eq__": never, "__hash__": never}),
    "float": type(
        "Strange", (float,), {"__float__": never, "__repr__": never, "__ge__": never, "__ne__": never}
    ),
    "int": type(
        "Strange", (int,), {"__float__": never, "__repr__": never, "__le__": never, "__bool__": never}
    ),
    "exception": type("Strange", (Exception,), {"__str__": never, "__class__": property(never)}),
}


@every("kind", STRANGE.values())
@every(
    "use",
    [
        "(on [make()] a -> b)",
        "(event e [make()]) (on e a -> b)",
        "(var d := [make()]) (ontime d a -> b)",
        "(ontime [make()] a -> b)",
        "(var v := [make()])",
    ],
)
def test_a_strange_value_is_an_issue_at_most(kind, use):
    i = Interpreter(parse(f"(machine m {use} (state a) (state b)) (spawn m a)"), namespace={"make": kind})
    i.watch_events()
    for now in range(3):
        i.step(float(now))
    assert i.tick == 3
    assert len(i.issues) <= 1


@every("kind", [STRANGE["exception"], type("Strange", (BaseException,), {"__str__": never})])
def test_a_strange_exception_is_an_issue(kind):
    def fail():
        raise kind

    i = Interpreter(parse("(machine m (state a (running [fail()]))) (spawn m a)"), namespace={"fail": fail})
    i.step(0.0)
    i.step(0.1)
    assert "Strange" in i.issues[0].message


def test_the_message_of_an_exception_is_bounded():
    text = "(machine m (state a (running [raise ValueError('x' * 10**6)]))) (spawn m a)"
    i = Interpreter(parse(text))
    i.step(0.0)
    i.step(0.1)
    assert len(i.issues[0].message) <= 1000
    assert len(i.issues[0].traceback) <= 21_000
