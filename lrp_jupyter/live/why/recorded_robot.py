"""A robot with the readings of one earlier tick, for evaluating a condition again."""

from __future__ import annotations

from collections.abc import Mapping
from operator import attrgetter
from typing import Any

from lrp_jupyter.bridges.tasks import RobotTask, TaskState
from lrp_jupyter.errors import NotAValue
from lrp_jupyter.language.blocks.expressions import UnknownValueError


class _EarlierTask(NotAValue):
    """A task, with its state when the tick began."""

    def __init__(self, state: TaskState) -> None:
        self._state = state

    def __getattr__(self, name: str) -> Any:
        if name == "since":
            raise UnknownValueError("The time of a task is not recorded.")
        return getattr(self._state, name)


class RecordedRobot(NotAValue):
    """A robot with only the readings of one tick, or the part of it that has a prefix, such as ``light.``."""

    def __init__(self, readings: Mapping[str, object], nodes: Mapping[str, object], prefix: str = "") -> None:
        self._readings, self._nodes, self._prefix = readings, nodes, prefix

    def __getattr__(self, name: str) -> Any:
        path = self._prefix + name
        if path in self._readings:
            value = self._readings[path]
            if isinstance(value, Exception):
                raise value
            return _EarlierTask(value) if isinstance(value, TaskState) else value
        if isinstance(self._nodes.get(path), RobotTask):
            return _EarlierTask(TaskState())
        if "." in name:  # asked for at once, see `language.blocks.companions`
            return attrgetter(name)(self)
        if any(each.startswith(f"{path}.") for each in self._nodes):
            return RecordedRobot(self._readings, self._nodes, f"{path}.")
        raise UnknownValueError(f"`robot.{path}` was not read in this tick.")
