"""What a view is told, when, and how much: with a page that is a list of messages."""

import json
import struct
from collections import deque
from contextvars import ContextVar
from itertools import chain, cycle, repeat
from pathlib import Path
from threading import Event, current_thread, main_thread

import pytest
from support.robots import Bare, Courier

from lrp_jupyter.live.running.commands import Call
from lrp_jupyter.live.session import Session
from lrp_jupyter.sim import Say
from lrp_jupyter.sim.world import FloorSpec, PathStroke, RobotSpec
from lrp_jupyter.widgets.connection import PageConnection
from lrp_jupyter.widgets.text.saver import Saver
from lrp_jupyter.widgets.text.texts import Texts

BLINK = """
(var count := [0])
(machine m
  (event often [count % 2 == 1])
  (state off (onentry [count = count + 1]))
  (state on (onentry [count = count + 1]))
  (on often off -> on up)
  (ontime 0 on -> off down))
(spawn m off)
"""
CALM = "(var count := [0]) (machine m (state a (running [count = count + 1]))) (spawn m a)"
MOVER = "(machine m (state a (running [robot.move(linear=0.2)]))) (spawn m a)"


def test_a_view_that_says_hello_gets_everything_once(bench):
    lab = bench(BLINK, name="blink")
    page = lab.page()
    (snapshot,) = page.messages
    assert snapshot["type"] == "snapshot"
    assert snapshot["name"] == "blink"
    assert snapshot["text"] == snapshot["running"] == BLINK
    assert [machine["path"] for machine in snapshot["frame"]["program"]["machines"]] == ["m"]
    assert snapshot["frame"]["layouts"].keys() == {"m"}
    assert "sim" in snapshot["choices"]["bridges"]
    assert snapshot["frame"]["status"] == "ready"
    json.dumps(snapshot, allow_nan=False)


def test_a_frame_holds_only_what_changed_since_the_last_one_sent(bench):
    lab = bench(BLINK)
    page = lab.page()
    lab.session.step()
    lab.publish()
    frame = page.last("frame")
    assert frame["active"] == frame["lit"] == ["m/off"]
    assert frame["variables"] == {"count": ["1", 1.0]}
    assert frame["events"] == {"m/often": True}
    assert frame["entered"] == {"m/off": [1, 1]}
    lab.session.step()
    lab.publish()
    frame = page.last("frame")
    assert "events" not in frame
    assert frame["fired"] == {"m:up": [1, 2]}
    assert frame["entered"] == {"m/on": [1, 2]}
    assert "status" not in frame
    assert "bridge" not in frame


def test_a_view_gets_thirty_messages_a_second_at_most(bench):
    lab = bench(BLINK)
    page = lab.page()
    lab.publish()
    before = len(page.messages)
    for _ in range(200):
        lab.session.step()
        lab.publish(after=0.005)
    assert 25 <= len(page.messages) - before <= 33


def test_a_view_without_credit_gets_nothing_and_loses_nothing(bench):
    lab = bench(BLINK)
    slow, quick = lab.page("slow", pays=False), lab.page("quick")
    for _ in range(20):
        lab.session.step()
        lab.publish()
    assert len(slow.messages) == 3
    assert len(quick.messages) > 20
    slow.send("credit", frame=slow.last("frame")["frame"])
    lab.publish()
    assert slow.last("frame")["entered"] == quick.latest("entered") | {"m/off": [10, 19]}
    assert slow.last("frame")["tick"] == 20


def test_a_late_view_gets_the_tick_in_which_a_state_was_entered_last(bench):
    lab = bench("(machine m (state a) (state b) (ontime 200 a -> b t))(spawn m a)")
    page = lab.page("graph")
    lab.session.run(seconds=2)
    lab.publish()
    entered = page.last("frame")["entered"]
    assert {name: tick for name, (_, tick) in entered.items()} == {"m/a": 1, "m/b": 3}


def frames_in(lab, page, milliseconds):
    """Publish every 6 ms; return the milliseconds at which the page got a frame."""
    came, before = [], len(page.all("frame"))
    for now in range(6, milliseconds + 1, 6):
        lab.publish(after=0.006)
        came += [now] * (len(page.all("frame")) - before)
        before = len(page.all("frame"))
    return came


