"""The texts that the bundled challenges begin with, one in each file ``NAME.lrp``."""

from importlib.resources import files

__all__ = ["starter"]


def starter(name: str) -> str:
    """Return the text that a bundled challenge begins with, without the comments at its top."""
    return (
        files(__name__).joinpath(f"{name.replace(',', '').replace(' ', '-')}.lrp").read_text(encoding="utf-8")
    )
