"""The bundled challenges, from easy to hard: each has one idea more than those before it."""

from lrp_jupyter.grading.bundled.asking import EXACT_SQUARE, THREE_TABLES
from lrp_jupyter.grading.bundled.beginning import FIRST_MOVE, HALF_THE_SPEED
from lrp_jupyter.grading.bundled.boxes import PUSH_THE_BOX
from lrp_jupyter.grading.bundled.broken import BROKEN_ROBOTS
from lrp_jupyter.grading.bundled.bumping import BUMP_AND_STAY, BUMP_AND_TURN, BUMP_OUT, LAMP
from lrp_jupyter.grading.bundled.editing import EDIT_IT_LIVE, SAFE_EDITS
from lrp_jupyter.grading.bundled.exploring import EDGE_GUARD, LOOK_BOTH_WAYS, MAZE
from lrp_jupyter.grading.bundled.lines import (
    FIND_THE_LINE,
    FOLLOW_THE_LINE,
    STOP_AT_THE_LINE,
    STOP_AT_THE_WIDE_LINE,
)
from lrp_jupyter.grading.bundled.measuring import EXACT_WAY, KEEP_YOUR_DISTANCE, STOP_BEFORE_THE_WALL
from lrp_jupyter.grading.bundled.returning import (
    DEBUG_THE_LISTING,
    LAP,
    ROBUST_FOLLOWER,
    THERE_AND_BACK,
)
from lrp_jupyter.grading.bundled.squares import LAMP_AND_LEGS, SQUARE, TWO_SQUARES
from lrp_jupyter.grading.bundled.walls import KEEP_ALONG, WALL_FOLLOWER

__all__ = ["BUNDLED"]

BUNDLED = (
    FIRST_MOVE,
    HALF_THE_SPEED,
    BUMP_AND_STAY,
    BUMP_AND_TURN,
    LAMP,
    SQUARE,
    STOP_AT_THE_WIDE_LINE,
    STOP_AT_THE_LINE,
    EXACT_SQUARE,
    THREE_TABLES,
    FIND_THE_LINE,
    LOOK_BOTH_WAYS,
    BUMP_OUT,
    THERE_AND_BACK,
    DEBUG_THE_LISTING,
    *BROKEN_ROBOTS,
    FOLLOW_THE_LINE,
    LAP,
    ROBUST_FOLLOWER,
    LAMP_AND_LEGS,
    SAFE_EDITS,
    TWO_SQUARES,
    EXACT_WAY,
    KEEP_YOUR_DISTANCE,
    STOP_BEFORE_THE_WALL,
    KEEP_ALONG,
    WALL_FOLLOWER,
    EDGE_GUARD,
    PUSH_THE_BOX,
    MAZE,
    EDIT_IT_LIVE,
)
