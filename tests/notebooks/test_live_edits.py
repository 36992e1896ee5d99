"""What the lessons tell the reader to type, and promise to show, is what happens; without waiting."""

from __future__ import annotations

import csv
import math
import re
from itertools import pairwise
from types import SimpleNamespace

import pytest
from stored import NOTEBOOKS, challenge_of, opened_program, options_of, read, sources, texts_of

from lrp_jupyter import Session
from lrp_jupyter.grading import Challenge
from lrp_jupyter.grading.attempt import attempt
from lrp_jupyter.grading.grade import jobs_of
from lrp_jupyter.sim.world import RobotSpec, World


class Typist:
    """Types what a notebook says into one of its labs."""

    def __init__(self, notebook: str, lab: str = "", seconds: float = 0, **options: object) -> None:
        stored = read(NOTEBOOKS / f"{notebook}.ipynb")
        self.said = re.sub(r"\s+", " ", "\n".join(sources(stored, "markdown")))
        labs = {opened_program(source): source for source in sources(stored, "code")}
        labs.pop(None, None)
        cell = labs[lab] if lab else next(iter(labs.values()))
        world = options_of(cell).get("world", "line" if challenge_of(cell) else "")
        robot = {"bridge": "sim", "world": world} if world else {}
        self.session = Session(cell.partition("\n")[2], **robot, **options)
        self.session.run(seconds)

    def types(self, typed: str, instead_of: str = "", before: str = "", after: str = "") -> Typist:
        """Replace a text that is there exactly once, or type a line before or after it."""
        assert re.sub(r"\s+", " ", typed).strip() in self.said, f"the notebook says nothing of {typed}"
        text, old = self.session.text, instead_of or before or after
        assert text.count(old) == 1, f"{old} is there {text.count(old)} times"
        new = typed if instead_of else f"{typed}\n{before}" if before else f"{after}\n{typed}"
        self.session.edit(text.replace(old, new))
        return self

    def deletes(self, text: str) -> Typist:
        assert self.session.text.count(text) == 1
        self.session.edit(self.session.text.replace(text, ""))
        return self

    def runs(self, seconds: float) -> Typist:
        self.session.run(seconds)
        return self

    def comes_to(self, state: str, within: float = 20) -> bool:
        return self.session.run(within, until=state)

    def resets(self) -> Typist:
        self.session.reset()
        if self.session.bridge is not None and hasattr(self.session.bridge, "reset_world"):
            self.session.call(lambda: self.session.bridge.reset_world())
        return self

    def places(self, x: float, y: float, heading: float = 0) -> Typist:
        self.session.call(lambda: self.session.bridge.place_robot((x, y, heading)))
        return self

    def is_active(self, state: str) -> bool:
        return self.session.frame.is_active(state)

    @property
    def found(self) -> set[str]:
        return {finding.code for finding in self.session.findings}

    @property
    def messages(self) -> str:
        return "\n".join(str(finding) for finding in self.session.findings)

    @property
    def restarts(self) -> int:
        return self.session.frame.restarts

    @property
    def x(self) -> float:
        return self.session.bridge.picture.robots[0].pose[0]

    def value(self, *path: str) -> object:
        return self.session.frame.values[path[-1]]

    def entered(self, state: str) -> int:
        return self.session.frame.count_of(state)


# -- 00: hello -----------------------------------------------------------------------------------------

HELLO = "00-hello-live-robot"


def test_the_first_robot_goes_all_the_way_around():
    hello = Typist(HELLO)
    furthest = [hello.runs(1).x for _ in range(40)]
    assert max(furthest) > 2.3
    assert min(furthest) < 0.7


@pytest.mark.slow
def test_the_first_robot_does_not_lose_its_line_while_the_lesson_is_read():
    hello = Typist(HELLO)
    turned = [hello.runs(10).session.bridge.robot.gyro.data for _ in range(30)]
    assert all(abs(after - before) < 5 for before, after in pairwise(turned)), "it never turns in circles"


def test_the_first_robot_continues_at_half_the_speed_and_with_tighter_curves():
    hello = Typist(HELLO, seconds=1).types("0.1", instead_of="0.2")
    assert hello.session.frame.tick == 10
    assert hello.session.frame.variables["forward",] == "0.1"
    hello.types("1.5", instead_of="1.0")
    furthest = [hello.runs(1).x for _ in range(60)]
    assert max(furthest) > 2.3
    assert min(furthest) < 0.7
    assert hello.restarts == 0


def test_a_missing_bracket_changes_nothing():
    hello = Typist(HELLO, seconds=1)
    before = hello.x
    whole = hello.session.text
    hello.session.edit(whole.replace("angular=bend)]))", "angular=bend)])"))
    assert "is not closed" in hello.messages
    hello.runs(2)
    assert hello.x > before + 0.1
    hello.session.edit(whole)
    assert not hello.found
    assert hello.restarts == 0


def test_a_change_inside_the_active_state_starts_the_first_program_over():
    hello = Typist(HELLO)
    assert hello.comes_to("right")
    hello.types("-2", instead_of="-bend")
    assert hello.restarts == 1
    assert hello.session.frame.restart_reason == "`right` is active and its `running` changed."


# -- 01: states and events -----------------------------------------------------------------------------

ROVER = "01-states-and-events"
AFTER_DRIVING = "(running [robot.move(linear=0.3)]))"


def _rover(seconds: float = 10) -> Typist:
    return Typist(ROVER, seconds=seconds)


def _complete_rover() -> Typist:
    rover = _rover().types("(event bump [robot.bumper.data])", after=AFTER_DRIVING)
    return rover.types("(state stopped)", before="(event").types(
        "(on bump driving -> stopped)", after="(event bump [robot.bumper.data])"
    )


