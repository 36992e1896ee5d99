"""What a person can have done from a page: one function for each act of the protocol.

Called on the thread that delivers messages. An act queues a command and gives its future, or does at once
what may be done from any thread, or leaves to the worker what has to wait. What it raises is the reply.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from functools import partial
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any, Literal, get_args

from lrp_jupyter.bridges.sim import SimBridge
from lrp_jupyter.errors import BridgeError, LRPError, UnknownElementError
from lrp_jupyter.graph.state_graph import find_machine
from lrp_jupyter.language.program import path_text
from lrp_jupyter.live import commands as do
from lrp_jupyter.widgets.choices import program_text
from lrp_jupyter.widgets.paths import path_of
from lrp_jupyter.widgets.protocol import Act, Command

if TYPE_CHECKING:
    from lrp_jupyter.widgets.connection import Connection

__all__ = ["ACTS", "carry_out"]

Outcome = Future[Any] | None


def carry_out(connection: Connection, command: Command) -> Outcome:
    """Begin what a command asks for; give its future, or None if it is done."""
    act = ACTS.get(command["do"])
    if act is None:
        raise LRPError(f"There is no act `{command['do']}`.")
    return act(connection, command)


# -- control -----------------------------------------------------------------------------------------


def run(connection: Connection, command: Command) -> Outcome:
    """Run, or go on; after a stop from the beginning."""
    session = connection.session
    if session.status in ("ready", "stopped"):
        return connection.work(session.start)
    return session.ask(do.Resume())


def pause(connection: Connection, command: Command) -> Outcome:
    """Stand still."""
    return connection.session.ask(do.Pause())


def step(connection: Connection, command: Command) -> Outcome:
    """One tick, or as many as `value` says."""
    if not connection.session.bridge.is_open:
        return connection.work(connection.session.step)
    *_, last = [connection.session.ask(do.Step()) for _ in range(max(1, int(command.get("value", 1))))]
    return last


def step_back(connection: Connection, command: Command) -> Outcome:
    """Go back by a tick, or as many as `value` says."""
    return connection.work(partial(connection.session.rewind, max(1, int(command.get("value", 1)))))


def reset(connection: Connection, command: Command) -> Outcome:
    """Begin anew."""
    return connection.session.ask(do.Reset())


def stop(connection: Connection, command: Command) -> Outcome:
    """Stop the robot now, whatever the program does."""
    connection.session.stop_robot()
    return None


def rate(connection: Connection, command: Command) -> Outcome:
    """Ticks per second."""
    return connection.session.ask(do.SetRate(command["value"]))


def speed(connection: Connection, command: Command) -> Outcome:
    """Let so many seconds be simulated in one; 0 is as many as possible."""
    return connection.session.ask(do.SetSpeed(command["value"] or math.inf))


def armed(connection: Connection, command: Command) -> Outcome:
    """Let commands move the robot, or not."""
    bridge = connection.session.bridge
    (bridge.arm if command["on"] else bridge.disarm)()
    return None


def bridge(connection: Connection, command: Command) -> Outcome:
    """Go on with another bridge: a new session of the same program."""
    return connection.work(partial(connection.change_bridge, command["name"]))


def panel(connection: Connection, command: Command) -> Outcome:
    """Press a button of the bridge's panel, or answer its question."""
    key, values = command["key"], command.get("values", {})
    robot = connection.session.bridge
    if key == "stop":
        connection.session.stop_robot()
        return None
    shown = robot.panel()
    if shown is not None and any(question.key == key for question in shown.questions):
        return connection.session.ask(do.Call(partial(robot.answer, key, values.get(key, "")), "answer"))
    return connection.session.ask(do.Call(partial(robot.press, key, command.get("row", ""), values), "press"))


# -- text --------------------------------------------------------------------------------------------


def hold(connection: Connection, command: Command) -> Outcome:
    """Let texts wait for `apply`, or not; what was held runs when it is switched off."""
    texts = connection.texts
    if texts.hold and not command["on"]:
        texts.hold = False
        connection.apply()
    texts.hold = command["on"]
    connection.wake()
    return None


def apply(connection: Connection, command: Command) -> Outcome:
    """Let the held text run."""
    connection.apply()
    return None


def revert(connection: Connection, command: Command) -> Outcome:
    """Go back to the text that runs."""
    connection.write(connection.session.program.text)
    return None


def load(connection: Connection, command: Command) -> Outcome:
    """Let a bundled program be the text."""
    name = command["name"]
    try:
        connection.write(program_text(name))
    except KeyError:
        raise LRPError(f"There is no bundled program `{name}`.") from None
    return None


def take(connection: Connection, command: Command) -> Outcome:
    """Settle a conflict: the cell's text."""
    text = connection.texts.end_conflict()
    if text is not None:
        connection.write(text)
    return None


def keep(connection: Connection, command: Command) -> Outcome:
    """Settle a conflict: the lab's text."""
    connection.texts.end_conflict()
    connection.wake()
    return None


def save(connection: Connection, command: Command) -> Outcome:
    """Write the text to a file."""
    name = command["name"].strip()
    if not name:
        raise LRPError("A file needs a name.")
    FilePath(name).expanduser().write_bytes(connection.texts.text.encode())
    return None


def rename(connection: Connection, command: Command) -> Outcome:
    """Rename an element and everything that refers to it."""
    kind = command["kind"]
    path = path_of(kind, command["path"])
    return connection.work(partial(connection.texts.rename, kind, path, command["name"]))


