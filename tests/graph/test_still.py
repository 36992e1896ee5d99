import re
import shutil
import subprocess
import xml.etree.ElementTree as ET

import pytest
from support.settings import with_settings

from lrp_jupyter.errors import UnknownElementError
from lrp_jupyter.graph.exports import dot, mermaid, tree
from lrp_jupyter.graph.labels import LABEL_FONT, text_width
from lrp_jupyter.graph.layout import fit_tags, layout
from lrp_jupyter.graph.state_graph import DefinedPaths, find_machine
from lrp_jupyter.graph.still import svg
from lrp_jupyter.language.parser import parse

NS = "{http://www.w3.org/2000/svg}"
ACTIVE = [("follower", "looking", "lookalgo", "lookright")]


def picture(program, *arguments, **options):
    return ET.fromstring(svg(program, *arguments, **options))


def with_attribute(root, name):
    return [element.get(name) for element in root.iter() if element.get(name) is not None]


def test_a_picture_is_well_formed_and_has_a_title_and_a_description(programs):
    for root in map(picture, programs.values()):
        ids = root.get("aria-labelledby").split()
        assert root.get("role") == "img"
        assert [root.find(f"{NS}title").get("id"), root.find(f"{NS}desc").get("id")] == ids
        assert root.find(f"{NS}title").text


def test_the_description_describes_the_picture(follower):
    text = picture(follower, ACTIVE, machine_path=("follower",)).find(f"{NS}desc").text
    assert "It starts in looking." in text
    assert "looking is active." in text
    assert "From any state to end, ending." in text


def test_states_and_transitions_carry_their_names_for_tests_and_themes(follower):
    root = picture(follower)
    assert "follower/looking" in with_attribute(root, "data-lrp-state")
    assert "follower/looking/lookalgo/lookleft" in with_attribute(root, "data-lrp-state")
    assert "follower:tlooking" in with_attribute(root, "data-lrp-transition")
    assert with_attribute(root, "data-lrp-machine") == ["follower", "follower/looking/lookalgo"]


def test_active_states_are_marked_from_root_to_leaf(follower):
    root = picture(follower, ACTIVE)
    active = [g.get("data-lrp-state") for g in root.iter(f"{NS}g") if g.get("data-active") is not None]
    assert active == ["follower/looking", "follower/looking/lookalgo/lookright"]


def test_the_transition_fired_last_is_marked(follower):
    root = picture(follower, (), "follower:tlooking")
    fired = [g.get("data-lrp-transition") for g in root.iter(f"{NS}g") if g.get("data-fired") is not None]
    assert fired == ["follower:tlooking"]
    plates = [text for text in root.iter(f"{NS}text") if "lrp-fired" in text.get("class", "")]
    assert [text.text for text in plates] == ["outofline"]
    assert root.findtext(f"{NS}desc").count("It fired last.") == 1


def test_each_kind_has_its_colour_and_its_own_dash(programs):
    text = svg(programs["kinds"], theme="light")
    for kind, colour in {
        "on": "#1F78B4",
        "eps": "#33A02C",
        "ontime": "#FF7F00",
        "wildcard": "#6A3D9A",
    }.items():
        assert re.search(rf"\.lrp-{kind} \.lrp-mark{{stroke:{colour}}}", text)
    dashes = re.findall(r"\.lrp-(\w+) \.lrp-shaft{stroke-dasharray:([^}]+)}", text)
    assert {kind for kind, _ in dashes} == {"eps", "ontime", "wildcard", "exit"}
    assert len({dash for _, dash in dashes}) == 4


def test_a_wildcard_timeout_is_drawn_as_a_wildcard():
    root = picture(parse("(machine m (state a) (ontime 5 *-> a))"))
    (arrow,) = [g for g in root.iter(f"{NS}g") if g.get("data-lrp-transition")]
    assert "lrp-wildcard" in arrow.get("class")


def test_dark_readers_get_light_colours(follower):
    text = svg(follower)
    assert text.index("#1F78B4") < text.index("@media (prefers-color-scheme:dark)") < text.index("#A6CEE3")
    assert "@media" not in svg(follower, theme="dark")


def test_two_pictures_in_one_page_have_ids_of_their_own(follower, programs):
    ids = re.findall(r' id="([^"]+)"', svg(follower) + svg(programs["kinds"]))
    assert len(ids) == len(set(ids)) == 4


def test_a_legend_names_only_what_is_there(follower):
    words = [text.text for text in picture(follower).iter(f"{NS}text") if text.get("class") == "lrp-key"]
    assert words == ["event", "timeout", "any state"]
    assert "lrp-legend" not in svg(follower, legend=False)


