"""Views of a program that need no browser: its state graph, layouts and still pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lrp_jupyter.language.display import Displayed

if TYPE_CHECKING:
    from lrp_jupyter.language.program import Machine, Program


def _render(subject: Program | Machine) -> dict[str, str]:
    from lrp_jupyter.graph.still import mimebundle  # only when one is shown

    return mimebundle(subject)


Displayed.renderer = _render
