"""Tasks: what a robot is asked for, for how long, and what has become of it."""

from __future__ import annotations

from threading import Event, Thread
from threading import enumerate as enumerate_threads

import numpy as np
import pytest
from support.robots import Clockwork, Courier
from support.waiting import until

from lrp_jupyter.bridges import tasks
from lrp_jupyter.bridges.bridge import Task
from lrp_jupyter.bridges.members import MemberError
from lrp_jupyter.errors import BridgeError
from lrp_jupyter.live.recording import read_recording
from lrp_jupyter.live.reproduction import reproduce
from lrp_jupyter.live.session import Session

GOING = """
(var place := [1])
(machine courier
  (state going (running [robot.go(place)]))
  (state there (running [robot.go(place)]))
  (state lost)
  (on [robot.go.succeeded] going -> there)
  (on [robot.go.failed] going -> lost)
  (on [robot.go.succeeded] there -> going))
(spawn courier going)
"""


def session_of(text: str, bot: Courier, **options: object) -> Session:
    return Session(text, bridge=bot, **options)  # type: ignore[arg-type]


def active(session: Session) -> str:
    return session.frame.active[0][-1]


# -- for how long ---------------------------------------------------------------------------------


def test_how_long_it_lasts_can_be_tested_before_it_is_asked_for():
    bot = Courier()
    text = GOING.replace("robot.go.succeeded", "robot.go.since > 0.3")
    session = session_of(text, bot)
    session.run(0.3)
    assert active(session) == "going"
    session.run(0.2)
    assert active(session) == "there"
    assert session.issues == ()


def test_asked_for_in_every_tick_it_is_one_task_until_the_state_is_left_and_then_another_one():
    bot = Courier()
    session = session_of(GOING, bot)
    session.run(0.5)
    first = bot.next()
    assert bot.log == ["go 1"]
    first.update(feedback=0.5)
    first.update(reason="It is slow.")  # says nothing new of the feedback
    session.run(0.1)
    go = bot.robot.go
    assert (go.status, go.active, go.feedback, go.result) == ("active", True, 0.5, None)
    assert go.reason == "It is slow."
    assert go.since == pytest.approx(0.5)
    with pytest.raises(MemberError, match=r"has no `cancel`; .*\. It is cancelled when the state is left"):
        go.cancel()
    with pytest.raises(MemberError, match="has no `start`"):  # nothing begins a task but a call
        go.start()
    first.update("succeeded", result="done")
    session.run(0.1)
    # the outcome was forgotten before the next state was tested, and the same words ask for another task
    assert active(session) == "there"
    second = bot.next()
    assert bot.robot.go.status == "active"
    first.update("aborted")  # a late and a double answer
    first.update("succeeded")
    session.run(0.5)
    assert (active(session), bot.robot.go.status) == ("there", "active")
    assert not first.is_wanted
    assert second.is_wanted
    assert bot.log == ["go 1", "go 1"]


def test_of_several_reports_in_a_tick_the_newest_feedback_and_the_newest_result_count():
    bot = Courier()
    session = session_of(GOING, bot)
    session.run(0.1)
    task = bot.next()
    task.update(feedback=1)
    task.update(feedback=2, result="half")
    task.update(reason="It goes round a table.")
    session.run(0.1)
    go = bot.robot.go
    assert (go.status, go.feedback, go.result, go.reason) == ("active", 2, "half", "It goes round a table.")


def test_another_goal_replaces_the_one_under_way():
    bot = Courier()
    session = session_of(GOING, bot)
    session.run(0.1)
    first = bot.next()
    session.set_variable("place", 2)  # as a number that is dragged does
    session.run(0.1)
    bot.next()
    first.update("succeeded")
    session.run(0.2)
    assert (active(session), bot.robot.go.status) == ("going", "active")
    assert bot.log == ["go 1", "cancel go 1", "go 2"]


PLACES = ("[1, [2]]", "np.array([1, 2])", "{0: {2}}")


