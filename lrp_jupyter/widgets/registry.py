"""The programs that run in this kernel, by name.

Widgets live as long as the kernel, so a cell that is run again must find the program that it opened: the same
name is the same running program. The text of the cell and the text typed in the lab are reconciled here.
"""

from __future__ import annotations

import atexit
import os
import shlex
from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path as FilePath
from typing import Any

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.discovery import make_bridge
from lrp_jupyter.errors import LRPError, UnknownElementError, did_you_mean, most_similar
from lrp_jupyter.grading.challenges import Challenge
from lrp_jupyter.language.parser import scan
from lrp_jupyter.live.running import commands as do
from lrp_jupyter.live.session import Session
from lrp_jupyter.sim.world import World
from lrp_jupyter.widgets.connection import PageConnection
from lrp_jupyter.widgets.text.conditions import Conditions
from lrp_jupyter.widgets.text.keeping import kept_texts
from lrp_jupyter.widgets.text.kept import checked_name
from lrp_jupyter.widgets.text.saver import Saver
from lrp_jupyter.widgets.text.texts import Texts
from lrp_jupyter.widgets.views.goal import Goal
from lrp_jupyter.widgets.wire.protocol import Hints, OnActiveEdit

DEAD_MAN = 5.0
"""Wall seconds without a view after which the program of a real robot pauses."""

_HAS_HUNG = (
    "A block of this program did not return when it last ran, so the program was not started. "
    "Correct the block, then run the program."
)

_connections: list[PageConnection] = []


def names() -> list[str]:
    """Return the names of the open programs, the oldest first."""
    return [connection.name for connection in running()]


def find(name: str) -> PageConnection | None:
    """Return the open program of this name."""
    return next((connection for connection in running() if connection.name == name), None)


def named(name: str) -> PageConnection:
    """Return the open program of a name, or raise; an empty name stands for the only open program."""
    known = names()
    found = find(name) if name else find(known[0]) if len(known) == 1 else None
    if found is not None:
        return found
    if not known:
        raise UnknownElementError("No program is open. `%lrp examples` lists bundled ones.")
    listed = ", ".join(f"`{each}`" for each in known)
    what = f"No program `{name}` is open.{did_you_mean(name, known)}" if name else "Name a program."
    candidates = most_similar(name, known) if name else known
    raise UnknownElementError(f"{what} Open programs: {listed}.", candidates)


def running() -> Iterator[PageConnection]:
    """Yield the connections of the open programs."""
    yield from (connection for connection in list(_connections) if not connection.closed)


def connection_of(session: Session) -> PageConnection:
    """Return the connection of a session; one that was created elsewhere gets a unique name."""
    for connection in running():
        if connection.session is session:
            return connection
    connection = PageConnection(session, Saver(Texts()), free_name=_free_name)
    connection.name = session.name = _free_name(session.name)
    return _add(connection)


def _add(connection: PageConnection) -> PageConnection:
    _connections[:] = [*running(), connection]
    return connection


def _free_name(name: str) -> str:
    """Return a name that no open program has: this one, if necessary with a number."""
    taken, free, count = names(), name, 1
    while free in taken:
        count += 1
        free = f"{name} ({count})"
    return free


def forget(connection: PageConnection) -> None:
    """Close a program and forget it."""
    connection.close()
    if connection in _connections:
        _connections.remove(connection)