def test_one_machine_of_a_program_is_drawn_alone(follower):
    root = picture(follower, machine_path=("follower", "looking", "lookalgo"))
    assert with_attribute(root, "data-lrp-machine") == ["follower/looking/lookalgo"]
    with pytest.raises(UnknownElementError):
        svg(follower, machine_path=("nothing",))


def test_texts_are_escaped():
    program = parse('(machine m (state a) (state b) (on ["<&>" in "]"] a -> b))')
    assert '["<&>" in "]"]' in [text.text for text in picture(program).iter(f"{NS}text")]
    assert "&quot;&lt;&amp;&gt;" in svg(program)


def test_programs_and_machines_show_themselves(follower):
    bundle = follower._repr_mimebundle_()
    assert set(bundle) == {"image/svg+xml", "text/plain"}
    assert bundle["image/svg+xml"] == svg(follower)
    assert follower.machines[0]._repr_mimebundle_()["text/plain"].startswith("machine follower")


def test_the_tree_shows_nesting_and_what_is_active(follower):
    assert tree(follower, ACTIVE).splitlines() == [
        "machine follower ●",
        "├─ moving",
        "├─ looking ●",
        "│  └─ machine lookalgo ●",
        "│     ├─ lookleft",
        "│     ├─ returnleft",
        "│     ├─ lookright ●",
        "│     └─ returnright",
        "├─ bumpback",
        "├─ bumpturn",
        "└─ end",
    ]
    assert tree(parse("")) == "(no machine)"


def test_dot_draws_each_machine_as_a_cluster_in_the_one_around_it(follower):
    text = dot(follower)
    outer = text.index('subgraph "cluster follower"')
    inner = text.index('subgraph "cluster follower/looking/lookalgo"')
    assert outer < inner < text.index('"follower/bumpback"')
    assert '"follower/*" -> "follower/end" [label="ending", color="#6A3D9A", style="dashed"];' in text
    assert text.count("{") == text.count("}")


def test_dot_quotes_what_it_must():
    text = dot(parse(r'(machine m (state a) (state b) (on ["\n\"" == "x"] a -> b))'))
    assert r'label="[\"\\n\\\"\" == \"x\"]"' in text


@pytest.mark.skipif(shutil.which("dot") is None, reason="Graphviz is not installed")
def test_graphviz_reads_the_dot_text(programs):
    texts = "\n".join(map(dot, programs.values()))
    subprocess.run(["dot", "-Tcanon"], input=texts, text=True, check=True, capture_output=True)


def test_mermaid_nests_machines_in_their_states(follower):
    lines = mermaid(follower).splitlines()
    assert lines[0] == "stateDiagram-v2"
    looking = next(i for i, line in enumerate(lines) if line.endswith("{") and '"looking"' in line)
    assert 'state "lookalgo"' in lines[looking + 1]
    assert sum(line.count("[*] -->") for line in lines) == 2
    assert any(line.endswith(": 1000 ms") for line in lines)


def test_mermaid_escapes_what_would_mean_something():
    text = mermaid(parse('(machine m (state a) (state b) (on [x["k"] == ";"] a -> b))'))
    assert "#91;x#91;#34;k#34;#93; #61;#61; #34;#59;#34;#93;" in text


def test_mermaid_leaves_a_nested_machine_without_crossing_its_border(programs):
    lines = [line.strip() for line in mermaid(programs["kinds"]).splitlines()]
    assert "s6 --> [*] : near → drive" in lines


def test_a_machine_spawned_from_elsewhere_shows_its_active_state():
    program = parse("(machine m (state a (onentry (spawn helper h)))) (machine helper (state h)) (spawn m a)")
    picture = svg(program, active=[("m", "a", "helper", "h")])
    lit = re.findall(r'data-lrp-state="([^"]*)" data-active', picture)
    assert sorted(lit) == ["helper/h", "m/a"]


USED_ALIKE = (
    "(machine k (state x)) (machine m (state a (onentry (spawn k x))))"
    "(machine n (state a (onentry (spawn k x))))"
    "(machine r (state s (onentry (spawn m a) (spawn n a)))) (spawn r s)"
)
SHARED = (
    "(machine m (state a (onentry (spawn helper h)))) (machine n (state b (onentry (spawn helper i))))"
    "(machine helper (state h) (state i)) (spawn m a) (spawn n b)"
)


def test_of_a_machine_that_runs_in_several_states_each_active_state_names_the_one_it_runs_in():
    program = parse(SHARED)
    root = picture(program, active=[("m", "a", "helper", "h"), ("n", "b", "helper", "i")])
    tags = {
        g.get("data-lrp-state"): text.text
        for g in root.iter(f"{NS}g")
        for text in g.findall(f"{NS}text[@class='lrp-user']")
    }
    assert tags == {"helper/h": "m/a", "helper/i": "n/b"}
    assert "h is active in m/a." in root.find(f"{NS}desc").text
    assert 'lrp-user"' not in svg(program, active=[("m", "a", "helper", "h"), ("n", "b")])


