"""Static checks: every code has a program that shows it, and its repair shows nothing."""

from __future__ import annotations

import pytest

from lrp_jupyter.language.checks import CODES, check

EXAMPLES = [code for code in CODES.values() if code.example]


@pytest.mark.parametrize("code", EXAMPLES, ids=lambda code: code.code)
def test_an_example_has_its_code_and_no_other(code) -> None:
    findings = check(code.example)
    assert {finding.code for finding in findings} == {code.code}
    assert {finding.severity for finding in findings} == {code.severity}


@pytest.mark.parametrize("code", EXAMPLES, ids=lambda code: code.code)
def test_a_repaired_example_has_no_findings(code) -> None:
    assert check(code.repaired) == ()
