"""The exercises of the lessons, and the series of bugs: for homework, and for those who are done early."""

from lrp_jupyter.grading.bundled.exercises import states_and_events

__all__ = ["EXERCISES"]

EXERCISES = (*states_and_events.EXERCISES,)
