"""A class of fifty, as Moodle sends it: what students hand in, and how a teacher wants to get it back."""

from __future__ import annotations

import io
import json
import zipfile
from pathlib import Path

from grading.answers import ANSWERS

from lrp_jupyter.grading.challenges import challenge

NAMES = """
Ada Lovelace, Bob Kahn, Carla Öz, Dora Ünal, Eve O'Neil, Frida Kahlo, Gustav Groß, Hana Sato, Ida Rhodes,
Jan Tschichold, Kim Lee, Lea Roth, Mia Farrow, Nina Simone, Olaf Palme, Pia Müller, Quin Abadi, Rosa
Parks, Sam Ting, Tove Jansson, Uma Thurman, Vera Rubin, Wim Wenders, Xi Chen, Yara Shahidi, Zoë Kravitz,
Anna Seghers, Ben Okri, Cem Karaca, Dai Sijie, Elif Şafak, Fela Kuti, Gina Rowlands, Hugo Ball, Inge
Lehmann, Joan Miró, Karl Popper, Lise Meitner, Max Born, Noor Khan, Otto Hahn, Paul Klee, Quentin Blake,
Ruth Benedict, Sofia Gubaidulina, Tim Berners, Ute Lemper, Vida Ahmadi, Walt Disney, Yoko Ono
""".replace("\n", " ")
STUDENTS = [name.strip() for name in NAMES.split(",")]
FIRST, SECOND = "first move", "bump and turn"


def answers(task: str, kind: str) -> list[str]:
    """Return the solutions of a challenge, or wrong programs."""
    return [each.text for each in ANSWERS if (each.challenge, each.kind) == (task, kind)]


def headed(task: str, text: str) -> str:
    """Return a program whose heading names its challenge."""
    return f"; My program.\n; challenge: {task}\n{text}"


def notebook(programs: dict[str, str]) -> str:
    """Return a notebook with a cell for each challenge."""
    cells = [f"%%lrp mine --challenge {task.replace(' ', '-')}\n{text}" for task, text in programs.items()]
    code = [
        {"cell_type": "code", "source": cell.splitlines(True)} for cell in ("%load_ext lrp_jupyter", *cells)
    ]
    return json.dumps({"cells": code, "nbformat": 4, "nbformat_minor": 5, "metadata": {}})


def zipped(files: dict[str, str | bytes]) -> bytes:
    """Return a zip file."""
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return data.getvalue()


def disguised(text: str) -> str:
    """Return a program with other names, comments and layout."""
    for word, other in (
        ("rover", "auto"),
        ("driving", "los"),
        ("backing", "weg"),
        ("turning", "um"),
        ("bump", "b"),
    ):
        text = text.replace(f" {word}", f" {other}").replace(f"({word}", f"({other}")
    return "; all mine\n" + text.replace(")\n", ")   ; so\n\n")


