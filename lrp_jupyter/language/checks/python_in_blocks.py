"""5xx: Python in blocks that cannot do what it is probably meant to do.

Paper: §3.2 (line 32 of the listing compares where it should assign), §9.
"""

from __future__ import annotations

import math
import random
import sys
from collections.abc import Iterable
from functools import cached_property
from itertools import chain

from lrp_jupyter.language.blocks.builtin_names import PROVIDED, TIMES
from lrp_jupyter.language.checks.block_facts import Facts, facts_of
from lrp_jupyter.language.checks.called_forms import form_calls
from lrp_jupyter.language.checks.clocks import unimported
from lrp_jupyter.language.checks.computed_uses import meanings, means
from lrp_jupyter.language.checks.creations import new_variable
from lrp_jupyter.language.checks.defined_names import BUILTINS
from lrp_jupyter.language.checks.report import Reporter, replace
from lrp_jupyter.language.checks.robot_uses import Remedied, check_robot, compared, suspicious_uses
from lrp_jupyter.language.program import Edit, Fix, Span, path_text
from lrp_jupyter.language.resolution import HOLD, PlacedBlock, Resolution, Scope
from lrp_jupyter.language.robot_members import RobotMembers

_STATEMENTS = frozenset({"return", "pass", "break", "continue"})
"""Keywords that are a statement by themselves: misspelt, they are names."""
_SPELT = {
    **dict.fromkeys(["nil", "null", "undefined"], "None"),
    **dict.fromkeys(["on", "yes"], "True"),
    **dict.fromkeys(["off", "no"], "False"),
    **dict.fromkeys(["inf", "infinity", "Infinity"], 'float("inf")'),
    "self": "robot",
}
"""Names from other languages, for which `difflib` would find no similar name."""
_IN_MODULES = {
    name: module.__name__
    for module in (random, math)
    for name in dir(module)
    if name[:1].islower() and len(name) > 1
}
"""Where a function is that is probably meant by its name alone."""
_NO_MOVE = "A block cannot change the state. Write a transition, as in"


def check_python(report: Reporter, names: Resolution, robot: RobotMembers | None) -> None:
    """Report what is wrong inside the blocks of a program."""
    _Python(report, names, robot).check()