def publish_all(lab):
    """Publish until nothing is new; the last frame is a heartbeat."""
    for _ in range(4):
        lab.publish(after=1.0)


def test_what_comes_with_every_tick_keeps_a_distance_of_80_ms(bench):
    lab = bench(CALM)
    page = lab.page()
    lab.session.step()
    publish_all(lab)
    lab.session.step()
    assert frames_in(lab, page, 60) == []
    lab.session.step()
    assert frames_in(lab, page, 60) == [84 - 60]
    assert page.last("frame")["variables"]["count"][0] == "3"
    lab.session.step()
    assert frames_in(lab, page, 240) == [84 - (60 - 24)]
    assert page.last("frame").keys() - {"asks"} == {"type", "view", "frame", "tick", "time", "variables"}


def test_a_condition_that_holds_at_every_other_tick_is_calm_news(bench):
    lab = bench(CALM.replace("(machine m", "(machine m (on [count % 2 == 1] for 9000 a -> a)"))
    page = lab.page()
    lab.session.step()
    publish_all(lab)
    for came in ([], [84 - 60], [84 - (60 - 24)]):
        lab.session.step()
        assert frames_in(lab, page, 60) == came
    assert any("countdowns" in frame for frame in page.all("frame"))


def test_calm_changes_after_a_rest_are_sent_at_once(bench):
    lab = bench(CALM)
    page = lab.page()
    lab.session.step()
    publish_all(lab)
    assert frames_in(lab, page, 120) == []
    lab.session.step()
    assert frames_in(lab, page, 120) == [6]


def test_what_is_urgent_comes_15_ms_after_the_last_frame(bench):
    lab = bench(BLINK)
    page = lab.page()
    lab.session.step()
    publish_all(lab)
    lab.session.step()
    assert frames_in(lab, page, 60) == [18]
    assert page.last("frame")["lit"] == ["m/on"]
    lab.session.step()
    assert frames_in(lab, page, 6) == [6]  # the last one was long enough ago


def test_a_robot_that_drives_is_calm_news(bench):
    lab = bench(MOVER, bridge="sim")
    page = lab.page()
    lab.session.run(1)
    came = []

    def look():
        lab.session.submit(Call(lambda: None))  # a frame of this tick
        before = len(page.buffers)
        lab.publish(after=1 / 32)
        came.append([buffer is not None for buffer in page.buffers[before:]])

    lab.session.run(1.1, after_tick=look)
    assert came[2:] == [[], [], [True]] * 3, "after it was told that the program runs"


def test_what_is_dragged_while_paused_is_urgent(bench):
    lab = bench(MOVER, bridge="sim")
    page = lab.page()
    lab.session.step()
    assert lab.session.status == "paused"
    publish_all(lab)
    for x in (1.0, 1.25):
        page.send("command", id=0, do="drag_robot", index=0, pose=[x, 0.5, 0.0])
        assert frames_in(lab, page, 18) == [18]
        assert struct.unpack_from("<dff", page.buffers[-1][0])[1:] == (x, 0.5)


def test_what_is_urgent_for_one_view_stays_calm_for_another(bench):
    lab = bench(CALM, bridge="sim")
    graph, world = lab.page("graph", part="graph"), lab.page("world", part="world")
    lab.session.step()
    publish_all(lab)
    before = len(graph.messages)
    lab.session.step()
    world.send("command", id=0, do="drag_robot", index=0, pose=[1.0, 0.5, 0.0])
    assert frames_in(lab, world, 60) == [18]
    assert len(graph.messages) == before
    assert frames_in(lab, graph, 60) == [84 - 60]