def test_several_users_of_one_active_state_share_a_tag_that_leaves_out_what_they_have_in_common():
    paths = DefinedPaths(parse(SHARED))
    every = [("m", "a", "helper", "h"), ("m", "c", "helper", "h"), ("helper", "i")]
    assert paths.users(every[:2]) == {"helper/h": "a, c"}
    assert paths.users(every) == {"helper/h": "m/a, m/c", "helper/i": "top level"}
    assert paths.users(every[:1]) == {}
    twice = DefinedPaths(parse(USED_ALIKE))
    assert twice.users([("r", "s", "m", "a", "k", "x"), ("r", "s", "n", "a", "k", "x")]) == {"k/x": "m, n"}


def test_tags_stay_in_the_frame_and_beside_the_next_state():
    program = parse(
        "(machine k (state x) (state y)) (machine m (state a (onentry (spawn k x))))"
        "(machine n (state a (onentry (spawn k x))))"
    )
    users = "a_user_with_a_long_name, another_user_with_a_long_name"
    machine = find_machine(program, ("k",))
    drawing = layout(machine, program=program, path=("k",), moved={"x": (0.0, 0.0), "y": (90.0, 0.0)})
    x, y = (next(each for each in drawing["states"] if each["name"] == name) for name in "xy")
    tags = fit_tags({"k/x": users, "k/y": users}, [drawing])
    for state, end in (x, y["x"] - y["width"] / 2), (y, drawing["frame"][0] + drawing["frame"][2]):
        left = state["x"] - state["width"] / 2 + 10
        assert left + text_width(tags[state["id"]], LABEL_FONT) < end
    assert text_width(tags["k/y"], LABEL_FONT) > 100, "there is room for the names of two"


def test_a_state_shows_and_describes_what_it_spawns_from_elsewhere(programs):
    root = picture(programs["shared"])
    lines = [g for g in root.iter(f"{NS}g") if g.get("data-lrp-spawns")]
    assert [(g.get("data-lrp-spawns"), g.find(f"{NS}text").text) for g in lines] == [("move", "move")] * 2
    described = root.find(f"{NS}desc").text
    assert "left spawns move." in described
    assert "From left to rest, found (from go)." in described
    assert "From go leaves to rest, found." in described


def test_dot_draws_an_exit_in_its_machine_and_where_it_lands(programs):
    lines = [line.strip() for line in dot(programs["shared"]).splitlines()]
    assert '"patrol/left" [label="left ⧉ move"];' in lines
    assert (
        '"patrol/right" -> "patrol/rest" [label="near (from turn)", color="#1F78B4", style="bold"];' in lines
    )
    assert '"move/go" -> "move/exit rest" [label="found", color="#1F78B4", style="bold"];' in lines
    assert not [line for line in lines if "move/go" in line and "patrol/rest" in line]


def test_mermaid_draws_an_exit_in_its_machine_and_where_it_lands(programs):
    lines = [line.strip() for line in mermaid(programs["shared"]).splitlines()]
    assert 'state "left #10697; move" as s1' in lines
    assert lines.count("s1 --> s3 : found (from go)") == 1
    assert "s4 --> [*] : found → rest" in lines


def test_one_machine_of_a_program_is_written_as_the_program_means_it(programs):
    program, path = programs["kinds"], ("kinds", "docking", "dock")
    assert '"kinds/docking/dock/locked" -> "kinds/docking/dock/exit drive"' in dot(program, path)
    assert "near → drive" in mermaid(program, path)
    for text, cross in ((dot(program, path), "✗"), (mermaid(program, path), "#10007;")):
        assert text.count(cross) == 1  # of the one that leads nowhere
        assert "rest" not in text


def test_the_tree_names_what_a_state_spawns_from_elsewhere(programs):
    program = with_settings(programs["shared"], "move", side="-1")
    assert tree(program).splitlines()[:3] == [
        "machine patrol",
        "├─ left ⧉ move side \N{MINUS SIGN}1",
        "├─ right ⧉ move side \N{MINUS SIGN}1",
    ]


def test_nested_machines_are_drawn_inside_their_states_if_wanted(follower):
    def owners(picture):
        root = ET.fromstring(picture)
        parents = {child: parent for parent in root.iter() for child in parent}
        (inner,) = (
            node for node in root.iter() if node.get("data-lrp-machine") == "follower/looking/lookalgo"
        )
        while inner in parents:
            inner = parents[inner]
            yield inner.get("data-lrp-state")

    assert "follower/looking" in owners(svg(follower, nested=True))
    assert "follower/looking" not in owners(svg(follower))
