"""What a view may show of a session, and the difference of two such states."""

from dataclasses import replace
from threading import Event, Thread
from typing import get_type_hints

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.robots import Bare

from lrp_jupyter.live.running.frame import Hung
from lrp_jupyter.widgets.views import layouts
from lrp_jupyter.widgets.views.view_state import difference
from lrp_jupyter.widgets.wire.protocol import FrameMessage, ViewState

COUNT = "(var count := [0]) (machine m (state a (running [count = count + 1]))) (spawn m a)"
LOST = "(machine m (state a) (state b) (on nowhere a -> b)) (spawn m a)"

ENTRIES = st.dictionaries(st.sampled_from("abc"), st.integers(0, 3))
STATES = st.fixed_dictionaries(
    {"tick": st.integers(0, 3), "lit": st.lists(st.integers()), "entered": ENTRIES}
)


def merged(before, changes):
    """What a page makes of a frame."""
    state = dict(before)
    for field, new in changes.items():
        if isinstance(new, dict) and isinstance(before.get(field), dict):
            new = {name: entry for name, entry in {**before[field], **new}.items() if entry is not None}
        state[field] = new
    return state


@given(STATES, STATES)
def test_a_difference_leads_from_one_state_to_the_next(before, now):
    assert merged(before, difference(before, now)) == now
    assert difference(now, now) == {}
    assert difference({}, now) == now


def test_a_view_state_has_all_fields_of_its_type(bench):
    lab = bench(COUNT)
    assert lab.connection.view_state().keys() == get_type_hints(ViewState).keys()
    assert get_type_hints(FrameMessage).keys() - get_type_hints(ViewState).keys() == {
        "type",
        "view",
        "frame",
        "ink",
        "says",
        "asks",
    }


def test_a_machine_that_runs_in_several_states_is_reported_with_these(bench, monkeypatch):
    lab = bench(
        "(machine m (state a (onentry (spawn k x)))) (machine n (state b (onentry (spawn k y))))"
        "(machine k (state x) (state y)) (spawn m a) (spawn n b)"
    )
    page = lab.page()
    active = (("m", "a", "k", "x"), ("n", "b", "k", "y"))
    monkeypatch.setattr(type(lab.session), "frame", replace(lab.session.frame, active=active))
    lab.publish()
    assert page.latest("users") == {"k/x": "m/a", "k/y": "n/b"}


def test_an_entry_is_reported_with_its_own_tick_however_late_a_view_gets_it(bench):
    lab = bench(COUNT)
    page = lab.page()
    for _ in range(5):
        lab.session.step()
    lab.publish()
    assert page.latest("tick") == 5
    assert page.latest("entered") == {"m/a": [1, 1]}
    said = {
        f["label"]: f["text"]
        for f in page.ask("inspect", kind="state", path="m/a", into=[])["inspect"]["facets"]
    }
    assert said["entered"] == "1 time, last in tick 1"


def test_a_block_that_hangs_is_sent_as_data_whatever_the_sentence(bench, monkeypatch):
    lab = bench(COUNT)
    page = lab.page()
    frame = replace(lab.session.frame, status="hung", reason="Wait.", hung=Hung("moving.running", 2.5))
    monkeypatch.setattr(type(lab.session), "frame", frame)
    lab.publish()
    assert page.latest("hung") == {"where": "moving.running", "seconds": 2.5, "line": 0, "held": False}
    later = replace(frame, hung=Hung("moving.running", 3.5))
    monkeypatch.setattr(type(lab.session), "frame", later)
    lab.publish()
    assert page.latest("hung") == {"seconds": 3.5}
    monkeypatch.undo()
    lab.publish()
    assert page.latest("hung") is None