def test_credit_for_a_later_frame_pays_for_all_before_it(bench):
    lab = bench(BLINK)
    page = lab.page(pays=False)
    for _ in range(4):
        lab.session.step()
        lab.publish()
    snapshot, *frames = page.messages
    assert [snapshot["frame"]["frame"], *(frame["frame"] for frame in frames)] == [1, 2, 3]
    page.send("credit", frame=2)
    lab.session.step()
    lab.publish()
    lab.session.step()
    lab.publish()
    assert [frame["frame"] for frame in page.all("frame")] == [2, 3, 4, 5]
    page.send("credit", frame=1)  # it came late, and pays for nothing more
    lab.session.step()
    lab.publish()
    assert page.last("frame")["frame"] == 5


class Tab:
    """A page behind a link, in virtual time: acknowledges what asks for it, and is busy with each frame."""

    def __init__(self, lab, there, back, busy=0.0):
        self.lab, self.there, self.back, self.busy = lab, there, back, busy
        self.page = lab.page(pays=False)
        self.coming, self.credits = deque(), deque()
        self.seen, self.free, self.paid = 0, 0.0, 0

    def run(self, seconds):
        """Let a program tick all the time; return how late each frame was read after it had arrived."""
        late = []
        for _ in range(int(seconds * 64)):
            self.lab.session.step()
            self.lab.publish(after=1 / 64)
            now = self.lab.wall.now
            frames = self.page.frames()
            for frame in frames[self.seen :]:
                self.coming.append((now + next(self.there), frame))
            self.seen = len(frames)
            while self.coming and now >= max(self.coming[0][0], self.free):
                arrived, frame = self.coming.popleft()
                late.append(now - arrived)
                self.free = now + self.busy
                if frame.get("asks"):
                    self.credits.append((now + self.busy + next(self.back), frame["frame"]))
            while self.credits and now >= self.credits[0][0]:
                self.page.send("credit", frame=self.credits.popleft()[1])
                self.paid += 1
        return late


def test_frames_come_as_often_over_a_slow_link_as_over_a_fast_one(bench):
    counts = []
    for delay in (0.0, 0.075, 0.2):
        tab = Tab(bench(CALM), repeat(delay), repeat(delay))
        tab.run(5)
        counts.append(len(tab.run(6)))
    assert min(counts) >= max(counts) - 1 >= 6 * 10


def test_frames_come_often_over_a_link_whose_delay_varies(bench):
    tab = Tab(bench(CALM), cycle([0.15, 0.16, 0.2]), cycle([0.16, 0.2, 0.15, 0.16]))
    tab.run(5)
    assert len(tab.run(6)) >= 6 * 9


@pytest.mark.parametrize(("busy", "delay"), [(0.15, 0.2), (0.3, 0.0), (1.0, 0.2)])
def test_a_slow_page_shows_no_old_frames_however_long_it_is_slow(bench, busy, delay):
    tab = Tab(bench(CALM), repeat(delay), repeat(delay), busy)
    tab.run(5)
    assert max(tab.run(10)) <= 5 * busy


@pytest.mark.slow
def test_a_page_that_becomes_slow_between_two_frames_gets_the_next_one(bench):
    """A window that becomes smaller than what is in flight holds a frame that asks, or lets one pass."""
    for slow in range(1, 12):
        delays = chain(repeat(0.0, 10 + slow), repeat(0.3))
        tab = Tab(bench(CALM), repeat(0.0), delays)
        tab.run(4)
        assert len(tab.run(6)) >= 6 * 4


def test_a_quick_page_near_by_acknowledges_few_frames_alone(bench):
    tab = Tab(bench(CALM), repeat(0.01), repeat(0.01))
    tab.run(5)
    before = tab.paid
    assert len(tab.run(10)) >= 100
    assert tab.paid - before <= 11


def test_a_quick_page_that_says_something_now_and_then_is_not_asked(bench):
    tab = Tab(bench(CALM), repeat(0.01), repeat(0.01))
    tab.run(5)
    paid = []
    for _ in range(12):
        tab.run(0.75)
        tab.page.send("command", id=0, do="rate", value=10, frame=tab.page.frames()[-1]["frame"])
        paid.append(tab.paid)
    assert paid[0] == paid[-1]


