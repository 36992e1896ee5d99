"""The glossary: thirty words, which the lessons use, and no second word for any of them."""

import re
from typing import NamedTuple

from stored import NOTEBOOKS
from support.tables import every

from lrp_jupyter.language.parser import parse
from lrp_jupyter.site.lessons import read_lessons

ENTRY = re.compile(r"^\*\*(.+?)\*\* \(\[(\d+)\]\((.+?)\)\): (.+?)(?: \*Elsewhere: (.+)\.\*)?$", re.M)


class Entry(NamedTuple):
    word: str
    number: str
    file: str
    meaning: str
    elsewhere: str | None


def prose(lesson):
    """The sentences of a lesson."""
    parts = (part for section in (lesson.opening, *lesson.sections) for part in section.parts)
    return "\n".join(part for part in parts if isinstance(part, str))


def without_code(text):
    return re.sub(r"^```.*?^```|`[^`]*`", " ", text, flags=re.M | re.S)


PAGE = (NOTEBOOKS / "glossary.md").read_text(encoding="utf-8")
ENTRIES = [Entry(*found) for found in ENTRY.findall(PAGE)]
LESSONS = {lesson.name: prose(lesson) for lesson in read_lessons(NOTEBOOKS)}


def uses(word, text):
    """Whether a text has a word, in any of its forms."""
    *first, last = word.split()
    stem = re.escape(last.removesuffix("e"))
    ending = r"(e|s|es|ed|d|ing|ings|ned|ning)?"
    begin = "".join(rf"{re.escape(each)}\s+" for each in first)
    return re.search(rf"\b{begin}{stem}{ending}\b", text, re.I) is not None


def test_thirty_words_have_an_entry_each():
    words = [entry.word for entry in ENTRIES]
    assert len(words) == len(set(words)) == PAGE.count("\n**") == 30


@every("entry", ENTRIES)
def test_a_word_is_used_in_the_lesson_that_its_entry_names(entry):
    name = entry.file.removesuffix(".ipynb")
    assert int(entry.number) == int(name[:2])
    assert uses(entry.word, LESSONS[name])


@every("entry", [entry for entry in ENTRIES if entry.elsewhere])
def test_no_lesson_has_a_second_word_for_the_same(entry):
    for other in entry.elsewhere.split(", "):
        assert [name for name, text in LESSONS.items() if uses(other, without_code(text))] == [], other


def test_the_glossary_is_listed_with_the_lessons_and_in_the_index():
    assert "\nglossary\n" in (NOTEBOOKS / "index.md").read_text(encoding="utf-8")
    assert "(glossary.md)" in (NOTEBOOKS / "lessons.md").read_text(encoding="utf-8")


def test_the_programs_in_the_glossary_are_programs():
    for form in re.findall(r"`(\((?:on|event|var|spawn)\b.*?\))`", PAGE):
        parse(f"(machine m {form} (state driving) (state stopped))" if form[1:3] != "sp" else form)
