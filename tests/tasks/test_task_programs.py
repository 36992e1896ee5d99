"""Programs that ask a robot for something and wait for it, as those of the language's authors do.

Each does what one kind of their programs does: `notebooks/appendix/for-researchers.ipynb` lists them.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from support.robots import Clockwork

from lrp_jupyter import programs
from lrp_jupyter.bridges.sim import SimBridge
from lrp_jupyter.live.running.checking import check
from lrp_jupyter.live.session import Session
from lrp_jupyter.sim.world import BoxSolid, DiscSolid
from lrp_jupyter.sim.world_edits import PutSolid, RemoveSolid

HERE = Path(__file__).parent
NOTEBOOKS = HERE.parents[1] / "notebooks"
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


# -- robots that are told things


@pytest.fixture
def clockwork() -> Iterator[Callable[..., tuple[Session, Clockwork]]]:
    made = []

    def run_on(name: str, *messages: str, **options: object) -> tuple[Session, Clockwork]:
        bridge = Clockwork(**options)  # type: ignore[arg-type]
        made.append(Session(text_of(name), bridge))
        made[-1].open()
        for message in messages:
            bridge.feed(message, type=str, stale_after=None)
        return made[-1], bridge

    yield run_on
    for each in made:
        each.close()


def asked(bridge: Clockwork, name: str) -> list[object]:
    return [each[1] for each in bridge.log if each[0] == name]


def test_all_that_is_heard_is_said_once_also_what_is_heard_while_it_talks(clockwork):
    session, parrot = clockwork("parrot", "heard.data", say=1.0)
    words = ["hello", "who", "who", "is", "there"]
    parrot.feed("heard.data", words[0])
    session.run(0.5)
    for word in words[1:4]:  # in one tick
        parrot.feed("heard.data", word)
    session.run(1.5)
    parrot.feed("heard.data", words[4])
    session.run(10)
    assert session.frame.values["said"] == asked(parrot, "say") == words
    assert not session.issues


def test_an_answer_counts_once_and_what_is_none_is_asked_for_again(clockwork):
    session, desk = clockwork("question", "answer.data", say=1.0, put=2.0)
    session.run(2.0)
    desk.feed("answer.data", "under the table")
    session.run(2.0)
    assert session.frame.is_active("listening")
    desk.feed("answer.data", "left")
    desk.feed("answer.data", "no, right")
    session.run(1.0)
    assert session.frame.is_active("putting")
    desk.feed("answer.data", "middle")  # too late for this one, and no answer to the next question
    session.run(until="listening", seconds=10)
    session.run(9.0)
    assert session.frame.values["put"] == asked(desk, "put") == ["left", "middle"]
    assert asked(desk, "say") == ["Which box?", "Pardon?", "Which box?", "Then the middle one.", "Which box?"]
    assert not session.issues


def test_each_touch_counts_once_however_short(watched):
    rover = watched("touch")
    log = rover.run(60)
    assert rover.value("touches") == log.count("backing") >= 5
    assert "drive_by aborted" not in log


ROUNDS = {"drive_to": 0.5, "lamp": 0.1}


def test_a_round_copes_with_failures_delays_a_low_battery_and_a_burst_of_orders(clockwork):
    session, rover = clockwork("rounds", "order.data", readings={"battery.data": 1.0}, **ROUNDS)
    first, second, third = ((2.0, 0.0), (2.0, 2.0), (0.0, 2.0))
    rover.plans = {("drive_to", *second): ["aborted"], ("drive_to", *third): [None]}
    session.run(until="leaving", seconds=10)
    for number in range(20):  # within a tick
        rover.feed("order.data", f"order {number}")
    session.run(until=lambda _: rover.log.count(("drive_to", *first)) == 2, seconds=20)
    rover.given["battery.data"] = 0.1
    session.run(0.2)
    assert rover.log[-2:] == [("cancel", "drive_to"), ("drive_to", 0.0, 0.0)]
    session.run(until="charging", seconds=10)
    rover.given["battery.data"] = 1.0
    session.run(0.2)
    session.close()
    drives = [each[1:] if each[0] == "drive_to" else each for each in rover.log if each[0] != "lamp"]
    late, low = ("cancel", "drive_to"), ("cancel", "drive_to")
    assert drives == [first, second, second, third, late, third, first, low, (0.0, 0.0), first, low]
    lamps = [each[1] for each in rover.log if each[0] == "lamp"]
    assert lamps == [True, False] * 3 + [False]  # the last one at the end of the run
    said = str(session.output).splitlines()
    assert [line.partition(" [")[0] for line in said] == ["place 0", "place 1", "place 2"]
    assert [line.count("order") for line in said] == [0, 20, 0]
    assert not session.issues


# -- where they are shown


def prose(notebook: str) -> str:
    cells = json.loads((NOTEBOOKS / f"{notebook}.ipynb").read_text())["cells"]
    return "\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "markdown")


def test_the_page_for_researchers_lists_them():
    row = r"^\| [^|]+ \| \d \| `(?:tests/tasks/)?([\w-]+)(?:\.lrp)?` \| \w+ \|$"
    rows = re.findall(row, prose("appendix/for-researchers"), re.MULTILINE)
    assert sorted(rows) == sorted({*BUNDLED, *OWN} - {"rounds"})


def test_the_page_of_patterns_shows_the_rounds_as_they_are():
    assert f"```lrp\n{text_of('rounds')}```" in prose("reference/patterns")