def open_program(
    name: str,
    text: str | None,
    bridge: str | None = None,
    *,
    namespace: dict[str, Any] | None = None,
    rate: float | None = None,
    on_active_edit: OnActiveEdit | None = None,
    folder: str | os.PathLike[str] | None = None,
    paused: str = "",
    given_in: str = "cell",
    task: Challenge | None = None,
    conditions: Conditions | None = None,
    runs: str | os.PathLike[str] | None = None,
    hints: Hints = "sentences",
    log: str | os.PathLike[str] | None = None,
    line: str = "",
    **options: Any,
) -> PageConnection:
    """Open a program, or continue with the open one of that name; it runs at once.

    `text`: the text of the cell; None or blank: the lab's text.
    `bridge`: default: that of the open program, else the simulator.
    `rate`, `on_active_edit`: of the session; default: as before.
    `folder`: of the notebook, which decides where texts are kept; default: the current one.
    `paused`: why a newly opened program does not run until its user starts it.
    `given_in`: where this text comes from, in a word: a cell, or a link.
    `task`: the challenge of the program: its first world is loaded, its goal shown.
    `conditions`: None: as before.
    `runs`: a folder of recordings that are run again with every new text, beside those in ``NAME.runs``.
    `hints`: for a challenge; ``"changes"``: also the smallest changes that make a program pass it.
    `log`: the file in which the session is recorded; if it exists, the name gets a number.
    `line`: the first line of the cell, without ``%%lrp``; default: the arguments, as such a line has them.
    `options`: for the bridge: ``world="line"``.
    """
    line = line or _line(name, bridge, task, options)
    text = text if text and text.strip() else None
    log = None if log is None else FilePath(log)
    if task is not None:
        if bridge not in (None, "sim") or "world" in options:
            what = "The world" if "world" in options else "The robot"
            raise LRPError(f"{what} is that of the challenge `{task.name}`. Leave it out.")
        bridge, options = "sim", {"seed": 0, **options, "world": task.worlds[0], "noise": task.noise}
        rate = task.rate if rate is None else rate
    connection = find(checked_name(name))
    if connection is None:
        here = folder or os.getcwd()
        texts = Texts(given_in)
        saver = Saver(texts, kept_texts(here, name), os.path.realpath(FilePath(here) / name))
        first, *later = saver.first_texts(text) or [""]
        if saver.hung in (first, *later):
            paused = _HAS_HUNG
        path = None if log is None else FilePath(here) / log
        session = _open_session(
            name, first, bridge or "sim", namespace, 10.0 if rate is None else rate, options, paused, path
        )
        reopen = partial(_reopen, log=path)
        connection = _add(
            PageConnection(session, saver, reopen, options, free_name=_free_name, beside=FilePath(here))
        )
        connection.log = log
        texts.line = line
        for each in (first, *later):
            if each != texts.text:
                texts.write(each)
    else:
        if log not in (None, connection.log):
            raise LRPError(
                f"`{name}` is open, and a recording begins before its first tick. End the program with "
                f'`lrp_jupyter.Lab("{name}").close()`, then open it again.'
            )
        if bridge is not None and bridge != connection.session.bridge.name:
            connection.change_bridge(bridge, **options)
        elif options and options != connection.options:
            connection.change_bridge(connection.session.bridge.name, **options)
    if runs is not None:
        connection.runs.attach_folder(runs)
    if conditions is not None:
        connection.texts.set_conditions(conditions)
    goal = connection.goal
    if task is not None and (goal is None or (goal.task, goal.hints) != (task, hints)):
        connection.goal = Goal(task, hints)
    if text:
        connection.texts.line = line
        connection.texts.reconcile(text)
    elif task is not None and not connection.texts.text.strip():
        connection.texts.write(task.beginning)
    if connection.session.status == "broken":
        connection.session.start()
    if rate is not None:
        connection.session.rate = rate
    if on_active_edit is not None:
        connection.session.on_active_edit = on_active_edit
    connection.saver.save()  # no page may ever open
    connection.wake()
    return connection


def _line(name: str, bridge: str | None, task: Challenge | None, options: Mapping[str, Any]) -> str:
    given = {"bridge": None if bridge == "sim" else bridge, "challenge": task and task.name, **options}
    words = [
        f"--{key.replace('_', '-')} {shlex.quote(str(value))}"
        for key, value in given.items()
        if isinstance(value, (str, int, float)) and not isinstance(value, bool)
    ]
    return " ".join([shlex.quote(name), *words])


def robot_for(world: World | str | None) -> dict[str, Any]:
    """Return the arguments of :func:`open_program` for the world, if any, that a program names."""
    if world == "none":
        return {"bridge": "none"}
    return {} if world is None else {"bridge": "sim", "world": world}


def _open_session(
    name: str,
    text: str,
    bridge: str | Bridge,
    namespace: dict[str, Any] | None,
    rate: float,
    options: dict[str, Any],
    paused: str = "",
    log: FilePath | None = None,
) -> Session:
    program, _ = scan(text, f"<lrp {name}>")
    robot = bridge if isinstance(bridge, Bridge) else make_bridge(bridge, **options)
    session = Session(
        "" if program is None else program,
        robot,
        rate=rate,
        name=name,
        namespace=namespace,
        dead_man=DEAD_MAN if robot.hardware else None,
    )
    try:
        if log is not None:
            session.record_until_closed(log)
        session.start(bool(paused))
        if paused:
            session.pause(paused)
    except BaseException:
        session.close()
        raise
    return session


def _reopen(old: Session, bridge: str | Bridge, log: FilePath | None = None, **options: Any) -> Session:
    new = _open_session(old.name, old.program.text, bridge, old.namespace, old.rate, options, log=log)
    for policy in ("on_active_edit", "on_issue"):
        new.ask(do.SetPolicy(policy, getattr(old, policy)))
    return new


@atexit.register
def _close_all() -> None:
    for connection in list(running()):
        connection.close()
