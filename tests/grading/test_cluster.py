"""The same runs on a Dask cluster: two workers, each a process of its own, on this machine."""

import os
import signal
import tempfile
from pathlib import Path

import pytest

from lrp_jupyter import sweep
from lrp_jupyter.errors import LRPError
from lrp_jupyter.grading.batch import grade_all
from lrp_jupyter.grading.challenges import challenge
from lrp_jupyter.grading.grade import jobs_of
from lrp_jupyter.grading.marks import grade_class
from lrp_jupyter.grading.submissions import Submission
from lrp_jupyter.grading.workers import HowRun, run_jobs

pytestmark = pytest.mark.slow  # each starts processes of its own

DRIVE = "(var v := [0.2]) (machine m (state driving (running [robot.move(linear=v)]))) (spawn m driving)"
HANG = DRIVE.replace("robot.move(linear=v)", "while True: pass")
CRASH = DRIVE.replace("robot.move(linear=v)", "import os; os.abort()")
FIRST = challenge("first move")


@pytest.fixture(autouse=True, scope="module")
def distributed():
    return pytest.importorskip("distributed", reason="needs the extra `batch`")  # slow: only where it is used


@pytest.fixture(scope="module")
def cluster(distributed, tmp_path_factory):
    """A cluster of two workers, reachable from this machine only."""
    with distributed.LocalCluster(
        n_workers=2,
        threads_per_worker=1,
        processes=True,
        host="127.0.0.1",
        dashboard_address="127.0.0.1:0",
        local_directory=str(tmp_path_factory.mktemp("dask")),
    ) as started:
        yield started


def test_a_class_has_the_same_marks_on_a_cluster(cluster):
    submissions = [
        Submission("Ada", "ada.lrp", DRIVE),
        Submission("Bob", "bob.lrp", HANG),
        Submission("Carl", "carl.lrp", CRASH),
        Submission("Dora", "dora.lrp", "(machine"),
        Submission("Eve", "eve.lrp", None, "`eve.lrp` cannot be read."),
        Submission("Fred", "fred.lrp", DRIVE.replace("0.2", "0.02")),
    ]
    seen = []
    here = grade_class(submissions, FIRST, 3, HowRun(limit=3))
    there = grade_class(
        submissions,
        FIRST,
        3,
        HowRun(limit=3, scheduler=cluster.scheduler_address),
        lambda done, of: seen.append((done, of)),
    )
    assert there == here
    assert [mark.grade.points > 0 for mark in there.marks] == [True, False, False, False, False, True]
    assert (seen[0], seen[-1]) == ((0, 15), (15, 15))


def test_a_sweep_has_the_same_result_on_a_cluster(cluster):
    values = [0.02, 0.1, 0.2]
    here = sweep(DRIVE, "first move", v=values, seeds=2)
    there = sweep(DRIVE, "first move", v=values, seeds=2, scheduler=cluster.scheduler_address)
    assert there == here


def test_a_name_of_the_notebook_is_sent_to_the_cluster(cluster):
    text = DRIVE.replace("linear=v", "linear=speed()")
    how = HowRun(scheduler=cluster.scheduler_address, namespace={"speed": lambda: 0.2})
    (graded,) = grade_all([text], FIRST, 1, how)
    assert graded.passed


def test_a_lost_worker_does_not_lose_the_batch(cluster):
    jobs = jobs_of(DRIVE, "edge guard", 12)[1]
    expected = dict(run_jobs(jobs))
    pids = [worker.pid for worker in cluster.workers.values()]
    made = {}
    for index, attempt in run_jobs(jobs, HowRun(scheduler=cluster.scheduler_address)):
        if not made:
            os.kill(pids[0], signal.SIGKILL)
        made[index] = attempt
    assert made == expected


def test_a_local_cluster_is_started_and_leaves_nothing_behind():
    before = set(Path(tempfile.gettempdir()).glob("lrp-dask-*"))
    (graded,) = grade_all([DRIVE], FIRST, 2, HowRun(processes=1, scheduler="local"))
    assert graded.passed
    assert set(Path(tempfile.gettempdir()).glob("lrp-dask-*")) == before


def test_a_local_cluster_runs_no_module_of_the_current_folder(tmp_path, monkeypatch):
    (tmp_path / "multiprocessing.py").write_text("open('ran', 'w').close()")
    monkeypatch.chdir(tmp_path)
    (graded,) = grade_all([DRIVE], FIRST, 1, HowRun(processes=1, scheduler="local"))
    assert graded.passed
    assert not Path("ran").exists()
    assert "PYTHONSAFEPATH" not in os.environ


def test_a_scheduler_that_is_not_there_is_a_sentence(monkeypatch):
    monkeypatch.setattr("lrp_jupyter.grading.cluster._CONNECTING", 1)
    with pytest.raises(LRPError, match=r"There is no Dask scheduler at `tcp://127\.0\.0\.1:1`"):
        grade_all([DRIVE], FIRST, 1, HowRun(scheduler="tcp://127.0.0.1:1"))


def test_a_cluster_that_has_no_workers_is_a_sentence(distributed, monkeypatch, tmp_path):
    monkeypatch.setattr("lrp_jupyter.grading.cluster._WITHOUT_WORKERS", 1)
    with (
        distributed.LocalCluster(
            n_workers=0, host="127.0.0.1", dashboard_address="127.0.0.1:0", local_directory=str(tmp_path)
        ) as empty,
        pytest.raises(LRPError, match=r"has had no worker for a minute\. Start some"),
    ):
        grade_all([DRIVE], FIRST, 1, HowRun(scheduler=empty.scheduler_address))
