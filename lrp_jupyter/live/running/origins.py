"""Where a command or a request of the robot comes from, as the frames of the call say."""

from __future__ import annotations

import sys
from types import FrameType

from lrp_jupyter.bridges.guarding.safety import Origin
from lrp_jupyter.bridges.tasks import Asker
from lrp_jupyter.errors import BridgeError
from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.language.reading.tokens import ACTIONS


def origin_of(interpreter: Interpreter) -> Origin:
    """Return the calling block, if it belongs to the running program."""
    filename = interpreter.program.filename
    block: FrameType | None = sys._getframe(1)
    while block is not None and block.f_code.co_filename != filename:
        block = block.f_back
    if block is None:
        return Origin(interpreter.tick)
    return Origin(interpreter.tick, block.f_code.co_name, block.f_lineno, interpreter.acting[0])


def asker_of(interpreter: Interpreter) -> Asker:
    """Return the machine and the kind of the action that asks for a task; nothing, if a person does.

    Raises BridgeError: a block asks that is not an action.
    """
    filename, name = interpreter.program.filename, ""
    frame: FrameType | None = sys._getframe(1)
    while frame is not None:  # the outermost one is the block itself
        name = frame.f_code.co_name if frame.f_code.co_filename == filename else name
        frame = frame.f_back
    machine, action = interpreter.acting
    asks = name.rpartition(".")[2]
    if asks and asks not in ACTIONS:
        raise BridgeError("A task is asked for in an action, not in a test or an initial value.")
    return Asker(machine, action) if machine and asks == action else Asker()
