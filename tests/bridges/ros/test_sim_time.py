"""The robot's time is that on `/clock`: a real master, a node that publishes it, and a bag that is played."""

from __future__ import annotations

import asyncio
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import suppress
from itertools import count, pairwise
from pathlib import Path
from typing import Any

import pytest
from support.waiting import until

from lrp_jupyter.bridges.bridge import ConnectionState
from lrp_jupyter.bridges.ros import RosBridge, rosapi
from lrp_jupyter.errors import NoDataYet
from lrp_jupyter.live.recording import read_recording
from lrp_jupyter.live.reproduction import reproduce
from lrp_jupyter.live.session import Session

HERE = Path(__file__).parent
Connect = Callable[..., RosBridge]
AFTER_TWO = "(machine m (state early) (state late) (ontime 2000 early -> late)) (spawn m early)"
SEEN = {"subscriptions": {"seen": {"topic": "/seen", "type": "geometry_msgs/PointStamped"}}}
STAMPED = {"publishers": {"move": {"topic": "/cmd_vel", "type": "geometry_msgs/TwistStamped"}}}
DRIVES = "(machine m (state s (running [robot.move(linear=0.2)]))) (spawn m s)"


class World:
    """A world whose time, in seconds, a test sets."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self._process = process

    def show(self, seconds: float, topic: str = "/clock") -> None:
        assert self._process.stdin is not None
        self._process.stdin.write(f"{topic} {seconds!r}\n")
        self._process.stdin.flush()

    def go(self, session: Session, *times: float) -> None:
        """Show one time after the other, each when the session has ticked at the one before."""
        for seconds in times:
            number = session.frame.tick + 1
            self.show(seconds)
            until(lambda number=number: session.frame.tick >= number)
            assert session.frame.tick == number


@pytest.fixture
def simulated(real: Any) -> Iterator[Any]:
    """A master that says that time is simulated."""
    import rosgraph

    master = rosgraph.Master("/tests")
    master.setParam("/use_sim_time", True)
    yield real
    master.deleteParam("/use_sim_time")
    with suppress(KeyError):  # it was not started
        real.kill_rosbridge()  # its node has taken the parameter over


@pytest.fixture
def world(simulated: Any) -> World:
    return World(simulated.start(sys.executable, str(HERE / "clock_node.py"), ready=True))


def tenths(first: int, last: int) -> list[float]:
    return [tenth / 10 for tenth in range(first, last + 1)]


def seen(ros: RosBridge) -> int:
    with suppress(NoDataYet):
        return int(ros.robot.seen.header.stamp.secs)
    return 0


def texts(ros: RosBridge) -> str:
    return " ".join(notice.text for notice in ros.safety.notices)


@pytest.mark.ros
class TestRos1:
    def test_a_program_waits_for_the_time_and_goes_by_it(self, world: World, connect: Connect) -> None:
        ros = connect()
        with Session(AFTER_TWO, ros) as session:
            session.start()
            until(lambda: ros.status.sentence.startswith("`/use_sim_time` is set, and no time arrives"))
            assert (ros.status.state, session.frame.tick) == (ConnectionState.WAITING, 0)
            world.go(session, *tenths(1000, 1019))
            assert session.frame.is_active("early")
            world.go(session, 102.0)
            assert (session.frame.time, session.frame.is_active("late")) == (2.0, True)
            later = count(1021)
            until(
                lambda: world.show(next(later) / 10) or "The time is that of `/clock`" in ros.status.sentence
            )

    def test_a_task_of_asyncio_goes_by_it_too(self, world: World, connect: Connect) -> None:
        async def run() -> None:
            with Session(AFTER_TWO, connect(), driver="asyncio") as session:
                session.start()
                for tenth in range(1000, 1021):
                    world.show(tenth / 10)
                    await asyncio.to_thread(until, lambda n=tenth - 1000: session.frame.tick > n)
                assert (session.frame.tick, session.frame.time) == (21, 2.0)
                assert session.frame.is_active("late")

        asyncio.run(run())

    def test_a_leap_is_one_tick_and_a_step_back_none(self, world: World, connect: Connect) -> None:
        ros = connect()
        with Session(AFTER_TWO, ros) as session:
            session.start()
            world.go(session, 100.0, 100.1, 101.5)
            assert session.frame.time == 1.5
            world.show(3.0)  # the simulation was reset
            until(lambda: "went back by 98.5 s" in texts(ros))
            world.go(session, 3.1, 3.2)
            assert session.frame.time == pytest.approx(1.7)
            world.go(session, *tenths(33, 35))
            assert (session.frame.is_active("late"), session.frame.tick) == (True, 8)

    def test_it_ticks_once_for_each_time_that_is_shown(self, world: World, connect: Connect) -> None:
        ros = connect()
        with Session(AFTER_TWO, ros, rate=50) as session:
            session.start()
            world.go(session, *tenths(1000, 1011))
            assert session.frame.time == pytest.approx(1.1)
            assert "`/clock` comes in steps of 0.1 s, so there are 10 ticks per second, not 50." in texts(ros)

    def test_a_pause_of_the_program_is_none_of_the_world(self, world: World, connect: Connect) -> None:
        with Session(AFTER_TWO, connect()) as session:
            session.start()
            world.go(session, *tenths(1000, 1005))
            session.pause()
            world.show(150.0)
            until(lambda: session.bridge.world_time() == 150.0)
            session.resume()
            world.go(session, *tenths(1501, 1514))
            assert session.frame.is_active("early")
            world.go(session, 151.5)
            assert (session.frame.time, session.frame.is_active("late")) == (2.0, True)

    def test_ages_and_stamps_are_in_it(self, world: World, simulated: Any, connect: Connect) -> None:
        lines = simulated.lines(simulated.start("/usr/bin/rostopic", "echo", "-p", "/cmd_vel"))
        ros = connect(setup={**SEEN, **STAMPED})
        text = """(var ages := [()])
            (machine m (state s (running [ages = ages + (robot.seen.age,)] [robot.move(linear=0.2)])))
            (spawn m s)"""
        with Session(text, ros) as session:
            session.start()
            world.show(99.75, "/seen")
            until(lambda: seen(ros) == 99)
            until(lambda: ros.stop_all() and len(lines) > 1)  # it hears what is published
            world.go(session, 100.0, 100.5, 102.0)
            assert session.variables["ages"] == pytest.approx((0.25, 0.75, 2.25))
            world.show(102.25, "/seen")  # it arrives before its time
            until(lambda: seen(ros) == 102)
            world.go(session, 102.125, 102.5)
            assert session.variables["ages"][3:] == pytest.approx((0.0, 0.25))

        def stamps() -> list[int]:
            rows = [dict(zip(lines[0].split(","), line.split(","), strict=True)) for line in lines[1:]]
            return [int(row["field.header.stamp"]) for row in rows if row["field.twist.linear.x"] == "0.2"]

        until(lambda: stamps()[-1:] == [102_500_000_000])
        assert set(stamps()) <= {100 * 10**9, 100_500_000_000, 102 * 10**9, 102_125_000_000, 102_500_000_000}

    def test_the_age_of_a_parameter_is_in_it(self, world: World, connect: Connect) -> None:
        import rosgraph

        rosgraph.Master("/tests").setParam("/limit", 0.5)
        text = "(var ages := [()]) (machine m (state s (running [ages += (robot.limit.age,)]))) (spawn m s)"
        with Session(text, connect(setup={"parameters": {"limit": "/limit"}})) as session:
            session.start()
            world.go(session, 100.0, 101.5, 130.0)
            assert session.variables["ages"] == pytest.approx((0.0, 1.5, 30.0))

    def test_where_time_stands_the_robot_is_stopped_by_that_of_the_wall(
        self, world: World, connect: Connect
    ) -> None:
        ros = connect(setup={"publishers": {"move": {"topic": "/cmd_vel", "type": "geometry_msgs/Twist"}}})
        with Session(DRIVES, ros) as session:
            session.start()
            world.go(session, 100.0, 100.1)
            until(lambda: not ros.safety.motion)  # it may also have been stopped between the two
            until(lambda: any(notice.kind == "tick watchdog" for notice in ros.safety.notices))
            until(lambda: "`/clock` stands still, and the program with it" in ros.status.sentence)
            assert session.frame.tick == 2
            world.go(session, 100.2)
            assert (ros.safety.command_count, ros.safety.commands[-1].sent) == (3, True), "it goes on with it"

    def test_a_recording_says_what_the_clock_showed_and_is_repeated(
        self, world: World, connect: Connect, tmp_path: Path
    ) -> None:
        path = tmp_path / "run.lrplog"
        text = AFTER_TWO.replace("(state early)", "(state early (running [robot.seen.age]))")
        with Session(text, connect(setup=SEEN)) as session, session.record(path):
            session.start()
            world.show(99.75, "/seen")
            world.go(session, 100.0, 100.1, 100.2)
            session.pause()
            world.show(150.0)
            until(lambda: session.bridge.world_time() == 150.0)
            session.resume()
            world.go(session, *tenths(1501, 1522))
        recording = read_recording(path)
        assert recording.clock == ((0.0, 100.0), (pytest.approx(0.3), 150.1))
        again = reproduce(recording)
        with again.session:
            assert again.difference is None
            assert (again.session.frame.tick, again.session.frame.is_active("late")) == (25, True)

    def test_a_bag_that_is_played_over_and_over_is_one_run(
        self, simulated: Any, connect: Connect, tmp_path: Path
    ) -> None:
        bag = tmp_path / "short.bag"
        write = (
            "import rosbag, genpy, std_msgs.msg as m\n"
            f"with rosbag.Bag({str(bag)!r}, 'w') as bag:\n"
            "    for n in range(11): bag.write('/count', m.Int32(n), genpy.Time(1000, n * 100_000_000))\n"
        )
        subprocess.run(["/usr/bin/python3", "-c", write], check=True, env={"PATH": "/usr/bin"})
        ros = connect(setup={"subscriptions": {"count": {"topic": "/count", "type": "std_msgs/Int32"}}})
        times: list[float] = []
        text = AFTER_TWO.replace("(state early)", "(state early (running [robot.count.new]))")
        with Session(text, ros) as session:
            session.on_tick(lambda: times.append(session.interpreter.now))
            session.start()
            simulated.start("/usr/bin/rosbag", "play", "--clock", "--loop", "-q", "-r", "2", str(bag))
            session.wait_for("late", 120)
            assert "went back by" in texts(ros), "the bag has one second"
        before = [time for time in times if time < 2 - 1e-6]
        assert all(one < other for one, other in pairwise(times))
        assert len(before) <= 21
        assert session.interpreter.visits[("m", "late")].tick == len(before) + 1

    def test_a_time_that_is_published_and_not_gone_by_is_told(self, real: Any, connect: Connect) -> None:
        world = World(real.start(sys.executable, str(HERE / "clock_node.py"), ready=True))
        world.show(100.0)
        ros = connect()
        until(lambda: "set `sim_time=true`" in texts(ros))
        assert ros.world_clock is None


def test_a_rosapi_that_does_not_answer_has_not_said_that_time_is_real(
    make: Connect, graph: Any, server: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(rosapi, "_ANSWER", 0.1)
    graph.parameters["/use_sim_time"] = True
    server.hangs.add("get_param")
    ros = make()
    ros.open()
    assert ros.world_clock is None
    server.hangs.clear()
    until(lambda: ros.world_clock is not None)
