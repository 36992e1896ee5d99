"""Worksheets as a browser prints them."""

import re

from lrp_jupyter.cli.lab_command import shipped_notebooks
from lrp_jupyter.site.sheets import write_sheets


def test_every_sheet_is_a_pdf_of_a_few_pages(tmp_path):
    printed = write_sheets(shipped_notebooks(), tmp_path, is_pdf=True)
    assert len(printed) > 10
    for pdf in printed:
        content = pdf.read_bytes()
        assert content.startswith(b"%PDF")
        assert 1 < len(re.findall(rb"/Type\s*/Page\b", content)) <= 6, pdf.name