def test_the_rover_pushes_the_wall_until_its_transition_is_typed():
    rover = _rover()
    assert rover.is_active("driving")
    assert 1.3 < rover.x - 1.5 < 1.45
    rover.types("(event bump [robot.bumper.data])", after=AFTER_DRIVING)
    assert rover.found == {"LRP403"}
    rover.types("(state stopped)", before="(event")
    assert rover.found == {"LRP401", "LRP403"}
    rover.types("(on bump driving -> stopped)", after="(event bump [robot.bumper.data])")
    assert not rover.found
    assert rover.runs(0.2).is_active("stopped")
    assert rover.restarts == 0


def test_the_rover_with_the_opposite_event_stops_where_it_stands():
    rover = _complete_rover().types("[not robot.bumper.data]", instead_of="[robot.bumper.data]").resets()
    assert rover.runs(1).is_active("stopped")
    assert abs(rover.x - 1.5) < 0.05


def test_the_rover_backs_away_to_the_opposite_wall():
    rover = _complete_rover().resets()
    assert rover.comes_to("stopped")
    rover.session.edit(
        rover.session.text.replace("(state stopped)", "(state stopped (running [robot.move(linear=-0.2)]))")
    )
    assert "(running [robot.move(linear=-0.2)])" in rover.said
    rover.resets().runs(30)
    assert rover.x < 0.2, "at the opposite wall, backwards"
    assert not rover.found


def test_a_misspelt_event_is_named_and_nothing_stops():
    rover = _complete_rover()
    rover.types("(on bumb driving -> stopped)", instead_of="(on bump driving -> stopped)").resets()
    assert "There is no event `bumb` here. Did you mean `bump`?" in rover.messages
    assert rover.runs(10).is_active("driving")


# -- 02: what a state does -----------------------------------------------------------------------------

DIARY = "02-what-a-state-does"


def _log(diary: Typist, *words: str) -> bool:
    return diary.value("log") == list(words)


def test_the_diary_is_as_the_answer_says():
    diary = Typist(DIARY, seconds=0.5)
    assert _log(diary, "in", "work", "work", "work", "out", "rest")
    assert str(diary.value("log")) in diary.said


def test_the_diary_is_written_tick_by_tick_as_its_table_says():
    diary = Typist(DIARY, seconds=2)
    diary.session.pause()
    diary.session.reset()
    lengths = []
    for _ in range(6):
        diary.session.step()
        lengths.append(len(diary.value("log")))
    assert lengths == [2, 3, 4, 6, 6, 6]


def test_the_first_enabled_transition_of_the_diary_wins():
    diary = Typist(DIARY, seconds=2).types("5", instead_of="4").resets().runs(2)
    assert _log(diary, "in", *["work"] * 4, "out", "rest")
    diary.types('(state party (onentry [log.append("party")]))', before="(on [len")
    party = "(on [len(log) == 5] work -> party)"
    diary.types(party, after="(on [len(log) == 5] work -> rest)").resets().runs(2)
    assert _log(diary, "in", *["work"] * 4, "out", "rest")
    diary.deletes(party).types(party, before="(on [len(log) == 5] work -> rest)").resets().runs(2)
    assert _log(diary, "in", *["work"] * 4, "out", "party")


# -- 03: time ------------------------------------------------------------------------------------------

ZIGZAG = "03-time-is-a-condition"


def _turned(zigzag: Typist, corners: int = 3) -> float:
    """Return the mean angle of the corners, in degrees."""
    robot = zigzag.session.bridge.robot
    zigzag.comes_to("straight")
    zigzag.comes_to("corner")
    before = robot.gyro.data
    for _ in range(corners):
        zigzag.comes_to("straight")
        zigzag.comes_to("corner")
    return (robot.gyro.data - before) * 57.2958 / corners


def test_the_zigzag_drives_a_triangle_and_then_other_shapes():
    zigzag = Typist(ZIGZAG)
    assert abs(_turned(zigzag) - 120) < 5
    zigzag.types("[1000 * degrees(90)]", instead_of="2100")
    assert abs(_turned(zigzag) - 92) < 1
    assert "So the robot turns for 1.6 seconds, which is 92°." in zigzag.said
    zigzag.types("[1000 * degrees(60)]", instead_of="[1000 * degrees(90)]")
    assert abs(_turned(zigzag) - 60) < 7


def test_the_zigzag_turns_at_once_when_its_time_is_over_already():
    zigzag = Typist(ZIGZAG, seconds=1.5)
    assert zigzag.is_active("straight")
    assert zigzag.types("1000", instead_of="2000").runs(0.2).is_active("corner")
    assert zigzag.restarts == 0


def test_between_its_turns_the_zigzag_moves_by_two_centimetres_in_two_milliseconds():
    zigzag = Typist(ZIGZAG)
    zigzag.comes_to("corner")
    zigzag.types("2", instead_of="2000")
    assert "the robot moves only 2 cm" in zigzag.said
    poses = []
    for state in ("straight", "corner") * 2:
        zigzag.comes_to(state)
        poses.append(zigzag.session.bridge.simulation.robot.pose)
    for before, after in (poses[:2], poses[2:]):
        assert 0.015 < math.dist(before[:2], after[:2]) < 0.022


def _pushing(seconds: float) -> Typist:
    """Let the knocker drive to the edge, and push there."""
    knocker = Typist(ZIGZAG, "knocker", seconds=1)
    while not knocker.session.bridge.robot.bumper.data:
        knocker.runs(0.1)
    return knocker.runs(seconds)


def test_the_knocker_gives_up_when_it_has_pushed_for_five_seconds_without_a_break():
    assert _pushing(4.5).comes_to("backing", 1)
    knocker = _pushing(4.5).places(2.5, 1)
    assert not knocker.comes_to("backing", 5)
    assert knocker.comes_to("backing", 3)


