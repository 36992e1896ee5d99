"""Where the language departs from the paper, and why.

The paper leaves some things open, contradicts itself in others, and the printed example has slips.
Each row is a rule of this implementation that a reader of the paper would not expect.
"""

from __future__ import annotations

from typing import NamedTuple

__all__ = ["DEVIATIONS", "Deviation"]


class Deviation(NamedTuple):
    """One departure: the section of the paper, what is done here, and the reason."""

    section: str
    here: str
    reason: str


DEVIATIONS = (
    Deviation(
        "§3.1",
        "Blocks hold Python instead of Smalltalk.",
        "The paper's footnote 3 allows any imperative language; notebooks and ROS speak Python.",
    ),
    Deviation(
        "§3.1",
        "Several spawns, at the top level and in states, run side by side in the same loop.",
        "The paper lists concurrent machines as future work.",
    ),
    Deviation(
        "§3.1",
        "A wildcard applies to every state but its own destination.",
        "§3.2 lists just these sources; polled conditions would re-enter the destination at every tick.",
    ),
    Deviation(
        "§3.1",
        "`eps` takes no bare `*`.",
        "It would leave and re-enter its destination at every tick.",
    ),
    Deviation(
        "§3.2",
        "The printed listing is an example of located errors; the follower is written anew.",
        "Lines 19, 33 and 35 have brackets too many or too few, line 32 compares where it should assign.",
    ),
    Deviation(
        "§3.2",
        "`exit`, inline conditions, `{…}` and `*-{…}` sources, `onpause`, `onresume`, delay expressions and "
        "events at the top level go beyond the paper.",
        "Its §9 and later programs of its authors ask for them.",
    ),
    Deviation(
        "§5.1",
        "The destination is entered in the tick in which the source is left.",
        "A robot has no gap between onexit and onentry, and one step shows one whole change.",
    ),
    Deviation(
        "§5.1",
        "An enabled transition without a destination is an issue, and the next one is tried.",
        "A name half typed in one transition must not block the others.",
    ),
    Deviation(
        "§5.2",
        "An inner variable may shadow an outer one; a warning says so.",
        "The paper gives this up only because of how its variables are implemented.",
    ),
    Deviation(
        "§6.1",
        "While the active state is gone from the text, the old program runs on until the new one can start.",
        "A name half typed stops no robot.",
    ),
    Deviation(
        "§6.1",
        "A change of what stands inside a nested machine is no change of the state around it.",
        "What a machine contains is not the state's own body; restarting would end most live edits.",
    ),
    Deviation(
        "§6.1",
        'The policy `on_active_edit="keep"` swaps the actions of an active state in place.',
        "Restarting is the paper's rule and the default; researchers want to compare.",
    ),
    Deviation(
        "§6.1",
        "An explicit rename carries the active state, its timer and its variables over.",
        "Typing cannot tell a rename from a removal; a command can.",
    ),
    Deviation(
        "§6.2",
        "Every fault is recorded once with its place, counted, resolved and reopened.",
        "A list that repeats itself at every tick hides what is new.",
    ),
    Deviation(
        "§7.1",
        "Topics are set up in a panel, in Python or on the command line, and kept; no class is asked for.",
        "There is no package class in Python's ROS clients.",
    ),
    Deviation(
        "§7.2",
        "A brick's address is asked once and kept, instead of at every start.",
        "A program restarts often.",
    ),
    Deviation(
        "§7.3",
        "`robot` is one stable object, not an instance of a generated class; a bridge describes its windows "
        "as data and is never hardware by default.",
        "The same bridge serves notebooks and the command line, and nothing drives off by itself.",
    ),
)
