import json
import re
from collections import Counter
from itertools import chain, combinations, pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.settings import with_settings
from support.tables import every

from lrp_jupyter import programs
from lrp_jupyter.graph import labels as labels_module
from lrp_jupyter.graph.arrangement import LEGIBLE, PASSED, is_dense, layers, order
from lrp_jupyter.graph.geometry import Cells, Rect
from lrp_jupyter.graph.labels import POINTS, place_labels
from lrp_jupyter.graph.layout import layout
from lrp_jupyter.graph.routes import SAMPLES, arc, bends, detour, obstacles, straight
from lrp_jupyter.graph.state_graph import find_machine
from lrp_jupyter.graph.state_places import RESERVED
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Transition

THREE = "(machine m (event e [True]) (state a) (state b) (state c) {more}) (spawn m a)"


def lay(text, previous=None, **options):
    program = parse(text)
    return layout(program.machines[0], previous, program=program, **options)


@pytest.fixture
def drawings(drawn):
    return list(chain.from_iterable(drawn.values()))


def box(shape, grow=0.0):
    return Rect(shape["x"], shape["y"], shape["width"] + grow, shape["height"] + grow)


def positions(drawing):
    return {shape["name"]: (shape["x"], shape["y"]) for shape in drawing["states"]}


def shape_of(drawing, name):
    return next(shape for shape in drawing["states"] if shape["name"] == name)


def numbers(d):
    return [float(word) for word in re.findall(r"-?\d+(?:\.\d+)?", d)]


# -- what a picture must be --------------------------------------------------------------------------


def test_no_two_states_overlap(drawings):
    for drawing in drawings:
        boxes = [box(shape) for shape in drawing["states"]]
        assert not [(a, b) for i, a in enumerate(boxes) for b in boxes[:i] if a.overlaps(b, 10.0, 10.0)]


def test_no_label_covers_a_state_or_another_label(drawings):
    for drawing in drawings:
        labels = [box(shape["label"]) for shape in drawing["transitions"]]
        solid = [box(shape) for shape in drawing["states"]]
        assert not [(a, b) for a in labels for b in solid if a.overlaps(b)]
        assert not [(a, b) for i, a in enumerate(labels) for b in labels[:i] if a.overlaps(b)]


def test_arrows_begin_and_end_at_the_borders_of_their_states(drawings):
    for drawing in drawings:
        shapes = {shape["name"]: shape for shape in drawing["states"]}
        for arrow in drawing["transitions"]:
            start = numbers(arrow["d"])[:2]
            assert _on_border(start, shapes[arrow["source"]])
            if arrow["head"] and (arrow["lands"] or arrow["kind"] != "exit"):
                assert _on_border(numbers(arrow["head"])[:2], shapes[arrow["destination"]])


def _on_border(point, shape):
    return box(shape, 1.0).holds(point) and not box(shape, -1.0).holds(point)


def test_everything_is_inside_the_view(drawings):
    for drawing in drawings:
        left, top, width, height = drawing["view"]
        for shape in [*drawing["states"], *(arrow["label"] for arrow in drawing["transitions"])]:
            assert left <= shape["x"] - shape["width"] / 2
            assert shape["x"] + shape["width"] / 2 <= left + width
            assert top <= shape["y"] - shape["height"] / 2
            assert shape["y"] + shape["height"] / 2 <= top + height


def test_a_layout_is_plain_json_and_always_the_same(programs, drawn):
    for name, program in programs.items():
        again = [layout(machine, program=program, path=path) for path, machine in program.walk()]
        assert json.loads(json.dumps(drawn[name])) == drawn[name] == again


def runs_through_a_state(drawing):
    """Return the arrows that do, each with the state."""
    found = set()
    for arrow in drawing["transitions"]:
        leaves = arrow["kind"] == "exit" and not arrow["lands"]
        if arrow["source"] == arrow["destination"] or leaves or arrow["broken"]:
            continue
        x0, y0, cx, cy, x1, y1 = numbers(arrow["d"])
        for i in range(101):
            t = i / 100
            x = (1 - t) ** 2 * x0 + 2 * t * (1 - t) * cx + t * t * x1
            y = (1 - t) ** 2 * y0 + 2 * t * (1 - t) * cy + t * t * y1
            for shape in drawing["states"]:
                if shape["name"] not in (arrow["source"], arrow["destination"]) and box(shape).holds((x, y)):
                    found.add((arrow["name"], shape["name"]))
    return found


def test_in_the_small_programs_no_arrow_runs_through_a_state(drawn):
    for name in ("follower", "kinds", "long names", "figure 3", "one state"):
        for drawing in drawn[name]:
            assert not runs_through_a_state(drawing)


def ring(count):
    """Return a machine whose states follow each other, and the last is followed by the first."""
    states = " ".join(f"(state s{i})" for i in range(count))
    arrows = " ".join(f"(ontime 400 s{i} -> s{(i + 1) % count})" for i in range(count))
    return f"(machine m {states} {arrows}) (spawn m s0)"