def test_another_condition_counts_from_its_edit_on():
    assert "type ` == 1` after `robot.bumper.data`" in Typist(ZIGZAG).said
    knocker = _pushing(4)
    knocker.session.edit(knocker.session.text.replace("bumper.data", "bumper.data == 1"))
    assert not knocker.comes_to("backing", 4.5)
    assert knocker.comes_to("backing", 1)
    assert knocker.restarts == 0


def test_another_delay_counts_at_once():
    knocker = _pushing(1.5)
    assert knocker.is_active("driving")
    assert knocker.types("1000", instead_of="5000").runs(0.2).is_active("backing")
    assert knocker.restarts == 0


def test_the_zigzag_begins_its_sides_slowly_and_ends_them_by_their_own_time():
    zigzag = Typist(ZIGZAG)
    assert zigzag.comes_to("corner")
    old = "(running [robot.move(linear=0.2)])"
    assert zigzag.session.text.count(old) == 1
    zigzag.session.edit(zigzag.session.text.replace(old, old.replace("0.2", "min(0.2, 0.1 * elapsed)")))
    assert "`min(0.2, 0.1 * elapsed)` instead of `0.2` in `straight`" in zigzag.said
    assert zigzag.comes_to("straight")
    speeds = [zigzag.runs(0.5).session.bridge.simulation.robot.command[0] for _ in range(3)]
    assert 0 < speeds[0] < speeds[1] < speeds[2] < 0.2
    by_time = "(ontime side straight -> corner)"
    zigzag.types("(on [elapsed > 1] straight -> corner)", instead_of=by_time).comes_to("corner")
    assert zigzag.comes_to("straight")
    began = zigzag.session.frame.time
    assert zigzag.comes_to("corner", 2)
    assert 1 < zigzag.session.frame.time - began < 1.3


def test_speed_times_time_is_the_angle_at_any_rate():
    zigzag = Typist(ZIGZAG, seconds=1)
    zigzag.types("(var turned := [0])", before="(var side")
    turns = "(running [robot.move(angular=1.0)])"
    assert "`[turned += 1.0 * dt]`" in zigzag.said
    zigzag.session.edit(zigzag.session.text.replace(turns, f"{turns[:-1]} [turned += 1.0 * dt])"))
    for rate in (10, 50):
        zigzag.session.rate = rate
        for _ in range(2):
            zigzag.comes_to("corner")
            zigzag.comes_to("straight")
        zigzag.runs(0.2)
        gyro = zigzag.session.bridge.robot.gyro.data
        assert abs(float(zigzag.value("turned")) - gyro) < 0.1


# -- 04: sensors ---------------------------------------------------------------------------------------

EYES = "04-what-the-robot-sees"


def test_the_eyes_wait_where_the_line_bends_and_go_on_when_they_are_put_back():
    eyes = Typist(EYES)
    assert eyes.comes_to("waiting")
    assert eyes.places(0.6, 0.5).comes_to("driving", 1)


def test_the_eyes_name_the_reading_that_was_meant():
    eyes = Typist(EYES, seconds=1)
    text = eyes.session.text.replace("white [robot.light", "white [robot.lihgt")
    eyes.session.edit(text)
    eyes.runs(1)
    assert "Did you mean `light`?" in eyes.session.issues[0].message
    assert eyes.is_active("driving")


def test_the_eyes_become_shy_of_the_wall_and_lose_their_shyness():
    eyes = Typist(EYES)
    eyes.types("(state shy)", before="(on white")
    eyes.types("(on [robot.distance.data < 0.3] driving -> shy)", before="(on white")
    eyes.places(2.9, 0.5)
    assert eyes.comes_to("shy", 2)
    eyes.types("(on [robot.distance.data > 0.4] shy -> driving)", before="(on white").runs(1)
    assert eyes.is_active("shy")
    assert eyes.places(0.6, 0.5).comes_to("driving", 1)


def test_the_asker_drives_on_to_a_longer_side_without_a_stop():
    asker = Typist(EYES, "asker", seconds=1)
    speed = asker.session.bridge.simulation.robot.command[0]
    asker.types("0.8", instead_of="0.4").runs(0.2)
    assert asker.session.bridge.simulation.robot.command[0] == speed == 0.2
    assert asker.comes_to("corner", 5)
    assert abs(asker.session.bridge.robot.odom.x - 0.8) < 0.01


def test_the_asker_gives_up_at_an_edge_and_says_so():
    asker = Typist(EYES, "asker", seconds=1)
    asker.types('(state stuck (onentry [robot.say("Help!")]))', before="(on [robot.drive_by")
    asker.types("(on [robot.drive_by.failed] side -> stuck)", before="(on [robot.drive_by").runs(0.2)
    assert asker.is_active("side")
    assert asker.restarts == 0
    asker.places(2.8, 1)
    assert asker.comes_to("stuck", 3)
    asker.runs(0.2)
    assert asker.session.frame.robot.robots[0].says == "Help!"


# -- 05: inside ----------------------------------------------------------------------------------------

SENTRY = "05-machines-inside-states"
SPAWN = "(onentry (spawn look left))"


def test_the_sentry_counts_its_turns_and_begins_with_0_each_time():
    sentry = Typist(SENTRY)
    for _ in range(2):
        assert sentry.comes_to("looking")
        assert sentry.session.frame.variables["sentry", "looking", "look", "turns"] == "0"
        assert sentry.runs(2.7).session.frame.variables["sentry", "looking", "look", "turns"] == "5"
        assert sentry.comes_to("driving")
        assert not sentry.session.frame.variables


