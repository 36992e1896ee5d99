"""What a run tells editors while it runs: which states are active, and the values of variables.

Each editor has a thread of its own, which looks at the last frame some times a second and sends what has
changed. It never waits for the run, nor the run for it: an editor that does not read is not sent more.
Messages are JSON; nothing that an editor sends is read after it has proved that it knows the key.
"""

from __future__ import annotations

import json
import threading
from contextlib import suppress
from multiprocessing import AuthenticationError
from multiprocessing.connection import Client, Connection, Listener, answer_challenge, deliver_challenge
from pathlib import Path
from types import TracebackType
from typing import Self

from lrp_jupyter.editors.live_news import news_of
from lrp_jupyter.editors.live_place import new_place
from lrp_jupyter.errors import LRPError
from lrp_jupyter.live.running import commands as do
from lrp_jupyter.live.session import Session

_PAUSE = 0.1  # s between two looks at the run
_MOST_EDITORS = 8


class LiveOffer:
    """Offers a run to the editors that have its file open, as long as the context lasts.

    Raises FileError: this user cannot have a private folder for it.
    """

    def __init__(self, session: Session, program: Path) -> None:
        self._session = session
        self._place = new_place(program)
        self._key = self._place.key  # whose file may be deleted: then nothing is let in
        self._ended = threading.Event()
        self._listener = Listener(self._place.address, backlog=_MOST_EDITORS)
        self._threads = [threading.Thread(target=self._accept, name="lrp editors", daemon=True)]

    def __enter__(self) -> Self:
        self._threads[0].start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._ended.set()
        with suppress(OSError, EOFError):
            Client(self._place.address).close()  # wakes the thread that waits for an editor
        self._threads[0].join(2)
        self._listener.close()
        self._place.forget()

    def _accept(self) -> None:
        while not self._ended.is_set():
            try:
                connection = self._listener.accept()
            except OSError:
                self._ended.wait(_PAUSE)
                continue
            self._threads = [each for each in self._threads if each.is_alive()]
            if self._ended.is_set() or len(self._threads) > _MOST_EDITORS:
                connection.close()
                continue
            thread = threading.Thread(target=self._tell, args=(connection,), name="lrp editor", daemon=True)
            self._threads.append(thread)
            thread.start()

    def _tell(self, connection: Connection) -> None:
        last = b""
        with suppress(OSError, EOFError, AuthenticationError, LRPError), connection:  # it may go at any time
            deliver_challenge(connection, self._key)
            answer_challenge(connection, self._key)
            self._session.ask(do.Call(self._session.interpreter.watch_events))
            while not self._ended.is_set():
                news = json.dumps(news_of(self._session.frame), ensure_ascii=False)
                message = news.encode(errors="replace")
                if message != last:
                    connection.send_bytes(message)
                    last = message
                self._ended.wait(_PAUSE)
