"""The programs that students hand in: in files ``*.lrp``, or in ``%%lrp`` cells of notebooks.

The lab writes its text into the cell when the notebook is saved. A lab without such a cell is saved with its
text in its output. A program says for which challenge it is by the option of its cell, by its heading, or by
the name of its file. The layouts of Moodle, Canvas and nbgrader are read as they are; so are links that
contain programs, and texts that were pasted into Moodle.
"""

from __future__ import annotations

import json
import re
import shlex
from collections.abc import Collection, Iterator, Sequence
from html.parser import HTMLParser
from pathlib import Path, PurePath
from typing import Any, NamedTuple

from lrp_jupyter.errors import FileError, LRPError, did_you_mean
from lrp_jupyter.files import guessed, shown
from lrp_jupyter.grading.challenges import Challenge, challenges
from lrp_jupyter.grading.class_folder import PAGES, Entry, HandedIn, entries_in
from lrp_jupyter.grading.handing_in import programs_in
from lrp_jupyter.programs import heading

_CELL = re.compile(r"\s*%%lrp\b(.*)")
_NAMELESS = "`{}` names no challenge. Write `; challenge: NAME` into its first line."
_LONGEST = 1_000_000  # characters of a program


class Submission(NamedTuple):
    """A program that was handed in.

    `student`: the name that Moodle or Canvas give, or that of the student's folder or file.
    `file`: its path; of several files among which none can be chosen, that of their folder. Of both, what a
        terminal obeys or no file can hold is shown by its number.
    `text`: None if it cannot be read.
    `problem`: why it cannot be read, a sentence.
    `as_given`: whether it is the text that was given out, apart from white space.
    `notes`: what is to be known of it, such as a guess, each a sentence.
    `entry`: the name of the file or folder in the folder of the class.
    `number`: by which Moodle or Canvas knows the student; may be empty.
    `challenge`: the name of the one that it is for; empty if it says none.
    `given`: the text that was given out.
    """

    student: str
    file: str
    text: str | None = None
    problem: str = ""
    as_given: bool = False
    notes: tuple[str, ...] = ()
    entry: str = ""
    number: str = ""
    challenge: str = ""
    given: str = ""


class _Program(NamedTuple):
    """A program that was found.

    `named`: the challenge that its cell or its heading names; may be empty.
    """

    named: str
    text: str


class _File(NamedTuple):
    """What is in a file.

    `name`: its path in the student's folder.
    `cells`: the program, or those in the ``%%lrp`` cells of a notebook.
    `labs`: those of labs that a notebook has saved in other outputs.
    `blank`: whether there are ``%%lrp`` cells without a program.
    """

    place: str
    name: str
    stem: str
    cells: tuple[_Program, ...]
    labs: tuple[_Program, ...] = ()
    blank: bool = False
    notes: tuple[str, ...] = ()

    @property
    def lacks(self) -> str:
        """Why it holds no program, a sentence; empty if it holds one."""
        if self.cells or self.labs:
            return ""
        if self.blank:
            return f"`{self.name}` has an empty `%%lrp` cell. Save the notebook again, with the lab open."
        return f"`{self.name}` has no `%%lrp` cell."

    def fits(self, task: Challenge) -> bool:
        """Return whether it says, by its name or its programs, that it is for a challenge."""
        return slug(self.stem) == slug(task.name) or any(
            _is_for(each, task) for each in (*self.cells, *self.labs)
        )


