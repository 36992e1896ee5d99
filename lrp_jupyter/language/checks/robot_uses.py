"""5xx: uses of the robot that cannot work, where its members are known.

Paper: §3.2, §7.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

from lrp_jupyter.language.checks.report import nearest, replace
from lrp_jupyter.language.checks.uses import Argument, NameUse, Other, RobotCall, uses_of
from lrp_jupyter.language.program import Edit, Fix, Span
from lrp_jupyter.language.robot_members import Fields, Parameters, RobotMember, RobotMembers
from lrp_jupyter.language.spellings import by_word
from lrp_jupyter.language.triggers import Purpose


class Remedied(NamedTuple):
    """A finding about a block, with offsets in its text."""

    code: str
    span: Span
    message: str
    fix: Fix | None = None


_WORDS = by_word(
    {
        "move(linear=0.2)": "forward forwards drive go ahead run straight speed set_speed move_forward",
        "move(linear=-0.2)": "backward backwards back reverse move_backward",
        "move(angular=1)": "turn rotate spin steer left right turn_left turn_right",
        "stop()": "halt brake stand",
        "say": "speak show display talk write text",
        "light.data": "color colour grey gray brightness reflection floor line",
        "bumper.data": "touch button pressed bump collision",
        "distance.data": "sonar ultrasonic ultrasound infrared ir range obstacle wall",
        "gyro.data": "angle heading compass rotation",
    }
)
"""What is meant by other words for what robots do and read."""
_EXAMPLES = {"rad": "(degrees(90))", "m": "(0.5)"}
_DONE = frozenset({"done", "finished", "complete", "completed", "ready", "success", "over", "ended"})
_KINDS = {"int": "number", "float": "number", "number": "number", "bool": "truth value", "str": "text"}
_ARTICLES = {"number": "a number", "truth value": "`True` or `False`", "text": "a text"}
_TYPES: dict[str, type] = {"int": int, "float": float, "bool": bool, "str": str, "tuple": tuple}
_USED = frozenset({"compared", "computed", "tested", "value"})


@lru_cache(maxsize=20_000)
def suspicious_uses(
    text: str, members: RobotMembers, purpose: Purpose
) -> tuple[tuple[NameUse, Remedied | None], ...]:
    """Return the uses of the robot in a block that are wrong, and those that depend on a variable."""
    found = []
    for use in uses_of("robot", text):
        remedied = check_robot(use, members, purpose, lambda _: False)
        if remedied or (use.call and any(argument.root for argument in use.call.arguments)):
            found.append((use, remedied))
    return tuple(found)


def check_robot(
    use: NameUse, members: RobotMembers, purpose: Purpose, is_number: Callable[[str], bool]
) -> Remedied | None:
    """Return what is wrong with a use of the robot; `is_number`: whether a variable is a number at first."""
    if purpose == "action" and use.role == "value":  # nothing uses the value of an action
        use = use._replace(role="stated")
    is_condition = purpose == "condition"
    path = ""
    for index, name in enumerate(use.names):
        around, path = path, f"{path}.{name}" if path else name
        member = members.members.get(path)
        is_certain = members.complete or path in members.tasks or around in members.tasks
        if member is not None:
            left = use.names[index + 1 :]
            if left and f"{path}.{left[0]}" in members.members:  # what accompanies it
                continue
            if member.parameters is not None:
                if left and members.inside(path):  # a task, of which something is read
                    continue
                if left:
                    return _inside_method(use, member, index)
                is_needed = use.result in (_USED if is_condition else _USED - {"value"})
                if use.role == "called" and is_needed and member.acts and is_certain:
                    return _command(use, member, path in members.tasks, is_condition)
                if path in members.tasks and use.role in _USED:
                    return _task(use, member)
                return _method(use, member, member.parameters, is_number)
            if left:
                return _inside_reading(use, member, index) if members.complete else None
            return _reading(use, member, is_condition) if is_certain else None
        if not members.inside(path):
            return _unknown(use, members, around, index) if is_certain else None
    return _part(use, members, path, is_condition) if path else None


def _command(use: NameUse, member: RobotMember, is_task: bool, is_condition: bool) -> Remedied:
    path = f"robot.{member.path}"
    if is_condition:
        remedy = f"Call it in an action, and {f'test `{path}.succeeded`' if is_task else 'write a test'} here"
    else:
        remedy = "Call it in a statement of its own" + (f", and read `{path}.succeeded`" if is_task else "")
    return Remedied("LRP505", use.span, f"`{path}` does something and has no value. {remedy}.")


def _task(use: NameUse, member: RobotMember) -> Remedied:
    path, end = f"robot.{member.path}", use.span.end
    message = f"`{path}` is a task, not a value. Its outcome is `{path}.succeeded` or `{path}.failed`."
    return Remedied("LRP524", use.span, message, Fix("Insert `.succeeded`", (Edit(end, end, ".succeeded"),)))


def _unknown(use: NameUse, members: RobotMembers, around: str, index: int) -> Remedied:
    name, span, known = use.names[index], use.spans[index], members.inside(around)
    what = f"robot.{around}".rstrip(".")
    elsewhere = list(members.named(name))
    meant = nearest(name, frozenset(known))
    if meant is None and len(elsewhere) == 1:
        start = use.spans[0].start
        fix = Fix(f"Change to `robot.{elsewhere[0]}`", (Edit(start, span.end, elsewhere[0]),))
        return Remedied("LRP520", span, f"`{what}` has no `{name}`. Write `robot.{elsewhere[0]}`.", fix)
    meant = _by_arguments(use, members, around) or meant
    if meant is None and around in members.tasks and name.lower() in _DONE:
        meant = "succeeded"
    said = _WORDS.get(name.lower(), "") if meant is None and not around else ""
    root, bracket, _ = said.partition("(")
    fits = bool(bracket) == (use.role == "called") and len(use.names) == 1
    if said and fits and root in members.members:
        reading = replace(span, said) if not bracket else None
        return Remedied("LRP520", span, f"`{what}` has no `{name}`. Write `robot.{said}`.", reading)
    if meant is None and len(known) == 1:
        message = f"`{what}` has no `{name}`. Write `{what}.{known[0]}`."
        return Remedied("LRP520", span, message, replace(span, known[0]))
    if meant is None:
        listed = ", ".join(f"`{each}`" for each in known)
        return Remedied("LRP520", span, f"`{what}` has no `{name}`. It has {listed}.")
    message = f"`{what}` has no `{name}`. Did you mean `{meant}`?"
    return Remedied("LRP520", span, message, replace(span, meant))


def _by_arguments(use: NameUse, members: RobotMembers, around: str) -> str | None:
    """Return the only method that has the arguments of a call, as `move` for `drive(linear=1)`."""
    used = {argument.name for argument in use.call.arguments} if use.call else set()
    found = [
        name
        for name in members.inside(around)
        if (method := members.members.get(f"{around}.{name}".strip("."))) is not None
        and method.parameters is not None
        and used.issubset(method.parameters.names)
    ]
    return found[0] if used and len(found) == 1 else None


def _part(use: NameUse, members: RobotMembers, path: str, is_condition: bool) -> Remedied | None:
    known = members.inside(path)
    end = use.span.end
    readings = [name for name in known if members.members.get(f"{path}.{name}", _METHOD).parameters is None]
    data = "data" if "data" in readings else readings[0] if len(readings) == 1 else None
    listed = ", ".join(f"`robot.{path}.{name}`" for name in known)
    what = f"`robot.{path}` is a part of the robot, not a value. It has {listed}."
    if data:
        what = f"`robot.{path}` is the sensor; its value is `robot.{path}.{data}`."
    if use.role in ("assigned", "deleted"):
        remedy = "Keep values in a variable" if use.role == "assigned" else "Remove the `del`"
        message = f"`robot.{path}` is a part of the robot and cannot be {use.role}. {remedy}."
        return Remedied("LRP523", use.span, message) if not is_condition else None
    if use.role == "called":
        assert use.call is not None
        fix = replace(use.call.brackets, f".{data}", f"Change to `robot.{path}.{data}`") if data else None
        return Remedied("LRP522", use.span, what, fix if not use.call.arguments else None)
    if use.role == "value" and not is_condition and set(known) <= set(members.inside("")):
        return None  # another robot, which a variable can hold
    if use.role in _USED:
        fix = Fix(f"Insert `.{data}`", (Edit(end, end, f".{data}"),)) if data else None
        return Remedied("LRP522", use.span, what, fix)
    if use.role == "stated":
        return Remedied("LRP507", use.span, f"This only names `robot.{path}` and does nothing. Remove it.")
    return None


_METHOD = RobotMember("", parameters=Parameters("()"))


def _inside_method(use: NameUse, member: RobotMember, index: int) -> Remedied:
    assert member.parameters is not None
    path = f"robot.{member.path}"
    name, span = use.names[index + 1], use.spans[index + 1]
    message = f"`{path}` is a method and has no `{name}`. Call it as `{path}{member.parameters.text}`."
    return Remedied("LRP520", span, message)


def _inside_reading(use: NameUse, member: RobotMember, index: int) -> Remedied | None:
    fields, path = member.fields, f"robot.{member.path}"
    for name, span in zip(use.names[index + 1 :], use.spans[index + 1 :], strict=True):
        if fields is None:
            break
        if name not in fields:
            return _no_field(path, name, span, fields)
        fields, path = fields[name], f"{path}.{name}"
    name, span = use.names[index + 1], use.spans[index + 1]
    kind = _TYPES.get(member.type)
    if kind is None or hasattr(kind, name):
        return None
    what = _ARTICLES.get(_KINDS.get(member.type, ""), "a value")
    message = f"`robot.{member.path}` is {what} and has no `{name}`. Remove `.{name}`."
    fix = Fix(f"Remove `.{name}`", (Edit(use.spans[index].end, span.end, ""),))
    return Remedied("LRP520", span, message, fix)


def _no_field(path: str, name: str, span: Span, fields: Fields) -> Remedied:
    meant = nearest(name, frozenset(fields))
    if meant is None:
        listed = ", ".join(f"`{each}`" for each in fields)
        return Remedied("LRP520", span, f"`{path}` has no `{name}`. It has {listed}.")
    message = f"`{path}` has no `{name}`. Did you mean `{meant}`?"
    return Remedied("LRP520", span, message, replace(span, meant))


def _reading(use: NameUse, member: RobotMember, is_condition: bool) -> Remedied | None:
    path, kind = f"robot.{member.path}", _KINDS.get(member.type, "")
    if use.role == "called":
        assert use.call is not None
        message = f"`{path}` is a value and cannot be called. Write it without `()`."
        fix = None if use.call.arguments else Fix("Remove `()`", (Edit(*use.call.brackets, ""),))
        return Remedied("LRP524", use.span, message, fix)
    if use.role == "assigned" and not is_condition:
        message = f"`{path}` is read from the robot and cannot be assigned. Keep the value in a variable."
        return Remedied("LRP523", use.span, message)
    if use.role == "deleted":
        message = f"`{path}` belongs to the robot and cannot be deleted. Remove the `del`."
        return Remedied("LRP523", use.span, message)
    if use.role == "stated":
        return Remedied("LRP507", use.span, f"This only reads `{path}` and does nothing with it. Remove it.")
    if use.role == "tested" and kind == "number" and member.limits is not None:
        message = f"`{path}` is a number, and any number but 0 counts as true. Compare it with a number."
        return Remedied("LRP527", use.span, message)
    if use.role == "value" and is_condition and kind in ("number", "text"):
        what = _ARTICLES[kind]
        message = f"A condition is `True` or `False`, but `{path}` is {what}. Compare it with {what}."
        return Remedied("LRP508", use.span, message)
    if use.other and use.other.kind == "text" and member.values and use.other.value not in member.values:
        return _no_such_value(path, use.other, member.values)
    return compared(path, kind, use.other) if use.other and kind else None


def _no_such_value(path: str, other: Other, values: tuple[str, ...]) -> Remedied:
    meant = nearest(str(other.value), frozenset(values))
    hint = f"Did you mean `{meant}`?" if meant else f"It has {', '.join(f'`{each}`' for each in values)}."
    fix = replace(other.span, f'"{meant}"') if meant else None
    return Remedied("LRP526", other.span, f"`{path}` is never {other.value!r}. {hint}", fix)


def compared(path: str, kind: str, with_what: Other) -> Remedied | None:
    """Return what is wrong with the comparison of a value of a kind with a literal."""
    sign, other, span, value = with_what
    is_equality = sign in ("==", "!=")
    what = _ARTICLES[kind]
    if {kind, other} == {"truth value", "number"}:
        if kind == "truth value" and not (is_equality and value not in (0, 1)):
            return None  # `True` is 1
        if kind == "truth value":
            return Remedied("LRP526", span, f"`{path}` is {what}, never {value!r}. Compare it with `True`.")
        if not is_equality:
            return None
        message = f"`{path}` is {what}, not `True` or `False`. Compare it with a number."
        return Remedied("LRP526", span, message)
    if kind == other:
        return None
    fix = None
    truths = ("0", "1", "True", "False") if kind == "truth value" else ()
    if isinstance(value, str) and (value in truths or (kind == "number" and _is_number(value))):
        fix = replace(span, value.strip())
        remedy = f"Write `{value.strip()}` without quotes"
    elif kind == "truth value":
        remedy = "Compare it with `True` or `False`"
    else:
        remedy = f"Compare it with {what}"
    if is_equality:
        outcome = "never equal to" if sign == "==" else "always different from"
        return Remedied("LRP526", span, f"`{path}` is {what}, {outcome} {_ARTICLES[other]}. {remedy}.", fix)
    return Remedied("LRP525", span, f"`{path}` is {what}, not {_ARTICLES[other]}. {remedy}.", fix)


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return text.strip()[:1] in "0123456789.-"


def _method(
    use: NameUse, member: RobotMember, parameters: Parameters, is_number: Callable[[str], bool]
) -> Remedied | None:
    path = f"robot.{member.path}"
    call = f"{path}{parameters.text}"
    if use.role == "called":
        assert use.call is not None
        return None if use.call.is_open else _arguments(use, use.call, path, parameters, is_number)
    if use.role in ("assigned", "deleted"):
        message = f"`{path}` is a method and cannot be {use.role}. Call it as `{call}`."
        return Remedied("LRP523", use.span, message)
    if use.role == "with" and not (parameters.fields or parameters.is_open):
        message = f"`{path}` accepts no message. Call it as `{call}`."
        return Remedied("LRP521", use.span, message)
    end = use.span.end
    is_plain = not (parameters.names or parameters.required)
    fix = Fix("Insert `()`", (Edit(end, end, "()"),)) if is_plain else None
    if use.role == "stated":
        first = parameters.units.get(parameters.required[0], "") if len(parameters.required) == 1 else ""
        example = _EXAMPLES.get(first, "(linear=0.2)" if "linear" in parameters.names else parameters.text)
        written = f"{path}()" if is_plain else f"{path}{example}"
        message = f"This only names `{path}` and does nothing. Write `{written}` to call it, or remove it."
        return Remedied("LRP507", use.span, message, fix)
    if use.role in _USED:
        message = f"`{path}` is a method. Write `{path}{'()' if is_plain else parameters.text}` to call it."
        return Remedied("LRP524", use.span, message, fix)
    return None


def _arguments(
    use: NameUse, call: RobotCall, path: str, parameters: Parameters, is_number: Callable[[str], bool]
) -> Remedied | None:
    known = parameters.fields | set(parameters.names)
    plain = [argument for argument in call.arguments if not argument.name]
    named = [argument for argument in call.arguments if argument.name]
    for argument in named:
        if argument.assigns and argument.name in known:
            message = f"An argument has its value after `=`. Write `{argument.name}=`."
            start = argument.span.start + len(argument.name)
            fix = Fix("Change to `=`", (Edit(start, argument.value.start, "="),))
            return Remedied("LRP521", argument.assigns, message, fix)
        if argument.name not in known and not (parameters.is_open or argument.assigns):
            return _unknown_argument(argument, path, parameters)
        is_number_wanted = bool(parameters.fields) and argument.name not in parameters.unlike
        wrong = argument.kind in ("text", "None", "truth value") and is_number_wanted
        if wrong and not argument.assigns:
            return _not_a_number(argument)
    texts = [*zip(parameters.names, plain, strict=False), *((each.name, each) for each in named)]
    for name, argument in texts if not parameters.fields else ():
        is_text = argument.kind == "text"
        if is_text and (not_a_text := _not_a_text(path, name, argument, parameters)):
            return not_a_text
    if parameters.fields:
        return _by_position(use, call, path, parameters, plain, is_number)
    if parameters.positional is not None and len(plain) > parameters.positional:
        message = f"`{path}` takes no arguments. Remove them."
        if parameters.names:
            message = f"`{path}` takes `{parameters.text}`. Remove the extra arguments."
        extra = plain[parameters.positional :]
        is_all = not parameters.names and len(plain) == len(call.arguments)
        removal = Fix("Remove the arguments", (Edit(*call.brackets, "()"),)) if is_all else None
        return Remedied("LRP521", Span(extra[0].span.start, extra[-1].span.end), message, removal)
    given = {argument.name for argument in named}
    by_place = parameters.required[len(plain) :] if len(plain) < len(parameters.required) else ()
    missing = [name for name in by_place if name not in given]
    if missing:
        listed = " and ".join(f"`{name}`" for name in missing)
        return Remedied("LRP521", use.span, f"`{path}` needs {listed}. Write `{path}{parameters.text}`.")
    return None


def _unknown_argument(argument: Argument, path: str, parameters: Parameters) -> Remedied:
    span = Span(argument.span.start, argument.span.start + len(argument.name))
    meant = nearest(argument.name, parameters.fields.union(parameters.names))
    if meant:
        message = f"`{path}` has no argument `{argument.name}`. Did you mean `{meant}`?"
        return Remedied("LRP521", span, message, replace(span, meant))
    listed = " and ".join(f"`{name}`" for name in parameters.names)
    accepted = f"It takes {listed}" if listed else "It takes none"
    return Remedied("LRP521", span, f"`{path}` has no argument `{argument.name}`. {accepted}.")


def _not_a_number(argument: Argument) -> Remedied:
    number = argument.text.strip()
    if _is_number(number):
        message = f"`{argument.name}` must be a number, not a text. Write `{number}` without quotes."
        return Remedied("LRP521", argument.value, message, replace(argument.value, number))
    wrong = _ARTICLES.get(argument.kind, "`None`")
    message = f"`{argument.name}` must be a number, not {wrong}. Write a number."
    return Remedied("LRP521", argument.value, message)


def _not_a_text(path: str, name: str, argument: Argument, parameters: Parameters) -> Remedied | None:
    """Return what is wrong with a text where a number or a truth value is needed."""
    if name in parameters.limits:
        return _not_a_number(argument._replace(name=name))
    if re.search(rf"\b{name}=(True|False)\b", parameters.text):
        meant = str(argument.text.strip().lower() not in ("off", "false", "no", "0", ""))
        message = f"`{path}` takes `True` or `False`, and every text counts as true. Write `{meant}`."
        return Remedied("LRP521", argument.value, message, replace(argument.value, meant))
    return None


def _by_position(
    use: NameUse,
    call: RobotCall,
    path: str,
    parameters: Parameters,
    plain: list[Argument],
    is_number: Callable[[str], bool],
) -> Remedied | None:
    """Return what is wrong with arguments without names of a method that takes a message."""
    numbers = [argument for argument in plain if argument.kind or is_number(argument.root)]
    if len(plain) < 2 and not numbers and not (plain and len(call.arguments) > 1):
        return None
    free = [name for name in parameters.names if all(argument.name != name for argument in call.arguments)]
    starts = [argument.span.start for argument in plain]
    edits = [Edit(start, start, f"{name}=") for start, name in zip(starts, free, strict=False)]
    example = ", ".join(f"{name}=…" for name in parameters.names)
    message = f"The arguments of `{path}` need names. Write `{path}({example})`."
    fix = Fix(f"Insert `{edits[0].text}`", tuple(edits)) if len(edits) == len(plain) else None
    return Remedied("LRP521", Span(plain[0].span.start, plain[-1].span.end), message, fix)
