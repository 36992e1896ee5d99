"""What a command of the robot takes, while its arguments are written."""

from __future__ import annotations

import re
from typing import NamedTuple

from lrp_jupyter.editors.program_text import ProgramText
from lrp_jupyter.editors.word_context import context_at
from lrp_jupyter.errors import LRPError
from lrp_jupyter.language.robot_members import parameters_of

_NEAR = 500  # characters
_CALL = re.compile(r"\brobot\.([\w.]+)\(((?:[^()\[\]]|\([^()]*\)|\[[^\[\]]*\])*)\Z")


class CallSignature(NamedTuple):
    """A command with its parameters, of which one is being written; -1 if none is known."""

    label: str
    doc: str
    parameters: tuple[str, ...]
    active: int


def signature_at(text: ProgramText, offset: int) -> CallSignature | None:
    """Return the command in whose brackets an offset is."""
    call = _CALL.search(text.text, max(0, offset - _NEAR), offset)
    bridge = text.robot.read(text.text).bridge
    if call is None or bridge is None:
        return None
    if context_at(text.text, text.root, text.names, offset).wanted != "python":
        return None
    try:
        member = bridge.describe(call[1])
    except LRPError:
        return None
    if not member.signature:
        return None
    names = parameters_of(member.signature).names
    written = re.sub(r"\([^()]*\)|\[[^\[\]]*\]", "", call[2]).split(",")
    named = re.match(r"\s*(\w+)\s*=(?!=)", written[-1])
    active = names.index(named[1]) if named and named[1] in names else len(written) - 1 if not named else -1
    return CallSignature(f"robot.{call[1]}{member.signature}", member.doc, names, active)
