"""The timeline of a page: what happened, looking at an earlier moment, running on from there, what if."""

import json

import pytest

PROGRAM = """\
(var speed := [0.2])
(machine m
  (var steps := [0])
  (state go (running [steps += 1; robot.move(linear=speed)]))
  (state turn (running [robot.move(angular=1.0)]))
  (on [steps > 9] go -> turn far)
  (ontime 500 turn -> go)
  (state fast))
(spawn m go)
"""


@pytest.fixture
def lab(bench):
    lab = bench(PROGRAM, bridge="sim", world="line")
    lab.session.run(4)
    return lab


@pytest.fixture
def page(lab):
    return lab.page()


FIELDS = ("status", "tick", "lit", "variables", "members", "looking", "reason", "issues")


def timeline(page, epoch=None, tick=0, plots=None):
    plots = plots or {}
    return page.ask("timeline", epoch=epoch, tick=tick, plots=plots)["timeline"]


def look(page, **moment):
    assert page.do("look", **moment) is None
    return state(page)


def state(page):
    """Return the view state that the page has."""
    return {field: page.merged(field) for field in FIELDS}


def pose(page):
    """Return the last pose of the robot that the page got."""
    return [buffers for buffers in page.buffers if buffers][-1][0][8:20]


def test_a_page_gets_what_happened_once(lab, page):
    told = timeline(page)
    entered = [each for each in told["happenings"] if each["kind"] == "entered"]
    assert [each["state"] for each in entered[:3]] == ["m/go", "m/turn", "m/go"]
    assert (entered[1]["by"], entered[1]["lane"], entered[1]["text"]) == ("m/far", "m", "`far` fired.")
    assert told["names"][:2] == ["speed", "m/steps"]
    lab.session.run(1)
    more = timeline(page, told["epoch"], told["last"])
    assert more["epoch"] == told["epoch"]
    assert more["kept"] == told["last"] - 1
    assert all(each["tick"] > more["kept"] for each in more["happenings"])
    lab.session.rewind(20)
    assert timeline(page, more["epoch"], more["last"])["kept"] == -1


def test_an_answer_is_plain_data_before_the_publisher_packs_it(lab):
    sent = []
    receive = lab.connection.receive
    receive(lambda message, _: sent.append(message), {"type": "hello", "view": "raw", "part": "lab"})
    request = {"type": "timeline", "view": "raw", "id": 1, "epoch": None, "tick": 0}
    receive(None, {**request, "plots": {"robot.odom.x": 0}})
    lab.finish()
    reply = next(message for message in sent if message["type"] == "reply")
    told = json.loads(json.dumps(reply))["timeline"]
    assert "m/far" in [each["by"] for each in told["happenings"]]
    values = told["plots"][0]["values"]
    assert values == [round(value, 8) for value in values]


def test_plots_come_with_their_thresholds_and_only_what_is_new(lab, page):
    told = timeline(page, plots={"m/steps": 0, "robot.light.data": 0})
    steps, light = told["plots"]
    assert steps["values"][:3] == [1, 2, 3]
    assert steps["thresholds"] == [{"text": "9", "values": [9.0] * 40}]
    assert len(light["values"]) == 40
    lab.session.run(1)
    assert len(timeline(page, told["epoch"], 40, plots={"m/steps": 40})["plots"][0]["values"]) == 10


def test_the_whole_view_state_shows_the_moment_looked_at(lab, page):
    lab.publish()
    lab.publish()
    now = state(page)
    past = look(page, tick=5)
    lab.publish()
    assert past["looking"] == {"tick": 5, "time": 0.4, "ago": 3.6, "edited": False}
    assert (past["tick"], past["lit"]) == (5, ["m/go"])
    assert past["variables"]["m/steps"][0] == "5"
    assert past["members"] != now["members"]
    assert look(page, time=2.05)["tick"] == 21
    assert look(page, time=2)["tick"] == 21
    assert look(page, time=0)["tick"] == 1
    assert look(page)["looking"] is None
    assert state(page)["variables"] == now["variables"]
    assert state(page)["members"] == now["members"]


def test_the_robot_pauses_while_its_past_is_looked_at_and_drives_on_after_it(lab, page):
    lab.session.start()
    look(page, tick=5)
    assert lab.session.status == "paused"
    look(page)
    assert lab.session.status == "running"
    lab.session.pause()
    look(page, tick=5)
    look(page)
    assert lab.session.status == "paused"


@pytest.mark.parametrize("act", ["run", "step", "step_back", "reset"])
def test_whatever_moves_the_robot_leads_back_to_the_present(lab, page, act):
    look(page, tick=5)
    assert page.do(act) is None
    lab.finish()
    assert state(page)["looking"] is None


@pytest.mark.parametrize(
    ("act", "details"),
    [
        ("transition", {"path": "m/turn"}),
        ("teleport", {"path": "m/turn"}),
        ("set_variable", {"path": "speed", "expression": "0.1"}),
    ],
)
def test_what_is_done_by_hand_is_done_in_the_present_and_shown_there(lab, page, act, details):
    look(page, tick=5)
    assert page.do(act, **details) is None
    assert state(page)["looking"] is None
    assert lab.session.status == "paused", "as it was before"


