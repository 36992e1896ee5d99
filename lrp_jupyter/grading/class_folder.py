"""What a class has handed in, student by student: files and folders, and what is in zip files.

No entry of a folder is left out: one that cannot be read says why. A zip file is unpacked in memory only.
Links are not followed, and the files that operating systems add are not entries.
"""

from __future__ import annotations

import io
import re
import zipfile
import zlib
from collections.abc import Callable, Collection, Iterator
from functools import partial
from pathlib import Path, PurePosixPath
from typing import IO, NamedTuple

from lrp_jupyter.errors import FileError, ended, printable
from lrp_jupyter.files import guessed, open_regular, shown, unreadable, whole
from lrp_jupyter.grading.handing_in import names_in

PROGRAMS = (".lrp", ".ipynb")
"""What programs are saved as."""
_TEXTS = (".txt", ".text", ".json", ".url", ".html", ".htm", "")  # as which others save them, and links
PAGES = (".html", ".htm")
"""What Moodle saves texts as that were written there."""
_MOODLE = re.compile(r"(?s)(.+?)_(\d+)_assign(?:submission|feedback)_[a-z]+(?:_.*)?")
_CANVAS = re.compile(r"(?s)([^_]+)_(?:LATE_)?(\d+)_\d+_.+")
_ADDED = ("__MACOSX", "__pycache__", "Thumbs.db", "desktop.ini")
_DEEPEST = 4  # zip files in one another
_MOST = 500  # files of an entry
_MOST_ZIPPED = 2_000  # files of a zip file in it, whose list is read again for each file
_OTHERS = (".doc", ".docx", ".jpeg", ".jpg", ".md", ".odt", ".pdf", ".png", ".py", ".rtf")
_ARCHIVES = (".7z", ".bz2", ".gz", ".rar", ".tar", ".tgz", ".xz")
_BROKEN = (zipfile.BadZipFile, zlib.error, NotImplementedError, RuntimeError, EOFError, OSError, ValueError)


class HandedIn(NamedTuple):
    """A file that was handed in.

    `parts`: its path below the folder of the class, in zip files too.
    `place`: its whole path, as it is shown.
    `contents`: returns what is in it, or raises a FileError.
    `problem`: why there is nothing to read, a sentence.
    """

    parts: tuple[str, ...]
    place: str
    contents: Callable[[], bytes] = bytes
    problem: str = ""

    @property
    def name(self) -> str:
        """Its path in the student's folder, or its name, as it is shown."""
        return named(self.parts)

    @property
    def stem(self) -> str:
        """Its name, without the name of a student and without what says how it was saved."""
        return _stem(_student_in(self.parts[-1])[2])

    @property
    def suffix(self) -> str:
        """The end of its name, in small letters."""
        return PurePosixPath(self.parts[-1]).suffix.lower()


def named(parts: tuple[str, ...]) -> str:
    """Return a path as messages show it: in the student's folder, or the name of that."""
    return shown(PurePosixPath(*(parts[1:] or parts)))


class Entry(NamedTuple):
    """What one student has handed in.

    `name`: as it is in the folder of the class.
    `student`: the student's name.
    `number`: by which Moodle or Canvas knows the student; may be empty.
    `place`: where it is, as it is shown.
    `files`: those that may be programs.
    `problems`: why each of the others is none.
    """

    name: str
    student: str
    number: str
    place: str
    files: tuple[HandedIn, ...]
    problems: tuple[str, ...]


def entries_in(path: Path, apart_from: Collection[Path] = ()) -> list[Entry]:
    """Return the entries of a class: in a folder, a zip file or a list of links, or a file that is one.

    `apart_from`: files and folders that are none, such as those that the marks are written to.
    Raises FileError: the path does not exist, or the folder cannot be read.
    """
    if not path.exists():
        raise FileError(f"`{shown(path)}` is neither a file nor a folder.")
    if path.is_dir():
        found = list(_in_folder(path, frozenset(each.absolute() for each in apart_from)))
    elif path.suffix.lower() == ".zip":
        found = _without_wrapper(list(_in_zip(partial(open_regular, path), (), shown(path), 1)))
    else:
        found = _in_list(path) or [_on_disk(path, (path.name,))]
    grouped: dict[tuple[str, ...], list[HandedIn]] = {}
    for file in sorted(found, key=lambda each: each.parts):
        name, number, _ = _student_in(file.parts[0])
        grouped.setdefault((name, number) if number else (file.parts[0],), []).append(file)
    return [_entry(path, files) for files in grouped.values()]


