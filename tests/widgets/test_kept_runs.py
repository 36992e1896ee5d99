"""Runs that are kept beside an open program: run again with every text, and shown in the page."""

import shutil
from threading import Event

import pytest
from runs.conftest import LAPS

import lrp_jupyter.grading.challenges as registry
from lrp_jupyter.grading.challenges import Challenge
from lrp_jupyter.grading.criteria import drives, ends_in
from lrp_jupyter.live.running.commands import Call
from lrp_jupyter.runs.decide import decide
from lrp_jupyter.sim.world import BoxZone, RobotSpec, World
from lrp_jupyter.widgets.views.goal import Goal

SLOWER = LAPS.replace("[0.3]", "[0.29]")


class Beside:
    """An open program in a folder of its own, whose page shows the runs that are kept beside it."""

    def __init__(self, bench):
        self.lab = bench(LAPS, bridge="sim", world="line", name="laps")
        self.page, self.session, self.runs = self.lab.page(), self.lab.session, self.lab.connection.runs
        self._news = Event()
        self.runs.attach(self._news.set)

    def decided(self):
        """Return what is shown when all runs have been run again with the present program."""
        while self.runs.view(self.session)["coverage"] is None:
            assert self._news.wait(60)
            self._news.clear()
        return self.runs.kept()

    def keep(self, name, seconds=25.0, expected=""):
        self.session.run(seconds)
        assert self.page.do("keep_run", name=name, expected=expected) is None


