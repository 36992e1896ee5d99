"""The abstract bridge and the robot that a program sees of it."""

from __future__ import annotations

import copy
import json
import re
import threading
from collections import namedtuple
from dataclasses import dataclass
from typing import Any

import pytest
from support.robots import Bare

from lrp_jupyter.bridges import bridge as bridge_module
from lrp_jupyter.bridges.bridge import Bridge, ConnectionState, MemberError, NullBridge, Robot, Twist, attach
from lrp_jupyter.bridges.panel import Button, Field, Panel, Question, Table
from lrp_jupyter.errors import BridgeError, LRPError, NoDataYet
from lrp_jupyter.live.running.checking import check


@pytest.fixture
def bare() -> Bare:
    bare = Bare()
    bare.open()
    return bare


# -- robot ----------------------------------------------------------------------------------------


def test_a_program_reads_and_commands_through_robot(cart: Any) -> None:
    assert cart.robot.light.data == 7
    cart.robot.move(linear=0.2)
    cart.robot.move(0.1, angular=1)
    assert cart.sent == [(0.2, 0.0), (0.1, 1)]


def test_a_method_returns_what_the_bridge_returns(cart: Any) -> None:
    assert cart.robot.beep(2) == "440 Hz for 2 s"


def test_an_unknown_member_names_the_existing_ones_and_the_nearest(cart: Any) -> None:
    with pytest.raises(MemberError) as error:
        cart.robot.lihgt  # noqa: B018
    assert str(error.value) == (
        "`robot` has no `lihgt`; it has `battery`, `beep`, `light`, `move`, `stop`. Did you mean `light`?"
    )
    with pytest.raises(MemberError, match=r"`robot\.light` has no `dta`; it has `data`"):
        cart.robot.light.dta  # noqa: B018


def test_an_unknown_member_is_an_attribute_error_and_one_of_ours(cart: Any) -> None:
    assert not hasattr(cart.robot, "wings")
    assert issubclass(MemberError, AttributeError)
    assert issubclass(MemberError, LRPError)


def test_robot_without_members_explains_why() -> None:
    with pytest.raises(BridgeError, match=r"the bridge `none` offers no members\. Open it"):
        NullBridge().robot.move(linear=1)


def test_what_python_asks_of_every_object_is_answered_shortly(cart: Any) -> None:
    with pytest.raises(AttributeError, match=r"`robot` has no `_repr_html_`.$"):
        cart.robot._repr_html_  # noqa: B018
    assert not hasattr(cart.robot.move, "_repr_html_")
    assert not hasattr(Twist(), "_repr_html_")


def test_there_is_one_robot_however_often_it_is_copied(cart: Any) -> None:
    kept = {"robot": cart.robot, "light": cart.robot.light, "move": cart.robot.move}
    again = copy.deepcopy(kept)
    assert all(again[name] is kept[name] for name in kept)
    assert copy.copy(cart.robot) is cart.robot
    assert copy.copy(cart.robot.move) is cart.robot.move


def test_nothing_of_robot_can_be_assigned_or_deleted(cart: Any) -> None:
    with pytest.raises(MemberError, match=r"Call it as `robot\.move\(linear=0\.0, angular=0\.0\)`"):
        cart.robot.move = 1
    with pytest.raises(MemberError, match="is read from the robot and cannot be assigned"):
        cart.robot.light.data = 1
    with pytest.raises(MemberError, match=r"is a part of the robot .* It has `robot\.light\.data`"):
        cart.robot.light = 1
    with pytest.raises(MemberError, match=r"`robot` has no `ligth`.*Did you mean `light`"):
        cart.robot.ligth = 1
    with pytest.raises(MemberError, match="cannot be deleted"):
        del cart.robot.move
    with pytest.raises(MemberError, match=r"is a method and has no `linear`\. Call it"):
        cart.robot.move.linear = 0.2
    assert cart.robot.light.data == 7


