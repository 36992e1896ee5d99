"""The connection to a brick: every fault is answered in time by a sentence; by a wire, and by TCP."""

from __future__ import annotations

import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import Any

import pytest
from support.waiting import until

from lrp_jupyter.bridges.ev3 import finding, lines, protocol
from lrp_jupyter.bridges.ev3.client import BrickClient
from lrp_jupyter.bridges.ev3.finding import check_address, connect, parse_beacon
from lrp_jupyter.bridges.ev3.lines import NoBrickError, open_tcp
from lrp_jupyter.errors import BridgeError

NAME = protocol.brick_name()


def turning(ports: int, percent: int) -> bytes:
    """A slice of a motor that is to turn on."""
    return protocol.run_milliseconds(ports, percent, 600, brake=False)


def refused(match: str | None = None) -> Any:
    return pytest.raises(BridgeError, match=match)


@pytest.fixture
def served(make_brick: Callable[..., Any], clock: Any, patient: None) -> Any:
    """A brick that accepts TCP at once, with its motors in virtual time."""
    return make_brick(clock=clock)


@pytest.fixture
def caller(served: Any) -> Iterator[BrickClient]:
    """A client of it."""
    client = BrickClient(open_tcp(("127.0.0.1", served.port)))
    yield client
    client.close()


@pytest.fixture
def short(monkeypatch: pytest.MonkeyPatch) -> None:
    """Shorten the waits for answers that never come."""
    monkeypatch.setattr(lines, "_OPEN_TIME", 0.05)
    monkeypatch.setattr(finding, "_PAUSE", 0.01)


@pytest.fixture
def stranger() -> Iterator[Callable[[bytes | None], int]]:
    """Make TCP servers that are not bricks; each sends one message (None: nothing) and stays connected."""
    servers: list[socket.socket] = []
    threads: list[threading.Thread] = []

    def make(answer: bytes | None) -> int:
        server = socket.create_server(("127.0.0.1", 0))
        servers.append(server)

        def serve() -> None:
            connection, _ = server.accept()
            with connection, suppress(ConnectionResetError):  # a client that closes may leave data unread
                if answer is not None:
                    connection.sendall(answer)
                while connection.recv(100):
                    pass

        threads.append(threading.Thread(target=serve))
        threads[-1].start()
        return int(server.getsockname()[1])

    yield make
    for thread in threads:
        thread.join(120)
    for server in servers:
        server.close()


def test_a_brick_answers(client):
    assert client.request(*NAME).rstrip(b"\0") == b"SLOWPOKE"


def test_the_unlocking_text_is_that_of_the_documentation(caller, served):
    caller.request(*NAME)
    assert served.greetings == [b"GET /target?sn= VMTP1.0\r\nProtocol: EV3"]


def test_a_command_is_executed_without_an_answer(client, brick):
    client.command(turning(0b0101, 40))
    client.request(*NAME)
    assert [motor.turning for motor in brick.motors] == [40, 0, 40, 0]


@pytest.mark.parametrize("fault", ["split", "merge"])
def test_replies_cut_or_joined_by_the_network_are_read(caller, served, fault):
    served.fault = fault
    for _ in range(3):
        assert caller.request(*NAME).rstrip(b"\0") == b"SLOWPOKE"


@pytest.mark.parametrize(
    ("fault", "sentence"),
    [
        ("half", "does not answer"),
        ("silent", "does not answer"),
        ("close", "closed the connection"),
        ("noise", "not a reply"),
    ],
)
def test_a_brick_that_does_not_answer_as_it_should_is_lost(client, brick, air, fault, sentence):
    brick.fault, began = fault, air.now
    with refused(sentence):
        client.request(*NAME)
    assert air.now - began < 0.56, "half a second, and a look"
    brick.fault = ""
    with refused(sentence):
        client.command(protocol.stop(15, True))
    assert sentence in client.lost


