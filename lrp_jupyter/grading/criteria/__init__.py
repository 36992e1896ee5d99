"""Criteria for a run: regions and times, never exact poses.

A criterion is a sentence and a function of the record of a run. The record grows while the robot drives, and
the function is asked after every tick: so the same criteria are shown live, and judge a finished run. These
functions make criteria; a teacher writes more of them as ``Criterion(sentence, judge)``.
"""

from lrp_jupyter.grading.criteria.contact import (
    backs_off_at_bumps,
    bumps,
    bumps_in,
    keeps_distance,
    never_pushes,
    stops_at,
    touches,
    touches_nothing,
    turns_at_bumps,
)
from lrp_jupyter.grading.criteria.criterion import Criterion, Found, State, Verdict, When
from lrp_jupyter.grading.criteria.lamp import blinks, lit_while
from lrp_jupyter.grading.criteria.line import ends_near_line, finds_line, near_line, on_line, sees_line
from lrp_jupyter.grading.criteria.looking import looks
from lrp_jupyter.grading.criteria.motion import (
    backs_off,
    drives,
    drives_smoothly,
    drives_straight,
    ends_still,
    keeps_driving,
    lasts,
    not_carried,
    stops_once,
    turns,
    within,
)
from lrp_jupyter.grading.criteria.places import (
    avoids,
    covers,
    ends_in,
    gets_away,
    keeps_to,
    pushes,
    stays_in,
    stays_near,
    visits,
)
from lrp_jupyter.grading.criteria.program_rules import (
    drives_differently,
    drives_on,
    edited,
    enters,
    moves_only_in,
    never_restarts,
    no_faults,
    reused,
    slows_to,
    without,
)

__all__ = [
    "Criterion",
    "Found",
    "State",
    "Verdict",
    "When",
    "avoids",
    "backs_off",
    "backs_off_at_bumps",
    "blinks",
    "bumps",
    "bumps_in",
    "covers",
    "drives",
    "drives_differently",
    "drives_on",
    "drives_smoothly",
    "drives_straight",
    "edited",
    "ends_in",
    "ends_near_line",
    "ends_still",
    "enters",
    "finds_line",
    "gets_away",
    "keeps_distance",
    "keeps_driving",
    "keeps_to",
    "lasts",
    "lit_while",
    "looks",
    "moves_only_in",
    "near_line",
    "never_pushes",
    "never_restarts",
    "no_faults",
    "not_carried",
    "on_line",
    "pushes",
    "reused",
    "sees_line",
    "slows_to",
    "stays_in",
    "stays_near",
    "stops_at",
    "stops_once",
    "touches",
    "touches_nothing",
    "turns",
    "turns_at_bumps",
    "visits",
    "within",
    "without",
]