@every("panel", [None, (300, 260), (390, 300), (600, 400), (300, 900), (1200, 300)])
@every("count", range(2, 14))
def test_the_arrow_that_closes_a_ring_passes_all_states_between(count, panel):
    assert not runs_through_a_state(lay(ring(count), panel=panel))


# -- the first arrangement ---------------------------------------------------------------------------


def test_the_start_state_is_on_top_and_the_fictional_state_at_the_left(drawn):
    drawing = drawn["follower"][0]
    places = positions(drawing)
    assert all(places["looking"][1] < y for name, (_, y) in places.items() if name not in ("looking", "*"))
    assert all(places["*"][0] < x for name, (x, _) in places.items() if name != "*")
    assert shape_of(drawing, "looking")["start"] is not None
    assert shape_of(drawing, "moving")["start"] is None


def test_layers_follow_the_longest_path():
    links = [("a", "b"), ("b", "c"), ("a", "c"), ("c", "a"), ("c", "d")]
    assert layers("abcd", links, ["a"]) == {"a": 0, "b": 1, "c": 2, "d": 3}


def test_nothing_leads_above_the_start_state():
    assert layers("ab", [("a", "b")], ["b"]) == {"a": 0, "b": 0}


def test_a_dense_machine_is_an_ellipse_in_the_order_of_the_text(drawn):
    drawing = drawn["figure 3"][0]
    assert is_dense([shape["name"] for shape in drawing["states"]], [("", "")] * 25)
    places = positions(drawing)
    assert places["one"][1] == min(y for _, y in places.values())
    assert places["two"][0] > 0 > places["five"][0]
    assert places["three"][0] > 0 > places["four"][0]