def test_dir_and_repr_show_the_members(cart: Any) -> None:
    assert dir(cart.robot) == ["battery", "beep", "light", "move", "stop"]
    assert repr(cart.robot) == "<robot: battery, beep, light, move, stop>"
    assert repr(cart.robot.light) == "<robot.light: data>"
    assert repr(NullBridge().robot) == "<robot: no members>"
    assert repr(cart.robot.move).startswith("<robot.move(linear")


def test_robot_stays_the_same_object_when_members_and_bridges_change(cart: Any, bare: Bare) -> None:
    robot: Robot = cart.robot
    cart.add_variable("compass", lambda: 90, "heading")
    assert robot.compass == 90
    cart.remove_member("compass")
    assert not hasattr(robot, "compass")
    bare.add_variable("depth", lambda: 3, "below the surface")
    attach(robot, bare)
    assert dir(robot) == ["depth", "stop"]


# -- members --------------------------------------------------------------------------------------


def test_a_member_of_the_same_name_replaces_the_first(bare: Bare) -> None:
    bare.add_variable("x", lambda: 1)
    bare.add_variable("x", lambda: 2)
    assert bare.robot.x == 2
    assert [member.name for member in bare.members()] == ["stop", "x"]


@pytest.mark.parametrize("name", ["", "1st", "a b", "class", "_hidden", "a..b", "a.", "light.if"])
def test_a_name_that_cannot_be_written_after_robot_is_refused(bare: Bare, name: str) -> None:
    with pytest.raises(ValueError, match="not a valid name for a member"):
        bare.add_variable(name, lambda: 1)


def test_a_name_is_a_member_or_a_part_not_both(bare: Bare) -> None:
    bare.add_variable("light.data", lambda: 1)
    bare.add_variable("sound", lambda: 1)
    with pytest.raises(ValueError, match="`light` has members of its own"):
        bare.add_variable("light", lambda: 1)
    with pytest.raises(ValueError, match="`sound` is already a member"):
        bare.add_method("sound.level", lambda: 1)
    assert dir(bare.robot) == ["light", "sound", "stop"]


def test_removing_a_part_removes_all_in_it_and_removing_its_last_member_removes_the_part(bare: Bare) -> None:
    for name in ("arm.left.x", "arm.left.y", "arm.right", "leg.x"):
        bare.add_variable(name, lambda: 1)
    bare.remove_member("leg.x")
    assert dir(bare.robot) == ["arm", "stop"]
    bare.remove_member("arm.left")
    assert dir(bare.robot.arm) == ["right"]
    with pytest.raises(MemberError, match=r"no member `amr` to remove. Did you mean `arm`\?"):
        bare.remove_member("amr")


def test_members_know_type_unit_doc_value_and_age(cart: Any) -> None:
    assert cart.describe("battery").value is None
    cart.begin_tick(1.0, 0.1)
    cart.refresh()
    cart.begin_tick(1.5, 0.1)
    battery = cart.describe("battery")
    assert (battery.kind, battery.type, battery.unit, battery.doc) == (
        "variable",
        "float",
        "V",
        "what is left",
    )
    assert (battery.value, battery.age) == (0.5, 0.5)
    beep = cart.describe("robot.beep")
    assert (beep.kind, beep.doc) == ("method", "Sound a tone.")
    assert beep.signature == "(seconds, *, tone=440)"


def test_a_part_is_described_by_its_members(cart: Any) -> None:
    assert [field.name for field in cart.describe("light").fields] == ["light.data", "light.new", "light.age"]


Point = namedtuple("Point", "x y")


@dataclass
class Pose:
    """A reading with fields."""

    position: Point
    heading: float


class Slotted:
    """A reading as message libraries make them."""

    __slots__ = ("_private", "seconds")

    def __init__(self) -> None:
        self.seconds = 3
        self._private = 4


def test_the_fields_of_a_reading_are_described_to_any_depth(bare: Bare) -> None:
    bare.add_variable("odom", lambda: Pose(Point(1, 2), 0.5))
    bare.add_variable("stamp", Slotted)
    bare.refresh()
    assert bare.describe("odom.position.y").value == 2
    assert bare.describe("odom.heading").type == "float"
    assert [field.name for field in bare.describe("stamp").fields] == ["stamp.seconds"]
    with pytest.raises(MemberError, match=r"`robot\.odom\.position` has no `z`"):
        bare.describe("odom.position.z")
    with pytest.raises(MemberError, match=r"`robot` has no `odm`. Did you mean `odom`"):
        bare.describe("odm")


