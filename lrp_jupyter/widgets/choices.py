"""What a person can choose from: bridges, worlds, programs of the package."""

from __future__ import annotations

from importlib import resources

from lrp_jupyter.bridges.discovery import find_bridges
from lrp_jupyter.sim.worlds import BUNDLED
from lrp_jupyter.widgets.protocol import ChoicesView

__all__ = ["choices", "program_names", "program_text"]


def program_names() -> list[str]:
    """Names of the bundled programs."""
    folder = resources.files("lrp_jupyter") / "programs"
    if not folder.is_dir():
        return []
    return sorted(file.name[: -len(".lrp")] for file in folder.iterdir() if file.name.endswith(".lrp"))


def program_text(name: str) -> str:
    """Give the text of a bundled program.

    Raises
    ------
    KeyError
        There is none of that name.
    """
    if name not in program_names():
        raise KeyError(name)
    return (resources.files("lrp_jupyter") / "programs" / f"{name}.lrp").read_text("utf-8")


def choices() -> ChoicesView:
    """List everything."""
    return {"bridges": list(find_bridges()), "worlds": list(BUNDLED), "programs": program_names()}