def test_an_issue_names_the_finding_about_the_same_fault_until_it_is_resolved(bench):
    lab = bench(LOST.replace("nowhere", "[True]"))
    page = lab.page()
    (finding,) = page.type(LOST)["findings"]
    lab.session.step()
    lab.session.step()
    lab.publish()
    (issue,) = page.merged("issues").values()
    assert (finding["code"], issue["code"]) == ("LRP301", "LRP603")
    assert issue["finding"] == finding["id"]
    page.type(f"{LOST}(", at=len(LOST) + 1, meant=False)  # the page still lists the finding
    lab.publish()
    assert page.merged("issues") == {"1": issue}
    page.type(LOST.replace("(on nowhere a -> b)", ""))
    lab.publish()
    (issue,) = page.merged("issues").values()
    assert issue["resolved"]
    assert issue["finding"] == ""


@pytest.mark.parametrize(
    ("block", "codes"),
    [
        ("robot.distance < 0.3", ("LRP522", "LRP601")),
        ("robot.distance", ("LRP522", "LRP602")),
        ("robot.light.data", ("LRP508", "LRP602")),
        ("robot.distanse.data < 1", ("LRP520", "LRP601")),
        ("nothing", ("LRP502", "LRP606")),
        ("n.y == 3", ("LRP532", "LRP601")),
        ("n", ("LRP533", "LRP602")),
        ("n > 1", ("LRP533", "LRP601")),
        ("n.state", ("LRP508", "LRP602")),
    ],
)
def test_a_fault_of_a_block_that_the_checks_found_is_listed_once(bench, block, codes):
    text = "(machine m (state a) (state b)\n  (on [True == False] a -> b))\n(spawn m a)"
    text += "\n(machine n (state x))\n(spawn n x)"
    lab = bench(text, bridge="sim")
    page = lab.page()
    (finding,) = page.type(text.replace("True == False", block))["findings"]
    lab.session.step()
    lab.session.step()
    lab.publish()
    (issue,) = page.merged("issues").values()
    assert (finding["code"], issue["code"]) == codes
    assert issue["finding"] == finding["id"]


def test_an_exception_is_not_a_finding(bench):
    lab = bench(COUNT.replace("count + 1", "1 / 0"))
    page = lab.page()
    lab.session.step()
    lab.session.step()
    lab.publish()
    (issue,) = page.merged("issues").values()
    assert issue["finding"] == ""


@pytest.mark.parametrize("act", ["stop", "pause"])
def test_a_long_layout_delays_no_command(bench, monkeypatch, act):
    lab = bench(COUNT)
    page = lab.page()
    lab.session.start()
    entered, go, layout = Event(), Event(), layouts.layout

    def slow(*arguments, **options):
        entered.set()
        assert go.wait(120)
        return layout(*arguments, **options)

    monkeypatch.setattr(layouts, "layout", slow)
    page.sends(COUNT.replace("(state a", "(state b) (state a"))
    lab.session.call(lambda: None)
    publisher = Thread(target=lab.publish)
    publisher.start()
    try:
        assert entered.wait(120)
        sender = Thread(target=page.send, args=["command"], kwargs={"id": 0, "do": act})
        sender.start()
        assert lab.session.wait_for(lambda frame: frame.status == "paused", 120)
        sender.join(120)
        assert not sender.is_alive()
        assert publisher.is_alive()
    finally:
        go.set()
        publisher.join(120)
    assert len(page.merged("layouts")["m"]["states"]) == 2


def test_a_reading_that_is_too_old_is_shown_with_its_age_where_one_that_is_missing_is_waited_for(bench):
    ear = Bare(lambda robot: robot.feed("sound", doc="loudness"), time=0.0)
    ear.fed.clock = lambda: ear.time
    lab = bench("(machine m (state a) (state b) (on [robot.sound > 5] a -> b)) (spawn m a)", bridge=ear)
    page = lab.page()

    def shown():
        lab.session.step()
        lab.publish()
        facet = page.ask("inspect", kind="robot", path="robot", into=[])["inspect"]["facets"][0]
        hover = page.ask("hover", chain="robot.sound", scope="m")["hover"]
        return {page.merged("members")["sound"], facet["text"], hover["value"]}

    assert shown() == {"waiting"}
    ear.feed("sound", 3)
    ear.time = 0.4
    assert shown() == {"3"}
    ear.time = 1.4
    assert shown() == {"stale, 1.4 s old"}
