"""A robot with the readings of one earlier tick, for evaluating a condition again."""

from __future__ import annotations

from collections.abc import Mapping
from operator import attrgetter
from typing import Any

from lrp_jupyter.bridges.argument_values import answer_to
from lrp_jupyter.bridges.member_tree import RobotMethod
from lrp_jupyter.bridges.tasks import RobotTask, TaskState, arguments_of
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


class _EarlierAnswers:
    """What a method that only asks for something has answered in a tick."""

    QUESTIONS = ("answer",)

    def __init__(self, method: RobotMethod, answers: object) -> None:
        self._method, self._answers = method, answers if isinstance(answers, list) else []

    def answer(self, *arguments: object) -> object:
        """Return the answer to the same question."""
        told = answer_to(arguments_of(self._method.bind(arguments, {})), self._answers)
        if told is None:
            raise UnknownValueError(f"`robot.{self._method.path}` was not asked this in this tick.")
        if isinstance(told[1], Exception):
            raise told[1]
        return told[1]


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
        node = self._nodes.get(path)
        if isinstance(node, RobotTask):
            return _EarlierTask(TaskState())
        if isinstance(node, RobotMethod) and not node.command:
            return _EarlierAnswers(node, self._readings.get(f"{path}()")).answer
        if "." in name:  # asked for at once, see `language.blocks.companions`
            return attrgetter(name)(self)
        if any(each.startswith(f"{path}.") for each in (*self._nodes, *self._readings)):
            return RecordedRobot(self._readings, self._nodes, f"{path}.")
        raise UnknownValueError(f"`robot.{path}` was not read in this tick.")
