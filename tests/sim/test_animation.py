"""The animated picture of a run shows what was recorded, at every time."""

import math
import random
from dataclasses import replace
from itertools import pairwise
from xml.etree import ElementTree

import pytest
from support.seeds import seeds
from support.smil import SVG, evaluate, placed

from lrp_jupyter.sim import PutSolid, PutZone, RemoveSolid, Say, Simulation, World, load
from lrp_jupyter.sim.animation import EVERY, TURNED, WITHIN, animated
from lrp_jupyter.sim.simulation import WorldMoment
from lrp_jupyter.sim.svg_shapes import BUMP, robot_colour
from lrp_jupyter.sim.world import BoxSolid, CircleZone, DiscSolid, Patrol, RobotSpec

BOX, CART, WALL = "#d9a566", "#8fc7c3", "#646d77"
JUST_AFTER = 0.002  # s: times of key frames are rounded
BODY = robot_colour(0)[0]


def yard():
    """A small world with something of every kind, and a robot."""
    return World(
        (1.6, 1.3),
        (RobotSpec((0.3, 0.6, 0), light=((0.06, 0.02), (0.06, -0.02))),),
        solids=(
            BoxSolid((0.8, 0.6, 0.15, 0.15), push=0.2),
            BoxSolid((1.3, 0.2, 0.1, 0.1), patrol=Patrol(((0, 0.9), (-0.4, 0.9)), 0.3, closed=True)),
            DiscSolid((0.2, 1.1, 0.08)),
        ),
    )


def drive_about(simulation, seed, seconds):
    """Drive, and return what was where at every sampled time."""
    dice, recorded = random.Random(seed), {}
    for step in range(seconds * 100):
        if step % 10 == 0:
            simulation.latch()
            if step % 50 == 0:
                simulation.drive(dice.uniform(-0.1, 0.4), dice.uniform(-2, 2))
        if step % EVERY == 0:
            recorded[step / 100] = (simulation.robot.pose, [thing.pose for thing in simulation.solids])
        simulation.step()
    return recorded


def of_all(simulation, first=WorldMoment(0, 0)):  # noqa: B008
    return animated(simulation.repeated(first, simulation.moment, EVERY))


def assert_at(found, pose):
    ((x, y, angle, _),) = found
    assert math.dist((x, y), pose[:2]) <= WITHIN
    turned = (angle - pose[2] + math.pi) % (2 * math.pi) - math.pi
    assert abs(turned) <= math.radians(TURNED)


@pytest.mark.parametrize("seed", seeds(1, 8))
def test_everything_is_where_it_was_at_every_time(seed):
    simulation = Simulation(yard())
    recorded = drive_about(simulation, seed, 15)  # over a checkpoint
    picture = of_all(simulation)
    for time, (robot, (box, cart, pillar)) in recorded.items():
        root = evaluate(picture, time)
        assert_at(placed(root, BODY), robot)
        assert_at(placed(root, BOX), box)
        assert_at(placed(root, CART), cart)
        assert_at(placed(root, WALL), pillar)
    assert_at(placed(evaluate(picture, 15.0 + 1.0 + 3.0), BODY), recorded[3.0][0])  # it begins again


@pytest.mark.slow
def test_it_is_small_and_contains_nothing_but_text():
    simulation = Simulation(yard())
    drive_about(simulation, 1, 60)
    picture = of_all(simulation)
    ElementTree.fromstring(picture)
    assert len(picture) < 60_000
    assert "href" not in picture
    assert "script" not in picture
    still = Simulation("empty")
    still.step(6000)
    assert len(of_all(still)) < 3000, "what does not move has no key frames"


