"""Every button, menu and drag of a page."""

import math
from contextlib import suppress

import pytest

from lrp_jupyter.bridges.bridge import Bridge, Panel
from lrp_jupyter.bridges.panel import Button, Question
from lrp_jupyter.errors import LRPError
from lrp_jupyter.widgets.text.conditions import Conditions

NEST = """
(var limit := [5])
(machine m
  (event never [False])
  (state a (onentry (spawn inner x)) (machine inner (var v := [limit]) (state x) (state y)
    (on never x -> y go) (exit never x -> b out)))
  (state b)
  (on never a -> b leave)
  (on never *-> a home))
(spawn m a)
"""


@pytest.fixture
def lab(bench):
    lab = bench(NEST, bridge="sim")
    lab.session.step()
    return lab


@pytest.fixture
def page(lab):
    return lab.page()


def active(lab):
    return ["/".join(path) for path in lab.session.frame.active]


def test_an_unknown_act_is_refused_in_a_sentence(page):
    assert page.do("dance") == "There is no act `dance`."


def test_run_and_pause(lab, page):
    assert page.do("run") is None
    assert lab.session.status == "running"
    assert page.do("pause") is None
    assert page.latest("status") == "paused"
    lab.session.stop()
    assert page.do("run") is None
    assert lab.session.status == "running"


@pytest.mark.slow
def test_a_block_that_does_not_return_is_interrupted(bench):
    lab = bench("(machine m (state a (running [while True: pass]))) (spawn m a)", hung_after=0.2)
    page = lab.page()
    assert "No block is running" in page.do("interrupt")
    lab.session.start()
    lab.session.wait_for(lambda frame: frame.status == "hung", 60)
    page.send("command", id=1, do="interrupt")
    lab.session.wait_for(lambda frame: frame.issues, 60)
    lab.publish()
    (issue,) = page.latest("issues").values()
    assert issue["code"] == "LRP611"
    assert issue["range"]["line"] == 1


def test_step_is_exactly_so_many_ticks_and_back_again(lab, page):
    assert page.do("step") is None
    assert page.do("step", value=3) is None
    assert lab.session.frame.tick == 5
    assert page.do("step_back", value=2) is None
    assert page.latest("tick") == 3


def test_stop_stops_the_robot_then_pauses(lab, page):
    lab.session.start()
    assert page.do("stop") is None
    lab.session.wait_for(lambda frame: frame.status == "paused", 60)
    lab.publish()
    assert page.latest("reason") == "The robot was stopped."


def test_rate_and_speed(lab, page):
    assert page.do("rate", value=25) is None
    assert page.do("speed", value=0) is None
    assert lab.session.rate == 25
    assert lab.session.speed == math.inf
    assert page.latest("speed") == 0
    assert page.do("rate", value=-1)


def test_transition_and_teleport_lead_to_a_state_by_its_path_in_the_text(lab, page):
    assert page.do("transition", path="m/a/inner/y") is None
    assert active(lab) == ["m/a/inner/y"]
    assert page.do("teleport", path="m/b") is None
    assert active(lab) == ["m/b"]
    assert page.do("transition", path="m/nowhere") is None  # an issue of the run, as in a program
    assert page.latest("issues")["1"]["code"] == "LRP604"


def test_a_transition_can_be_fired_whatever_its_condition(lab, page):
    assert page.do("fire", path="m/a/inner:go") is None
    assert active(lab) == ["m/a/inner/y"]
    assert "leaves is active" in page.do("fire", path="m/a/inner:go")
    assert page.do("fire", path="m:leave") is None
    assert page.do("fire", path="m:home") is None
    assert page.do("fire", path="m/a/inner:out") is None
    assert active(lab) == ["m/b"]
    assert "There is no transition `m/x`" in page.do("fire", path="m:x")


def test_a_variable_gets_the_value_of_an_expression_or_the_reason_why_not(lab, page):
    assert page.do("set_variable", path="m/a/inner/v", expression="limit * 2") is None
    assert page.latest("variables")["m/a/inner/v"] == ["10", 10.0]
    assert "division by zero" in page.do("set_variable", path="limit", expression="1/0")
    assert "SyntaxError" in page.do("set_variable", path="limit", expression="1 +")
    assert "no variable `m/x`" in page.do("set_variable", path="m/x", expression="1")