def test_opposite_arrows_are_22_px_apart_and_parallel_ones_26():
    a, b = Rect(0, 0, 64, 36), Rect(0, 200, 64, 36)
    there, back = bends(2, 1)
    middles = [arc(a, b, bend).points[SAMPLES // 2] for bend in there]
    middles += [arc(b, a, bend).points[SAMPLES // 2] for bend in back]
    assert [round(x) for x, _ in middles] == [-11, -37, 11]
    assert bends(3, 0) == ([-26.0, 0.0, 26.0], [])


def test_arrows_between_the_same_states_pass_what_is_between_them_together():
    a, b, between = Rect(0, 0, 64, 36), Rect(0, 300, 64, 36), Rect(0, 150, 80, 36)
    there, back = bends(1, 1)
    around = detour(a, b, [there[0], -back[0]], obstacles([a, b, between]))
    ways = [arc(a, b, there[0], around), arc(b, a, back[0], -around)]
    assert not [point for way in ways for point in way.points if between.holds(point, 2.0)]
    assert abs(ways[0].points[SAMPLES // 2][0] - ways[1].points[SAMPLES // 2][0]) == pytest.approx(22, abs=1)


def test_states_are_in_the_middle_whatever_is_beside_them():
    places = positions(lay(THREE.format(more="(on e a -> b)")))
    assert places["a"][0] == pytest.approx(places["b"][0], abs=1)
    assert abs(places["a"][0] - places["c"][0]) < 200


def test_loops_are_on_top_side_by_side_each_with_its_label_outside(drawn):
    drawing = drawn["kinds"][0]
    state = shape_of(drawing, "drive")
    loops = [arrow for arrow in drawing["transitions"] if arrow["source"] == arrow["destination"]]
    assert all(max(numbers(arrow["d"])[1::2]) <= state["y"] - state["height"] / 2 for arrow in loops)
    left, right = loops
    assert numbers(left["d"])[-2] < numbers(right["d"])[0]  # the second begins where the first has ended
    assert left["label"]["x"] < state["x"] < right["label"]["x"]


# -- the panel that shows it -------------------------------------------------------------------------

PANELS = [(420.0, 220.0), (900.0, 300.0), (400.0, 700.0)]


def shown_at(drawing, panel):
    """Return the scale at which all of a drawing is in view."""
    return min(1.0, panel[0] / drawing["view"][2], panel[1] / drawing["view"][3])


@every("panel", PANELS)
def test_a_layout_fits_into_the_panel_at_least_as_well_as_without_knowing_it(programs, panel):
    for program in programs.values():
        for path, machine in program.walk():
            plain = layout(machine, program=program, path=path)
            fitting = layout(machine, program=program, path=path, panel=panel)
            assert shown_at(fitting, panel) >= 0.9 * shown_at(plain, panel)
            boxes = [box(shape) for shape in fitting["states"]]
            assert not [(a, b) for i, a in enumerate(boxes) for b in boxes[:i] if a.overlaps(b, 10.0, 10.0)]


def test_a_chain_runs_to_the_right_in_a_wide_panel_and_down_in_a_tall_one():
    text = THREE.format(more="(on e a -> b) (on e b -> c)")
    wide, tall = (positions(lay(text, panel=panel)) for panel in ((900, 200), (300, 700)))
    assert wide["a"][0] < wide["b"][0] < wide["c"][0]
    assert wide["a"][1] == wide["b"][1] == wide["c"][1]
    assert tall["a"][1] < tall["b"][1] < tall["c"][1]


def test_a_new_state_is_placed_beside_the_others_in_a_wide_panel_and_below_them_in_a_tall_one():
    before = lay("(machine m (state a)) (spawn m a)")
    after = "(machine m (state a) (state b) (eps a -> b)) (spawn m a)"
    wide, tall = (positions(lay(after, before, panel=panel)) for panel in ((900, 200), (200, 900)))
    assert wide["b"][1] == wide["a"][1]
    assert tall["b"][0] == tall["a"][0]


# -- machines inside states --------------------------------------------------------------------------


def nested(program):
    """Return layouts by path, inner ones inside the states of outer ones."""
    done = {}
    for path, machine in reversed(list(program.walk())):
        done["/".join(path)] = layout(machine, program=program, path=path, inside=done)
    return done


@every("name", ["follower", "kinds"])
def test_a_nested_machine_has_room_inside_its_state_and_the_states_around_it_keep_apart(programs, name):
    drawn = nested(programs[name])
    outer = drawn[name]
    for shape in outer["states"]:
        for inside in shape["inside"]:
            left, top, width, height = drawn[inside["machine"]]["view"]
            room = Rect(shape["x"], shape["y"], shape["width"] + 0.2, shape["height"] + 0.2)
            x, y = shape["x"] + inside["x"], shape["y"] + inside["y"]
            assert room.holds((x + left, y + top))
            assert room.holds((x + left + width, y + top + height))
    assert any(shape["inside"] for shape in outer["states"])
    boxes = [box(shape) for shape in outer["states"]]
    assert not [(a, b) for a, b in combinations(boxes, 2) if a.overlaps(b, 10.0, 10.0)]
    shapes = {shape["name"]: shape for shape in outer["states"]}
    for arrow in outer["transitions"]:
        if arrow["head"] and arrow["kind"] != "exit":
            assert _on_border(numbers(arrow["head"])[:2], shapes[arrow["destination"]])


def test_a_state_that_grows_moves_its_neighbours_out_of_itself():
    text = "(machine m (state a (machine i {})) (state b) (eps a -> b)) (spawn m a)"
    small, large = (
        parse(text.format(states)) for states in ("(state x)", "(state x) (state y) (eps x -> y)")
    )
    before = nested(small)
    inner = layout(
        large.machines[0].states[0].machines[0], before["m/a/i"], program=large, path=("m", "a", "i")
    )
    after = layout(large.machines[0], before["m"], program=large, inside={"m/a/i": inner})
    a, b = (box(shape_of(after, name)) for name in "ab")
    assert a.height > box(shape_of(before["m"], "a")).height
    assert not a.overlaps(b, 10.0, 10.0)


# -- names and reasons -------------------------------------------------------------------------------


def test_ids_are_paths_of_states_and_ids_of_transitions(drawn):
    outer, inner = drawn["follower"]
    assert [shape["id"] for shape in outer["states"]][:3] == [
        "follower/*",
        "follower/moving",
        "follower/looking",
    ]
    assert outer["transitions"][0]["id"] == "follower:tlooking"
    assert outer["transitions"][2]["id"] == "follower:on:*->bumpback"
    assert outer["transitions"][2]["name"] == "bumping:*->bumpback"
    assert inner["transitions"][0]["id"] == "follower/looking/lookalgo:treturnleft"


def test_a_transition_with_several_sources_has_several_arrows_of_one_id(drawn):
    arrows = [arrow for arrow in drawn["kinds"][0]["transitions"] if arrow["label"]["text"] == "panic"]
    assert [arrow["source"] for arrow in arrows] == ["drive", "check"]
    assert len({arrow["id"] for arrow in arrows}) == 1


def test_a_wildcard_with_exceptions_shows_them(drawn):
    texts = {arrow["label"]["text"] for arrow in drawn["kinds"][0]["transitions"]}
    assert "panic (not docking)" in texts


def test_long_names_are_cut_in_the_middle_and_complete_in_the_title(drawn):
    (drawing,) = drawn["long names"]
    shape = drawing["states"][1]
    assert re.fullmatch(r"approach\w*…\w*the_left", shape["label"])
    assert shape["title"] == "approaching_the_charging_station_from_the_left"
    assert all(shape["width"] < 190 for shape in drawing["states"])
    assert re.fullmatch(r"\[robot.*….*lim \+ 10\]", drawing["transitions"][0]["label"]["text"])
    assert "robot.light.data > lightlim + 10" in drawing["transitions"][0]["title"]


def test_a_nested_machine_is_named_in_its_state(drawn):
    shape = shape_of(drawn["follower"][0], "looking")
    assert shape["machines"] == ["lookalgo"]
    assert shape["nested"] == "lookalgo"


def test_a_dangling_transition_is_broken_with_its_reason(drawn):
    arrows = {arrow["label"]["text"]: arrow for arrow in drawn["kinds"][0]["transitions"]}
    assert arrows["go"]["broken"] == "There is no state `nowhere`."
    assert arrows["nosuch"]["broken"] == "There is no event `nosuch`."
    assert arrows["go"]["mark"]
    assert not arrows["go"]["head"]
    assert arrows["hit"]["broken"] is None


def test_an_exit_ends_in_a_port_on_the_frame(drawn):
    drawing = drawn["kinds"][1]
    left, _, width, _ = drawing["frame"]
    assert [port["name"] for port in drawing["ports"]] == ["drive", "drive", "nowhere"]
    assert {port["x"] for port in drawing["ports"]} == {round(left + width, 1)}
    assert [port["missing"] for port in drawing["ports"]] == [False, False, True]


# -- machines that are left by an exit, or spawned elsewhere than where they are defined ----------------


def landed(drawing):
    return {
        (arrow["source"], arrow["destination"]): arrow["label"]["text"]
        for arrow in drawing["transitions"]
        if arrow["lands"]
    }


def test_an_exit_is_an_arrow_of_the_machine_in_which_it_lands(drawn):
    outer, inner = drawn["kinds"]
    assert landed(outer) == {
        ("docking", "drive"): "[robot.charged]\n(from locked)",
        ("docking", "nowhere"): "near\n(from approach)",
    }
    (arrow,) = [arrow for arrow in outer["transitions"] if arrow["name"] == "giveup"]
    (begin,) = [arrow for arrow in inner["transitions"] if arrow["name"] == "giveup"]
    assert arrow["id"] == begin["id"] == "kinds/docking/dock:giveup"
    assert arrow["title"] == "(exit near align -> drive giveup) of kinds/docking/dock"
    assert (begin["lands"], begin["source"], arrow["source"]) == (False, "align", "docking")
    broken = {arrow["destination"]: arrow["broken"] for arrow in outer["transitions"] if arrow["lands"]}
    assert broken == {"drive": None, "nowhere": "There is no state `nowhere`."}


def test_an_exit_lands_once_for_each_state_that_spawns_its_machine(drawn):
    patrol, move = drawn["shared"]
    texts = Counter(
        (arrow["source"], arrow["label"]["text"]) for arrow in patrol["transitions"] if arrow["lands"]
    )
    assert texts == dict.fromkeys(
        (
            ("left", "found\n(from go)"),
            ("left", "near\n(from turn)"),
            ("right", "found\n(from go)"),
            ("right", "near\n(from turn)"),
        ),
        1,
    )
    assert not landed(move)


@every("name", ["exit", "box-pusher"])
def test_the_pictures_of_the_programs_with_an_exit_are_connected(name):
    program = parse(programs.load(name))
    drawing = layout(program.machines[0], program=program)
    reached, links = {drawing["states"][0]["name"]}, drawing["transitions"]
    for _ in links:
        reached |= {arrow["destination"] for arrow in links if arrow["source"] in reached}
        reached |= {arrow["source"] for arrow in links if arrow["destination"] in reached}
    assert reached == {shape["name"] for shape in drawing["states"]}


@every("panel", [None, (560, 330)])
def test_the_label_of_an_exit_is_nearer_to_its_arrow_than_to_others(panel):
    program = parse(programs.load("exit"))
    drawing = layout(program.machines[0], program=program, panel=panel)
    middles = {}
    for arrow in drawing["transitions"]:
        x0, y0, cx, cy, x1, y1 = numbers(arrow["d"])
        middles[arrow["name"]] = [
            (
                (1 - t) ** 2 * x0 + 2 * t * (1 - t) * cx + t * t * x1,
                (1 - t) ** 2 * y0 + 2 * t * (1 - t) * cy + t * t * y1,
            )
            for t in (i / 20 for i in range(21))
        ]
    for arrow in drawing["transitions"]:
        label = box(arrow["label"])

        def away(points, label=label):
            return min(
                max(abs(x - label.x) - label.width / 2, 0.0) + max(abs(y - label.y) - label.height / 2, 0.0)
                for x, y in points
            )

        if arrow["lands"]:
            assert min(middles, key=lambda name: away(middles[name])) == arrow["name"]


def test_a_landing_whose_end_is_being_typed_moves_nothing():
    inner = "(machine i (state x) (exit [True] x -> {}))"
    text = f"(machine m (state a {inner} (onentry (spawn i x))) (state b)) (spawn m a)"
    before = lay(text.format("som"))
    after = lay(text.format("some"), before)
    assert positions(after)["some"] == positions(before)["som"]


def test_a_state_shows_what_it_spawns_from_elsewhere(drawn):
    patrol, _ = drawn["shared"]
    left = shape_of(patrol, "left")
    (line,) = left["spawns"]
    assert (line["machine"], line["name"], line["settings"]) == ("move", "move", "")
    assert left["title"] == "left, spawns move"
    assert (left["nested"], left["machines"], left["height"]) == ("", [], 52)
    assert -left["width"] / 2 < line["x"] < 0 < line["y"] < left["height"] / 2
    assert shape_of(drawn["follower"][0], "looking")["spawns"] == []


def test_a_state_shows_the_values_that_it_gives_to_the_variables_of_a_machine(programs):
    text = "(machine m (state a (machine i (state x)) (onentry (spawn i x)))) (spawn m a)"
    for program, shown in ((programs["shared"], "move"), (parse(text), "i")):
        program = with_settings(
            program, shown, side=" -1 ", keep="[robot.distance.data,\n robot.light.data, 0.25]"
        )
        machine = program.machines[0]
        shape = layout(machine, program=program)["states"][0]
        assert shape["width"] < 260
        if shape["spawns"]:
            assert shape["spawns"][0]["settings"].startswith("side \N{MINUS SIGN}1, kee")
            assert "…" in shape["spawns"][0]["settings"]
            assert (
                "(side \N{MINUS SIGN}1, keep [robot.distance.data, robot.light.data, 0.25])" in shape["title"]
            )
        else:
            assert shape["nested"].startswith("i side \N{MINUS SIGN}1")


def test_an_open_state_has_room_for_what_it_spawns_from_elsewhere():
    program = parse(
        "(machine m (state a (machine i (state x)) (onentry (spawn i x) (spawn j y))) (state b) (eps a -> b))"
        "(machine j (state y)) (spawn m a)"
    )
    inside = {"m/a/i": layout(find_machine(program, "m/a/i"), program=program, path=("m", "a", "i"))}
    without = parse(
        "(machine m (state a (machine i (state x)) (onentry (spawn i x))) (state b) (eps a -> b)) (spawn m a)"
    )
    shape, plain = (
        shape_of(layout(each.machines[0], program=each, inside=inside), "a") for each in (program, without)
    )
    (line,), (place,) = shape["spawns"], shape["inside"]
    _, top, _, height = inside["m/a/i"]["view"]
    assert shape["height"] == plain["height"] + 16
    assert place["y"] + top + height < line["y"] < shape["height"] / 2


def test_an_arrow_with_a_long_condition_has_the_name_of_its_transition(drawn):
    (arrow,) = (arrow for arrow in drawn["shared"][1]["transitions"] if arrow["name"] == "finished")
    assert arrow["label"]["text"] == "finished"
    assert "robot.light.data < 3" in arrow["title"]
    kept = lay("(machine m (state a) (on [x > 2] a -> a short))")
    assert kept["transitions"][0]["label"]["text"] == "[x > 2]"


def test_the_card_of_an_arrow_has_what_it_waits_for_and_its_effect():
    effect = "(effect [x = 1] [\n y = 2\n z = 3\n])"
    inner = "(machine move (state there))"
    text = f"(machine m (state a {inner}) (on move.there for 2000 a -> a {effect}) (eps a -> a))"
    full, plain = lay(text)["transitions"]
    assert full["title"] == "(on move.there for 2000 a -> a)\n/ [x = 1] [y = 2\nz = 3]"
    assert (full["watched"], plain["watched"]) == ("move", "")
    assert plain["title"] == "(eps a -> a)"


def test_the_sign_of_an_effect_stays_at_the_end_of_a_name(monkeypatch):
    monkeypatch.setattr(Transition, "arrow_text", f"[{'x > 2 and ' * 9}] /")
    named, plain = lay("(machine m (state a) (on e a -> a found) (on e a -> a))")["transitions"]
    assert named["label"]["text"] == "found /"
    assert re.fullmatch(r"\[x > .*….* /", plain["label"]["text"])


def test_without_its_program_a_machine_knows_of_no_missing_events(follower):
    drawing = layout(find_machine(follower, ("follower", "looking", "lookalgo")))
    assert drawing["machine"] == "lookalgo"
    assert not any(arrow["broken"] for arrow in drawing["transitions"])


# -- stable under edits ------------------------------------------------------------------------------


@every(
    "more",
    [
        "(on e c -> a)",
        "(on e *-> b)",
        "(state d)",
        "(state d) (on e d -> a) (eps b -> d)",
        "(state d (machine n (state x)))",
        "(eps a -> a) (on e a -> b) (on e b -> a)",
        "(on e a -> nowhere)",
    ],
)
def test_an_edit_leaves_every_state_where_it_is(more):
    before = lay(THREE.format(more="(on e a -> b) (on e b -> c)"))
    after = lay(THREE.format(more="(on e a -> b) (on e b -> c) " + more), before)
    assert positions(before).items() <= positions(after).items()
    boxes = [box(shape) for shape in after["states"]]
    assert not [(a, b) for i, a in enumerate(boxes) for b in boxes[:i] if a.overlaps(b, 10.0, 10.0)]


def test_a_new_state_is_placed_near_its_neighbour():
    text = (
        "(machine m " + " ".join(f"(state s{i}) (eps s{i} -> s{i + 1})" for i in range(8)) + "(state s8){})"
    )
    before = lay(text.format(""))
    after = lay(text.format("(state new) (eps new -> s8)"), before)
    x, y = positions(after)["new"]
    near = min(
        positions(before),
        key=lambda name: abs(positions(before)[name][0] - x) + abs(positions(before)[name][1] - y),
    )
    assert near == "s8"


def test_the_fictional_state_is_added_at_the_left():
    before = lay(THREE.format(more="(on e a -> b) (on e b -> c)"))
    after = lay(THREE.format(more="(on e a -> b) (on e b -> c) (on e *-> b)"), before)
    assert positions(after)["*"][0] < min(x for x, _ in positions(before).values())


def test_the_missing_end_keeps_its_place_when_its_state_appears():
    before = lay(THREE.format(more="(on e c -> d) (on e a -> b)"))
    after = lay(THREE.format(more="(on e c -> d) (on e a -> b) (state d)"), before)
    assert shape_of(before, "d")["kind"] == "missing"
    assert shape_of(after, "d")["kind"] == "state"
    assert positions(before) == positions(after)
    assert after["transitions"][0]["broken"] is None


def test_a_removed_state_finds_its_place_again_within_30_seconds():
    full = THREE.format(more="(on e a -> b) (on e b -> c)")
    fewer = "(machine m (event e [True]) (state a) (state c)) (spawn m a)"
    before = lay(full)
    gone = lay(fewer, before, now=10.0)
    assert "b" not in positions(gone)
    still_gone = lay(fewer, gone, now=10.0 + RESERVED - 1)
    assert positions(lay(full, still_gone, now=10.0 + RESERVED - 1)) == positions(before)
    forgotten = lay(fewer, still_gone, now=10.0 + RESERVED)
    assert "b" not in forgotten["places"]


def test_the_place_of_a_removed_state_is_not_reused():
    before = lay("(machine m (state a) (state b) (eps a -> b)) (spawn m a)")
    gone = lay("(machine m (state a)) (spawn m a)", before, now=1.0)
    after = lay(
        "(machine m (state a) (state c) (state d) (eps a -> c) (eps a -> d)) (spawn m a)", gone, now=2.0
    )
    assert not box(shape_of(after, "c")).overlaps(box(shape_of(before, "b")))
    assert not box(shape_of(after, "d")).overlaps(box(shape_of(before, "b")))


def test_typing_a_name_letter_by_letter_moves_nothing():
    text = "(machine m (state a) (state {}) (state c) (eps a -> b) (eps b -> c)) (spawn m a)"
    first = drawing = lay(text.format("b"))
    for name in ("bu", "bum", "bump", "bum", "bu", "b"):
        drawing = lay(text.format(name), drawing)
        assert positions(drawing)[name] == positions(first)["b"]
        assert positions(drawing)["a"] == positions(first)["a"]
        assert positions(drawing)["c"] == positions(first)["c"]
    assert positions(drawing) == positions(first)


@every("text", ["(eps a -> {})", "(eps {} -> a)", "(on e {{a {}}} -> b)"])
def test_typing_a_missing_end_letter_by_letter_moves_nothing(text):
    text = THREE.format(more="(eps c -> lost) " + text)
    first = drawing = lay(text.format("r"))
    for name in ("re", "res", "rest", "res", "resti"):
        drawing = lay(text.format(name), drawing)
        moved = {("r" if shown == name else shown): at for shown, at in positions(drawing).items()}
        assert moved == positions(first)
    assert set(drawing["places"]) == set(positions(drawing))  # nothing is reserved for half a word


def test_a_missing_end_that_another_arrow_has_already_stays():
    text = THREE.format(more="(eps c -> lost) (eps a -> {})")
    before = lay(text.format("los"))
    after = lay(text.format("lost"), before)
    assert positions(after)["lost"] == positions(before)["lost"]


def test_a_state_stays_where_it_was_dragged():
    text = THREE.format(more="(on e a -> b) (on e b -> c)")
    before = lay(text)
    dragged = lay(text, before, moved={"b": (400, -50)})
    assert positions(dragged) == {**positions(before), "b": (400.0, -50.0)}
    later = lay(THREE.format(more="(on e a -> b) (on e b -> c) (state d)"), dragged)
    assert positions(later)["b"] == (400.0, -50.0)


def test_a_state_to_come_has_the_place_that_was_reserved_for_it():
    text = THREE.format(more="{more}")
    before = lay(text.format(more=""))
    reserved = lay(text.format(more=""), before, moved={"d": (400, -50)}, now=10.0)
    assert positions(reserved) == positions(before)
    after = lay(text.format(more="(state d)"), reserved, now=11.0)
    assert positions(after) == {**positions(before), "d": (400.0, -50.0)}
    too_late = lay(text.format(more=""), reserved, now=10.0 + RESERVED)
    assert "d" not in too_late["places"]


def test_the_first_state_of_a_machine_has_the_place_that_was_reserved_for_it():
    reserved = lay("(machine m)", moved={"a": (40, 30)})
    assert positions(lay("(machine m (state a))", reserved)) == {"a": (40.0, 30.0)}


def test_a_first_layout_leaves_a_place_for_what_was_moved():
    text = THREE.format(more="(on e a -> b) (on e b -> c)")
    fresh = lay(text, moved={"c": positions(lay(text))["a"]})
    assert positions(fresh)["c"] == positions(lay(text))["a"]
    assert not box(shape_of(fresh, "a")).overlaps(box(shape_of(fresh, "c")))


def test_states_dragged_onto_each_other_are_still_drawn():
    drawing = lay(THREE.format(more="(on e a -> b) (on e b -> a)"), moved={"a": (0, 0), "b": (0, 0)})
    assert all(arrow["d"] for arrow in drawing["transitions"])


names = st.sampled_from("abcdefg")
forms = st.one_of(
    st.builds("(state {})".format, names),
    st.builds("(eps {} -> {})".format, names, names),
    st.builds("(on [True] {} -> {})".format, names, names),
    st.builds("(ontime 5 *-> {})".format, names),
    st.builds("(exit [True] {} -> {})".format, names, names),
)
machines = st.lists(forms, max_size=14).map(lambda parts: "(machine m " + " ".join(parts) + ") (spawn m a)")


@given(st.lists(machines, min_size=2, max_size=4))
def test_whatever_the_edits_states_that_stay_do_not_move(texts):
    drawing = lay(texts[0])
    for text in texts[1:]:
        program = parse(text)
        after = layout(program.machines[0], drawing, program=program)
        before, now = positions(drawing), positions(after)
        stayed = {shape["name"] for shape in drawing["states"] if shape["kind"] == "state"}
        for name in stayed & {shape["name"] for shape in after["states"] if shape["kind"] == "state"}:
            assert before[name] == now[name]
        boxes = [box(shape) for shape in after["states"]]
        assert not [(a, b) for i, a in enumerate(boxes) for b in boxes[:i] if a.overlaps(b)]
        assert json.loads(json.dumps(after)) == after
        drawing = after


def test_benchmark_first_layout_of_40_states(benchmark, programs):
    program = programs["forty states"]
    benchmark(layout, program.machines[0], program=program)


def test_benchmark_layout_of_40_states_after_an_edit(benchmark, programs):
    program = programs["forty states"]
    previous = layout(program.machines[0], program=program)
    benchmark(layout, program.machines[0], previous, program=program)


# -- large machines ----------------------------------------------------------------------------------


def large(states, *more):
    forms = [f"(state s{i})" for i in range(states)]
    forms += [f"(eps s{i} -> s{(i + 1) % states})" for i in range(states)]
    return f"(machine m {' '.join([*forms, *more])}) (spawn m s0)"


@pytest.fixture
def work(monkeypatch):
    """Count how often rectangles are compared with lines, points and each other."""
    done = []

    def counted(original):
        def call(*arguments):
            done.append(original)
            return original(*arguments)

        return call

    for name in ("overlaps", "holds", "crossed_by"):
        monkeypatch.setattr(Rect, name, counted(getattr(Rect, name)))
    return done


@every("more", [(), ("(eps s3 -> s80)", "(eps s70 -> s12)"), ("(exit [True] s1 -> a)", "(ontime 5 *-> s9)")])
def test_the_work_grows_with_the_states_and_not_with_their_square(work, more):
    spent = []
    for states in (60, 240):
        del work[:]
        lay(large(states, *more))
        spent.append(len(work))
    assert spent[1] < 5.5 * spent[0]


def test_an_edit_of_a_large_machine_compares_the_new_state_with_those_near_it_only(work):
    spent = []
    for states in (60, 240):
        before = lay(large(states))
        del work[:]
        lay(large(states), before)
        unchanged = len(work)
        del work[:]
        lay(large(states, "(state new)", "(eps s9 -> new)"), before)
        spent.append(len(work) - unchanged)
    assert spent[1] < 5.5 * spent[0]


def test_an_order_considers_the_shortest_edges_as_far_as_its_work_allows(monkeypatch):
    level = {"a": 0, "b": 0, "c": 1, "d": 1, "x": 2, "y": 2}
    links = [("a", "y"), ("b", "c"), ("b", "d"), ("c", "x"), ("d", "x")]
    assert PASSED >= 1
    monkeypatch.setattr("lrp_jupyter.graph.arrangement.PASSED", 0)
    across = order("abcdxy", links, level)
    assert across == order("abcdxy", links[1:], level)
    assert across.keys() == level.keys()


def test_labels_of_large_pictures_know_arrows_by_fewer_points_and_still_avoid_states_and_labels(monkeypatch):
    known = []

    class Recorded(labels_module._Obstacles):
        def __init__(self):
            super().__init__()
            known.append(self._points)

    monkeypatch.setattr(labels_module, "_Obstacles", Recorded)
    source = Rect(0.0, 0.0, 64.0, 36.0)
    ways = [straight(source, (40_000.0, 40.0 * i)) for i in range(60)]
    sizes = [(80.0, 16.0)] * len(ways)
    labels = place_labels(ways, sizes, [source])
    assert 0 < sum(map(len, known[0].values())) <= POINTS + SAMPLES * len(ways)
    assert not [(a, b) for i, a in enumerate(labels) for b in labels[:i] if a.overlaps(b)]


def test_cells_find_all_rectangles_that_a_brute_search_finds():
    rects = [Rect(37.0 * i % 500, 91.0 * i % 700, 64.0, 36.0) for i in range(60)]
    cells = Cells(96.0, 7.0)
    for rect in rects:
        cells.add(rect)
    for i in range(80):
        start, end = (13.0 * i % 480, 7.0 * i % 690), (29.0 * i % 510 - 40.0, 350.0 - 3.0 * i)
        crossed = {rect for rect in rects if rect.crossed_by(start, end, 4.0)}
        assert crossed == {rect for rect in cells.along(start, end) if rect.crossed_by(start, end, 4.0)}
        held = {rect for rect in rects if rect.holds(start, 7.0)}
        assert held == {rect for rect in cells.at(start) if rect.holds(start, 7.0)}
        mine = Rect(*start, 80.0, 40.0)
        met = {rect for rect in rects if rect.overlaps(mine, 7.0, 7.0)}
        assert met == {rect for rect in cells.near(mine) if rect.overlaps(mine, 7.0, 7.0)}


def test_the_layout_of_very_many_arrows_is_drawn_plainly_within_bounds(monkeypatch):
    crossed = Counter()
    before = Rect.crossed_by
    monkeypatch.setattr(Rect, "crossed_by", lambda *given: crossed.update(n=1) or before(*given))
    monkeypatch.setattr("lrp_jupyter.graph.layout.PLAIN", 100)
    arrows = " ".join(f"(eps a -> b{i})" for i in range(300))
    shape = lay(f"(machine m (state a) {arrows})")
    assert len(shape["states"]) == 301
    assert len(shape["transitions"]) == 300
    assert crossed["n"] < 1_000


@pytest.mark.parametrize("first", [2, 25])
def test_many_new_states_find_places_within_bounds_and_none_on_another(monkeypatch, first):
    names = [f"s{i}" for i in range(100)]
    monkeypatch.setattr("lrp_jupyter.graph.state_places.EFFORT", 20_000)

    def machine(some):
        arrows = " ".join(f"(eps s0 -> {name})" for name in some[1:])
        return f"(machine m {' '.join(f'(state {name})' for name in some)} {arrows})"

    previous = lay(machine(names[:first]))
    compared = Counter()
    before = Rect.crossed_by
    monkeypatch.setattr(Rect, "crossed_by", lambda *given: compared.update(n=1) or before(*given))
    shape = lay(machine(names), previous)
    boxes = [Rect(each["x"], each["y"], each["width"], each["height"]) for each in shape["states"]]
    assert not any(a.overlaps(b) for a, b in combinations(boxes, 2))
    assert {k: v for k, v in shape["places"].items() if k in previous["places"]} == previous["places"]
    assert compared["n"] < 3 * 20_000


def test_a_machine_in_a_narrow_panel_has_narrow_layers():
    program = parse(programs.load("follower"))
    wide, narrow = (layout(program.machines[0], program=program, panel=panel) for panel in (None, (378, 530)))
    assert wide["frame"][2] > 500
    assert narrow["frame"][2] <= 378
    assert narrow["frame"][3] <= 530


@every("panel", [(330, 215), (400, 180), (520, 300)])
def test_the_four_states_of_the_search_are_wholly_in_sight_in_the_panel_of_a_small_window(panel):
    program = parse(programs.load("follower"))
    path = ("follower", "looking", "lookalgo")
    drawing = layout(find_machine(program, path), program=program, path=path, panel=panel)
    assert shown_at(drawing, panel) >= LEGIBLE


@every("count", [4, 6, 8, 9])
def test_a_chain_that_is_longer_than_its_panel_turns_back_in_it(count):
    drawing = lay(ring(count), panel=(600, 400))
    assert shown_at(drawing, (600, 400)) >= LEGIBLE
    places = list(positions(drawing).values())
    assert all(abs(a[0] - b[0]) + abs(a[1] - b[1]) < 200 for a, b in pairwise(places))


def test_a_column_that_turns_back_stands_beside_the_widest_row_of_the_one_before():
    program = parse(re.sub(r"\(exit .*-> done\)", "", programs.load("box-pusher")))
    drawing = layout(program.machines[0], program=program, panel=(560, 330))
    done, backing = (box(shape_of(drawing, name)) for name in ("done", "backing"))
    assert 0 < (backing.x - backing.width / 2) - (done.x + done.width / 2) < 150


def test_a_machine_that_is_too_large_for_its_panel_is_scrolled_in_one_direction_if_possible():
    program = parse(programs.load("follower"))
    shown = layout(program.machines[0], program=program, panel=(330, 213))
    assert shown["frame"][2] * LEGIBLE <= 330
