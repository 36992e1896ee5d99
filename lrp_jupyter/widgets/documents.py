"""Files in tabs of JupyterLab, each with its own kernel, which the page calls: a program, or a recording.

The page has the text of a program's file, and saves it. That text and the lab's are reconciled as those of a
cell and a lab are: what is typed in the lab is in the document of the page at once, and what an editor
changes there is in the lab.
"""

from __future__ import annotations

from pathlib import Path

from IPython.core.getipython import get_ipython

from lrp_jupyter import programs
from lrp_jupyter.errors import LRPError
from lrp_jupyter.grading.challenges import challenge
from lrp_jupyter.live.recording import read_recording
from lrp_jupyter.live.reproduction import reproduce
from lrp_jupyter.widgets import registry
from lrp_jupyter.widgets.connection import PageConnection
from lrp_jupyter.widgets.lab import Lab


class StrangerError(LRPError):
    """A recording contains a program that this user has not recorded."""


class _Document:
    """The text of a file, as the newest page has it that shows the lab."""

    def __init__(self, connection: PageConnection, text: str) -> None:
        self._connection = connection
        self._lab = Lab(connection.session)
        self.reconcile(text)
        connection.saver.elsewhere = self._send
        connection.wake()

    def reconcile(self, text: str) -> None:
        """Note what the page has, by other hands than the lab's."""
        with self._connection.texts.lock:
            self._text = text
            self._connection.texts.reconcile(text)

    def _send(self) -> None:
        """Send the lab's text to the page, if that has another, and its user is not asked which to keep."""
        texts = self._connection.texts
        with texts.lock:
            if texts.text != self._text and all(each.source != "cell" for each in texts.conflicts):
                self._text = texts.text
                texts.put_into_cell(self._text)
                self._lab.send({"text": self._text})


_shown: _Document | Lab
"""What this kernel's page shows."""


def open_program(name: str, text: str, again: bool) -> None:
    """Open the lab of a program in a page that has this text of it; one that runs already goes on.

    `again`: whether another kernel, which has ended, has run it: then it waits for its user.
    """
    global _shown
    _shown = _Document(registry.find(name) or _opened(name, text, _AGAIN if again else ""), text)


_AGAIN = "The kernel that ran this program has ended, and this is a new one. Run the program to go on."


def _opened(name: str, text: str, paused: str) -> PageConnection:
    shell = get_ipython()
    heading = programs.heading(text)
    task = challenge(heading.challenge) if heading.challenge else None
    robot = {"task": task} if task else registry.robot_for(programs.world_of(text, Path()))
    names = None if shell is None else shell.user_ns
    return registry.open_program(name, text, namespace=names, paused=paused, given_in="file", **robot)


def reconcile(text: str) -> None:
    """Note a text that the page has now."""
    if isinstance(_shown, _Document):
        _shown.reconcile(text)


def open_recording(file: str, trusted: bool) -> None:
    """Run a recording again, and open a lab at its end."""
    global _shown
    recording = read_recording(file)
    if not (trusted or recording.is_own):
        raise StrangerError(
            f"`{recording.name}` contains a program that you have not recorded here, and its blocks can do "
            "whatever you can do. Read it before you run it."
        )
    session = reproduce(recording).session
    session.name = Path(file).name.partition(".lrplog")[0]
    connection = registry.connection_of(session)
    connection.texts.note_saved(connection.texts.text)
    _shown = Lab(session)
