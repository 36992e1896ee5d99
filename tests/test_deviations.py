"""Departures from the paper are named where they are made, and listed where they are read."""

import re
from pathlib import Path

import lrp_jupyter
from lrp_jupyter.language.deviations import DEVIATIONS

PACKAGE = Path(lrp_jupyter.__file__).parent
README = Path(__file__).parent.parent / "README.md"


def test_every_departure_in_the_code_is_listed():
    listed = {deviation.section for deviation in DEVIATIONS}
    for file in PACKAGE.rglob("*.py"):
        for section in re.findall(r"Deviation: (§[\d.]*\d)", file.read_text(encoding="utf-8")):
            assert section in listed, f"{file.name}: {section}"


def test_the_readme_lists_every_departure():
    text = README.read_text(encoding="utf-8")
    for deviation in DEVIATIONS:
        assert f"| {deviation.section} | {deviation.here} | {deviation.reason} |" in text
