"""The challenge of an open program: criteria of the present run, checks, hints, runs that are shown."""

import asyncio
import threading
from dataclasses import replace

import pytest

from lrp_jupyter.errors import LRPError
from lrp_jupyter.grading.challenges import Challenge, challenge
from lrp_jupyter.grading.criteria import drives, ends_in, never_restarts, no_faults
from lrp_jupyter.grading.grade import grade
from lrp_jupyter.live.session import Session
from lrp_jupyter.sim.world import BoxZone, RobotSpec, World
from lrp_jupyter.widgets.lab import Lab
from lrp_jupyter.widgets.views.goal import Goal
from lrp_jupyter.widgets.views.shown_moment import Looking

DRIVE = "(machine m (state driving (running [robot.move(linear=0.2)]))) (spawn m driving)"
STOP = """
(machine m
  (state driving (running [robot.move(linear=0.2)]))
  (state stopped)
  (ontime 5000 driving -> stopped)
)
(spawn m driving)
"""


def room(name, start):
    return World(
        name=name, size=(4, 2), robots=(RobotSpec((start, 1, 0)),), zones={"goal": BoxZone((2, 1, 1, 1))}
    )


STAY = Challenge(
    "stay",
    "Stop in the goal.",
    (room("near", 1), room("far", 0.2)),
    (drives(0.9), ends_in("goal"), no_faults()),
    8,
    hold=0,
)


class Watched(Goal):
    """A goal whose session runs in virtual time, and whose check can be waited for."""

    def __init__(self, task, text=DRIVE, namespace=None):
        super().__init__(task)
        self.text = text
        self.session = Session(text, "sim", world=task.worlds[0], rate=task.rate, namespace=namespace)
        self.ended = threading.Event()
        self.attach(self.session, self._woken)

    def _woken(self):
        check = self.view(self.session, self.text)["check"]
        if check is not None and not check["busy"]:
            self.ended.set()

    @property
    def shown(self):
        return self.view(self.session, self.text)

    @property
    def states(self):
        return [each["state"] for each in self.criteria()]

    def checked(self, text=None):
        self.text = self.text if text is None else text
        self.ended.clear()
        self.check(self.session, self.text)
        assert self.ended.wait(60)
        return {**self.shown["check"], "attempts": [each for _, each in sorted(self.attempts().items())]}


@pytest.fixture
def stay():
    goal = Watched(STAY, STOP)
    yield goal
    goal.close()
    goal.session.close()


def test_what_the_criteria_say_of_the_present_run_follows_it(stay):
    assert stay.states == ["open"] * 3
    stay.session.run(2)
    assert stay.states == ["open", "open", "so far"]
    assert next(each["reason"] for each in stay.criteria()).startswith("it drove 0.")
    stay.session.run(3.5)
    assert stay.states == ["met", "met", "met"]
    assert stay.shown["over"]


def test_a_run_is_judged_from_the_beginning_when_the_robot_starts_over(stay):
    stay.session.run(5.5)
    assert stay.shown["over"]
    stay.start_over(stay.session, 1)
    stay.session.pause()
    stay.session.run(1)
    assert stay.states == ["open", "open", "so far"]
    assert (stay.shown["world"], stay.session.bridge.world.name) == (1, "far")


@pytest.fixture
def unbroken():
    goal = Watched(replace(STAY, criteria=(drives(9), never_restarts())))
    yield goal
    goal.close()
    goal.session.close()


def test_starting_over_is_no_restart_of_the_run_that_begins(unbroken, monkeypatch):
    session, call = unbroken.session, unbroken.session.call

    def call_and_let_it_run(job):
        call(job)
        ticked = threading.Event()
        session.on_tick(ticked.set)
        assert session.status == "paused" or ticked.wait(120)

    session.start()
    monkeypatch.setattr(session, "call", call_and_let_it_run)
    unbroken.start_over(session)
    session.pause()
    session.run(0.5)
    assert unbroken.states == ["open", "so far"]


def test_going_back_takes_back_what_was_met(stay):
    stay.session.run(5.5)
    stay.session.rewind(40)
    stay.session.run(0.1)
    assert stay.states == ["open", "open", "so far"]


def test_a_world_that_is_not_the_challenges_is_told(stay):
    assert stay.shown["note"] == ""
    stay.session.call(lambda: stay.session.bridge.load_world("line"))
    assert "Start over" in stay.shown["note"]


def test_a_check_makes_all_runs_beside_the_program(stay):
    check = stay.checked()
    assert (check["done"], check["total"], check["passed"]) == (2, 2, False)
    near, far = check["attempts"]
    assert near["passed"]
    assert (far["failed"], far["world"], far["shows"]) == ("ends in `goal`", 1, True)
    assert 5 < check["points"] < 10
    assert stay.session.frame.tick == 0


def test_a_check_is_stale_as_soon_as_the_text_is_another(stay):
    assert not stay.checked()["stale"]
    stay.text += "\n; later"
    assert stay.shown["check"]["stale"]


