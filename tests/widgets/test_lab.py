"""The objects that a notebook holds: a lab, its parts, its variables, its pictures."""

import base64
import gc
import re
import threading
import xml.etree.ElementTree as ElementTree

import pytest

import lrp_jupyter
from lrp_jupyter import Editor, Lab, LRPError, Session, SimView, StateGraph, UnknownElementError, parse
from lrp_jupyter.bridges.bridge import Bridge, BridgeError
from lrp_jupyter.live.recording import read_recording
from lrp_jupyter.widgets import registry
from lrp_jupyter.widgets.lab import Part, lab_of
from lrp_jupyter.widgets.text.conditions import Conditions

PROGRAM = """
(var box := [[1]])
(machine m (var v := [0]) (var w := [5])
  (state a (machine n (var v := [7]) (state x)) (onentry (spawn n x))))
(spawn m a)
"""


@pytest.fixture
def make(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def make(*arguments, **options):
        return Lab(*arguments, namespace={}, **options)

    yield make
    for connection in list(registry.running()):
        registry.forget(connection)


def test_a_lab_runs_at_once_and_shows_what_its_session_does(make):
    lab = make(PROGRAM, rate=100)
    lab.session.wait_for("x", 60)
    assert lab.active == (("m", "a", "n", "x"),)
    assert lab.program == parse(PROGRAM)
    assert lab.text == PROGRAM
    assert list(lab.issues) == []
    assert lab.fault == ""
    assert "running" in repr(lab)


def test_the_log_of_a_session_overwrites_no_recording(make, tmp_path):
    (tmp_path / "p.lrplog").write_text("the recording of another run", encoding="utf-8")
    with Session(PROGRAM, name="own") as session:
        make(session, log="p.lrplog")
        session.run(0.3)
        with pytest.raises(ValueError, match="has run already"):
            make(session, log="p.lrplog")
    assert (tmp_path / "p.lrplog").read_text(encoding="utf-8") == "the recording of another run"
    assert read_recording(tmp_path / "p (2).lrplog").ticks == 3
    assert sorted(file.name for file in tmp_path.glob("*.lrplog")) == ["p (2).lrplog", "p.lrplog"]


def test_a_function_that_observes_the_frame_is_called_when_a_page_reports_a_change(make):
    lab, seen = make(PROGRAM), []
    lab.session.wait_for("x", 60)
    lab.session.pause()
    lab.session.wait_for(lambda frame: frame.status == "paused", 60)
    assert not lab.reports
    lab.observe(seen.append, "frame")
    assert lab.reports
    lab.set_state({"reported": 1.0})  # as the page's report arrives
    assert seen[0].new is lab.frame is lab.session.frame
    assert seen[0].new.status == "paused"
    assert seen[0].new.is_active("x")
    lab.set_state({"reported": 1.0})
    assert len(seen) == 1


def test_every_face_is_the_same_widget_with_another_view(make):
    lab = make(PROGRAM)
    parts = [face(lab.session) for face in (StateGraph, SimView, Editor, lrp_jupyter.Variables)]
    assert [part.view for part in parts] == ["graph", "world", "editor", "variables"]
    assert lab.view == "lab"
    assert all(isinstance(part, Part) and part.session is lab.session for part in parts)
    assert StateGraph(lab).session is StateGraph("m").session is lab.session
    with pytest.raises(UnknownElementError, match=r"No program `x` is open\. Open programs: `m`\."):
        StateGraph("x")


def test_a_study_is_set_up_in_python(make):
    lab = make(PROGRAM, edits="hold", quiet=True)
    assert lab.conditions == Conditions("hold", quiet=True)
    assert make("m").conditions == lab.conditions  # of the same program
    assert make(lab.session, graph="static", lock=True).conditions == Conditions(graph="static", lock=True)
    lab.set_conditions(edits="hold")
    assert lab.conditions == Conditions("hold")
    with pytest.raises(ValueError, match=r"`graph` must be .*, not `off`\."):
        lab.set_conditions(graph="off")
    with pytest.raises(TypeError, match=r"`quiet` must be True or False, not int\."):
        make(PROGRAM, quiet=1)
    assert lab.conditions == Conditions("hold")


def test_the_stored_picture_shows_what_the_lab_shows(make):
    lab = make(PROGRAM, rate=100)
    lab.session.wait_for("x", 60)

    def picture():
        return lab._repr_mimebundle_()[0]["image/svg+xml"]

    assert 'data-active=""' in picture()
    lab.set_conditions(graph="static")
    assert 'data-active=""' not in picture()
    assert 'data-lrp-state="m/a"' in picture()
    lab.set_conditions(graph="hidden")
    assert 'data-lrp="graph"' not in picture()
    assert "World line" in picture()


def test_variables_are_read_and_written_by_name_or_path(make):
    lab = make(PROGRAM, rate=100)
    lab.session.wait_for("x", 60)
    assert lab.variables["w"] == 5
    assert lab.variables["m/v"] == 0
    assert lab.variables["m/a/n/v"] == 7
    lab.variables["w"] = 6
    assert lab.variables[("m", "w")] == 6
    box = [object()]
    lab.variables["box"] = box
    assert lab.variables["box"] is box
    assert set(lab.variables) == {("box",), ("m", "v"), ("m", "w"), ("m", "a", "n", "v")}
    assert lab.variables._ipython_key_completions_() == ["box", "m/v", "m/w", "m/a/n/v"]
    assert len(lab.variables) == 4
    assert "w = 6" in repr(lab.variables)
    assert lab.session.namespace.keys() == {"__builtins__"}
    with pytest.raises(UnknownElementError, match="Several variables are called `v`"):
        lab.variables["v"]
    with pytest.raises(UnknownElementError, match="There is no variable `x` now"):
        lab.variables["x"] = 1
    with pytest.raises(TypeError, match="Remove it from the program's text"):
        del lab.variables["w"]


def test_a_second_lab_of_a_name_shows_and_patches_the_same_program(make):
    first = make(PROGRAM)
    second = make(PROGRAM.replace("[5]", "[50]"))
    assert second.session is first.session
    assert first.program == second.program
    assert make("m").session is first.session  # by name


def test_a_bundled_program_is_opened_by_its_name(make):
    lab = make("follower")
    assert lab.session.name == "follower"
    assert "(machine follower" in lab.text


def test_a_word_that_names_no_program_is_not_taken_as_a_text(make):
    with pytest.raises(LRPError, match=r"There is no bundled program `folower`\. Did you mean `follower`\?"):
        make("folower")


def test_a_lab_may_be_of_a_program_or_of_a_session(make):
    assert make(parse(PROGRAM)).text == PROGRAM
    with Session(PROGRAM, name="own") as session:
        assert make(session).session is session


def test_a_text_is_saved_to_a_file_of_ones_choice(make, tmp_path):
    make(PROGRAM).save(tmp_path / "f.lrp")
    assert (tmp_path / "f.lrp").read_text() == PROGRAM


def test_closing_ends_the_run_and_the_next_lab_starts_again(make):
    lab = make(PROGRAM)
    lab.close()
    lab.close()
    assert lab.session.status == "closed"
    assert make(PROGRAM).session.status == "running"


def test_cells_show_one_lab_of_a_program_until_it_is_closed(make):
    lab = lab_of(make(PROGRAM)._connection)
    assert lab_of(lab._connection) is lab
    Part.close(lab)
    assert lab_of(lab._connection) is not lab


def test_a_part_that_is_closed_leaves_the_program_running(make):
    lab = make(PROGRAM)
    StateGraph(lab).close()
    assert lab.session.status == "running"


def test_the_output_has_pictures_and_the_text_beside_the_widget(make):
    lab = make(PROGRAM, rate=100)
    lab.session.wait_for("x", 60)
    bundle, _ = lab._repr_mimebundle_()
    assert "application/vnd.jupyter.widget-view+json" in bundle
    assert bundle["text/plain"] == PROGRAM
    picture = ElementTree.fromstring(bundle["image/svg+xml"])
    shown = [element.get("data-lrp-state") for element in picture.iter()]
    assert "m/a" in shown
    assert any("lrp-world" in (element.get("class") or "") for element in picture.iter())


def test_a_lab_without_a_world_is_pictured_by_its_graph(make):
    bundle, _ = make(PROGRAM, "none")._repr_mimebundle_()
    assert "lrp-world" not in bundle["image/svg+xml"]
    ElementTree.fromstring(bundle["image/svg+xml"])


def test_a_snapshot_holds_no_widget(make, monkeypatch):
    shown = []
    monkeypatch.setattr("IPython.display.display", lambda data, raw: shown.append(data))
    make(PROGRAM).snapshot()
    assert [set(data) for data in shown] == [{"image/svg+xml", "text/plain"}]


def test_a_snapshot_shows_an_edit_made_a_moment_ago(make, monkeypatch):
    shown = []
    monkeypatch.setattr("IPython.display.display", lambda data, raw: shown.append(data))
    lab = make(PROGRAM)
    lab.session.edit(lab.session.text.replace("(machine m", "(machine m (state brandnew)"))
    lab.snapshot()
    assert "brandnew" in shown[0]["text/plain"]
    assert "brandnew" in shown[0]["image/svg+xml"]


class Lorry(Bridge):
    """A real robot, to the lab."""

    name = "lorry"
    stop_timeout = None

    def open_interface(self):
        self.add_method("move", lambda linear=0.0: None)

    def stop(self):
        """There is nothing to stop."""


class Unreachable(Lorry):
    name = "unreachable"

    def open_interface(self):
        raise BridgeError("The robot does not answer; is it switched on?")


def test_hardware_opens_disarmed_and_pauses_when_it_is_not_watched(make, monkeypatch):
    monkeypatch.setattr(registry, "DEAD_MAN", 0.1)
    lab = make("(machine m (state a (running [robot.move(linear=1)]))) (spawn m a)", "lorry")
    assert not lab.session.bridge.safety.armed
    lab.session.wait_for(lambda frame: frame.status == "paused", 60)
    assert "The robot has not been watched" in lab.session.frame.reason


def test_a_robot_that_cannot_be_reached_is_an_error_in_a_sentence_and_leaves_nothing(make):
    before = set(threading.enumerate())
    with pytest.raises(BridgeError, match="does not answer"):
        make(PROGRAM, "unreachable")
    assert registry.names() == []
    assert set(threading.enumerate()) <= before


@pytest.mark.slow
def test_a_saved_notebook_shows_graph_world_and_text_without_a_kernel(make):
    import nbformat
    from nbconvert import HTMLExporter

    lab = make(PROGRAM)
    data, metadata = lab._repr_mimebundle_()
    output = {
        "output_type": "execute_result",
        "data": data,
        "metadata": metadata,
        "execution_count": 1,
    }
    cell = {
        "cell_type": "code",
        "id": "a",
        "metadata": {},
        "source": "",
        "outputs": [output],
        "execution_count": 1,
    }
    notebook = nbformat.from_dict({"cells": [cell], "metadata": {}, "nbformat": 4, "nbformat_minor": 5})
    html, _ = HTMLExporter().from_notebook_node(notebook)
    *_, picture = re.findall(r"data:image/svg\+xml;base64,([\w+/=]+)", html)
    drawn = base64.b64decode(picture).decode()
    assert 'data-lrp-state="m/a"' in drawn
    assert "lrp-world" in drawn


@pytest.mark.slow
def test_a_lab_that_is_forgotten_stops_nothing(make):
    session = make(PROGRAM).session
    gc.collect()
    assert session.status == "running"
