"""The robot of a run: which bridge, with which options."""

from __future__ import annotations

import inspect

import typer

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.discovery import choose_bridge, find_bridges, make_bridge
from lrp_jupyter.cli.options import RunOptions
from lrp_jupyter.cli.source import Source

__all__ = ["open_robot", "where"]


def open_robot(source: Source, wanted: RunOptions) -> Bridge:
    """Make the bridge of a run, and open it; hardware that was named is armed.

    Raises
    ------
    BridgeError
        There is no such bridge or world, or its robot cannot be reached.
    typer.BadParameter
        An option does not fit the bridge.
    """
    simulated = bool(wanted.world or wanted.noise or wanted.seed is not None)
    alone = source.world == "none" and not simulated
    name = choose_bridge(wanted.bridge, "none" if alone else "sim")
    if name == "sim":
        return _open_simulator(source, wanted)
    if simulated:
        option = "--world" if wanted.world else "--noise" if wanted.noise else "--seed"
        raise typer.BadParameter(f"{option} is for the simulator, and the bridge is `{name}`.")
    kind = find_bridges()[name].load()
    if kind.hardware and wanted.speed != 1:
        raise typer.BadParameter(f"--speed is for the simulator: `{name}` moves in real time.")
    taken = inspect.signature(kind).parameters
    options = {key: text for key, text in wanted.answers.items() if key in taken}
    bridge = make_bridge(name, **options)
    try:
        bridge.open()
        for key, text in wanted.answers.items():
            if key not in options:
                bridge.answer(key, text)
        if bridge.hardware:
            bridge.arm()
    except BaseException:
        bridge.close()
        raise
    return bridge


def _open_simulator(source: Source, wanted: RunOptions) -> Bridge:
    world = wanted.world or (source.world if source.world not in (None, "none") else "line")
    bridge = make_bridge("sim", world=world, seed=wanted.seed, noise=wanted.noise or None, **wanted.answers)
    bridge.open()
    return bridge


def where(bridge: Bridge, world: str | None = None) -> str:
    """Say in a few words what the robot is: ``sim: line``; a real one is in no world."""
    simulated = getattr(bridge, "world", None)
    name = "" if simulated is None else simulated.name or world
    return f"{bridge.name}: {name}" if name else bridge.name
