"""A session, its connection and pages, without a kernel, a thread or a real clock."""

from itertools import count

from lrp_jupyter.language.edits.rename import rename
from lrp_jupyter.live.session import Session
from lrp_jupyter.widgets.connection import PageConnection
from lrp_jupyter.widgets.text.kept import Kept
from lrp_jupyter.widgets.text.saver import Saver
from lrp_jupyter.widgets.text.texts import Texts
from lrp_jupyter.widgets.wire.changes import TextChanges, difference, from_units, to_units
from lrp_jupyter.widgets.wire.packing import packed, unpacked
from lrp_jupyter.widgets.wire.page_places import path_of


class Wall:
    """A clock that stands still until a test moves it."""

    def __init__(self):
        self.now = 100.0

    def __call__(self):
        return self.now


class Unpublished(PageConnection):
    """A connection that publishes only when the test calls it."""

    def start(self):
        pass


class Page:
    """A view in a page: sends hello, returns credit, keeps the messages that it receives."""

    def __init__(self, lab, name, part, pays):
        self.lab, self.name, self.pays = lab, name, pays
        self.messages, self.buffers, self.ids = [], [], count(1)
        self.units, self.revision, self.seq = "", 0, 0  # of its editor
        self.send("hello", part=part)

    def __call__(self, message, buffers):
        if message["view"] != self.name:
            return
        message = unpacked({"json": packed(message)})
        self.messages.append(message)
        self.buffers.append(buffers)
        if message["type"] == "snapshot":
            self.units, self.revision = to_units(message["text"]), message["revision"]
        if message["type"] == "answer":
            for update in message["updates"][self.revision - message["revision"] :]:
                self.units = TextChanges.from_json(update["changes"]).apply(self.units)
                self.revision += 1
        frame = message["frame"] if message["type"] == "frame" else None
        frame = message["frame"]["frame"] if message["type"] == "snapshot" else frame
        if frame is not None and self.pays:
            self.send("credit", frame=frame)

    def send(self, kind, /, **fields):
        self.lab.connection.receive(self, {"type": kind, "view": self.name, **fields})

    def do(self, act, **details):
        """Send a command; return the error of its reply."""
        return self.ask("command", do=act, **details)["error"]

    def ask(self, kind, /, **fields):
        number = next(self.ids)
        self.send(kind, id=number, **fields)
        self.lab.finish()
        return next(m for m in self.messages if m["type"] == "reply" and m["id"] == number)

    @property
    def text(self):
        """The text in its editor."""
        return from_units(self.units)

    def sends(self, text, at=None, **fields):
        """Type a text, with the cursor at an offset."""
        self.seq += 1
        changes = difference(self.units, to_units(text))
        updates = [] if changes.is_empty else [changes.json()]
        selection = None if at is None else [at, at]
        self.send("text", seq=self.seq, base=self.revision, updates=updates, selection=selection, **fields)

    def type(self, text, **fields):
        """Type a text; return its answer."""
        before = len(self.messages)
        self.sends(text, **fields)
        self.lab.publish()
        return next(m for m in self.messages[before:] if m["type"] == "answer")

    def rename(self, kind, path, name):
        """Rename an element as the editor does; return the answer."""
        text = rename(self.lab.session.program, kind, path_of(kind, path), name)
        return self.type(text, rename=[kind, path, name])

    def moves(self, at, meant=True):
        """Move the cursor to an offset, or leave the editor; return the answer, if there is one."""
        before = len(self.messages)
        selection = None if at is None else [at, at]
        self.send("cursor", seq=self.seq, revision=self.revision, selection=selection, meant=meant)
        self.lab.publish()
        return next((m for m in self.messages[before:] if m["type"] == "answer"), None)

    def all(self, kind):
        return [message for message in self.messages if message["type"] == kind]

    def last(self, kind):
        return self.all(kind)[-1]

    def frames(self):
        """Return all frames received, including that of the snapshot."""
        frame_of = {"frame": lambda message: message, "snapshot": lambda message: message["frame"]}
        return [
            frame_of[message["type"]](message) for message in self.messages if message["type"] in frame_of
        ]

    def latest(self, field):
        """Return the last value received for a field of a frame, in the snapshot or later."""
        return next(frame[field] for frame in reversed(self.frames()) if field in frame)

    def merged(self, field):
        """Return a field of the view state, merged from all frames as the page does; null is nothing."""
        value = None
        for frame in self.frames():
            new = frame.get(field, value)
            if isinstance(new, dict) and field in frame:
                known = value if isinstance(value, dict) else {}
                new = {name: entry for name, entry in {**known, **new}.items() if entry is not None}
            value = new
        return value


class Bench:
    """A session with its connection, and a wall clock that the test moves."""

    def __init__(self, text, folder=None, bridge="none", **options):
        """`text`: of a new session, or a session."""
        self.wall = Wall()
        self.session = text if isinstance(text, Session) else Session(text, bridge, **options)
        self.session.open()
        saver = Saver(Texts(), None if folder is None else Kept(folder, self.session.name))
        self.connection = Unpublished(self.session, saver, clock=self.wall)

    def page(self, name="page", part="lab", pays=True):
        return Page(self, name, part, pays)

    def publish(self, after=0.5):
        """Advance the wall time, and let the publisher do a round."""
        self.wall.now += after
        self.connection.publish()

    def finish(self):
        """Wait for the worker, then publish."""
        self.connection.work(lambda: None).result(60)
        self.publish()