def make(folder: Path) -> dict[str, str]:
    """Fill a folder with fifty entries, and return what is expected of each: a word, by the student."""
    (good, *_), (second, *_) = answers(FIRST, "solution"), answers(SECOND, "solution")
    weak, weak_second = answers(FIRST, "wrong"), answers(SECOND, "wrong")
    both = {FIRST: good, SECOND: second}
    given = {name: challenge(name).beginning for name in (FIRST, SECOND)}
    hang = good.replace("[robot.move(linear=0.2)]", "[[None for each in iter(int, 1)]]")
    crash = good.replace("[robot.move(linear=0.2)]", "[(lambda: __import__('os').abort())()]")
    first = headed(FIRST, good)
    kinds: list[tuple[str, dict[str, str | bytes]]] = [
        ("both", {"lesson.ipynb": notebook(both)}),
        ("both", {"first.lrp": first, "bump.lrp": headed(SECOND, second)}),
        ("both", {"all.zip": zipped({"a/first.lrp": first, "a/b/x.LRP": headed(SECOND, second)})}),
        ("both", {"first-move.lrp": good, "bump-and-turn.lrp": disguised(second)}),  # named by their files
        (
            "both",
            {
                "lesson.ipynb": notebook({FIRST: good, SECOND: given[SECOND]}),
                "bump.lrp": headed(SECOND, second),
            },
        ),
        ("first", {"mine.txt": first}),
        ("first", {"MINE.LRP": first}),
        ("first", {"mine.lrp.txt": first}),
        ("first", {"mine": first}),
        ("first", {"mine.lrp": first.encode("utf-16")}),
        ("first", {"mine.lrp": first.replace("\n", "\r")}),
        ("first", {"mine.lrp": first, "readme.txt": "I did it.", "picture.png": b"\x89PNG\r\n"}),
        ("guess", {"mine.lrp": headed(FIRST, "; für später\n" + good).encode("cp1252")}),
        ("guess", {"mine.lrp": first, "broken.lrp": b"\0\0\0"}),
        ("given", {"lesson.ipynb": notebook(given)}),
        ("given", {"lesson.ipynb": notebook({FIRST: given[FIRST]})}),
        ("weak", {"mine.lrp": headed(FIRST, weak[0])}),
        ("weak", {"mine.lrp": headed(FIRST, weak[1])}),
        ("weak", {"mine.lrp": headed(SECOND, weak_second[0])}),
        ("weak", {"mine.lrp": headed(SECOND, weak_second[1])}),
        ("text", {"mine.lrp": headed(FIRST, "(machine m (state a)")}),
        ("hang", {"mine.lrp": headed(FIRST, hang)}),
        ("crash", {"mine.lrp": headed(FIRST, crash)}),
        ("unread", {"mine.lrp": ""}),
        ("unread", {"mine.lrp": b"\0\1\2\3"}),
        ("unread", {"report.pdf": b"%PDF"}),
        ("unread", {"mine.docx": zipped({"word/document.xml": "<w/>"})}),
        ("unread", {"mine.rar": b"Rar!"}),
        ("unread", {"mine.zip": b"PK no"}),
        ("unread", {"mine.zip": zipped({})}),
        ("unread", {"lesson.ipynb": "{"}),
        ("unread", {"lesson.ipynb": notebook({})}),
        ("unread", {"mine.lrp": good}),  # for which challenge?
        ("unread", {"mine.lrp": headed("frist move", good)}),
        ("unread", {"a.lrp": headed(FIRST, good), "b.lrp": headed(FIRST, weak[0])}),
        ("unread", {}),
    ]
    kinds += [("weak", {"mine.lrp": headed(FIRST, text)}) for text in weak[2:5]]
    kinds += [("first", {"mine.lrp": f"{first}; {number}"}) for number in range(len(STUDENTS) - len(kinds))]
    for number, (student, (_, files)) in enumerate(zip(STUDENTS, kinds, strict=True)):
        place = folder / f"{student}_{1000 + number}_assignsubmission_file"
        place.mkdir()
        for name, content in files.items():
            (place / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    return {student: kind for student, (kind, _) in zip(STUDENTS, kinds, strict=True)}


def worksheet(separator: str = ",") -> str:
    """Return the table that Moodle wants back; two rows are of students who have handed in nothing."""
    comma = separator == ";"
    most = "100,00" if comma else "100.00"
    head = [
        "Identifier",
        "Full name",
        "Email address",
        "Status",
        "Grade",
        "Maximum Grade",
        "Grade can be changed",
        "Last modified (submission)",
        "Last modified (grade)",
        "Feedback comments",
    ]
    rows = [head]
    for number, student in enumerate([*STUDENTS, "Not There", "Else Where"]):
        mail = f"{number}@school.example"
        rows.append(
            [f"Participant {1000 + number}", student, mail, "Submitted", "", most, "Yes", "-", "-", ""]
        )
    return "\ufeff" + "\r\n".join(separator.join(f'"{cell}"' for cell in row) for row in rows) + "\r\n"


def canvas() -> str:
    """Return Canvas's gradebook, in which names are the other way round."""
    rows = ["Student,ID,SIS User ID,SIS Login ID,Section,First Move (77),Bump and Turn (78),Current Score"]
    rows.append("    Points Possible,,,,,5.00,10.00,(read only)")
    for number, student in enumerate(STUDENTS):
        first, _, last = student.partition(" ")
        rows.append(f'"{last}, {first}",{5000 + number},,{number},Robots,,,')
    return "\n".join(rows) + "\n"