class _Python:
    def __init__(self, report: Reporter, names: Resolution, robot: RobotMembers | None) -> None:
        self.report = report
        self.robot = robot
        self.scopes = names.scopes
        self.blocks = tuple(names.all_blocks)
        self.names = names
        self.outside = frozenset(report.names)
        self._meant: dict[Scope, tuple[str, ...]] = {}
        self.known = BUILTINS | PROVIDED | self.outside

    def check(self) -> None:
        for place in self.blocks:
            facts = facts_of(place.block.text)
            self._names(place, facts)
            self._values(place, facts, self._robot(place))

    # The robot

    def _robot(self, place: PlacedBlock) -> set[Span]:
        """Report wrong uses of the robot; return their places."""
        if self.robot is None or "robot" in place.visible:
            return set()

        def is_number(name: str) -> bool:
            scope = place.visible.get(name)
            literal = facts_of(scope.variables[name].initial.text).literal if scope else None
            is_literal = literal is not None and literal[0] == "a number"
            return is_literal and (scope, name) not in self._set_otherwise

        wrong = set()
        for use, known in suspicious_uses(place.block.text, self.robot, place.purpose):
            remedied = known or check_robot(use, self.robot, place.purpose, is_number)
            if remedied is not None:
                wrong.add(use.span)
                self._remedied(place, remedied)
        return wrong

    def _remedied(self, place: PlacedBlock, remedied: Remedied) -> None:
        code, span, message, fix = remedied
        if fix is not None:
            at = place.block.at
            edits = tuple(Edit(*at(Span(start, end)), text) for start, end, text in fix.edits)
            fix = Fix(fix.title, edits)
        self.report.add(code, place.block.at(span), message, fix)

    @cached_property
    def _numbers(self) -> set[tuple[Scope | None, str]]:
        """The variables that begin as a number, and to which no block assigns anything else."""
        found: set[tuple[Scope | None, str]] = set()
        for scope in self.scopes:
            for name, variable in scope.variables.items():
                literal = facts_of(variable.initial.text).literal
                if literal and literal[0] == "a number":
                    found.add((scope, name))
        for place in self.blocks:
            facts = facts_of(place.block.text)
            found -= {(place.visible.get(name), name) for name in facts.binds if name not in facts.numbers}
        return found - self._set_otherwise

    @cached_property
    def _set_otherwise(self) -> set[tuple[Scope | None, str]]:
        """The variables that a spawn may initialise with something else than a number."""
        return {
            (spawning.machine, str(setting.name))
            for spawning in self.names.spawns
            for setting in spawning.noun.settings
            if (literal := facts_of(setting.initial.text).literal) is None or literal[0] != "a number"
        }

    # Names

    def _names(self, place: PlacedBlock, facts: Facts) -> None:
        visible = place.visible
        stated = [each for each in facts.comparisons if place.purpose == "action" or not each.last]
        meant = {remark.name for remark in stated if remark.edit}  # `x == 1` for `x = 1`
        explained = self._form_calls(place)
        for name, span, _ in facts.reads:
            if name in meant or any(start <= span.start < end for start, end in explained):
                continue
            if self._is_undefined(place, name):
                problem = f"`{name}` is not defined where this block can see it"
                known = chain(visible, facts.binds), self._meanings(place.scope), self.known, _STATEMENTS
                self._unknown("LRP502", place, name, span, problem, *known)
        for name, span, _ in facts.nonlocals:
            if name not in visible:
                problem = f"There is no variable `{name}` that could be `nonlocal` here"
                self._unknown("LRP502", place, name, span, problem, chain(visible, facts.binds))
        for name, span, nested in facts.augmented:
            if name not in visible and name not in meant and not (nested and name in facts.binds):
                problem = f"`{name}` is not a variable here, so it has no value to change"
                self._unknown("LRP503", place, name, span, problem, chain(visible, facts.binds))
        for inner in facts.inner:
            if inner.name in visible or inner.name in facts.binds:
                code = "LRP529" if inner.lost else "LRP503"
                what = ", so the variable does not change" if inner.lost else " and has no value"
                word = f"nonlocal {inner.name}"
                message = f"`{inner.name}` is local to this function{what}. Write `{word}` first."
                fix = Fix(f"Insert `{word}`", (inner.edit,))
                self._remedied(place, Remedied(code, inner.span, message, fix))
        if place.purpose == "action":
            for name, span, _ in facts.unread:
                if name not in TIMES and means(place, name, self.outside):
                    what = "an event" if place.event(name) else "a machine"
                    problem = f"`{name}` is {what}, and this is a name of this block only that nothing reads"
                    self._add("LRP530", place, span, f"{problem}. Declare a variable with another name.")
                    continue
                if name not in visible and (name == "state" or name in self._states):
                    others = {read for read, _, _ in facts.reads} & self._states
                    if not any(self._is_undefined(place, read) for read in others):
                        problem = f"`{name}` is a name of this block only, and nothing reads it"
                        remedy = f"{_NO_MOVE} `(on event source -> destination)`."
                        self._add("LRP530", place, span, f"{problem}. {remedy}")
                    continue
                similar = None if name in visible else self.report.nearest(name, visible)
                if similar and name not in self._undefined:
                    problem = f"`{name}` is a name of this block only, and nothing reads it"
                    self._add("LRP530", place, span, f"{problem}. Did you mean `{similar}`?", similar)

    def _form_calls(self, place: PlacedBlock) -> list[Span]:
        """Report the calls of what only forms do; return their places."""
        found = []
        for call in form_calls(place.block.text):
            if call.root in place.visible or call.root in self.known:
                continue
            found.append(call.whole)
            is_onentry, fix = place.element.kind == "onentry", None
            if is_onentry and call.is_alone and len(call.spawned) == 2:
                machine, state = call.spawned
                scope = place.scope.machine(place.element.path[-1], machine)
                if scope is not None and state in scope.states:
                    fix = replace(place.block.span, f"(spawn {machine} {state})")
            self.report.add("LRP502", place.block.at(call.span), call.remedy(is_onentry), fix)
        return found

    @cached_property
    def _undefined(self) -> set[str]:
        """Names that some block reads although nothing defines them: that is reported there."""
        return {
            word.name
            for place in self.blocks
            for word in facts_of(place.block.text).reads
            if self._is_undefined(place, word.name)
        }

    def _meanings(self, scope: Scope) -> tuple[str, ...]:
        if scope not in self._meant:
            self._meant[scope] = meanings(scope, self.names)
        return self._meant[scope]

    def _is_undefined(self, place: PlacedBlock, name: str) -> bool:
        if name in place.visible or name in self.known or name.startswith("__"):
            return False
        return not means(place, name, self.outside)

    def _unknown(
        self, code: str, place: PlacedBlock, name: str, span: Span, problem: str, *known: Iterable[str]
    ) -> None:
        """Report an unknown name, with a remedy."""
        elsewhere = self._elsewhere(place, name)
        groups = [tuple(names) for names in known]
        prefix = any(each.startswith(name) for names in groups for each in names)
        similar = (self.report.nearest(name, names) for names in groups)
        meant = _SPELT.get(name) or next(filter(None, similar), None)
        if meant in BUILTINS and name not in _SPELT and meant[:1].lower() != name[:1].lower():
            meant = None  # of that many names, one is always a little similar
        remedy = f"{problem}. Declare `(var {name} := [value])`."
        creatable = name not in self._variables and not place.scope.event(name)
        creatable &= name not in self.names.computed[1]
        if elsewhere:
            remedy, meant = f"{problem}. {elsewhere}.", None
        elif self.robot is not None and name in self.robot.inside("") and meant not in place.visible:
            meant = f"robot.{name}"
            remedy = f"{problem}. Write `{meant}`."
        elif name in sys.stdlib_module_names and meant not in place.visible:
            remedy = f"`{name}` is not imported. Write `import {name}` before it."
            remedy, meant = unimported(place.block.text, span.start) or remedy, None
            creatable = False
        elif machine := self._machine_in(place, name):
            remedy, meant = f"`{name}` is a state of `{machine}`. Write its name in quotes.", f'"{name}"'
            creatable = False
        elif instead := self._no_variable(name) if meant not in place.visible else "":
            remedy, meant, creatable = instead, None, False
        elif _is_said(place.block.text, span):
            remedy, meant = f'{problem}. If it is a text, write it in quotes: `"{name}"`.', f'"{name}"'
        elif meant:
            remedy = f"{problem}. Did you mean `{meant}`?"
            creatable &= name not in _SPELT
        creates = new_variable(self.report, name) if creatable else None
        self._add(code, place, span, remedy, meant, prefix=prefix, creates=creates)

    def _no_variable(self, name: str) -> str:
        """Return what to write in place of a name that is not meant as one of a variable; else nothing."""
        if name in self._states:
            return f"`{name}` is a state, not a value. {_NO_MOVE} `(on event source -> {name})`."
        if name == "state":
            return "`state` is not defined. For the state of a machine that runs, write `machine.state`."
        module = "" if name in _SPELT else _IN_MODULES.get(name, "")
        if module:
            what = f"`{name}` is in the module `{module}`"
            return f"{what}. Write `import {module}` before it, and `{module}.{name}` here."
        return ""

    def _machine_in(self, place: PlacedBlock, state: str) -> str | None:
        """Return the machine with a state of this name whose state the block asks for."""
        reads = (word.name for word in facts_of(place.block.text).reads)
        machines = ((name, place.machines(name)) for name in reads if f"{name}.state" in place.block.text)
        return next((name for name, found in machines if any(state in each.states for each in found)), None)

    def _elsewhere(self, place: PlacedBlock, name: str) -> str | None:
        """Return what a name is that is out of scope in this block, and a remedy; None for any other name."""
        if place.scope.event(name):
            itself = place.event(name) is None
            return "It is this event itself" if itself else "It is an event, and blocks can only read it"
        if name in place.scope.path[::2]:
            return "It is a machine around this block, whose variables are read without its name"
        if name in self._variables:
            scope = self._variables[name]
            if scope.path == place.scope.path[: len(scope.path)]:
                return "The variable is initialised later. Declare it first"
            return f"The variable belongs to `{path_text(scope.path)}`. Declare it further out"
        if name in self._assigned:
            line = self.report.line(self._assigned[name])
            return f"Line {line} sets it only in its own block. Declare `(var {name} := [value])` to keep it"
        if name in self.names.computed[1]:
            return "It is a machine that is out of scope here. Move it outward"
        return None

    @cached_property
    def _states(self) -> frozenset[str]:
        return frozenset(state for scope in self.scopes for state in scope.states)

    @cached_property
    def _variables(self) -> dict[str, Scope]:
        return {name: scope for scope in self.scopes for name in scope.variables}

    @cached_property
    def _assigned(self) -> dict[str, Span]:
        """Where the blocks of the program bind names, one place for each."""
        return {
            name: place.block.at(span)
            for place in self.blocks
            for name, span in facts_of(place.block.text).binds.items()
        }

    # Values

    def _values(self, place: PlacedBlock, facts: Facts, wrong: set[Span]) -> None:
        used = place.purpose != "action"
        for diagnosis in facts.misread:
            where = Span(diagnosis.start, diagnosis.end)
            self._remedied(place, Remedied(diagnosis.code, where, diagnosis.message, diagnosis.fix))
        for remark in facts.comparisons:
            if not (used and remark.last):
                is_name = remark.name in place.visible or self._is_undefined(place, remark.name)
                fix = "=" if remark.edit and is_name else None
                is_variable = remark.edit and not means(place, remark.name, self.outside)
                remedy = "Write `=` to assign" if is_variable else "Use its result, or remove it"
                message = f"This only compares, and the result is not used. {remedy}."
                self._add("LRP504", place, remark.span, message, fix, remark.edit)
        for remark in facts.uncalled:
            if not (used and remark.last) and remark.span not in wrong:
                text = place.block.text[slice(*remark.span)]
                end = Span(remark.span.end, remark.span.end)
                is_stop = text.endswith(".stop")
                remedy = f"Write `{text}({'' if is_stop else '…'})` to call it, or remove it"
                message = f"This only names `{text}` and does nothing. {remedy}."
                call = "()" if text.count(".") == 1 and is_stop else None
                self._add("LRP507", place, remark.span, message, call, end)
        for remark in facts.bitwise:
            word = "and" if remark.name == "&" else "or"
            message = f"`{remark.name}` binds more tightly than the comparison. Write `{word}`."
            self._add("LRP509", place, remark.span, message, word, remark.edit)
        if facts.valueless and place.purpose == "initialiser":
            message = "This ends in a statement, so the variable is `None`. End with its value on a new line."
            self._add("LRP506", place, facts.valueless.span, message)
        elif facts.valueless and facts.valueless.is_test and place.purpose == "condition":
            edit = facts.valueless.edit or facts.valueless.span
            test = " ".join(place.block.text[edit.end : facts.valueless.span.end].split()).replace("`", "'")
            message = f"This condition only assigns and has no value. Write the test alone: `{test}`."
            edits = (Edit(*place.block.at(edit), ""),)
            fixed = None if facts.valueless.name in place.visible else Fix(f"Change to `{test}`", edits)
            self.report.add("LRP505", place.block.at(facts.valueless.span), message, fixed)
        elif facts.valueless and used:
            remedy = "Write `==` to compare" if facts.valueless.edit else "End with an expression"
            message = f"This {place.purpose} ends in a statement and has no value. {remedy}."
            fix = "==" if place.purpose == "condition" and facts.valueless.edit else None
            self._add("LRP505", place, facts.valueless.span, message, fix, facts.valueless.edit)
        if facts.test and place.purpose == "delay":
            self._tested_delay(place, facts.test)
        for name, other in facts.texts:
            if (place.visible.get(name), name) in self._numbers:
                remedied = compared(name, "number", other)
                if remedied:
                    self._remedied(place, remedied)
        halved = any(diagnosis.code == "LRP518" for diagnosis in facts.misread)
        if facts.literal and place.purpose in _WANTED and not halved:
            (kind, span), wanted = facts.literal, _WANTED[place.purpose]
            if kind != wanted:
                problem = f"A {place.purpose} must be {wanted}, not {kind}"
                remedy = "Write an expression that returns one"
                if kind == "a tuple" and place.purpose == "condition":
                    remedy = "Write `and` or `or` for the comma"
                self._add("LRP508", place, span, f"{problem}. {remedy}.")

    def _tested_delay(self, place: PlacedBlock, test: Span) -> None:
        """Report a comparison as a delay, with the keyword for conditions as its fix."""
        if place.ordinal == HOLD:
            message = "After `for` comes a number of milliseconds, and this is `True` or `False`."
            self.report.add("LRP508", place.block.at(test), f"{message} Write it into the condition.")
            return
        opening = self.report.program.text.rfind("ontime", 0, place.block.span.start)
        fix = replace(Span(opening, opening + len("ontime")), "on") if opening >= 0 else None
        problem = "A delay is a number of milliseconds, and this is `True` or `False`"
        message = f"{problem}. Write `on` for a condition."
        self.report.add("LRP508", place.block.at(test), message, fix)

    def _add(
        self,
        code: str,
        place: PlacedBlock,
        span: Span,
        message: str,
        text: str | None = None,
        edit: Span | None = None,
        prefix: bool = False,
        creates: Fix | None = None,
    ) -> None:
        """Report a finding at a range of a block; `text` is what a fix puts there, or at `edit`."""
        fix = None if text is None else replace(place.block.at(edit or span), text)
        self.report.add(code, place.block.at(span), message, fix, prefix, creates)


def _is_said(text: str, span: Span) -> bool:
    """Return whether a range of a block is the only argument of `robot.say`."""
    before, after = text[: span.start].rstrip(), text[span.end :].lstrip()
    return before.endswith("robot.say(") and after.startswith(")")


_WANTED = {"condition": "a truth value", "delay": "a number"}
