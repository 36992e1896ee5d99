"""A session, its connection and pages, without a kernel, a thread or a clock of the wall."""

from itertools import count

import pytest

from lrp_jupyter.live.session import Session
from lrp_jupyter.widgets.connection import PageConnection
from lrp_jupyter.widgets.texts import Texts


class Wall:
    """A clock that stands until it is told to go on."""

    def __init__(self):
        self.now = 100.0

    def __call__(self):
        return self.now


class Unpublished(PageConnection):
    """A connection whose publisher is the test."""

    def start(self):
        pass


class Page:
    """What a view in a page does: say hello, give credit back, keep what it is told."""

    def __init__(self, lab, name, part, pays):
        self.lab, self.name, self.pays = lab, name, pays
        self.messages, self.buffers, self.ids = [], [], count(1)
        self.say("hello", part=part)

    def __call__(self, message, buffers):
        if message["view"] != self.name:
            return
        self.messages.append(message)
        self.buffers.append(buffers)
        frame = message["frame"] if message["type"] == "frame" else None
        frame = message["frame"]["frame"] if message["type"] == "snapshot" else frame
        if frame is not None and self.pays:
            self.say("credit", frame=frame)

    def say(self, kind, /, **fields):
        self.lab.connection.receive(self, {"type": kind, "view": self.name, **fields})

    def do(self, act, **details):
        """Have something done; give the reply's error."""
        return self.ask("command", do=act, **details)["error"]

    def ask(self, kind, /, **fields):
        number = next(self.ids)
        self.say(kind, id=number, **fields)
        self.lab.settle()
        return next(m for m in self.messages if m["type"] == "reply" and m["id"] == number)

    def type(self, text, seq=1):
        """Type a text; give its answer."""
        before = len(self.messages)
        self.say("text", seq=seq, base=0, text=text)
        self.lab.publish()
        return next(m for m in self.messages[before:] if m["type"] == "answer")

    def all(self, kind):
        return [message for message in self.messages if message["type"] == kind]

    def last(self, kind):
        return self.all(kind)[-1]

    def frames(self):
        """All frames that came, that of the snapshot too."""
        told = {"frame": lambda message: message, "snapshot": lambda message: message["frame"]}
        return [told[message["type"]](message) for message in self.messages if message["type"] in told]

    def told(self, field):
        """The last value of a frame's field that came, in the snapshot or later."""
        return next(frame[field] for frame in reversed(self.frames()) if field in frame)

    def knows(self, field):
        """A field of the view state as the page puts it together from all frames."""
        value = None
        for frame in self.frames():
            new = frame.get(field, value)
            if isinstance(new, dict) and isinstance(value, dict) and field in frame:
                new = {name: entry for name, entry in {**value, **new}.items() if entry is not None}
            value = new
        return value


class Bench:
    """A session with its connection, and a wall clock that the test moves."""

    def __init__(self, text, folder=None, bridge="none", **options):
        self.wall = Wall()
        self.session = Session(text, bridge, **options)
        self.session.open()
        self.connection = Unpublished(self.session, Texts(folder), clock=self.wall)

    def page(self, name="page", part="lab", pays=True):
        return Page(self, name, part, pays)

    def publish(self, after=0.5):
        """Let time pass on the wall, and the publisher do its round."""
        self.wall.now += after
        self.connection.publish()

    def settle(self):
        """Publish, after what was left to the worker."""
        self.connection.work(lambda: None).result(60)
        self.publish()


@pytest.fixture
def bench():
    made = []

    def make(*arguments, **options):
        made.append(Bench(*arguments, **options))
        return made[-1]

    yield make
    for each in made:
        each.connection.close()
        assert each.connection.fault == ""
