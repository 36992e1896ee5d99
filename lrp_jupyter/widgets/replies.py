"""What is owed to a page: the one answer to each command and request."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from concurrent.futures import Future
from dataclasses import dataclass, field
from typing import Any

from lrp_jupyter.errors import LRPError

__all__ = ["Reply"]


@dataclass(eq=False)
class Reply:
    """A command or request that is not answered yet.

    Parameters
    ----------
    view : str
        Who asked.
    id : int
    answer : Future
    deadline : float
        When it is answered with what holds it up.
    tell : callable
        Makes the reply's fields of the result.
    """

    view: str
    id: int
    answer: Future[Any]
    deadline: float
    tell: Callable[[Any], Mapping[str, Any]] = field(default=lambda _: {})

    def outcome(self) -> tuple[str | None, Mapping[str, Any]]:
        """Give the error, a sentence or None, and the other fields."""
        if self.answer.cancelled():
            return "Something newer came in between.", {}
        error = self.answer.exception()
        if error is None:
            return None, self.tell(self.answer.result() or {})
        if isinstance(error, (LRPError, ValueError, OSError)) and str(error):
            return str(error), {}
        return f"{type(error).__name__}: {error}", {}
