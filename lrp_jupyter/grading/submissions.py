"""What students hand in: files, or a folder with a file or a sub-folder for each of them.

A program is a file ``*.lrp``, or a ``%%lrp`` cell of a notebook, into which the lab writes its text when the
notebook is saved. A lab without such a cell is saved with its text in its output. The layouts of Moodle and
nbgrader, which have a folder for each student, are read as they are.
"""

from __future__ import annotations

import json
import re
import shlex
from collections.abc import Iterator, Sequence
from pathlib import Path, PurePath
from typing import Any, NamedTuple

from lrp_jupyter.errors import FileError, LRPError, printable
from lrp_jupyter.files import read_text, shown, unreadable
from lrp_jupyter.grading.challenges import Challenge

_SUFFIXES = (".lrp", ".ipynb")
_MOODLE = re.compile(r"_\d+_assignsubmission_.*")
_CELL = re.compile(r"\s*%%lrp\b(.*)")
_LONGEST = 1_000_000  # characters of a program


_Found = tuple[list[str], str]
"""The words after ``%%lrp``, and the program."""


class Submission(NamedTuple):
    """A program that was handed in.

    `student`: the name of the student's folder or, where there is none, that of the file.
    `file`: its path; of several files among which none can be chosen, that of their folder. Of both, what a
        terminal obeys or no file can hold is shown by its number.
    `text`: None if it cannot be read.
    `problem`: why it cannot be read, a sentence.
    `as_given`: whether it is the text that was given out, apart from white space.
    """

    student: str
    file: str
    text: str | None = None
    problem: str = ""
    as_given: bool = False


def find_submissions(
    paths: Sequence[str | Path], task: Challenge, given: Path | None = None
) -> list[Submission]:
    """Return the submissions in files and folders; one that cannot be read says why.

    `given`: the file that was given out; default: the text with which a lab of the challenge begins.
    Raises FileError: a path does not exist, or there is no submission in any of them.
    """
    first = task.beginning if given is None else read_submission(given, task)
    found = []
    for path in map(Path, paths):
        if path.is_dir():
            found += list(_in_folder(path, task))
        elif path.exists():
            found.append(_read(_student(path.stem), [path], path, task))
        else:
            raise FileError(f"`{shown(path)}` is neither a file nor a folder.")
    if not found:
        listed = ", ".join(f"`{shown(path)}`" for path in paths)
        raise FileError(
            f"There is no submission in {listed}. Put a file `NAME.lrp` or `NAME.ipynb` for each student "
            "there, or a folder with one."
        )
    return [each._replace(as_given=_is(each.text, first)) for each in found]


def _is(text: str | None, first: str) -> bool:
    return text is not None and text.split() in ([], first.split())


def _in_folder(folder: Path, task: Challenge) -> Iterator[Submission]:
    """Yield the submissions of a class: files of the folder, and a folder for each student."""
    for path in sorted(_visible(folder)):
        if path.is_dir():
            try:
                files = sorted(_programs(path))
            except OSError as error:
                yield Submission(_student(path.name), _shown(path), problem=str(unreadable(path, error)))
                continue
            if files:
                yield _read(_student(path.name), files, path, task)
        elif path.suffix in _SUFFIXES:
            yield _read(_student(path.stem), [path], path, task)


def _programs(folder: Path) -> Iterator[Path]:
    """Yield the programs of one student, those in inner folders included; links are not followed."""
    waiting = [folder]
    while waiting:
        for path in _visible(waiting.pop()):
            if path.is_dir():
                waiting.append(path)
            elif path.suffix in _SUFFIXES:
                yield path


def _visible(folder: Path) -> Iterator[Path]:
    for path in folder.iterdir():
        is_link = path.is_symlink() or getattr(path, "is_junction", bool)()
        if not (path.name.startswith((".", "_")) or is_link):
            yield path


def _student(name: str) -> str:
    return printable(_MOODLE.sub("", name))


def _shown(path: Path) -> str:
    return printable(str(path))


