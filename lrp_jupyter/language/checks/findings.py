"""The table of all codes: the meaning of each, with a program that has it and the same program repaired.

It documents the findings and tests them: each example has its own code and no other, and its repaired
program has none.
"""

from __future__ import annotations

from dataclasses import dataclass

from lrp_jupyter.errors import Severity
from lrp_jupyter.language.checks.examples import EXAMPLES

__all__ = ["CODES", "Code"]


@dataclass(frozen=True, slots=True)
class Code:
    """A kind of finding.

    Parameters
    ----------
    code : str
        Never changes: ``LRP301``.
    severity : {"error", "warning", "hint"}
        An error cannot work; a warning works, but probably not as intended; a hint is worth a check.
    title, explanation : str
        A heading, and a few sentences.
    example, repaired : str
        Two programs. Empty for faults that only a running program can show (6xx).
    """

    code: str
    severity: Severity
    title: str
    explanation: str
    example: str = ""
    repaired: str = ""


_TABLE: tuple[tuple[str, Severity, str, str], ...] = (
    ("LRP101", "error", "`(` not closed", "Indentation decides which bracket lacks its `)`."),
    ("LRP102", "error", "Unmatched `)`", "There is no open form that this bracket could close."),
    (
        "LRP103",
        "error",
        "`[` not closed",
        "A block of Python ends with the `]` that matches its `[`; brackets inside it must match too.",
    ),
    (
        "LRP104",
        "error",
        "Wrong sign",
        "Outside blocks there are only brackets, names, numbers, arrows, `:=`, `*` and braces.",
    ),
    (
        "LRP105",
        "error",
        "Outside every form",
        "A program consists of forms in brackets; comments begin with `;` or `#`.",
    ),
    (
        "LRP106",
        "error",
        "Unknown or missing keyword",
        "A `(` is followed by one of the keywords of the language.",
    ),
    (
        "LRP107",
        "error",
        "Form in the wrong place",
        "Each form has its place: states and transitions in machines, actions and nested machines in states.",
    ),
    (
        "LRP108",
        "error",
        "Incomplete or wrongly ordered form",
        "The form does not have the parts of its kind in the right order.",
    ),
    (
        "LRP109",
        "error",
        "Empty block",
        "An action may be empty; a variable, a condition and a delay need a value.",
    ),
    (
        "LRP110",
        "error",
        "Not a valid name",
        "A name is a Python identifier; the name of a variable must not be a Python keyword.",
    ),
    ("LRP111", "error", "Nested too deeply", "The depth of brackets is limited."),
    (
        "LRP112",
        "error",
        "`eps` from every state",
        "It would fire at every tick. Name the states that it leaves.",
    ),
    (
        "LRP113",
        "error",
        "Import or export",
        "LRP has no modules: a program is one text. Python's own modules are imported inside a block.",
    ),
    (
        "LRP114",
        "error",
        "Comment of another language",
        "Comments begin with `;` or `#` and end with their line.",
    ),
    (
        "LRP115",
        "error",
        "Python outside square brackets",
        "Values, conditions and actions are Python, and Python is written between `[` and `]`.",
    ),
    (
        "LRP116",
        "error",
        "Bracket hidden by a comment",
        "A comment ends with its line, so brackets in it close nothing.",
    ),
    (
        "LRP117",
        "error",
        "Action outside an action form",
        "`onentry`, `running` and `onexit` say when the Python of a state runs.",
    ),
    (
        "LRP201",
        "error",
        "Defined twice",
        "The first definition of a name counts; the second is never used.",
    ),
    (
        "LRP202",
        "warning",
        "Variable hides a variable",
        "An inner variable with the name of an outer one is another variable; the blocks inside see only "
        "the inner one.",
    ),
    (
        "LRP203",
        "warning",
        "Variable hides `robot` or `print`",
        "Blocks use the robot as `robot` and the lab's output through `print`, unless a variable has "
        "that name.",
    ),
    (
        "LRP204",
        "warning",
        "Variable hides a builtin of Python",
        "Where a variable has its name, blocks can no longer call Python's own function.",
    ),
    (
        "LRP205",
        "hint",
        "Transitions distinguished only by order",
        "Transitions are identified by kind, sources, destination and name; the condition is their "
        "content. Two that share all four are distinguished by their order, so removing the first looks "
        "like changing both.",
    ),
    (
        "LRP206",
        "warning",
        "Nothing is spawned",
        "A program starts with the machines that it spawns at the top level; there is no implicit start.",
    ),
    (
        "LRP301",
        "error",
        "Unknown event",
        "The transition never fires. Events are looked up in the machine of the transition, then outward.",
    ),
    (
        "LRP302",
        "error",
        "Unknown source",
        "The state does not exist. Only states of its own machine can be sources of a transition.",
    ),
    (
        "LRP303",
        "error",
        "Unknown destination",
        "The transition cannot fire, and the next one is tried. Only `exit` leads out of a machine.",
    ),
    (
        "LRP304",
        "error",
        "Unknown machine",
        "A machine can be spawned by the state that contains it and from inside that state, or from "
        "anywhere if it is at the top level; never by itself or from inside itself.",
    ),
    (
        "LRP305",
        "error",
        "Unknown start state",
        "The machine has no state of that name, so it is not spawned.",
    ),
    (
        "LRP306",
        "error",
        "Unknown state to exit to",
        "`exit` leads to a state of the outer machine: that of the state which spawned this machine.",
    ),
    (
        "LRP307",
        "error",
        "`exit` in a root machine",
        "A machine that is spawned at the top level has no outer machine to which `exit` could lead.",
    ),
    (
        "LRP308",
        "error",
        "Unknown variable as delay",
        "The delay of `ontime` is a number of milliseconds, a variable of the program, or a block.",
    ),
    (
        "LRP401",
        "warning",
        "Unreachable state",
        "No transition and no spawn leads to this state, whatever the robot senses.",
    ),
    (
        "LRP402",
        "warning",
        "Machine never spawned",
        "A nested machine does not start by itself: an `onentry` spawns it and names its start state.",
    ),
    ("LRP403", "hint", "Event never used", "An event is tested only where a transition names it."),
    (
        "LRP404",
        "warning",
        "Transition never tested",
        "Transitions are tested in the order of the text, and the first enabled one fires. This one comes "
        "after another that is enabled whenever it is: an `eps`, the same condition, or the same or a "
        "shorter delay.",
    ),
    (
        "LRP405",
        "warning",
        "State entered again at every tick",
        "An `eps` (or a delay of 0) from a state to itself leaves no tick in which that state could run.",
    ),
    (
        "LRP406",
        "warning",
        "Transition from no state",
        "A wildcard stands for all states except its destination and those named after `*-`; here none "
        "remains.",
    ),
    (
        "LRP407",
        "warning",
        "Spawned twice",
        "A running machine is not spawned again. One that is spawned at the top level never ends.",
    ),
    ("LRP501", "error", "Not valid Python", "Python cannot parse or compile the block."),
    (
        "LRP502",
        "error",
        "Undefined name",
        "A block sees the variables of its machine and of the machines around it, its local names, "
        "Python's builtins, `robot`, `print`, and the names of the notebook.",
    ),
    (
        "LRP503",
        "error",
        "Update of a name without a value",
        "`x += 1` needs an existing value of `x`. A name that is not a variable is local to one run of the "
        "block, even if the notebook has the same name.",
    ),
    (
        "LRP504",
        "warning",
        "Comparison as a statement",
        "`==` compares and `=` assigns; the result of a comparison by itself is lost.",
    ),
    (
        "LRP505",
        "error",
        "Condition or delay without a value",
        "The value of a block is that of its last statement, if that is an expression. This one is "
        "another statement, so the value is always `None`.",
    ),
    (
        "LRP506",
        "warning",
        "Variable without a value",
        "The initialiser ends in a statement, so the variable is `None`.",
    ),
    (
        "LRP507",
        "warning",
        "Named but not called",
        "A member of the robot by itself does nothing; parentheses after it call it.",
    ),
    (
        "LRP508",
        "error",
        "Value of the wrong kind",
        "A condition is `True` or `False`, and nothing else counts as true; a delay is in milliseconds.",
    ),
    (
        "LRP509",
        "warning",
        "`&` inside a comparison",
        "In Python `&` and `|` bind more tightly than `==`: `a == 1 & b` compares `a` with `1 & b`.",
    ),
    (
        "LRP510",
        "error",
        "Sign of another language",
        "Python writes `and`, `or` and `not` as words, assigns with `=` and compares with `==`.",
    ),
    (
        "LRP511",
        "error",
        "Keyword misspelt, or of another language",
        "Python's keywords are written in small letters, and `else if` is `elif`.",
    ),
    (
        "LRP512",
        "error",
        "`:` missing or superfluous",
        "`if`, `while`, `for`, `def` and their like end with `:`; no other line does.",
    ),
    (
        "LRP513",
        "error",
        "Bracket missing or superfluous in a block",
        "Each `(` needs its `)`, each `[` its `]`.",
    ),
    ("LRP514", "error", "String not closed", "A string ends with the quote that it begins with."),
    (
        "LRP515",
        "error",
        "Wrong indentation",
        "The lines that belong to an `if` or `for` begin further right, all in the same column.",
    ),
    ("LRP516", "error", "`=` in the wrong place", "`=` assigns and names arguments, `==` compares."),
    (
        "LRP517",
        "error",
        "Two values without a sign between them",
        "A call needs parentheses, arguments need commas, and the parts of a name are joined by dots.",
    ),
    (
        "LRP518",
        "warning",
        "Sign that means something else in Python",
        "`0,5` is two numbers, `x: 5` assigns nothing, `x =+ 1` assigns 1, and `^` is not a power.",
    ),
    (
        "LRP520",
        "error",
        "Unknown member of the robot",
        "The robot has only the members that its bridge offers; in a simulated world, those of its robot.",
    ),
    (
        "LRP521",
        "error",
        "Wrong arguments of a method of the robot",
        "A method accepts the arguments that its signature names. Numbers of a command are passed by name.",
    ),
    (
        "LRP522",
        "error",
        "Sensor instead of its value",
        "`robot.distance` is the sensor; its value is `robot.distance.data`.",
    ),
    (
        "LRP523",
        "error",
        "Member of the robot assigned",
        "Readings are only read and methods are only called. Values are kept in variables.",
    ),
    (
        "LRP524",
        "error",
        "Value called, or method not called",
        "A reading is written without parentheses, and a method does nothing without them.",
    ),
    (
        "LRP525",
        "error",
        "Values that cannot be compared",
        "A number is neither smaller nor larger than a text.",
    ),
    (
        "LRP526",
        "warning",
        "Comparison that never changes",
        "Values of different kinds are never equal.",
    ),
    (
        "LRP527",
        "warning",
        "Value that is not compared",
        "`x == 1 or 2` is `(x == 1) or 2`: each side of `or` and `and` stands alone.",
    ),
    (
        "LRP528",
        "warning",
        "`is` with a number or text",
        "`is` asks whether two names stand for one object; `==` compares values.",
    ),
    (
        "LRP529",
        "warning",
        "Assigned in a function only",
        "An assignment in a function makes a name of its own, unless the function declares it `nonlocal`.",
    ),
    (
        "LRP530",
        "hint",
        "Local name that nothing reads",
        "A name that is not a variable of the program is forgotten at the end of the block.",
    ),
    (
        "LRP540",
        "warning",
        "Loop without a way out",
        "A block runs within one tick: while it loops, nothing else runs and no edit is applied. `running` "
        "is repeated at every tick, so it needs no loop of its own.",
    ),
    (
        "LRP541",
        "warning",
        "Loop that waits for a change",
        "Sensors are read once per tick and variables are changed by blocks only, so inside the loop the "
        "condition keeps its value. States wait: a transition tests the condition at every tick.",
    ),
    (
        "LRP542",
        "warning",
        "Sleeping block",
        "A block runs within one tick: while it sleeps, nothing else runs, no edit is applied and the robot "
        "keeps its last command. States wait, with `ontime`.",
    ),
    (
        "LRP543",
        "warning",
        "Block that waits for typing",
        "A running program has no place for typing an answer. Its variables can be set at any time.",
    ),
    (
        "LRP601",
        "error",
        "Exception in a block",
        "What the block did before it is kept; the traceback shows the line.",
    ),
    (
        "LRP602",
        "error",
        "Condition not boolean",
        "It counts as false. Write a comparison, or `bool(…)` around it.",
    ),
    ("LRP603", "error", "Unknown event", "The transition is ignored until the event exists."),
    ("LRP604", "error", "Unknown state", "The transition or the spawn is ignored until the state exists."),
    ("LRP605", "error", "Unknown machine", "The spawn is ignored until the machine exists."),
    ("LRP606", "error", "Unknown variable", "The block or the delay names a variable that does not exist."),
    ("LRP607", "error", "Delay not a number", "The timeout never fires."),
    ("LRP608", "error", "Machine already running", "A running machine is not spawned again."),
    ("LRP609", "error", "Defined twice", "The first definition counts."),
    (
        "LRP610",
        "hint",
        "No data yet",
        "A reading of the robot has not arrived; an event that needs it does not occur.",
    ),
    (
        "LRP611",
        "error",
        "Block did not return",
        "A block runs within one tick: meanwhile nothing else runs, and no edit is applied. It was "
        "interrupted. States wait, with `ontime` or for an event; blocks do not.",
    ),
    (
        "LRP690",
        "warning",
        "Edit waits",
        "A block has not returned yet; the edit is kept and applied when it does.",
    ),
    (
        "LRP698",
        "hint",
        "More findings",
        "Only the first 200 findings of a text are listed, errors before others.",
    ),
    (
        "LRP699",
        "warning",
        "Checks failed",
        "A fault of the checks themselves, not of the program: it runs, unchecked. Please report it.",
    ),
)

CODES: dict[str, Code] = {
    row[0]: Code(*row, *EXAMPLES.get(row[0], "").strip().partition("\n---\n")[::2]) for row in _TABLE
}
"""Every code, in order."""
