"""The random numbers of a program: Python's, or those of a separate generator in a fork or a replay."""

from __future__ import annotations

import builtins
from collections.abc import Mapping
from types import ModuleType
from typing import Any


def random_module(namespace: Mapping[str, Any]) -> ModuleType:
    """Return the module that `import random` gives to the blocks of a namespace."""
    own = namespace.get("__builtins__")
    find = own.get("__import__", __import__) if isinstance(own, dict) else builtins.__import__
    module: ModuleType = find("random")
    return module
