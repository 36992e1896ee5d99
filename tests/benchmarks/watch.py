"""Runs in the kernel that is measured: when what happened, and what could grow."""

import gc
import threading
import time
from pathlib import Path

from lrp_jupyter.widgets import registry

connection = registry.find("m")
session = connection.session
stamps = []  # kind of event, path, seconds on the wall
session.observe(lambda event: stamps.append((event.kind, "/".join(event.path), time.time())))


def fired():
    return sum(session.frame.fired.values())


def load():
    """Ticks per second, threads, megabytes, what waits, frames on their way."""
    rate = session.frame.achieved_rate  # before everything stands still for the collection
    stamps.clear()
    gc.collect()
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    waiting = len(connection.texts.waiting) + len(connection._publisher._replies) + len(session._loop.inbox)
    on_their_way = [len(view._window._sent) for view in connection._publisher._views.values()]
    return (
        rate,
        threading.active_count(),
        pages * 4096 / 1e6,
        waiting,
        max(on_their_way),
    )
