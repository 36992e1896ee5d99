"""What a person does with a kept run: look at it in the session that runs, or record it again."""

from __future__ import annotations

import os
import random
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from lrp_jupyter.bridges.sim import SimBridge
from lrp_jupyter.files import unwritable
from lrp_jupyter.language.parser import parse
from lrp_jupyter.live.recorder import Recorder, start_of
from lrp_jupyter.live.recording import Recording, random_of, recording_of
from lrp_jupyter.live.session import Session
from lrp_jupyter.logs import open_log
from lrp_jupyter.runs.rerun import drive_again, session_for

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
    """
    session.pause()
    bridge, start, world = session.bridge, recording.start, recording.start.world
    if isinstance(bridge, SimBridge) and world is not None:
        session.call(lambda: bridge.load_world(world))
    session.reset()
    random.setstate(random_of(start.random).getstate())
    return drive_again(session, recording, _LIMIT)


def record_again(file: Path, text: str, namespace: Mapping[str, Any]) -> None:
    """Run a kept run again with a program, and replace its recording by that of this run.

    Raises
    ------
    LRPSyntaxError
        The text is not a valid program.
    FileError
        The file cannot be written; the old one stays.
    """
    recording = recording_of(file)
    new = file.with_name(f".new {file.name}")
    try:
        with session_for(recording, parse(text), namespace) as session, open_log(new) as stream:
            began = replace(start_of(session._loop), bridge=recording.start.bridge)
            recorder = Recorder(session._loop, stream.write, began)
            drive_again(session, recording, _LIMIT)
            recorder.end()
        os.replace(new, file)
    except OSError as error:
        raise unwritable(file, error) from None
    finally:
        new.unlink(missing_ok=True)