def test_what_a_page_says_acknowledges_frames(bench):
    lab = bench(BLINK)
    page = lab.page(pays=False)
    for _ in range(3):
        for _ in range(2):
            lab.session.step()
            lab.publish()
        page.send("command", id=0, do="rate", value=10, frame=page.frames()[-1]["frame"])
    assert [frame["frame"] for frame in page.frames()] == [1, 2, 3, 4, 5, 6, 7]


@pytest.mark.parametrize("bridge", ["none", "sim"])
def test_where_only_the_time_goes_on_a_frame_comes_four_times_a_second(bench, bridge):
    lab = bench("(machine m (state a)) (spawn m a)", bridge=bridge)
    page = lab.page()
    lab.session.step()
    publish_all(lab)
    came = []
    for _ in range(10):
        lab.session.step()
        came += frames_in(lab, page, 102)
    assert len(came) == 4
    assert page.last("frame").keys() - {"asks"} == {"type", "view", "frame", "tick", "time"}


def test_a_view_without_credit_gets_no_world_either(bench):
    lab = bench(MOVER, bridge="sim", world="boxes")
    slow, quick = lab.page("slow", pays=False), lab.page("quick")
    for x in range(6):
        quick.do("drag_solid", index=0, pose=[1.0 + x / 10, 0.5, 0.0])
    before = len(slow.messages)
    for x in range(6):
        quick.do("drag_solid", index=0, pose=[2.0 + x / 10, 0.5, 0.0])
    assert len(slow.messages) == before
    assert quick.last("world")["world"]["solids"][0]["box"][:2] == [2.5, 0.5]
    slow.send("credit", frame=slow.last("frame")["frame"])
    lab.publish()
    assert slow.last("world") == quick.last("world") | {"view": "slow"}


def test_while_nothing_changes_a_heartbeat_is_sent_once_a_second(bench):
    lab = bench(BLINK)
    page = lab.page()
    lab.publish(after=2.0)
    before = len(page.messages)
    for _ in range(80):
        lab.publish(after=0.0625)
    beats = page.messages[before:]
    assert len(beats) == 5
    assert all(beat.keys() - {"asks"} == {"type", "view", "frame"} for beat in beats)


def test_a_view_that_is_silent_for_long_is_forgotten_and_may_return(bench):
    lab = bench(BLINK)
    gone = lab.page("gone", pays=False)
    for _ in range(40):
        lab.publish(after=1.0)
    assert len(gone.messages) == 3
    gone.send("hello", part="lab")
    assert gone.messages[-1]["type"] == "snapshot"


def test_what_a_forgotten_view_asks_is_done_and_answered_when_it_returns(bench):
    lab = bench(BLINK)
    gone = lab.page("gone", pays=False)
    for _ in range(40):
        lab.publish(after=1.0)
    gone.send("command", do="step", id=7)
    gone.send("save_world", name="a", replace=False, id=8)
    lab.finish()
    assert lab.session.frame.tick == 1
    lab.publish(after=1.0)
    assert not gone.all("reply")
    gone.send("hello", part="lab")
    lab.publish(after=0.1)
    done, saved = sorted(gone.all("reply"), key=lambda reply: reply["id"])
    assert (done["id"], done["error"]) == (7, None)
    assert (saved["id"], saved["error"]) == (8, "`none` has no world that could be changed.")


@pytest.mark.parametrize(("seconds", "frames"), [(14, 4), (16, 3)])
def test_after_15_seconds_of_silence_credit_of_a_view_that_owes_it_comes_too_late(bench, seconds, frames):
    lab = bench(BLINK)
    page = lab.page(pays=False)
    for _ in range(2):
        lab.publish(after=1.0)
    for _ in range(seconds - 2):
        lab.publish(after=1.0)
    page.send("credit", frame=3)
    lab.publish(after=0.9)
    assert len(page.frames()) == frames


def test_a_view_that_returns_credit_late_is_not_forgotten(bench):
    lab = bench(BLINK)
    page = lab.page(pays=False)
    for _ in range(4):
        for _ in range(12):
            lab.publish(after=1.0)
        page.send("credit", frame=page.frames()[-1]["frame"])
    lab.publish(after=1.0)
    assert len(page.frames()) == 4 * 3 + 1


