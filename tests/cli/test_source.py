"""The file of a run, as it is saved."""

from __future__ import annotations

import threading
from pathlib import Path

import pytest
from support.tables import every
from support.waiting import until

from lrp_jupyter.cli import program_source as source
from lrp_jupyter.errors import FileError
from lrp_jupyter.files import read_text

OLD, NEW = "(machine m (state a)) (spawn m a)", "(machine m (state b)) (spawn m b)"


def test_a_file_that_is_being_written_is_read_when_it_is_whole(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, saved, parts = tmp_path / "my.lrp", [], ["", NEW[:21]]
    path.write_text(OLD)

    def read(path: Path) -> str:
        text = read_text(path)
        return parts.pop(0) if text == NEW and parts else text

    monkeypatch.setattr(source, "read_text", read)
    whole = threading.Event()

    def save(text: object) -> None:
        saved.append(text)
        if text == NEW:
            whole.set()

    watch = source.Watch(path, OLD, save)
    path.write_text(NEW)
    assert whole.wait(60)
    watch.close()
    assert (saved, parts) == ([NEW], [])


def test_a_file_that_is_gone_is_told_at_once_and_once_though_others_beside_it_are_written(
    tmp_path: Path,
) -> None:
    path, said, told, back = tmp_path / "my.lrp", [], threading.Event(), threading.Event()
    path.write_text(OLD)

    def save(text: object) -> None:
        said.append(text)
        (back if text == OLD else told).set()

    path.unlink()  # after it was read, and before it is watched
    watch = source.Watch(path, OLD, save)
    beside = tmp_path / "trace.jsonl"
    until(lambda: beside.write_text("") or told.is_set(), "it was not told")
    path.write_text(OLD)
    assert back.wait(60)
    watch.close()
    assert [type(each) for each in said] == [FileError, str]


@pytest.mark.slow
@every(
    "arguments",
    [
        ["check", "null.lrp"],
        ["format", "null.lrp"],
        ["graph", "null.lrp"],
        ["run", "null.lrp", "--for", "0"],
        ["run", "follower", "--for", "0", "--world", "null.json"],
        ["run", "follower", "--for", "0", "--bridge", "null.py"],
        ["replay", "null.lrplog"],
        ["why", "null.lrplog.gz", "a"],
        ["worlds", "--show", "null.json"],
        ["bridges", "null.py"],
        ["grade", "null.lrp", "--challenge", "square"],
        ["grade", "follower", "--challenge", "null.py"],
        ["sweep", "null.lrp", "--challenge", "square", "--set", "a=1"],
    ],
)
def test_no_command_reads_a_device_which_may_have_no_end(lrp, here, arguments) -> None:
    file = here / next(each for each in arguments if each.startswith("null."))
    file.unlink(missing_ok=True)
    file.symlink_to("/dev/null")  # which has an end, so that the test has one, too
    done = lrp(*arguments)
    told = " ".join((done.stderr + done.stdout).split())
    assert "a device or a pipe" in told
    assert done.exit_code == (2 if arguments[0] not in ("check", "format") else done.exit_code) != 0