def find_submissions(
    paths: Sequence[str | Path],
    task: Challenge | None = None,
    given: Path | None = None,
    apart_from: Collection[Path] = (),
) -> list[Submission]:
    """Return the submissions in files, folders and zip files; one that cannot be read says why.

    `task`: the challenge, for which each entry has one submission; default: those that the programs name, of
        which an entry may have several.
    `given`: the file that was given out; default: the text with which a lab of the challenge begins.
    `apart_from`: files and folders that are not submissions.
    Raises FileError: a path does not exist, or there is nothing in any of them.
    """
    released = None if given is None else _read_path(given)
    found = []
    for path in map(Path, paths):
        for entry in entries_in(path, apart_from):
            handed_in = _of_entry(entry, released) if task is None else [_for(entry, task, released)]
            found += [
                each._replace(entry=entry.name, number=entry.number, student=entry.student)
                for each in handed_in
            ]
    if not found:
        listed = ", ".join(f"`{shown(path)}`" for path in paths)
        raise FileError(
            f"There is no submission in {listed}. Put a file `NAME.lrp` or `NAME.ipynb` for each student "
            "there, or a folder with one."
        )
    return found


def read_submission(path: Path, task: Challenge) -> str:
    """Return the program in a file: its text or, of a notebook, that of the ``%%lrp`` cell for a challenge.

    This is the last cell with the challenge as its option, or the last lab of the challenge in the output of
    another cell; or else the only ``%%lrp`` cell, or the only lab.

    Raises FileError: the file cannot be read, or it is not clear which cell is meant.
    """
    return _text_for(_read_path(path), task)


def slug(name: str) -> str:
    """Return a name as it is compared: in small letters, words joined by hyphens."""
    return re.sub(r"[\W_]+", "-", name.casefold()).strip("-")


# -- the programs of an entry ----------------------------------------------------------------------


def _for(entry: Entry, task: Challenge, released: _File | None) -> Submission:
    """Return the submission of an entry for a challenge."""
    files, problems = _read_all(entry)
    if not files:
        return _unread(entry, [*problems, *entry.problems], task.name)
    fitting = [each for each in files if each.fits(task)] or files
    return _chosen(entry, fitting, task, released, problems)


def _of_entry(entry: Entry, released: _File | None) -> Iterator[Submission]:
    """Yield the submissions of an entry: one for each challenge that its programs name."""
    files, problems = _read_all(entry)
    known = {slug(task.name): task for task in challenges()}
    named = [program.named for file in files for program in (*file.cells, *file.labs) if program.named]
    by_file = [file.stem for file in files if slug(file.stem) in known]
    tasks = {slug(name): known.get(slug(name)) for name in (*named, *by_file)}
    for key, task in tasks.items():
        if task is not None:
            fitting = [file for file in files if file.fits(task)]
            yield _chosen(entry, fitting, task, released, problems)
        else:
            name = next(each for each in named if slug(each) == key)
            hint = did_you_mean(key.replace("-", " "), (each.name for each in challenges()))
            problem = f"A program names the challenge `{name}`, which does not exist.{hint}"
            yield _unread(entry, [problem])
    if not tasks and files:
        yield _unread(entry, [*(file.lacks or _NAMELESS.format(file.name) for file in files), *problems])
    elif not tasks:
        yield _unread(entry, [*problems, *entry.problems])


def _read_all(entry: Entry) -> tuple[list[_File], list[str]]:
    """Return the programs and notebooks of an entry that can be read, and why others cannot."""
    files, problems = [], []
    for handed_in in entry.files:
        try:
            files.append(_read(handed_in))
        except LRPError as error:
            problems.append(str(error))
    return files, problems


def _unread(entry: Entry, problems: Sequence[str], name: str = "") -> Submission:
    shown_ones = " ".join(problems[:3]) + (f" And {len(problems) - 3} more." if len(problems) > 3 else "")
    return Submission(entry.student, entry.place, problem=shown_ones, challenge=name)


