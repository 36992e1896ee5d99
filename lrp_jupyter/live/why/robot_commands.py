"""Why the robot received its last command, and what became of it."""

from __future__ import annotations

import ast
from itertools import chain

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.guarding.safety import CommandRecord, Origin
from lrp_jupyter.bridges.interventions import CommandsHeld, RobotStopped
from lrp_jupyter.bridges.member_tree import RobotMethod
from lrp_jupyter.bridges.tasks import RobotTask
from lrp_jupyter.errors import UnknownElementError
from lrp_jupyter.interpreter.facts import Commanded
from lrp_jupyter.language.blocks.block import read
from lrp_jupyter.language.lookup import definition_of
from lrp_jupyter.language.program import Element, Program, path_text
from lrp_jupyter.language.resolution import resolve
from lrp_jupyter.live.reason import CommandCode, Reason
from lrp_jupyter.live.why.answer_draft import AnswerDraft
from lrp_jupyter.live.why.elements import line_of
from lrp_jupyter.live.why.recorded_run import RecordedRun
from lrp_jupyter.live.why.task_states import task_text
from lrp_jupyter.live.why.wording import call_text, given_arguments, listed, restart_text, time_text


def command_reason(run: RecordedRun, name: str, tick: int, now: bool) -> Reason:
    """Return why the robot received its last command of a name, or any that sets the velocity as it does.

    `now`: whether to consider events since that tick, too.
    Raises UnknownElementError: the robot has no such command.
    """
    safety, time = run.loop.bridge.safety, run.time(tick)
    names = _alike(run.loop.bridge, name)
    given = [each for each in safety.commands if each.name in names and each.first.tick <= tick]
    if not given:
        return _never_given(run, name, tick)
    last = given[-1]
    origin = last.origin if last.origin.tick <= tick else last.first
    first = last.first.tick
    where = f"by `{origin.block}`{_places(run, origin)} (line {origin.line})" if origin.block else "by hand"
    since = f", repeated since {time_text(run.time(first))}" if first < origin.tick else ""
    draft = AnswerDraft(
        {
            "command": last.name,
            "arguments": given_arguments(last.arguments),
            "block": origin.block,
            "state": origin.block.partition(".")[0],
            "since": first,
            "limited": last.limited,
        }
    )
    call = call_text(last.name, last.arguments)
    draft.say(f"The last command was {call}, given {where} at {time_text(run.time(origin.tick))}{since}.")
    draft.lines.append(origin.line)
    for sentence in last.limited:
        draft.say(sentence)
    code, sentence = _fate(run, last, origin.tick, tick, now)
    if sentence:
        draft.say(sentence)
    if isinstance(run.loop.bridge.nodes.table[name], RobotTask):
        draft.say(task_text(run, name, tick))
    return draft.reason(code, tick, time)


def _places(run: RecordedRun, origin: Origin) -> str:
    """Say in which instances the block can have run that gave a command, if its machine can have several."""
    name, _, action = origin.block.rpartition(".")
    if origin.tick not in run.history.ticks:
        return ""
    state = run.history.state(origin.tick, before=action == "onexit")
    names, paths = resolve(state.program), []
    for each in state.walk():
        if each.state[-1] == name and names.is_shared(each.state[:-1]):
            found = definition_of(state.program, Element("state", each.state))
            first, last = (state.program.place(at)[0] for at in found.span) if found else (0, 0)
            if first <= origin.line <= last:
                paths.append(f"`{path_text(each.path)}`")
    return f" in {listed(paths, 'or')}" if paths else ""


def commands_of(bridge: Bridge) -> dict[str, RobotMethod]:
    """Return the commands of a robot by name."""
    return {each.path: each for each in bridge.nodes.members() if isinstance(each, RobotMethod)}