def test_a_run_of_the_check_is_repeated_in_the_lab_as_it_was():
    goal = Watched(STAY, STOP)
    check = goal.checked()
    index = next(index for index, each in enumerate(check["attempts"]) if not each["passed"])
    goal.show(goal.session, Looking(), index)
    sentence = check["attempts"][index]["failed"]
    shown = next(each for each in goal.criteria() if each["sentence"] == sentence)
    assert shown == {
        "sentence": sentence,
        "state": "failed",
        "reason": check["attempts"][index]["reason"],
    }
    assert goal.session.bridge.world.name == STAY.worlds[check["attempts"][index]["world"]].name
    (time, x, y, state) = goal.shown["trail"][-1]
    assert (x, y) == pytest.approx((1.2, 1), abs=0.1)
    assert state == "m/stopped"
    assert time == pytest.approx(goal.session.frame.time, abs=0.2)
    assert goal.shown["begun"] == 1
    goal.session.close()


@pytest.mark.slow
def test_a_run_that_was_broken_is_shown_at_that_moment():
    goal = Watched(challenge("edge guard"))
    goal.checked()
    looking = Looking()
    goal.show(goal.session, looking, 0)
    seen = looking.shown(goal.session).looking
    assert seen is not None
    assert abs(seen["time"] - goal.session.frame.time) < 0.3
    goal.session.close()


def test_a_run_of_another_text_is_not_shown(stay):
    stay.checked()
    stay.session.edit(DRIVE)
    with pytest.raises(LRPError, match="Check again"):
        stay.show(stay.session, Looking(), 0)


@pytest.mark.slow
def test_hints_come_one_at_a_time_and_only_when_they_are_asked_for():
    goal = Watched(replace(challenge("stop at the line"), seeds=1))
    with pytest.raises(LRPError, match="Press Check first"):
        goal.hint()
    goal.checked()
    assert goal.shown["hints"] == []
    for number in range(goal.shown["more_hints"]):
        goal.hint()
        assert len(goal.shown["hints"]) == number + 1
    with pytest.raises(LRPError, match="no more hints"):
        goal.hint()
    goal.session.close()


def test_a_check_knows_the_names_of_the_notebook():
    goal = Watched(STAY, DRIVE.replace("0.2", "speed()"), {"speed": lambda: 0.2})
    assert goal.checked()["attempts"][0]["passed"]
    goal.session.close()


def test_a_check_that_cannot_be_made_says_why():
    goal = Watched(STAY, DRIVE.replace("0.2", "lock and 0.2"), {"lock": threading.Lock()})
    assert "uses `lock`, which cannot be sent" in goal.checked()["error"]
    goal.session.close()


def test_a_program_that_hangs_is_checked_and_the_lab_goes_on(stay):
    stay.check(
        stay.session,
        DRIVE.replace("robot.move", "import threading; threading.Event().wait(1000); robot.move"),
    )
    stay.session.run(1)
    assert stay.session.frame.tick == 10
    assert stay.shown["check"]["busy"]


@pytest.mark.slow
def test_a_check_about_edits_replaces_the_program_that_the_challenge_begins_with():
    task = challenge("half the speed")
    goal = Watched(task, task.beginning)
    assert not goal.checked()["passed"]
    assert "[0.3]" in task.beginning
    assert goal.checked(task.beginning.replace("[0.3]", "[0.15]"))["passed"]
    goal.session.close()


def test_a_lab_is_graded_as_its_panel_checks_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = DRIVE.replace("0.2", "speed()")
    lab = Lab(text, challenge=STAY, name="graded", namespace={"speed": lambda: 0.2})
    try:
        result = grade(lab, STAY)
        assert [attempt.ended for attempt in result.attempts] == ["", ""]
        assert result.passed
        assert lab._connection.goal.task is STAY
    finally:
        lab.close()


def test_a_lab_for_a_challenge_begins_with_its_text(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    lab = Lab(challenge="square", namespace={})
    try:
        assert lab.text == challenge("square").beginning
        assert lab.session.name == "square"
    finally:
        lab.close()


def test_the_commands_of_a_page_reach_the_goal(bench):
    lab = bench(STOP, bridge="sim", world=STAY.worlds[0])
    page = lab.page()
    assert "is not written for a challenge" in page.do("check")
    lab.connection.goal = Goal(STAY)
    assert page.do("start_over", world=1) is None
    assert lab.session.bridge.world.name == "far"
    assert page.do("start_over", world=-1) is None
    assert lab.session.bridge.world.name == "far"
    assert page.do("hint").startswith("Press Check first")
    assert page.do("show_attempt", index=0).startswith("This run is no longer known")
    assert page.merged("goal")["name"] == "stay"


def test_in_a_browser_a_check_which_may_not_return_waits_until_the_text_is_stored():
    async def checked():
        stored, goal = asyncio.Event(), Goal(STAY)
        with Session(STOP, "sim", world=STAY.worlds[0], rate=STAY.rate, driver="asyncio") as session:
            goal.attach(session, lambda: None)
            goal.stored = stored.wait
            goal.check(session, STOP)
            for _ in range(20):
                await asyncio.sleep(0)
            waiting = goal.view(session, STOP)["check"]
            stored.set()
            await goal._task
            return waiting["done"], goal.view(session, STOP)["check"]["done"]

    assert asyncio.run(checked()) == (0, 2)