def test_fields_are_known_from_the_type_before_the_first_reading(bare: Bare) -> None:
    bare.add_variable("odom", lambda: None, type=Pose)
    assert [field.name for field in bare.describe("odom").fields] == ["odom.position", "odom.heading"]
    assert bare.describe("odom.heading").type == "float"


def test_an_annotation_that_cannot_be_resolved_still_names_its_field(bare: Bare) -> None:
    class Odd:
        speed: NoSuchType  # type: ignore[name-defined]  # noqa: F821

    bare.add_variable("odd", lambda: None, type=Odd)
    assert [(field.name, field.type) for field in bare.describe("odd").fields] == [
        ("odd.speed", "NoSuchType")
    ]


def test_a_value_that_contains_itself_is_described_all_the_same(bare: Bare) -> None:
    class Knot:
        def __init__(self) -> None:
            self.me = self

    bare.add_variable("knot", Knot)
    bare.refresh()
    assert bare.describe("knot.me.me").name == "knot.me.me"


def test_members_are_json_whatever_their_values(bare: Bare) -> None:
    for index, value in enumerate(
        (float("nan"), float("inf"), 1, True, "x" * 1000, object(), [1], Pose(Point(1, 2), 0))
    ):
        bare.add_variable(f"v{index}", lambda value=value: value)
    bare.refresh()
    text = json.dumps([member.as_dict() for member in bare.members()], allow_nan=False)
    assert len(text) < 5000


def test_members_may_change_while_other_threads_read_them(bare: Bare) -> None:
    failures: list[BaseException] = []
    done = threading.Event()

    def look() -> None:
        try:
            while not done.is_set():
                bare.members()
                dir(bare.robot)
        except BaseException as error:
            failures.append(error)

    thread = threading.Thread(target=look)
    thread.start()
    for round_ in range(300):
        bare.add_variable(f"a{round_ % 7}.b", lambda: 1)
        bare.remove_member(f"a{round_ % 7}")
    done.set()
    thread.join()
    assert not failures


# -- readings -------------------------------------------------------------------------------------


def test_a_reading_that_is_not_there_yet_is_not_a_fault(cart: Any) -> None:
    cart.light = None
    with pytest.raises(NoDataYet, match=r"`robot\.light\.data` has no data yet"):
        cart.robot.light.data  # noqa: B018


def test_a_getter_may_report_itself_that_there_is_no_data(bare: Bare) -> None:
    def getter() -> int:
        raise NoDataYet

    bare.add_variable("x", getter)
    with pytest.raises(NoDataYet):
        bare.robot.x  # noqa: B018


def test_a_getter_that_fails_is_a_bridge_error_with_its_cause(bare: Bare) -> None:
    bare.add_variable("x", lambda: {}["y"])
    bare.add_variable("z", lambda: object().wheel)  # type: ignore[attr-defined]
    with pytest.raises(BridgeError, match=r"`robot\.x` could not be read: KeyError: 'y'") as error:
        bare.robot.x  # noqa: B018
    assert isinstance(error.value.__cause__, KeyError)
    with pytest.raises(BridgeError, match=r"AttributeError: .* 'wheel'") as error:
        bare.robot.z  # noqa: B018
    assert not isinstance(error.value, AttributeError), "it must not look as if the member did not exist"


def test_the_sentence_of_a_failing_getter_is_kept(bare: Bare) -> None:
    def getter() -> int:
        raise BridgeError("the sensor is not plugged in")

    bare.add_variable("x", getter)
    bare.begin_tick(0.0, 0.1)
    for _ in range(2):
        with pytest.raises(BridgeError, match=r"^the sensor is not plugged in$"):
            bare.robot.x  # noqa: B018