def test_policies_are_shared_by_all_views(lab, page):
    other = lab.page("other")
    assert page.do("on_active_edit", name="keep") is None
    assert page.do("pause_on_issue", on=True) is None
    settings = other.merged("settings")
    assert (settings["on_active_edit"], settings["pause_on_issue"]) == ("keep", True)
    assert page.do("on_active_edit", name="perhaps")


def test_conditions_are_shared_by_all_views_and_by_those_that_come_later(lab, page):
    other = lab.page("other")
    assert page.do("graph", mode="static") is None
    assert page.do("hold", on=True) is None
    for each in (other, lab.page("loaded again")):
        assert {**each.merged("settings"), "edits": "hold", "graph": "static"} == each.merged("settings")
    assert "`live` or `static` or `hidden`" in page.do("graph", mode="gone")


def test_locked_conditions_are_refused_to_a_page_and_not_to_python(lab, page):
    locked = Conditions("hold", "static", quiet=True, lock=True)
    lab.connection.texts.set_conditions(locked)
    for act in ({"act": "hold", "on": False}, {"act": "graph", "mode": "live"}):
        assert page.do(**act).startswith("This lab is locked for a study: ")
    assert lab.connection.texts.conditions == locked
    again = lab.page("loaded again").merged("settings")
    assert {"edits": "hold", "graph": "static", "quiet": True, "lock": True}.items() <= again.items()
    assert page.do("apply") is None
    lab.connection.texts.set_conditions(Conditions("hold"))
    assert page.do("hold", on=False) is None
    assert page.latest("settings")["edits"] == "live"


def test_the_pose_and_the_world_can_be_reset(lab, page):
    start = lab.session.bridge.world.robots[0].pose
    page.do("drag_robot", index=0, pose=[1.0, 1.0, 1.0])
    assert page.do("reset_pose", index=0) is None
    assert lab.session.frame.robot.robots[0].pose == pytest.approx(start)
    lab.session.call(lab.session.bridge.simulation.pen)
    page.do("step", value=20)
    assert page.do("reset_world") is None
    assert lab.session.frame.robot.marks == 0
    assert lab.session.frame.robot.robots[0].pose == pytest.approx(start)
    assert "no robot 3" in page.do("reset_pose", index=3)


def test_another_world_is_drawn_and_the_program_continues(lab, page):
    assert page.do("world", name="maze") is None
    assert page.last("world")["world"]["name"] == "maze"
    assert lab.session.frame.tick == 1
    page.do("step", value=2)
    assert "belongs to another world" in page.do("step_back", value=3)
    assert page.do("step_back", value=2) is None
    assert "no world" in page.do("world", name="paradise")


def test_a_robot_without_a_world_refuses_what_is_done_to_worlds(bench):
    page = bench(NEST).page()
    assert page.do("reset_world") == "`none` has no world that could be changed."


def test_a_dragged_state_stays_where_it_was_put_until_all_is_arranged(lab, page):
    assert page.do("pin", path="m", name="b", x=300, y=40) is None
    layout = page.latest("layouts")
    assert layout.keys() == {"m"}
    assert layout["m"]["places"]["b"] == {"x": 300.0, "y": 40.0}
    page.type(NEST.replace("(state b)", "(state b) (state c)"))
    assert page.latest("layouts")["m"]["places"]["b"]["x"] == 300.0
    assert page.do("arrange", path="m") is None
    assert page.latest("layouts")["m"]["places"]["b"]["x"] != 300.0


class Toy(Bridge):
    """A robot that asks for its address."""

    name = "toy"
    stop_timeout = None

    def __init__(self):
        self.pressed, self.host, self.stops = [], "", 0

    def open_interface(self):
        return self.panel()

    def panel(self):
        return Panel("Toy", buttons=(Button("beep", "Beep"),), questions=(Question("host", "Where?"),))

    def press(self, key, row="", values=None):
        self.pressed.append((key, row, values))

    def answer(self, key, value):
        self.host = value

    def stop(self):
        self.stops += 1


