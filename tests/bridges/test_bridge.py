"""The abstract bridge: thirty lines make a robot."""

from __future__ import annotations

import pytest

from lrp_jupyter.bridges.bridge import Bridge, MemberError, NullBridge
from lrp_jupyter.errors import BridgeError, NoDataYet


class Cart(Bridge):
    """A cart that writes down what it is told."""

    name = "test-cart"

    def __init__(self) -> None:
        self.sent: list[tuple[float, float]] = []
        self.light: int | None = 7

    def open_interface(self) -> None:
        self.add_variable("light.data", lambda: self.light, doc="0 dark ... 255 bright")
        self.add_method("move", self.move, doc="m/s and rad/s", limits={"linear": 0.5})

    def move(self, linear: float = 0.0, angular: float = 0.0) -> None:
        self.sent.append((linear, angular))


@pytest.fixture
def cart() -> Cart:
    cart = Cart()
    cart.open()
    cart.arm()
    return cart


def test_a_program_reads_and_commands_through_robot(cart: Cart) -> None:
    assert cart.robot.light.data == 7
    cart.robot.move(linear=0.2)
    assert cart.sent == [(0.2, 0.0)]


def test_an_unknown_member_names_the_existing_ones_and_the_nearest(cart: Cart) -> None:
    with pytest.raises(
        MemberError, match=r"`robot` has no `lihgt`; it has `light`, `move`. Did you mean `light`\?"
    ):
        cart.robot.lihgt  # noqa: B018


def test_hardware_opens_disarmed_and_records_what_it_does_not_send() -> None:
    cart = Cart()
    cart.open()
    cart.robot.move(linear=0.2)
    assert cart.sent == []
    assert cart.safety.commands[-1].arguments == {"linear": 0.2}
    assert not cart.safety.commands[-1].sent


def test_a_reading_that_is_not_there_yet_is_no_fault(cart: Cart) -> None:
    cart.light = None
    with pytest.raises(NoDataYet):
        cart.robot.light.data  # noqa: B018


def test_a_number_beyond_the_limit_is_brought_back(cart: Cart) -> None:
    cart.robot.move(linear=2)
    assert cart.sent == [(0.5, 0.0)]
    assert cart.safety.notices[-1].text == "`move`: linear 2 limited to 0.5"


def test_the_null_bridge_has_no_members() -> None:
    bridge = NullBridge()
    bridge.open()
    with pytest.raises(BridgeError, match="offers no members"):
        bridge.robot.move(linear=1)
