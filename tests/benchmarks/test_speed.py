"""The benchmark itself works; its figures are not asserted."""

import subprocess
import sys
from pathlib import Path

import pytest


@pytest.mark.slow
def test_the_benchmark_runs_and_prints_ratios():
    script = Path(__file__).with_name("speed.py")
    done = subprocess.run([sys.executable, script, "--quick"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "| lrp |" in done.stdout
    assert "times real time" in done.stdout


@pytest.mark.slow
def test_the_benchmark_of_the_past_runs_and_prints_ratios():
    script = Path(__file__).with_name("past.py")
    done = subprocess.run([sys.executable, script, "--quick"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "| why not, now |" in done.stdout
    assert "with no difference" in done.stdout


@pytest.mark.slow
def test_the_benchmark_of_batches_runs_and_its_results_are_the_same_everywhere():
    script = Path(__file__).with_name("batch.py")
    done = subprocess.run([sys.executable, script, "--quick"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("| the same |") == 9
