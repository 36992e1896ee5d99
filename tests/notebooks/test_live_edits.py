"""What the tables "type, and see" of the notebooks promise is what happens; without waiting."""

from __future__ import annotations

from prose import prose
from stored import NOTEBOOKS, opened_program, read, sources

from lrp_jupyter import Session


class Typist:
    """Types the edits in the tables of a notebook into its lab, in their order."""

    def __init__(self, name: str) -> None:
        notebook = read(NOTEBOOKS / f"{name}.ipynb")
        cell = next(source for source in sources(notebook, "code") if opened_program(source))
        first, _, program = cell.partition("\n")
        _, _, world = first.partition("--world ")
        self.prose = prose(notebook)
        self.session = Session(program, bridge="sim", world=world)

    def type(self, typed: str, instead_of: str = "", before: str = "") -> None:
        assert f"`{typed}`" in self.prose, "the notebook says so"
        text, old = self.session.text, instead_of or before
        assert text.count(old) == 1
        self.session.edit(text.replace(old, typed if instead_of else f"{typed}\n{before}"))

    def is_active(self, state: str) -> bool:
        return self.session.frame.is_active(state)

    def found(self) -> set[str]:
        return {finding.code for finding in self.session.findings}

    @property
    def x(self) -> float:
        return self.session.bridge.picture.robots[0].pose[0]


def test_the_first_robot_continues_at_half_the_speed():
    hello = Typist("00-hello-live-robot")
    hello.session.run(1)
    hello.type("0.1", instead_of="0.2")
    assert hello.session.frame.tick == 10
    assert hello.session.frame.variables["forward",] == "0.1"
    hello.session.run(30)
    assert hello.session.frame.restarts == 0


def test_the_first_robot_learns_to_rest_and_to_continue():
    hello = Typist("00-hello-live-robot")
    hello.session.run(1)
    hello.type("(state resting (onentry [robot.stop()]))", before="(on black")
    assert hello.found() == {"LRP401"}
    hello.session.run(5)
    hello.type("(ontime 500 left -> resting)", before="(on black")
    assert not hello.found()
    assert hello.session.run(60, until="resting")
    hello.session.run(5)
    assert hello.is_active("resting")
    hello.type("(ontime 1000 resting -> left)", before="(on black")
    assert hello.session.run(1, until="left")
    assert hello.session.frame.restarts == 0


def test_the_first_robot_misses_the_line_when_it_is_too_fast():
    hello = Typist("00-hello-live-robot")
    hello.session.run(1)
    hello.type("0.5", instead_of="0.2")
    hello.session.run(10)
    around = hello.session.frame.count_of("right")
    hello.session.run(20)
    assert hello.session.frame.count_of("right") - around < 12
    assert 1.2 < hello.x < 2.0, "it drives circles"


def test_the_rover_stops_as_soon_as_its_transition_is_typed():
    rover = Typist("01-states-and-events")
    rover.session.run(10)
    rover.type("(event bump [robot.bumper.data == 1])", before="(state driving")
    assert rover.found() == {"LRP403"}
    rover.type("(state stopped (onentry [robot.stop()]))", before="(state driving")
    assert "LRP401" in rover.found()
    rover.type("(on bump driving -> stopped)", before="(state driving")
    assert not rover.found()
    rover.session.run(0.2)
    assert rover.is_active("stopped")
    assert rover.session.frame.restarts == 0


def test_the_zigzag_turns_at_once_when_its_time_is_over_already():
    zigzag = Typist("02-time-is-a-condition")
    zigzag.session.run(1)
    assert zigzag.is_active("straight")
    zigzag.type("500", instead_of="2000")
    zigzag.session.run(0.2)
    assert zigzag.is_active("corner")
    zigzag.type("[1000 * 3.14 / 2]", instead_of="2100")
    assert not zigzag.found()
    zigzag.session.run(1.4)
    assert zigzag.is_active("corner")
    zigzag.session.run(0.3)
    assert zigzag.is_active("straight")
    assert zigzag.session.frame.restarts == 0


def test_the_eyes_see_differently_with_another_threshold():
    eyes = Typist("03-what-the-robot-sees")
    eyes.session.run(10, until="waiting")
    before = eyes.x
    eyes.type("250", instead_of="138")
    eyes.session.call(lambda: eyes.session.bridge.reset_world())
    assert eyes.session.run(1, until="driving")
    assert eyes.session.run(10, until="waiting")
    assert eyes.x > before
    eyes.type("(state shy (onentry [robot.stop()]))", before="(on white")
    eyes.type("(on [robot.distance.data < 0.3] *-> shy)", before="(on white")
    eyes.session.call(lambda: eyes.session.bridge.place_robot((2.5, 0.5, 0)))
    assert eyes.session.run(2, until="shy")
    eyes.session.run(2)
    assert eyes.is_active("shy")


def test_what_the_eyes_saw_becomes_a_variable():
    eyes = Typist("03-what-the-robot-sees")
    eyes.type("(var seen := [0])", before="(var forward")
    eyes.type("[seen = robot.light.data]", before="[robot.move")
    eyes.session.run(0.3)
    assert eyes.session.frame.variables["seen",] == "0"
    eyes.session.run(10)
    assert int(eyes.session.frame.variables["seen",]) > 0, "the edge of the line"
