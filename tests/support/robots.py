"""Robots that tests drive: a bare one, to which a test adds what it needs; one that is asked; one that tells.

They connect nothing, and keep what reaches them.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from queue import Queue
from typing import Any

from lrp_jupyter.bridges.bridge import Bridge, BridgeError, Task

_QUIET = ("close_interface", "sense", "act", "on_start", "on_resume")  # hooks that do nothing by default


class Bare(Bridge, offered=False):
    """A robot with the members that a test gives it.

    Parameters
    ----------
    members : callable
        Adds members to the bridge, whenever it is opened.
    hardware : bool
    notes : str
        Names of hooks whose calls are listed in `calls`, as in ``"open_interface stop"``.
    **replaced
        Hooks and attributes of the bridge.

    Attributes
    ----------
    calls : list
        The noted hooks, and the speeds that reached `move`, in their order.
    failing : dict of str to BaseException
        What a hook raises, by its name; of a noted hook, or of one that does nothing by default.
    """

    name = "test-bare"
    stop_timeout = None  # nothing here blocks

    def __init__(
        self,
        members: Callable[[Any], object] = lambda _: None,
        *,
        hardware: bool = False,
        notes: str = "",
        **replaced: Any,
    ) -> None:
        self.hardware, self.safety.armed = hardware, not hardware  # type: ignore[misc]
        self.calls: list[Any] = []
        self.failing: dict[str, BaseException] = {}
        self._add, self._noted = members, notes.split()
        for hook in (*_QUIET, *self._noted):
            setattr(self, hook, self._hook(hook))
        vars(self).update(replaced)

    def _hook(self, name: str) -> Callable[..., None]:
        def hook(*_: object) -> None:
            if name in self._noted:
                self.calls.append(name)
            if name in self.failing:
                raise self.failing[name]

        hook.__name__ = name
        return hook

    def add_members(self) -> None:
        """Add the members of the test."""
        self._add(self)

    def open_interface(self) -> None:
        """There is nothing to connect."""

    def move(self, linear: float = 0.0) -> None:
        """Drive, for a member that the test adds."""
        self.calls.append(linear)


class Cart(Bare):
    """A cart that is asked for its readings: about what a student writes.

    Attributes
    ----------
    sent : list of tuple
        The speeds that reached it, linear and angular.
    light, battery : object
        What its sensors measure.
    reads : int
        How often `light` was read.
    """

    name = "test-cart"

    def __init__(self, members: Callable[[Any], object] = lambda _: None, **options: Any) -> None:
        super().__init__(members, **{"hardware": True, **options})
        self.sent: list[tuple[float, float]] = []
        self.light: object = 7
        self.battery: object = 0.5
        self.reads = 0

    def add_members(self) -> None:
        """Add readings and commands."""
        self.add_variable("light.data", self.read_light, doc="0 dark ... 255 bright")
        self.add_variable("battery", lambda: self.battery, doc="what is left", unit="V")
        self.add_method("move", self.move, doc="m/s and rad/s", limits={"linear": 0.5})
        self.add_method("beep", self.beep)
        super().add_members()

    def read_light(self) -> object:
        """Measure."""
        self.reads += 1
        return self.light

    def move(self, linear: float = 0.0, angular: float = 0.0) -> None:
        """Drive."""
        self.sent.append((linear, angular))

    def beep(self, seconds: float, *, tone: int = 440) -> str:
        """Sound a tone.

        It lasts for the given time.
        """
        return f"{tone} Hz for {seconds} s"


class Buggy(Bare):
    """A buggy that tells what it measures: the test feeds it, and moves its clock.

    Attributes
    ----------
    time : float
        By which its readings grow old.
    """

    name = "test-buggy"

    def __init__(self, members: Callable[[Any], object] = lambda _: None, **options: Any) -> None:
        super().__init__(members, **{"hardware": True, "notes": "stop", **options})
        self.time = 100.0
        if self.time_step is None:  # else it has the time of its world
            self.fed.clock = lambda: self.time

    def add_members(self) -> None:
        """Add readings and commands."""
        self.feed("light.data", doc="0 dark ... 255 bright", unit="lx", type=int)
        self.feed("battery", doc="what is left", stale_after=None)
        self.add_method("move", self.move, "drive, in m/s")
        self.add_method("beep", lambda: self.calls.append("beep"), "sound a tone")
        super().add_members()


class Courier(Bridge, offered=False):
    """A robot that is asked for tasks: to go to a place, to run a lap, and to call for something.

    Parameters
    ----------
    hardware : bool

    Attributes
    ----------
    log : list of str
        What has reached the robot: ``go 1``, ``cancel go 1``, ``call lamp``, ``stop``.
    begun : queue of Task
        Those that were begun, in their order; the last one of a name is `under_way`.
    """

    name = "test-courier"

    def __init__(self, hardware: bool = False) -> None:
        self.hardware = hardware  # type: ignore[misc]
        self.safety.armed = not hardware
        self.log: list[str] = []
        self.begun: Queue[Task] = Queue()
        self._places: dict[int, object] = {}

    def open_interface(self) -> None:
        """There is nothing to connect."""

    def add_members(self) -> None:
        """Add the tasks."""
        self.add_task("go", self.go, self.cancel, "go to a place")
        self.add_task("lap", self.go, self.cancel, "run a lap", replaces=True)
        self.add_task("call", self.call, doc="call for something", moves=False)

    def go(self, task: Task, place: object = 0) -> None:
        """Begin to go to a place; a place that does not exist is refused."""
        if str(place) == "nowhere":
            raise BridgeError("There is no such place.")
        self._places[task.number] = place
        self.log.append(f"{task.name} {place}")
        if task.replaced is not None:
            self.cancel(task.replaced)
        self.begun.put(task)

    def call(self, task: Task, what: str) -> None:
        """Call for something, which does not end before it has come."""
        self.log.append(f"call {what}")
        self.begun.put(task)

    def cancel(self, task: Task) -> None:
        """Go no further, if it goes there."""
        place = self._places.pop(task.number, None)
        if place is not None:
            self.log.append(f"cancel {task.name} {place}")

    def stop(self) -> None:
        """Stand still."""
        self.log.append("stop")

    def next(self) -> Task:
        """Return the next task that was begun, when it is."""
        return self.begun.get(timeout=60)


class Clockwork(Bridge, offered=False):
    """A robot whose tasks take some seconds of its own world, and which the test tells the rest.

    Parameters
    ----------
    readings : dict of str to object
        What it reads, by name.
    **seconds : float
        Its tasks, and how long each takes. One of the name ``call`` or ``lamp`` cannot be cancelled.

    Attributes
    ----------
    plans : dict of tuple to list
        For a task with arguments, the statuses with which it will end, one after the other; None: never.
    log : list of tuple
        What was asked for, with the arguments, and what was cancelled.
    """

    name = "test-clockwork"
    hardware = False
    time_step = 0.05

    def __init__(self, readings: dict[str, object] | None = None, **seconds: float) -> None:
        self.given = readings or {}
        self.seconds = seconds
        self.plans: dict[tuple[object, ...], list[Any]] = {}
        self.log: list[tuple[object, ...]] = []
        self.time = 0.0
        self._due: dict[int, tuple[float, Task, Any]] = {}

    def open_interface(self) -> None:
        """Add readings and tasks."""
        for name in self.given:
            self.add_variable(name, partial(self.given.__getitem__, name))
        for name in self.seconds:
            self.add_task(name, self.start, None if name in ("call", "lamp") else self.cancel)

    def start(self, task: Task, *arguments: object) -> None:
        """Begin a task."""
        asked = (task.name, *arguments)
        self.log.append(asked)
        plans = self.plans.get(asked)
        outcome = plans.pop(0) if plans else "succeeded"
        if outcome is not None:
            self._due[task.number] = self.time + self.seconds[task.name], task, outcome

    def cancel(self, task: Task) -> None:
        """Go on with it no further."""
        self._due.pop(task.number, None)
        self.log.append(("cancel", task.name))

    def advance(self, seconds: float) -> None:
        """Let what is due end."""
        self.time += seconds
        for number, (due, task, outcome) in tuple(self._due.items()):
            if due <= self.time + 1e-9:
                del self._due[number]
                task.update(outcome)