def test_the_state_and_the_variable_of_the_look_end_the_look():
    sentry = Typist(SENTRY, seconds=1)
    sentry.types("(on look.right looking -> driving)", instead_of="(ontime 2800 looking -> driving)")
    assert sentry.comes_to("looking")
    assert sentry.runs(0.5).is_active("looking")
    assert sentry.comes_to("driving", 0.2)
    sentry.types("[look.turns == 4]", instead_of="look.right")
    assert sentry.comes_to("looking")
    assert sentry.runs(2.0).is_active("looking")
    assert sentry.comes_to("driving", 0.2)
    assert sentry.restarts == 0
    assert not sentry.session.issues


def test_a_variable_outside_all_machines_counts_on():
    sentry = Typist(SENTRY, seconds=1)
    sentry.types("(var turns := [0])", before="(machine sentry")
    sentry.session.edit(sentry.session.text.replace("      (var turns := [0])\n", ""))
    assert sentry.restarts == 0
    for counted in (6, 12):
        assert sentry.comes_to("looking")
        assert sentry.comes_to("driving")
        assert sentry.value("turns") == counted


def test_without_its_spawn_the_sentry_stands_and_the_issues_warn():
    sentry = Typist(SENTRY, seconds=1)
    sentry.types(SPAWN, instead_of=SPAWN).deletes(SPAWN)
    assert sentry.found == {"LRP402"}
    assert sentry.comes_to("looking")
    assert sentry.runs(1).session.frame.active == (("sentry", "looking"),)


# -- 06: from anywhere ---------------------------------------------------------------------------------

PATROL = "06-from-anywhere"
LOOK = """(state waiting
  (onentry (spawn look left))
  (machine look
    (var looks := [0])
    (state left (running [robot.move(angular=1.5)]) (onexit [looks += 1]))
    (state right (running [robot.move(angular=-1.5)]) (onexit [looks += 1]))
    (exit [looks == 4] left -> driving)
    (ontime 300 left -> right)
    (ontime 300 right -> left)
  ))"""


def test_a_bump_of_the_patrol_leads_to_backing_once_and_its_timer_is_left_alone():
    patrol = Typist(PATROL)
    assert patrol.comes_to("backing")
    patrol.runs(0.9)
    assert patrol.entered("backing") == 1
    assert patrol.comes_to("turning", 0.3)


def test_a_state_without_the_wildcard_pushes_on():
    def pushes(source: str) -> bool:
        patrol = Typist(PATROL, seconds=1)
        patrol.types(source, instead_of="*")
        patrol.session.edit(patrol.session.text.replace("ontime 2000 driving", "ontime 200 driving"))
        patrol.resets().comes_to("slow")
        patrol.places(0.98, 1)  # in front of the box
        patrol.runs(1)
        return patrol.is_active("slow")

    assert pushes("*-{slow}")
    assert not pushes("{driving slow}")


def test_the_patrol_looks_around_and_ends_its_look_by_itself():
    patrol = Typist(PATROL, seconds=1)
    patrol.types(LOOK, instead_of="(state waiting)").deletes("(ontime 500 waiting -> driving)")
    assert not patrol.found
    assert patrol.restarts == 0
    assert patrol.comes_to("waiting")
    assert patrol.comes_to("driving", 2)
    patrol.session.edit(patrol.session.text.replace("looks == 4", "looks == 3"))
    assert patrol.comes_to("waiting")
    assert not patrol.comes_to("driving", 20)
    patrol.session.edit(patrol.session.text.replace("looks == 3", "looks >= 3"))
    assert patrol.comes_to("driving", 2)
    patrol.session.edit(patrol.session.text.replace("left -> driving", "left -> lookout"))
    assert "where there is no `lookout`" in patrol.messages


def test_the_outer_machine_can_end_the_look_of_the_patrol():
    patrol = Typist(PATROL, seconds=1)
    patrol.types(LOOK, instead_of="(state waiting)").deletes("(exit [looks == 4] left -> driving)")
    patrol.types("(on [look.looks == 4] waiting -> driving)", instead_of="(ontime 500 waiting -> driving)")
    assert patrol.comes_to("waiting")
    assert not patrol.comes_to("driving", 1.1)
    assert patrol.comes_to("driving", 0.3)
    assert not patrol.session.issues


# -- 07: the line follower -----------------------------------------------------------------------------

STORY = "07-line-follower-live"
SEARCH = """(machine lookalgo
      (var time := [maxlook])
      (state lookleft (running [robot.move(angular=search)]))
      (state returnleft (running [robot.move(angular=-search)]))
      (ontime time lookleft -> returnleft)
      (ontime time returnleft -> lookright)
    )"""
RIGHT = """(state lookright (running [robot.move(angular=-search)]))
      (state returnright (running [robot.move(angular=search)]))
      (ontime time lookright -> returnright)
      (ontime time returnright -> lookleft)"""
BACK = """(var bumps := [0])
  (on [robot.bumper.data and bumps == 0] *-> bumpback)
  (on [robot.bumper.data and bumps == 1] *-> end)
  (state bumpback
    (running [robot.move(linear=-0.2)]))
  (state bumpturn
    (onentry [bumps = 1])
    (running [robot.move(angular=1.0)]))
  (state end
    (onentry [robot.stop()]))"""


def _turns_away_from_the_line(story: Typist) -> bool:
    """Drive until the robot has turned to one side for a second; return whether that took as long as said."""
    assert "after about 15 seconds" in story.said
    began, lasted = story.session.frame.time, 0
    while lasted < 10:
        story.runs(0.1)
        lasted = lasted + 1 if story.is_active("returnleft") else 0
    return 12 < story.session.frame.time - began < 20


