from xml.etree import ElementTree

from support.tables import every

from lrp_jupyter.sim import BUNDLED, Say, Simulation, World, load
from lrp_jupyter.sim.sketch import sketch
from lrp_jupyter.sim.svg import svg
from lrp_jupyter.sim.world import BoxSolid, DiscSolid, FloorSpec, PathStroke, RobotSpec

SVG = "{http://www.w3.org/2000/svg}"


@every("name", BUNDLED)
def test_every_world_has_a_self_contained_picture(name):
    picture = svg(load(name))
    root = ElementTree.fromstring(picture)
    assert root.tag == f"{SVG}svg"
    assert "href" not in picture
    assert len(picture) < 10_000


def test_the_picture_describes_the_world_in_words():
    simulation = Simulation("line")
    simulation.step(150)
    simulation.latch()
    root = ElementTree.fromstring(svg(simulation))
    assert root.get("aria-label").startswith(
        "World line at 1.5 s: robot at 0.70, 0.50 m, heading 0°; light 0"
    )
    texts = ["".join(text.itertext()) for text in root.iter(f"{SVG}text")]
    assert "line · 1.5 slight 0 · bumper free · distance ∞ m" in [text.replace("\n", "") for text in texts]
    assert "0" in texts  # the light's value, beside its spot


def test_a_pressed_bumper_is_lit():
    simulation = Simulation(
        World((2, 1), (RobotSpec((1, 0.5, 0)),), solids=(BoxSolid((1.15, 0.5, 0.1, 0.3)),))
    )
    assert 'stroke="#E31A1C" stroke-width="0.02"' not in svg(simulation)
    simulation.drive(0.2)
    simulation.step(30)
    simulation.latch()
    assert 'stroke="#E31A1C" stroke-width="0.02"' in svg(simulation)


def test_a_lit_lamp_is_drawn_and_said():
    simulation = Simulation("empty")
    assert "lamp" not in svg(simulation)
    simulation.lamp()
    picture = svg(simulation)
    assert "the lamp is lit" in picture
    assert "lamp lit" in ElementTree.fromstring(picture).attrib["aria-label"]


def test_what_a_robot_says_is_in_a_bubble_within_the_world_and_in_the_words():
    simulation = Simulation("empty")
    simulation.place((0.1, 1.9, 2.0))
    assert "says" not in svg(simulation)
    simulation.apply(Say("Tea & <cake>, and whatever else there is on this long and ample table"))
    root = ElementTree.fromstring(svg(simulation, 300))
    assert "says “Tea & <cake>, and" in root.attrib["aria-label"]
    lines = [text.text for text in root.iter(f"{SVG}text") if text.get("text-anchor") is None]
    assert lines[:4] == ["Tea & <cake>, and", "whatever else there is", "on this long and ample", "table"]
    rect = next(rect for rect in root.iter(f"{SVG}rect") if rect.get("rx") == "5")
    left, top = float(rect.get("x")) * 0.008 + 0.1, 1.9 - float(rect.get("y")) * 0.008
    assert left >= -1e-3
    assert 1 < top < 1.9 - simulation.robot.spec.radius


def test_trails_and_drawings_are_joined_paths():
    simulation = Simulation("empty")
    before = svg(simulation).count("<path")
    simulation.draw(((0.1, 0.1), (0.2, 0.1), (0.2, 0.2)))
    simulation.draw(((0.5, 0.5),))
    simulation.pen()
    simulation.drive(0.2)
    simulation.step(100)
    picture = svg(simulation)
    assert "M0.1 0.1L0.2 0.1L0.2 0.2" in picture
    assert picture.count("mix-blend-mode:darken") == 1
    assert picture.count("<path") == before + 4  # two drawings, the trail, and where it has been


def test_ways_of_other_runs_are_drawn_and_named():
    simulation = Simulation("empty")
    simulation.drive(0.2)
    simulation.step(100)
    way = [(0.1 + 0.001 * step, 0.5) for step in range(1000)]
    root = ElementTree.fromstring(svg(simulation, ways={"fast & wide": way, "slow": way[:10], "none": []}))
    titles = [title.text for title in root.iter(f"{SVG}title")]
    assert titles == ["fast & wide", "slow"]
    assert {"fast & wide", "slow"} <= {text.text for text in root.iter(f"{SVG}text")}
    drawn = [group for group in root.iter(f"{SVG}g") if group.find(f"{SVG}title") is not None]
    shapes = [group.find(f"{SVG}path") for group in drawn]
    assert len({(shape.get("stroke"), shape.get("stroke-dasharray")) for shape in shapes}) == 2
    assert shapes[0].get("d").endswith("L1.099 0.5"), "up to its end"
    assert len(shapes[0].get("d")) < 6000


def test_names_are_escaped():
    world = World((1, 1), (RobotSpec((0.5, 0.5, 0)),), name='<a href="x">&')
    ElementTree.fromstring(svg(world))


def test_a_picture_can_do_without_caption():
    assert 'lrp-world-text" x' not in svg(load("oval"), caption=False)


def test_a_sketch_shows_line_walls_boxes_and_heading():
    floor = FloorSpec(strokes=(PathStroke(((0, 0.75), (2, 0.75))),))
    solids = (BoxSolid((0.1, 0.3, 0.2, 0.2)), DiscSolid((1.75, 0.3, 0.1), push=0.3))
    world = World((2, 1), (RobotSpec((1.05, 0.3, 1.6)),), floor, solids)
    assert sketch(world, 20) == [
        "                    ",
        "····················",
        "                    ",
        "##        ↑     ▒▒▒ ",
        "                    ",
    ]


def test_a_pressed_bumper_is_a_star_in_the_sketch():
    simulation = Simulation(
        World((2, 1), (RobotSpec((1, 0.5, 0)),), solids=(BoxSolid((1.15, 0.5, 0.1, 0.3)),))
    )
    simulation.drive(0.2)
    simulation.step(30)
    simulation.latch()
    assert "*" in "".join(sketch(simulation))


def test_a_drawn_line_appears_in_the_sketch():
    simulation = Simulation("empty")
    assert "·" not in "".join(sketch(simulation))
    simulation.draw(((0, 0.2), (3, 0.2)))
    assert "·" * 60 in sketch(simulation)


def test_a_robot_outside_an_open_world_is_not_in_the_sketch():
    simulation = Simulation(World((1, 1), (RobotSpec((0.5, 0.5, 0)),), open=True))
    simulation.drive(0.5)
    simulation.step(300)
    assert not any(row.strip() for row in sketch(simulation, 10))