def _alike(bridge: Bridge, name: str) -> set[str]:
    """Return the names of the commands among which to find the last one."""
    methods = commands_of(bridge)
    if name not in methods:
        known = ", ".join(f"`{each}`" for each in methods) or "none"
        message = f"`robot` has no command `{name}`."
        raise UnknownElementError.missing(message, name, methods, f"There are: {known}.")
    meant = methods[name]
    if name.rpartition(".")[2] == "stop" or not meant.velocity:
        return {name}
    return {path for path, other in methods.items() if other.velocity and other.mover == meant.mover}


def _never_given(run: RecordedRun, name: str, tick: int) -> Reason:
    lines = _lines_with(run.program(tick), f"robot.{name}")
    where = f"It appears in line {lines[0]}." if lines else "It does not appear in the program."
    draft = AnswerDraft()
    draft.say(f"`robot.{name}` has not been called. {where}", *lines)
    return draft.reason("never", tick, run.time(tick))


def _lines_with(program: Program, attribute: str) -> list[int]:
    """Return the lines of the blocks of a program that contain an attribute, in order."""
    found = set()
    for placed in chain.from_iterable(resolve(program).blocks.values()):
        try:
            tree, suite, *_ = read(placed.block.text)
        except SyntaxError:
            continue
        first = line_of(program, placed.block) - suite.header.count("\n")
        nodes = [node for node in ast.walk(tree) if isinstance(node, ast.Attribute)]
        found |= {first + node.lineno - 1 for node in nodes if ast.unparse(node) == attribute}
    return sorted(found)


def _why_held(run: RecordedRun, tick: int) -> str:
    """Return why the bridge did not send a command in a tick; empty if it was stopped or disarmed."""
    held = [each.what for each in run.loop.record.inputs.since(tick - 1) if each.tick == tick - 1]
    return next((each.lost or each.blind for each in held if isinstance(each, CommandsHeld)), "")


def _fate(run: RecordedRun, last: CommandRecord, given: int, tick: int, now: bool) -> tuple[CommandCode, str]:
    """Return what became of a command given in a tick: the code, and a sentence or nothing."""
    safety = run.loop.bridge.safety
    if not last.sent and not safety.armed:
        return "disarmed", "It was not sent, because the robot is disarmed."
    if not last.sent:
        why = _why_held(run, given) or "the robot was disarmed, or had been stopped in that tick."
        return "stopped", f"It was not sent: {why}"
    notices = [each for each in safety.notices if each.kind in ("command watchdog", "stale")]
    notices = [each for each in notices if last.now < each.now <= run.loop.timing.now]
    if notices and (now or notices[-1].now <= run.time(tick) + 1e-9):
        code: CommandCode = "stopped" if notices[-1].kind == "stale" else "watchdog"
        return code, f"The robot was stopped at {time_text(notices[-1].now)}: {notices[-1].text}"
    for when, fact in run.backward(tick):
        if when <= given:
            break
        if isinstance(fact, Commanded) and fact.kind == "resumed" and last.origin.block == "onresume":
            break  # the command was given then
        if isinstance(fact, Commanded) and fact.kind == "paused":
            why = run.loop.reason if now else ""
            return "stopped", f"Then the program was paused, which stops the robot. {why}".strip()
        if isinstance(fact, Commanded) and fact.kind == "ended":
            return "stopped", "Then the run ended, which stops the robot."
        if isinstance(fact, Commanded) and fact.kind == "restarted":
            restarted = f"Then the program was restarted ({restart_text(fact)})"
            return "stopped", f"{restarted}, which stops the robot."
    is_last = tick == run.history.ticks.stop - 1
    stops = [
        entry
        for entry in run.loop.record.inputs.since(given)
        if isinstance(entry.what, RobotStopped) and (is_last or entry.tick < tick)
    ]
    if stops:
        disarmed = "" if safety.armed or not is_last else " It is disarmed."
        return "stopped", f"Then the robot was stopped at {time_text(stops[-1].time)}.{disarmed}"
    return ("limited" if last.limited else "commanded"), ""
