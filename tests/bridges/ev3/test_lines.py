"""Bluetooth and USB: the same frames on another line, with the same answers to faults."""

from __future__ import annotations

import errno
import socket
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from support.waiting import until

from lrp_jupyter.bridges.ev3 import EV3Bridge, lines, protocol, usb
from lrp_jupyter.bridges.ev3.client import BrickClient
from lrp_jupyter.bridges.ev3.finding import check_address, connect
from lrp_jupyter.bridges.ev3.lines import open_bluetooth
from lrp_jupyter.bridges.ev3.usb import open_usb
from lrp_jupyter.errors import BridgeError

pytestmark = pytest.mark.usefixtures("patient")

NAME = protocol.brick_name()
ADDRESS = "00:16:53:01:02:03"
SERIAL = "0016535a1b2c"
ANSWERS = [  # with how long is waited for them: an answer that comes is always in time
    ("half", "does not answer", 0.05),
    ("silent", "does not answer", 0.05),
    ("close", "closed the connection", 60),
    ("noise", "not a reply", 60),
]


def name_of(client: BrickClient) -> bytes:
    return client.request(*NAME).rstrip(b"\0")


# -- Bluetooth ----------------------------------------------------------------------------------------


@pytest.fixture
def bluetooth(monkeypatch: pytest.MonkeyPatch, make_brick: Callable[..., Any], clock: Any) -> Any:
    """A brick that is called by its Bluetooth address; a TCP connection stands for the serial port."""
    brick = make_brick(locked=False, clock=clock)

    class Called(socket.socket):
        def connect_ex(self, address: Any) -> int:
            assert address == (ADDRESS, 1)
            return super().connect_ex(("127.0.0.1", brick.port))

    monkeypatch.setattr(lines, "_rfcomm", partial(Called, socket.AF_INET, socket.SOCK_STREAM))
    return brick


@pytest.fixture
def called(bluetooth: Any) -> Iterator[BrickClient]:
    client = connect("00:16:53:01:02:03")
    yield client
    client.close()


def test_a_brick_answers_by_bluetooth_and_needs_no_unlocking(called, bluetooth):
    assert name_of(called) == b"SLOWPOKE"
    assert called.place == ADDRESS
    assert bluetooth.greetings == []


@pytest.mark.parametrize("fault", ["split", "merge"])
def test_replies_cut_or_joined_by_bluetooth_are_read(called, bluetooth, fault):
    bluetooth.fault = fault
    for _ in range(3):
        assert name_of(called) == b"SLOWPOKE"


@pytest.mark.parametrize(("fault", "sentence", "seconds"), ANSWERS)
def test_a_brick_that_does_not_answer_by_bluetooth_is_lost(called, bluetooth, fault, sentence, seconds):
    bluetooth.fault = fault
    with pytest.raises(BridgeError, match=sentence):
        called.request(*NAME, timeout=seconds)
    assert sentence in called.lost


def test_a_brick_that_left_the_reach_of_bluetooth_is_found_again_and_its_motors_are_stopped(bluetooth, clock):
    bridge = EV3Bridge(ADDRESS)
    bridge.clock = clock
    bridge.open()
    try:
        bridge.arm()
        bridge.robot.motorA.start_at_speed(50)
        bluetooth.hang_up()
        until(lambda: bluetooth.connections == 2 and bridge.status.state == "connected")
        assert "its motors were stopped" in bridge.status.sentence
        assert ADDRESS in bridge.status.sentence
        assert bridge.panel().questions[0].default == ADDRESS
        assert not bluetooth.motors[0].turning
    finally:
        bridge.close()


@pytest.mark.parametrize(
    ("code", "sentence"),
    [
        (errno.EHOSTDOWN, "does not answer. Switch it on, with Bluetooth"),
        (errno.ETIMEDOUT, "does not answer"),
        (errno.ECONNREFUSED, "It refuses. Pair it with this computer"),
        (errno.EACCES, "It refuses. Pair it"),
        (errno.EHOSTUNREACH, "switched off on this computer"),
        (errno.EIO, "Is it paired with this computer"),
    ],
)
def test_a_call_by_bluetooth_that_fails_says_why_and_what_to_do(monkeypatch, code, sentence):
    class Refused(socket.socket):
        def connect_ex(self, address: Any) -> int:
            return code

    monkeypatch.setattr(lines, "_rfcomm", Refused)
    with pytest.raises(BridgeError, match=f"No connection to the brick {ADDRESS} .*{sentence}"):
        connect(ADDRESS)