@pytest.mark.slow
def test_the_story_of_the_line_follower_is_as_the_lesson_tells_it():
    story = Typist(STORY, "story")
    assert story.comes_to("looking")
    story.runs(3)
    assert story.is_active("looking")

    story.types(SEARCH, after="(onentry [robot.stop()])")  # 1
    assert story.runs(1).is_active("looking")
    assert story.restarts == 0
    assert story.found == {"LRP402", "LRP303"}

    spawning = "(onentry [robot.stop()] (spawn lookalgo lookleft))"  # 2
    story.types(spawning, instead_of="(onentry [robot.stop()])")
    assert story.restarts == 1
    assert story.comes_to("lookleft", 1)
    assert story.comes_to("moving", 5)
    assert _turns_away_from_the_line(story)
    story.runs(40)
    assert story.x < 0.7, "back at the near wall, where step 3 cannot be seen"

    assert _turns_away_from_the_line(story.resets())  # 3
    assert any(not issue.resolved for issue in story.session.frame.issues)
    story.session.pause()
    story.types(RIGHT, after="(state returnleft (running [robot.move(angular=-search)]))")
    assert not story.found
    story.session.resume()
    assert story.comes_to("lookright", 1)
    assert not [issue for issue in story.session.frame.issues if not issue.resolved]

    story.resets().runs(30)  # 4
    before = story.entered("lookleft")
    assert story.runs(10).entered("lookleft") - before > 5
    story.types("400", instead_of="200")
    assert (story.value("maxlook"), story.value("time")) == (400, 400)
    story.session.set_variable("maxlook", 200)
    assert (story.value("maxlook"), story.value("time")) == (200, 400)
    assert story.comes_to("moving")

    old = "(state returnright (running [robot.move(angular=search)]))"  # 5
    assert "(onexit [time = time * 2])" in story.said
    story.session.edit(story.session.text.replace(old, f"{old[:-1]} (onexit [time = time * 2]))"))
    story.types("200", instead_of="400").resets().runs(60)
    assert story.session.bridge.robot.bumper.data, "at the wall at its end"
    assert story.x > 2, "at the far wall"

    story.types(BACK, after="(on intheline looking -> moving)")  # 6
    story.session.edit(
        story.session.text.replace(
            "(on intheline looking -> moving)",
            "(on intheline looking -> moving)\n(ontime 1000 bumpback -> bumpturn)"
            "(ontime 3142 bumpturn -> looking)",
        )
    )
    story.resets()
    assert story.comes_to("end", 120)
    assert story.x < 0.7, "at the near wall"


# -- 11: two things at once ----------------------------------------------------------------------------

DASHES = "11-two-things-at-once"


def test_two_machines_drive_and_draw_and_agree():
    dashes = Typist(DASHES, seconds=1)
    assert len(dashes.session.frame.active) == 2
    dashes.types("800", instead_of="400")
    dashes.comes_to("up")
    dashes.types("(var dashes := [0])", after="; ms")
    old = "(onentry [robot.pen(True)])"
    assert "(onexit [dashes += 1])" in dashes.said
    dashes.session.edit(dashes.session.text.replace(old, f"{old} (onexit [dashes += 1])"))
    dashes.types("(state resting)", before="(ontime 3000")
    dashes.types("(on [dashes >= 10] *-> resting)", before="(ontime 3000")
    assert not dashes.found
    assert dashes.restarts == 0
    assert dashes.comes_to("resting", 60)
    assert dashes.value("dashes") == 10
    hand = dashes.entered("down")
    assert dashes.runs(5).entered("down") > hand
    assert dashes.is_active("resting")


# -- 09: playing with time -----------------------------------------------------------------------------

LEFTY = "09-playing-with-time"


def _after(lefty: Session, at: float, search: str, seconds: float) -> tuple[Session, float]:
    """Return the run from a moment on with another search, and how far to the right it came."""
    other = lefty.fork(at=at, program=re.sub(r"search := \[[-\d.]+\]", f"search := [{search}]", lefty.text))
    return other, max(_x(other, second) for second in range(int(seconds)))


def _x(session: Session, _: int) -> float:
    session.run(1)
    return session.bridge.picture.robots[0].pose[0]


def test_lefty_never_gets_past_the_first_bend_to_the_right():
    lefty = Typist(LEFTY, seconds=1)
    assert max(lefty.runs(1).x for _ in range(120)) < 1.5
    states = [lefty.session.at(second).active[0][1] for second in (4.2, 4.3, 7.0, 7.1)]
    assert "at 4.3 s" in lefty.said
    assert "at 7.1 s" in lefty.said
    assert states == ["moving", "looking", "looking", "moving"]


def test_two_edits_in_the_past_of_lefty_bring_it_to_the_wall():
    lefty = Typist(LEFTY, seconds=30)
    assert "`-1.0` instead of `1.0`" in lefty.said
    other, furthest = _after(lefty.session, 4.2, "-1.0", 25)
    assert 2.0 < furthest < 2.5, "through the bend to the right, and caught in the last one"
    assert {other.at(second).active[0][1] for second in (11.5, 12.0, 12.5, 13.0, 13.5)} == {"looking"}
    other, furthest = _after(other, 11.0, "1.0", 20)
    assert other.bridge.robot.bumper.data
    assert other.frame.restarts == 0


def test_an_edit_of_the_active_state_starts_lefty_over_in_the_past_too():
    lefty = Typist(LEFTY, seconds=10)
    edited = lefty.session.text.replace("angular=search", "angular=-search")
    assert lefty.session.fork(at=5.0, program=edited).frame.restarts == 1
    assert lefty.session.fork(at=4.2, program=edited).frame.restarts == 0


# -- 12: safe live editing -----------------------------------------------------------------------------

LORRY = "12-safe-live-editing"


def _lorry(text: str = "") -> Session:
    stored = read(NOTEBOOKS / f"{LORRY}.ipynb")
    names: dict[str, object] = {}
    definition, lab = (source for source in sources(stored, "code")[:2])
    exec(definition.replace("%load_ext lrp_jupyter", ""), names)
    lorry = Session(text or lab.partition("\n")[2], bridge=names["Careful"]())
    lorry.bridge.arm()
    return lorry


