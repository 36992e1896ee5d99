"""Sessions with the simulated robot: one time for program and world."""

import json
import math

import pytest
from support.robots import Bare
from support.smil import evaluate, placed

from lrp_jupyter.bridges.sim import SimBridge
from lrp_jupyter.errors import BridgeError
from lrp_jupyter.live import clock as clocks
from lrp_jupyter.live.recording import read_recording
from lrp_jupyter.live.reproduction import reproduce
from lrp_jupyter.live.session import Session
from lrp_jupyter.live.trace import Trace
from lrp_jupyter.sim.animation import TURNED, WITHIN
from lrp_jupyter.sim.svg_shapes import robot_colour

BOUNCE = """
(var bumps := [0])
(machine m
  (state driving (running [robot.move(linear=0.4)]))
  (state backing (onentry [bumps = bumps + 1]) (running [robot.move(linear=-0.2, angular=0.7)]))
  (on [robot.bumper.data == 1] driving -> backing)
  (ontime 1500 backing -> driving))
(spawn m driving)
(onpause [robot.stop()])
"""
LONG = 120.0  # seconds; reached only when something is wrong


def poses(session):
    return [robot.pose for robot in session.frame.robot.robots]


@pytest.fixture
def trace():
    """Record the events of an observer as text."""
    lines = []

    def follow(session):
        session.observe(Trace(lines.append))
        return lambda: "".join(lines)

    return follow


def test_two_runs_give_bit_identical_poses_and_traces(session, trace):
    runs = []
    for _ in range(2):
        bouncing = session(BOUNCE, "sim", world="boxes", seed=7, noise={"motor": 0.1, "light": 10})
        written = trace(bouncing)
        bouncing.run(20)
        runs.append((poses(bouncing), written()))
        bouncing.close()
    assert runs[0][0] == runs[1][0]
    assert runs[0][1] + runs[0][1] == runs[1][1]  # both wrote into one list


def test_another_seed_is_another_run(session):
    runs = []
    for seed in range(2):
        bouncing = session(BOUNCE, "sim", world="boxes", seed=seed, noise={"motor": 0.1})
        bouncing.run(5)
        runs.append(poses(bouncing))
    assert runs[0] != runs[1]


@pytest.mark.parametrize("ticks", [1, 7, 150])
def test_rewinding_restores_program_world_and_time_exactly(session, ticks):
    bouncing = session(BOUNCE, "sim", world="boxes", noise={"motor": 0.05})
    bouncing.run(30)
    after = (poses(bouncing), bouncing.frame.variables, bouncing.frame.active, bouncing.frame.time)
    bouncing.rewind(ticks)
    assert bouncing.frame.time == pytest.approx(30 - ticks / 10)
    assert bouncing.frame.robot.time == bouncing.frame.time
    bouncing.run(ticks / 10)
    assert (poses(bouncing), bouncing.frame.variables, bouncing.frame.active, bouncing.frame.time) == after


def test_stepping_and_stepping_back_leaves_everything_where_it_was(session):
    bouncing = session(BOUNCE, "sim", world="boxes")
    bouncing.run(5)
    before = (poses(bouncing), bouncing.frame.time, bouncing.frame.tick)
    for _ in range(4):
        bouncing.step()
    bouncing.rewind(4)
    assert (poses(bouncing), bouncing.frame.time, bouncing.frame.tick) == before


def test_rewinding_undoes_what_came_after_the_beginning_of_a_tick(session, tmp_path):
    path = tmp_path / "run.lrplog"
    bouncing = session(BOUNCE, "sim", world="boxes")
    with bouncing.record(path):
        bouncing.run(3)
        before = poses(bouncing)
        bouncing.bridge.place_robot((1.5, 1.5, 2.0))
        bouncing.step()
        assert poses(bouncing) != before
        bouncing.rewind(1)
        assert poses(bouncing) == [(1.5, 1.5, 2.0)], "where it was put before that tick"
        bouncing.step()
        bouncing.rewind(2)
        bouncing.step()
        assert poses(bouncing) == before
    again = reproduce(read_recording(path))
    assert again.difference is None
    again.session.close()


