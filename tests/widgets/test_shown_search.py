"""The smallest change is searched for beside an open program, where that is allowed, and taken."""

from threading import Event

import pytest
from runs.conftest import LAPS

from lrp_jupyter.grading.bundled.starters import starter
from lrp_jupyter.grading.challenges import challenge
from lrp_jupyter.widgets.views.goal import Goal

LATE = LAPS.replace("[1500]", "[3000]")


@pytest.fixture
def searched(bench, tmp_path, monkeypatch):
    """Open a program, and return its bench, its page, and what waits for the end of a search."""
    monkeypatch.chdir(tmp_path)

    def opened(text, **options):
        lab, news = bench(text, bridge="sim", name="laps", **options), Event()
        lab.connection.search.attach(news.set)

        def end():
            while (shown := lab.connection.view_state()["search"])["busy"]:
                assert news.wait(60)
                news.clear()
            return shown

        return lab, lab.page(), end

    return opened


@pytest.mark.slow
def test_a_change_with_which_the_kept_runs_pass_is_found_and_taken(searched):
    lab, page, end = searched(LAPS, world="line")
    assert "Keep a run first" in page.do("find_change")
    lab.session.run(6)
    news = Event()
    lab.connection.runs.attach(news.set)
    page.do("keep_run", name="wall")
    while not lab.connection.runs.all:
        assert news.wait(60)
        news.clear()
    page.type(LATE)
    assert page.do("find_change") is None
    shown = end()
    assert shown["changes"][0]["sentence"].startswith("`turn` 1500 ms instead of 3000 ms (line 1) passes")
    assert page.do("take_change", index=0) is None
    lab.publish()
    assert lab.connection.texts.text == LAPS
    assert lab.connection.view_state()["search"]["stale"]
    assert page.do("take_change", index=0) == "The program has changed since this search. Search again."


def test_in_a_challenge_changes_are_found_only_if_the_teacher_has_them_offered(searched):
    task = challenge("robot 3")
    lab, page, end = searched(starter("robot 3"), world=task.worlds[0])
    lab.connection.goal = Goal(task)
    assert lab.connection.view_state()["search"] is None
    assert "give the answer away" in page.do("find_change")
    lab.connection.goal = Goal(task, "changes")
    assert page.do("find_change") is None
    assert page.do("stop_search") is None
    assert end()["busy"] is False
