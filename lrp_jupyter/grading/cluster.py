"""A Dask cluster that makes runs: ``--scheduler ADDRESS``.

Each task makes one run as it is made without a cluster: in a process of its own, on the machine of the Dask
worker. So the results are the same, and a program that crashes ends no Dask worker. If a Dask worker is lost,
the scheduler gives its tasks to another one.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from concurrent.futures import CancelledError, Future
from contextlib import ExitStack
from typing import Any

from lrp_jupyter.errors import LRPError, sentence_of
from lrp_jupyter.grading.worker import LOST, Ending, Request
from lrp_jupyter.process import safe_path

_LOCAL = "127.0.0.1:0"  # any port, for this machine only
_CONNECTING = 20.0  # s until a scheduler must have answered
_WITHOUT_WORKERS = 60.0  # s


class Cluster:
    """A cluster to which runs are sent.

    `address`: of its scheduler, or ``"local"``: then a cluster is started on this machine, reachable from
        here only, and ends with this object.
    `make`: what a Dask worker does with a request: a function of a module.
    `processes`: how many Dask workers a local cluster has.
    Raises LRPError: dask is not installed, or the scheduler cannot be reached.
    """

    patience = 5.0

    def __init__(self, address: str, make: Callable[[Request], Ending], processes: int) -> None:
        try:
            import distributed
        except ImportError as error:
            raise LRPError(
                "A cluster needs the package `distributed`, which is not installed. Run "
                '`pip install "lrp-jupyter[batch]"`, or leave the scheduler out.'
            ) from error
        self._make, self._address = make, address
        self._lost = distributed.scheduler.KilledWorker
        with ExitStack() as opened:
            try:
                where: Any = local_cluster(opened, processes) if address == "local" else address
                self._client = opened.enter_context(_client(where))
            except (OSError, ValueError, RuntimeError) as error:
                raise LRPError(
                    f"There is no Dask scheduler at `{address}`: {sentence_of(error)} Start one with "
                    "`dask scheduler`, which prints its address, or write `local`."
                ) from error
            self._executor = self._client.get_executor(pure=False)
            self._opened = opened.pop_all()

    @property
    def size(self) -> int:
        """How many runs its workers make at a time.

        Raises LRPError: there has been no worker for a minute, or the scheduler is gone.
        """
        try:
            threads = sum(map(int, self._client.nthreads().values()))
            if not threads:
                self._client.wait_for_workers(1, timeout=_WITHOUT_WORKERS)
        except TimeoutError as error:
            raise LRPError(
                f"The Dask cluster at `{self._address}` has had no worker for a minute. Start some with "
                f"`dask worker {self._address}`, in an environment with lrp-jupyter."
            ) from error
        except (OSError, ValueError) as error:
            raise self._gone(error) from error
        return max(1, threads)

    def submit(self, request: Request) -> Future[Ending]:
        """Have a run made."""
        future: Future[Ending] = self._executor.submit(self._make, request)
        return future

    def result(self, future: Future[Ending]) -> Ending:
        """Return the ending of a run; it is lost if it has ended the Dask workers that tried it.

        Raises LRPError: the scheduler is gone, or a worker cannot make runs.
        """
        try:
            return future.result()
        except self._lost:
            return LOST
        except CancelledError as error:
            raise self._gone(error) from error
        except Exception as error:  # whatever a worker without the package, or with another version, raises
            raise LRPError(
                f"A worker of the Dask cluster cannot make runs: {sentence_of(error)} Install the same "
                "versions of Python and lrp-jupyter there."
            ) from error

    def _gone(self, error: BaseException) -> LRPError:
        return LRPError(f"The Dask scheduler at `{self._address}` is gone: {sentence_of(error)}")

    def close(self) -> None:
        """Cancel what was not made, and leave the cluster; a local one ends."""
        with self._opened:
            self._executor.shutdown(wait=False)


def _client(where: Any) -> Any:
    import distributed

    return distributed.Client(where, timeout=_CONNECTING)  # type: ignore[no-untyped-call]


def local_cluster(opened: ExitStack, processes: int) -> Any:
    """Start a cluster on this machine: a process for each of its workers, all for this machine only."""
    import distributed

    opened.enter_context(safe_path())
    folder = opened.enter_context(tempfile.TemporaryDirectory(prefix="lrp-dask-", ignore_cleanup_errors=True))
    return opened.enter_context(
        distributed.LocalCluster(  # type: ignore[no-untyped-call]
            n_workers=processes,
            threads_per_worker=1,
            processes=True,
            host="127.0.0.1",
            dashboard_address=_LOCAL,
            worker_dashboard_address=_LOCAL,
            local_directory=folder,
        )
    )
