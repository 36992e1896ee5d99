"""The runs that are kept beside a program: recordings in folders, and what is expected of each."""

from __future__ import annotations

import json
import os
import tomllib
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

from lrp_jupyter.errors import FileError
from lrp_jupyter.files import read_text, shown, unreadable, unwritable, write_file
from lrp_jupyter.live.stored.run_files import ENDINGS, check_name, name_of
from lrp_jupyter.logs import unused
from lrp_jupyter.runs.expectation import AS_RECORDED, expectation

EXPECTED = "expected.toml"
"""The file in a folder of runs that says what is expected of each."""
REMOVED = ".removed"
_HEAD = "# What is expected of each run, such as: reaches STATE within 30 s, never touches\n"


class KeptRun(NamedTuple):
    """A kept run.

    Parameters
    ----------
    name : str
    file : Path
        Its recording.
    expected : str
        What is expected of it, in one line: see :mod:`~lrp_jupyter.runs.expectation`.
    """

    name: str
    file: Path
    expected: str = AS_RECORDED


Where = str | os.PathLike[str] | Iterable[KeptRun | str | os.PathLike[str]]
"""A folder of runs or a recording, or several of them; among these also runs themselves."""


def kept_runs(where: Where) -> tuple[KeptRun, ...]:
    """Return the runs of a folder in the order of their names, or those of several folders and files.

    Raises
    ------
    FileError
        There is no such folder or file, or what is expected of its runs cannot be read.
    """
    several = [where] if isinstance(where, (str, os.PathLike)) else where
    found = [
        run for each in several for run in ([each] if isinstance(each, KeptRun) else _runs_at(Path(each)))
    ]
    return tuple(dict.fromkeys(found))


def _runs_at(path: Path) -> Iterator[KeptRun]:
    if not path.exists():
        raise FileError(
            f"`{shown(path)}` does not exist. It should be a recording, or a folder of recordings."
        )
    return _runs_in(path) if path.is_dir() else _runs_in(path.parent, path)


def _runs_in(folder: Path, only: Path | None = None) -> Iterator[KeptRun]:
    expected = _expected_in(folder)
    try:
        files = sorted(folder.iterdir()) if only is None else [only]
    except OSError as error:
        raise unreadable(folder, error) from None
    for file in files:
        if only is not None or file.name.endswith(ENDINGS):
            name = name_of(file)
            yield KeptRun(name, file, expected.get(name, AS_RECORDED))


def _expected_in(folder: Path) -> dict[str, str]:
    file = folder / EXPECTED
    if not file.exists():
        return {}
    try:
        lines = tomllib.loads(read_text(file))
    except tomllib.TOMLDecodeError as error:
        raise FileError(f"`{shown(file)}` cannot be read: {error}.") from None
    wrong = next((name for name, line in lines.items() if not isinstance(line, str)), None)
    if wrong is not None:
        raise FileError(f"`{shown(file)}`: what is expected of `{wrong}` must be a text in quotation marks.")
    return lines


def expect(run: KeptRun, line: str) -> KeptRun:
    """Write what is expected of a run; return it.

    Raises
    ------
    LRPError
        The line cannot be read.
    FileError
        The file cannot be written.
    """
    wanted = str(expectation(line))
    folder = run.file.parent
    _write(folder, {**_expected_in(folder), run.name: wanted})
    return run._replace(expected=wanted)


def _write(folder: Path, lines: dict[str, str]) -> None:
    """Write what is expected of the runs in a folder, but for what is the default."""
    kept = {name: line for name, line in sorted(lines.items()) if line != AS_RECORDED}
    quoted = [f"{_quoted(name)} = {_quoted(line)}\n" for name, line in kept.items()]
    if quoted or (folder / EXPECTED).exists():
        write_file(folder / EXPECTED, _HEAD + "".join(quoted))


def _quoted(text: str) -> str:
    """Return a text as TOML writes it, which differs from JSON in one character."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007F")


def rename(run: KeptRun, name: str) -> KeptRun:
    """Give a run another name; return it.

    Raises
    ------
    FileError
        It cannot have this name, or another run has it.
    """
    check_name(name)
    file = run.file.with_name(f"{name}{run.file.name[len(run.name) :]}")
    if file.exists():
        raise FileError(f"There is already a run `{name}`. Choose another name.")
    lines = _expected_in(run.file.parent)
    _move(run.file, file)
    lines.pop(run.name, None)
    _write(run.file.parent, {**lines, name: run.expected})
    return KeptRun(name, file, run.expected)


def remove(run: KeptRun) -> None:
    """Move the file of a run into the folder ``.removed`` beside it, where it can be found again.

    Raises
    ------
    FileError
        It cannot be moved.
    """
    folder = run.file.parent / REMOVED
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise unwritable(folder, error) from None
    _move(run.file, unused(folder / run.file.name))


def _move(file: Path, to: Path) -> None:
    try:
        file.rename(to)
    except OSError as error:
        raise unwritable(to, error) from None