def test_the_trail_grows_with_the_robot():
    simulation = Simulation("empty")
    recorded = {}
    for turn in (0.0, 1.0, -0.7):
        simulation.drive(0.2, turn)
        for _ in range(20):
            recorded[simulation.time] = simulation.robot.pose
            simulation.step(10)
    picture = of_all(simulation)
    for time, (x, y, _) in recorded.items():
        (line,) = [each for each in evaluate(picture, time).iter(f"{SVG}path") if each.get("stroke-opacity")]
        points = [tuple(map(float, each.split())) for each in line.get("d")[1:].split("L")]
        drawn = float(line.get("stroke-dasharray").split()[0]) - float(line.get("stroke-dashoffset"))
        for one, other in pairwise(points):
            length = math.dist(one, other)
            if drawn <= length:
                end = [a + (b - a) * drawn / length for a, b in zip(one, other, strict=True)]
                break
            drawn -= length
        else:
            end = points[-1]
        assert math.dist(end, (x, y)) < 2 * WITHIN


def test_the_bumper_is_lit_while_something_presses_it():
    simulation = Simulation(
        World((2, 1), (RobotSpec((1, 0.5, 0)),), solids=(BoxSolid((1.25, 0.5, 0.1, 0.3)),))
    )
    pressed = {}
    for step in range(300):
        if step % EVERY == 0:
            simulation.drive(0.2 if step < 150 else -0.2)
            pressed[step / 100] = simulation.robot.memory.pressed_at > max(-1, step - EVERY)
        simulation.step()
    picture = of_all(simulation)
    bars = {
        time: [each.get("stroke") for each in evaluate(picture, time + JUST_AFTER).iter(f"{SVG}path")]
        for time in pressed
    }
    assert {time: BUMP[0] in strokes for time, strokes in bars.items()} == pressed
    assert 10 < sum(pressed.values()) < 50


def test_rays_end_where_something_was_seen_and_are_hidden_where_nothing_was():
    simulation = Simulation(World((3, 2), (RobotSpec((1, 1, 0), distance=((0, 1.0),)),)))
    ways = {}
    simulation.drive(0.0, 1.0)
    for _ in range(100):
        simulation.latch()
        ways[simulation.time] = simulation.robot.readings.distances[0]
        simulation.step(10)
    picture = of_all(simulation)
    assert any(map(math.isinf, ways.values()))
    assert not all(map(math.isinf, ways.values()))
    for time, way in ways.items():
        dots = placed(evaluate(picture, time + JUST_AFTER), "#E31A1C")
        assert len(dots) == math.isfinite(way)
        for *_, dot in dots:
            assert float(dot.get("cx")) == pytest.approx(0.08 + way, abs=0.02)


def test_light_sensors_show_what_they_saw():
    simulation = Simulation("line")
    simulation.place((1.0, 0.3, math.pi / 2))
    simulation.drive(0.1)
    greys = {}
    for _ in range(40):
        simulation.latch()
        greys[simulation.time] = simulation.robot.readings.lights[0]
        simulation.step(10)
    assert {0, 255} <= set(greys.values())
    picture = of_all(simulation)
    for time, grey in greys.items():
        (spot,) = [
            each
            for each in evaluate(picture, time + JUST_AFTER).iter(f"{SVG}circle")
            if each.get("stroke") == "#FF7F00"
        ]
        assert abs(int(spot.get("fill")[1:3], 16) - grey) <= 12


def test_what_is_put_elsewhere_jumps():
    simulation = Simulation(yard())
    simulation.step(100)
    simulation.place((1.2, 1.0, 2.0))
    simulation.place_solid(2, (0.5, 0.2, 0))
    simulation.step(100)
    picture = of_all(simulation)
    assert_at(placed(evaluate(picture, 0.99), BODY), (0.3, 0.6, 0))
    assert_at(placed(evaluate(picture, 1.01), BODY), (1.2, 1.0, 2.0))
    assert_at(placed(evaluate(picture, 0.99), WALL), (0.2, 1.1, 0))
    assert_at(placed(evaluate(picture, 1.01), WALL), (0.5, 0.2, 0))
    lines = [
        each for each in ElementTree.fromstring(picture).iter(f"{SVG}path") if each.get("stroke-opacity")
    ]
    assert lines == [], "it has not driven there"


