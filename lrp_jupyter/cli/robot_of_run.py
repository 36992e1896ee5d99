"""The robot of ``lrp run``: which one it is, and how it is opened."""

from __future__ import annotations

from dataclasses import replace

import typer

from lrp_jupyter.bridges.bridge import Bridge, BridgeStatus, ConnectionState
from lrp_jupyter.bridges.discovery import choose_bridge, find_bridges, make_bridge
from lrp_jupyter.bridges.options import options_of, refuse_options
from lrp_jupyter.cli.console import plain_console
from lrp_jupyter.cli.program_source import Source
from lrp_jupyter.cli.run_options import RunOptions
from lrp_jupyter.live.running.checking import DEFAULT_WORLD


def open_robot(source: Source, wanted: RunOptions) -> Bridge:
    """Return the opened bridge of a run; hardware that was named is armed."""
    simulated = bool(wanted.world or wanted.noise or wanted.seed is not None)
    alone = source.world == "none" and not simulated
    name = choose_bridge(wanted.bridge, "none" if alone else "sim")
    if wanted.ros_arguments:
        wanted = _with_ros_arguments(wanted, name)
    if name == "sim":
        return _open_simulator(source, wanted)
    if simulated:
        option = "--world" if wanted.world else "--noise" if wanted.noise else "--seed"
        raise typer.BadParameter(f"{option} is for the simulator, and the bridge is `{name}`.")
    kind = find_bridges()[name].load()
    if kind.hardware and wanted.speed != 1:
        raise typer.BadParameter(f"--speed is for the simulator: `{name}` moves in real time.")
    known = options_of(kind)
    if known is not None and kind.answer is Bridge.answer:
        refuse_options(kind, wanted.answers)  # before anything is opened
    options = {key: text for key, text in wanted.answers.items() if known is None or key in known}
    bridge = make_bridge(name, **options)
    bridge.alone = True
    try:
        bridge.status_listener = _tell_waiting
        bridge.open()
        bridge.status_listener = None
        for key, text in wanted.answers.items():
            if key not in options:
                bridge.answer(key, text)
        if bridge.hardware:
            bridge.arm()
    except BaseException:
        bridge.close()
        raise
    return bridge


def _tell_waiting(status: BridgeStatus) -> None:
    """Print for what the opening of a robot waits."""
    if status.state is ConnectionState.CONNECTING and status.sentence.startswith("Waiting"):
        plain_console(stderr=True).print(f"lrp: {status.sentence}")


def _with_ros_arguments(wanted: RunOptions, name: str) -> RunOptions:
    """Return the options with those that the arguments of a node are; they come last, so they count."""
    from lrp_jupyter.bridges.ros.arguments import bridge_options, split_arguments

    if name != "ros":
        first = wanted.ros_arguments[0]
        if split_arguments([first])[1]:
            raise typer.BadParameter(
                f"`{first}` is for a node of ROS, and the bridge is `{name}`. Write `--bridge ros`, or leave"
                " it out."
            )
        raise typer.BadParameter(f"Got an unexpected argument: `{first}`.")
    options = bridge_options(wanted.ros_arguments, options_of(find_bridges()[name].load()) or ())
    rules = filter(None, (wanted.answers.get("remap"), options.get("remap")))
    remap = {"remap": " ".join(rules)} if "remap" in options else {}
    return replace(wanted, answers={**wanted.answers, **options, **remap})


def _open_simulator(source: Source, wanted: RunOptions) -> Bridge:
    world = wanted.world or (source.world if source.world not in (None, "none") else DEFAULT_WORLD)
    bridge = make_bridge("sim", world=world, seed=wanted.seed, noise=wanted.noise or None, **wanted.answers)
    bridge.open()
    return bridge


def where(bridge: Bridge, world: str | None = None) -> str:
    """Return the name of the bridge, with that of its world if it is simulated: ``sim: line``."""
    simulated = getattr(bridge, "world", None)
    name = "" if simulated is None else simulated.name or world
    return f"{bridge.name}: {name}" if name else bridge.name
