"""What the commands print on a terminal: nothing of a stranger's commands it."""

import io
from pathlib import Path

import pytest

from lrp_jupyter.cli.console import Colours

EVIL = "\x1b[2J\x9b1A\x07\u202e"


@pytest.mark.slow
def test_nothing_of_a_stranger_commands_the_terminal(terminal, program, here):
    """The name of a file, a message, a line of a program, an argument, a usage error."""
    raises = f"(machine m (state a (onentry [raise ValueError('{EVIL}')]))) (spawn m a) ; {EVIL}"
    name = program(raises, f"x{EVIL}.lrp").name
    Path("other.lrp").write_text(raises.replace("(spawn", "(spown"))
    commands = [
        ("grade", name, "other.lrp", "--challenge", "first move", "--seeds", "1"),
        ("grade", name, "--challenge", "first move", "--seeds", "1"),
        ("grade", name, "--challenge", EVIL),
        ("grade", f"-{EVIL}"),
        ("check", name, "other.lrp", f"no{EVIL}.lrp"),
        ("run", name, "--for", "1", "--speed", "max"),
        ("run", name, "--bridge", EVIL),
        ("format", f"{EVIL}.lrp"),
        ("why", f"{EVIL}.lrplog", "a"),
    ]
    for command in commands:
        running = terminal(*command)
        assert running.end() in (0, 1, 2)
        for part in ("\x1b[2J", "\x9b", "\x07", "\u202e"):
            assert part not in running.text, (command, running.text)
        assert "<U+001B>" in running.text or "Usage" in running.text, (command, running.text)


def test_colours_and_line_ends_pass_and_nothing_else():
    stream = io.StringIO()
    colours = Colours(stream)
    colours.writelines(["\x1b[1;31ma\x1b[0m\r\n", "b\rc\t\x1b[1Ad\x1b]0;title\x07"])
    assert stream.getvalue() == ("\x1b[1;31ma\x1b[0m\r\nb<U+000D>c\t<U+001B>[1Ad<U+001B>]0;title<U+0007>")
