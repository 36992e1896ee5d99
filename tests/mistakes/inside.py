"""Typical mistakes inside blocks."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from typing import NamedTuple

from lrp_jupyter import programs
from lrp_jupyter.language.blocks.names_in_blocks import Offsets
from lrp_jupyter.language.python.block_suite import parse_suite
from lrp_jupyter.language.python.scanner import strings

from .planting import Slip, kind, slip
from .sources import Source

ACTIONS = ("onentry", "running", "onexit", "onpause", "onresume", "onend")
CONDITIONS = ("event", "on", "exit")


class Place(NamedTuple):
    """A match in the code of a block, outside of strings and comments."""

    start: int
    end: int
    match: re.Match[str]
    block: tuple[int, int]


def blocks(source: Source, *keywords: str) -> Iterator[tuple[int, int]]:
    """The content of the blocks of some forms, of all without a keyword."""
    for form in source.forms:
        if not keywords or form.keyword in keywords:
            for _, start, end in form.of("BLOCK"):
                yield start + 1, end - 1


def places(source: Source, pattern: str, *keywords: str) -> Iterator[Place]:
    """The matches of a pattern in the code of blocks."""
    for start, end in blocks(source, *keywords):
        text = source.text[start:end]
        hidden = strings(text)
        hidden += [(match.start(), match.end()) for match in re.finditer(r"#[^\r\n]*", text)]
        for match in re.finditer(pattern, text, re.MULTILINE):
            if not any(first <= match.start() < last for first, last in hidden):
                yield Place(start + match.start(), start + match.end(), match, (start, end))


def words(name: str, pattern: str, new: str, *keywords: str) -> None:
    """Register a kind that replaces each match of a pattern by a template."""

    @kind(f"inside: {name}")
    def _(source: Source) -> Iterator[Slip]:
        for found in places(source, pattern, *keywords):
            yield slip(found.start, found.end, found.match.expand(new))


# Signs and words of other languages


@kind("inside: `:=` for `=`")
def _(source: Source) -> Iterator[Slip]:
    for found in places(source, r"(?:^|; *|\A) *\b\w+ (=)(?!=)", *ACTIONS):
        yield slip(found.end - 1, found.end, ":=")


@kind("inside: `true` for `True`")
def _(source: Source) -> Iterator[Slip]:
    for found in places(source, r"\b(True|False)\b"):
        yield slip(found.start, found.end, found.match[0].lower())


words("`&&` for `and`", r"\band\b", "&&")
words("`&&` for `and`, without blanks", r" and ", "&&")
words("`||` for `or`", r"\bor\b", "||")
words("`!` for `not`", r"\bnot (?!in)", "!")
words("`<>` for `!=`", r"!=", "<>")
words("`=>` for `>=`", r">=", "=>")
words("`=<` for `<=`", r"<=", "=<")
words("`===` for `==`", r"(?<!=)==(?!=)", "===")
words("`> =` for `>=`", r"(>|<|!|=)=", r"\1 =")
words("`≤` for `<=`", r"<=", "≤")
words("`≥` for `>=`", r">=", "≥")
words("`≠` for `!=`", r"!=", "≠")
words("`++` for `+= 1`", r" \+= 1\b", "++", *ACTIONS)
words("`AND` for `and`", r"\band\b", "AND")
words("`−` for `-`", r"(?<=[=(,] |.[=(,])-(?=[\w.])", "−")
words("`->` for `.`", r"\b(robot)\.", r"\1->")
words("`then` for `:`", r"\b(if|while) ([^:\n]*[^: \n]):(?= *\S)(?![^\n]*:)", r"\1 \2 then", *ACTIONS)
words("`else if` for `elif`", r"\belif\b", "else if")
words("`else if` for `elif`, in place of `elseif`", r"\belif\b", "elseif")
words("`if … {`", r"^( *)(if|while|for) ([^:\n]*):(?= *$)", r"\1\2 \3 {", *ACTIONS)
words("`var` before an assignment", r"^( *)(\w+ = )", r"\1var \2", *ACTIONS)
words("`function` for `def`", r"\bdef\b", "function")
words("decimal comma", r"\b(\d)\.(\d+)\b", r"\1,\2", "running", "onentry")

# Keywords misspelt


def misspelt(word: str) -> list[str]:
    """A word with a letter doubled, two swapped, and with a capital."""
    found = [word.capitalize()]
    for at in range(len(word) - 1):
        found.append(word[:at] + word[at + 1] + word[at] + word[at + 2 :])
    found += [word[: at + 1] + word[at:] for at in range(len(word))] if len(word) > 3 else []
    return [each for each in found if each != word]


@kind("inside: keyword misspelt")
def _(source: Source) -> Iterator[Slip]:
    for found in places(
        source, r"\b(if|elif|else|while|for|in|def|return|import|from|and|or|not|class|with|lambda)\b"
    ):
        for word in misspelt(found.match[0]):
            yield slip(found.start, found.end, word)


# Brackets, quotes, colons


@kind("inside: missing `)`")
def _(source: Source) -> Iterator[Slip]:
    for found in places(source, r"\)"):
        yield slip(found.start, found.end, "")


@kind("inside: missing `(`")
def _(source: Source) -> Iterator[Slip]:
    for found in places(source, r"(?<=\w)\("):
        yield slip(found.start, found.end, " " if source.text[found.end] != ")" else "")


@kind("inside: missing `]`")
def _(source: Source) -> Iterator[Slip]:
    for found in places(source, r"\]"):
        yield slip(found.start, found.end, "")


@kind("inside: `)` too many")
def _(source: Source) -> Iterator[Slip]:
    for found in places(source, r"\)"):
        yield slip(found.end, found.end, ")")


words("missing colon", r"\b(if|elif|while|for|def|else)(\b[^:\n\[{]*):(?= *$)", r"\1\2")
words("missing colon in one line", r"^( *(?:if|while|for|def|else)\b[^:\n\[{]*):(?= *[^\s#])", r"\1")
words("`;` for the colon", r"\b(if|elif|while|for|def|else)(\b[^:\n\[{]*):(?= *$)", r"\1\2;")


@kind("inside: missing second quote")
def _(source: Source) -> Iterator[Slip]:
    for start, end in blocks(source):
        for first, last in strings(source.text[start:end]):
            if (
                source.text[start + first] in "'\""
                and last - first < 40
                and "\n" not in source.text[start + first : start + last]
            ):
                yield slip(start + last - 1, start + last, "")


@kind("inside: missing first quote")
def _(source: Source) -> Iterator[Slip]:
    for start, end in blocks(source):
        for first, last in strings(source.text[start:end]):
            text = source.text[start + first : start + last]
            if re.fullmatch(r"(['\"])[\w ]+\1", text):
                yield slip(start + first, start + first + 1, "")


@kind("inside: typographic quotes")
def _(source: Source) -> Iterator[Slip]:
    for start, end in blocks(source):
        for first, last in strings(source.text[start:end]):
            text = source.text[start + first : start + last]
            if re.fullmatch(r'"[^"\\[\]]*"', text):
                yield Slip(((start + first, start + first + 1, "“"), (start + last - 1, start + last, "”")))


# Calls and arguments

words("`print x`", r"\bprint\(([^()\n]*)\)(?= *(?:$|\Z|;))", r"print \1", *ACTIONS)
words("call without parentheses", r"\b(robot\.\w+)\(([^()\n]+)\)(?= *(?:$|\Z|;))", r"\1 \2", *ACTIONS)
words("missing parentheses of a call", r"\b(robot\.\w+)\(\)(?= *(?:$|\Z|;))", r"\1", *ACTIONS)
words("`:` for `=` of an argument", r"\b(linear|angular)=", r"\1: ", *ACTIONS)
words("missing comma", r"\b(robot\.\w+\([^(),\n]*),", r"\1", *ACTIONS)
words("blank for the point", r"\brobot\.(?=\w+\.)", "robot ")

# Comparisons

words("`=` for `==` in an `if`", r"\b((?:if|while) [^=\n:!<>]*)==", r"\1=")
words("`=` for `==` in a condition", r"(?<!=)==(?!=)", "=", *CONDITIONS)
words("`x not == y`", r"\b(\S+) != ", r"\1 not == ")
words("`x is == y`", r"(?<=[\w)]) == ", " is == ")

# Indentation


@kind("inside: line indented too far")
def _(source: Source) -> Iterator[Slip]:
    for found in places(source, r"^ +(?=[a-z])(?!elif|else|except|finally)", *ACTIONS, "var"):
        above = source.text[: found.start].rstrip().rpartition("\n")[2].rstrip()
        margin = len(above) - len(above.lstrip())
        if (
            margin <= len(found.match[0])
            and not above.endswith((":", ",", "(", "["))
            and _is_start(source, found)
        ):
            yield slip(found.start, found.end, found.match[0] + "  ")


@kind("inside: body not indented")
def _(source: Source) -> Iterator[Slip]:
    for found in places(source, r"(?<=:\n)( +)(?=[a-z])", *ACTIONS, "var"):
        head = source.text[: found.start - 1].rpartition("\n")[2]
        width = len(head) - len(head.lstrip())
        if found.block[0] <= found.start - 1 - len(head) and width < len(found.match[0]):
            yield slip(found.start, found.end, " " * width)


@kind("inside: tab for blanks")
def _(source: Source) -> Iterator[Slip]:
    for found in places(source, r"^ +(?=[a-z])", *ACTIONS, "var"):
        if _is_start(source, found):
            yield slip(found.start, found.end, "\t")


def _is_start(source: Source, found: Place) -> bool:
    """Whether a statement begins there, and not the first one of its block."""
    start, end = found.block
    if not source.text[start : found.start].strip():
        return False
    tree, suite = parse_suite(source.text[start:end])
    offsets = Offsets(suite.source(source.text[start:end]))
    starts = {offsets.start_of(node) + suite.shift for node in ast.walk(tree) if isinstance(node, ast.stmt)}
    return found.end - start in starts


# The robot, in programs that name a world


def in_worlds(name: str, pattern: str, new: str, *keywords: str) -> None:
    """Register a kind as `words` does, for programs whose robot is known."""

    @kind(f"robot: {name}")
    def _(source: Source) -> Iterator[Slip]:
        if programs.heading(source.text).world not in (None, "none"):
            for found in places(source, pattern, *keywords):
                yield slip(found.start, found.end, found.match.expand(new))


in_worlds("member misspelt, letters swapped", r"\brobot\.(\w)(\w)(\w)(?=\w)", r"robot.\1\3\2")
in_worlds("member misspelt, a letter twice", r"\brobot\.(\w)(\w)(?=\w)", r"robot.\1\2\2")
in_worlds("member with a capital", r"\brobot\.l", "robot.L")
in_worlds("field misspelt", r"\b(robot\.\w+)\.data", r"\1.dta")
in_worlds("without `.data`, compared", r"\b(robot\.\w+)\.data (?=[<>=!])", r"\1 ")
in_worlds("without `.data`, computed", r"\b(robot\.\w+)\.data(?=\))(?=[^\n]* [<>])", r"\1")
in_worlds("argument misspelt", r"\blinear=", "lienar=")
in_worlds("arguments without names", r"\brobot\.move\(linear=(?=[-\d])", "robot.move(")
in_worlds("`:=` for `=` of an argument", r"\b(linear|angular)=(?=[-\d.])", r"\1 := ")
in_worlds("number in quotes, compared", r"(\.data [<>]=? )(\d+(?:\.\d+)?)", r'\1"\2"')
in_worlds("number in quotes, passed", r"\b(linear|angular)=(\d+(?:\.\d+)?)", r'\1="\2"')
in_worlds("sensor called", r"\b(robot\.\w+\.data)\b", r"\1()")
in_worlds("sensor called instead of read", r"\b(robot\.\w+)\.data\b", r"\1()")
in_worlds("missing parentheses of a call", r"\b(robot\.\w+)\(\)(?= *(?:$|\Z|;))", r"\1", *ACTIONS)
in_worlds("argument too many", r"\brobot\.stop\(\)", "robot.stop(1)")

# Python that is valid

words("`nonlocal` missing", r"^( *)nonlocal [^\n]*\n", "", "var", *ACTIONS)
words("`==` for `=`", r"^( *\w+) = (?=[\w.-]+$)", r"\1 == ", *ACTIONS)
words("`=+` for `+=`", r" \+= ", " =+ ", *ACTIONS)
words("`is` for `==`", r" == (?=\d|['\"])", " is ")


@kind("inside: variable misspelt where it is set")
def _(source: Source) -> Iterator[Slip]:
    names = {source.word(form.tokens[1]) for form in source.all("var")}
    for found in places(source, r"(?:^|; |(?<=\[))( *)(\w{4,})(?= = )", *ACTIONS):
        name = found.match[2]
        if name in names and len(re.findall(rf"\b{name}\b", source.text[slice(*found.block)])) == 1:
            yield slip(
                found.start + found.match.start(2) - found.match.start(),
                found.end,
                name[0] + name[2] + name[1] + name[3:],
            )


# Smalltalk, as in the paper

SIMPLE = r"-?[\d.]+|[a-z]\w*"


def _smalltalk(name: str, pattern: str, new: str, *keywords: str) -> None:
    """Register a kind that writes whole blocks in Smalltalk."""

    @kind(f"inside: {name}")
    def _(source: Source) -> Iterator[Slip]:
        for start, end in blocks(source, *keywords):
            if found := re.fullmatch(pattern, source.text[start:end]):
                yield slip(start, end, found.expand(new))


_smalltalk(
    "Smalltalk, a command",
    rf"robot\.move\(linear=({SIMPLE})\)",
    r"robot move: [:msg | msg linear x: \1]",
    *ACTIONS,
)
_smalltalk(
    "Smalltalk, two commands in one",
    rf"robot\.move\(linear=({SIMPLE}), angular=({SIMPLE})\)",
    r"robot move: [:msg | msg linear x: \1. msg angular z: \2]",
    *ACTIONS,
)
_smalltalk(
    "Smalltalk, a reading",
    rf"robot\.(\w+)\.(\w+) ([<>]) ({SIMPLE})( [+-] \d+)?",
    r"robot \1 \2 \3 \4\5",
    *CONDITIONS,
)
_smalltalk(
    "Smalltalk, `&` and `not`",
    r"robot\.(\w+)\.(\w+) == (\d+) and not ([a-z]\w*)",
    r"robot \1 \2 == \3 & \4 not",
    *CONDITIONS,
)
