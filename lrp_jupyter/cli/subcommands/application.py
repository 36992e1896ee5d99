"""The application to which the commands belong, and the arguments that several of them have."""

from __future__ import annotations

from functools import partial
from importlib.metadata import version
from typing import Annotated, Any

import typer
from typer import Argument, Option
from typer.core import TyperCommand, TyperGroup

from lrp_jupyter.cli import complete
from lrp_jupyter.errors import LRPError, lacks_simulator


class _Commands(TyperGroup):
    """A command group that prints an error of the user's as one sentence and exits with code 2."""

    def invoke(self, ctx: Any) -> Any:
        try:
            return super().invoke(ctx)
        except (LRPError, OSError, ModuleNotFoundError) as error:
            if isinstance(error, ModuleNotFoundError):
                if not (lacking := lacks_simulator(error)):
                    raise
                error = LRPError(lacking)
            elif isinstance(error, OSError) and not isinstance(error, LRPError):
                name = f"`{error.filename}` cannot be used: " if error.filename else ""
                error = LRPError(f"{name}{error.strerror or str(error)}.")
            typer.echo(f"lrp: {error}", err=True)
            raise typer.Exit(error.exit_code) from None


class _Command(TyperCommand):
    """A command that takes no empty text, which would be the current folder, or nothing at all."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        known = {name for parameter in self.params for name in parameter.opts}
        for before, text in zip(["", *args], args, strict=False):
            name, equals, value = text.partition("=")
            is_option = bool(equals) and name in known
            if not (value if is_option else text).strip():
                named = name if is_option else before if before in known else "An argument"
                raise typer.BadParameter(f"{named} is empty. Write what is meant, or leave it out.")
        return super().parse_args(ctx, args)


class NodeCommand(_Command):
    """A command that takes the arguments of a node of ROS, wherever they stand."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse what is not for ROS; the rest comes after a ``--``."""
        if not any(":=" in text or text == "--ros-args" for text in args):
            return super().parse_args(ctx, args)
        from lrp_jupyter.bridges.ros.arguments import split_arguments

        own, ros = split_arguments(args)
        return super().parse_args(ctx, [*own, *([] if "--" in own else ["--"]), *ros] if ros else own)


app = typer.Typer(
    cls=_Commands,
    no_args_is_help=True,
    add_completion=True,
    rich_markup_mode="markdown",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
command = partial(app.command, cls=_Command)


time_option = partial(Option, metavar="SECONDS", min=0, max=1e7)  # of a run
seeds_option = partial(Option, metavar="N", min=1, max=100_000)


File = Annotated[
    str,
    Argument(
        metavar="FILE",
        help="A file, the name of a bundled program, or `-` for stdin.",
        autocompletion=complete.sources,
    ),
]


CheckedBridge = Annotated[
    str | None,
    Option(
        "--bridge",
        metavar="NAME",
        autocompletion=complete.bridges,
        help="Check for this robot: see `lrp bridges`. Default: the simulated one.",
    ),
]


BridgeOptions = Annotated[
    list[str] | None,
    Option("--option", "-o", metavar="KEY=VALUE", help="An option of the bridge, or an answer to it."),
]


RosArguments = Annotated[
    list[str] | None,
    Argument(
        metavar="ROS_ARGUMENTS",
        help="For a node of ROS: what roslaunch and `ros2 launch` append, such as `__name:=behaviour`.",
    ),
]


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"lrp {version('lrp-jupyter')}")
        raise typer.Exit


@app.callback()
def lrp(
    _: Annotated[
        bool, Option("--version", help="Print the version.", callback=_version, is_eager=True)
    ] = False,
) -> None:
    """Live programming of robot behaviour: nested state machines that change while they run.

    Start with `lrp run follower`.

    **Exit codes**: 0 when all went well; 1 when a text has errors, or what was demanded of a program did not
    happen; 2 when an argument is wrong, or a file or robot cannot be used; 3 for a fault of this package; 4
    when no robot answers; 5 when ROS 1 has ended the node; 130 after Ctrl-C; 154 when a call of C that
    cannot be interrupted has exceeded a limit. The help of `run`, `check`, `format`, `graph`, `grade` and
    `sweep` has the details.
    """
