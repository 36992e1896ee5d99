"""The base for connections that block: never a thread that died unseen, and nothing sent twice."""

from __future__ import annotations

import socket
import threading
from collections.abc import Iterator
from contextlib import suppress

import pytest
from support.waiting import until

from lrp_jupyter.bridges.bridge import Bridge, ConnectionState
from lrp_jupyter.bridges.conformance import BridgeConformance
from lrp_jupyter.bridges.reconnecting import ReconnectingBridge
from lrp_jupyter.errors import BridgeError


class Robot:
    """A robot that talks lines over TCP: the counterpart, on a thread of its own."""

    def __init__(self) -> None:
        self.port = 0
        self.heard: list[str] = []
        self.clients: list[socket.socket] = []
        self.visits = 0
        self.over, self.talks = threading.Event(), False
        self.listen()
        threading.Thread(target=self._talk, daemon=True).start()

    def listen(self) -> None:
        self.listener = socket.create_server(("127.0.0.1", self.port))
        self.port = self.listener.getsockname()[1]
        threading.Thread(target=self._serve, args=(self.listener,), daemon=True).start()

    def _talk(self) -> None:
        while not self.over.wait(0.02):
            if self.talks and self.clients:
                with suppress(OSError):
                    self.say("7")

    def _serve(self, listener: socket.socket) -> None:
        while True:
            try:
                client, _ = listener.accept()
            except OSError:
                return
            self.clients.append(client)
            self.visits += 1
            with client, client.makefile("r") as lines:
                try:
                    for line in lines:
                        self.heard.append(line.strip())
                except OSError:
                    continue

    def say(self, words: str) -> None:
        self.clients[-1].sendall(f"{words}\n".encode())

    def hang_up(self) -> None:
        self.clients[-1].shutdown(socket.SHUT_RDWR)

    def cut(self) -> None:
        self.listener.shutdown(socket.SHUT_RDWR)  # wakes the thread that accepts
        self.listener.close()
        self.hang_up()

    def close(self) -> None:
        self.over.set()
        self.listener.close()
        for client in self.clients:
            client.close()


class Line(ReconnectingBridge):
    """About what a student writes."""

    name = "test-line"
    retry_after = 0.01
    connect_within = 2.0

    def __init__(self, port: int) -> None:
        self.port = port

    def add_members(self) -> None:
        self.feed("light.data", doc="0 dark ... 255 bright", type=int)
        self.add_method("move", self.move, "drive, in m/s")

    def connect(self) -> None:
        self.socket = socket.create_connection(("127.0.0.1", self.port), 1.0)
        self.socket.settimeout(0.2)

    def receive(self) -> None:
        try:
            words = self.socket.recv(100)
        except TimeoutError:
            return
        if not words:
            raise BridgeError("The robot hung up.")
        self.feed("light.data", int(words.split()[-1]))

    def disconnect(self) -> None:
        self.socket.close()

    def move(self, linear: float = 0.0) -> None:
        self.socket.sendall(f"move {linear}\n".encode())

    def stop(self) -> None:
        self.socket.sendall(b"stop\n")


@pytest.fixture
def robot() -> Iterator[Robot]:
    robot = Robot()
    yield robot
    robot.close()


@pytest.fixture
def line(robot: Robot) -> Iterator[Line]:
    """Open and armed; what it was told is not old, however long a test is held up."""
    line = Line(robot.port)
    line.fed.clock = lambda: 0.0
    line.open()
    line.arm()
    until(lambda: robot.visits == 1)
    yield line
    line.close()


def test_what_arrives_is_read_and_what_is_commanded_is_sent(line, robot):
    assert line.status.sentence == "`test-line` is connected."
    robot.say("7")
    until(lambda: line.describe("light.data").age is not None)
    assert line.robot.light.data == 7
    line.robot.move(linear=0.2)
    until(lambda: robot.heard == ["move 0.2"])


def test_a_lost_robot_is_refused_then_stopped_and_gets_nothing_a_second_time(line, robot):
    line.robot.move(linear=0.2)
    until(lambda: robot.heard == ["move 0.2"])
    port, line.port = line.port, 1
    robot.hang_up()
    until(lambda: line.status.state is ConnectionState.LOST)
    assert "The robot hung up. It is tried again." in [notice.text for notice in line.safety.notices]
    with pytest.raises(BridgeError, match=r"^`robot\.move` was not sent: "):
        line.robot.move(linear=0.9)
    until(
        lambda: (
            line.status.sentence == "`test-line` cannot be reached: Connection refused. It is tried again."
        )
    )
    line.port = port
    until(lambda: line.status.state is ConnectionState.CONNECTED)
    line.robot.move(linear=0.1)
    until(lambda: robot.heard[-1:] == ["move 0.1"])
    assert [words for words in robot.heard if words != "stop"] == ["move 0.2", "move 0.1"]
    assert robot.heard[-2:] == ["stop", "move 0.1"]
    robot.say("8")
    until(lambda: line.describe("light.data").age is not None)
    assert line.robot.light.data == 8


