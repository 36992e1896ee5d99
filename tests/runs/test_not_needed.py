"""A run that is not needed any more is not made."""

from runs.conftest import LAPS
from support.waiting import until

from lrp_jupyter.grading import workers
from lrp_jupyter.grading.worker import LOST
from lrp_jupyter.runs.rerun import Rerun

REQUEST = workers._packed(Rerun((LAPS,), "nowhere.lrplog"), 1000)


def test_a_run_is_not_begun_by_a_worker_that_starts_when_it_is_needed_no_more():
    workers.close_workers()
    crew = workers._Processors(1)
    ending = crew.submit(REQUEST)
    until(lambda: crew._busy)
    crew.close()
    assert ending.result() == LOST
    (worker,) = workers._idle  # it makes the next one
    assert not worker.is_spent
