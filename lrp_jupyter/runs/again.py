"""What a person does with a kept run: look at it in the session that runs, or record it again."""

from __future__ import annotations

import os
import random
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from lrp_jupyter.bridges.sim import SimBridge
from lrp_jupyter.errors import LRPError
from lrp_jupyter.files import unwritable
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import path_text
from lrp_jupyter.live.recorder import Recorder, start_of
from lrp_jupyter.live.recording import Recording, RunStart, random_of, read_recording
from lrp_jupyter.live.session import Session
from lrp_jupyter.logs import open_log
from lrp_jupyter.runs.rerun import check_own, drive_again, session_for

_LIMIT = 10.0  # s of computing


def begin_run(session: Session) -> None:
    """Put the world back to its start, and the program, too, without the issues of the run before.

    Both go on when the session does.

    Raises
    ------
    SessionTimeoutError
        A block does not return.
    """
    session.pause()
    session.reset()
    session.clear_issues()
    if isinstance(session.bridge, SimBridge):
        session.bridge.reset_world()
        session.call(session._loop.settle)  # at once


def show_run(session: Session, recording: Recording) -> float:
    """Repeat a kept run in a session whose robot is like the recorded one; return when it began there.

    The session is paused, in the recorded world, at the end of the run.

    Raises
    ------
    SessionTimeoutError
        A block does not return.
    LRPError
        It contains an expression that someone else may have recorded, or did not begin as the program does.
    """
    check_own(recording)
    _check_beginning(session, recording.start)
    session.pause()
    bridge, start, world = session.bridge, recording.start, recording.start.world
    if isinstance(bridge, SimBridge) and world is not None:
        session.call(lambda: bridge.load_world(world))
    session.reset()
    random.setstate(random_of(start.random).getstate())
    return drive_again(session, recording, _LIMIT)


def _check_beginning(session: Session, start: RunStart) -> None:
    """Raise LRPError if a run began with something else than the program of a session does."""
    if start.start != path_text(session.interpreter.start or ()):
        raise LRPError(
            f"The run began with `{start.start}` alone, but the program here begins with everything that it "
            "spawns, so the run cannot be shown here."
            if start.start
            else "The run began with everything that its program spawns, but here one machine is started "
            "alone, so the run cannot be shown here."
        )
    if start.initials and start.program(session.program) != session.program:
        given = ", ".join(f"`(var {name} := [{value}])`" for name, value in start.initials.items())
        raise LRPError(f"The run began with {given}. Write that into the program to look at the run.")


def record_again(file: Path, text: str, namespace: Mapping[str, Any]) -> None:
    """Run a kept run again with a program, and replace its recording by that of this run.

    Raises
    ------
    LRPSyntaxError
        The text is not a valid program.
    FileError
        The file cannot be written; the old one stays.
    LRPError
        It contains an expression that someone else may have recorded.
    """
    recording = read_recording(file)
    check_own(recording)
    new = file.with_name(f".new {file.name}")
    try:
        with session_for(recording, parse(text), namespace) as session, open_log(new) as stream:
            old = recording.start
            began = replace(start_of(session._loop, initials=old.initials), bridge=old.bridge)
            recorder = Recorder(session._loop, stream.write, began)
            drive_again(session, recording, _LIMIT)
            recorder.end()
        os.replace(new, file)
    except OSError as error:
        raise unwritable(file, error) from None
    finally:
        new.unlink(missing_ok=True)
