"""A sandbox closes what a program can do to a computer: each thing is possible without it, and not in it."""

import os
import shutil
import socket
import subprocess
import sys
from pathlib import Path

import pytest

import lrp_jupyter
from lrp_jupyter.errors import LRPError
from lrp_jupyter.grading import sandbox, workers
from lrp_jupyter.grading.batch import grade_all
from lrp_jupyter.grading.challenges import challenge
from lrp_jupyter.grading.workers import HowRun

FIRST = challenge("first move")
DRIVE = "(machine m (state driving (running [robot.move(linear=0.2)])))\n(spawn m driving)"
BWRAP = shutil.which("bwrap")
WORKS = BWRAP and not subprocess.run([BWRAP, "--unshare-user", "--ro-bind", "/", "/", "true"]).returncode
needs_bubblewrap = pytest.mark.skipif(not WORKS, reason="needs bubblewrap, and user namespaces")


def driving_unless_it_can(code):
    """Return a program that drives only if some lines of Python fail."""
    lines = f"import os, pathlib, socket\ntry:\n    {code}\n    can = True\nexcept Exception: can = False"
    text = f"exec(bytes.fromhex('{lines.encode().hex()}').decode(), names)"
    return (
        f"(var names := [{{}}])\n(machine m (state driving (onentry [{text}])\n"
        "  (running [robot.move(linear=0.0 if names['can'] else 0.2)])))\n(spawn m driving)"
    )


@pytest.mark.slow
@needs_bubblewrap
def test_what_a_program_can_do_to_a_computer_it_cannot_in_a_sandbox(tmp_path, monkeypatch):
    secret = tmp_path / "secret"
    secret.write_text("secret")
    monkeypatch.setenv("SECRET", "secret")
    workers.close_workers()  # those that are idle do not know it
    package = Path(lrp_jupyter.__file__).parent
    with socket.create_server(("127.0.0.1", 0)) as server:
        deeds = [
            f"open({str(secret)!r}).read()",
            f"os.listdir({str(tmp_path.parent)!r})",
            f"open({str(tmp_path / 'new')!r}, 'w').close()",
            f"path = pathlib.Path({str(package)!r}, 'new.py'); path.touch(); path.unlink()",
            "path = pathlib.Path('new'); path.touch(); path.unlink()",
            "path = pathlib.Path('/dev/shm/new'); path.touch(); path.unlink()",
            f"socket.create_connection({server.getsockname()!r}).close()",
            f"os.kill({os.getpid()}, 0)",
            "os.environ['SECRET']",
            "open('/etc/passwd').read()",
        ]
        texts = [driving_unless_it_can(deed) for deed in deeds]
        without = grade_all(texts, FIRST, 1)
        closed = grade_all([*texts, DRIVE], FIRST, 1, HowRun(sandbox=True))
    assert [deed for deed, each in zip(deeds, without, strict=True) if each.passed] == []
    assert [deed for deed, each in zip([*deeds, "drive"], closed, strict=True) if not each.passed] == []


@needs_bubblewrap
@pytest.mark.slow
def test_what_hangs_or_crashes_in_a_sandbox_is_told_as_without_it():
    hang = DRIVE.replace("robot.move(linear=0.2)", "while True: pass")
    crash = DRIVE.replace("robot.move(linear=0.2)", "import os; os.abort()")
    hungry = DRIVE.replace("robot.move(linear=0.2)", "x = ' ' * 3_000_000_000")
    texts, how = [hang, crash, hungry, DRIVE], HowRun(limit=3)
    assert grade_all(texts, FIRST, 1, how._replace(sandbox=True)) == grade_all(texts, FIRST, 1, how)


@needs_bubblewrap
def test_no_idle_process_outside_the_sandbox_makes_a_run_for_it():
    grade_all([DRIVE], FIRST, 1)
    outside = {worker.process.pid for worker in workers._idle}
    grade_all([DRIVE], FIRST, 1, HowRun(sandbox=True))
    inside = {worker.process.pid for worker in workers._sandboxed}
    assert inside
    assert not inside & outside
    workers.close_workers()
    assert not workers._sandboxed


def test_where_there_is_no_sandbox_a_sentence_says_how_to_get_one(monkeypatch):
    monkeypatch.setattr(sandbox.shutil, "which", lambda name: None)
    monkeypatch.setattr(sys, "platform", "linux")
    with pytest.raises(LRPError, match=r"`bwrap`, which is not installed. Install the package `bubblewrap`"):
        HowRun(sandbox=True).check()
    monkeypatch.setattr(sys, "platform", "darwin")
    with pytest.raises(LRPError, match=r"A sandbox needs Linux. Leave it out"):
        HowRun(sandbox=True).check()
    monkeypatch.setattr(workers, "check_sandbox", lambda: None)
    with pytest.raises(LRPError, match=r"A sandbox is for runs on this machine"):
        HowRun(sandbox=True, scheduler="local").check()


@pytest.mark.skipif(sys.platform != "linux", reason="a sandbox needs Linux")
def test_a_sandbox_that_the_system_refuses_is_an_error_and_no_mark(monkeypatch, tmp_path):
    refusing = tmp_path / "bwrap"
    refusing.write_text("#!/bin/sh\necho 'bwrap: No permissions to create a new namespace' >&2\nexit 1\n")
    refusing.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
    workers.close_workers()
    with pytest.raises(LRPError, match=r"does not start: bwrap: No permissions to create a new namespace\."):
        grade_all([DRIVE], FIRST, 1, HowRun(sandbox=True))