@pytest.fixture
def beside(bench, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return Beside(bench)


@pytest.mark.slow
def test_a_run_is_kept_decided_about_at_an_edit_and_shown_at_its_first_difference(beside):
    beside.keep("wall")
    run = beside.decided()["wall"]
    assert (run["state"], run["differs"], run["lane"], run["recorded"]) == (
        "passed",
        None,
        "laps",
        run["now"],
    )
    beside.page.type(SLOWER)
    run = beside.decided()["wall"]
    (outcome,) = decide(SLOWER, ["laps.runs"]).outcomes.values()
    assert (run["state"], run["reason"]) == ("failed", outcome.reason)
    assert run["differs"] == (outcome.time, outcome.difference)
    assert beside.page.do("show_run", name="wall") is None
    looking = beside.lab.connection.view_state()["looking"]
    begin = beside.session.frame.time - run["seconds"]
    assert looking["time"] == pytest.approx(begin + outcome.time, abs=0.11)
    assert beside.page.do("accept_run", name="wall") is None
    assert beside.decided()["wall"]["state"] == "passed"


@pytest.mark.slow
def test_what_is_expected_is_written_by_the_page_and_what_cannot_be_is_refused_there(beside):
    beside.keep("wall", expected="never enters away")
    assert "`away` is entered at" in beside.decided()["wall"]["reason"]
    assert beside.page.do("expect", name="wall", expected="reaches away within 30 s") is None
    assert beside.decided()["wall"]["state"] == "passed"
    assert "is not something that can be expected" in beside.page.do("expect", name="wall", expected="works")
    assert beside.page.do("rename_run", name="wall", new_name="edge") is None
    assert {name: run["expected"] for name, run in beside.decided().items()} == {
        "edge": "reaches away within 30 s"
    }
    assert beside.page.do("expect", name="wall", expected="") == "The run `wall` no longer exists."
    beside.page.do("forget_run", name="edge")
    assert beside.runs.folder.joinpath(".removed", "edge.lrplog").exists()


@pytest.mark.slow
def test_only_a_run_that_has_changed_is_run_again_while_the_program_is_the_same(beside):
    for name in ("one", "other"):
        beside.keep(name, seconds=5)
    beside.decided()

    def states():
        return {name: run["state"] for name, run in beside.runs.kept().items()}

    assert beside.page.do("expect", name="one", expected="reaches away") is None
    assert states()["other"] == "passed"
    beside.decided()
    assert states() == {"one": "failed", "other": "passed"}
    beside.page.do("forget_run", name="other")
    beside.keep("other", seconds=1)  # another one of this name
    assert beside.decided()["other"]["seconds"] == pytest.approx(11, abs=0.11)


@pytest.mark.slow
def test_what_all_runs_cover_is_told_once_the_newest_is_decided(beside, monkeypatch):
    began, is_kept = Event(), Event()

    def decide_late(*args, **options):
        decide(*args, **options)
        began.set()
        assert is_kept.wait(60)

    monkeypatch.setattr("lrp_jupyter.widgets.views.shown_runs.decide", decide_late)
    beside.keep("one", seconds=5)
    beside.runs.view(beside.session)
    assert began.wait(60)
    beside.keep("other", seconds=5)
    is_kept.set()
    assert {name: run["state"] for name, run in beside.decided().items()} == {
        "one": "passed",
        "other": "passed",
    }


@pytest.mark.slow
def test_a_new_run_begins_at_the_start_and_the_recordings_of_a_folder_are_shown_too(beside, tmp_path):
    beside.session.run(3)
    assert beside.page.do("new_run") is None
    beside.session.pause()
    assert beside.session.bridge.pose == beside.session.bridge.world.robots[0].pose
    beside.keep("again", seconds=5)
    (tmp_path / "other").mkdir()
    (tmp_path / "laps.runs" / "again.lrplog").rename(tmp_path / "other" / "strange.lrplog")
    assert "does not exist" in beside.page.do("attach_runs", folder="nowhere")
    assert beside.page.do("attach_runs", folder=str(tmp_path / "other")) is None
    assert [*beside.decided()] == ["strange"]


@pytest.mark.slow
def test_runs_of_one_name_in_several_folders_are_all_shown(beside, tmp_path):
    beside.keep("run", seconds=3)
    shutil.copytree(tmp_path / "laps.runs", tmp_path / "other")
    for folder in ("other", str(tmp_path / "other"), "laps.runs"):
        assert beside.page.do("attach_runs", folder=folder) is None
    assert beside.runs.view(beside.session)["attached"] == ["other"]
    assert [*beside.decided()] == beside.runs.view(beside.session)["names"] == ["run", "run (other)"]
    assert beside.page.do("expect", name="run (other)", expected="reaches away") is None
    assert [run["state"] for run in beside.decided().values()] == ["passed", "failed"]


@pytest.mark.slow
def test_the_newest_of_many_edits_is_the_one_that_is_decided_about(beside):
    for name in ("a", "b", "c"):
        beside.keep(name, seconds=9)
    beside.decided()
    for number in range(20):
        beside.page.type(LAPS.replace("[0.3]", f"[0.{30 + number}]"))
        beside.runs.view(beside.session)
    shown = beside.decided()
    made = decide(beside.session.program, ["laps.runs"]).outcomes
    assert {name: (run["reason"], run["now"][-1]) for name, run in shown.items()} == {
        run.name: (outcome.reason, (outcome.now[-1].time, f"laps/{outcome.now[-1].state}"))
        for run, outcome in made.items()
    }


def test_what_no_run_has_reached_is_shown_by_the_numbers_of_the_runs(beside):
    beside.keep("short", seconds=1)
    beside.keep("whole", seconds=24)
    beside.decided()
    coverage = beside.runs.view(beside.session)["coverage"]
    assert coverage["states"] == {"laps/ahead": [0, 1], "laps/aside": [1], "laps/away": [1]}
    assert coverage["transitions"]["laps/on:ahead->aside"] == []
    assert coverage["conditions"] == {"laps/on:ahead->aside": "never true"}
    assert coverage["words"].startswith("Reached: 3 of 3 states, ")


ROOM = World(
    name="a/b", size=(3, 2), robots=(RobotSpec((0.5, 1, 0)),), zones={"end": BoxZone((2.5, 1, 1, 1))}
)
SOON = Challenge("home/soon", "Reach the end.", (ROOM,), (drives(1), ends_in("end")), 8, hold=0)


def test_a_run_of_a_check_is_kept_and_has_to_meet_the_challenge(beside, monkeypatch):
    monkeypatch.setattr(registry, "_challenges", {SOON.name: SOON})
    goal = beside.lab.connection.goal = Goal(SOON)
    ended = Event()
    goal.attach(beside.session, lambda: goal.view(beside.session, LAPS)["check"]["busy"] or ended.set())
    assert beside.page.do("keep_attempt", index=0) == "This run is no longer known. Check again."
    beside.page.do("check")
    assert ended.wait(60)
    beside.session.run(1.03)  # to between two ticks
    assert beside.page.do("keep_attempt", index=0) is None
    assert beside.lab.connection.view_state()["looking"] is None
    ((name, run),) = beside.decided().items()
    attempt = goal.attempts()["0"]
    assert (name, run["expected"]) == (f"a-b, seed {attempt['seed']}", "meets home/soon")
    assert (run["state"], run["differs"]) == ("failed", None)
    assert attempt["failed"] in run["reason"]


def test_a_program_that_no_run_can_be_kept_of_says_why(beside):
    view = beside.runs.view(beside.session)
    assert (view["keeps"], view["folder"]) == ("No tick has run yet. Run the program first.", "laps.runs")
    assert beside.page.do("keep_run", name="x") == view["keeps"]


def test_a_run_that_is_shown_is_shown_whole_whatever_is_asked_for_meanwhile(beside):
    beside.keep("wall")
    beside.decided()
    end = beside.session.on_tick(lambda: beside.session.submit(Call(beside.session.bridge.refresh)))
    before = beside.session.frame.time
    assert beside.page.do("show_run", name="wall") is None
    end()
    assert beside.session.frame.time == pytest.approx(before + 25)
