"""An answer that is being written."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from lrp_jupyter.interpreter.tick_reasons import ReasonCode
from lrp_jupyter.live.reason import CommandCode, Reason, StateCode


@dataclass(slots=True)
class AnswerDraft:
    """An answer that is being written; its most relevant line comes first, and 0 stands for none."""

    facts: dict[str, Any] = field(default_factory=dict)
    sentences: list[str] = field(default_factory=list)
    lines: list[int] = field(default_factory=list)

    def say(self, sentence: str, *lines: int) -> None:
        """Add a sentence and the lines that it mentions."""
        self.sentences.append(sentence)
        self.lines += lines

    def reason(self, code: ReasonCode | StateCode | CommandCode, tick: int, time: float) -> Reason:
        """Return the finished answer."""
        lines = tuple(dict.fromkeys(line for line in self.lines if line))
        facts = {**self.facts, "lines": lines}
        return Reason(code, tick, time, lines[0] if lines else 0, " ".join(self.sentences), facts)
