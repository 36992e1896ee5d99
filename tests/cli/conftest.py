import os
import select
import subprocess
import sys
from pathlib import Path
from threading import Timer

import pytest
from support.waiting import until
from typer.testing import CliRunner

from lrp_jupyter.cli import app


@pytest.fixture
def lrp():
    """Run the command in this process."""

    def run(*arguments, **options):
        result = CliRunner().invoke(app, [str(each) for each in arguments], prog_name="lrp", **options)
        if result.exception is not None and not isinstance(result.exception, SystemExit):
            raise result.exception
        return result

    return run


@pytest.fixture
def program(tmp_path):
    """Write a program into a file."""

    def write(text, name="my.lrp"):
        path = tmp_path / name
        path.write_text(text, encoding="utf-8", newline="")
        return path

    return write


@pytest.fixture
def process():
    """Start the command as a process of its own, which ends with the test."""
    started, timers = [], []

    def start(*arguments, **options):
        options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True} | options
        command = [sys.executable, "-m", "lrp_jupyter", *map(str, arguments)]
        started.append(subprocess.Popen(command, **options))
        timers.append(Timer(240, started[-1].kill))
        timers[-1].start()
        return started[-1]

    yield start
    for timer in timers:
        timer.cancel()
    for each in started:
        if each.poll() is None:
            each.kill()
        each.communicate()


class Terminal:
    """A pseudo terminal with a process in it."""

    def __init__(self, arguments, columns=100, rows=40, term="xterm-256color", is_own=True):
        import termios

        self._master, slave = os.openpty()
        termios.tcsetwinsize(slave, (rows, columns))
        environment = os.environ | {"TERM": term, "COLUMNS": "", "LINES": ""}
        environment.pop("COLUMNS"), environment.pop("LINES"), environment.pop("NO_COLOR", None)
        self.process = subprocess.Popen(
            [sys.executable, "-m", "lrp_jupyter", *map(str, arguments)],
            stdin=slave, stdout=slave, stderr=slave, env=environment, start_new_session=True,
            preexec_fn=_take_terminal if is_own else None,
        )  # fmt: skip
        os.close(slave)
        self.text = ""

    def read(self):
        """Read what is there."""
        while select.select([self._master], [], [], 0)[0]:
            try:
                data = os.read(self._master, 65536)
            except OSError:  # the process has gone
                break
            if not data:
                break
            self.text += data.decode(errors="replace")
        return self.text

    def wait_for(self, text):
        """Wait until a text was written after the last one; forget what came before it."""
        until(lambda: text in self.read(), lambda: f"{text!r} did not come; there is {self.text[-2000:]!r}")
        self.text = self.text.partition(text)[2]

    def press(self, keys):
        os.write(self._master, keys.encode())

    def hang_up(self):
        """Close the terminal, as its window does."""
        os.close(self._master)
        self._master = os.open(os.devnull, os.O_RDWR)

    def end(self):
        """Wait for the end; the exit code."""
        until(lambda: (self.read(), self.process.poll() is not None)[1], "it did not end")
        return self.process.returncode

    def close(self):
        if self.process.poll() is None:
            self.process.kill()
        self.process.wait()
        os.close(self._master)


def _take_terminal():
    import fcntl
    import termios

    fcntl.ioctl(0, termios.TIOCSCTTY, 0)


@pytest.fixture
def terminal():
    started = []

    def start(*arguments, **options):
        started.append(Terminal(arguments, **options))
        return started[-1]

    yield start
    for each in started:
        each.close()


@pytest.fixture
def here(tmp_path, monkeypatch):
    """Be in an empty folder."""
    monkeypatch.chdir(tmp_path)
    return Path()