def test_a_view_that_owes_nothing_is_not_forgotten_while_the_machine_sleeps(bench):
    lab = bench(BLINK)
    page = lab.page()
    lab.publish(after=3600.0)
    assert page.all("frame")


def test_a_view_that_says_goodbye_gets_no_more_messages(bench):
    lab = bench(BLINK)
    page = lab.page()
    page.send("bye")
    lab.session.step()
    lab.publish()
    assert len(page.messages) == 1


def test_credit_of_a_view_shows_that_it_is_watched(bench):
    lab = bench(MOVER, dead_man=0.05, rate=100)
    lab.session.start()
    assert lab.session.wait_for(lambda frame: frame.status == "paused", 60)
    assert "has not been watched" in lab.session.frame.reason


def test_poses_come_with_a_frame_as_numbers(bench):
    lab = bench(MOVER, bridge="sim", world="line")
    page = lab.page()
    lab.session.step()
    lab.publish()
    assert [frame["frame"] for frame in page.all("frame")] == [2]
    (buffer,) = page.buffers[-1]
    time, x, y, *_ = struct.unpack(f"<d{(len(buffer) - 8) // 4}f", buffer)
    assert time == pytest.approx(0.1)
    assert (x, y) != lab.session.bridge.world.robots[0].pose[:2]


def test_only_parts_that_show_the_world_get_poses(bench):
    lab = bench(MOVER, bridge="sim")
    graph = lab.page("graph", part="graph")
    lab.session.step()
    lab.publish()
    assert graph.all("frame")
    assert not any(graph.buffers)


def test_a_world_is_described_with_all_that_a_page_draws_and_does_not_know(bench):
    lab = bench(MOVER, bridge="sim", world="boxes")
    world = lab.page().messages[0]["world"]
    assert world["robots"][0].keys() == {"pose", "name"}
    assert {solid.get("push") for solid in world["solids"]} == {0.3, 0.2, None}
    assert lab.page("other").messages[0]["choices"]["worlds"][0] == "empty"


def test_a_page_knows_what_a_world_leaves_out():
    robot, stroke = RobotSpec((0, 0, 0)), PathStroke(())
    assert (robot.radius, robot.light, robot.bumper, robot.distance) == (0.08, ((0.06, 0),), True, ((0, 2),))
    assert (stroke.width, stroke.grey, FloorSpec().grey) == (0.03, 0, 255)
    page = (Path(__file__).parents[2] / "js/src/world/complete.ts").read_text("utf-8")
    for filled in ("radius: 0.08", "light: [[0.06, 0]]", "bumper: true", "distance: [[0, 2]]"):
        assert filled in page
    assert "width: 0.03, grey: 0" in page
    assert "grey = 255" in page


def test_what_is_dragged_while_paused_is_seen(bench):
    lab = bench(MOVER, bridge="sim", world="boxes")
    page = lab.page()
    lab.publish()
    assert page.do("drag_robot", index=0, pose=[1.0, 0.5, 0.0]) is None
    (buffer,) = page.buffers[-1]
    assert struct.unpack_from("<dff", buffer)[1:] == (1.0, 0.5)
    assert page.do("drag_solid", index=0, pose=[2.0, 0.5, 0.0]) is None
    assert page.last("world")["world"]["solids"][0]["box"][:2] == [2.0, 0.5]
    assert "no robot 7" in page.do("drag_robot", index=7, pose=[1.0, 0.5, 0.0])


def test_trails_come_as_ink_that_is_added_to(bench):
    lab = bench("(machine m (state a)) (spawn m a)", bridge="sim", world="empty")
    page = lab.page()
    lab.publish()

    def drive():
        lab.session.call(lambda: lab.session.bridge.simulation.step(100))
        lab.publish()

    simulation = lab.session.bridge.simulation
    lab.session.call(lambda: (simulation.pen(grey=120, width=0.01), simulation.drive(0.2)))
    drive()
    ink = page.last("frame")["ink"]
    (trail,) = ink["strokes"]
    assert ink["first"] == 0
    assert trail["path"][0] == [1.5, 1.0]
    assert {**trail, "path": []} == {"path": [], "width": 0.01, "grey": 120, "ink": True}
    drive()
    assert page.last("frame")["ink"]["first"] == 1
    page.do("reset_world")
    lab.publish()
    assert page.last("world")["world"]["name"] == "empty"
    assert "ink" not in page.last("frame")