def test_the_lorry_drives_while_it_is_armed_and_stops_at_once_when_it_is_not():
    lorry = _lorry()
    assert lorry.bridge.hardware, "so a lab opens it disarmed"
    lorry.bridge.disarm()
    at = _x(lorry, 0)
    assert _x(lorry, 0) == at
    assert lorry.frame.is_active("driving"), "the program runs"
    lorry.bridge.arm()
    assert _x(lorry, 0) > at + 0.1
    lorry.bridge.disarm()
    at = _x(lorry, 0)
    assert _x(lorry, 0) == at


def test_what_stands_there_while_a_number_is_typed_is_as_the_lesson_says():
    lorry = _lorry()
    whole = lorry.text
    assert "`0.`, which is zero, and `0.1`" in Typist(LORRY, "lorry").said
    for typed, runs in (("0.", "0.0"), ("0.1", "0.1"), ("015", "0.1"), ("15", "15")):
        lorry.edit(whole.replace("[0.2]", f"[{typed}]"))
        lorry.run(0.2)
        assert lorry.frame.variables["forward",] == runs


def test_a_robot_stops_when_its_program_falls_silent_and_is_limited_when_it_is_too_fast():
    program = "(machine m (state a ({} [robot.move(linear={})])))(spawn m a)"
    silent = _lorry(program.format("onentry", 0.2))
    assert _x(silent, 0) == _x(silent, 0)
    assert "No command for 0.5 s" in silent.bridge.safety.notices[-1].text
    fast = _lorry(program.format("running", 15))
    fast.run(1)
    assert "limited" in fast.bridge.safety.notices[-1].text


# -- 13: a machine used twice --------------------------------------------------------------------------

DANCER = "13-a-machine-used-twice"
TO_THE_RIGHT = "(spawn circle driving (var side := [-1]))"


def _bend(dancer: Typist, state: str) -> float:
    """Return how fast the robot turns in a circle."""
    assert dancer.comes_to(state)
    return dancer.runs(0.3).session.bridge.simulation.robot.command[1]


def test_the_dancer_drives_an_eight_with_one_circle():
    dancer = Typist(DANCER)
    assert (_bend(dancer, "left"), _bend(dancer, "right"), _bend(dancer, "left")) == (0.8, -0.8, 0.8)
    assert dancer.session.frame.variables["dancer", "left", "circle", "side"] == "1"
    assert math.dist(dancer.session.bridge.simulation.robot.pose[:2], (1.5, 1)) < 0.2


def test_an_edit_of_the_machine_counts_for_both_and_one_of_a_spawn_for_its_own_use():
    dancer = Typist(DANCER, seconds=1).types("0.2", instead_of="0.25")
    assert (_bend(dancer, "left"), _bend(dancer, "right")) == (1, -1)
    smaller = "(spawn circle driving (var side := [-1]) (var radius := [0.1]))"
    dancer.types(smaller, instead_of=TO_THE_RIGHT)
    assert dancer.runs(0.1).session.bridge.simulation.robot.command[1] == -2
    assert _bend(dancer, "left") == 1
    dancer.types("[-0.5]", instead_of="[-1]")
    assert dancer.comes_to("right")
    before = dancer.session.bridge.robot.gyro.data
    assert dancer.comes_to("left")
    assert abs(before - dancer.session.bridge.robot.gyro.data - math.pi) < 0.3
    assert dancer.restarts == 0


def test_the_effect_counts_the_eights_and_takes_the_way_out():
    dancer = Typist(DANCER, seconds=1).types("(var eights := [0])", after="(machine dancer")
    back = "(on circle.done right -> left)"
    dancer.types("(on circle.done right -> left (effect [eights += 1]))", instead_of=back)
    assert dancer.restarts == 0
    for eights in (1, 2):
        assert dancer.comes_to("right")
        assert dancer.comes_to("left")
        assert dancer.value("eights") == eights
    dancer.types("(var way := [0])", after="(machine circle")
    dancer.types("(var last := [0])", after="(machine dancer")
    assert "`[way += 0.2 * dt]`" in dancer.said
    drives = "[robot.move(linear=0.2, angular=side * 0.2 / radius)]"
    dancer.session.edit(dancer.session.text.replace(drives, f"{drives} [way += 0.2 * dt]"))
    assert dancer.restarts == 1
    dancer.types("(effect [eights += 1; last = circle.way])", instead_of="(effect [eights += 1])")
    assert dancer.comes_to("right")
    assert dancer.comes_to("left")
    assert abs(dancer.value("last") - 2 * math.pi * 0.25) < 0.05
    assert not dancer.session.issues


def test_one_machine_drives_two_robots_each_with_its_own_speed_and_sensor():
    pair = Typist(DANCER, "pair", seconds=1)

    def speeds() -> list[float]:
        return [robot.command[0] for robot in pair.session.bridge.simulation.robots]

    assert speeds() == [0.2, 0.1]
    assert pair.types("0.15", instead_of="0.2").runs(0.1).restarts == 0
    assert speeds() == [0.15, 0.1]
    pair.types("[0.3]", instead_of="[0.1]").runs(0.1)
    assert speeds() == [0.15, 0.3]
    backs = [pair.runs(0.1) and speeds() for _ in range(60)]
    assert [0.15, -0.3] in backs
    assert not pair.session.issues


# -- 14: where am I ------------------------------------------------------------------------------------

WHERE = "14-where-am-i"
STRAIGHT_ON = "robot.move(linear=0.2)"


def _pacer() -> Typist:
    names: dict[str, object] = {}
    exec(sources(read(NOTEBOOKS / f"{WHERE}.ipynb"), "code")[0].replace("%load_ext lrp_jupyter", ""), names)
    return Typist(WHERE, "pacer", bridge=names["Worn"]())