def test_what_is_added_drawn_and_removed_comes_and_goes():
    simulation = Simulation(yard())
    simulation.step(100)
    simulation.apply(PutSolid(DiscSolid((1.4, 1.1, 0.05))))
    simulation.apply(PutZone("goal", CircleZone((0.2, 0.2, 0.1))))
    simulation.draw(((0.1, 0.1), (0.4, 0.1)))
    simulation.step(100)
    simulation.apply(RemoveSolid(2))
    simulation.step(100)
    picture = of_all(simulation)
    assert [len(placed(evaluate(picture, time), WALL)) for time in (0.5, 1.5, 2.5)] == [1, 2, 1]
    assert [len(placed(evaluate(picture, time), "#33A02C")) for time in (0.5, 1.5, 2.5)] == [0, 1, 1]
    ((x, y, _, _),) = placed(evaluate(picture, 2.5), WALL)
    assert (x, y) == (1.4, 1.1)


def test_ink_appears_as_it_was_drawn_and_goes_with_a_reset():
    simulation = Simulation("empty")
    simulation.pen()
    simulation.drive(0.2)
    simulation.step(200)
    simulation.reset()
    simulation.step(100)
    picture = of_all(simulation)

    def ink(time):
        root = evaluate(picture, time)
        hidden = [
            each for group in root.iter() if group.get("visibility") == "hidden" for each in group.iter()
        ]
        (line,) = [each for each in root.iter(f"{SVG}path") if "darken" in each.get("style", "")]
        if line in hidden:
            return None
        return float(line.get("stroke-dasharray").split()[0]) - float(line.get("stroke-dashoffset"))

    assert ink(0.02) == pytest.approx(0.0, abs=0.01)
    assert ink(1.0) == pytest.approx(0.2, abs=0.01)
    assert ink(1.9) == pytest.approx(0.38, abs=0.01)
    assert ink(2.5) is None


def test_what_the_robot_says_is_there_while_it_says_it():
    simulation = Simulation("empty")
    simulation.drive(0.2)
    for text in ("Hello", "Bye"):
        simulation.step(100)
        simulation.apply(Say(text))
    simulation.step(200)
    picture = of_all(simulation)

    def said(time):
        root = evaluate(picture, time)
        hidden = [
            each for group in root.iter() if group.get("visibility") == "hidden" for each in group.iter()
        ]
        return [each.text for each in root.iter(f"{SVG}text") if each.get("x") == "0" and each not in hidden]

    assert [said(time) for time in (0.9, 1.1, 1.9, 2.1, 3.0, 3.9)] == [
        [], ["Hello"], ["Hello"], ["Bye"], ["Bye"], []
    ]  # fmt: skip


def test_what_the_robot_says_covers_the_names_of_zones():
    simulation = Simulation("line")
    simulation.apply(Say("Hello"))
    simulation.step(100)
    picture = of_all(simulation)
    assert picture.index(">near<") < picture.index(">Hello<")


def test_a_part_of_a_run_begins_with_what_was_there():
    simulation = Simulation("empty")
    simulation.pen()
    simulation.drive(0.2)
    simulation.step(200)
    simulation.drive()
    simulation.step(50)
    moment, pose = simulation.moment, simulation.robot.pose
    simulation.drive(0.0, 1.0)
    simulation.step(100)
    picture = of_all(simulation, moment)
    assert "2.5 to 3.5 s" in picture
    assert_at(placed(evaluate(picture, 0.0), BODY), pose)
    (line,) = [
        each
        for each in ElementTree.fromstring(picture).iter(f"{SVG}path")
        if "darken" in each.get("style", "")
    ]
    assert line.get("stroke-dasharray") is None, "the ink from before is there from the beginning"


def test_the_run_does_not_notice():
    simulation, other = Simulation(load("boxes")), Simulation(load("boxes"))
    for each in (simulation, other):
        each.drive(0.3)
        each.step(250)
    of_all(simulation)
    for each in (simulation, other):
        each.step(250)
    assert simulation.robot.pose == other.robot.pose
    assert simulation.moment == other.moment


def test_names_are_escaped():
    ElementTree.fromstring(of_all(Simulation(replace(yard(), name='<a href="x">&'))))
