"""The variables of a running program as a mapping that can be assigned to."""

from __future__ import annotations

from collections.abc import Callable, Iterator, MutableMapping
from typing import Any

from lrp_jupyter.language.blocks.names_in_blocks import as_path
from lrp_jupyter.language.program import Path, path_text
from lrp_jupyter.live.running.frame import Frame


class LiveVariables(MutableMapping[Path, Any]):
    """The variables of a session: read from its newest frame, and assigned between two ticks.

    Keys are those of :class:`~lrp_jupyter.interpreter.by_path.ByPath`.
    """

    def __init__(self, frame: Callable[[], Frame], assign: Callable[[Path, object], object]) -> None:
        self._frame = frame
        self._assign = assign

    def __getitem__(self, name: str | Path) -> Any:
        return self._frame().values[name]

    def __setitem__(self, name: str | Path, value: object) -> None:
        self._assign(as_path(name), value)

    def __delitem__(self, name: str | Path) -> None:
        raise TypeError("A variable cannot be deleted here. Remove it from the program's text.")

    def __contains__(self, name: object) -> bool:
        return name in self._frame().values

    def __iter__(self) -> Iterator[Path]:
        return iter(self._frame().values)

    def __len__(self) -> int:
        return len(self._frame().values)

    def _ipython_key_completions_(self) -> list[str]:
        return self._frame().values._ipython_key_completions_()

    def __repr__(self) -> str:
        texts = self._frame().variables
        return "\n".join(f"{path_text(path)} = {text}" for path, text in texts.items()) or "(no variables)"
