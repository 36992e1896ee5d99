"""The file of a run, as it is saved."""

from __future__ import annotations

import threading
from pathlib import Path

import pytest
from support.waiting import until

from lrp_jupyter.cli import source
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
