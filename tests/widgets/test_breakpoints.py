"""Breakpoints of a page: it adds, switches and removes them, and is told why the program paused."""

import pytest

from lrp_jupyter.live.session import Session
from lrp_jupyter.widgets.connection import PageConnection
from lrp_jupyter.widgets.text.saver import Saver
from lrp_jupyter.widgets.text.texts import Texts

PROGRAM = """\
(var n := [0])
(event many [n > 8])
(machine m
  (state a (running [n += 1]))
  (state b)
  (ontime 300 a -> b there)
  (ontime 300 b -> a back))
(spawn m a)
"""


@pytest.fixture
def lab(bench):
    return bench(PROGRAM)


@pytest.fixture
def page(lab):
    return lab.page()


def known(lab, page):
    lab.publish()
    return page.merged("breakpoints")


def test_a_page_is_told_which_breakpoint_paused_the_program(lab, page):
    assert page.do("add_breakpoint", kind="entered", path="m/b") is None
    assert known(lab, page)["1"] == {
        "kind": "entered",
        "path": "m/b",
        "name": "b",
        "expression": "",
        "machine": "",
        "instance": "",
        "enabled": True,
        "hits": 0,
        "after": 1,
        "dormant": False,
        "problem": "",
        "line": 5,
    }
    lab.session.run(5)
    assert known(lab, page)["1"]["hits"] == 1
    sentence = "`b` was entered (breakpoint 1, 1st time)."
    assert page.merged("paused_by") == {"number": 1, "text": sentence, "hits": 1}
    assert page.merged("reason") == sentence
    page.do("step")
    lab.publish()
    assert page.merged("paused_by") is None


@pytest.mark.parametrize(
    ("kind", "path", "line"), [("left", "m/a", 4), ("fired", "m:back", 7), ("event", "many", 2)]
)
def test_each_kind_of_element_can_have_one(lab, page, kind, path, line):
    assert page.do("add_breakpoint", kind=kind, path=path) is None
    each = known(lab, page)["1"]
    assert (each["kind"], each["path"], each["line"]) == (kind, path, line)
    lab.session.run(5)
    lab.publish()
    assert page.merged("paused_by")["number"] == 1


def test_a_breakpoint_is_changed_and_removed(lab, page):
    page.do("add_breakpoint", kind="entered", path="m/b")
    page.do("change_breakpoint", number=1, on=False)
    assert not known(lab, page)["1"]["enabled"]
    page.do("change_breakpoint", number=1, on=True, after=2)
    lab.session.run(2)
    each = known(lab, page)["1"]
    assert (each["enabled"], each["after"], each["hits"], lab.session.frame.tick) == (True, 2, 2, 10)
    page.do("remove_breakpoint", number=1)
    assert known(lab, page) == {}
    assert page.do("remove_breakpoint", number=1) == "There is no breakpoint 1. There are: none."


def test_a_condition_pauses_and_says_what_is_wrong_with_it(lab, page):
    assert "not an expression" in page.do("add_breakpoint", kind="condition", expression="n = 3")
    page.do("add_breakpoint", kind="condition", expression="n > 2")
    lab.session.run(1)
    assert known(lab, page)["1"]["hits"] == 1
    page.do("add_breakpoint", kind="condition", expression="missing > 2")
    assert "missing" in known(lab, page)["2"]["problem"]


def test_breakpoints_follow_edits_renames_and_resets(lab, page):
    page.do("add_breakpoint", kind="entered", path="m/b")
    lab.session.run(0.1)
    assert page.rename("state", "m/b", "far")["applied"]
    lab.session.run(0.1)
    each = known(lab, page)["1"]
    assert (each["path"], each["name"], each["dormant"]) == ("m/far", "far", False)
    text = lab.session.program.text
    page.type("\n\n" + text)
    lab.session.run(0.1)
    assert known(lab, page)["1"]["line"] == 7
    page.type(PROGRAM.replace("  (state b)\n", "").replace("b there", "a there").replace("b -> a", "a -> a"))
    lab.session.run(0.1)
    each = known(lab, page)["1"]
    assert (each["dormant"], each["line"]) == (True, 0)
    page.type(text)
    lab.session.run(0.1)
    assert not known(lab, page)["1"]["dormant"]
    page.do("reset")
    lab.session.run(2)
    assert lab.session.frame.paused_by.number == 1


def test_another_view_is_sent_the_breakpoints(lab, page):
    page.do("add_breakpoint", kind="fired", path="m:there")
    assert lab.page("other").merged("breakpoints")["1"]["path"] == "m:there"


def test_breakpoints_stay_when_another_bridge_is_chosen():
    opened = []

    def reopen(old, bridge):
        opened.append(Session(old.text, bridge))
        return opened[-1]

    connection = PageConnection(Session(PROGRAM), Saver(Texts()), reopen)
    try:
        connection.session.pause_when("b", after=2)
        connection.change_bridge("sim")
        (kept,) = connection.session.breakpoints
        assert (kept.name, kept.after, kept.hits) == ("b", 2, 0)
        assert connection.session is opened[0]
    finally:
        connection.close()
