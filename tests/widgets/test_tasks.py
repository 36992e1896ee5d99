"""A lab where there are no threads: one event loop drives the program and publishes it."""

import asyncio
import threading

import pytest

from lrp_jupyter.live.session import Session
from lrp_jupyter.widgets.connection import PageConnection
from lrp_jupyter.widgets.text.saver import Saver
from lrp_jupyter.widgets.text.texts import Texts

TEXT = "(machine m (state a) (state b) (ontime 20 a -> b) (ontime 20 b -> a)) (spawn m a)"
RENAMED = "(machine m (state start) (state b) (ontime 20 start -> b) (ontime 20 b -> start)) (spawn m start)"


class View:
    """A view of the whole lab that returns credit for every frame."""

    def __init__(self, connection):
        self.connection, self.messages = connection, []
        self.send("hello", part="lab")

    def __call__(self, message, buffers):
        self.messages.append(message)
        frame = {"frame": lambda: message["frame"], "snapshot": lambda: message["frame"]["frame"]}
        if message["type"] in frame:
            self.send("credit", frame=frame[message["type"]]())

    def send(self, kind, /, **fields):
        self.connection.receive(self, {"type": kind, "view": "v", **fields})

    async def next(self, kind, condition=lambda message: True):
        for _ in range(5000):
            for message in self.messages:
                if message["type"] == kind and condition(message):
                    return message
            await asyncio.sleep(0.001)
        raise AssertionError(f"no {kind}")


@pytest.fixture
def scene():
    """Run a scenario with a lab in an event loop; no thread may start."""

    def run(scenario):
        async def alone():
            session = Session(TEXT, rate=100, driver="asyncio")
            connection = PageConnection(session, Saver(Texts()))
            before = set(threading.enumerate())
            session.start()
            try:
                await scenario(connection, View(connection))
                assert before.issuperset(threading.enumerate())
                assert connection.fault == session.fault == ""
            finally:
                connection.close()

        asyncio.run(alone())

    return run


def test_a_page_sees_the_program_run(scene):
    async def scenario(connection, view):
        first = await view.next("frame", lambda frame: "m/b" in frame.get("lit", []))
        await view.next(
            "frame", lambda frame: frame["frame"] > first["frame"] and "m/a" in frame.get("lit", [])
        )

    scene(scenario)


def test_commands_that_wait_elsewhere_are_done_at_once(scene):
    async def scenario(connection, view):
        await view.next("frame", lambda frame: frame.get("tick", 0) > 3)
        view.send("command", id=1, do="pause")
        assert (await view.next("reply"))["error"] is None
        tick = connection.session.frame.tick
        view.send("command", id=2, do="step_back", value=2)
        assert (await view.next("reply", lambda reply: reply["id"] == 2))["error"] is None
        assert connection.session.frame.tick == tick - 2

    scene(scenario)


def test_the_error_of_such_a_command_is_its_reply(scene):
    async def scenario(connection, view):
        view.send("command", id=1, do="version", key="unknown")
        assert "no longer kept" in (await view.next("reply"))["error"]

    scene(scenario)
