"""``lrp programs | worlds | bridges | explain``: lists of what there is, and of challenges."""

from __future__ import annotations

import inspect
import sys

from rich.table import Table
from rich.text import Text

from lrp_jupyter import programs
from lrp_jupyter.cli.console import plain_console
from lrp_jupyter.codes import CODES, explain
from lrp_jupyter.errors import BridgeError, LRPError


def table_of(*columns: str) -> Table:
    """Return an empty table whose last column takes what room there is."""
    table = Table(box=None, pad_edge=False, header_style="dim", padding=(0, 3, 0, 0))
    for column in columns:
        table.add_column(column, no_wrap=column is not columns[-1])
    return table


def show_table(table: Table) -> None:
    """Print a table."""
    console = plain_console(soft_wrap=False)
    if not console.is_terminal:
        console.width = 200  # one line each, for other programs to read
    console.print(table)


def list_programs(show: str | None) -> None:
    """Print the bundled programs, or the text of one."""
    if show is not None:
        sys.stdout.write(programs.load(show))
        return
    table = table_of("program", "world", "what it does")
    for name in programs.names():
        heading = programs.heading(programs.load(name))
        table.add_row(Text(name, "bold"), heading.world or "", Text(heading.description))
    show_table(table)


def list_worlds(show: str | None, as_json: bool) -> None:
    """Print the bundled worlds, or a map or the JSON of one world."""
    from lrp_jupyter.sim.world import WorldError
    from lrp_jupyter.sim.worlds import BUNDLED, DESCRIPTIONS, load

    if show is None:
        table = table_of("world", "metres", "what it is")
        for name in BUNDLED:
            width, depth = load(name).size
            table.add_row(Text(name, "bold"), f"{width:.3g} x {depth:.3g}", Text(DESCRIPTIONS[name]))
        show_table(table)
        return
    try:
        world = load(show)
    except WorldError as error:
        raise LRPError(str(error)) from error
    console = plain_console()
    if as_json:
        sys.stdout.write(world.to_json(indent=2) + "\n")
        return
    from lrp_jupyter.bridges.sim import SimBridge
    from lrp_jupyter.cli.map import framed
    from lrp_jupyter.sim.sketch import sketch

    console.print(DESCRIPTIONS.get(show, world.name or show))
    for line in framed(sketch(world, 70)):
        console.print(line)
    console.print("# solid   ▒ can be pushed   ▓ moves   · line   → robot", style="dim")
    if world.zones:
        console.print(f"zones: {', '.join(world.zones)}", style="dim")
    robot = SimBridge(world)
    robot.add_members()
    console.print(f"robot: {', '.join(member.name for member in robot.members())}", style="dim")


def list_bridges() -> None:
    """Print the available bridges."""
    from lrp_jupyter.bridges.discovery import find_bridges

    table = table_of("bridge", "from", "what it is")
    for name, offer in find_bridges().items():
        try:
            bridge = offer.load()
            words = (inspect.getdoc(bridge) or "").partition("\n")[0]
            words += " Hardware: moves something real." if bridge.hardware else ""
        except BridgeError as error:
            words = str(error)
        table.add_row(Text(name, "bold"), offer.origin, Text(words))
    show_table(table)


def list_options(name: str) -> None:
    """Print the options of a bridge, with their types and default values."""
    from lrp_jupyter.bridges.discovery import choose_bridge, find_bridges
    from lrp_jupyter.bridges.options import options_of

    chosen = choose_bridge(name)
    bridge = find_bridges()[chosen].load()
    sys.stdout.write(f"{chosen}: {(inspect.getdoc(bridge) or '').partition(chr(10))[0]}\n\n")
    options = options_of(bridge)
    if not options:
        sys.stdout.write("It takes any options.\n" if options is None else "It takes no options.\n")
        return
    table = table_of("option", "takes", "default", "what it is")
    for each in options.values():
        default = "must be given" if each.is_needed else "" if each.default is None else str(each.default)
        table.add_row(Text(each.name, "bold"), Text(each.words), Text(default), Text(each.doc))
    show_table(table)
    if bridge.about_options:
        sys.stdout.write(f"\n{bridge.about_options}\n")
    sys.stdout.write(f"\nGive one with `lrp run FILE --bridge {name} --option NAME=VALUE`.\n")


def list_challenges() -> None:
    """Print the available challenges, each series in a table of its own."""
    from lrp_jupyter.grading.challenges import challenges_by_series

    for series, members in challenges_by_series().items():
        if series:
            sys.stdout.write("\n")
        table = table_of(series or "challenge", "what the robot has to do")
        for each in members:
            table.add_row(Text(each.name, "bold"), Text(each.assignment))
        show_table(table)


def explain_code(word: str | None) -> None:
    """Print what the codes of a name mean, or all codes."""
    if word is not None:
        sys.stdout.write("\n\n\n".join(map(str, explain(word))) + "\n")
        return
    table = table_of("code", "what it is", "what it says")
    for each in CODES.values():
        table.add_row(Text(each.code, "bold"), Text(each.kind), Text(each.title))
    show_table(table)
