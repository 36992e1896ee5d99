"""Programs by name: what a cell brings and what the lab has are brought together, and nothing is lost."""

import threading

import pytest
from support.waiting import until

from lrp_jupyter.errors import BridgeError, LRPError
from lrp_jupyter.live.running.monitor import Monitor
from lrp_jupyter.live.session import Session
from lrp_jupyter.widgets import registry
from lrp_jupyter.widgets.text import saver

A = "(machine m (state a)) (spawn m a)"
B = "(machine m (state a) (state b)) (spawn m a)"
C = "(machine m (state a) (state c)) (spawn m a)"
BROKEN = "(machine m (state a)"


@pytest.fixture
def cell(tmp_path):
    """Run a cell with a text, as often as wanted; leave no thread."""
    before = set(threading.enumerate())

    def run(text, name="mine", **options):
        connection = registry.open_program(name, text, namespace={}, folder=tmp_path, **options)
        connection.publish()
        return connection

    yield run
    for connection in list(registry.running()):
        registry.forget(connection)
    assert not [thread for thread in set(threading.enumerate()) - before if "publisher" in thread.name]
    assert not [thread for thread in set(threading.enumerate()) - before if thread.name == "lrp mine"]


@pytest.fixture
def restart_kernel(cell):
    def restart():
        for connection in list(registry.running()):
            registry.forget(connection)

    return restart


def test_a_program_runs_at_once_on_the_simulator(cell):
    connection = cell(A)
    assert connection.session.bridge.name == "sim"
    assert connection.session.status == "running"
    assert registry.names() == ["mine"]


def test_a_cell_that_is_run_again_changes_the_program_that_runs(cell):
    first = cell(A)
    first.session.wait_for("a", 60)
    second = cell(B)
    assert second is first
    assert second.session.wait_for(lambda frame: frame.program.text == B, 60).restarts == 0


def test_a_program_that_is_opened_in_a_lab_gives_it_its_name_and_leaves_the_old_ones_text(cell, tmp_path):
    connection = cell(A)
    connection.saver.save(at_once=True)
    connection.load("square", B)
    connection.saver.save(at_once=True)
    assert registry.names() == ["square"]
    assert connection.session.name == "square"
    assert (tmp_path / ".lrp" / "mine.lrp").read_text() == A
    assert (tmp_path / ".lrp" / "square.lrp").read_text() == B
    assert [version.text for version in connection.texts.versions] == [A]
    assert cell(A) is not connection, "the cell has a program of its own again"
    assert connection.texts.text == B


def test_what_was_kept_under_the_name_of_an_opened_program_is_among_the_versions(cell, restart_kernel):
    cell(C, "square").saver.save(at_once=True)
    restart_kernel()
    connection = cell(A)
    connection.load("square", B)
    connection.saver.save(at_once=True)
    assert not connection.texts.conflicts
    assert {version.text for version in connection.texts.versions} == {A, C}


def test_an_opened_program_has_a_number_if_another_lab_has_its_name(cell):
    other = cell(B, "square")
    connection = cell(A)
    connection.load("square", C)
    assert registry.names() == ["square", "square (2)"]
    assert registry.named("square") is other
    assert other.texts.text == B


def test_an_unchanged_cell_keeps_the_labs_text(cell):
    connection = cell(A)
    connection.texts.write(B)
    assert cell(A).texts.text == B
    assert connection.texts.conflict is None


@pytest.mark.parametrize("typed", [B, "(machine m\r\n  (state a))\r\n(spawn m a)"])
def test_a_labs_text_that_was_written_into_the_cell_causes_no_conflict(cell, restart_kernel, typed):
    written = "\n".join(typed.splitlines()) + "\n"  # as a cell holds it, and IPython passes it
    cell(A).texts.write(typed)
    assert cell(written).texts.conflict is None
    assert cell(written).texts.text == typed
    restart_kernel()
    assert cell(written).texts.conflict is None


def test_where_cell_and_lab_have_changed_the_person_is_asked(cell):
    connection = cell(A)
    connection.texts.write(B)
    cell(C)
    assert connection.texts.text == B
    assert connection.texts.conflict["text"] == C
    cell(C)
    assert connection.texts.conflict["text"] == C  # asked until it is answered


@pytest.mark.parametrize(("act", "text"), [("take", C), ("keep", B)])
def test_the_answer_to_a_conflict_holds(cell, act, text):
    connection = cell(A)
    connection.texts.write(B)
    cell(C)
    connection.receive(lambda *_: None, {"type": "hello", "view": "v", "part": "lab"})
    connection.receive(lambda *_: None, {"type": "command", "view": "v", "id": 0, "do": act})
    assert connection.texts.text == text
    assert connection.texts.conflict is None
    assert cell(C).texts.conflict is None
    assert connection.texts.text == text


@pytest.mark.parametrize("ends", ["\n", "\r\n"])
def test_the_person_is_not_asked_about_a_text_that_has_been_typed_meanwhile(cell, ends):
    connection = cell(A)
    connection.texts.write(B)
    cell(C.replace(" (spawn", f"{ends}(spawn"))
    assert connection.texts.conflict is not None
    connection.texts.write(C.replace(" (spawn", "\n(spawn"))
    assert connection.texts.conflict is None


def test_a_text_that_is_not_a_program_opens_the_lab_with_its_errors(cell):
    connection = cell(BROKEN)
    assert connection.texts.text == BROKEN
    assert connection.texts.judgement.findings
    assert connection.session.status == "running"


