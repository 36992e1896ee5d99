"""A machine that runs in two places: a page is told of both, and can mean either."""

import pytest
from support.twice import TWICE

from lrp_jupyter.widgets.views.instances import Instances


@pytest.fixture
def lab(bench):
    lab = bench(TWICE)
    lab.session.run(0.8)
    return lab


@pytest.fixture
def page(lab):
    page = lab.page()
    lab.publish()
    return page


def instances(page):
    return [(each["path"], each["machine"]) for each in page.merged("instances")]


def test_the_instances_that_run_and_their_variables_have_their_paths_as_spawned(lab, page):
    both = [("m/left/follow", "follow"), ("k/one/follow", "follow")]
    assert instances(page) == [("m", "m"), both[0], ("k", "k"), both[1], ("clock", "clock")]
    variables = page.merged("variables")
    assert variables["m/left/follow/side"] == ["2", 2]
    assert variables["k/one/follow/side"] == ["1", 1]
    assert "follow/side" not in variables
    lab.session.run(0.4)
    lab.publish()
    assert instances(page) == [("m", "m"), ("k", "k"), both[1], ("clock", "clock")]
    assert page.do("look", tick=8) is None
    lab.publish()
    assert instances(page)[1] == both[0]
    inspected = page.ask("inspect", kind="variable", path="m/left/follow/side", into=[])
    assert inspected["inspect"]["text"] == "2"
    assert page.ask("hover", chain="side", scope="m/left/follow")["hover"]["value"] == "2"
    assert page.merged("variables")["m/left/follow/side"] == ["2", 2]


def test_what_the_spawn_of_an_instance_initialises_is_said_in_a_line(lab, page):
    settings = {each["path"]: each["settings"] for each in page.merged("instances")}
    assert settings["m/left/follow"] == "side 2"
    assert settings["k/one/follow"] == ""
    lab.session.edit(TWICE.replace("[2])", "[-1]) (var twice := [[1,\n2]])"))
    found = Instances(lab.session.program).of([("m", "left", "follow", "search")])
    assert found[1]["settings"] == "side \N{MINUS SIGN}1, twice [1, …"


def test_a_value_that_is_outdated_is_so_in_its_instance(lab, page):
    assert page.do("set_variable", path="k/one/follow/side", expression="5") is None
    lab.publish()
    assert page.merged("outdated").keys() == {"k/one/follow/twice"}


def test_a_page_can_mean_one_instance(lab, page):
    for instance, state in ("m/left/follow", "search"), ("k/one/follow", "found"):
        facets = page.ask("inspect", kind="state", path=f"{instance}/search", into=[])["inspect"]["facets"]
        assert facets[0]["text"] == ("yes" if state == "search" else "no")
        value = page.ask("inspect", kind="variable", path=f"{instance}/side", into=[])["inspect"]["text"]
        assert page.ask("hover", chain="side", scope=instance)["hover"]["value"] == value
    assert page.ask("hover", chain="n", scope="k/one/follow")["hover"]["value"] == "8"
    assert page.ask("why", kind="transition", path="m/left/follow:hit")["why"]["code"] == "condition-false"
    assert page.ask("why", kind="transition", path="k/one/follow:hit")["why"]["code"] == "fired"
    assert page.do("teleport", path="m/left/follow/found") is None
    assert page.do("teleport", path="k/one/follow/search") is None
    assert page.do("fire", path="k/one/follow:hit") is None
    lab.publish()
    assert page.merged("active")[:2] == ["m/left/follow/found", "k/one/follow/found"]


def test_an_event_has_the_value_of_its_instance(bench):
    event = "(event mine [side < 2]) (on mine search -> found)"
    lab = bench(TWICE.replace("(state search)", f"{event} (state search)"))
    page = lab.page()
    lab.session.run(0.4)
    lab.publish()
    both = {"m/left/follow/mine": False, "k/one/follow/mine": True}
    assert page.merged("events").items() >= both.items()
    for path, value in both.items():
        scope = path.removesuffix("/mine")
        assert page.ask("hover", chain="mine", scope=scope)["hover"]["value"] == str(value)
    everywhere = page.ask("hover", chain="mine", scope="follow")["hover"]["value"]
    assert everywhere == "m/left/follow: False\nk/one/follow: True"


def test_a_breakpoint_of_a_page_is_for_any_instance_or_for_one(lab, page):
    assert page.do("add_breakpoint", kind="entered", path="follow/found") is None
    assert page.do("add_breakpoint", kind="entered", path="follow/found", instance="m/left/follow") is None
    lab.publish()
    known = page.merged("breakpoints")
    assert [known[number]["instance"] for number in "12"] == ["", "m/left/follow"]
    assert {each["path"] for each in known.values()} == {"follow/found"}
    lab.session.run(0.1)
    lab.publish()
    assert [each["hits"] for each in page.merged("breakpoints").values()] == [1, 1]
    assert page.merged("paused_by")["text"].startswith("`found` was entered in `m/left/follow` (breakpoint 1")


def test_the_instance_at_the_top_level_can_be_meant_too(bench):
    lab = bench(
        "(machine follow (state x) (state y) (ontime 100 x -> y))"
        "(machine k (state a (onentry (spawn follow y)))) (spawn k a) (spawn follow x)"
    )
    page = lab.page()
    assert page.do("add_breakpoint", kind="entered", path="follow/y", instance="follow") is None
    lab.session.run(0.5)
    lab.publish()
    assert page.merged("breakpoints")["1"]["hits"] == 1
    assert page.merged("breakpoints")["1"]["instance"] == "follow"
