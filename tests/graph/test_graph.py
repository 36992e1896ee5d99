import networkx as nx
import pytest

from lrp_jupyter.errors import UnknownElementError
from lrp_jupyter.graph.state_graph import (
    find_machine,
    outer_states,
    start_states,
    state_graph,
    unreachable,
    unspawned,
)
from lrp_jupyter.language.parser import parse

LOOKALGO = ("follower", "looking", "lookalgo")


def edges(graph, kind=None):
    return {
        ("/".join(a), "/".join(b), key)
        for a, b, key, data in graph.edges(keys=True, data=True)
        if kind in (None, data["kind"])
    }


def test_every_state_is_a_node_with_its_path(follower):
    graph = state_graph(follower)
    states = [path for path, data in graph.nodes(data=True) if data["kind"] == "state"]
    assert states[0] == ("follower", "moving")
    assert (*LOOKALGO, "lookleft") in states
    assert len(states) == 9
    assert graph.nodes["follower", "looking"]["machines"] == (LOOKALGO,)
    assert graph.nodes[*LOOKALGO, "lookleft"]["machine"] == LOOKALGO


def test_an_edge_has_its_kind_and_condition(follower):
    graph = state_graph(follower)
    edge = graph.edges[("follower", "moving"), ("follower", "looking"), "tlooking"]
    assert edge == {
        "kind": "on",
        "label": "tlooking",
        "condition": "outofline",
        "text": "outofline",
        "style": "on",
        "wildcard": False,
        "order": 0,
        "dangling": None,
    }
    assert (
        graph.edges[("follower", "bumpback"), ("follower", "bumpturn"), "1000:bumpback->bumpturn"]["text"]
        == "1000 ms"
    )


def test_a_wildcard_becomes_an_edge_from_every_other_state(follower):
    graph = state_graph(follower)
    sources = {a[-1] for a, b, key in graph.edges(keys=True) if key == "tend"}
    assert sources == {"moving", "looking", "bumpback", "bumpturn"}


def test_unexpanded_a_wildcard_is_one_edge_from_the_fictional_state(follower):
    graph = state_graph(follower, expand=False)
    assert [a for a, b, key in graph.edges(keys=True) if key == "tend"] == [("follower", "*")]
    assert graph.nodes["follower", "*"]["kind"] == "any"


def test_spawns_are_edges_from_the_program_and_from_states(follower):
    assert edges(state_graph(follower), "spawn") == {
        ("", "follower/looking", "spawn follower"),
        ("follower/looking", "follower/looking/lookalgo/lookleft", "spawn lookalgo"),
    }


def test_a_missing_state_is_a_node_and_the_edge_has_the_reason():
    graph = state_graph(parse("(machine m (state a) (event e [True]) (on e a -> b)) (spawn m a)"))
    assert graph.nodes["m", "b"]["kind"] == "missing"
    assert graph.edges[("m", "a"), ("m", "b"), "e:a->b"]["dangling"] == "There is no state `b`."


def test_an_unknown_event_dangles_but_one_of_an_outer_machine_does_not():
    graph = state_graph(
        parse(
            "(event top [True]) (machine m (event outer [True])"
            " (state a (machine n (state x) (state y) (on top x -> y) (on outer y -> x) (on inner x -> y))))"
        )
    )
    dangling = {key: data["dangling"] for _, _, key, data in graph.edges(keys=True, data=True)}
    assert dangling == {
        "top:x->y": None,
        "outer:y->x": None,
        "inner:x->y": "There is no event `inner`.",
    }


def test_an_exit_leads_to_a_state_of_the_machine_around(programs):
    graph = state_graph(programs["kinds"])
    assert graph.has_edge(("kinds", "docking", "dock", "align"), ("kinds", "drive"), "giveup")
    assert outer_states(programs["kinds"], ("kinds", "docking", "dock")) == {
        "drive",
        "rest",
        "check",
        "docking",
    }


def test_an_exit_of_a_root_machine_dangles():
    graph = state_graph(parse("(machine m (state a) (state b) (exit [True] a -> b)) (spawn m a)"))
    assert [data["dangling"] for *_, data in graph.edges(data=True) if data["kind"] == "exit"] == [
        "No state spawns this machine, so there is nothing to exit to."
    ]


def test_a_machine_spawned_from_elsewhere_exits_to_the_machine_of_its_spawner():
    text = (
        "(machine tool (state work) (exit [True] work -> idle))"
        "(machine m (state idle) (state busy (onentry (spawn tool work)))) (spawn m busy)"
    )
    assert unreachable(parse(text)) == ()
    assert state_graph(parse(text)).has_edge(("tool", "work"), ("m", "idle"))


def test_no_machine_can_spawn_the_one_around_it():
    graph = state_graph(parse("(machine m (state a (onentry (spawn m a)))) (spawn m a)"))
    assert [data["dangling"] for a, _, data in graph.edges(data=True) if a] == [
        "No machine `m` can be spawned here."
    ]


def test_of_two_states_of_one_name_the_first_counts():
    graph = state_graph(parse("(machine m (state a) (state a (machine n)))"))
    assert graph.nodes["m", "a"]["machines"] == ()


def test_everything_in_the_follower_can_be_reached(follower):
    assert unreachable(follower) == ()
    assert unspawned(follower) == ()


def test_states_that_no_path_leads_to_are_unreachable():
    text = """
    (machine m (event e [True])
      (state a) (state b) (state c) (state island (machine n (state x)) (onentry (spawn n x)))
      (on e a -> b) (on nosuch b -> c) (on e island -> c))
    (machine never (state y))
    (spawn m a)
    """
    program = parse(text)
    assert unreachable(program) == (
        ("m", "c"),
        ("m", "island"),
        ("m", "island", "n", "x"),
        ("never", "y"),
    )
    assert unspawned(program) == (("never",),)


def test_without_a_spawn_nothing_can_be_reached():
    assert unreachable(parse("(machine m (state a) (state b) (eps a -> b))")) == (("m", "a"), ("m", "b"))


def test_start_states_are_those_that_some_spawn_names(follower):
    assert start_states(follower) == {("follower",): ("looking",), LOOKALGO: ("lookleft",)}


def test_networkx_algorithms_run_on_it(follower):
    graph = state_graph(follower)
    path = nx.shortest_path(graph, (), ("follower", "bumpturn"))
    assert [step[-1] for step in path[1:]] == ["looking", "bumpback", "bumpturn"]


def test_a_machine_is_found_by_its_path(follower):
    assert find_machine(follower, LOOKALGO).name == "lookalgo"
    with pytest.raises(UnknownElementError, match="no machine `follower/looking/other`"):
        find_machine(follower, ("follower", "looking", "other"))