def test_a_refused_command_is_an_error_and_no_loss(client, brick):
    brick.fault = "refuse"
    with refused("refused"):
        client.request(*NAME)
    brick.fault = ""
    assert client.request(*NAME).rstrip(b"\0") == b"SLOWPOKE"


def test_an_unplugged_brick_is_lost(client, brick):
    brick.unplug()
    with refused("does not answer"):
        client.request(*NAME)


def test_a_lost_connection_is_cut_so_that_nothing_under_way_arrives_later(caller, served):
    served.fault = "silent"
    with refused():
        caller.request(*NAME, timeout=0.05)
    caller.close()
    until(lambda: served.resets == 1)
    assert served.goodbyes == 0
    frames = len(served.frames)
    with refused():
        caller.command(turning(1, 50))
    assert len(served.frames) == frames


def test_a_closed_connection_delivers_what_was_sent_before(served):
    client = BrickClient(open_tcp(("127.0.0.1", served.port)))
    client.command(protocol.stop(15, True))
    client.close()
    until(lambda: served.goodbyes == 1)
    assert all(motor.braked for motor in served.motors)


def test_a_brick_that_accepts_no_more_bytes_is_lost(caller, served):
    served.unplug()
    with refused("accepts no commands"):
        for _ in range(10_000):  # until every buffer between here and the brick is full
            caller.command(protocol.stop(15, True) * 200, 0.05)


def test_a_question_that_waits_is_woken_by_the_loss_of_the_connection(client, brick):
    brick.fault = "silent"

    def give_up() -> None:
        with suppress(BridgeError):
            client.lose("somebody gave up")

    brick.waits = give_up
    with refused("somebody gave up"):
        client.request(*NAME, timeout=3600)


def test_a_command_does_not_wait_for_a_question_under_way(client, brick):
    brick.fault = "silent"

    def stop() -> None:
        stopping = threading.Thread(target=client.command, args=(protocol.stop(15, True),))
        stopping.start()
        stopping.join(60)
        assert brick.commands

    brick.waits = stop
    with refused("does not answer"):
        client.request(*NAME)
    assert all(motor.braked for motor in brick.motors)


