"""The commands in the pages: each is one that ``lrp`` has, with options that it has."""

import re
import shlex

import pytest
import typer
from stored import NOTEBOOKS
from support.tables import every

from lrp_jupyter.cli import app
from lrp_jupyter.language.parser import parse

PAGES = {
    path.relative_to(NOTEBOOKS): path.read_text(encoding="utf-8") for path in sorted(NOTEBOOKS.rglob("*.md"))
}
COMMANDS = [
    (str(name), line.partition(" #")[0].strip())
    for name, page in PAGES.items()
    for block in re.findall(r"^```sh\n(.*?)^```", page, re.M | re.S)
    for line in block.replace("\\\n", " ").split("\n")
    if line.startswith("lrp ") and "|" not in line and "$(" not in line
]


def parsed(line):
    group = typer.main.get_command(app)
    word, *rest = shlex.split(line.partition(" > ")[0])[1:]
    with typer.Context(group) as context:
        command = group.get_command(context, word)
        assert command is not None, f"there is no command {word}"
        return command.make_context(word, rest, parent=context)


@pytest.mark.slow
@every(("page", "line"), COMMANDS)
def test_a_command_of_a_page_can_be_typed(page, line):
    parsed(line)


def test_an_option_that_there_is_not_is_found():
    with pytest.raises(Exception, match="No such option"):
        parsed("lrp run follower --wrold line")


def test_many_pages_have_commands():
    assert len({page for page, _ in COMMANDS}) > 5


def test_the_program_of_the_plan_for_few_robots_is_valid():
    text = re.search(r"```lrp\n(.*?)```", PAGES[next(n for n in PAGES if n.stem == "few-robots")], re.S)[1]
    assert parse(text).machines[0].name == "stopper"
