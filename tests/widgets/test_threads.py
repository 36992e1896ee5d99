"""Two threads at the same work: nothing is done twice, and nothing is left behind."""

from threading import Event, Thread

import pytest

from lrp_jupyter.errors import SessionClosedError
from lrp_jupyter.live.session import Session
from lrp_jupyter.widgets.connection import Connection
from lrp_jupyter.widgets.texts import Texts

A = "(machine m (state a)) (spawn m a)"


def test_a_text_is_saved_once_though_two_threads_save(tmp_path):
    written = []

    class Interrupted(Texts):
        def _write(self, text, ending):
            written.append(text)
            other.start()
            other.join(0.05)  # it does not get further
            super()._write(text, ending)

    texts = Interrupted(tmp_path)
    other = Thread(target=texts.save)
    with Session(A, name="mine") as session:
        texts.follow(session)
        texts.save()
        other.join()
    assert written == [A]
    assert [file.name for file in tmp_path.iterdir()] == ["mine.lrp"]


def test_a_bridge_that_is_opened_while_the_program_is_closed_is_closed_too():
    opened = []

    def reopen(old, bridge):
        connection.close()
        opened.append(Session(A, bridge))
        return opened[0]

    connection = Connection(Session(A), Texts(), reopen)
    with pytest.raises(SessionClosedError, match="was closed meanwhile"):
        connection.change_bridge("sim")
    assert opened[0].status == "closed"
    assert connection.session is not opened[0]
    with pytest.raises(SessionClosedError):
        connection.work(lambda: None)


def test_two_changes_of_the_bridge_at_once_leave_one_session_open():
    sessions, second = [Session(A)], Event()

    def reopen(old, bridge):
        if bridge == "none":
            second.set()
        else:
            other.start()
            second.wait(0.05)  # it does not get further
        sessions.append(Session(A, bridge))
        return sessions[-1]

    connection = Connection(sessions[0], Texts(), reopen)
    other = Thread(target=connection.change_bridge, args=["none"])
    connection.change_bridge("sim")
    other.join()
    assert [session.status for session in sessions] == ["closed", "closed", "ready"]
    assert connection.session is sessions[-1]
    connection.close()
