"""The README and the pages beside the notebooks are true: what they print, list, link to and let one type."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from support.tables import every

from lrp_jupyter import Session, check, programs
from lrp_jupyter.cli import app
from lrp_jupyter.sim.worlds import BUNDLED

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")
PAGES = [ROOT / "README.md", *sorted((ROOT / "notebooks").glob("*.md"))]


def blocks(text: str, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.DOTALL | re.MULTILINE)


# -- what it prints ------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_example_about_the_past_prints_what_it_says(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("mine.lrp").write_text(programs.load("follower"), encoding="utf-8")
    page = (ROOT / "notebooks" / "python.md").read_text(encoding="utf-8")
    (block,) = [each for each in blocks(page, "python") if "why_not" in each]
    names = {"Session": Session}
    exec(block, names)
    names["session"].close()
    printed = capsys.readouterr().out
    said = re.findall(r"(?:^# .*\n)+", block, re.MULTILINE)
    assert len(said) == 2
    for each in said:
        assert " ".join(re.sub(r"^# ", "", each, flags=re.MULTILINE).split()) in printed


# -- what it lets one type -----------------------------------------------------------------------


class Walk:
    """The first behaviour: its program, and what is typed into it, row by row."""

    def __init__(self) -> None:
        head, text = next(each for each in blocks(README, "lrp") if each.startswith("%%lrp")).split("\n", 1)
        self.text = text
        self.rows = re.findall(r"^\| (`.*`) \| ([A-Z].*) \|$", README, re.MULTILINE)[:5]
        self.session = Session(text, "sim", world=head.rpartition(" ")[2])

    def type(self) -> set[str]:
        """Type the next row; return the codes of the findings."""
        typed = re.findall(r"`([^`]+)`", self.rows.pop(0)[0])
        if len(typed) == 1:
            self.text = self.text.replace("\n\n", f"\n  {typed[0]}\n\n", 1)
        else:
            new, old = typed
            assert self.text.count(old) == 1
            self.text = self.text.replace(old, new)
        return {finding.code for finding in self.session.edit(self.text)}

    @property
    def pose(self) -> tuple[float, ...]:
        return tuple(self.session.bridge.simulation.robot.pose)


@pytest.mark.slow
def test_the_first_behaviour_does_what_the_table_says():
    walk = Walk()
    with walk.session as session:
        session.run(15)
        pushing = walk.pose
        assert session.bridge.robot.bumper.data
        assert walk.type() == {"LRP403"}
        session.run(2)
        assert walk.pose == pytest.approx(pushing, abs=0.01)
        assert walk.type() == {"LRP403", "LRP401"}
        session.run(2)
        assert walk.pose == pytest.approx(pushing, abs=0.01)
        assert not walk.type()
        session.run(8)
        assert ("rover", "turning") in session.frame.active
        assert walk.pose[2] > pushing[2] + 6
        assert not walk.type()
        session.run(90)
        assert session.frame.count_of("turning") > 4
        session.run(60, until="driving")
        session.run(0.5)
        assert not walk.type()
        before = walk.pose
        session.run(1)
        assert 0.05 < abs(complex(walk.pose[0] - before[0], walk.pose[1] - before[1])) < 0.12
        assert session.frame.restarts == 0
        assert "did not fire" in str(session.why_not("bump:driving->turning"))


def test_every_program_of_the_pages_is_without_findings():
    found = [block for page in PAGES for block in blocks(page.read_text(encoding="utf-8"), "lrp")]
    assert len(found) >= 2
    for block in found:
        assert not check(re.sub(r"^%%lrp.*\n", "", block))


# -- what it lists -------------------------------------------------------------------------------


def test_it_lists_every_member_of_the_simulated_robots():
    members = {}
    for world in BUNDLED:
        with Session("", "sim", world=world) as session:
            session.run(0)
            others = tuple(f"{name}." for name in session.bridge.world.robot_names[1:])
            members |= {
                each.name: each for each in session.bridge.members() if not each.name.startswith(others)
            }
    rows = [
        f"| `robot.{each.name}{each.signature}` | {each.doc}{f', in {each.unit}' if each.unit else ''} |"
        for each in members.values()
    ]
    assert len(rows) >= 10
    assert [row for row in rows if row not in README] == []
    assert len(re.findall(r"^\| `robot\.", README, re.MULTILINE)) == len(rows)


def test_the_page_of_the_command_line_lists_every_command():
    page = (ROOT / "notebooks" / "command-line.md").read_text(encoding="utf-8")
    for command in app.registered_commands:
        name = command.name or command.callback.__name__
        assert f"`lrp {name}" in page, name


def test_it_has_two_commands_that_create_an_environment():
    commands = re.findall(r"^python3 -m venv .*$", README, re.MULTILINE)
    assert [command.rpartition("/")[2] for command in commands] == ["lrp lab", "pytest"]


# -- what it links to ----------------------------------------------------------------------------


@every("page", PAGES)
def test_every_link_and_picture_leads_to_a_file(page: Path):
    text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)
    links = re.findall(r"\]\(([^)#\s]+)[^)]*\)", text)
    missing = [link for link in links if "://" not in link and not (page.parent / link).exists()]
    assert not missing
