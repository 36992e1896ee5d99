"""Paths as the page writes them."""

from __future__ import annotations

from lrp_jupyter.language.program import Path, path_text

__all__ = ["id_of", "path_of"]


def id_of(kind: str, path: Path) -> str:
    """Write an element's path as the page does: a transition's last name comes behind a colon."""
    return f"{path_text(path[:-1])}:{path[-1]}" if kind == "transition" else path_text(path)


def path_of(kind: str, text: str) -> Path:
    """Read an element's path as the page writes it."""
    if kind == "transition":
        machine, _, label = text.partition(":")
        return (*machine.split("/"), label)
    return tuple(text.split("/")) if text else ()