def _entry(path: Path, files: list[HandedIn]) -> Entry:
    name = files[0].parts[0]
    student, number, _ = _student_in(name)
    alone = len(files) == 1
    place = files[0].place if alone else _shown(path / name)
    rest = [each for each in files[_MOST:] if not each.problem]
    readable = [each for each in files[:_MOST] if not each.problem]
    for suffixes in (PROGRAMS, _TEXTS):
        programs = tuple(each for each in readable if each.suffix in suffixes)
        if programs:
            break
    problems = [each.problem for each in files if each.problem]
    problems += [_not_a_program(each) for each in readable if each not in programs]
    if rest:
        problems.append(f"`{named((name,))}` has more than {_MOST} files. Keep those of the task.")
    is_folder = len(files[0].parts) > 1 and not name.lower().endswith(".zip")
    return Entry(
        printable(name), printable(student if is_folder else _stem(student)), number, place, programs,
        tuple(problems),
    )  # fmt: skip


def _not_a_program(file: HandedIn) -> str:
    if file.suffix in _ARCHIVES:
        return f"`{file.name}` is an archive that cannot be opened here. Unpack it, or pack it as `.zip`."
    return (
        f"`{file.name}` is not a program. Hand in the notebook, or the file that Save… in the menu More of "
        "the lab writes."
    )


def _student_in(name: str) -> tuple[str, str, str]:
    """Return the name and number of a student that Moodle or Canvas put into a name, and the rest of it."""
    if found := _MOODLE.fullmatch(name):
        return found[1], found[2], re.sub(r"(?s).*?_assign[a-z]+_[a-z]+_?", "", name, count=1)
    if found := _CANVAS.fullmatch(name):
        return found[1], found[2], re.sub(r"(?s)[^_]+_(?:LATE_)?\d+_\d+_", "", name, count=1)
    return name, "", name


def _stem(name: str) -> str:
    while PurePosixPath(name).suffix.lower() in (*PROGRAMS, *_TEXTS[:-1], *_OTHERS, *_ARCHIVES, ".zip"):
        name = PurePosixPath(name).stem
    return name


def _in_folder(folder: Path, apart_from: frozenset[Path]) -> Iterator[HandedIn]:
    """Yield the files in a folder, inner folders and zip files included.

    Raises FileError: the folder itself cannot be read.
    """
    waiting: list[tuple[Path, tuple[str, ...]]] = [(folder, ())]
    while waiting:
        inner, parts = waiting.pop()
        try:
            listed = [each for each in inner.iterdir() if not _is_added(each.name)]
            kinds = {path: _kind(path) for path in listed if path.absolute() not in apart_from}
        except OSError as error:
            if not parts:
                raise unreadable(inner, error) from error
            yield HandedIn(parts, _shown(inner), problem=str(unreadable(named(parts), error)))
            continue
        if not listed and parts:
            yield HandedIn(parts, _shown(inner), problem=f"`{named(parts)}` is an empty folder.")
        for path, kind in kinds.items():
            below = (*parts, path.name)
            if kind == "link":
                problem = f"`{named(below)}` is a link, which is not followed. Put the file itself there."
                yield HandedIn(below, _shown(path), problem=problem)
            elif kind == "folder":
                waiting.append((path, below))
            elif path.suffix.lower() == ".zip":
                yield from _in_zip(partial(open_regular, path), below, _shown(path), 1)
            else:
                yield _on_disk(path, below)


