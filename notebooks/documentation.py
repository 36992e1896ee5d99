"""What the documentation shows of the package itself, and how programs are coloured: an extension of Sphinx.

What the package knows is not written twice: a page holds ``<!-- generated: NAME -->`` where the function of
that name below puts it.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from docutils import nodes

import lrp_jupyter
import lrp_jupyter.testing
from lrp_jupyter import Session
from lrp_jupyter.bridges.members import Member
from lrp_jupyter.codes import CODES, Code
from lrp_jupyter.grading.challenges import challenges_by_series
from lrp_jupyter.language.deviations import DEVIATIONS
from lrp_jupyter.sim.worlds import DESCRIPTIONS


def anchor(title: str) -> str:
    """Return the anchor of a heading, as Jupyter has it."""
    return re.sub(r"\s+", "-", title.strip())


# -- what the package knows ------------------------------------------------------------------------


def _cell(text: str) -> str:
    return text.replace("|", r"\|").replace("\n", " ")


def _table(columns: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    lines = [list(columns), ["---"] * len(list(columns)), *(map(_cell, row) for row in rows)]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


_FAMILIES = {
    "LRP1": "The text and its brackets",
    "LRP2": "Names",
    "LRP3": "References to what does not exist",
    "LRP4": "What is never reached or used",
    "LRP5": "Python in blocks",
    "LRP6": "A running program",
    "transition": "Why a transition did not fire",
    "state": "Why a state is active",
    "command": "Why the robot does this",
    "notice": "Notices of the robot's safety",
    "exit": "Exit codes of the command line",
}


def _linked(text: str) -> str:
    """Return Markdown in which a code leads to its place on the page."""
    return re.sub(r"`(LRP\d+)`", r'<a href="#\1"><code>\1</code></a>', text)


def _section(code: Code) -> str:
    parts = [f'<span id="{code.code}"></span>', f"### {code.code}: {code.title}", f"*{code.kind}*"]
    parts.append(_linked(code.explanation))
    if code.example:
        parts.append(f"```lrp\n{code.example}\n```")
    if code.script:
        parts.append(f"```{'sh' if code.script.startswith('lrp ') else 'python'}\n{code.script}\n```")
    parts.append(f"**What to do.** {_linked(code.remedy)}")
    if code.repaired:
        parts.append(f"```lrp\n{code.repaired}\n```")
    return "\n\n".join(parts)


def codes() -> str:
    """Return the explanations of all codes, by family."""
    families: dict[str, list[Code]] = {family: [] for family in _FAMILIES}
    for code in CODES.values():
        families[code.code[:4] if code.code.startswith("LRP") else code.code.partition("-")[0]].append(code)
    return "\n\n".join(
        "\n\n".join([f"## {_FAMILIES[family]}", *map(_section, each)]) for family, each in families.items()
    )


def members() -> str:
    """Return the members of the simulated robots, and the worlds in which only some have them."""
    found: dict[str, tuple[Member, list[str]]] = {}
    for world in DESCRIPTIONS:
        with Session("", "sim", world=world) as session:
            session.run(0)
            for member in session.bridge.members():
                found.setdefault(member.name, (member, []))[1].append(world)
    rows = []
    for member, homes in found.values():
        only = "" if len(homes) == len(DESCRIPTIONS) else f" (in the worlds {', '.join(homes)})"
        name = f"`robot.{member.name}{member.signature}`"
        rows.append((name, member.unit or member.type, f"{member.doc}{only}"))
    return _table(["member", "unit or type", "what it is"], rows)


def worlds() -> str:
    """Return the bundled worlds."""
    return _table(["world", "what it is"], ((f"`{name}`", about) for name, about in DESCRIPTIONS.items()))


def challenges() -> str:
    """Return the challenges, each series in a table of its own."""
    return "\n\n".join(
        _table(
            [series or "challenge", "what the robot has to do"],
            ((each.name, each.assignment) for each in members),
        )
        for series, members in challenges_by_series().items()
    )


def departures() -> str:
    """Return the departures from the paper."""
    return _table(["paper", "here", "why"], DEVIATIONS)


_PARTS = {
    "language": "Programs",
    "interpreter": "Running a program",
    "live": "Running a program",
    "widgets": "In a notebook",
    "graph": "State graphs",
    "sim": "The simulated world",
    "bridges": "Robots",
    "grading": "Grading",
    "runs": "Kept runs",
    "repairs": "The smallest change",
    "errors": "Errors",
}


def api() -> str:
    """Return the public names, each with its docstring, by the part of the package that they belong to."""
    parts: dict[str, list[str]] = defaultdict(list)
    for name in lrp_jupyter.__all__:
        public = getattr(lrp_jupyter, name)
        kind = "function"
        if isinstance(public, type):
            kind = "exception" if issubclass(public, Exception) else "class"
        members = "" if kind == "function" else "\n   :members:"
        if public is lrp_jupyter.Session:  # much of it is its base class, which no one else uses
            members += "\n   :inherited-members:"
        entry = f"```{{eval-rst}}\n.. auto{kind}:: lrp_jupyter.{name}{members}\n```"
        parts[_PARTS[public.__module__.split(".")[1]]].append(entry)
    for name in lrp_jupyter.testing.__all__:
        kind = "class" if isinstance(getattr(lrp_jupyter.testing, name), type) else "function"
        members = "\n   :members:" if kind == "class" else ""
        entry = f"```{{eval-rst}}\n.. auto{kind}:: lrp_jupyter.testing.{name}{members}\n```"
        parts["Tests"].append(entry)
    order = [*dict.fromkeys(_PARTS.values()), "Tests"]
    return "\n\n".join("\n\n".join([f"## {part}", *parts[part]]) for part in order if part in parts)


_GENERATED: dict[str, Callable[[], str]] = {
    each.__name__: each for each in (codes, members, worlds, challenges, departures, api)
}


def generate(app: Any, _name: str, source: list[str]) -> None:
    """Put into a page what the package knows, and list only folders that there are."""

    def listed(found: re.Match[str]) -> str:
        return found[0] if Path(app.srcdir, found[1]).is_dir() else ""

    text = re.sub(r"<!-- generated: (\w+) -->", lambda found: _GENERATED[found[1]](), source[0])
    source[0] = re.sub(r"^(\w+)/\*+\n", listed, text, flags=re.MULTILINE)


# -- programs in colour ----------------------------------------------------------------------------


def colour(_app: Any, doctree: nodes.document) -> None:
    """Say which language a cell is written in."""
    for block in doctree.findall(nodes.literal_block):
        if block.astext().startswith("%%lrp"):
            block["language"] = "lrp"
        elif block.get("language") == "python":
            block["language"] = "ipython3"


def setup(app: Any) -> None:
    """Register all this with Sphinx."""
    app.connect("source-read", generate)
    app.connect("doctree-read", colour)
