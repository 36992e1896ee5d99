"""What every command refuses before it does anything: empty texts, numbers beyond all use, wrong suffixes."""

from __future__ import annotations

import pytest
import typer
from support.tables import every
from typer.main import get_command

from lrp_jupyter.cli import app

COMMANDS = get_command(app).commands
NEEDED = {
    "run": ["follower"],
    "why": ["run.lrplog", "a"],
    "replay": ["run.lrplog"],
    "looks": ["run.lrplog"],
    "repair": ["follower"],
    "sweep": ["follower"],
}


def options():
    """Every option that takes a value, by its command and name."""
    return [
        (name, option, parameter)
        for name, command in COMMANDS.items()
        for parameter in command.params
        for option in parameter.opts
        if option.startswith("-") and not parameter.is_flag
    ]


def unparsed(name, *arguments):
    """What is said of arguments that are refused before the command runs."""
    with pytest.raises(typer.BadParameter) as told:
        COMMANDS[name].make_context(name, [*arguments])
    assert told.value.exit_code == 2
    return told.value.format_message()


def refused(lrp, *arguments):
    """What is said of arguments that are refused, in one line."""
    done = lrp(*arguments)
    assert done.exit_code == 2
    return " ".join(done.stderr.replace("│", " ").split())


@pytest.mark.slow
def test_every_number_has_bounds_and_what_is_beyond_them_is_refused(lrp):
    numbers = [each for each in options() if each[2].type_descriptor.annotation in (int, float)]
    assert len(numbers) > 12
    for name, option, parameter in numbers:
        if option == "--seed":  # any whole number
            continue
        assert option == "--rate" or None not in (parameter.min, parameter.max), (name, option)
        for text in ("inf", "-inf", "nan", "-1", "1e400", "9" * 30, "", "x"):
            told = refused(lrp, name, *NEEDED.get(name, []), option, text)
            assert option in told


def test_no_command_takes_an_empty_text(lrp, here):
    for name, option, _ in options():
        for given in ([option, ""], [option, " \t"], *([[f"{option}="]] if option[1] == "-" else [])):
            assert f"{option} is empty." in unparsed(name, *given)
    arguments = [
        name for name, each in COMMANDS.items() if any(not p.opts[0].startswith("-") for p in each.params)
    ]
    assert len(arguments) > 8
    for name in arguments:
        assert "An argument is empty." in unparsed(name, "")
    assert "An argument is empty." in refused(lrp, "grade", "")
    assert not list(here.iterdir())


@every(
    ("arguments", "suffix"),
    [
        (["run", "follower", "--for", "0", "--animate", "a.png"], "`.svg`"),
        (["run", "follower", "--for", "0", "--animate", "a"], "`.svg`"),
        (["run", "follower", "--for", "0", "--record", "a.svg"], "`.lrplog` or `.lrplog.gz`"),
        (["run", "follower", "--for", "0", "--trace", "a.csv"], "`.jsonl`, `.jsonl.gz` or `.json`"),
        (["graph", "follower", "--format", "svg", "-o", "a.dot"], "`.svg` or `.txt`"),
        (["graph", "follower", "-o", "a.png"], "`a.svg`"),
        (["grade", "follower", "--challenge", "square", "--out", "a.png"], "`.json`, `.xml` or `.html`"),
        (["sweep", "follower", "--challenge", "square", "--set", "a=1", "--map", "a.png"], "`.svg`"),
        (["sweep", "follower", "--challenge", "square", "--set", "a=1", "--out", "a.xml"], "or `.json`"),
    ],
)  # fmt: skip
def test_no_file_has_the_suffix_of_another_format_than_its_own(lrp, here, arguments, suffix):
    told = refused(lrp, *arguments)
    assert suffix in told
    assert not list(here.iterdir())
