"""The journal is bounded by bytes, too, and forgets whole ticks."""

import subprocess
import sys
from types import SimpleNamespace

import pytest
from support.tables import every

from lrp_jupyter.interpreter import journal
from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.language.parser import parse

TEXT = "(var v := [0]) (var n := [0]) (machine m (state a (running [n = n + 1] [v = make(n)]))) (spawn m a)"
LARGE = 50_000


@pytest.fixture(autouse=True)
def most(monkeypatch):
    monkeypatch.setattr(journal, "MOST", 1_000_000)


def ran(make, ticks, text=TEXT):
    i = Interpreter(parse(text), namespace={"make": make})
    for tick in range(ticks):
        i.step(tick / 10)
    return i


@every(
    "make",
    [
        lambda n: bytes(LARGE),
        lambda n: "ä" * LARGE,
        lambda n: list(range(LARGE // 40)),
        lambda n: (bytes(LARGE), n),
        lambda n: SimpleNamespace(image=bytes(LARGE), number=n),
        lambda n: bytes(LARGE) if n > 1000 else n,
        lambda n: bytes(LARGE) if n % 2 else n,
    ],
)
def test_large_values_shorten_what_can_be_undone(make):
    i = ran(make, 2000)
    assert 8 <= i.journal <= 80
    reach = i.journal
    i.rewind(reach)
    assert (i.tick, i.variables["n"]) == (2000 - reach, 2000 - reach), "whole ticks are dropped"
    with pytest.raises(ValueError, match="holds 0"):
        i.rewind(1)
    for tick in range(500):
        i.step(300 + tick / 10)
    assert 8 <= i.journal <= 80


def test_what_was_undone_no_longer_counts():
    i = ran(lambda n: bytes(LARGE), 10)
    for _ in range(20):
        i.rewind(5)
        for tick in range(5):
            i.step(i.now + tick / 10)
    assert i.journal == 10


@every("make", [lambda n: n, lambda n: f"value {n}", lambda n: [n] * 5])
def test_small_values_do_not(make, monkeypatch):
    monkeypatch.setattr(journal, "MOST", 10_000_000)
    assert ran(make, 5000).journal == 5000


def test_a_large_value_that_is_assigned_again_and_again_counts_once():
    table = list(range(20_000))
    assert ran(lambda n: table, 2000).journal == 2000


def test_the_texts_of_edits_count_too():
    i = ran(lambda n: n, 1)
    for number in range(100):
        i.patch(parse(f"{TEXT} ; {'x' * 100_000}{number}"))
        i.step(1 + number / 10)
    assert 3 <= i.journal <= 20
    reach = i.journal
    i.rewind(reach)
    assert i.program.text.endswith(f"x{100 - reach - 1}")


def test_values_whose_size_cannot_be_known_do_no_harm():
    class Odd(type):
        def __eq__(cls, other):
            raise RuntimeError

        def __hash__(cls):
            raise RuntimeError

    def never(self):
        raise RuntimeError

    odd = Odd("Thing", (), {"__sizeof__": never, "__dict__": property(never)})
    assert ran(lambda n: odd(), 300).journal == 300


@every("error", [RuntimeError, SystemExit])
def test_a_proxy_is_weighed_without_being_asked_for_attributes(error):
    def never(self, name):
        raise error

    def exits(self):
        raise error

    proxy = type("Proxy", (), {"__getattribute__": never, "__getattr__": never})
    sized = type("Sized", (), {"__sizeof__": exits})
    for kind in (proxy, sized):
        interpreter = ran(lambda n, kind=kind: kind(), 300)
        interpreter.reset()
        assert interpreter.journal == 300


@pytest.mark.slow
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="needs /proc")
def test_six_hundred_large_values_fit_into_memory():
    program = f"""
from lrp_jupyter import Session
session = Session({TEXT!r}, namespace={{"make": lambda n: bytes([n % 256]) * 1_500_000}})
session.run(60)
assert session.frame.tick == 600
assert session.frame.issues == ()
with open("/proc/self/status") as status:  # `getrusage` counts what the parent had before the fork
    print(next(line.split()[1] for line in status if line.startswith("VmHWM")))
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert int(done.stdout) < 400_000  # kB
