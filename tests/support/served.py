"""A browser's part of the page of a run, in Python: what it asks for, and what it is told."""

import json
import re
import ssl
from collections import deque
from contextlib import contextmanager, suppress
from urllib.parse import urlsplit

from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from support.waiting import until

WAIT = 120


class ServedRun:
    """A run that serves its page."""

    def __init__(self, started, output):
        self.process, self.output = started, output
        link = until(lambda: re.search(r"(https?://\S+#token=\S+)\s", output.read_text()), output.read_text)
        self.link = link[1]
        self.address, _, self.token = self.link.partition("/#token=")
        self.place = urlsplit(self.address).netloc
        self.visitors = []

    def says(self, words):
        until(lambda: words in self.output.read_text(), lambda: self.output.read_text())

    def connect(self, origin=None, **options):
        """Open a WebSocket, as a page of this origin does."""
        address = f"{self.address.replace('http', 'ws', 1)}/socket"
        if self.address.startswith("https"):
            options["ssl"] = ssl._create_unverified_context()
        return connect(address, origin=origin or self.address, max_size=None, compression=None, **options)

    @contextmanager
    def visitor(self, view="me"):
        """A page with a lab, from hello on."""
        with self.connect() as socket:
            socket.send(self.token)
            yield Visitor(socket, view)


class Visitor:
    """A page that has shown the token."""

    def __init__(self, socket, view):
        self.socket, self.view, self.number, self.seq = socket, view, 0, 0
        self.about = json.loads(socket.recv(WAIT))
        self.say("hello", part="lab")
        self.snapshot = self.get("snapshot")

    def say(self, kind, /, **fields):
        self.socket.send(json.dumps({"type": kind, "view": self.view, **fields}))

    def get(self, kind, holds=lambda message: True):
        """The next message of a kind for which a condition holds; frames are acknowledged meanwhile."""
        seen = deque(maxlen=20)
        return until(lambda: self._next(kind, holds, seen), lambda: f"no such {kind}: {[*seen]}")

    def _next(self, kind, holds, seen):
        """The next message, if it is of the kind and the condition holds."""
        data = self.socket.recv(WAIT)
        if isinstance(data, bytes):
            return None
        message = json.loads(data)
        seen.append({key: each for key, each in message.items() if key not in ("time", "tick", "robot")})
        if message["type"] in ("snapshot", "answer"):
            self.revision = message["revision"]
        if message["type"] == "frame":
            with suppress(ConnectionClosed):  # and this is one of its last
                self.say("credit", frame=message["frame"])
        is_meant = message["type"] == kind and message["view"] == self.view and holds(message)
        return message if is_meant else None

    def ask(self, kind, /, **fields):
        """Ask, and return the reply."""
        self.number += 1
        self.say(kind, id=self.number, **fields)
        return self.get("reply", lambda message: message["id"] == self.number)

    def do(self, act, /, **fields):
        """Do something, and return the error."""
        return self.ask("command", do=act, **fields)["error"]

    def type(self, sections):
        """Send what was typed into the newest text; return the answer."""
        self.seq += 1
        self.say("text", seq=self.seq, base=self.revision, updates=[sections], selection=None)
        return self.get("answer", lambda message: message["seq"] == self.seq)

    def replace(self, old, new):
        """Type something in the place of a piece of the text of the snapshot."""
        text = self.snapshot["text"]
        at = text.index(old)
        lines = new.split("\n")
        changes = [at, [len(old), *lines], len(text) - at - len(old)]
        return self.type([each for each in changes if each != 0])


def closed(socket):
    """Wait until the other side closes; the code."""
    try:
        while True:
            socket.recv(WAIT)
    except ConnectionClosed as error:
        return error.rcvd.code if error.rcvd else None
