r"""Tell a bridge what happens in a run, so that others can follow it beside the robot's sensors.

A bridge that overrides :meth:`Bridge.tell <lrp_jupyter.bridges.bridge.Bridge.tell>` is told after each tick
and each command in which something happened. Each time it is told all that a listener who comes later has to
know, and what has happened since the last time::

    {"program": "follower", "file": "follower.lrp", "status": "running", "reason": "",
     "tick": 12, "time": 1.1, "stamp": 1764393392.12, "active": ["follower/moving"],
     "events": [{"tick": 12, "time": 1.1, "event": "left", "state": "follower/looking"},
                {"tick": 12, "time": 1.1, "event": "fired", "machine": "follower", "transition": "tmoving",
                 "source": "looking", "destination": "moving", "line": 29,
                 "why": "`tmoving` (line 29) fired at 1.1 s, from `looking` to `moving`, because …",
                 "values": {"robot.light.data": 0, "lightlim": 128}},
                {"tick": 12, "time": 1.1, "event": "entered", "state": "follower/moving"}]}

``status`` is that of a :class:`~lrp_jupyter.live.running.frame.Frame`, with its reason; ``stamp`` is what
the robot's clock shows, or else this computer's, in seconds; ``active`` are the states that are active now.
The events are the lines of the trace (`lrp_jupyter.live.trace`), without ``changed``, ``commanded`` and
``printed``. ``fired`` also has ``line``, ``why`` and ``values`` where the bridge wants them (`tells_why`) and
the session remembers ticks; ``patched`` has its ``changes``. A notice of the robot's safety is another one:
``{"event": "notice", "kind": "stale", "message": "…"}``.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from typing import Any

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.guarding.safety import Notice
from lrp_jupyter.errors import sentence_of
from lrp_jupyter.interpreter.facts import Fired
from lrp_jupyter.interpreter.patching import Patch
from lrp_jupyter.interpreter.trace_events import TraceEvent
from lrp_jupyter.language.program import path_text
from lrp_jupyter.live.running.commands import Call
from lrp_jupyter.live.running.loop import Loop
from lrp_jupyter.live.trace import as_dict, json_value
from lrp_jupyter.live.why.recorded_run import RecordedRun
from lrp_jupyter.live.why.transitions import transition_reason

_LEFT_OUT = frozenset({"changed", "commanded", "printed"})
REMEMBERED = 10
"""Ticks that a session has to remember, at least, for a bridge that wants to know why."""


class Teller:
    """Tells the bridge of a loop what happens in it; `name` is that of the program.

    It observes the interpreter. Nothing waits for it: where another thread is telling just now, the events
    are told the next time.
    """

    def __init__(self, loop: Loop, name: str) -> None:
        self._loop, self._name = loop, name
        self._events: deque[TraceEvent | Notice] = deque(loop.bridge.safety.notices)
        self._status = "ready"
        self._busy = threading.Lock()
        loop.bridge.safety.noticed = self._noticed
        loop.after_tick.append(self.after_tick)
        loop.interpreter.observe(self)

    def __call__(self, event: TraceEvent) -> None:
        """Keep an event until the tick or command is over."""
        if event.kind not in _LEFT_OUT:
            self._events.append(event)

    def _noticed(self, notice: Notice) -> None:
        """Keep a notice, on any thread; while the program does not run, no tick would tell it."""
        self._events.append(notice)
        if self._loop.status != "running":
            self._loop.inbox.put(Call(lambda: None))

    def after_tick(self) -> None:
        """Tell what happened in a tick; on the thread that drives the loop."""
        if self._events:
            self._tell(self._loop.interpreter.tick)

    def published(self, name: str) -> None:
        """Tell what happened between two ticks, or that the status is another one; on any thread."""
        self._name = name
        if self._events or self._shown_status != self._status:
            self._tell(0)

    @property
    def _shown_status(self) -> str:
        return self._loop.status if self._loop.hung is None else "hung"

    def _tell(self, tick: int) -> None:
        """Tell the bridge; `tick` is the one that is over just now, if there is one."""
        loop, bridge = self._loop, self._loop.bridge
        if not bridge.is_open or not self._busy.acquire(blocking=False):
            return
        try:
            hung, frame, clock = loop.hung, loop.frame, bridge.world_time()
            self._status = self._shown_status
            events = [self._events.popleft() for _ in range(len(self._events))]
            told = {
                "program": self._name,
                "file": frame.program.filename,
                "status": self._status,
                "reason": loop.reason if hung is None else str(hung),
                "tick": tick or frame.tick,
                "time": round(loop.timing.now if tick else frame.time, 9),
                "stamp": time.time() if clock is None else clock,
                "active": [path_text(path) for path in (loop.interpreter.active if tick else frame.active)],
                "events": [self._line(event, tick) for event in events],
            }
            bridge.tell(told)
        except Exception as error:  # of the author of a bridge; the run goes on
            bridge.safety.notice("fault", f"What happens could not be told: {sentence_of(error)}", "tell")
        finally:
            self._busy.release()

    def _line(self, event: TraceEvent | Notice, tick: int) -> dict[str, Any]:
        if isinstance(event, Notice):
            when = {"tick": self._loop.interpreter.tick, "time": round(event.now, 9)}
            return {**when, "event": "notice", "kind": event.kind, "message": event.text}
        line = as_dict(event)
        if isinstance(event.data, Patch):
            line["changes"] = str(event.data.changes)
        if isinstance(event.data, Fired) and event.tick == tick and self._loop.bridge.tells_why:
            line |= self._why(event.data, tick)
        return line

    def _why(self, fired: Fired, tick: int) -> dict[str, Any]:
        """Return why a transition fired in the tick that is over; some 0.2 ms."""
        interpreter = self._loop.interpreter
        if tick not in interpreter.history.ticks:  # the session remembers nothing
            return {}
        run = RecordedRun(self._loop, lambda *_: None)
        run.instance = fired.machine, tick
        reason = transition_reason(run, fired.transition, interpreter.program, tick)
        lines, values = reason.facts.get("lines", ()), reason.facts.get("values", {})
        return {
            "line": lines[0] if lines else 0,
            "why": reason.sentence,
            "values": {text: json_value(value) for text, value in values.items()},
        }


def make_teller(loop: Loop, name: str) -> Teller | None:
    """Return what tells the bridge of a loop; None if it has nothing to do with what it is told."""
    return None if type(loop.bridge).tell is Bridge.tell else Teller(loop, name)