def test_a_period_is_a_whole_number_of_physics_steps(session):
    running = session(BOUNCE, "sim", world="empty", rate=30)
    running.run(3)
    assert running.frame.tick == 100


def test_at_rate_0_there_is_a_tick_for_every_physics_step(session):
    running = session(BOUNCE, "sim", world="empty", rate=0)
    running.run(2)
    assert running.frame.tick == 200


def test_a_run_shorter_than_a_physics_step_is_one(session):
    running = session(BOUNCE, "sim", world="empty")
    running.run(0.001)
    running.run(0.013)
    assert running.frame.time == 0.03


def test_a_step_moves_the_world_by_one_period(session):
    running = session(BOUNCE, "sim", world="empty", rate=5)
    running.step()
    running.step()
    ((x, _, _),) = poses(running)
    assert x == pytest.approx(1.5 + 0.4 * 0.4, abs=0.015)


def test_a_restart_stops_the_robot_and_leaves_the_world_as_it_is(session):
    running = session(BOUNCE, "sim", world="empty")
    running.run(1)
    before = poses(running)
    running.edit(BOUNCE.replace("robot.move(linear=0.4)", "0"))
    assert running.frame.restarts == 1
    assert poses(running) == before
    running.step()
    ((x, _, _),) = poses(running)
    assert running.frame.robot.robots[0].command == (0.0, 0.0)
    assert before[0][0] <= x <= before[0][0] + 0.02


def test_pausing_freezes_program_and_world_together(session):
    running = session(BOUNCE, "sim", world="empty", speed=10.0)
    running.start()
    running.wait_for(lambda frame: frame.tick >= 5, LONG)
    running.pause()
    before = (poses(running), running.frame.time, running.frame.tick)
    running.call(lambda: None)
    assert (poses(running), running.frame.time, running.frame.tick) == before
    assert running.frame.robot.robots[0].command == (0.0, 0.0)


def test_the_world_moves_between_two_slow_ticks(session):
    running = session(BOUNCE, "sim", world="empty", rate=1, speed=5.0)
    seen = set()
    running.start()
    running.wait_for(lambda frame: seen.add(frame.time) or frame.tick >= 3, LONG)
    assert len(seen) > 5


@pytest.fixture
def wall(monkeypatch):
    """A wall clock that the test moves by hand."""
    now = [100.0]
    monkeypatch.setattr(clocks, "monotonic", lambda: now[0])
    return now


@pytest.mark.parametrize("speed", [1.0, 4.0])
@pytest.mark.parametrize("bridge", ["sim", "none"])
def test_after_a_stall_of_the_host_one_tick_follows_and_not_all_that_were_missed(
    session, wall, bridge, speed
):
    stalled = session(BOUNCE.replace("robot.", "0 or robot."), bridge, speed=speed)
    loop = stalled._loop
    stalled.resume()
    for _ in range(3):
        wall[0] += 0.1 / speed
        loop.turn()
    before = loop.interpreter.tick
    wall[0] += 60
    for _ in range(5):  # no more wall time passes
        loop.turn()
    assert loop.interpreter.tick == before + 1


def test_a_turn_that_comes_late_moves_the_world_no_further_than_to_its_tick(session, wall):
    late = session(BOUNCE, "sim", world="empty")
    loop = late._loop
    late.resume()
    loop.turn()
    wall[0] += 0.13
    loop.turn()
    assert (loop.timing.now, loop.interpreter.tick, loop.interpreter.now) == (0.1, 2, 0.1)


def test_a_stall_of_the_host_makes_a_simulated_run_slower_and_skips_nothing(session, wall):
    stalled = session(BOUNCE, "sim", world="empty")
    loop = stalled._loop
    stalled.resume()
    for turn in range(60):
        wall[0] += 60 if turn == 20 else 0.05
        loop.turn()
    assert loop.timing.clock.now() == pytest.approx(loop.timing.now, abs=0.05)
    assert loop.timing.now < 3.1
    assert loop.interpreter.tick == pytest.approx(loop.timing.now * 10, abs=1.01)


