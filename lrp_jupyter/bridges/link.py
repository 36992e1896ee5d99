"""A connection to a robot, with its own thread, which restores it whenever it is lost."""

from __future__ import annotations

import math
import threading
import time
from abc import ABC, abstractmethod
from enum import Enum

from lrp_jupyter.errors import BridgeError, NoAnswerError, sentence_of

_CALM = 0.3  # s that the thread has to end before the connection is closed under it
_JOIN = 1.7  # s that it has after that
_SLICE = 0.1  # s of waiting: Windows lets Ctrl-C in only in between


class Stage(Enum):
    """What the thread of a link does next."""

    OPENING = "connect, while someone waits for it"
    SEARCHING = "connect, for as long as it takes"
    UP = "attend"
    ENDED = "nothing"


_NEXT = {  # after a success, and after a failure
    Stage.OPENING: (Stage.UP, Stage.ENDED),
    Stage.SEARCHING: (Stage.UP, Stage.SEARCHING),
    Stage.UP: (Stage.UP, Stage.SEARCHING),
    Stage.ENDED: (Stage.ENDED, Stage.ENDED),
}


class Link(ABC):
    """A thread that goes through the stages; a subclass says what is done in them.

    `name`: names the thread, and the bridge in the sentence about a fault of the bridge itself.
    """

    def __init__(self, name: str) -> None:
        self._stage, self._failure, self._is_due = Stage.OPENING, "", False
        self._is_absent = False  # whether the failure is that no robot answers
        self._changed = threading.Condition()  # for these four
        self._again = False  # whether opening goes on then
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)

    # -- on the link's thread ---------------------------------------------------------------------

    @abstractmethod
    def connect(self) -> float:
        """Connect, in bounded time; return the seconds until `attend`."""

    @abstractmethod
    def attend(self) -> float:
        """Read or probe the connection; return the seconds until the next time. Any exception is a loss."""

    @abstractmethod
    def lose(self, sentence: str) -> float:
        """Report that there is no connection, or still none; return the seconds until `connect`."""

    @abstractmethod
    def disconnect(self) -> None:
        """Close the connection, if any; other threads call this to end a wait of the link's thread."""

    def explain(self, error: BaseException) -> str:
        """Return why `connect` or `attend` has failed, in a sentence."""
        is_own = not isinstance(error, BridgeError)
        return f"The {self._thread.name} bridge itself failed: {sentence_of(error)}" if is_own else str(error)

    def _run(self) -> None:
        while not self.is_ended:
            pause = self._turn()
            with self._changed:
                self._changed.wait_for(
                    lambda: self.is_ended or (self._is_due and self._stage is Stage.UP), pause
                )
        self.disconnect()

    def _turn(self) -> float:
        """Do what the stage says, and go on to the next one; return the seconds until that."""
        pause, failure, is_absent, self._is_due = 0.0, "", False, False
        try:
            pause = self.attend() if self._stage is Stage.UP else self.connect()
        except BaseException as error:  # also of an author's code: a thread must not die unseen
            failure, is_absent = self.explain(error), isinstance(error, NoAnswerError)
        with self._changed:
            self._failure, self._is_absent = failure, is_absent
            if not (self._stage is Stage.OPENING and self._again and is_absent):
                self._stage = _NEXT[self._stage][bool(failure)]
            self._changed.notify_all()
        if failure and not self.is_ended:
            pause = self.lose(failure)
            self.disconnect()
        return pause

    # -- on any thread ----------------------------------------------------------------------------

    @property
    def is_opening(self) -> bool:
        """Whether it was not connected yet, and someone waits for that."""
        return self._stage is Stage.OPENING

    @property
    def is_ended(self) -> bool:
        """Whether it was closed, or could not be opened."""
        return self._stage is Stage.ENDED

    def open(self, patience: float | None = None, again: bool = False) -> bool:
        """Connect; return whether that took less than `patience` seconds; BridgeError: it is not possible.

        `again`: where no robot answers, try it again as long as that lasts.
        """
        self._again = again
        self._thread.start()
        end, in_time = time.monotonic() + (math.inf if patience is None else patience), False
        try:
            while not in_time and time.monotonic() < end:
                with self._changed:
                    in_time = self._changed.wait_for(lambda: self._stage is not Stage.OPENING, _SLICE)
        finally:
            failure, is_absent = self._failure, self._is_absent  # not that of an attempt that is broken off
            if not in_time or self.is_ended:
                self.close()
        if failure and self.is_ended:
            raise (NoAnswerError if is_absent else BridgeError)(failure)
        return in_time

    def search(self) -> None:
        """Connect in the background, for as long as it takes."""
        self._stage = Stage.SEARCHING
        self._thread.start()

    def hurry(self) -> None:
        """Have the connection attended to now; one that is lost is not made any sooner."""
        with self._changed:
            self._is_due = True
            self._changed.notify_all()

    def close(self) -> None:
        """End the thread and the connection, in bounded time; idempotent."""
        with self._changed:
            self._stage = Stage.ENDED
            self._changed.notify_all()
        self.has_ended(within=_CALM)
        self.disconnect()  # ends what the thread waits for
        self.has_ended(within=_JOIN)

    def has_ended(self, within: float) -> bool:
        """Wait some seconds for the thread to end; return whether it has."""
        if self._thread.is_alive() and self._thread is not threading.current_thread():
            self._thread.join(within)
        return not self._thread.is_alive()