def test_what_a_robot_says_comes_when_it_begins_and_when_it_ends_also_in_another_view(bench):
    lab = bench("(machine m (state a)) (spawn m a)", bridge="sim", world="convoy")
    page = lab.page()
    simulation = lab.session.bridge.simulation
    lab.publish()
    assert "says" not in page.last("frame")
    lab.session.call(lambda: (simulation.apply(Say("Hello", robot=1)), simulation.step(10)))
    lab.publish()
    assert page.last("frame")["says"] == ["", "Hello"]
    late = lab.page("late")
    lab.session.call(lambda: simulation.step(10))
    lab.publish()
    assert late.last("frame")["says"] == ["", "Hello"]
    lab.session.call(lambda: simulation.step(200))
    lab.publish()
    assert page.last("frame")["says"] == late.last("frame")["says"] == []


def test_what_blocks_print_is_sent_once_and_in_order(bench):
    lab = bench("(machine m (state a (running [print('hello')]))) (spawn m a)")
    page = lab.page()
    for _ in range(3):
        lab.session.step()
        lab.publish()
    told = [frame["printed"] for frame in page.all("frame") if "printed" in frame]
    assert told == [{"0": "hello"}, {"1": "hello"}, {"2": "hello"}]


def test_issues_are_sent_with_their_place_and_gone_when_they_are_cleared(bench):
    lab = bench("(machine m (state a (running [1 / 0]))) (spawn m a)")
    page = lab.page()
    for _ in range(3):
        lab.session.step()
    lab.publish()
    (issue,) = page.latest("issues").values()
    assert issue["code"] == "LRP601"
    assert issue["count"] == 3
    assert "ZeroDivisionError" in issue["traceback"]
    assert (issue["range"]["line"], issue["range"]["column"]) == (1, 31)
    assert page.do("clear_issues") is None
    assert page.latest("issues") == {str(issue["id"]): None}


def test_a_restart_by_an_edit_is_reported_with_its_reason(bench):
    lab = bench(MOVER, bridge="sim")
    page = lab.page()
    lab.session.step()
    page.type(MOVER.replace("0.2", "0.3"))
    lab.publish()
    (restart,) = page.merged("restarts").values()
    assert "`a` is active" in restart["reason"]
    page.do("reset")
    assert list(page.merged("restarts")) == ["1"]  # a reset is not a restart by an edit


def test_values_of_the_robots_members_are_sent_though_no_program_reads_them(bench):
    lab = bench("(machine m (state a)) (spawn m a)", bridge="sim")
    page = lab.page()
    lab.session.step()
    lab.publish()
    lab.publish()
    assert page.latest("members")["light.data"].isdigit()
    members = {member["name"]: member for member in page.latest("bridge")["members"]}
    assert members["move"]["insert"] == "robot.move(linear=0.0, angular=0.0)"
    assert members["distance.data"]["unit"] == "m"


def test_what_has_become_of_a_task_is_sent_also_of_a_tick_that_is_looked_at(bench):
    bot = Courier()
    lab = bench("(machine m (state a (running [robot.go(1)]))) (spawn m a)", bridge=bot)
    page, seen = lab.page(), []
    lab.session.run(0.2)
    task = bot.next()
    lab.publish()
    seen.append(page.latest("members")["go"])
    task.update("aborted", reason="no path")
    lab.session.run(0.1)
    lab.publish()
    seen.append(page.latest("members")["go"])
    for tick in (2, 1):
        page.do("look", tick=tick)
        lab.publish()
        seen.append(page.latest("members")["go"])
    assert seen == ["active", "aborted: no path", "active", ""]


def test_a_fault_of_the_lab_is_reported_in_the_lab(bench, monkeypatch):
    lab = bench(BLINK)
    page = lab.page()
    monkeypatch.delattr(lab.connection, "texts")
    page.sends("")
    monkeypatch.undo()
    assert "AttributeError" in lab.connection.fault
    lab.publish()
    assert "The lab itself failed; the program is not at fault." in page.latest("printed").values()
    lab.connection.fault = ""