def test_a_run_whose_commands_were_not_sent_says_once_that_the_robot_was_never_armed(session):
    def made(hardware, text="[robot.move(1)]"):
        bridge = Bare(lambda robot: robot.add_method("move", lambda linear: None), hardware=hardware)
        return session(f"(machine m (state a (running {text}))) (spawn m a)", bridge)

    running = made(True)
    with pytest.warns(
        UserWarning, match=r"`test-bare` is disarmed.*bridge\.arm\(\).*hardware = False"
    ) as told:
        running.run(1)
    running.run(1)
    assert [each.filename for each in told] == [__file__]
    made(False).run(1)
    made(True, "[1]").run(1)
    armed = made(True)
    armed.open()
    armed.bridge.arm()
    armed.run(1)
    armed.bridge.disarm()
    armed.run(1)


def test_an_issue_that_a_member_is_missing_is_over_when_the_robot_has_it(session):
    bare = Bare()
    text = "(machine m (state a (onentry [robot.light.data] [robot.lamp])) ) (spawn m a)"
    running = session(text, bare)
    running.run(1)
    assert [issue.resolved for issue in running.issues] == [False, False]
    bare.add_variable("light.data", int)
    running.run(1)
    assert [issue.resolved for issue in running.issues] == [True, False]


def test_an_armed_robot_cannot_be_rewound_and_a_disarmed_one_can(session):
    barrow = Bare(lambda robot: robot.add_method("move", lambda linear: None), hardware=True)
    running = session("(machine m (state a (running [robot.move(1)]))) (spawn m a)", barrow)
    with pytest.warns(UserWarning, match="disarmed"):
        running.run(1)
    barrow.arm()
    with pytest.raises(ValueError, match="speed 1"):
        running.speed = 10
    with pytest.raises(BridgeError, match="armed"):
        running.rewind(3)
    assert running.frame.tick == 10
    barrow.disarm()
    running.rewind(3)
    assert running.frame.tick == 7


def test_a_bridge_that_fails_is_lost_and_the_loop_continues(session):
    def fail(*_):
        raise OSError("the cable is gone")

    wreck = Bare(on_start=fail, sense=fail)
    running = session("(var n := [0]) (machine m (state a (running [n = n + 1]))) (spawn m a)", wreck)
    running.run(1)
    assert (running.frame.variables[("n",)], running.frame.issues) == ("10", ())
    assert "the cable is gone" in running.frame.bridge


def test_a_trace_is_one_object_per_event_with_what_it_concerns(session, trace):
    running = session(
        """
        (var n := [0])
        (machine m
          (state a (onentry [n = 1]))
          (state b (machine k (state x)) (onentry (spawn k x)) (running [1 / 0]))
          (ontime 100 a -> b go))
        (spawn m a)
        """
    )
    written = trace(running)
    running.run(0.3)
    running.teleport_to("m/a")
    running.edit(running.text.replace("1 / 0", "2"))
    running.reset()
    entries = [json.loads(line) for line in written().splitlines()]
    assert [set(entry) >= {"tick", "time", "event"} for entry in entries] == [True] * len(entries)
    found = [{key: value for key, value in entry.items() if key not in ("tick", "time")} for entry in entries]
    for expected in (
        {"event": "started"},
        {"event": "spawned", "machine": "m"},
        {"event": "entered", "state": "m/a"},
        {"event": "changed", "variable": "n", "value": 1},
        {"event": "left", "state": "m/a"},
        {"event": "fired", "machine": "m", "transition": "go", "source": "a", "destination": "b"},
        {"event": "spawned", "machine": "m/b/k"},
        {"event": "discarded", "machine": "m/b/k"},
        {"event": "forced", "state": "m/a", "how": "teleport"},
        {"event": "patched", "applied": True, "restarted": False, "reason": None},
        {"event": "restarted", "reason": "reset"},
    ):
        assert expected in found
    (issue,) = [entry for entry in found if entry["event"] == "issue"]
    assert (issue["code"], issue["element"], issue["line"]) == ("LRP601", "m/b", 5)


