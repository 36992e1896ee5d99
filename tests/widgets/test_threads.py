"""Two threads at the same work: nothing is done twice, and nothing is left over."""

from threading import Event, Thread

import pytest

from lrp_jupyter.bridges.bridge import NullBridge
from lrp_jupyter.errors import SessionClosedError
from lrp_jupyter.live.session import Session
from lrp_jupyter.widgets.connection import PageConnection
from lrp_jupyter.widgets.text.kept import Kept
from lrp_jupyter.widgets.text.saver import Saver
from lrp_jupyter.widgets.text.texts import Texts

A = "(machine m (state a)) (spawn m a)"
B = "(machine m (state a) (state b)) (spawn m a)"


def test_a_text_is_saved_once_though_two_threads_save(tmp_path):
    written = []

    class Interrupted(Kept):
        def write(self, ending, text):
            written.append(text)
            other.start()
            other.join(0.05)  # it does not get further
            super().write(ending, text)

    saver = Saver(Texts(), Interrupted(tmp_path, "mine"))
    other = Thread(target=saver.save)
    with Session(A, name="mine") as session:
        saver.texts.attach(session, lambda: None)
        saver.save()
        other.join()
    assert written == [A]
    assert [file.name for file in tmp_path.iterdir()] == ["mine.lrp"]


def test_a_bridge_that_is_opened_while_the_program_is_closed_is_closed_too():
    opened = []

    def reopen(old, bridge):
        connection.close()
        opened.append(Session(A, bridge))
        return opened[0]

    connection = PageConnection(Session(A), Saver(Texts()), reopen)
    with pytest.raises(SessionClosedError, match="has been closed in the meantime"):
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

    connection = PageConnection(sessions[0], Saver(Texts()), reopen)
    other = Thread(target=connection.change_bridge, args=["none"])
    connection.change_bridge("sim")
    other.join()
    assert [session.status for session in sessions] == ["closed", "closed", "ready"]
    assert connection.session is sessions[-1]
    connection.close()


class Fading(NullBridge):
    """Its session is closed by another thread just when it is to be read."""

    session = None

    @property
    def refresh(self):
        self.session.close()
        return lambda: None


def test_a_session_that_is_closed_during_a_round_is_not_a_fault_of_the_lab(bench):
    lab = bench(A, bridge=(bridge := Fading()))
    lab.session.step()
    bridge.session = lab.session
    page = lab.page()
    lab.publish()
    lab.publish()
    assert page.last("frame")["status"] == "closed"
    assert lab.connection.fault == ""


def test_a_robot_is_read_though_the_one_before_it_hung(bench):
    gate, inside = Event(), Event()
    lab = bench(
        "(machine m (state a (running [inside.set() or gate.wait(60)]))) (spawn m a)",
        namespace={"gate": gate, "inside": inside},
    )
    page = lab.page()
    with lab.session as hung, Session(A, "sim") as session:
        hung.start()
        assert inside.wait(60)
        lab.publish()
        lab.connection.use(session)
        session.step()
        lab.publish()
        lab.publish()
        gate.set()
        assert page.latest("members")["light.data"].isdigit()


def test_a_view_that_cannot_be_reached_costs_the_others_nothing(bench):
    lab = bench(A)
    broken, page = lab.page("broken"), lab.page()

    def fail(message, buffers):
        raise RuntimeError("the comm is gone")

    lab.connection.receive(fail, {"type": "hello", "view": "broken", "part": "lab"})
    assert page.type(A.replace("state a", "state a)(state b"))["applied"]
    lab.session.step()
    lab.publish()
    assert page.latest("active") == ["m/a"]
    assert "the comm is gone" in lab.connection.fault
    lab.connection.fault = ""
    lab.publish()
    assert lab.connection.fault == ""  # it is forgotten, until it says hello
    broken.send("hello", part="lab")
    assert broken.last("snapshot")["frame"]["active"] == ["m/a"]


def test_a_view_that_opens_too_late_gets_the_end(bench):
    lab = bench(A)
    lab.connection.close()
    page = lab.page()
    assert page.last("snapshot")["frame"]["status"] == "closed"
    page.send("command", id=1, do="run")
    lab.publish()
    assert len(page.messages) == 1


def test_what_is_typed_while_a_bridge_is_opened_is_not_lost():
    def reopen(old, bridge):
        session = Session(old.program, bridge)
        connection.texts.write(B)
        return session

    connection = PageConnection(Session(A), Saver(Texts()), reopen)
    connection.change_bridge("sim")
    assert connection.texts.text == connection.session.program.text == B
    connection.close()


def test_what_is_typed_when_the_session_is_closed_is_answered_and_kept(bench, tmp_path):
    lab = bench(A, tmp_path, name="mine")
    page = lab.page()
    lab.session.close()
    answer = page.type(B)
    assert answer["accepted"]
    assert not answer["applied"]
    assert answer["reason"] == "The session `mine` is closed."
    lab.publish()
    assert lab.connection.texts.text == B
    assert (tmp_path / "mine.lrp").read_text() == B
    assert len(page.all("answer")) == 1
