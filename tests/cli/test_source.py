"""The file of a run, as it is saved."""

from __future__ import annotations

import threading
from pathlib import Path

import pytest

from lrp_jupyter.cli import source
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
