"""The rules of the language that differ from the paper, and why.

The paper leaves some points open and contradicts itself on others, and its printed example has slips.
Each row is a rule of this implementation that a reader of the paper would not expect.
"""

from __future__ import annotations

from typing import NamedTuple

__all__ = ["DEVIATIONS", "Deviation"]


class Deviation(NamedTuple):
    """One departure from the paper: its section, the rule implemented here, and the reason."""

    section: str
    here: str
    reason: str


DEVIATIONS = (
    Deviation(
        "§3.1",
        "Blocks hold Python instead of Smalltalk; a block of Smalltalk is one error, with the same in "
        "Python.",
        "The paper's footnote 3 allows any imperative language; notebooks and ROS speak Python.",
    ),
    Deviation(
        "§3.1",
        "Several spawns, at the top level and in states, run side by side in the same loop.",
        "The paper lists concurrent machines as future work.",
    ),
    Deviation(
        "§3.1",
        "A wildcard applies to every state except its own destination.",
        "§3.2 lists exactly these sources; with polled conditions the destination would be re-entered at "
        "every tick.",
    ),
    Deviation(
        "§3.1",
        "`eps` does not accept a bare `*`.",
        "The transition would fire at every tick.",
    ),
    Deviation(
        "§3.1",
        "Wildcard transitions are tested among the others, in the order of the text.",
        "This section says that the first one in the text fires, while step 3 of §5.1 adds the wildcards to "
        "the others.",
    ),
    Deviation(
        "§3.2",
        "The printed listing becomes a program by the fixes of its errors; the bundled `paper-listing` is "
        "that program, line by line, with a comment wherever it says something else.",
        "Lines 19, 33 and 35 have too many or too few brackets; line 32 compares where it should assign, and "
        "stands where the assignment would end the program at the first wall; line 35 turns at `search`.",
    ),
    Deviation(
        "§3.2",
        "`exit`, inline conditions, `{…}` and `*-{…}` sources, `onpause`, `onresume`, delay expressions and "
        "top-level events are additions.",
        "The paper's §9 and later programs by its authors call for them.",
    ),
    Deviation(
        "§4",
        "A destination that does not exist is drawn, dashed, and the transition leads to it.",
        "In the paper the transition is not shown; here one sees what it lacks.",
    ),
    Deviation(
        "§5.1",
        "The delay of the loop is not waited for between steps 7 and 2: the destination is entered in the "
        "tick in which the source is left.",
        "There is no gap between `onexit` and `onentry`, and a single step shows the whole transition.",
    ),
    Deviation(
        "§5.1",
        "A state is left in the tick after its entry at the earliest, by a transition that is enabled then.",
        "The delay has to be somewhere, or the states between two conditions that hold would not be seen.",
    ),
    Deviation(
        "§5.1",
        "An enabled transition whose destination does not exist is an issue, and the next transition is "
        "tried.",
        "A half-typed name in one transition must not block the others.",
    ),
    Deviation(
        "§5.2",
        "An inner variable may shadow an outer one; a warning says so.",
        "The paper rules this out only because of how its variables are implemented.",
    ),
    Deviation(
        "§6.1",
        "If the active state disappears from the text, the old program keeps running until the new one can "
        "start.",
        "A half-typed name must not stop the robot.",
    ),
    Deviation(
        "§6.1",
        "In the lab, a half-typed name that brings an error is applied only when the cursor leaves it or "
        "after 700 ms, and a number after 400 ms; the rest of the text is applied at once.",
        "Otherwise the letters of one word would stop or restart the program several times.",
    ),
    Deviation(
        "§6.1",
        "In the lab, an error in an active state is not applied while the cursor is inside that state.",
        "A form that is not complete yet must not restart the program.",
    ),
    Deviation(
        "§6.1",
        "A change inside a nested machine does not count as a change of the state that contains it.",
        "A nested machine is not part of the state's own body, and otherwise most live edits would restart "
        "the program.",
    ),
    Deviation(
        "§6.1",
        'The policy `on_active_edit="keep"` replaces the actions of an active state in place.',
        "Restarting is the paper's rule and the default; the policy makes the two comparable.",
    ),
    Deviation(
        "§6.1",
        "An edited initialiser initialises its variable anew, and those that are computed from it; an "
        "assignment changes one variable only.",
        "In §4 an increased `maxlook` widens the sweeps at once, although they are timed by a variable that "
        "is computed from it.",
    ),
    Deviation(
        "§6.1",
        "An explicit rename keeps the active state, its timer and its variables.",
        "A rename by typing looks like a removal; a rename command is unambiguous.",
    ),
    Deviation(
        "§6.2",
        "Every fault is recorded once with its location, counted, resolved and, if it returns, reopened.",
        "A list that grows at every tick hides what is new.",
    ),
    Deviation(
        "§6.4",
        "Teleporting to a state executes the spawns in its `onentry`, but none of its actions.",
        "Otherwise a state that contains a machine would be active without it.",
    ),
    Deviation(
        "§6.5",
        "A transition that fires glows for a moment in the graph, and so does a state that is left before it "
        "can be seen.",
        "At ten ticks per second a visit of a single tick is too short to see.",
    ),
    Deviation(
        "§7.1",
        "Topics are configured in a panel, in Python or on the command line, and saved; no class has to be "
        "named.",
        "Python's ROS clients have no package class.",
    ),
    Deviation(
        "§7.2",
        "The address of a brick is asked for once and saved, not at every start.",
        "Programs restart often.",
    ),
    Deviation(
        "§7.3",
        "`robot` is one stable object, not an instance of a generated class; a bridge describes its panels "
        "as data, and hardware is never the default.",
        "The same bridge works in notebooks and on the command line, and no robot starts moving unasked.",
    ),
)