def counted(robot):
    """Count how often a robot is read."""
    robot.add_variable("x", lambda: robot.calls.append("read") or len(robot.calls))


@pytest.fixture
def reads(bench):
    """How often a robot is read in three seconds, for the views of a session that is as it is told."""

    def count(hardware=False, views=1, then=lambda session: None):
        lab = bench("(machine m (state a)) (spawn m a)", bridge=(robot := Bare(counted, hardware=hardware)))
        for number in range(views):
            lab.page(f"page {number}")
        lab.session.step()
        then(lab.session)
        before = len(robot.calls)
        for _ in range(96):
            lab.publish(after=1 / 32)
        return len(robot.calls) - before

    return count


def test_a_simulator_is_read_five_times_a_second_and_a_real_robot_once(reads):
    assert 13 <= reads(hardware=False) <= 15
    assert reads(hardware=True) == 3


def test_an_unwatched_robot_and_a_stopped_one_are_not_read(reads):
    assert reads(views=0) == 0
    assert reads(then=lambda session: session.stop()) == 0


def test_a_robot_is_not_asked_again_before_it_has_answered(bench):
    gate, inside = Event(), Event()
    lab = bench(
        "(machine m (state a (running [inside.set() or gate.wait(60)]))) (spawn m a)",
        bridge=(robot := Bare(counted)),
        namespace={"gate": gate, "inside": inside},
    )
    lab.page()
    lab.session.start()
    assert inside.wait(60)
    for _ in range(20):
        lab.publish()
    gate.set()
    lab.session.call(lambda: None)
    assert len(robot.calls) == 1


def test_views_get_a_snapshot_of_the_session_that_takes_the_place_of_another(bench):
    lab = bench(BLINK, name="before")
    page = lab.page()
    with Session(CALM, "sim", name="after") as session:
        lab.connection.use(session)
        assert [snapshot["name"] for snapshot in page.all("snapshot")] == ["before", "after"]
        (machine,) = page.last("snapshot")["frame"]["program"]["machines"]
        assert [state["path"] for state in machine["states"]] == ["m/a"]


def test_a_fault_at_the_end_is_reported_and_keeps_no_session_open(bench, monkeypatch):
    lab = bench(BLINK)
    monkeypatch.setattr(type(lab.connection.layouts), "update", lambda *_: {}["no layout"])
    lab.connection.close()
    assert lab.session.status == "closed"
    assert "no layout" in lab.connection.fault
    lab.connection.fault = ""


def test_closing_tells_a_view_without_credit_too(bench):
    lab = bench(BLINK)
    page = lab.page(pays=False)
    for _ in range(5):
        lab.session.step()
        lab.publish()
    lab.connection.close()
    assert page.last("frame")["status"] == "closed"
    assert page.latest("tick") == 5


def test_what_was_asked_before_the_end_is_answered(bench):
    lab = bench(BLINK)
    page = lab.page()
    page.send("command", id=7, do="rate", value=25)
    lab.connection.close()
    assert page.last("reply") == {"type": "reply", "view": "page", "id": 7, "error": None}


def test_after_a_round_that_failed_the_publisher_goes_on():
    failed, gone_on = Event(), Event()

    def send(message, buffers):
        if message["type"] == "frame" and failed.is_set():
            gone_on.set()

    connection = PageConnection(Session(BLINK), Saver(Texts()))
    update = connection.layouts.update

    def fail_once(frame):
        if not failed.is_set():
            failed.set()
            raise RuntimeError("no layout")
        update(frame)

    connection.layouts.update = fail_once
    connection.receive(send, {"type": "hello", "view": "page", "part": "lab"})
    assert gone_on.wait(60)
    assert "no layout" in connection.fault
    connection.close()