def test_a_call_by_bluetooth_can_be_given_up(monkeypatch):
    class Mute(socket.socket):
        """It is never connected, and never refused."""

        def __init__(self) -> None:
            own, self.other = socket.socketpair()
            super().__init__(fileno=own.detach())
            self.setblocking(False)
            try:
                while True:
                    self.send(bytes(4096))
            except BlockingIOError:  # not ready to send, as a socket that is being connected
                pass

        def connect_ex(self, address: Any) -> int:
            return errno.EINPROGRESS

        def close(self) -> None:
            self.other.close()
            super().close()

    monkeypatch.setattr(lines, "_rfcomm", Mute)
    asked = iter([False, False, True])
    with pytest.raises(BridgeError, match="does not answer"):
        open_bluetooth(ADDRESS, lambda: next(asked))


def test_a_python_without_bluetooth_says_so(monkeypatch):
    monkeypatch.delattr(socket, "AF_BLUETOOTH", raising=False)
    with pytest.raises(BridgeError, match=r"This Python was built without Bluetooth\. Use another"):
        EV3Bridge(ADDRESS).open()


def test_a_computer_without_bluetooth_says_so(monkeypatch):
    monkeypatch.setattr(socket, "AF_BLUETOOTH", 9999, raising=False)
    monkeypatch.setattr(socket, "BTPROTO_RFCOMM", 3, raising=False)
    with pytest.raises(BridgeError, match=r"This computer has no Bluetooth: .*by USB or WiFi"):
        connect(ADDRESS)


# -- USB ----------------------------------------------------------------------------------------------


