"""A small robot for the tests of bridges."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Iterator

import pytest
from support.robots import Cart

from lrp_jupyter.bridges.conformance import BridgeConformance


@pytest.fixture(autouse=True)
def _patience(monkeypatch: pytest.MonkeyPatch) -> None:
    """Have the checks of a bridge wait for a robot, or for this process, that the machine holds up."""
    for limit, seconds in {"open": 60.0, "answer": 10.0, "stale": 10.0, "lost": 20.0}.items():
        monkeypatch.setattr(BridgeConformance, f"{limit}_within", seconds)


@pytest.fixture
def cart() -> Cart:
    """Open and armed."""
    cart = Cart()
    cart.open()
    cart.arm()
    return cart


@pytest.fixture
def disarmed() -> Cart:
    """Open, as hardware opens."""
    cart = Cart()
    cart.open()
    return cart


JUPYTER = (
    *("IPython", "anywidget", "comm", "ipykernel", "ipywidgets", "jupyter_client", "jupyter_core"),
    *("jupyter_server", "jupyterlab", "notebook", "traitlets"),
)
_BARE = """
import sys
sys.modules.update(dict.fromkeys({missing}))  # to import one of these is an error
{before}
from lrp_jupyter.cli import main
main()
"""


@pytest.fixture
def bare_lrp() -> Iterator[Callable[..., subprocess.Popen[str]]]:
    """Start the command line as on a machine without Jupyter, or whatever else is `missing`.

    `before` is code that runs before it: where a test is not about time, it lets nothing be late.
    """
    started: list[subprocess.Popen[str]] = []

    def start(
        *arguments: object,
        missing: tuple[str, ...] = (),
        environment: dict[str, str] | None = None,
        before: str = "",
    ) -> subprocess.Popen[str]:
        process = subprocess.Popen(
            [
                sys.executable,
                "-c",
                _BARE.format(missing=(*JUPYTER, *missing), before=before),
                *map(str, arguments),
            ],
            env={**(environment or os.environ), "PYTHONWARNINGS": ""},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        started.append(process)
        return process

    yield start
    for process in started:
        if process.poll() is None:
            process.kill()
        process.communicate()