def _in_list(path: Path) -> list[HandedIn]:
    """Return the lines of a list of links, each as a file of its student; none if it is no such list."""
    if path.suffix.lower() not in _TEXTS or path.suffix.lower() in PAGES:
        return []
    try:
        text, _ = guessed(_on_disk(path, (path.name,)).contents(), shown(path))
    except FileError:
        return []
    found = []
    listed = zip(text.splitlines(), names_in(text), strict=False)
    for number, (line, (name, has_link)) in enumerate(listed, 1):
        parts = (printable(name)[:60] or f"line {number}", f"{number}.url")
        place = f"{_shown(path)}, line {number}"
        missing = f"Line {number} of `{shown(path.name)}` has no link that contains a program."
        problem = "" if has_link else missing
        if line.strip():
            found.append(HandedIn(parts, place, partial(bytes, line, "utf-8"), problem))
    return found


def _kind(path: Path) -> str:
    if path.is_symlink() or getattr(path, "is_junction", bool)():
        return "link"
    return "folder" if path.is_dir() else "file"


def _on_disk(path: Path, parts: tuple[str, ...]) -> HandedIn:
    def contents() -> bytes:
        try:
            with open_regular(path) as stream:
                return whole(stream)
        except (OSError, ValueError) as error:  # a ValueError: there is a null character in its name
            raise unreadable(named(parts), error) from error

    return HandedIn(parts, _shown(path), contents)


def _in_zip(
    opened: Callable[[], IO[bytes]], parts: tuple[str, ...], place: str, depth: int
) -> Iterator[HandedIn]:
    """Yield the files in a zip file, those in its folders and zip files included."""
    try:
        with opened() as stream, zipfile.ZipFile(stream) as archive:
            names = [each.filename for each in archive.infolist() if not each.is_dir()]
            if parts and len(names) > _MOST_ZIPPED:
                raise OSError(f"It has more than {_MOST_ZIPPED:,} files.")
    except _BROKEN as error:
        own = parts or (place,)
        yield HandedIn(own, place, problem=_cannot_be_unpacked(named(own), error))
        return
    is_empty = True
    for name in sorted(dict.fromkeys(names)):
        below = tuple(part for part in re.split(r"[/\\]", name) if part not in ("", ".", ".."))
        if not below or any(map(_is_added, below)):
            continue
        is_empty = False
        inner = f"{place}/{printable('/'.join(below))}"
        contents = _unpacking(opened, name, named((*parts, *below)))
        if below[-1].lower().endswith(".zip") and depth < _DEEPEST:
            try:
                data = contents()
            except FileError as error:
                yield HandedIn((*parts, *below), inner, problem=str(error))
                continue
            yield from _in_zip(partial(io.BytesIO, data), (*parts, *below), inner, depth + 1)
        else:
            yield HandedIn((*parts, *below), inner, contents)
    if is_empty:
        own = parts or (place,)
        yield HandedIn(own, place, problem=f"`{named(own)}` is an empty zip file.")


def _unpacking(opened: Callable[[], IO[bytes]], name: str, told: str) -> Callable[[], bytes]:
    def contents() -> bytes:
        try:
            with opened() as stream, zipfile.ZipFile(stream) as archive, archive.open(name) as file:
                return whole(file)
        except _BROKEN as error:
            raise FileError(_cannot_be_unpacked(told, error)) from error

    return contents


def _cannot_be_unpacked(place: str, error: Exception) -> str:
    reason = printable(str(error)) or "It is damaged"
    if isinstance(error, zipfile.BadZipFile | zlib.error | EOFError):
        reason = "It is damaged, or not a zip file"
    elif "password" in reason:
        reason = "It is encrypted"
    return f"`{place}` cannot be unpacked: {ended(reason)} Pack it again, or hand in the file itself."


def _without_wrapper(files: list[HandedIn]) -> list[HandedIn]:
    """Return the files of a zip file without the one folder that has them all, if there is one."""
    while len({each.parts[0] for each in files}) == 1 and all(len(each.parts) > 1 for each in files):
        if _student_in(files[0].parts[0])[1] or len(files) == 1:
            break
        files = [each._replace(parts=each.parts[1:]) for each in files]
    return files


def _is_added(name: str) -> bool:
    """Return whether an operating system or an editor has added a file, not a student."""
    return name.startswith((".", "~$")) or name in _ADDED


def _shown(path: Path) -> str:
    return printable(str(path))