@pytest.fixture
def listed(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Callable[..., None]:
    """List devices as Linux does: their number, vendor, product and serial number."""
    monkeypatch.setattr(usb, "_LISTED", tmp_path)

    def listed(
        number: int, vendor: str = "00000694", product: str = "00000005", serial: str = SERIAL
    ) -> None:
        folder = tmp_path / f"hidraw{number}" / "device"
        folder.mkdir(parents=True)
        facts = f"DRIVER=hid-generic\nHID_ID=0003:{vendor}:{product}\nHID_NAME=LEGO\nHID_UNIQ={serial}\n"
        (folder / "uevent").write_text(facts, encoding="utf-8")

    return listed


@pytest.fixture
def plugged(
    monkeypatch: pytest.MonkeyPatch, make_brick: Callable[..., Any], listed: Callable[..., None], clock: Any
) -> Any:
    """A brick that is plugged in, beside a mouse."""
    brick = make_brick(clock=clock)
    listed(0, vendor="0000046D", product="0000C077", serial="")
    listed(3)
    brick.opened = []

    def open_device(device: Path) -> Any:
        brick.opened.append(device)
        return brick.insert()

    monkeypatch.setattr(usb, "_open", open_device)
    return brick


@pytest.fixture
def client(plugged: Any) -> Iterator[BrickClient]:
    client = connect("USB")
    yield client
    client.close()


def test_a_brick_is_found_among_the_devices_and_answers_by_usb(client, plugged):
    assert name_of(client) == b"SLOWPOKE"
    assert (client.place, client.serial) == ("usb", SERIAL)
    assert plugged.opened == [Path("/dev/hidraw3")]
    client.command(protocol.stop(15, True))
    assert name_of(client) == b"SLOWPOKE"
    assert all(motor.braked for motor in plugged.motors)


@pytest.mark.parametrize(("fault", "sentence", "seconds"), ANSWERS[1:])  # a report is never halved
def test_a_brick_that_does_not_answer_by_usb_is_lost(client, plugged, fault, sentence, seconds):
    plugged.fault = fault
    with pytest.raises(BridgeError, match=sentence):
        client.request(*NAME, timeout=seconds)
    assert sentence in client.lost


def test_a_refused_command_is_no_loss_by_usb(client, plugged):
    plugged.fault = "refuse"
    with pytest.raises(BridgeError, match="refused"):
        client.request(*NAME)
    plugged.fault = ""
    assert name_of(client) == b"SLOWPOKE"


def test_an_answer_that_was_meant_for_another_program_is_dropped(monkeypatch, plugged):
    size = NAME[1]
    theirs = (3 + size).to_bytes(2, "little") + b"\x01\x00\x02" + b"another".ljust(size, b"\0")
    monkeypatch.setattr(usb, "_open", lambda _device: plugged.insert(theirs))
    client = connect("usb")
    assert name_of(client) == b"SLOWPOKE"
    client.close()


def test_a_cable_that_is_pulled_and_plugged_in_again_stops_the_motors(plugged, clock):
    bridge = EV3Bridge("usb")
    bridge.clock = clock
    bridge.open()
    try:
        bridge.arm()
        bridge.robot.motorA.start_at_speed(50)
        until(lambda: plugged.motors[0].turning)
        plugged.hang_up()
        until(lambda: plugged.connections == 2 and bridge.status.state == "connected")
        assert "its motors were stopped" in bridge.status.sentence
        assert not plugged.motors[0].turning
        assert [notice.kind for notice in bridge.safety.notices][:2] == ["armed", "fault"]
    finally:
        bridge.close()


def test_a_device_that_breaks_is_a_loss(client, monkeypatch):
    def broken(_number: int, _size: Any) -> bytes:
        raise OSError(errno.EIO, "Input/output error")

    monkeypatch.setattr(usb.os, "write", broken)
    with pytest.raises(BridgeError, match="connection to the brick broke: input/output error"):
        client.request(*NAME)


def test_a_closed_client_says_so(client):
    client.close()
    with pytest.raises(BridgeError, match="is closed"):
        client.request(*NAME)


def test_no_brick_at_usb_says_what_to_do(listed):
    listed(0, vendor="0000046D")
    with pytest.raises(BridgeError, match=r"No EV3 brick is plugged in by USB\. Plug it in"):
        EV3Bridge("usb").open()


def test_a_brick_with_another_serial_number_is_not_opened(plugged):
    with pytest.raises(BridgeError, match=f"number 1234 is plugged in .* Plugged in: {SERIAL}"):
        connect("usb", serial="1234")
    assert plugged.opened == []


def test_of_two_bricks_one_is_chosen_by_its_serial_number(plugged, listed):
    listed(4, serial="001653ffffff")
    with pytest.raises(BridgeError, match=f"2 EV3 bricks are plugged in. .*serial={SERIAL}"):
        connect("usb")
    connect("usb", serial="00:16:53:FF:FF:FF").close()
    assert plugged.opened == [Path("/dev/hidraw4")]


def test_a_device_that_may_not_be_opened_says_which_rule_to_write(plugged, monkeypatch):
    def forbidden(_device: Path) -> Any:
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr(usb, "_open", forbidden)
    with pytest.raises(BridgeError) as refused:
        connect("usb")
    for part in ("may not open /dev/hidraw3", "udev/rules.d", 'ATTRS{idVendor}=="0694"', "plug the brick in"):
        assert part in str(refused.value)


def test_a_device_that_cannot_be_opened_is_reported(plugged, monkeypatch):
    def gone(device: Path) -> Any:
        raise FileNotFoundError(errno.ENOENT, "No such file or directory", str(device))

    monkeypatch.setattr(usb, "_open", gone)
    with pytest.raises(BridgeError, match="/dev/hidraw3 cannot be opened: no such file"):
        connect("usb")


def test_a_computer_that_lists_no_devices_is_told_the_other_lines(monkeypatch, tmp_path):
    monkeypatch.setattr(usb, "_LISTED", tmp_path / "missing")
    with pytest.raises(BridgeError, match=r"on Linux only\. Connect it by WiFi or Bluetooth"):
        open_usb()


# -- addresses ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("typed", "address"),
    [
        (" usb", "usb"),
        ("USB", "usb"),
        ("localhost", "127.0.0.1"),
        ("192.168.1.7", "192.168.1.7"),
        ("00:16:53:5a:1b:2c", "00:16:53:5A:1B:2C"),
        ("0016535a1b2c", "00:16:53:5A:1B:2C"),
    ],
)
def test_an_address_is_written_in_one_way(typed, address):
    assert check_address(typed) == address


@pytest.mark.parametrize("typed", ["00:16:53:5a:1b", "00:16:53:5a:1b:2g", "001653:5a1b2c", "usb1"])
def test_what_is_nearly_an_address_is_refused(typed):
    with pytest.raises(BridgeError, match="is not the address of a brick"):
        check_address(typed)