@pytest.mark.parametrize("place", [*PLACES, "float('nan')"])
def test_equal_values_are_one_task(place):
    bot = Courier()
    text = f"(machine m (state s (running [robot.go({place})]))) (spawn m s)"
    session = session_of(text, bot, namespace={"np": np})
    session.run(0.3)
    assert bot.next().is_wanted
    assert len(bot.log) == 1
    assert not session.issues


@pytest.mark.parametrize("place", PLACES)
def test_a_value_that_is_changed_in_place_is_another_goal(place):
    bot = Courier()
    text = f"(var place := [{place}]) (machine m (state s (running [robot.go(place)]))) (spawn m s)"
    session = session_of(text, bot, namespace={"np": np})
    session.run(0.1)
    bot.next()
    value = session.interpreter.variables["place"]
    before = str(value)
    value[0] = 7
    session.run(0.1)
    bot.next()
    assert bot.log == [f"go {before}", f"cancel go {before}", f"go {value}"]
    assert not session.issues


def test_a_cancel_may_wait_for_the_thread_that_tells_how_it_went():
    class Waits(Courier, offered=False):
        def cancel(self, task: Task) -> None:
            super().cancel(task)
            library = Thread(target=task.update, args=("cancelled",), daemon=True)
            library.start()
            library.join(60)
            assert not library.is_alive()

    bot = Waits()
    session = session_of(GOING, bot)
    session.run(0.1)
    bot.next()
    session.set_variable("place", 2)
    session.run(0.1)
    bot.next()
    assert bot.log == ["go 1", "cancel go 1", "go 2"]
    assert not [notice for notice in bot.safety.notices if notice.kind == "fault"]


def test_a_bridge_may_replace_a_goal_itself_so_that_the_robot_goes_on():
    bot = Courier()
    session = session_of(GOING.replace("robot.go(", "robot.lap("), bot)
    session.run(0.1)
    bot.next()
    session.set_variable("place", 2)
    session.run(0.1)
    bot.next()
    assert bot.log == ["lap 1", "lap 2", "cancel lap 1"]


def test_what_a_goal_would_have_replaced_ends_with_it_if_it_is_cancelled_before_it_began():
    bot = Courier()
    bot.open()
    bot.robot.lap(1)
    bot.next()
    with bot.requested._changing:  # its thread does not begin it
        bot.robot.lap(2)
        bot.requested.drop()
    assert bot.log == ["lap 1", "cancel lap 1"]


def test_it_ends_when_running_no_longer_asks_for_it():
    bot = Courier()
    session = session_of(
        "(var on := [True]) (machine m (state s (running [if on: robot.go(1)]))) (spawn m s)", bot
    )
    session.run(0.1)
    bot.next()
    session.set_variable("on", False)
    session.run(0.2)
    assert bot.log == ["go 1", "cancel go 1"]
    assert (bot.robot.go.status, bot.robot.go.reason) == ("cancelled", "It is no longer asked for.")
    session.set_variable("on", True)
    session.run(0.1)
    bot.next()
    assert bot.robot.go.status == "active"


def test_an_edit_that_removes_the_line_ends_it_and_so_does_one_that_restarts():
    for policy in ("keep", "restart"):
        bot = Courier()
        session = session_of(GOING, bot, on_active_edit=policy)
        session.run(0.1)
        bot.next()
        session.edit(GOING.replace("going (running [robot.go(place)])", "going (running [pass])"))
        session.run(0.2)
        assert bot.log[:2] == ["go 1", "cancel go 1"], policy
        assert bot.robot.go.status == ("cancelled" if policy == "keep" else None)


