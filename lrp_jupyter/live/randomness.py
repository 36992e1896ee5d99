"""The random numbers of a program: those of Python, or of a generator of its own in a fork or a replay."""

from __future__ import annotations

import builtins
from collections.abc import Mapping
from types import ModuleType
from typing import Any


def random_module(namespace: Mapping[str, Any]) -> ModuleType:
    """Return what `import random` gives to the blocks of a namespace."""
    own = namespace.get("__builtins__")
    find = own.get("__import__", __import__) if isinstance(own, dict) else builtins.__import__
    module: ModuleType = find("random")
    return module