def test_values_in_a_trace_are_json_and_without_addresses(session, trace):
    class Thing:
        pass

    running = session(
        "(var a := [Thing()]) (var b := [float('inf')]) (var c := [[1]]) (machine m (state s)) (spawn m s)",
        namespace={"Thing": Thing},
    )
    written = trace(running)
    running.step()
    values = {
        entry["variable"]: entry["value"]
        for entry in map(json.loads, written().splitlines())
        if "variable" in entry
    }
    assert values["b"] == "inf"
    assert values["c"] == "[1]"
    assert "0x" not in values["a"]


def test_a_run_beside_what_moves_by_itself_is_gone_back_forked_and_reproduced_exactly():
    text = """
(event near [robot.front.distance < 0.3])
(event far [robot.front.distance > 0.4])
(machine m
  (state driving (running [robot.move(linear=0.3)]))
  (state waiting (onentry [robot.stop()]))
  (on near driving -> waiting)
  (on far waiting -> driving))
(spawn m driving)
"""
    bridge = SimBridge("crossing", noise={"motor": 0.1, "distance": 0.01})

    def now(session):
        simulation = session.bridge.simulation
        return [
            *(thing.pose for thing in simulation.solids),
            simulation.robot.pose,
            session.interpreter.active,
        ]

    with Session(text, bridge, clock=clocks.VirtualClock()) as session:
        session.run(seconds=6)
        there = now(session)
        with session.fork() as early:
            session.run(seconds=14)
            end = now(session)
            early.run(seconds=14)
            assert now(early) == end
        with session.fork(at=60) as late:
            late.run(seconds=14.1)
            assert now(late) == end
        session.rewind(140)
        assert now(session) == there
        session.run(seconds=14)
        assert now(session) == end
    assert end[0] != there[0]


def test_a_run_is_drawn_as_an_animation_whole_or_in_part():
    with Session(BOUNCE, SimBridge("walls"), clock=clocks.VirtualClock()) as session:
        recorded = {}
        session.run(seconds=20, after_tick=lambda: recorded.update({session.frame.time: poses(session)[0]}))
        whole, part = session.animation(), session.animation(5.0, 150)
        assert "0.0 to 20.0 s" in whole
        assert "5.0 to 15.0 s" in part
        for time, pose in recorded.items():
            assert_pose(whole, time, pose)
            if 5.0 <= time <= 15.0:
                assert_pose(part, time - 5.0, pose)
        assert len(whole) < 40_000
        session.rewind(100)
        assert "0.0 to 10.0 s" in session.animation()


def assert_pose(picture, time, pose):
    ((x, y, angle, _),) = placed(evaluate(picture, time), robot_colour(0)[0])
    assert math.dist((x, y), pose[:2]) <= WITHIN
    assert abs((angle - pose[2] + math.pi) % math.tau - math.pi) <= math.radians(TURNED)


def test_what_cannot_be_animated_is_refused_in_a_sentence():
    with Session(BOUNCE, SimBridge("walls"), clock=clocks.VirtualClock()) as session:
        session.run(seconds=1)
        with pytest.raises(ValueError, match="Tick 99 is not remembered"):
            session.animation(99)
        with pytest.raises(ValueError, match="The end, tick 3, is before the beginning, tick 5"):
            session.animation(5, 3)
        session.call(lambda: session.bridge.load_world("maze"))
        session.run(seconds=1)
        with pytest.raises(BridgeError, match="Another world was loaded meanwhile"):
            session.animation(3)
        assert "maze · 0.0 to 1.0 s" in session.animation()
    with Session("(machine m (state a)) (spawn m a)", clock=clocks.VirtualClock()) as session:
        session.run(seconds=1)
        with pytest.raises(BridgeError, match="`none` has no simulated world that could be drawn"):
            session.animation()
