"""Programs that ask a robot for something and wait for it, as those of the language's authors do.

Each does what one kind of their programs does: `notebooks/appendix/for-researchers.ipynb` lists them.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from lrp_jupyter import programs
from lrp_jupyter.bridges.sim import SimBridge
from lrp_jupyter.live.running.checking import check
from lrp_jupyter.live.session import Session
from lrp_jupyter.sim.world import BoxSolid, DiscSolid
from lrp_jupyter.sim.world_edits import PutSolid, RemoveSolid

HERE = Path(__file__).parent
BUNDLED = ("courier", "guide")
OWN = tuple(sorted(path.stem for path in HERE.glob("*.lrp")))


def text_of(name: str) -> str:
    return programs.load(name) if name in BUNDLED else (HERE / f"{name}.lrp").read_text()


class TaskRun:
    """A simulated run, with what was entered, asked for and told, in the order of time."""

    def __init__(self, name: str) -> None:
        text = text_of(name)
        self.bridge = SimBridge(programs.heading(text).world)
        self.session = Session(text, self.bridge)
        self.log: list[str] = []
        self.session.observe(self._note)

    def _note(self, event) -> None:  # type: ignore[no-untyped-def]
        if event.kind == "entered":
            self.log.append(event.path[-1])
        elif event.kind == "task":
            name, state = event.data
            self.log.append(f"{name} {state.status}")

    def run(self, seconds: float) -> list[str]:
        """Run on, and return what happened meanwhile."""
        del self.log[:]
        self.session.run(seconds)
        assert not self.session.issues
        return list(self.log)

    def value(self, name: str) -> object:
        return self.session.frame.values[name]

    def until(self, state: str) -> None:
        assert self.session.run(until=state, seconds=60)


@pytest.fixture
def watched() -> Iterator[type[TaskRun]]:
    made = []

    class Kept(TaskRun):
        def __init__(self, name: str) -> None:
            super().__init__(name)
            made.append(self)

    yield Kept
    for each in made:
        each.session.close()


@pytest.mark.parametrize("name", [*BUNDLED, *OWN])
def test_a_program_of_tasks_has_no_findings(name):
    assert check(text_of(name)) == ()


def test_a_way_is_asked_for_and_its_end_decides_and_a_table_may_move_meanwhile(watched):
    courier = watched("courier")
    assert courier.run(15)[:4] == ["loading", "say succeeded", "driving", "drive_to succeeded"]
    courier.until("driving")
    courier.session.run(1)
    tables = [(0.3, 0.5), *courier.value("tables")[1:]]
    courier.session.set_variable("tables", [(1.0, 0.6), (-0.3, -0.5), *tables[2:]])
    courier.until("handing")
    assert courier.session.bridge.robot.odom.x == pytest.approx(-0.3, abs=0.02)
    assert courier.session.bridge.robot.odom.y == pytest.approx(-0.5, abs=0.02)
    courier.until("sorry")  # the wall is in the way of the last one
    assert str(courier.session.output).startswith("The robot has not moved for 1 s, ")
    assert courier.value("brought") == [0, 1, 2]
    assert courier.run(10)[:3] == ["say succeeded", "backing", "drive_by succeeded"]
    courier.until("handing")  # another parcel, of whose way nothing is known yet
    assert courier.value("brought") == [0, 1, 2, 0]


def test_one_thing_is_done_after_the_other_and_two_at_once_when_both_are_done(watched):
    guide = watched("guide")
    log = [each for each in guide.run(30) if each not in ("dark", "lit")]
    assert log[:3] == ["welcome", "say succeeded", "going"]
    stops = [log[at : at + 5] for at in range(3, len(log), 5)]
    for way, state, *both, _ in stops:
        assert (way, state) == ("drive_by succeeded", "showing")
        assert sorted(both) == ["say succeeded", "turn_by succeeded"]
    assert [then for *_, then in stops] == ["going", "going", "over"]
    lamp = [each.arguments["on"] for each in guide.bridge.safety.commands if each.name == "lamp"]
    assert lamp == [False, *[True, False] * 4]


def test_it_greets_beside_what_it_does_and_once_for_each_time_that_someone_is_there(watched):
    greeter = watched("greeter")
    walk = [each for each in greeter.run(28) if each in ("there", "back", "greeting")]
    assert walk == ["there", "back", "there", "back", "there"]
    greeter.bridge.edit_world(PutSolid(DiscSolid((2.4, 1.0, 0.08))))
    met = [each for each in greeter.run(27.6) if each in ("there", "back", "greeting")]
    assert met == ["greeting", "back", "there", "greeting", "back", "there"]
    assert greeter.value("greeted") == 2


def test_it_stands_before_it_decides_and_turns_until_there_is_room(watched):
    look, pressed = watched("look"), []
    look.session.open()
    asked = look.bridge.robot.drive_by
    look.session.on_tick(lambda: pressed.append(look.bridge.robot.bumper.data))
    for _ in range(5):
        look.until("standing")
        look.session.run(0.3)
        assert asked.status is None  # the way has ended with the state
        assert look.bridge.simulation.robot.command == (0, 0)
        look.until("driving")
    assert look.value("turns") == 5
    assert not any(pressed)


def test_it_searches_until_it_has_found_and_then_no_longer(watched):
    finder = watched("finder")
    finder.run(9)
    assert finder.value("half_turns") == 2
    box = PutSolid(BoxSolid((1.5, 1.55, 0.1, 0.1)))
    finder.bridge.edit_world(box)
    assert finder.run(10)[-3:] == ["drive_by succeeded", "there", "say succeeded"]
    pose = finder.bridge.simulated.pose
    finder.bridge.edit_world(RemoveSolid(0))
    assert finder.run(5) == []
    assert finder.bridge.simulated.pose == pytest.approx(pose, abs=0.001)