@pytest.mark.parametrize(
    ("act", "details"),
    [
        ("reset", {}),
        ("teleport", {"path": "m/turn"}),
        ("set_variable", {"path": "speed", "expression": "0.1"}),
    ],
)
def test_a_robot_that_was_paused_for_looking_drives_on_after_what_is_done_by_hand(lab, page, act, details):
    lab.session.start()
    look(page, tick=5)
    page.send("command", id=0, do=act, **details)
    lab.session.call(lambda: None)  # what was queued before is done then
    lab.publish()
    assert state(page)["looking"] is None
    assert lab.session.status == "running"


def test_run_on_from_the_moment_looked_at(lab, page):
    look(page, tick=5)
    assert page.do("run_from") is None
    assert lab.session.status == "running"
    lab.session.pause()
    assert 5 <= lab.session.frame.tick < 40
    lab.publish()
    assert state(page)["looking"] is None


def test_what_was_edited_while_looking_runs_on_from_there(lab, page):
    look(page, tick=5)
    lab.session.edit(PROGRAM.replace("steps > 9", "steps > 6"))
    lab.publish()
    assert state(page)["looking"]["edited"]
    assert state(page)["tick"] == 5
    page.do("run_from")
    lab.session.pause()
    assert "steps > 6" in lab.session.text
    assert lab.session.program.text == lab.session.text
    lab.session.run(1)
    entered = [each.time for each in lab.session.timeline().happenings if each.state == ("m", "turn")]
    assert entered[0] < 0.9


def test_an_edit_that_was_undone_is_none(lab, page):
    look(page, tick=5)
    lab.session.edit(PROGRAM.replace("steps > 9", "steps > 6"))
    lab.session.edit(PROGRAM)
    lab.publish()
    assert not state(page)["looking"]["edited"]
    page.do("run_from")
    lab.session.pause()
    assert lab.session.program.text == PROGRAM
    assert not any(each.kind == "edit" for each in lab.session.timeline().happenings)


def test_the_edited_program_is_shown_beside_what_was_recorded(lab, page):
    look(page, tick=5)
    lab.session.edit(PROGRAM.replace("steps > 9", "steps > 6"))
    what_if = page.ask("what_if", seconds=2)["what_if"]
    assert (what_if["tick"], what_if["begin"]) == (5, 0.4)
    assert what_if["divergence"]["text"] == "`turn` is entered; in the original run it is not."
    assert len(what_if["changed"]["way"]) == len(what_if["recorded"]["way"]) == 20
    assert what_if["changed"]["way"] != what_if["recorded"]["way"]


def test_the_last_seconds_of_a_value_are_asked_for_alone(lab, page):
    (steps,) = page.ask("plots", names=["m/steps"], event="", seconds=1)["plots"]
    assert (steps["name"], len(steps["times"])) == ("m/steps", 10)
    assert [each["text"] for each in steps["thresholds"]] == ["9"]
    assert "no event `late`" in page.ask("plots", names=[], event="late", seconds=1)["error"]


def test_the_courses_of_some_programs_are_told_at_once_and_the_running_one_is_left_alone(lab, page):
    programs = [PROGRAM.replace("angular=1.0", f"angular={turn}") for turn in (1.0, 1.5, 1.6)]
    frame = lab.session.frame
    told = page.ask("try_programs", programs=programs, seconds=3)["what_ifs"]
    assert [each["divergence"] is None for each in told] == [True, False, False]
    assert [(each["begin"], len(each["changed"]["way"])) for each in told] == [(frame.time, 30)] * 3
    assert (lab.session.frame.tick, lab.session.program.text) == (frame.tick, PROGRAM)
    refused = page.ask("try_programs", programs=[PROGRAM, "(machine"], seconds=3)
    assert refused["error"]
    assert not refused.get("what_ifs")


def test_a_collision_is_told_before_it_happens(lab, page):
    lab.session.edit(PROGRAM.replace("steps > 9", "steps > 900"))
    touch = page.ask("what_if", seconds=60)["what_if"]["changed"]["touch"]
    assert touch["text"].startswith("The robot touches ")
    assert touch["time"] > lab.session.frame.time
    assert lab.session.frame.tick == 40


def test_a_moment_that_is_not_recorded_is_refused_in_a_sentence(page):
    assert page.do("look", tick=1000) == "Tick 1000 is not remembered. Ask about ticks 1 to 40."
    assert page.do("run_from").startswith("The lab shows the present.")


def test_a_moment_that_is_not_recorded_does_not_pause_the_robot(lab, page):
    lab.session.start()
    assert page.do("look", tick=10**6).startswith("Tick 1000000 ")
    assert lab.session.status == "running"


def test_why_is_answered_about_the_moment_looked_at(page):
    look(page, tick=5)
    why = page.ask("why", kind="transition", path="m:far")["why"]
    assert (why["tick"], why["code"], why["name"]) == (5, "condition-false", "far")


def test_the_answer_has_the_name_of_its_sentence_also_of_a_transition_without_one(page):
    why = page.ask("why", kind="transition", path="m:ontime:turn->go")["why"]
    assert why["name"] == "500:turn->go"
    assert "`500:turn->go` (line 7)" in why["sentence"]
    assert page.ask("why", kind="state", path="m/turn")["why"]["name"] == "turn"


def test_the_pose_of_the_robot_is_that_of_the_moment(lab, page):
    look(page, tick=5)
    past = pose(page)
    look(page)
    far = pose(page)
    assert far != past
    look(page, time=0.4)
    assert pose(page) == past