def test_asked_for_at_the_entry_or_on_the_way_it_lives_until_the_state_is_left():
    bot = Courier()
    text = """
    (var leave := [0])
    (machine outer
      (state a) (state b (onentry [robot.lap(2)])) (state c)
      (on [leave == 1] a -> b (effect [robot.go(1)]))
      (on [leave == 2] b -> b (effect [robot.go(1)]))
      (on [leave == 3] b -> c))
    (spawn outer a)
    """
    session = session_of(text, bot)
    session.run(0.1)
    session.set_variable("leave", 1)
    session.run(0.5)
    asked = bot.next(), bot.next()
    assert sorted(bot.log) == ["go 1", "lap 2"]
    for task in asked:
        task.update("succeeded")
    session.run(0.1)
    assert (bot.robot.go.succeeded, bot.robot.lap.succeeded) == (True, True)
    session.set_variable("leave", 2)  # the same words, for another visit
    session.run(0.1)
    _ = bot.next(), bot.next()
    session.set_variable("leave", 0)
    session.run(0.3)
    assert (bot.robot.go.status, bot.robot.lap.status) == ("active", "active")
    session.set_variable("leave", 3)
    session.run(0.1)
    assert sorted(bot.log) == ["cancel go 1", "cancel lap 2", "go 1", "go 1", "lap 2", "lap 2"]
    assert (bot.robot.go.status, bot.robot.lap.status) == (None, None)


def test_asked_for_on_the_way_out_of_a_machine_it_belongs_to_the_state_that_is_entered():
    bot = Courier()
    text = """
    (var leave := [0])
    (machine outer
      (state a (onentry (spawn inner x)) (running [robot.lap(0)])
        (machine inner (state x) (exit [leave == 1] x -> b (effect [robot.go(1)]))))
      (state b) (state c)
      (on [leave == 2] b -> c))
    (spawn outer a)
    """
    session = session_of(text, bot)
    session.run(0.1)
    session.set_variable("leave", 1)
    session.run(0.5)
    assert sorted(bot.next().name for _ in range(2)) == ["go", "lap"]
    assert (active(session), bot.robot.go.status, bot.robot.lap.status) == ("b", "active", None)
    session.set_variable("leave", 2)
    session.run(0.1)
    assert (active(session), bot.robot.go.status) == ("c", None)
    assert sorted(bot.log) == ["cancel go 1", "cancel lap 0", "go 1", "lap 0"]


def test_a_request_follows_its_machine_over_renames_and_ends_with_a_forced_state():
    bot = Courier()
    session = session_of(GOING, bot)
    session.run(0.1)
    bot.next()
    session.rename("machine", "courier", "postman")
    session.rename("state", "postman/going", "driving")
    session.run(0.3)
    assert (bot.log, bot.robot.go.status) == (["go 1"], "active")
    session.teleport_to("postman/lost")
    assert (bot.log, bot.robot.go.status) == (["go 1", "cancel go 1"], None)


def test_for_how_long_can_be_compared_before_anything_is_asked_for():
    bot = Courier()
    states = "(state a (running [robot.go(1)])) (state b) (on [robot.go.since > 0.25] a -> b)"
    session = session_of(f"(machine m {states}) (spawn m a)", bot)
    session.run(0.3)
    assert (active(session), session.issues) == ("a", ())
    session.run(0.1)
    assert active(session) == "b"


def test_a_service_is_called_once_and_ends_by_itself():
    bot = Courier()
    session = session_of(
        """
        (machine m (state calling (running [robot.call("lamp")])) (state on (onexit [robot.call("dark")]))
          (on [robot.call.succeeded] calling -> on) (ontime 400 on -> calling))
        (spawn m calling)
        """,
        bot,
    )
    session.run(0.5)
    bot.next().update("succeeded", result="lit")
    session.run(0.4)
    assert active(session) == "on"
    session.run(0.1)
    bot.next(), bot.next()
    assert sorted(bot.log) == ["call dark", "call lamp", "call lamp"]


# -- stops ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("how", ["pause", "stop_robot", "reset", "stop", "close"])
def test_every_stop_cancels_it_at_once_and_what_runs_on_asks_again(how):
    bot = Courier()
    with session_of(GOING, bot) as session:
        session.start()
        first = bot.next()
        getattr(session, how)()
        assert bot.log[:3] == ["go 1", "cancel go 1", "stop"]
        assert not first.is_wanted
        if how in ("pause", "stop_robot"):
            session.resume()
        if how in ("pause", "stop_robot", "reset"):
            assert bot.next() is not first