def _beside(pacer: Typist) -> float:
    """Return how far the robot is beside its way when it has come to its end, in metres to the left."""
    assert pacer.resets().comes_to("there")
    return pacer.session.bridge.simulation.robot.pose[1] - 1.5


def test_the_pacer_bends_off_and_its_odometry_does_not_notice_that_it_is_lifted():
    pacer = _pacer()
    assert 0.55 < _beside(pacer) < 0.65
    assert "60 cm off course" in pacer.said
    read = pacer.runs(0.2).session.bridge.robot
    assert (read.odom.y, read.gyro.data) == pytest.approx((0.59, 0.46), abs=0.02)
    before = read.odom.x, read.odom.y
    pacer.places(1, 2).runs(0.2)
    assert (read.odom.x, read.odom.y) == pytest.approx(before)


def test_feedback_keeps_the_pacer_on_its_course_and_leads_it_to_another():
    pacer = _pacer()
    pacer.types("robot.move(linear=0.2, angular=0 - robot.gyro.data)", instead_of=STRAIGHT_ON)
    weakly = _beside(pacer)
    pacer.types("3 * (0 - robot.gyro.data)", instead_of="0 - robot.gyro.data")
    assert 0 < _beside(pacer) < weakly / 2 < 0.05
    before = pacer.restarts
    pacer.types("(var course := [0])", before="(var length")
    pacer.types("3 * (course - robot.gyro.data)", instead_of="3 * (0 - robot.gyro.data)")
    assert pacer.restarts == before, "it has come to its end, where nothing starts over"
    assert 0 < _beside(pacer) < 0.05
    before = pacer.resets().runs(3).restarts
    assert "`degrees(20)` instead of `0` after `course :=`" in pacer.said
    pacer.session.edit(pacer.session.text.replace("course := [0]", "course := [degrees(20)]"))
    assert pacer.runs(3).restarts == before
    assert pacer.session.bridge.robot.gyro.data == pytest.approx(math.radians(20), abs=0.02)


def test_odometry_drifts_and_the_gyro_does_not():
    printed = "".join(map(texts_of, read(NOTEBOOKS / f"{WHERE}.ipynb").cells))
    rows = re.findall(r"wrong by ([\d.]+) m and (\d+)°, the gyro by (\d+)°", printed)
    assert len(rows) == 3
    away, turned, gyro = zip(*[tuple(map(float, row)) for row in rows], strict=True)
    assert list(away) == sorted(away)
    assert list(turned) == sorted(turned)
    assert turned[-1] > 5 * turned[0], "one sees it"
    assert max(gyro) < 3


@pytest.mark.parametrize("battery", [1, 0.7])
def test_a_bend_ends_by_the_gyro_and_has_its_radius_whatever_the_battery_does(battery: float):
    bend = "robot.move(linear=0.2, angular=0.2 / 0.3)"
    assert f"`{bend}`, until `robot.gyro.data > degrees(180)`" in _pacer().said
    world = World((2, 2), (RobotSpec((1, 0.5, 0), wheels=(battery, battery)),))
    text = f"""(machine m (state bend (running [{bend}])) (state done (onentry [robot.stop()]))
      (on [robot.gyro.data > degrees(180)] bend -> done)) (spawn m bend)"""
    session = Session(text, "sim", world=world)
    assert session.run(20, until="done")
    assert session.bridge.simulation.robot.pose[1] - 0.5 == pytest.approx(0.6, abs=0.03)


# -- 15: how much --------------------------------------------------------------------------------------

KEEPER = "15-how-much"


def _at(keeper: Typist, metres: float) -> Typist:
    """Put the robot so far from the wall, in the middle of the room."""
    return keeper.places(3 - 0.08 - metres, 1)


def _errors(keeper: Typist, since: float = 0) -> list[float]:
    (error,) = keeper.session.plots(["error"])
    return [value for time, value in zip(error.times, error.values, strict=True) if time >= since]


def test_the_speed_of_the_keeper_is_in_proportion_to_its_error():
    keeper = Typist(KEEPER)
    for metres, speed in ((1.5, 0.5), (0.6, 0.05), (0.3, -0.1)):
        _at(keeper, metres).runs(0.1)
        assert keeper.session.bridge.simulation.robot.command[0] == pytest.approx(speed, abs=0.001)
    assert "0.5 m/s, 0.05 m/s, and -0.1 m/s" in keeper.said


def test_the_error_of_the_keeper_falls_ever_more_slowly():
    keeper = Typist(KEEPER, seconds=7)
    assert _errors(keeper)[-1] > 0.02
    assert "After about eight seconds the error is less than 2 cm" in keeper.said
    assert _errors(keeper.runs(1))[-1] < 0.02
    assert all(after <= before + 1e-9 for before, after in pairwise(_errors(keeper)))


def test_two_speeds_alone_never_bring_the_keeper_to_rest():
    keeper = Typist(KEEPER, seconds=1)
    keeper.types("(0.2 if error > 0 else -0.2)", instead_of="gain * error").runs(20)
    assert keeper.restarts == 1
    commands = [keeper.runs(0.1).session.bridge.simulation.robot.command[0] for _ in range(20)]
    assert set(commands) == {0.2, -0.2}


def test_the_gain_makes_the_keeper_quick_or_slow_or_lets_it_tremble():
    keeper = Typist(KEEPER, seconds=10)
    text = keeper.session.text
    times = {}
    for gain in ("2", "0.2", "20"):
        assert f"`{gain}` instead of" in keeper.said
        keeper.session.edit(text.replace("gain := [0.5]", f"gain := [{gain}]"))
        began = keeper.session.frame.time
        _at(keeper, 1.5).runs(30)
        errors = _errors(keeper, began + 0.15)
        times[gain] = next(index for index, error in enumerate(errors) if abs(error) < 0.02) / 10
        assert (max(errors[-20:]) - min(errors[-20:]) > 0.02) == (gain == "20"), "it trembles"
    assert keeper.restarts == 0
    assert "An issue says that this robot drives at 0.5 m/s at most" in keeper.said
    assert any("limited to 0.5" in notice.text for notice in keeper.session.bridge.safety.notices)
    assert times["2"] < 5
    assert 15 < times["0.2"] < 25


