"""What all tests share: what Hypothesis tries, guards without a clock, and a state folder of their own.

By default Hypothesis tries the same examples every time, however loaded the machine is.
``HYPOTHESIS_PROFILE=long`` tries other ones at every run, and more of them; an example that fails is
printed with the line that repeats it. ``few`` tries the first of those that are always tried.
"""

import gc
import os
import signal
import sys

import pytest
from hypothesis import HealthCheck, settings

always = settings(deadline=None, database=None, suppress_health_check=[HealthCheck.too_slow])
settings.register_profile("same", always, max_examples=25, derandomize=True)
settings.register_profile("few", always, max_examples=8, derandomize=True)
settings.register_profile("long", always, max_examples=150, print_blob=True)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "same"))

os.environ.pop("VIRTUAL_ENV", None)  # IPython warns if it is not the one of these tests
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # in a shell's background; children inherit it
    signal.signal(signal.SIGINT, signal.default_int_handler)
if hasattr(signal, "SIGHUP"):  # by `nohup`, which a program obeys
    signal.signal(signal.SIGHUP, signal.SIG_DFL)


def pytest_collection_finish():
    """Keep thousands of tests out of every garbage collection to come."""
    if sys.version_info < (3, 14):  # there Hypothesis would miss who refers to its random numbers
        gc.collect()
        gc.freeze()


@pytest.fixture(autouse=True, scope="session")
def _no_workers_left():
    """End the processes in which programs were graded."""
    yield
    workers = sys.modules.get("lrp_jupyter.grading.workers")
    if workers is not None:
        workers.close_workers()


@pytest.fixture(autouse=True)
def _no_suspension(monkeypatch):
    """Have no time pass for guards of this process: a test that the machine holds up is not suspended."""
    from lrp_jupyter.bridges.guarding import guard

    present = guard.now()
    monkeypatch.setattr(guard, "now", lambda: present)
    monkeypatch.setattr(guard, "SILENCE", 3600.0)  # of this process, for the guard process


@pytest.fixture(autouse=True)
def _path(monkeypatch):
    """Search no folder for modules that an earlier test had searched."""
    monkeypatch.setattr(sys, "path", [*sys.path])


@pytest.fixture(autouse=True, scope="session")
def _state(tmp_path_factory):
    """Keep this user's state out of the tests, and theirs out of the user's."""
    before = os.environ.get("XDG_STATE_HOME")
    os.environ["XDG_STATE_HOME"] = str(tmp_path_factory.mktemp("state"))
    yield
    if before is None:
        del os.environ["XDG_STATE_HOME"]
    else:
        os.environ["XDG_STATE_HOME"] = before