def test_what_a_stop_ends_before_the_robot_has_heard_of_it_is_ended_again_when_it_has():
    class Slow(Courier, offered=False):
        arrives, asked = Event(), Event()

        def go(self, task: Task, place: object = 0) -> None:
            self.asked.set()
            assert self.arrives.wait(60)
            super().go(task, place)

    bot = Slow()
    session = session_of("(machine m (state s (onentry [robot.go(1)]))) (spawn m s)", bot)
    session.run(0.1)
    assert bot.asked.wait(60)
    session.stop_robot()
    assert bot.log == ["stop"]
    bot.arrives.set()
    bot.next()
    session.run(0.1)
    bot.robot.go(2)
    bot.next()
    assert bot.log == ["stop", "go 1", "cancel go 1", "go 2"]


def test_a_task_of_an_entry_that_a_stop_has_ended_is_not_begun_again_and_that_is_said():
    bot = Courier()
    text = "(machine m (state s (onentry [robot.go(1)])) (state t) (on [robot.go.failed] s -> t)) (spawn m s)"
    session = session_of(text, bot)
    session.run(0.1)
    bot.next()
    session.stop_robot()
    session.run(0.5)
    assert bot.log == ["go 1", "cancel go 1", "stop"]
    assert (bot.robot.go.status, bot.robot.go.reason) == ("cancelled", "The robot was stopped.")
    (notice,) = (each for each in bot.safety.notices if each.kind == "stopped")
    assert notice.text.startswith("`go` ended when the robot was stopped")


class Walker(Courier, offered=False):
    """A courier that also takes velocities."""

    def open_interface(self) -> None:
        super().open_interface()
        self.add_method("move", lambda linear=0.0: self.log.append(f"move {linear}"), "m/s")


def test_a_velocity_that_is_not_commanded_any_more_is_stopped_and_the_task_after_it_goes_on():
    bot = Walker(hardware=True)
    text = """
    (machine m (state a (running [robot.move(0.2)])) (state b (onentry [robot.go(1)])) (ontime 100 a -> b))
    (spawn m a)
    """
    session = session_of(text, bot)
    session.open()
    bot.arm()
    session.run(0.2)
    task = bot.next()
    session.run(1.5)
    assert bot.log == ["move 0.2", "go 1", "stop"]
    assert (bot.robot.go.status, task.is_wanted) == ("active", True)
    assert bot.in_motion, "the guard still stops it if this program dies"
    assert [notice.kind for notice in bot.safety.notices if notice.kind == "command watchdog"]


def test_disarmed_it_is_recorded_and_not_begun_and_disarming_cancels_it():
    bot = Courier(hardware=True)
    session = session_of(GOING, bot)
    with pytest.warns(UserWarning, match="is disarmed"):
        session.run(0.3)
    assert (bot.log, bot.robot.go.status) == ([], None)
    assert [(command.name, command.sent) for command in bot.safety.commands] == [("go", False)]
    bot.arm()
    session.run(0.1)
    bot.next()
    bot.disarm()
    session.run(0.1)
    assert bot.log == ["go 1", "cancel go 1", "stop"]


def test_the_robot_may_move_while_a_task_that_moves_it_goes_on_and_no_longer():
    bot = Courier(hardware=True)
    text = '(machine m (state s (running [robot.call("lamp")] [robot.go(1)]))) (spawn m s)'
    with session_of(text, bot) as session:
        session.open()
        bot.arm()
        session.run(0.1)
        tasks = {task.name: task for task in (bot.next(), bot.next())}
        assert bot.in_motion
        tasks["go"].update("succeeded")
        session.run(0.3)
        assert not bot.in_motion
        assert bot.robot.call.active


