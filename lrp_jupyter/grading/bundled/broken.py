"""Six broken robots: each fails for another reason, which one has to ask for."""

from __future__ import annotations

from lrp_jupyter.grading.bundled.starters import starter
from lrp_jupyter.grading.challenge import Challenge
from lrp_jupyter.grading.criteria import Criterion, Found, backs_off_at_bumps, bumps, drives, enters
from lrp_jupyter.grading.run_record import RunRecord
from lrp_jupyter.grading.variation import moves
from lrp_jupyter.language.checks.uses import uses_of

__all__ = ["BROKEN_ROBOTS"]


def _enters_at(state: str, seconds: float, slack: float = 0.25) -> Criterion:
    """Require that a state is entered first at this time."""

    def judge(run: RunRecord) -> Found:
        found = run.entered(state)
        if found is None:
            return Found(run.seconds <= seconds + slack, "not entered yet")
        is_then = abs(found.time - seconds) <= slack
        return Found(is_then, f"entered after {found.time:.1f} s")

    return Criterion(f"enters `{state}` after {seconds:g} s", judge, "always", needs_motion=False)


def _enters_with(state: str, name: str, number: float) -> Criterion:
    """Require that a variable had this number, to within 1, when a state was entered first."""

    def judge(run: RunRecord) -> Found:
        entered = run.entered(state)
        before = run.last(lambda sample: entered is not None and sample.time < entered.time)
        if before is None:
            return Found(0, "entered at once" if entered else "never entered")
        value = dict(before.numbers).get(name)
        told = "not a number" if value is None else f"{value:g}"
        return Found(value is not None and abs(value - number) < 1, f"`{name}` was {told}")

    return Criterion(f"enters `{state}` when `{name}` is {number:g}", judge, needs_motion=False)


def _never_enters(state: str) -> Criterion:
    def judge(run: RunRecord) -> Found:
        found = run.entered(state)
        return Found(found is None, f"entered after {found.time:.1f} s" if found else "never entered")

    return Criterion(f"never enters `{state}`", judge, "always", needs_motion=False)


def _only_by(transition: str, name: str) -> Criterion:
    """Require that no other transition leads where this one does, and that it still asks for a name."""

    def judge(run: RunRecord) -> Found:
        machines = [machine for program in run.programs[-1:] for _, machine in program.walk()]
        transitions = [each for machine in machines for each in machine.transitions]
        own = next((each for each in transitions if each.name == transition), None)
        if own is None:
            return Found(0, f"there is no transition `{transition}`")
        if sum(each.destination == own.destination for each in transitions) > 1:
            return Found(0, f"another transition leads to `{own.destination}`, too")
        events = {str(event.name): event.condition.text for machine in machines for event in machine.events}
        root, _, member = name.partition(".")
        uses = uses_of(root, events.get(own.trigger.text) or own.trigger.text)
        depends = any(member in ("", *use.names[:1]) for use in uses)
        return Found(depends, f"it {'depends' if depends else 'does not depend'} on `{name}`")

    return Criterion(f"gets on by `{transition}` only, which depends on `{name}`", judge, needs_motion=False)


def _ask(transition: str) -> str:
    return (
        f"Ask before you edit: right-click the transition `{transition}` in the State graph, and choose **Why"
        " not?**. Then repair what the answer names."
    )


_ASK_THE_ROBOT = (
    "Ask before you edit: choose **Why does the robot do this?** in the menu of the World, when it stands."
)


def _robot(number: int, task: str, hint: str, *criteria: Criterion) -> Challenge:
    name = f"robot {number}"
    return Challenge(
        name,
        task,
        ("boxes",),
        criteria,
        10,
        (lambda _: hint,),
        seeds=3,
        vary=moves("box", x=0.25),
        starter=starter(name),
    )


BROKEN_ROBOTS = (
    _robot(
        1,
        "It bumps into a box. Then it should back off: ask `tback`.",
        _ask("tback"),
        enters("driving", "backing"),
        _only_by("tback", "robot.bumper"),
        bumps(1),
        backs_off_at_bumps(0.3),
    ),
    _robot(
        2,
        "It should sleep after a second: ask `tsleep`.",
        _ask("tsleep"),
        enters("awake", "asleep"),
        _enters_at("asleep", 1),
    ),
    _robot(
        3,
        "At level 2 it should sound the alarm: ask `talarm`.",
        _ask("talarm"),
        enters("sinking", "alarm"),
        _only_by("talarm", "level"),
        _enters_with("alarm", "level", 2),
        _never_enters("saving"),
    ),
    _robot(
        4,
        "Its search should swing to the right: ask `tright`.",
        _ask("tright"),
        enters("moving", "search/looking/sweep/left", "search/looking/sweep/right"),
    ),
    _robot(
        5,
        "It should drive: ask the robot.",
        _ASK_THE_ROBOT,
        drives(0.3),
    ),
    _robot(
        6,
        "It should be done after three laps: ask `tdone`.",
        _ask("tdone"),
        enters("counting", "done"),
        _only_by("tdone", "laps"),
        _enters_with("done", "laps", 3),
    ),
)
