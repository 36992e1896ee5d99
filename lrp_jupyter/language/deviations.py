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
        "Blocks contain Python, not Smalltalk; a Smalltalk block is reported as one error that shows the "
        "same in Python.",
        "The paper's footnote 3 allows any imperative language; notebooks and ROS speak Python.",
    ),
    Deviation(
        "§3.1",
        "Several spawns, at the top level and in states, run side by side in the same loop. A machine runs "
        "once in each state that spawns it, with its own variables, and never inside itself.",
        "The paper leaves concurrent machines to future work (§9); a behaviour that is used several times "
        "should be written once.",
    ),
    Deviation(
        "§3.1",
        "In a block, the name of an event is the value of its block, and the name of a machine gives its "
        "active state and its variables.",
        "In the paper only transitions use events, so that a condition would have to be written twice. The "
        "value is computed only where it is used, as §5.1.1 does for transitions.",
    ),
    Deviation(
        "§3.1",
        "A block that does not return is named after two seconds and the robot stopped; an edit or command "
        "that has to wait for it interrupts it.",
        "Actions are atomic, so an endless loop would otherwise block every edit.",
    ),
    Deviation(
        "§3.1",
        "A wildcard applies to every state except its own destination.",
        "§3.2 lists exactly these sources; otherwise the destination would be re-entered again and again "
        "while the condition holds.",
    ),
    Deviation(
        "§3.1",
        "An epsilon transition cannot start from a bare `*`: `(eps * -> a)` is an error.",
        "Every other state of the machine would be left as soon as it is entered.",
    ),
    Deviation(
        "§3.1",
        "Wildcard transitions are tested among the others, in the order of the text.",
        "§3.1 says that the first one in the text fires, while step 3 of §5.1 adds the wildcards to the "
        "others.",
    ),
    Deviation(
        "§3.2",
        "Accepting the fix of each error turns the printed listing into a valid program; the bundled "
        "`paper-listing` keeps its lines and has a comment at each one that it corrects.",
        "Lines 19, 33 and 35 have too many or too few brackets; line 32 compares instead of assigning, and "
        "assigning there rather than in `bumpturn` would end the program at the first bump; line 35 turns "
        "by `search` and leaves `turn` unused.",
    ),
    Deviation(
        "§3.2",
        "`exit`, inline conditions, `{…}` and `*-{…}` sources, `onpause`, `onresume`, `onend`, delay "
        "expressions, top-level events, several blocks in one action and comments are additions.",
        "Some are plans of the paper (§9), and later programs by its authors call for others.",
    ),
    Deviation(
        "§3.2",
        "The state of a machine as a condition (`MACHINE.STATE`), conditions that must hold (`for`), the "
        "`effect` of a transition, settings of a spawn, `elapsed` and `dt` are additions, too.",
        "Without them, programs need states that only report an end, measure a time or do what belongs to a "
        "transition, and copies of machines that differ in a number.",
    ),
    Deviation(
        "§3.2",
        "The fields of a message are arguments, as in `robot.move(linear=0.2)`; `with robot.move as msg:` "
        "fills it field by field.",
        "The paper fills a message in a block with a parameter; in Python that would be a `lambda`, which "
        "cannot assign.",
    ),
    Deviation(
        "§4",
        "A transition to a state that does not exist is drawn, leading to a dashed placeholder.",
        "In the paper it is not shown; here one sees which state is missing.",
    ),
    Deviation(
        "§5.1",
        "There is no delay between steps 7 and 2: the destination is entered in the tick in which the "
        "source is left.",
        "So nothing happens to the robot between `onexit` and `onentry`, and a single step shows the whole "
        "transition.",
    ),
    Deviation(
        "§5.1",
        "A state is left in the tick after its entry at the earliest, by a transition that is enabled in "
        "that later tick.",
        "In the paper a state can be entered and left in one pass of the loop; here each one is active at "
        "the end of at least one tick and can be seen.",
    ),
    Deviation(
        "§5.1",
        "A nested machine is entered when step 2 spawns it, but its transitions are tested only in step 5, "
        "after those of the state that contains it.",
        "If all of it were interpreted in step 2, inner transitions would be tested before outer ones, "
        "against §5.1.2.",
    ),
    Deviation(
        "§5.1",
        "The delay of a timeout is evaluated whenever the transition is tested, not when the state is "
        "entered.",
        "In §4 an increased `maxlook` widens the sweeps at once.",
    ),
    Deviation(
        "§5.2",
        "The variables of a machine are initialised whenever it is spawned.",
        "As class variables they would keep their values; §3.2 discards the machine, so that each search "
        "begins with a short sweep.",
    ),
    Deviation(
        "§5.2",
        "An inner variable may shadow an outer one; a warning says so.",
        "The paper rules this out only because its variables are class variables of Smalltalk.",
    ),
    Deviation(
        "§6.1",
        "If the active state disappears from the text, the old program keeps running until the text has a "
        "`spawn` that can start.",
        "A half-typed name must not stop the robot.",
    ),
    Deviation(
        "§6.1",
        "In the lab, a half-typed name that causes an error is applied only when the cursor leaves it or "
        "after 700 ms, and a number after 400 ms; the rest of the text is applied at once.",
        "Otherwise a program could be stopped or restarted several times while one word is typed.",
    ),
    Deviation(
        "§6.1",
        "In the lab, a change that puts an error into an active state is not applied while the cursor is "
        "inside that state.",
        "An unfinished form must not restart the program.",
    ),
    Deviation(
        "§6.1",
        "A change inside a nested machine, or an added one, does not count as a change of the state that "
        "contains it.",
        "In §4 only the added `spawn` changes the active state; if every inner change did, most live edits "
        "would restart the program.",
    ),
    Deviation(
        "§6.1",
        "Changing or removing a top-level `spawn` restarts the program if there is one that can start; an "
        "added one starts at once.",
        "The paper does not say; the text then shows what runs.",
    ),
    Deviation(
        "§6.1",
        'With the policy `on_active_edit="keep"`, new actions of an active state replace the old ones '
        "without a restart.",
        "Restarting is the paper's rule and the default; the policy makes the two comparable.",
    ),
    Deviation(
        "§6.1",
        "Editing an initialiser, or the setting of a spawn, reinitialises its variable and those that are "
        "computed from it; an assignment changes one variable only.",
        "In §4 an increased `maxlook` widens the sweeps at once, although they are timed by a variable "
        "that is computed from it.",
    ),
    Deviation(
        "§6.1",
        "An explicit rename keeps the active state, its timer and its variables.",
        "A rename by typing looks like a removal; a command is unambiguous, and §9 plans one.",
    ),
    Deviation(
        "§6.2",
        "Every fault is recorded once, with its location and a count; it is resolved when its block runs "
        "without it, and reopened if it returns.",
        "A list that grows at every tick hides what is new.",
    ),
    Deviation(
        "§6.2",
        "A transition to a state that does not exist does not block those after it in the text: the next "
        "enabled one fires.",
        "The paper says only that such a transition never triggers; a half-typed name must not disable the "
        "others.",
    ),
    Deviation(
        "§6.2",
        'At an error the program can be paused (`on_issue="pause"`), at the end of the tick; a debugger is '
        "opened by hand, afterwards.",
        "A debugger that opened inside a tick would hold up the loop while the robot moves.",
    ),
    Deviation(
        "§6.3",
        "A pause stops the robot and the timers; a restart stops the robot, too.",
        "In the paper a motor that was started by an `onentry` keeps running (§9).",
    ),
    Deviation(
        "§6.4",
        "Teleporting to a state executes the spawns in its `onentry`, but none of its actions.",
        "Otherwise a state that contains a machine would be active without it.",
    ),
    Deviation(
        "§6.4",
        "A state can be forced even if its machine is not running: the states around it become active, with "
        "all the machines that they spawn.",
        "An inner state can thus be tried before anything leads there.",
    ),
    Deviation(
        "§6.5",
        "A transition that fires glows for a moment in the graph, and so does a state that is left before "
        "it can be seen.",
        "At ten ticks per second, a visit of a single tick is too short to see.",
    ),
    Deviation(
        "§7",
        "A bridge to hardware sends nothing that moves the robot until it is armed, limits what is sent, "
        "and stops the robot when ticks or data stop coming.",
        "A careless live edit can damage a robot, as §8 remarks.",
    ),
    Deviation(
        "§7.1",
        "Topics are configured in a panel, in Python or on the command line, and saved; no class has to be "
        "named.",
        "Python's ROS clients have no package class.",
    ),
    Deviation(
        "§7.1",
        "Before the first message of a topic, a condition that reads it is false, and any other block that "
        "reads it ends with an issue.",
        "The paper does not say what is read then; a made-up value would not be safe.",
    ),
    Deviation(
        "§7.1",
        "A robot is also asked for tasks: goals of actions, services, a turn. A request belongs to the visit "
        "of the state whose action makes it, and ends, with its outcome, when that state is left.",
        "The authors' own programs empty a variable and wait until it is set; then an old result can be "
        "taken for a new one, and a goal goes on when nothing waits for it any more.",
    ),
    Deviation(
        "§7.1",
        "`robot.order.new` has every message since the last tick, once.",
        "A topic's last message alone hides those before it, and cannot tell a repeated one from an old one.",
    ),
    Deviation(
        "§7.2",
        "A brick is found by the beacon that it sends, or its address is asked for once and saved, instead "
        "of at every start.",
        "The address of a brick seldom changes.",
    ),
    Deviation(
        "§7.3",
        "`robot` is one stable object, not an instance of a generated class; a bridge describes its panels "
        "as data, and hardware is never the default.",
        "The same bridge works in notebooks and on the command line, and no robot starts moving unasked.",
    ),
)