def test_of_a_lost_robot_it_is_lost_and_not_an_issue():
    bot = Courier()
    session = session_of(GOING.replace("(on [robot.go.failed] going -> lost)", ""), bot)
    session.run(0.1)
    bot.next()
    bot.set_status("lost", "The line is cut.")
    session.run(0.3)
    go = bot.robot.go
    assert (go.status, go.failed, go.reason) == ("lost", True, "The line is cut.")
    bot.set_status("connected")
    session.run(0.1)
    bot.next()
    assert go.status == "active"
    assert not session.issues


def test_when_data_are_too_old_nothing_begins_that_moves_the_robot():
    bot = Courier()
    session = session_of(
        '(machine m (state s (running [robot.go(1)] [robot.call("lamp")]))) (spawn m s)', bot
    )
    bot.fed.clock = lambda: 10.0
    session.open()
    bot.feed("light.data", 1)
    bot.fed.clock = lambda: 12.0
    session.run(0.2)
    bot.next()
    assert bot.log == ["stop", "call lamp"]
    assert (bot.robot.go.status, bot.robot.call.status) == (None, "active")


# -- who asks, and with what ----------------------------------------------------------------------


def test_what_start_raises_aborts_it_with_the_sentence():
    bot = Courier()
    session = session_of(GOING.replace("[1]", '["nowhere"]'), bot)
    session.open()
    session.run(0.1)
    over = session.run(until=lambda frame: frame.active[0][-1] == "lost", limit=60)
    assert over
    assert not session.issues


def test_what_ends_while_it_begins_has_ended_also_in_a_world_of_the_bridges_own():
    class Refuses(Clockwork, offered=False):
        def start(self, task: Task, *arguments: object) -> None:
            if arguments == (2,):
                raise ValueError("There is no place 2.")
            task.update("rejected", reason="It is busy.")

    text = """
    (machine m
      (state a (running [robot.go(1)])) (state b (running [robot.go(2)])) (state c)
      (on [robot.go.status == "rejected" and robot.go.reason == "It is busy."] a -> b)
      (on [robot.go.status == "aborted" and "There is no place 2." in robot.go.reason] b -> c))
    (spawn m a)
    """
    session = Session(text, bridge=Refuses(go=1.0))
    session.run(0.3)
    assert active(session) == "c"
    assert not session.issues


def test_a_start_that_does_not_return_holds_up_later_requests_for_a_while_and_not_for_ever(monkeypatch):
    class Hangs(Courier, offered=False):
        returns = Event()

        def go(self, task: Task, place: object = 0) -> None:
            super().go(task, place)
            assert place != 1 or self.returns.wait(60)

    def threads() -> int:
        return sum(thread.name == "task go" for thread in enumerate_threads())

    bot = Hangs()
    session = session_of(GOING, bot)
    session.run(0.1)
    bot.next()
    for place in range(2, 30):
        session.set_variable("place", place)
        session.run(0.1)
    until(lambda: threads() == 2)  # only the last one waits
    assert bot.robot.go.active
    monkeypatch.setattr(tasks, "_PATIENCE", 0.0)
    session.set_variable("place", 30)
    session.run(0.1)
    until(lambda: threads() == 1)
    session.run(0.2)
    assert active(session) == "lost"
    assert "aborted at 3 s: The bridge was still beginning the one before it after 0 s." in str(
        session.why("lost")
    )
    bot.returns.set()
    until(lambda: threads() == 0)
    session.reset()
    session.run(0.1)
    bot.next()
    assert [each for each in bot.log if each != "stop"] == ["go 1", "cancel go 1", "go 1"]