# -- forcing -----------------------------------------------------------------------------------------


def transition(connection: Connection, command: Command) -> Outcome:
    """Go to a state as if a transition led there."""
    return connection.session.ask(do.Force(path_of("state", command["path"])))


def teleport(connection: Connection, command: Command) -> Outcome:
    """Be in a state; no action runs."""
    return connection.session.ask(do.Force(path_of("state", command["path"]), teleport=True))


def fire(connection: Connection, command: Command) -> Outcome:
    """Take a transition now: its source must be active."""
    program = connection.session.program
    *where, label = path_of("transition", command["path"])
    machine = find_machine(program, where)
    found = next(
        (t for name, t in zip(machine.labels, machine.transitions, strict=True) if name == label), None
    )
    if found is None:
        raise UnknownElementError(f"There is no transition `{label}` in `{path_text(tuple(where))}`.")
    lit = {tuple(path.split("/")) for path in connection.lit()}
    if not any(path[:-1] == tuple(where) and found.leaves(path[-1]) for path in lit):
        raise LRPError(f"No state that `{label}` leaves is active: {found.source_text}.")
    target = where[:-2] if found.kind == "exit" else where
    return connection.session.ask(do.Force((*target, str(found.destination))))


def set_variable(connection: Connection, command: Command) -> Outcome:
    """Assign the value of an expression."""
    path = path_of("variable", command["path"])
    return connection.session.ask(do.SetVariable(path, command["expression"]))


# -- policies and issues -----------------------------------------------------------------------------


def on_active_edit(connection: Connection, command: Command) -> Outcome:
    """Let an edit of the active state restart the program, or keep it running."""
    if command["name"] not in ("restart", "keep"):
        raise LRPError(f"It is `restart` or `keep`, not `{command['name']}`.")
    return _policy(connection, "on_active_edit", command["name"])


def pause_on_issue(connection: Connection, command: Command) -> Outcome:
    """Whether a new issue pauses the program."""
    return _policy(connection, "on_issue", "pause" if command["on"] else "record")


def _policy(connection: Connection, name: Literal["on_active_edit", "on_issue"], value: str) -> Outcome:
    answer = connection.session.ask(do.SetPolicy(name, value))
    answer.add_done_callback(lambda _: connection.wake())
    return answer


def clear_issues(connection: Connection, command: Command) -> Outcome:
    """Forget the issues of the run."""
    return connection.session.ask(do.Call(connection.session.interpreter.issues.clear))


# -- the world ---------------------------------------------------------------------------------------


def _world(connection: Connection) -> SimBridge:
    robot = connection.session.bridge
    if not isinstance(robot, SimBridge):
        raise BridgeError(f"`{robot.name}` has no world that could be changed.")
    return robot


def _shown(connection: Connection) -> Outcome:
    """Let what was done to the world be seen, also while nothing ticks."""
    return connection.session.ask(do.Call(lambda: None, "look"))


def drag_robot(connection: Connection, command: Command) -> Outcome:
    """Put a robot elsewhere."""
    _world(connection).place_robot(command["pose"], command["index"])
    return _shown(connection)


def drag_solid(connection: Connection, command: Command) -> Outcome:
    """Put a solid elsewhere."""
    _world(connection).place_solid(command["index"], command["pose"])
    return _shown(connection)


def drop(connection: Connection, command: Command) -> Outcome:
    """Let go of what was dragged: it stands where it is."""
    return None


def stroke(connection: Connection, command: Command) -> Outcome:
    """Draw a line on the floor."""
    points = tuple((x, y) for x, y in command["points"])
    _world(connection).draw(points, command.get("width", 0.03), command.get("grey", 0))
    return _shown(connection)


def erase(connection: Connection, command: Command) -> Outcome:
    """Paint with the floor's own grey."""
    points = tuple((x, y) for x, y in command["points"])
    _world(connection).erase(points, command.get("width", 0.06))
    return _shown(connection)


def reset_pose(connection: Connection, command: Command) -> Outcome:
    """Put a robot back where it began."""
    world, index = _world(connection), command["index"]
    if not 0 <= index < len(world.world.robots):
        raise BridgeError(f"There is no robot {index}.")
    world.place_robot(world.world.robots[index].pose, index)
    return _shown(connection)


def reset_world(connection: Connection, command: Command) -> Outcome:
    """Let the world be as it was, without trails and drawings."""
    _world(connection).reset_world(drawings=True)
    return _shown(connection)


def world(connection: Connection, command: Command) -> Outcome:
    """Go on in another world."""
    robot = _world(connection)
    return connection.session.ask(do.Call(partial(robot.load_world, command["name"]), "world"))


# -- the graph ---------------------------------------------------------------------------------------


def select(connection: Connection, command: Command) -> Outcome:
    """Note which machine a view looks at."""
    return None


def pin(connection: Connection, command: Command) -> Outcome:
    """Put a node of the graph where it was dragged."""
    x, y, _ = command["pose"]
    connection.texts.drawings.pin(command["path"], command["name"], x, y)
    connection.wake()
    return None


def arrange(connection: Connection, command: Command) -> Outcome:
    """Lay out a machine anew."""
    connection.texts.drawings.arrange(command["path"])
    connection.wake()
    return None


ACTS: Mapping[str, Callable[[Connection, Command], Outcome]] = {
    name: globals()[name] for name in get_args(Act)
}
"""Every act of the protocol, by its name."""