def _read(student: str, files: Sequence[Path], place: Path, task: Challenge) -> Submission:
    """Return the submission that is in one of a student's files."""
    readings = {file: _reading(student, file, task) for file in files}
    if len(files) == 1:
        return readings[files[0]]
    readable = {file: each for file, each in readings.items() if each.text is not None}
    fitting = [each for file, each in readable.items() if _fits(file, task)] or list(readable.values())
    if len(fitting) == 1:
        return fitting[0]
    names = ", ".join(f"`{_shown(file.relative_to(place))}`" for file in files)
    if not fitting:
        problem = f"None of {names} can be read as a program for `{task.name}`. {readings[files[0]].problem}"
    else:
        problem = (
            f"There are several programs: {names}. Name the one to be graded `{_slug(task.name)}.lrp`, or "
            "remove the others."
        )
    return Submission(student, _shown(place), problem=problem)


def _fits(file: Path, task: Challenge) -> bool:
    """Return whether a file says by its name or its cells that it is for a challenge."""
    return _slug(_student(file.stem)) == _slug(task.name) or (
        file.suffix == ".ipynb"
        and any(_is_for(options, task) for programs in _cells_and_labs(file) for options, _ in programs)
    )


def _reading(student: str, file: Path, task: Challenge) -> Submission:
    try:
        text = read_submission(file, task)
        if len(text) > _LONGEST:
            raise FileError(f"`{shown(file)}` has more than {_LONGEST:,} characters. Let it be shorter.")
        return Submission(student, _shown(file), text)
    except LRPError as error:
        return Submission(student, _shown(file), problem=str(error))


def read_submission(file: Path, task: Challenge) -> str:
    """Return the program in a file: its text or, of a notebook, that of the ``%%lrp`` cell for a challenge.

    This is the last cell with the challenge as its option, or the last lab of the challenge in the output of
    another cell; or else the only ``%%lrp`` cell, or the only lab.

    Raises FileError: the file cannot be read, or it is not clear which cell is meant.
    """
    if file.suffix != ".ipynb":
        return read_text(file)
    found = _cells_and_labs(file)
    for programs in found:
        fitting = [text for options, text in programs if _is_for(options, task)]
        if fitting:
            return fitting[-1]
    for programs in found:
        if len(programs) == 1:
            return programs[0][1]
    cells, _ = found
    what = "no `%%lrp` cell" if not cells else f"{len(cells)} `%%lrp` cells, and none is for this challenge"
    raise FileError(
        f"`{shown(file)}` has {what}. Begin the cell to be graded with "
        f"`%%lrp {_slug(task.name)} --challenge {shlex.quote(task.name)}`."
    )


def _cells_and_labs(file: Path) -> tuple[list[_Found], list[_Found]]:
    """Return the programs in the ``%%lrp`` cells of a notebook, and those of labs saved in other outputs."""
    cells: list[_Found] = []
    labs: list[_Found] = []
    for source, outputs in _code_cells(file):
        head, _, text = source.lstrip().partition("\n")
        cell = _CELL.match(head)
        if cell is not None and text.strip():
            cells.append((_words(cell[1]), text))
        else:
            labs += _labs(outputs)
    return cells, labs


def _code_cells(file: Path) -> list[tuple[str, object]]:
    """Return the source and the outputs of each code cell of a notebook."""
    try:
        notebook: Any = json.loads(read_text(file))
        cells = [cell for cell in notebook["cells"] if cell.get("cell_type") == "code"]
        return [("".join(cell["source"]), cell.get("outputs")) for cell in cells]
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError) as error:
        raise FileError(
            f"`{shown(file)}` is not a notebook that can be read. Save it again in Jupyter."
        ) from error


def _labs(outputs: object) -> Iterator[_Found]:
    for output in outputs if isinstance(outputs, list) else ():
        try:
            about, text = dict(output["metadata"]["lrp_jupyter"]), "".join(output["data"]["text/plain"])
        except (TypeError, KeyError, ValueError):  # of another kind
            continue
        if text.strip():
            yield ["--challenge", str(about["challenge"])] if "challenge" in about else [], text


def _words(line: str) -> list[str]:
    try:
        return shlex.split(line)
    except ValueError:  # a quotation mark is not closed
        return line.split()


def _is_for(words: Sequence[str], task: Challenge) -> bool:
    """Return whether the options of a cell name a challenge."""
    for number, word in enumerate(words):
        key, equals, value = word.partition("=")
        if key == "--challenge":
            named = value if equals else next(iter(words[number + 1 :]), "")
            return _slug(PurePath(named).stem if named.endswith(".py") else named) == _slug(task.name)
    return False


def _slug(name: str) -> str:
    return re.sub(r"[\W_]+", "-", name.casefold()).strip("-")