@pytest.mark.parametrize(
    ("fault", "sentence"),
    [
        (ValueError("not a number"), "`receive` raised ValueError: not a number. It is tried again."),
        (SystemExit(1), "`receive` raised SystemExit: 1. It is tried again."),
        (
            OSError(5, "Input/output error"),
            "`test-line` no longer answers: Input/output error. It is tried again.",
        ),
        (EOFError(), "`test-line` no longer answers: EOFError. It is tried again."),
    ],
)
def test_a_thread_that_receives_does_not_die_unseen(line, robot, fault, sentence):
    faults = [fault]
    receive = line.receive

    def fail_once() -> None:
        if faults:
            raise faults.pop()
        receive()

    line.receive = fail_once  # type: ignore[method-assign]
    until(lambda: sentence in [notice.text for notice in line.safety.notices])
    until(lambda: line.status.state is ConnectionState.CONNECTED)
    until(lambda: robot.visits == 2)
    robot.say("9")
    until(lambda: line.describe("light.data").age is not None)


def test_without_a_robot_opening_fails_in_a_sentence():
    with socket.socket() as unused:
        unused.bind(("127.0.0.1", 0))
        line = Line(unused.getsockname()[1])
        with pytest.raises(BridgeError, match=r"^`test-line` cannot be reached: Connection refused\.$"):
            line.open()
    assert line.status.state is ConnectionState.DISCONNECTED
    assert not line.is_open


def test_a_robot_that_does_not_answer_is_given_up(robot, monkeypatch):
    over, calls = threading.Event(), []
    monkeypatch.setattr(Line, "connect_within", 0.1)
    monkeypatch.setattr("lrp_jupyter.bridges.link._JOIN", 0.01)

    def connect(line: Line) -> None:
        over.wait(120)
        line.set_status("connected", "Connected at last.")

    monkeypatch.setattr(Line, "connect", connect)
    monkeypatch.setattr(Line, "disconnect", lambda line: calls.append("disconnect"))
    line = Line(robot.port)
    with pytest.raises(BridgeError, match=r"^`test-line` did not connect within 0\.1 s\.$"):
        line.open()
    with pytest.raises(BridgeError, match="has not ended yet"):
        line.open()
    over.set()
    assert line._kept_link is not None
    assert line._kept_link.has_ended(within=120)
    assert calls == ["disconnect"], "what came too late is closed"
    assert line.status.state is ConnectionState.DISCONNECTED


def test_closing_ends_a_wait_for_data(line, monkeypatch):
    monkeypatch.setattr("lrp_jupyter.bridges.link._CALM", 0.01)
    waiting, closed = threading.Event(), threading.Event()

    def receive() -> None:
        waiting.set()
        closed.wait(120)
        raise OSError("closed")

    def disconnect() -> None:
        Line.disconnect(line)
        closed.set()

    line.receive, line.disconnect = receive, disconnect  # type: ignore[method-assign]
    assert waiting.wait(120)
    line.close()
    assert line._kept_link is not None
    assert line._kept_link.has_ended(within=120)
    assert line.status.sentence == "`test-line` is closed."
    assert [notice.text for notice in line.safety.notices if notice.kind == "fault"] == []


def test_a_connection_may_have_a_sentence_of_its_own(robot):
    class Talkative(Line):
        name = "test-talkative"

        def connect(self) -> None:
            super().connect()
            self.set_status("connected", f"Connected to port {self.port}.")

    talkative = Talkative(robot.port)
    talkative.open()
    try:
        assert talkative.status.sentence == f"Connected to port {robot.port}."
    finally:
        talkative.close()


def test_the_waits_between_attempts_double_up_to_a_limit(line, robot, monkeypatch):
    monkeypatch.setattr(Line, "retry_after", 0.5)
    line._kept_link.close()
    for _ in range(2):
        line._kept_link.connect()
        assert [line._kept_link.lose("It is gone.") for _ in range(7)] == [0.5, 1.0, 2.0, 4.0, 8.0, 8.0, 8.0]
        line._kept_link.disconnect()


class TestLine(BridgeConformance):
    """It keeps the rules of every bridge, with a real connection that is silent, breaks and comes back."""

    moves = True

    @pytest.fixture(autouse=True)
    def _robot(self, robot: Robot) -> None:
        self.robot = robot

    def make_bridge(self) -> Line:
        self.robot.talks = True
        return Impatient(self.robot.port)

    def silence(self) -> None:
        self.robot.talks = False

    def cut(self) -> None:
        self.robot.cut()

    def restore(self) -> None:
        if self.robot.listener.fileno() < 0:
            self.robot.listen()

    def has_moved(self, bridge: Bridge) -> bool:
        return "move 0.05" in self.robot.heard


class Impatient(Line):
    name = "test-impatient-line"

    def add_members(self) -> None:
        super().add_members()
        self.feed("light.data", stale_after=0.3)


def test_it_is_no_robot_itself():
    from lrp_jupyter.bridges.discovery import find_bridges

    assert "reconnecting" not in find_bridges()