@pytest.mark.parametrize("typed", [B, BROKEN])
def test_after_a_restart_the_cells_text_runs_until_the_labs_is_chosen(cell, restart_kernel, tmp_path, typed):
    cell(A).texts.write(typed)
    restart_kernel()
    for _ in range(2):  # a question that is not answered is asked again
        connection = cell(A)
        assert connection.session.program.text == connection.texts.text == A
        assert connection.texts.conflict["text"] == typed
        restart_kernel()
    connection = cell(A)
    connection.texts.end_conflict(None, use=True)
    connection.publish()
    assert connection.texts.text == typed
    assert connection.texts.conflict is None
    restart_kernel()
    connection = cell(A)
    connection.texts.end_conflict(None, use=False)
    assert typed in [version.text for version in connection.texts.versions]
    restart_kernel()
    assert cell(A).texts.conflict is None


def test_after_a_restart_a_cell_that_alone_was_changed_counts(cell, restart_kernel):
    cell(A)
    restart_kernel()
    assert cell(C).session.program.text == C


def test_after_a_restart_two_changed_texts_are_asked_about(cell, restart_kernel):
    cell(A).texts.write(B)
    next(registry.running()).publish()
    restart_kernel()
    connection = cell(C)
    assert connection.session.program.text == C
    assert connection.texts.conflict["text"] == B


def test_another_bridge_starts_again_with_the_same_program(cell):
    first = cell(A)
    old = first.session
    cell(A, bridge="none")
    assert first.session is not old
    assert first.session.bridge.name == "none"
    assert first.session.program.text == A
    assert old.status == "closed"


def test_a_text_that_is_not_a_program_survives_a_change_of_bridge(cell):
    connection = cell(A)
    connection.texts.write(BROKEN)
    connection.change_bridge("none")
    assert connection.texts.text == BROKEN
    assert connection.session.program.text == A


def test_a_bridge_that_does_not_exist_changes_nothing(cell):
    connection = cell(A)
    with pytest.raises(BridgeError, match="no bridge `wings`"):
        cell(A, bridge="wings")
    assert connection.session.status == "running"


def test_another_world_starts_again_and_the_same_one_does_not(cell):
    connection = cell(A, world="oval")
    session = connection.session
    cell(A, world="oval", rate=50)
    assert connection.session is session
    assert session.rate == 50
    cell(A, world="maze")
    assert connection.session.bridge.world.name == "maze"


def test_a_name_cannot_leave_the_folder(cell):
    with pytest.raises(LRPError, match="not a valid name for a program"):
        cell(A, name="../mine")


def test_a_session_that_was_made_elsewhere_is_shown_as_it_is(cell):
    with Session(A, name="own") as session:
        connection = registry.connection_of(session)
        assert registry.connection_of(session) is connection
        assert session.status == "ready"
        assert registry.find("own") is connection


def test_a_forgotten_program_can_be_opened_again(cell):
    first = cell(A)
    registry.forget(first)
    assert registry.names() == []
    assert cell(A) is not first


def test_a_cell_that_is_run_again_starts_a_session_again_that_failed_itself(cell, monkeypatch):
    connection = cell(A)
    with monkeypatch.context() as fault:
        fault.setattr(type(connection.session.interpreter), "step", lambda *_: {}["our own mistake"])
        connection.session.wait_for(lambda frame: frame.status == "broken", 60)
    assert cell(B, rate=20.0) is connection
    frame = connection.session.wait_for("a", 60)
    assert (frame.status, frame.program.text, frame.rate) == ("running", B, 20)


HANGS = "(machine m (state a (running [while True: pass]))) (spawn m a)"


@pytest.fixture
def impatient(monkeypatch):
    monkeypatch.setattr(Monitor, "hung_after", 0.05)


def hung(cell):
    connection = cell(HANGS)
    connection.session.wait_for(lambda frame: frame.status == "hung", 60)
    connection.publish()
    return connection


@pytest.mark.slow
@pytest.mark.parametrize("text", [HANGS, None])
def test_a_text_that_hung_is_not_started_again_by_itself(cell, restart_kernel, impatient, text):
    hung(cell)
    restart_kernel()
    session = cell(text).session
    assert (session.status, session.frame.tick, session.text) == ("paused", 0, HANGS)
    assert "did not return when it last ran" in session.frame.reason
    session.resume()
    session.wait_for(lambda frame: frame.status == "hung", 60)


def test_another_text_than_the_one_that_hung_is_started(cell, restart_kernel, impatient):
    hung(cell).texts.write(A)
    registry.find("mine").session.wait_for(lambda frame: frame.program.text == A, 60)
    registry.find("mine").publish()
    restart_kernel()
    assert cell(None).session.status == "running"
    restart_kernel()
    assert cell(HANGS).session.status == "paused"


@pytest.mark.slow
def test_a_text_that_hung_is_started_again_once_it_has_run_well(cell, restart_kernel, impatient, monkeypatch):
    text = "(machine m (state a (running [while not done: pass]))) (spawn m a)"
    names = {"done": []}
    monkeypatch.setattr(saver, "_WELL", 0.5)
    connection = cell(text)
    connection.session.namespace.update(names)
    connection.session.wait_for(lambda frame: frame.status == "hung", 60)
    connection.publish()
    names["done"].append(True)
    kept = connection.saver.kept
    assert kept.remembered().hung == text
    until(lambda: connection.publish() or kept.remembered().hung is None)
