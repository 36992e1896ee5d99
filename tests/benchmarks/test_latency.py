"""The benchmark of the page itself works; its figures are not asserted."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from e2e.jupyter import lacking


@pytest.mark.browser
@pytest.mark.skipif(bool(lacking()) and not os.environ.get("CI"), reason=f"there is no {lacking()}")
def test_the_benchmark_of_the_page_runs_and_loses_nothing():
    script = Path(__file__).with_name("latency.py")
    done = subprocess.run(
        [sys.executable, "-W", "ignore", script, "--quick"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "| stop |" in done.stdout
    fired, told = re.search(r"(\d+) transitions fired; the page was told of (\d+)", done.stdout).groups()
    assert fired == told
    assert "at 100 Hz" in done.stdout
