"""Record the kernel's messages while the follower drives, for the page that shows the lab without one.

``python js/tests/page/record.py [PROGRAM OUT]`` writes ``recording.json`` beside itself: a snapshot,
then frames and poses at 10 Hz, published by a real session in virtual time.
"""

from __future__ import annotations

import base64
import json
import sys
from pathlib import Path
from typing import Any

from lrp_jupyter import programs
from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.session import Session
from lrp_jupyter.widgets.connection import PageConnection
from lrp_jupyter.widgets.text.saver import Saver
from lrp_jupyter.widgets.text.texts import Texts

HERE = Path(__file__).parent
TICKS = 300
SKIP = 20
ALWAYS = {  # a page that plays a recording shows it running at its rate
    "status": "running",
    "rate": {"wanted": 10, "achieved": 10},
    "speed": {"wanted": 1, "achieved": 1},
}


class Recorder(PageConnection):
    """A connection whose publisher is this script."""

    def start(self) -> None:
        """Start no thread."""


def main(program_file: Path | None = None, out_file: Path = HERE / "recording.json") -> None:
    """Write the recording."""
    text = programs.load("follower") if program_file is None else program_file.read_text(encoding="utf-8")
    session = Session(text, bridge="sim", clock=VirtualClock(), world="line", name="follower")
    now, came = [0.0], []
    connection = Recorder(session, Saver(Texts()), clock=lambda: now[0])

    def hear(message: dict[str, Any], buffers: list[bytes] | None) -> None:
        came.append((message, buffers))
        frame = message["frame"]["frame"] if message["type"] == "snapshot" else message.get("frame")
        if frame is not None:
            connection.receive(hear, {"type": "credit", "view": "v", "frame": frame})

    session.run(seconds=0.1)
    connection.receive(hear, {"type": "hello", "view": "v", "part": "lab"})
    for _ in range(TICKS - 1):
        session.run(seconds=0.1)
        now[0] += 0.1
        connection.publish()
    (snapshot, _), *messages = came
    del snapshot["view"]  # a page gives itself another name
    snapshot["document"] = "recorded"
    snapshot["frame"].update(ALWAYS)
    frames = []
    for message, buffers in messages[SKIP:]:
        if message["type"] == "frame" and buffers:
            kept = {
                field: value for field, value in message.items() if field not in ("view", "reason", *ALWAYS)
            }
            frames.append({"frame": kept, "poses": base64.b64encode(buffers[0]).decode()})
    connection.close()
    out = {"snapshot": snapshot, "frames": frames}
    out_file.write_text(json.dumps(out, separators=(",", ":"), allow_nan=False), encoding="utf-8")


main(*map(Path, sys.argv[1:]))
