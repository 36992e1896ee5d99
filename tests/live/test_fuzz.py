"""A short run of the fuzzer: whatever is typed and asked, nothing escapes, hangs or ends the loop."""

import random

import fuzz
import pytest
from seeds import seeds


@pytest.fixture
def watch(monkeypatch):
    monkeypatch.setattr(fuzz, "LONGEST", 60.0)  # seconds, however busy the machine is
    return fuzz.Stopwatch()


@pytest.mark.parametrize("seed", seeds(1, 4))
def test_random_texts_are_explained(watch, seed):
    fuzz.fuzz_texts(400, seed, watch)
    assert watch.counts["scan"] == 400


@pytest.mark.parametrize("seed", seeds(1, 4))
def test_random_edits_and_commands_do_no_harm(watch, seed):
    fuzz.fuzz_edits(50, seed, watch)
    assert watch.counts["edit"] >= 50


def test_the_fuzzer_finds_what_escapes(watch, monkeypatch):
    def fail(*_):
        raise ZeroDivisionError

    text = fuzz.hostile(random.Random(1))
    monkeypatch.setattr(fuzz, "LONGEST", -1.0)
    with pytest.raises(fuzz.ViolationError, match="lasted"):
        fuzz.fuzz_text(text, watch)
    monkeypatch.setattr(fuzz, "LONGEST", 60.0)
    monkeypatch.setattr(fuzz, "scan", fail)
    with pytest.raises(fuzz.ViolationError, match="ZeroDivisionError"):
        fuzz.fuzz_text(text, watch)
