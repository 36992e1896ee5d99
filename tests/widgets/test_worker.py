"""The lab of a page without a notebook: what the page's worker calls."""

import json

import pytest

from lrp_jupyter import programs
from lrp_jupyter.errors import LRPError
from lrp_jupyter.widgets import registry
from lrp_jupyter.widgets import site_worker as worker

TEXT = "(machine shared (state a)) (spawn shared a)\n"


@pytest.fixture
def opening(tmp_path, monkeypatch):
    """Open what an address asks for; `messages` are those that the page gets."""
    monkeypatch.chdir(tmp_path)
    opened = []

    def opening(messages=None, /, **address):
        received = [] if messages is None else messages
        opened.append(
            worker.open_program(json.dumps(address), lambda text, buffers: received.append(json.loads(text)))
        )
        return opened[-1]

    yield opening
    for each in opened:
        each.close()


def shared(opened):
    return json.loads(opened.shared())


def test_without_an_address_the_follower_drives_along_its_line(opening):
    assert shared(opening()) == {
        "program": "follower",
        "text": programs.load("follower"),
        "world": "line",
        "challenge": "",
    }


def test_the_address_names_a_program_and_a_world(opening):
    assert shared(opening(program="escapement", world="walls")) == {
        "program": "escapement",
        "text": programs.load("escapement"),
        "world": "walls",
        "challenge": "",
    }


@pytest.mark.parametrize(
    "address", [{"program": "stopwatch"}, {"program": "mine", "text": TEXT, "world": "none"}]
)
def test_a_program_that_needs_no_robot_has_none(opening, address):
    opened = opening(**address)
    assert shared(opened)["world"] == "none"
    assert registry.find(address["program"]).session.bridge.name == "none"


def test_the_text_of_a_link_runs(opening):
    opened = opening(program="mine", text=TEXT, world="empty")
    assert shared(opened) == {"program": "mine", "text": TEXT, "world": "empty", "challenge": ""}
    assert registry.find("mine").session.status == "running"


def test_a_page_that_is_loaded_again_continues_with_what_was_typed(opening):
    first = opening(program="mine", text=TEXT)
    registry.find("mine").texts.write(TEXT.replace("shared", "typed"))
    first.close()
    again = opening(program="mine", text=TEXT, again=True)
    assert shared(again)["text"] == TEXT.replace("shared", "typed")


def test_a_link_that_is_opened_shows_its_text_and_asks_about_the_kept_one(opening):
    first = opening(program="mine", text=TEXT)
    registry.find("mine").texts.write(TEXT.replace("shared", "typed"))
    first.close()
    assert shared(opening(program="mine", text=TEXT))["text"] == TEXT
    conflict = registry.find("mine").texts.conflict
    assert conflict["text"] == TEXT.replace("shared", "typed")
    assert conflict["keep"] == "Keep the link's text"


def test_a_program_that_hung_python_waits_for_its_user(opening):
    opening(program="mine", text=TEXT, hung=True)
    session = registry.find("mine").session
    assert (session.status, session.frame.tick) == ("paused", 0)
    assert "Correct what did not return" in session.frame.reason


def test_a_challenge_begins_with_its_task_in_its_world(opening):
    opened = opening(challenge="stop at the line")
    assert shared(opened)["program"] == "stop-at-the-line"
    assert "; Drive straight on and stop at the black line" in shared(opened)["text"]
    assert shared(opened)["challenge"] == "stop at the line"
    assert registry.find("stop-at-the-line").goal.task.name == "stop at the line"


def test_messages_pass_as_json(opening):
    messages = []
    opened = opening(messages, program="mine", text=TEXT)
    opened.receive(json.dumps({"type": "hello", "view": "v", "part": "lab"}))
    assert messages[0]["type"] == "snapshot"
    assert messages[0]["text"] == TEXT


@pytest.mark.parametrize("address", [{"program": "folower"}, {"challenge": "maize"}, {"world": "lin"}])
def test_what_does_not_exist_is_told_with_a_suggestion(opening, address):
    with pytest.raises(LRPError, match="Did you mean"):
        opening(**address)
