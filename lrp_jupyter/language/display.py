"""What a notebook shows of a program: whatever a higher layer has registered."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar


class Displayed:
    """Base class of the elements that a notebook shows."""

    renderer: ClassVar[Callable[[Any], dict[str, str]]]
    """Returns the representations of an element, by media type; `lrp_jupyter.graph` registers it."""

    def _repr_mimebundle_(self, include: object = None, exclude: object = None) -> dict[str, str]:
        return Displayed.renderer(self)
