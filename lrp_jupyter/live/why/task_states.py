"""What had become of the tasks that a condition is about."""

from __future__ import annotations

from lrp_jupyter.bridges.tasks import RobotTask, TaskState
from lrp_jupyter.errors import ended
from lrp_jupyter.live.why.answer_draft import AnswerDraft
from lrp_jupyter.live.why.case import Case
from lrp_jupyter.live.why.recorded_run import RecordedRun
from lrp_jupyter.live.why.wording import time_text

_BACK = 1000  # ticks


def tell_of_tasks(draft: AnswerDraft, case: Case) -> None:
    """Say something about each task of the robot that the condition of a transition mentions."""
    text = "" if case.tested is None else case.tested[0].text
    for name, node in case.run.loop.bridge.nodes.table.items():
        if isinstance(node, RobotTask) and f"robot.{name}." in text:
            draft.say(task_text(case.run, name, case.tick))


def task_text(run: RecordedRun, name: str, tick: int) -> str:
    """Return a sentence about the state of a task when a tick began."""
    state, robot = _state(run, name, tick), f"`robot.{name}`"
    match state.status:
        case None:
            return f"{robot} was not asked for{_forgotten(run, name, tick)}."
        case "active":
            return f"{robot} had been under way since {time_text(state.at)}."
        case "succeeded":
            return f"{robot} succeeded at {time_text(state.at)}."
        case status:
            why = f": {state.reason}" if state.reason else ""
            return ended(f"{robot} was {status} at {time_text(state.at)}{why}")


def _state(run: RecordedRun, name: str, tick: int) -> TaskState:
    record = run.loop.record
    state = record.readings_of(record.moment(tick).sensed).get(name)
    return state if isinstance(state, TaskState) else TaskState()


def _forgotten(run: RecordedRun, name: str, tick: int) -> str:
    """Say since when an outcome is forgotten, if there was one not long before."""
    for earlier in range(tick - 1, max(tick - _BACK, run.history.ticks.start) - 1, -1):
        status = _state(run, name, earlier).status
        if status is not None:
            was = "it was under way" if status == "active" else f"its outcome was `{status}`"
            since = time_text(run.time(earlier))
            return f"; until {since} {was}, which ended with the state that had asked for it"
    return ""