def test_one_tick_sees_one_world(cart: Any) -> None:
    cart.begin_tick(0.0, 0.1)
    assert cart.robot.light.data == 7
    cart.light = 8
    assert cart.robot.light.data == 7
    cart.end_tick(0.0)
    assert cart.robot.light.data == 8, "between ticks a person sees what is there now"
    cart.begin_tick(0.1, 0.1)
    assert cart.robot.light.data == 8


def test_what_fails_is_tried_once_in_a_tick(cart: Any) -> None:
    cart.light = None
    cart.begin_tick(0.0, 0.1)
    for _ in range(3):
        with pytest.raises(NoDataYet):
            cart.robot.light.data  # noqa: B018
    assert cart.reads == 1


def test_what_is_not_read_is_not_fetched(cart: Any) -> None:
    cart.begin_tick(0.0, 0.1)
    cart.end_tick(0.0)
    cart.members()
    assert cart.reads == 0


def test_a_variable_with_another_source_has_no_data(bare: Bare) -> None:
    bare.add_variable("x", lambda: 1)
    bare.refresh()
    bare.add_variable("x", lambda: None)
    assert bare.describe("x").value is None


def test_a_bridge_may_know_the_age_better(bare: Bare) -> None:
    bare.add_variable("x", lambda: 1, age=lambda: 3.5)
    assert bare.describe("x").age == 3.5


# -- commands -------------------------------------------------------------------------------------


def test_a_wrong_argument_is_refused_with_the_right_one(cart: Any) -> None:
    with pytest.raises(BridgeError, match=r"unexpected keyword argument 'liner'\. Did you mean `linear`\?"):
        cart.robot.move(liner=1)
    with pytest.raises(BridgeError, match="missing a required argument: 'seconds'"):
        cart.robot.beep()
    with pytest.raises(BridgeError, match="must be a number, not 'fast'"):
        cart.robot.move(linear="fast")
    assert cart.sent == []


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ("fast", "not 'fast' (a text)."),
        ("0.2", "not '0.2' (a text). Write 0.2 without quotes."),
        ((0, 15), "not (0, 15) (a tuple). A decimal number has a point: 0.15."),
        (True, "not True (a truth value)."),
    ],
)
def test_what_is_not_a_number_is_refused_by_the_name_that_the_program_uses(wrong: Any, message: str) -> None:
    with pytest.raises(BridgeError, match=f"^{re.escape(f'`linear` must be a number, {message}')}$"):
        Twist(linear=wrong)
    with pytest.raises(BridgeError, match=f"^{re.escape(f'`msg.linear.x` must be a number, {message}')}$"):
        Twist().linear.x = wrong


def test_a_method_that_fails_is_a_bridge_error_with_its_cause(bare: Bare) -> None:
    def fail() -> None:
        raise OSError("unplugged")

    bare.add_method("kick", fail, "kick the ball")
    with pytest.raises(BridgeError, match=r"`robot\.kick` failed: OSError: unplugged") as error:
        bare.robot.kick()
    assert isinstance(error.value.__cause__, OSError)


def test_a_method_without_message_cannot_be_filled(cart: Any) -> None:
    with pytest.raises(BridgeError, match="does not accept a message"), cart.robot.beep:
        pass


def test_a_callable_without_signature_accepts_anything(bare: Bare) -> None:
    bare.add_method("lowest", min, "the smallest of numbers", command=False)
    assert bare.robot.lowest(3, 1, 2) == 1


# -- robot.stop() ---------------------------------------------------------------------------------


def test_every_robot_can_be_stopped_and_commanded_again_in_the_same_tick(cart: Any) -> None:
    cart.begin_tick(0.0, 0.1)
    cart.robot.move(linear=0.2)
    cart.robot.stop()
    cart.robot.move(linear=0.1)
    assert cart.sent == [(0.2, 0.0), (0.0, 0.0), (0.1, 0.0)]
    stop = cart.describe("stop")
    assert (stop.doc, stop.signature) == ("stop the robot", "()")


def test_a_stop_that_a_program_gives_is_a_command_like_others(disarmed: Any) -> None:
    disarmed.robot.stop()
    assert disarmed.sent == []
    assert disarmed.safety.commands[-1].name == "stop"


