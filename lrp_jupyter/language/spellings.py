"""Spellings of keywords in other languages, and misspellings of them."""

from __future__ import annotations

import re
from collections.abc import Iterable
from difflib import get_close_matches

OTHERS: dict[str, tuple[str, ...]] = {
    word: tuple(meant.split())
    for meant, words in {
        "var": "let variable const def define set int float global param parameter constant assign",
        "event": "condition trigger sensor guard signal",
        "machine": "statemachine fsm automaton sm",
        "state": "node mode",
        "spawn": "launch instantiate",
        "onentry": "entry enter onenter onstart init entryaction",
        "onexit": "leave onleave exitaction",
        "running": "doactivity during always whilerunning action",
        "ontime": "after timeout wait delay timer ontimeout every sleep timed",
        "onpause": "pause",
        "onresume": "resume",
        "eps": "epsilon immediate",
        "exit": "return break",
        "on eps": "transition trans goto arrow edge go move",
        "on": "when if event",
        "spawn onentry": "start begin",
        "spawn running": "run loop do execute while",
        "onexit exit": "end finish stop",
    }.items()
    for word in words.split()
}
"""The keywords that correspond to those of other languages, by their words in lower case and without `_`."""
MODULES = frozenset({"import", "export", "from", "include", "require", "use", "using", "module"})
FOLLOWERS = {"onentry": ("entry", "enter", "start"), "onexit": ("exit", "leave", "end"), "ontime": ("time",)}
FOLLOWERS |= {"onpause": ("pause",), "onresume": ("resume",)}
ARROWS = "→⇒⟶⟹➔➜➝➞←⇐"
SIGN = re.compile(rf"[=:<>~\-{ARROWS}]+")
ARROW_WORDS = frozenset({"to", "into", "then", "goto", "zu", "nach"})
ANY_WORDS = frozenset({"any", "all", "every", "anything", "everything", "anywhere"})
ASSIGN_WORDS = frozenset({"is", "be", "equals", "becomes", "to"})
UNITS = {
    "": 0,
    **dict.fromkeys(["ms", "msec", "msecs", "millis", "milliseconds", "millisecond"], 1),
    **dict.fromkeys(["s", "sec", "secs", "second", "seconds"], 1000),
    **dict.fromkeys(["min", "minute", "minutes"], 60_000),
}
"""Milliseconds in each unit; 0 where there is none."""
AMOUNT = re.compile(r"([0-9][0-9_]*(?:\.[0-9]*)?(?:[eE][0-9]+)?)([a-zA-Z]*)")


def closest(word: str, known: Iterable[str], cutoff: float) -> str:
    """Return the keyword that a word misspells, or an empty text."""
    swapped = [keyword for keyword in known if sorted(keyword) == sorted(word)]
    return next(iter(swapped or get_close_matches(word, sorted(known), 1, cutoff)), "")