def test_the_numbers_of_the_keeper_are_written_for_a_spreadsheet(tmp_path, monkeypatch):
    keeper = Typist(KEEPER, seconds=3)
    (cell,) = (
        source for source in sources(read(NOTEBOOKS / f"{KEEPER}.ipynb"), "code") if "import csv" in source
    )
    monkeypatch.chdir(tmp_path)
    lab = SimpleNamespace(session=keeper.session)
    exec(cell.replace("from lrp_jupyter import Lab", ""), {"Lab": {"keeper": lab}.__getitem__})
    with open("error.csv", newline="") as file:
        rows = list(csv.reader(file))
    assert rows[0] == ["seconds", "metres"]
    assert [float(error) for _, error in rows[1:]] == pytest.approx(_errors(keeper))


def test_the_table_of_gains_is_as_the_lesson_explains_it():
    (printed,) = (text for cell in read(NOTEBOOKS / f"{KEEPER}.ipynb").cells if (text := texts_of(cell)))
    rows = re.findall(r"gain +([\d.]+): within 2 cm after +([\d.]+) s, ([\d.]+) cm beyond", printed)
    beyond = {float(gain): float(far) for gain, _, far in rows}
    assert [gain for gain, far in beyond.items() if far > 0] == [20]


@pytest.mark.parametrize(("gain", "weaves"), [(3, False), (15, False), (25, True)])
def test_the_robot_of_lesson_14_weaves_with_a_large_gain(gain: int, weaves: bool):
    pacer = _pacer()
    steering = f"robot.move(linear=0.2, angular={gain} * (degrees(20) - robot.gyro.data))"
    pacer.session.edit(pacer.session.text.replace(STRAIGHT_ON, steering))
    headings = [pacer.runs(0.1).session.bridge.robot.gyro.data for _ in range(80)]
    assert (max(headings[-20:]) - min(headings[-20:]) > 0.01) == weaves


# -- 16: testing your own program ----------------------------------------------------------------------

STOPPER = "16-testing-your-own-program"
TRIED = "worlds=[room(1), room(3), room(0.1)]"
FAILING = 'noise={"distance": 0.005, "dropout": 0.04}'
BLIND = """(state blind
    (onentry [robot.stop()])
  )
  (on [robot.distance.data > 1.9] driving -> blind)
  (on [robot.distance.data < 1.9] blind -> driving)"""


def _stopper() -> Typist:
    return Typist(STOPPER, "stopper")


def _tests(stopper: Typist, *typed: tuple[str, str]) -> dict[str, list[int]]:
    """Type into the cell of the tests; return with which seeds each world fails."""
    _, _, room, tests, *_ = sources(read(NOTEBOOKS / f"{STOPPER}.ipynb"), "code")
    for new, old in typed:
        assert f"`{new}`" in stopper.said, f"the notebook says nothing of {new}"
        assert tests.count(old) == 1
        tests = tests.replace(old, new)
    names: dict[str, object] = {}
    exec(room.replace("Lab, World, grade", "World"), names)
    exec(tests.partition("print(")[0], names)
    task = names["tests"]
    assert isinstance(task, Challenge)
    failed: dict[str, list[int]] = {}
    for job in jobs_of(stopper.session.text, task)[1]:
        made = attempt(job)
        failed.setdefault(made.world, []).extend([] if made.passed else [made.seed])
    return failed


@pytest.mark.slow
def test_the_stopper_is_tested_and_fails_where_the_lesson_says():
    stopper = _stopper()
    assert _tests(stopper) == {"wall after 1 m": []}
    one = ("worlds=[room(1), room(3)]", "worlds=[room(1)]")
    assert _tests(stopper, one) == {"wall after 1 m": [], "wall after 3 m": []}
    three, noise = (TRIED, "worlds=[room(1)]"), (FAILING, 'noise={"distance": 0.005}')
    only_near = {"wall after 1 m": [], "wall after 3 m": [], "wall after 0.1 m": [1]}
    assert _tests(stopper, three) == only_near
    assert _tests(stopper, three, noise) == only_near
    failed = _tests(stopper, three, noise, ("seeds=range(10)", "seeds=[1]"))
    assert failed["wall after 1 m"][0] == 0
    assert 1 not in failed["wall after 1 m"] + failed["wall after 3 m"]
    assert failed["wall after 0.1 m"] == list(range(10))


@pytest.mark.slow
def test_a_repair_of_the_stopper_breaks_what_had_passed_and_the_next_one_does_not():
    stopper = _stopper()
    kept = (TRIED, "worlds=[room(1)]"), (FAILING, 'noise={"distance": 0.005}'), ("seeds=[0, 1]", "seeds=[1]")
    near = {"wall after 0.1 m": [0, 1]}
    assert _tests(stopper, *kept) == {"wall after 1 m": [0], "wall after 3 m": [0], **near}
    stopper.types(BLIND, before="(on near")
    assert not stopper.found
    assert _tests(stopper, *kept) == {"wall after 1 m": [], "wall after 3 m": [0, 1], **near}
    slowly = "(running [robot.move(linear=0.08)])"
    blind = BLIND.replace("(onentry [robot.stop()])", slowly)
    assert f"`{slowly}` instead of the `(onentry [robot.stop()])` of `blind`" in stopper.said
    stopper.session.edit(stopper.session.text.replace(BLIND, blind))
    assert _tests(stopper, *kept) == {"wall after 1 m": [], "wall after 3 m": [], **near}