def test_after_a_stop_no_further_commands_are_expected(cart: Any) -> None:
    cart.begin_tick(0.0, 0.1)
    cart.robot.move(linear=0.2)
    cart.robot.stop()
    cart.end_tick(0.0)
    cart.begin_tick(0.6, 0.1)
    cart.end_tick(0.6)
    assert [notice.kind for notice in cart.safety.notices] == ["armed"]


def test_a_stop_that_fails_is_told_to_the_program(cart: Any) -> None:
    def stop() -> None:
        raise OSError("unplugged")

    cart.stop = stop
    with pytest.raises(BridgeError, match=r"^The robot may not have stopped: OSError: unplugged\.$"):
        cart.robot.stop()


def test_a_bridge_may_have_a_stop_of_its_own() -> None:
    braking = Bare(
        lambda it: it.add_method("stop", lambda brake=True: brake, "stop, with or without the brakes")
    )
    braking.open()
    assert braking.robot.stop(brake=False) is False
    assert len(braking.members()) == 1


def test_the_checks_know_that_it_can_be_stopped() -> None:
    known = Bare(lambda it: it.add_variable("depth", lambda: 3, "below the surface"), complete=True)
    text = "(machine m (state a (onentry [robot.stop()] [robot.halt()]))) (spawn m a)"
    (finding,) = check(text, bridge=known)
    assert finding.message == "`robot` has no `halt`. Write `robot.stop()`."


# -- life -----------------------------------------------------------------------------------------


@pytest.fixture
def noted() -> Bare:
    """It notes the life of its connection."""
    return Bare(notes="open_interface close_interface stop", hardware=True)


def test_opening_connects_once_and_returns_the_panel() -> None:
    opened: list[None] = []
    bridge = Bare(open_interface=lambda: (opened.append(None), Panel("Noted"))[1])
    assert bridge.status.state is ConnectionState.DISCONNECTED
    assert bridge.open() == bridge.open() == Panel("Noted")
    assert len(opened) == 1
    assert bridge.status.state is ConnectionState.CONNECTED
    assert bridge.is_open


def test_closing_stops_first_and_only_once(noted: Bare) -> None:
    noted.close()
    noted.open()
    noted.close()
    noted.close()
    assert noted.calls == ["open_interface", "stop", "close_interface"]
    assert noted.status.sentence == "`test-bare` is closed."
    noted.open()
    assert noted.is_open


def test_a_robot_that_is_not_there_is_a_bridge_error_and_a_status(noted: Bare) -> None:
    noted.failing["open_interface"] = BridgeError("nobody answers at 10.0.0.7")
    with pytest.raises(BridgeError, match=r"^nobody answers"):
        noted.open()
    assert noted.status.sentence == "nobody answers at 10.0.0.7"
    noted.failing["open_interface"] = OSError("no such port")
    with pytest.raises(BridgeError, match=r"`test-bare` could not be opened: OSError: no such port"):
        noted.open()
    assert not noted.is_open
    assert noted.status.state is ConnectionState.DISCONNECTED


def test_closing_continues_when_the_bridge_fails(noted: Bare) -> None:
    noted.open()
    noted.failing["close_interface"] = OSError("gone")
    noted.close()
    assert not noted.is_open
    assert noted.safety.notices[-1].text == "Closing `test-bare` failed: OSError: gone."


def test_closing_does_not_wait_for_ever(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bridge_module, "_CLOSING", 0.05)
    go = threading.Event()
    stuck = Bare(close_interface=go.wait, stop_timeout=60.0)
    stuck.open()
    stuck.close()
    assert stuck.safety.notices[-1].text == "Closing `test-bare` failed: no answer for 0.05 s."
    assert stuck.status.sentence == "`test-bare` is closed."
    go.set()


def test_a_bridge_that_fails_in_a_tick_is_lost_and_stopped_and_the_loop_continues(noted: Bare) -> None:
    noted.open()
    noted.failing["sense"] = BridgeError("the server is gone")
    for tick in range(3):
        noted.begin_tick(tick / 10, 0.1)
        noted.end_tick(tick / 10)
    assert noted.status.state is ConnectionState.LOST
    assert noted.status.sentence == "the server is gone"
    assert noted.calls.count("stop") == 1
    assert [notice.count for notice in noted.safety.notices] == [3]
    noted.failing["sense"] = ValueError("a mistake in sense")
    noted.begin_tick(0.3, 0.1)
    assert noted.safety.notices[-1].text == "`sense` raised ValueError: a mistake in sense."


