"""Departures from the paper are rows of a table: where, what, why."""

import re

from lrp_jupyter.language.deviations import DEVIATIONS


def test_every_departure_names_a_section_and_a_reason():
    for deviation in DEVIATIONS:
        assert re.fullmatch(r"§[3-7](\.\d)?", deviation.section)
        assert deviation.here.endswith(".")
        assert deviation.reason.endswith(".")


def test_departures_are_in_the_order_of_the_paper_and_once_each():
    sections = [deviation.section for deviation in DEVIATIONS]
    assert sections == sorted(sections)
    assert len({deviation.here for deviation in DEVIATIONS}) == len(DEVIATIONS)