def test_nested_machines_are_drawn_inside_their_states_and_everything_returns_to_its_place(lab, page):
    def states():
        return {shape["id"]: shape for shape in page.merged("layouts")["m"]["states"]}

    page.do("pin", path="m", name="b", x=300, y=40)
    plain = states()
    assert page.do("nest", on=True) is None
    nested = states()
    (inside,) = nested["m/a"]["inside"]
    assert inside["machine"] == "m/a/inner"
    inner = page.merged("layouts")["m/a/inner"]
    left, top, width, height = inner["view"]
    assert nested["m/a"]["width"] >= width
    assert inside["x"] + left >= -nested["m/a"]["width"] / 2
    assert inside["y"] + top + height <= nested["m/a"]["height"] / 2

    # what is inside grows to the right: everything else in it stays where it is, and the state grows with it
    def at(name):
        (inside,) = states()["m/a"]["inside"]
        place = page.merged("layouts")["m/a/inner"]["places"][name]
        return [states()["m/a"][way] + inside[way] + place[way] for way in "xy"]

    before, wide = at("x"), nested["m/a"]["width"]
    place = inner["places"]["y"]
    page.do("pin", path="m/a/inner", name="y", x=place["x"] + 200, y=place["y"])
    assert states()["m/a"]["width"] > wide
    assert at("x") == pytest.approx(before, abs=0.11)

    page.do("nest", on=False)
    assert states() == plain


def test_the_first_panel_has_the_machines_laid_out_again_and_a_later_one_only_on_request(bench):
    text = "(machine m (state a) (state b) (state c) (eps a -> b) (eps b -> c)) (spawn m a)"
    page = bench(text).page()

    def width_and_height():
        return page.latest("layouts")["m"]["view"][2:]

    width, height = width_and_height()
    assert height > width
    assert page.do("fit", width=900, height=200) is None
    width, height = wide = width_and_height()
    assert width > height
    page.do("fit", width=200, height=900)
    assert width_and_height() == wide
    page.do("arrange", path="m")
    width, height = width_and_height()
    assert height > width


def test_a_panel_is_sent_and_its_buttons_and_questions_are_answered(bench):
    toy = Toy()
    lab = bench(NEST, bridge=toy)
    page = lab.page()
    assert page.latest("panel")["title"] == "Toy"
    assert page.do("panel", key="beep", values={"loud": "true"}) is None
    assert toy.pressed == [("beep", "", {"loud": "true"})]
    assert page.do("panel", key="host", values={"host": "10.0.0.2"}) is None
    assert toy.host == "10.0.0.2"
    stops = toy.stops
    assert page.do("panel", key="stop") is None
    assert toy.stops > stops


def test_hardware_is_shown_as_disarmed_and_can_be_armed(bench):
    lab = bench(NEST, bridge=Toy())
    page = lab.page()
    assert page.latest("bridge")["hardware"]
    assert not page.latest("bridge")["armed"]
    assert page.do("armed", on=True) is None
    assert page.latest("bridge")["armed"]


def test_a_session_made_elsewhere_keeps_its_bridge(lab, page):
    assert "created elsewhere" in page.do("bridge", name="none")


def test_a_command_without_an_id_gets_no_reply(lab, page):
    page.send("command", id=0, do="rate", value=50)
    lab.finish()
    assert not page.all("reply")
    assert lab.session.rate == 50


@pytest.mark.parametrize(
    ("act", "fields", "wrong"),
    [
        ("rate", {}, "`rate` needs `value`."),
        ("step", {"value": 1e9}, "`value` of `step` must be a whole number"),
        ("transition", {"path": []}, "`path` of `transition` must be a string"),
        ("reset_pose", {"index": -1}, "`index` of `reset_pose` must be"),
        ("pin", {"path": "m", "name": "b", "x": math.nan, "y": 0}, "`x` of `pin` must be a number"),
    ],
)
def test_a_command_of_the_wrong_form_is_refused_in_its_reply(lab, page, act, fields, wrong):
    assert page.do(act, **fields).startswith(wrong)
    assert lab.session.frame.tick == 1


def test_run_starts_a_session_again_that_failed_itself(lab, page, monkeypatch):
    for act in ("run", "reset"):
        with monkeypatch.context() as fault:
            fault.setattr(type(lab.session.interpreter), "step", lambda *_: {}["our own mistake"])
            with suppress(LRPError):  # once it runs, its own thread may be faster
                lab.session.run(1)
        lab.publish()
        assert page.latest("status") == "broken"
        assert "The session itself failed" in page.latest("reason")
        assert page.do(act) is None
        assert lab.session.fault == ""
    page.do("run")
    assert page.latest("status") == "running"
    assert page.latest("reason") == ""