def test_messages_are_sent_in_the_context_of_the_cell_that_opened_the_lab():
    cell = ContextVar("cell", default="none")
    cell.set("this one")
    seen, sent = [], Event()

    def send(message, buffers):
        if current_thread() is not main_thread():
            seen.append(cell.get())
            sent.set()

    connection = PageConnection(Session(BLINK), Saver(Texts()))
    connection.receive(send, {"type": "hello", "view": "page", "part": "lab"})
    connection.session.step()
    assert sent.wait(60)
    connection.close()
    assert set(seen) == {"this one"}


def test_closing_notifies_every_view_and_ends_the_session(bench):
    lab = bench(BLINK)
    page = lab.page()
    lab.session.start()
    lab.connection.close()
    lab.connection.close()
    assert page.last("frame")["status"] == "closed"
    assert lab.session.status == "closed"


def test_the_states_to_mark_have_their_paths_in_the_text_and_variables_those_as_spawned(bench):
    lab = bench(
        "(machine shared (var v := [1]) (state x))"
        "(machine m (state a (onentry (spawn shared x)))) (spawn m a)"
    )
    page = lab.page()
    lab.session.step()
    lab.publish()
    assert lab.session.frame.active == (("m", "a", "shared", "x"),)
    assert page.latest("lit") == ["m/a", "shared/x"]
    assert page.latest("variables").keys() == {"m/a/shared/v"}


FAST = """(var n := [0])
(machine m
  (state a (running [n += 1
                     robot.move(linear=n, angular=0.1)]))
  (state b (onentry [robot.stop()]))
  (on [n == 5] a -> b))
(spawn m a)
"""


def test_a_clipped_command_is_in_the_issues_once_where_it_was_given(bench):
    lab = bench(FAST, bridge="sim", world="empty")
    page = lab.page()
    for _ in range(4):
        lab.session.step()
    lab.publish()

    def issues():
        return list(page.merged("issues").values())

    (issue,) = issues()
    assert issue["message"] == "`move`: linear 1 limited to 0.5."
    assert (issue["severity"], issue["count"], issue["resolved"]) == ("warning", 4, False)
    assert (issue["range"]["line"], issue["range"]["column"]) == (4, 28)
    assert (issue["first_tick"], issue["last_tick"]) == (1, 4)
    for _ in range(20):
        lab.session.step()
    lab.publish()
    assert issues()[0]["resolved"]
    assert lab.session.issues == (), "it is no fault of the program"
    page.do("clear_issues")
    lab.publish()
    assert issues() == []


def test_a_command_that_a_pause_has_ended_is_in_the_issues_where_it_was_given(bench):
    once = FAST.replace("(running [n += 1", "(onentry [n += 1")
    lab = bench(once, bridge="sim", world="empty")
    page = lab.page()
    lab.session.run(0.2)
    lab.session.resume()
    lab.session.pause()
    lab.session.run(0.1)
    lab.publish()
    (limit, issue) = page.merged("issues").values()
    assert (issue["kind"], issue["element"], issue["count"]) == ("stopped", "a.onentry", 1)
    assert issue["range"] == limit["range"], "the same `move`"
    page.do("clear_issues")
    lab.publish()
    assert list(page.merged("issues").values()) == []


def test_what_a_page_cannot_stop_while_a_cell_runs_is_told_with_what_holds_then(bench):
    def told(**options):
        lab = bench(MOVER, **options)
        page, other = lab.page(), lab.page("other")
        assert page.latest("late") == ""
        lab.session.bridge.hardware = "dead_man" in options
        lab.connection.receive(page, {"type": "credit", "view": "page", "frame": 1}, waits=True)
        lab.publish()
        assert other.latest("late") == page.latest("late") != ""
        page.send("bye")
        lab.publish()
        assert other.latest("late") == "", "the other page is in time"
        return page.latest("late")

    assert "After 5 s in which no page reaches it, the robot stops" in told(dead_man=5.0)
    assert "robot" not in told()


def test_where_the_program_waits_for_a_cell_as_well_nothing_comes_late(bench):
    lab = bench(MOVER, driver="asyncio")
    page = lab.page()
    lab.connection.receive(page, {"type": "credit", "view": "page", "frame": 1}, waits=True)
    lab.publish()
    assert page.latest("late") == ""
