"""Live programming of robot behaviour: nested state machines that change while they run.

A program is text: :func:`parse` turns it into a :class:`Program`, and an :class:`Interpreter` runs it tick by
tick and can be patched between two ticks. A :class:`Session` adds time, a thread and a robot; a
:class:`Lab` is a session in a notebook cell, with an editor and a graph.

>>> from lrp_jupyter import Interpreter, parse
>>> program = parse("(machine m (state a) (state b) (ontime 100 a -> b)) (spawn m a)")
>>> i = Interpreter(program)
>>> for tick in range(3):
...     i.step(tick / 10)
>>> i.active
(('m', 'b'),)
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

import lrp_jupyter.graph  # noqa: F401  (registers the pictures of programs; loads them when one is shown)

if TYPE_CHECKING:
    from lrp_jupyter.bridges.bridge import Bridge as Bridge
    from lrp_jupyter.bridges.sim import SimBridge as SimBridge
    from lrp_jupyter.errors import BridgeError as BridgeError
    from lrp_jupyter.errors import LRPError as LRPError
    from lrp_jupyter.errors import LRPSyntaxError as LRPSyntaxError
    from lrp_jupyter.errors import NoDataYet as NoDataYet
    from lrp_jupyter.errors import SessionClosedError as SessionClosedError
    from lrp_jupyter.errors import UnknownElementError as UnknownElementError
    from lrp_jupyter.grading.grade import grade as grade
    from lrp_jupyter.grading.sweep import sweep as sweep
    from lrp_jupyter.graph.state_graph import state_graph as state_graph
    from lrp_jupyter.interpreter.interpreter import Interpreter as Interpreter
    from lrp_jupyter.interpreter.issues import Issue as Issue
    from lrp_jupyter.language.diff import diff as diff
    from lrp_jupyter.language.parser import parse as parse
    from lrp_jupyter.language.printer import to_source as to_source
    from lrp_jupyter.language.program import Machine as Machine
    from lrp_jupyter.language.program import Program as Program
    from lrp_jupyter.live.clock import VirtualClock as VirtualClock
    from lrp_jupyter.live.running.checking import check as check
    from lrp_jupyter.live.running.frame import Frame as Frame
    from lrp_jupyter.live.session import Session as Session
    from lrp_jupyter.repairs.repair import repair as repair
    from lrp_jupyter.runs.decide import decide as decide
    from lrp_jupyter.sim import World as World
    from lrp_jupyter.widgets.lab import Controls as Controls
    from lrp_jupyter.widgets.lab import Editor as Editor
    from lrp_jupyter.widgets.lab import Issues as Issues
    from lrp_jupyter.widgets.lab import Lab as Lab
    from lrp_jupyter.widgets.lab import SimView as SimView
    from lrp_jupyter.widgets.lab import StateGraph as StateGraph
    from lrp_jupyter.widgets.lab import Variables as Variables

__version__ = "0.1.0"

_HOMES = {
    "bridges.bridge": ("Bridge",),
    "bridges.sim": ("SimBridge",),
    "errors": (
        "BridgeError",
        "LRPError",
        "LRPSyntaxError",
        "NoDataYet",
        "SessionClosedError",
        "UnknownElementError",
    ),
    "interpreter.interpreter": ("Interpreter",),
    "interpreter.issues": ("Issue",),
    "language.diff": ("diff",),
    "language.parser": ("parse",),
    "language.printer": ("to_source",),
    "language.program": ("Machine", "Program"),
    "live.running.checking": ("check",),
    "repairs.repair": ("repair",),
    "live.clock": ("VirtualClock",),
    "grading.grade": ("grade",),
    "grading.sweep": ("sweep",),
    "live.running.frame": ("Frame",),
    "live.session": ("Session",),
    "runs.decide": ("decide",),
    "sim": ("World",),
    "graph.state_graph": ("state_graph",),
    "widgets.lab": ("Controls", "Editor", "Issues", "Lab", "SimView", "StateGraph", "Variables"),
}
_HOME = {name: home for home, names in _HOMES.items() for name in names}

__all__ = sorted(_HOME)


def __getattr__(name: str) -> Any:
    """Import a public name on first use, so that `import lrp_jupyter` stays fast."""
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def load_ipython_extension(shell: Any) -> None:
    """Register ``%lrp`` and ``%%lrp``; called by ``%load_ext lrp_jupyter``."""
    from lrp_jupyter.widgets.magics import LRPMagics, completions, open_body

    shell.register_magics(LRPMagics)
    shell.input_transformers_cleanup.append(open_body)
    shell.set_hook("complete_command", completions, re_key=r"%%?lrp\b")


def __dir__() -> list[str]:
    return sorted([*__all__, "__version__"])