def test_many_threads_share_a_connection(caller, served):
    wrong: list[object] = []

    def work(port: int) -> None:
        for _ in range(20):
            caller.command(turning(port, port))
            if caller.request(*NAME, timeout=60).rstrip(b"\0") != b"SLOWPOKE":
                wrong.append(port)

    threads = [threading.Thread(target=work, args=(1 << i,)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert wrong == []
    assert [motor.turning for motor in served.motors] == [1, 2, 4, 8]


@pytest.mark.parametrize("answer", [None, b"", b"HTTP/1.1 400 Bad Request\r\n\r\n", b"Accept:EV3", b"A" * 16])
def test_a_host_that_is_not_a_brick_is_reported(stranger, answer, free_udp_port, short):
    port = stranger(answer)
    with refused("is not an EV3 brick"):
        connect("127.0.0.1", port=port, beacon_port=free_udp_port)


def test_a_host_that_hangs_up_again_and_again_is_reported(free_udp_port, served, caller, monkeypatch):
    monkeypatch.setattr(finding, "_PAUSE", 0.01)
    caller.request(*NAME)  # the brick serves one client and hangs up on others
    with refused("hung up. Is another program connected to the brick"):
        connect("127.0.0.1", port=served.port, beacon_port=free_udp_port)


def test_a_brick_that_has_not_noticed_the_end_of_the_last_connection_is_tried_again(
    free_udp_port, served, caller
):
    caller.request(*NAME)
    attempts: list[None] = []

    def fails() -> bool:
        attempts.append(caller.close())
        return False

    again = connect("127.0.0.1", port=served.port, beacon_port=free_udp_port, cancelled=fails)
    assert attempts
    assert again.request(*NAME).rstrip(b"\0") == b"SLOWPOKE"
    again.close()


def test_an_address_where_nothing_is_gives_up_in_time(free_udp_port):
    with refused(r"No EV3 brick was found. No connection to 127.0.0.1:1: .*refused"):
        connect("127.0.0.1", port=1, beacon_port=free_udp_port, patience=0.05)


def test_without_address_and_beacon_the_search_gives_up_in_time(free_udp_port):
    with refused("No beacon"):
        connect(beacon_port=free_udp_port, patience=0.05)


def test_a_search_can_be_cancelled(free_udp_port):
    with refused("No EV3 brick was found"):
        connect(beacon_port=free_udp_port, patience=60, cancelled=lambda: True)


@pytest.mark.parametrize("address", ["", "ev3.local", "1.2.3", "1.2.3.4.5", "300.1.1.1", "[::1]"])
def test_what_is_not_an_address_is_refused_at_once(address):
    with refused("is not the address of a brick"):
        check_address(address)


def test_a_brick_is_found_by_its_beacon_and_unlocked_by_its_serial_number(make_brick, free_udp_port):
    brick = make_brick(free_udp_port)
    client = connect(beacon_port=free_udp_port, patience=3)
    assert client.place == "127.0.0.1"
    assert client.request(*NAME).rstrip(b"\0") == b"SLOWPOKE"
    assert brick.greetings == [b"GET /target?sn=0016535a1b2c VMTP1.0\r\nProtocol: EV3"]
    assert brick.answers >= 1
    client.close()


def test_a_brick_that_refuses_tcp_until_its_beacon_is_answered_is_found_by_its_address(
    make_brick, free_udp_port
):
    brick = make_brick(free_udp_port)
    with pytest.raises(BridgeError, match="refused"):
        BrickClient(open_tcp(("127.0.0.1", brick.port)))
    client = connect("127.0.0.1", port=brick.port, beacon_port=free_udp_port, patience=3)
    assert client.request(*NAME).rstrip(b"\0") == b"SLOWPOKE"
    client.close()


def test_where_an_address_is_given_tcp_needs_no_beacon(served, free_udp_port):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other_program:
        other_program.bind(("", free_udp_port))
        client = connect("127.0.0.1", port=served.port, beacon_port=free_udp_port)
    assert client.request(*NAME).rstrip(b"\0") == b"SLOWPOKE"
    client.close()


def test_a_beacon_that_cannot_be_received_is_reported(free_udp_port):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other_program:
        other_program.bind(("", free_udp_port))
        with refused(f"Cannot listen on UDP port {free_udp_port}"):
            connect(beacon_port=free_udp_port)


def test_the_beacon_of_another_brick_is_not_answered(make_brick, free_udp_port):
    brick = make_brick(free_udp_port)
    with refused("No beacon of it"):
        connect(serial="001653ffffff", beacon_port=free_udp_port, patience=0.1)
    assert (brick.answers, brick.connections) == (0, 0)


def test_a_brick_is_chosen_by_its_serial_number_as_people_write_it(make_brick, free_udp_port):
    make_brick(free_udp_port)
    client = connect(serial="00:16:53:5A:1B:2C", beacon_port=free_udp_port, patience=3)
    assert client.serial == "0016535a1b2c"
    client.close()


def test_a_beacon_is_read():
    data = b"Serial-Number: 0016533f0c1e\r\nPort: 5555\r\nName: EV3 of Ann\r\nProtocol: EV3\r\n"
    assert parse_beacon(data) == ("0016533f0c1e", 5555, "EV3 of Ann")


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"\xff\xfe\0",
        b"Port: 5555\r\n",
        b"Serial-Number: 1\r\nPort: x\r\nProtocol: EV3\r\n",
        b"Serial-Number: 1\r\nPort: 70000\r\nProtocol: EV3\r\n",
        b"Serial-Number: a b\r\nPort: 5555\r\nProtocol: EV3\r\n",
        b"Serial-Number: 1\r\nPort: 5555\r\nProtocol: NXT\r\n",
    ],
)
def test_another_datagram_is_not_a_beacon(data):
    assert parse_beacon(data) is None


def test_a_stranger_is_distinguished_from_an_absent_brick():
    assert issubclass(NoBrickError, BridgeError)
