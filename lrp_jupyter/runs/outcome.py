"""What came of a kept run that was run again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple, get_args

from lrp_jupyter.grading.attempt import Ended
from lrp_jupyter.grading.untrusted import number_in, one_of, text_in
from lrp_jupyter.live.coverage import REACHED

OPEN_LOOP = (
    "A real robot was recorded: from the first difference on, its readings are those of the recorded drive, "
    "not what the robot would have read with this program."
)


class PartVerdict(NamedTuple):
    """The verdict on one part of an expectation.

    `part`: as a person writes it.
    `reason`: a sentence.
    `time`: when it was decided, in seconds of the run; None if only the end decided.
    """

    part: str
    passed: bool
    reason: str
    time: float | None = None


class StateEntered(NamedTuple):
    """A state that was entered, or None for the end of its machine: when (s), and in which machine.

    `lane`: the path of the machine, as spawned.
    """

    time: float
    lane: str
    state: str | None


class RunOutcome(NamedTuple):
    """What came of a run that was run again.

    `found`: the verdict on each part of what is expected.
    `difference`: the first difference of its states from the recording, in words.
    `time`, `lane`: when that is, in seconds, and in which machine.
    `open_loop`: the time in seconds from which recorded readings no longer answer what is commanded.
    `seconds`: how long the run is.
    `recorded`, `now`: the states that were entered.
    `coverage`: what was reached of the program, as plain data.
    `issues`: how many issues the program has at the end.
    `problem`: why there is no verdict; empty if there is.
    `ended`: why it did not come to its end; empty if it did.
    """

    found: tuple[PartVerdict, ...] = ()
    difference: str = ""
    time: float = 0.0
    lane: str = ""
    open_loop: float | None = None
    seconds: float = 0.0
    recorded: tuple[StateEntered, ...] = ()
    now: tuple[StateEntered, ...] = ()
    coverage: Mapping[str, Sequence[str]] = dict.fromkeys(REACHED, ())
    issues: int = 0
    problem: str = ""
    ended: Ended = ""

    @property
    def passed(self) -> bool:
        """Whether everything that is expected holds."""
        return not self.problem and all(each.passed for each in self.found)

    @property
    def reason(self) -> str:
        """Why it did not pass; empty if it did."""
        return self.problem or next((each.reason for each in self.found if not each.passed), "")

    @classmethod
    def from_dict(cls, data: Any) -> RunOutcome:
        """Return the outcome that plain data describes. Raises ValueError: it describes none."""
        try:
            return cls(
                tuple(
                    PartVerdict(text_in(part), one_of(passed, (True, False)), text_in(reason), _maybe(time))
                    for part, passed, reason, time in data["found"]
                ),
                text_in(data["difference"]),
                number_in(data["time"]),
                text_in(data["lane"]),
                _maybe(data["open_loop"]),
                number_in(data["seconds"]),
                tuple(map(_entered_in, data["recorded"])),
                tuple(map(_entered_in, data["now"])),
                {kind: tuple(map(text_in, data["coverage"][kind])) for kind in REACHED},
                number_in(data["issues"], int),
                text_in(data["problem"]),
                one_of(data["ended"], get_args(Ended)),
            )
        except (TypeError, LookupError, AttributeError) as error:
            raise ValueError("This is not the outcome of a run.") from error


def _maybe(time: Any) -> float | None:
    return None if time is None else number_in(time)


def _entered_in(data: Any) -> StateEntered:
    time, lane, state = data
    return StateEntered(number_in(time), text_in(lane), None if state is None else text_in(state))
