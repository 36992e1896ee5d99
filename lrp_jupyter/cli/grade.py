"""``lrp grade``: judge a program by a challenge."""

from __future__ import annotations

from rich.text import Text

from lrp_jupyter.cli.excerpt import plain_console
from lrp_jupyter.cli.source import read_source
from lrp_jupyter.grading.challenges import challenge
from lrp_jupyter.grading.grade import grade

__all__ = ["grade_file"]


def grade_file(file: str, name: str, seeds: int) -> int:
    """Run a file in every world of a challenge with so many seeds; return 1 if it does not pass."""
    task, source = challenge(name), read_source(file)
    result = grade(source.text, task, seeds)
    report = Text(f"{source.name}, {result}")
    report.highlight_regex(r"✓", "green")
    report.highlight_regex(r"✗", "bold red")
    report.highlight_regex(r"(?m)^Hint:", "bold yellow")
    plain_console().print(report)
    return int(not result.passed)
