"""Every code that the package can bring is explained: by a text, by the smallest program, by a repair."""

from __future__ import annotations

import re
from pathlib import Path
from typing import get_args

import pytest
from support.tables import every
from typer.testing import CliRunner

import lrp_jupyter
from lrp_jupyter import Session, check
from lrp_jupyter.bridges.guarding.safety import NoticeKind
from lrp_jupyter.cli import app
from lrp_jupyter.codes import CODES, FINDINGS, Code, explain
from lrp_jupyter.errors import LRPError
from lrp_jupyter.interpreter.issues import ISSUE_CODES
from lrp_jupyter.interpreter.tick_reasons import ReasonCode
from lrp_jupyter.live.reason import CommandCode, StateCode
from lrp_jupyter.live.running import driver, monitor

PACKAGE = Path(lrp_jupyter.__file__).parent
NO_PROGRAM_BRINGS_IT = {"LRP699", "exit-3", "exit-4", "exit-5", "exit-130", "exit-154"}
ENOUGH_TO_CHECK = {code for code in FINDINGS if code[3] != "6"}


def produced() -> set[str]:
    """Every code that the source can bring."""
    sources = "".join(path.read_text(encoding="utf-8") for path in PACKAGE.rglob("*.py"))
    exits = re.search(r"\*\*Exit codes\*\*: (.*?)\"\"\"", sources, re.DOTALL)
    assert exits is not None
    return {
        *re.findall(r"\"(LRP\d{3})\"", sources),
        *(f"transition-{code}" for code in get_args(ReasonCode)),
        *(f"state-{code}" for code in get_args(StateCode)),
        *(f"command-{code}" for code in get_args(CommandCode)),
        *(f"notice-{kind.replace(' ', '-')}" for kind in get_args(NoticeKind)),
        *(f"exit-{number}" for number in re.findall(r"(?:^|; )(\d+) ", " ".join(exits[1].split()))),
    }


def test_every_code_has_a_text_and_every_text_has_a_code():
    assert len(produced()) > 100
    assert produced() == set(CODES)


@every("code", CODES.values())
def test_a_text_has_all_its_parts(code: Code):
    assert code.title[0].isupper() or code.title[0] == "`"
    assert code.title[-1] not in ".?:"
    assert re.fullmatch(r"(`|[A-Z]).*\.", code.explanation, re.DOTALL)
    assert re.fullmatch(r"[A-Z].*\.", code.remedy, re.DOTALL)
    assert bool(code.example or code.script) == (code.code not in NO_PROGRAM_BRINGS_IT)
    assert code.address.endswith(f"errors.html#{code.code}")
    prose = re.sub(r"`[^`]*`", "", code.explanation + code.remedy)
    assert not re.search(r"[*_\[\]]", prose), "the lab and the command line show only backticks as code"
    for other in re.findall(r"LRP\d+", code.explanation + code.remedy):
        assert other in CODES
    if code.code in FINDINGS and code.example:
        assert code.repaired
        assert code.repaired != code.example


# -- its program brings it -----------------------------------------------------------------------


@pytest.fixture
def impatient(monkeypatch: pytest.MonkeyPatch):
    for module in (driver, monitor):
        monkeypatch.setattr(module, "PATIENCE", 0.2)


def brought_by(script: str, text: str) -> set[str]:
    """Run a program, as its script says; return every code that appears."""
    names: dict[str, object] = {"text": text}
    exec(script or "from lrp_jupyter import Session\nsession = Session(text)\nsession.run(1)", names)
    codes = {finding.code for finding in names.get("findings", ())}
    session = names.get("session")
    if isinstance(session, Session):
        codes |= {issue.code for issue in session.frame.issues}
        codes |= {f"notice-{each.kind.replace(' ', '-')}" for each in session.bridge.safety.notices}
        session.close()
    if (reason := names.get("reason")) is not None:
        assert re.fullmatch(r"[`T].*\.", str(reason))
        assert all(line > 0 for line in reason.facts["lines"])
        codes |= {f"{asked}-{reason.code}" for asked in ("transition", "state", "command")}
    return codes


RUNNING = [
    code for code in CODES if code not in ENOUGH_TO_CHECK | NO_PROGRAM_BRINGS_IT and code[:4] != "exit"
]


@pytest.mark.slow
@every("code", RUNNING)
def test_its_program_brings_it(code: str, impatient: None):
    assert code in brought_by(CODES[code].script, CODES[code].example)


@every("code", [code for code in RUNNING if CODES[code].repaired])
def test_its_repaired_program_does_not_bring_it(code: str, impatient: None):
    assert code not in brought_by(CODES[code].script, CODES[code].repaired)


def test_the_codes_of_findings_are_brought_by_checks_or_runs():
    """`tests/language/test_checks.py` checks the examples of the others."""
    assert ENOUGH_TO_CHECK | {code for code in RUNNING if code in FINDINGS} == set(FINDINGS) - {"LRP699"}
    assert set(ISSUE_CODES.values()) <= set(RUNNING)
    assert all(CODES[code].example and not CODES[code].script for code in ENOUGH_TO_CHECK)
    assert check(CODES["LRP301"].example)[0].code == "LRP301"


# -- it is found ---------------------------------------------------------------------------------


@every(
    ("word", "found"),
    [
        ("LRP301", ["LRP301"]),
        ("lrp301", ["LRP301"]),
        ("301", ["LRP301"]),
        ("condition-false", ["transition-condition-false"]),
        ("command watchdog", ["command-watchdog", "notice-command-watchdog"]),
        ("fired", ["state-fired", "transition-fired"]),
        ("154", ["exit-154"]),
        ("0", ["exit-0"]),
    ],
)
def test_a_code_is_found_by_its_name_or_the_end_of_it(word: str, found: list[str]):
    assert [code.code for code in explain(word)] == found


@every(("word", "hint"), [("LPR301", " Did you mean `LRP301`?"), ("", ""), ("quince", ""), ("01", "")])
def test_a_wrong_code_is_a_sentence(word: str, hint: str):
    with pytest.raises(LRPError) as raised:
        explain(word)
    assert str(raised.value) == f"There is no code `{word}`.{hint} `lrp explain` lists the codes."


def test_only_findings_have_a_severity():
    assert FINDINGS["LRP301"].severity == "error"
    with pytest.raises(ValueError, match="`exit-2` is not the code of a finding"):
        _ = CODES["exit-2"].severity
    assert "exit-2" not in FINDINGS
    assert "LRP000" not in CODES


@pytest.mark.parametrize("code", [code for code in CODES if code[:4] == "exit" and CODES[code].script])
def test_its_command_ends_with_its_exit_code(code: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    Path("mine.lrp").write_text(CODES[code].example, encoding="utf-8")
    command, *arguments = CODES[code].script.split()
    assert command == "lrp"
    assert CliRunner().invoke(app, arguments).exit_code == int(code.removeprefix("exit-"))
