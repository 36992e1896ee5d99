"""Spellings of keywords in other languages, and misspellings of them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from difflib import get_close_matches


def by_word(words: Mapping[str, str]) -> dict[str, str]:
    """Return what is said for each of several words, by word."""
    return {word: said for said, several in words.items() for word in several.split()}


OTHERS = {
    word: tuple(meant.split())
    for word, meant in by_word(
        {
            "var": "let variable const def define set int float global param parameter constant assign",
            "event": "condition trigger sensor guard signal",
            "machine": "statemachine fsm automaton sm",
            "state": "node mode final",
            "spawn": "launch instantiate invoke call",
            "onentry": "entry enter onenter onstart init entryaction",
            "onexit": "leave onleave exitaction",
            "running": "doactivity during whilerunning action",
            "ontime": "after timeout wait delay timer ontimeout every sleep timed",
            "onpause": "pause",
            "onresume": "resume",
            "onend": "onstop onclose onfinish finally shutdown onshutdown cleanup teardown atexit",
            "eps": "epsilon immediate immediately otherwise else default auto automatic true",
            "running eps": "always",
            "exit": "return break",
            "on eps": "transition trans goto arrow edge go move",
            "on": "when if event",
            "spawn onentry": "start begin",
            "spawn running": "run loop do execute while",
            "onexit exit onend": "end finish stop",
        }
    ).items()
}
"""The keywords that correspond to those of other languages, by their words in lower case and without `_`."""
_EPSILON = "A transition without a condition is an `eps`, and the order of the text decides. Write `eps`."
NOT_SENT = "Events are not sent: they are conditions, tested at every tick. Set a variable, and test it."
_PARALLEL = "Machines that one `onentry` spawns run side by side. Write a `spawn` for each."
_CHOICE = "A state chooses between its own transitions, in the order of the text. Write them there."
_MOVE = "A state is left by a transition of its machine. Write `(on event source -> destination)`."
_DONE = "The machine outside can ask for any state, as in `(on machine.state a -> b)`. Write `state`."
REMARKS = by_word(
    {
        _EPSILON: "always otherwise else default auto automatic immediately true",
        NOT_SENT: "emit raise send dispatch broadcast fire notify post publish",
        _PARALLEL: "parallel region regions orthogonal fork concurrent concurrence",
        _CHOICE: "choice junction decision",
        _MOVE: "goto jump go",
        _DONE: "final outcome outcomes done",
        "The `spawn` of a machine names its first state. Remove this.": "initial initialstate",
        "There are no history states. Keep where to resume in a variable outside the machine.": "history",
        'Ask both machines, as in `(on [m.state == "done" and n.state == "done"] a -> b)`.': "join",
    }
)
"""What to write in place of a concept of other languages, by its words in lower case and without `_`."""
NO_EVENTS = {
    **dict.fromkeys(["always", "otherwise", "else", "true"], _EPSILON),
    **dict.fromkeys(
        ["timeout", "after"], "A delay is an `ontime`. Write `(ontime milliseconds source -> destination)`."
    ),
}
"""What to write in place of an event that has such a name and is not defined."""
LAST = frozenset({"otherwise", "else", "default"})
"""What comes last wherever it stands."""
MODULES = frozenset({"import", "export", "from", "include", "require", "use", "using", "module"})
FOLLOWERS: dict[str, tuple[str, ...]] = {
    "onentry": ("entry", "enter", "start"),
    "onexit": ("exit", "leave", "end"),
    "ontime": ("time", "after", "timeout"),
    "onpause": ("pause",),
    "onresume": ("resume",),
    "onend": ("end", "stop", "close", "finish"),
}
ARROWS = "→⇒⟶⟹➔➜➝➞←⇐"
SIGN = re.compile(rf"[=:<>~\-{ARROWS}]+")
ARROW_WORDS = frozenset({"to", "into", "then", "goto", "zu", "nach"})
ANY_WORDS = frozenset({"any", "all", "every", "anything", "everything", "anywhere"})
JOINING = {
    **dict.fromkeys(["and", "&&", "&", "if", "when", "where", "with", "provided"], "and"),
    **dict.fromkeys(["or", "||", "|"], "or"),
    **dict.fromkeys(["not", "!"], "not"),
    ",": ",",
    "unless": "and not",
}
"""What stands between conditions, as Python writes it; a comma means one thing here and another there."""
HOLDING = frozenset({"for", "during", "hold", "holds", "holding", "lasting"})
"""What is written in place of `for`."""
GUARD_WORDS = frozenset({"guard", "cond", "condition", "if", "when", "where", "given"})
ASKING = frozenset({"in", "In", "in_state", "instate", "inState", "is_in", "isIn", "done", "final"})
EFFECT_WORDS = frozenset(
    {"/", ":", "=>", "do", "then", "effect", "effects", "action", "actions", "execute", "assign"}
)
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