def test_a_world_of_the_bridges_own_that_goes_back_goes_on_with_the_tasks_of_then():
    class GoesBack(Clockwork, offered=False):
        def moment(self) -> object:
            return self.time, dict(self._due)

        def rewind(self, moment: object) -> None:
            time, due = moment
            self.time, self._due = time, dict(due)

    text = """
    (machine m
      (state a (onentry [robot.go(1)])) (state b (onentry [robot.go(2)])) (on [robot.go.succeeded] a -> b))
    (spawn m a)
    """
    session = Session(text, bridge=GoesBack(go=1.0))
    session.run(0.5)
    for _ in range(2):
        session.run(0.8)
        assert active(session) == "b"
        session.rewind(8)
        assert active(session) == "a"
    fork = session.fork(at=session.frame.tick)
    assert fork.bridge.robot.go.active


def test_what_a_goal_should_replace_ends_if_that_cannot_be_begun():
    class Refuses(Courier, offered=False):
        def go(self, task: Task, place: object = 0) -> None:
            if place == 2:
                raise BridgeError("There is no place 2.")
            super().go(task, place)

    bot = Refuses()
    session = session_of(GOING.replace("robot.go(", "robot.lap("), bot)
    session.run(0.1)
    first = bot.next()
    session.set_variable("place", 2)
    session.run(0.1)
    session.run(until=lambda _: bot.robot.lap.failed, seconds=60)
    assert bot.log == ["lap 1", "cancel lap 1"]
    assert bot.robot.lap.reason == "There is no place 2."
    assert not first.is_wanted


def test_two_machines_cannot_have_one_task_at_the_same_time():
    bot = Courier()
    session = session_of(
        """
        (machine one (state s (running [robot.go(1)])))
        (machine two (state s (running [robot.go(2)])))
        (spawn one s) (spawn two s)
        """,
        bot,
    )
    session.run(0.3)
    bot.next()
    (issue,) = session.issues
    assert issue.message.endswith("`robot.go` is under way for `one`, which asked for it first.")
    assert (issue.line, bot.log) == (3, ["go 1"])


def test_a_machine_sees_what_has_become_of_its_task_before_another_one_asks_for_the_same():
    bot = Courier()
    text = """
    (machine eager (state waiting) (state going (running [robot.go(2)])) (ontime 300 waiting -> going))
    (machine first
      (state going (running [robot.go(1)])) (state there) (on [robot.go.succeeded] going -> there))
    (spawn eager waiting) (spawn first going)
    """
    session = session_of(text, bot)
    session.run(0.5)
    bot.next().update("succeeded")
    session.run(0.1)
    assert session.frame.is_active("there")
    session.run(0.1)
    bot.next()
    assert bot.log == ["go 1", "go 2"]
    (issue,) = session.issues
    assert issue.message == "`robot.go` has ended in this tick for `first`, which asked for it first."


def test_a_test_or_an_initial_value_cannot_ask():
    for text in (
        "(machine m (state s) (on [robot.go(1)] s -> s)) (spawn m s)",
        "(var x := [robot.go(1)]) (machine m (state s)) (spawn m s)",
    ):
        session = session_of(text, Courier())
        session.run(0.1)
        (issue,) = session.issues
        assert issue.message.endswith("A task is asked for in an action, not in a test or an initial value.")


def test_by_hand_it_lives_until_it_ends_or_the_robot_is_stopped():
    bot = Courier()
    session = session_of("(machine m (state s) (state t) (ontime 100 s -> t)) (spawn m s)", bot)
    session.open()
    bot.robot.go(5)
    task = bot.next()
    session.run(1.0)
    assert bot.robot.go.active
    bot.robot.go(5)  # the same again
    bot.stop_all()
    session.run(0.1)
    assert bot.log == ["go 5", "cancel go 5", "stop"]
    bot.robot.go(6)
    bot.next().update("succeeded")
    task.update("aborted")
    session.run(0.1)
    assert bot.robot.go.succeeded


def test_what_a_stop_has_ended_is_asked_for_again_at_once_also_with_the_same_words():
    bot = Courier()
    session = session_of("(machine m (state s)) (spawn m s)", bot)
    session.run(0.1)
    bot.robot.go(1)
    bot.next()
    bot.robot.stop()
    bot.robot.go(1)
    task = bot.next()
    session.run(0.1)
    assert bot.log == ["go 1", "cancel go 1", "stop", "go 1"]
    assert bot.robot.go.active
    assert task.is_wanted


