"""The exercises of the lessons, and the series of bugs: for homework, and for those who are done early."""

from lrp_jupyter.grading.bundled.exercises import (
    asking_why,
    exact_ways,
    find_the_bug,
    first_edits,
    from_everywhere,
    line_follower,
    live_safety,
    looking_back,
    machine_reuse,
    machines_inside_states,
    own_tests,
    proportional_control,
    robust_numbers,
    side_by_side,
    states_and_events,
    time_is_a_condition,
    what_a_state_does,
    what_the_robot_sees,
)

__all__ = ["EXERCISES"]

EXERCISES = (
    *first_edits.EXERCISES,
    *states_and_events.EXERCISES,
    *what_a_state_does.EXERCISES,
    *time_is_a_condition.EXERCISES,
    *what_the_robot_sees.EXERCISES,
    *machines_inside_states.EXERCISES,
    *from_everywhere.EXERCISES,
    *line_follower.EXERCISES,
    *asking_why.EXERCISES,
    *looking_back.EXERCISES,
    *robust_numbers.EXERCISES,
    *side_by_side.EXERCISES,
    *live_safety.EXERCISES,
    *machine_reuse.EXERCISES,
    *exact_ways.EXERCISES,
    *proportional_control.EXERCISES,
    *own_tests.EXERCISES,
    *find_the_bug.BUGS,
)
