"""Discovery of the available bridges, and the choice among them.

Packages offer bridges as entry points of the group ``lrp.bridges``; a class defined in a notebook
is there as soon as it is defined, and wins over a package's of the same name. A Python file that
defines one can be named in the place of a bridge: ``--bridge mine.py``. Listing them
imports nothing: a bridge's own libraries are loaded when it is opened.

Paper: §7.3 (the interpreter finds the subclass of the abstract bridge by reflection).
Deviation: §7.3 takes any subclass that it finds; here hardware is never chosen by itself: a person
names it. The default is a simulated robot, or none.
"""

from __future__ import annotations

import inspect
import os
import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from types import ModuleType
from typing import Any

from lrp_jupyter.bridges.bridge import Bridge, NullBridge
from lrp_jupyter.bridges.options import convert_options, refuse_options
from lrp_jupyter.errors import BridgeError, did_you_mean, lacks_simulator
from lrp_jupyter.files import run_python, shown

__all__ = ["GROUP", "Offer", "check_options", "choose_bridge", "find_bridges", "make_bridge", "open_bridge"]

GROUP = "lrp.bridges"


@dataclass(frozen=True, slots=True)
class Offer:
    """A bridge that can be chosen.

    `origin`: the name of the package that it comes from, or ``"defined here"``.
    """

    name: str
    origin: str
    source: EntryPoint | type[Bridge]

    def load(self) -> type[Bridge]:
        """Return the class.

        Raises BridgeError: it cannot be imported, or is not a usable bridge; other bridges are not affected.
        """
        if isinstance(self.source, type):
            return self.source
        try:
            bridge = self.source.load()
        except Exception as error:
            raise BridgeError(
                lacks_simulator(error)
                or f"The bridge `{self.name}` of the package {self.origin} cannot be loaded:"
                f" {type(error).__name__}: {error}"
            ) from error
        if not (isinstance(bridge, type) and issubclass(bridge, Bridge)):
            raise BridgeError(
                f"`{self.source.value}` of the package {self.origin} is not a subclass of Bridge."
            )
        return bridge


def find_bridges() -> Mapping[str, Offer]:
    """Return every bridge that can be chosen, by name; imports none of them."""
    found = {offer.name: offer for offer in _packaged(tuple(map(_version, sys.path)))}
    packaged = {offer.source.value for offer in found.values() if not isinstance(offer.source, type)}
    for name, bridge in Bridge.registry.items():
        if inspect.isabstract(bridge) or f"{bridge.__module__}:{bridge.__qualname__}" in packaged:
            continue
        found[name] = Offer(name, "defined here", bridge)
    return dict(sorted(found.items()))


@lru_cache(maxsize=1)
def _packaged(versions: tuple[tuple[str, int], ...]) -> tuple[Offer, ...]:
    """Read the offers of packages: some ms for a hundred installed ones, so once for a state of the path."""
    points = entry_points(group=GROUP)
    return tuple(Offer(each.name, each.dist.name if each.dist else "unknown", each) for each in points)


def _version(folder: str) -> tuple[str, int]:
    """Return a folder with the time of its last change: installing a package is one."""
    try:
        return folder, os.stat(folder or ".").st_mtime_ns
    except OSError:
        return folder, 0


def choose_bridge(explicit: str | None = None, default: str = "sim") -> str:
    """Return the name of the bridge to use: the explicit one, else the default.

    The default is the simulator for lab, magic and command line, and ``"none"`` for a session.

    `explicit`: a name, or a Python file: it is run, and the last bridge that it defines is used.
    Raises BridgeError: there is no bridge of that name, and the message lists the known ones; or the file
        defines none.
    Raises LRPError: the file cannot be read, or raises something.
    """
    name = explicit or default
    if name.endswith(".py"):
        return _from_file(name)
    known = find_bridges()
    if name not in known:
        listed = ", ".join(f"`{other}`" for other in known)
        hint = did_you_mean(name, known) or " Or name a Python file that defines one, as in `mine.py`."
        raise BridgeError(f"There is no bridge `{name}`; there are {listed}.{hint}")
    return name


def _from_file(path: str) -> str:
    """Run a Python file and return the name of the bridge that it defines last, else of what it imports."""
    before = list(Bridge.registry.values())
    folder = str(Path(path).resolve().parent)
    if folder not in sys.path:
        sys.path.append(folder)  # it may import a file beside it, also later
    module = ModuleType(f"lrp_bridge_{Path(path).stem}")
    module.__file__ = path
    sys.modules[module.__name__] = module  # where a dataclass looks for the names in its annotations
    try:
        run_python(path, vars(module))
    finally:  # what another process needs of it is sent there, as of a notebook: it cannot import it
        del sys.modules[module.__name__]
    registered = list(Bridge.registry.values())
    new = [each for each in registered if each not in before and each.__module__ == module.__name__]
    found = [each for each in (*vars(module).values(), *new) if any(each is other for other in registered)]
    usable: list[type[Bridge]] = [each for each in found if not inspect.isabstract(each)]
    if not usable:
        _refuse_abstract(new, f"In `{shown(path)}`, ")
        raise BridgeError(f"`{shown(path)}` defines no bridge. Write a subclass of `Bridge` in it.")
    return next((each for each in reversed(usable) if each in new), usable[-1]).name


def _refuse_abstract(kinds: Iterable[type[Bridge]], where: str = "") -> None:
    """Raise a BridgeError if one of some classes lacks what every bridge needs."""
    for bridge in kinds:
        if inspect.isabstract(bridge):
            missing = ", ".join(f"`{name}`" for name in sorted(bridge.__abstractmethods__))
            raise BridgeError(f"{where}`{bridge.__name__}` lacks {missing}, which every bridge needs.")


def make_bridge(which: str | type[Bridge] | Bridge | None = None, **options: Any) -> Bridge:
    """Create a bridge without opening it, from a name, a class or an existing bridge.

    None stands for the `NullBridge`. An option that is a text is read as its annotation says.

    Raises BridgeError: the name is unknown, the class cannot be loaded, or it does not take these options or
        these values.
    """
    if isinstance(which, Bridge):
        check_options(which, options)
        return which
    bridge = _class_of(which)
    _refuse_abstract([bridge])
    refuse_options(bridge, options)
    return bridge(**convert_options(bridge, options))


def _class_of(which: str | type[Bridge] | None) -> type[Bridge]:
    if which is None:
        return NullBridge
    if isinstance(which, str):
        name = choose_bridge(which)  # first: a file that it runs defines one
        return find_bridges()[name].load()
    if isinstance(which, type) and issubclass(which, Bridge):
        return which
    kind = which.__name__ if isinstance(which, type) else type(which).__name__
    raise TypeError(f"A bridge is a name, a subclass of Bridge or an object of one, not {kind}.")


def check_options(
    which: str | type[Bridge] | Bridge | None, options: Mapping[str, Any], others: Iterable[str] = ()
) -> None:
    """Raise a BridgeError for an option that a bridge, as for :func:`make_bridge`, does not take, or lacks.

    `others`: further keywords of the caller, one of which may be meant.
    """
    if isinstance(which, Bridge):
        for option in options:
            raise BridgeError(
                f"The bridge `{which.name}` exists already and accepts no more options, such as `{option}`."
                f"{did_you_mean(option, others, 0.7)}"
            )
    elif options:
        refuse_options(_class_of(which), options, others)


def open_bridge(which: str | type[Bridge] | Bridge | None = None, **options: Any) -> Bridge:
    """Create a bridge and open it; raise as `make_bridge` and `Bridge.open`."""
    bridge = make_bridge(which, **options)
    bridge.open()
    return bridge