def test_what_has_become_of_it_by_hand_is_no_outcome_for_the_state_that_is_entered():
    bot = Courier()
    text = """
    (machine m
      (state a) (state b (running [robot.go(2)])) (state c)
      (on [robot.go.succeeded] b -> c))
    (spawn m a)
    """
    session = session_of(text, bot)
    session.run(0.1)
    bot.robot.go(1)
    bot.next().update("succeeded")
    session.run(0.2)
    assert bot.robot.go.succeeded
    session.transition_to("b")
    session.run(0.2)
    assert (active(session), bot.robot.go.status, bot.log) == ("b", "active", ["go 1", "go 2"])


def test_a_view_as_plain_data_has_the_status_and_what_can_be_read():
    bot = Courier()
    bot.open()
    bot.robot.go(1)
    described = bot.describe("go").as_dict()
    assert (described["kind"], described["value"]) == ("task", "active")
    assert [each["name"] for each in described["fields"]][:2] == ["go.status", "go.active"]


def test_a_wrong_use_says_what_there_is():
    bot = Courier()
    bot.open()
    go = bot.robot.go
    with pytest.raises(BridgeError, match=r"^`robot\.go` has no `statsu`; .* Did you mean `status`\?$"):
        _ = go.statsu
    with pytest.raises(BridgeError, match=r"^`robot\.go\.status` is read from the robot"):
        go.status = None
    with pytest.raises(BridgeError, match=r"^`robot\.go` is a task, not a value\. Its outcome is "):
        _ = go > 1
    with pytest.raises(BridgeError, match=r"^`robot\.go\(place=0\)`: "):
        go(plac=1)
    with pytest.raises(ValueError, match=r"^A task has no status 'succeded'\. Did you mean `succeeded`\?$"):
        go(1), bot.next().update("succeded")  # type: ignore[arg-type]


# -- the past -------------------------------------------------------------------------------------


def driven(path: str, bot: Courier) -> Session:
    """Run a session in which a task succeeds, one is replaced, one is stopped, and one aborted; record it."""
    session = session_of(GOING, bot)
    with session.record(path):
        session.run(0.3)
        task = bot.next()
        task.update(feedback=1.5)
        session.run(0.2)
        task.update("succeeded", result=(1, "done"))
        session.run(0.3)
        bot.next()
        session.set_variable("place", 2)
        session.run(0.2)
        bot.next()
        session.stop_robot()
        session.run(0.2)
        bot.next().update("succeeded")
        session.run(0.3)
        bot.next().update("aborted", reason="no path")
        session.run(0.5)
    assert active(session) == "lost"
    return session


def test_a_recorded_run_with_tasks_is_repeated_and_acts_on_no_robot(tmp_path):
    path, bot = str(tmp_path / "run.lrplog"), Courier()
    driven(path, bot)
    log = list(bot.log)
    replay = reproduce(read_recording(path))
    assert replay.difference is None
    assert replay.session.frame.active == (("courier", "lost"),)
    assert bot.log == log


def test_a_fork_continues_from_any_tick_with_what_was_known_then(tmp_path):
    bot = Courier()
    session = driven(str(tmp_path / "run.lrplog"), bot)
    log = list(bot.log)
    for tick in range(1, session.frame.tick + 1):
        then, fork = session.at(tick), session.fork(at=tick)
        assert (fork.frame.active, fork.frame.readings.get("go")) == (then.active, then.readings.get("go"))
        before = fork.bridge.requested.moment.requests["go"].state if then.active[0][-1] != "lost" else None
        fork.run(0.3)
        fork.rewind(fork.frame.tick - tick)
        asked = fork.bridge.requested.moment.requests.get("go")
        assert (fork.frame.active, asked and asked.state) == (then.active, before)
    assert bot.log == log