def test_a_bridge_sets_its_own_status() -> None:
    bridge = Bare(open_interface=lambda: bridge.set_status("disconnected", "waiting for the address"))
    bridge.open()
    assert bridge.status.sentence == "waiting for the address"
    bridge.set_status(ConnectionState.STALE)
    assert bridge.status.sentence == "`test-bare` is stale."
    with pytest.raises(ValueError, match="not a valid ConnectionState"):
        bridge.set_status("fine")


def test_a_bridge_without_open_interface_cannot_be_made() -> None:
    class Half(Bridge):
        name = "test-half"

    with pytest.raises(TypeError, match="open_interface"):
        Half()  # type: ignore[abstract]


def test_armed_hardware_cannot_step_back(cart: Any) -> None:
    with pytest.raises(BridgeError, match="a real robot cannot step back"):
        cart.rewind(cart.moment())
    cart.disarm()
    cart.rewind(cart.moment())


# -- panel ----------------------------------------------------------------------------------------


def test_a_panel_is_plain_data() -> None:
    panel = Panel(
        "Robot",
        fields=(Field("speed", "Speed", "number", "0.2", unit="m/s"),),
        tables=(
            Table(
                "topics",
                "Topics",
                ("name", "type"),
                ("odom",),
                (("odom", "Odometry"),),
                (Button("x", "Remove"),),
            ),
        ),
        questions=(Question("host", "Address", "127.0.0.1"),),
    )
    data = json.loads(json.dumps(panel.as_dict()))
    assert data["buttons"] == [{"key": "stop", "label": "Stop robot"}]
    assert data["fields"][0]["kind"] == "number"
    assert data["tables"][0]["rows"] == [["odom", "Odometry"]]
    question = {"key": "host", "text": "Address", "default": "127.0.0.1", "button": "Connect"}
    assert data["questions"] == [question]


def test_a_table_has_a_key_and_a_text_for_each_column_in_every_row() -> None:
    with pytest.raises(ValueError, match="needs a key for each row"):
        Table("t", "T", ("a",), (), (("1",),))
    with pytest.raises(ValueError, match="a text for each column"):
        Table("t", "T", ("a", "b"), ("k",), (("1",),))


def test_the_stop_button_works_on_every_bridge_and_others_are_refused() -> None:
    bridge = Bare(open_interface=lambda: Panel("Noted"), notes="stop")
    bridge.open()
    bridge.press("stop")
    assert bridge.calls == ["stop"]
    with pytest.raises(BridgeError, match="no button `dance`"):
        bridge.press("dance")
    with pytest.raises(BridgeError, match="has no option `host`"):
        bridge.answer("host", "10.0.0.7")
    assert bridge.panel() == Panel("Noted")
    assert bridge.simulated is None


@pytest.mark.parametrize("words", ["the cable is missing", "The cable is missing."])
def test_the_sentence_about_a_foreign_exception_ends_with_one_full_stop(noted, words):
    noted.failing["open_interface"] = RuntimeError(words)
    with pytest.raises(BridgeError):
        noted.open()
    assert noted.status.sentence == f"RuntimeError: {words.rstrip('.')}."


def test_hardware_without_a_panel_of_its_own_has_its_status_and_a_stop() -> None:
    waiting = ("waiting for data", "Waiting for the first value.")
    bridge = Bare(open_interface=lambda: bridge.set_status(*waiting), hardware=True, notes="stop")
    assert bridge.panel() is None
    bridge.open()
    panel = bridge.panel()
    assert panel is not None
    assert [field.value for field in panel.fields] == ["Waiting for the first value."]
    bridge.press(panel.buttons[0].key)
    assert bridge.calls == ["stop"]
    bridge.close()


def test_a_simulation_without_a_panel_has_none(bare: Bare) -> None:
    assert bare.panel() is None
