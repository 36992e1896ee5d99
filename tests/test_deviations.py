"""Departures from the paper are listed; the documentation and the reference show that list."""

import re
from pathlib import Path

import lrp_jupyter
from lrp_jupyter.language.deviations import DEVIATIONS

PACKAGE = Path(lrp_jupyter.__file__).parent


def test_every_departure_in_the_code_is_listed():
    listed = {deviation.section for deviation in DEVIATIONS}
    for file in PACKAGE.rglob("*.py"):
        for section in re.findall(r"Deviation: (§[\d.]*\d)", file.read_text(encoding="utf-8")):
            assert section in listed, f"{file.name}: {section}"
