"""The example of the README about the past runs as it is printed, and prints what its comments say."""

import re
from pathlib import Path

from lrp_jupyter import Session, programs

README = Path(__file__).parent.parent / "README.md"


def test_the_example_about_the_past_prints_what_it_says(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("mine.lrp").write_text(programs.load("follower"), encoding="utf-8")
    blocks = re.findall(
        r"^```python\n(.*?)^```", README.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE
    )
    (block,) = [each for each in blocks if "why_not" in each]
    names = {"Session": Session}
    exec(block, names)
    names["session"].close()
    printed = capsys.readouterr().out
    said = re.findall(r"(?:^# .*\n)+", block, re.MULTILINE)
    assert len(said) == 2
    for each in said:
        assert " ".join(re.sub(r"^# ", "", each, flags=re.MULTILINE).split()) in printed