def _chosen(
    entry: Entry, files: Sequence[_File], task: Challenge, released: _File | None, unread: Sequence[str]
) -> Submission:
    """Return the submission for a challenge that is in one of several files.

    A text that was changed counts before one that is as given, and of equal texts the first one.

    `unread`: why other files cannot be read.
    """
    given = _given(released, task)
    found: dict[str, tuple[_File, str]] = {}
    problems = []
    for file in files:
        try:
            text = _text_for(file, task)
            found.setdefault("\n".join(text.split()), (file, text))
        except FileError as error:
            problems.append(str(error))
    if not found:
        return _unread(entry, [*problems, *unread], task.name)
    changed = [each for each in found.values() if not _is(each[1], given)] or list(found.values())
    named = [each for each in changed if slug(each[0].stem) == slug(task.name)]
    if len(named or changed) > 1:
        names = ", ".join(f"`{file.name}`" for file, _ in changed)
        problem = (
            f"There are several programs: {names}. Name the one to be graded `{slug(task.name)}.lrp`, or "
            "remove the others."
        )
        return _unread(entry, [problem], task.name)
    file, text = (named or changed)[0]
    notes = (*file.notes, *unread)
    found_one = Submission(entry.student, file.place, text, as_given=_is(text, given), notes=notes)
    return found_one._replace(challenge=task.name, given=given)


def _given(released: _File | None, task: Challenge) -> str:
    """Return what was given out for a challenge: in a file, or else what a lab of it begins with."""
    if released is None:
        return task.beginning
    try:
        return _text_for(released, task)
    except FileError:
        return task.beginning


def _is(text: str, given: str) -> bool:
    return text.split() == given.split()


# -- the programs of a file ------------------------------------------------------------------------


def _read_path(path: Path) -> _File:
    """Read a file that a person named.

    Raises FileError: it cannot be read.
    """
    files = [file for entry in entries_in(path) for file in entry.files]
    if len(files) != 1:
        raise FileError(f"`{shown(path)}` is neither a program nor a notebook. Name a single file.")
    return _read(files[0])


def _read(handed_in: HandedIn) -> _File:
    """Read a file.

    Raises FileError: it cannot be read, is empty or too long.
    """
    place, name = handed_in.place, handed_in.name
    text, guess = guessed(handed_in.contents(), f"`{name}`")
    notes = (guess,) if guess else ()
    if handed_in.suffix in PAGES:
        if "jp-Notebook" in text:
            raise FileError(
                f"`{name}` is a page made of a notebook. Hand in the notebook itself, `NAME.ipynb`."
            )
        text = _said(text)
    if handed_in.suffix == ".ipynb" or (text.lstrip().startswith("{") and '"cells"' in text):
        cells, labs, blank = _cells_and_labs(text, name)
        file = _File(place, name, handed_in.stem, cells, labs, blank, notes)
    elif not text.strip():
        raise FileError(f"`{name}` is empty. Open the program in the lab, save it again, and hand in that.")
    elif linked := _linked(handed_in, text):
        file = _File(place, name, handed_in.stem, linked, notes=notes)
    else:
        file = _File(
            place, name, handed_in.stem, (_Program(heading(text).challenge or "", text),), notes=notes
        )
    if any(len(each.text) > _LONGEST for each in (*file.cells, *file.labs)):
        raise FileError(f"`{name}` has more than {_LONGEST:,} characters. Let it be shorter.")
    return file


def _linked(handed_in: HandedIn, text: str) -> tuple[_Program, ...]:
    """Return the programs in the links of a file.

    Raises FileError: a link is damaged, or the links are those of several students.
    """
    links = [] if handed_in.suffix == ".lrp" else programs_in(text)
    if len({each.challenge for each in links}) < len({each.before for each in links}) == len(links):
        raise FileError(
            f"`{handed_in.name}` has the links of several students. Mark it alone, not in a folder with"
            " others."
        )
    return tuple(_Program(each.challenge or heading(each.text).challenge or "", each.text) for each in links)


