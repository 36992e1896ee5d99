"""What runs tell about the files that are open in an editor."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable
from multiprocessing import AuthenticationError
from multiprocessing.connection import Client
from pathlib import Path
from typing import cast

from lrp_jupyter.editors.live_news import LiveNews
from lrp_jupyter.editors.live_place import LivePlace, places_of

_SCAN = 0.5  # s between two looks for runs
_LONGEST = 2_000_000  # bytes of a message


class LiveReader:
    """Listens to the runs of files. `changed` is called on a thread, with the file that has news."""

    def __init__(self, changed: Callable[[Path], object]) -> None:
        self._changed = changed
        self._files: set[Path] = set()
        self._news: dict[Path, dict[LivePlace, LiveNews]] = {}
        self._heard: set[tuple[Path, LivePlace]] = set()
        self._lock = threading.Lock()
        self._wake = threading.Event()
        self._scanner: threading.Thread | None = None

    def open(self, file: Path) -> None:
        """Look for runs of a file from now on."""
        with self._lock:
            self._files.add(file)
            if self._scanner is None:
                self._scanner = threading.Thread(target=self._scan, name="lrp runs", daemon=True)
                self._scanner.start()
        self._wake.set()

    def close(self, file: Path) -> None:
        """Stop looking for runs of a file."""
        with self._lock:
            self._files.discard(file)

    def news(self, file: Path) -> LiveNews | None:
        """Return the last news of a file, from the run that began last; None if none runs."""
        with self._lock:
            found = self._news.get(file)
            return next(reversed(found.values())) if found else None

    def _scan(self) -> None:
        while True:
            for file in [*self._files]:
                for place in reversed(places_of(file)):  # the newest is heard last, and so counts
                    if (file, place) not in self._heard:
                        self._heard.add((file, place))
                        threading.Thread(
                            target=self._listen, args=(file, place), name="lrp run", daemon=True
                        ).start()
            self._wake.wait(_SCAN)
            self._wake.clear()

    def _listen(self, file: Path, place: LivePlace) -> None:
        """Listen to a run to its end; if it cannot be reached, the next scan tries again."""
        try:
            with Client(place.address, authkey=place.key) as connection:
                while file in self._files:
                    self._keep(file, place, cast(LiveNews, json.loads(connection.recv_bytes(_LONGEST))))
        except (OSError, EOFError, AuthenticationError, ValueError):
            pass  # it has ended, or has not begun to listen
        finally:
            self._keep(file, place, None)
            self._heard.discard((file, place))

    def _keep(self, file: Path, place: LivePlace, news: LiveNews | None) -> None:
        with self._lock:
            known = self._news.setdefault(file, {})
            if news is None:
                was_known = known.pop(place, None) is not None
            else:
                known[place] = news
        if news is not None or was_known:
            self._changed(file)