class _Page(HTMLParser):
    """What a page says, and where its links lead, as text: Moodle's online texts are pages."""

    def __init__(self) -> None:
        super().__init__()
        self.said = self.links = ""

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self.links += "".join(f"\n{value}" for key, value in attributes if key == "href" and value)
        self.said += "\n" * (tag == "br")

    def handle_endtag(self, tag: str) -> None:
        self.said += "\n" * (tag in ("p", "div", "li", "pre"))

    def handle_data(self, data: str) -> None:
        self.said += data.replace("\xa0", " ")


_DECLARATION = re.compile("<[!?][^<>]*>")
_NO_TAG = re.compile("<(?!/?[a-zA-Z][^<>]*>)")


def _said(page: str) -> str:
    """Return what a page says, or where its links to programs lead.

    The parser gets whole tags only: with others it may fail, or take hours.
    """
    parser = _Page()
    first, *others = page.split("<!--")
    page = "".join([first, *(each.partition("-->")[2] for each in others)])
    parser.feed(_NO_TAG.sub("&lt;", _DECLARATION.sub("", page)))
    parser.close()
    return parser.links if programs_in(parser.links) else parser.said


def _text_for(file: _File, task: Challenge) -> str:
    """Return the program in a file that is for a challenge.

    Raises FileError: it is not clear which one is meant.
    """
    for programs in (file.cells, file.labs):
        fitting = [each.text for each in programs if _is_for(each, task)]
        if fitting:
            return fitting[-1]
    for programs in (file.cells, file.labs):
        if len(programs) == 1:
            return programs[0].text
    count = len(file.cells)
    what = file.lacks or f"`{file.name}` has {count} `%%lrp` cells, and none is for this challenge."
    raise FileError(
        f"{what} Begin the cell to be graded with "
        f"`%%lrp {slug(task.name)} --challenge {shlex.quote(task.name)}`."
    )


def _is_for(program: _Program, task: Challenge) -> bool:
    return slug(program.named) == slug(task.name)


def _cells_and_labs(text: str, name: str) -> tuple[tuple[_Program, ...], tuple[_Program, ...], bool]:
    """Return the programs in the ``%%lrp`` cells of a notebook, those in other outputs, and if any is blank.

    Raises FileError: the text is not a notebook.
    """
    cells: list[_Program] = []
    labs: list[_Program] = []
    blank = False
    for source, outputs in _code_cells(text, name):
        head, _, program = source.lstrip().partition("\n")
        cell = _CELL.match(head)
        if cell is not None and program.strip():
            cells.append(_Program(_option(_words(cell[1])) or heading(program).challenge or "", program))
        else:
            blank |= cell is not None
            labs += _labs(outputs)
    return tuple(cells), tuple(labs), blank


def _code_cells(text: str, name: str) -> list[tuple[str, object]]:
    """Return the source and the outputs of each code cell of a notebook."""
    try:
        notebook: Any = json.loads(text)
        cells = [cell for cell in notebook["cells"] if cell.get("cell_type") == "code"]
        return [("".join(cell["source"]), cell.get("outputs")) for cell in cells]
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError) as error:
        raise FileError(f"`{name}` is not a notebook that can be read. Save it again in Jupyter.") from error


def _labs(outputs: object) -> Iterator[_Program]:
    for output in outputs if isinstance(outputs, list) else ():
        try:
            about, text = dict(output["metadata"]["lrp_jupyter"]), "".join(output["data"]["text/plain"])
        except (TypeError, KeyError, ValueError):  # of another kind
            continue
        if text.strip():
            yield _Program(str(about.get("challenge", "")) or heading(text).challenge or "", text)


def _words(line: str) -> list[str]:
    try:
        return shlex.split(line)
    except ValueError:  # a quotation mark is not closed
        return line.split()


def _option(words: Sequence[str]) -> str:
    """Return the challenge that the options of a cell name; empty if they name none."""
    for number, word in enumerate(words):
        key, equals, value = word.partition("=")
        if key == "--challenge":
            named = value if equals else next(iter(words[number + 1 :]), "")
            return PurePath(named).stem if named.endswith(".py") else named
    return ""
