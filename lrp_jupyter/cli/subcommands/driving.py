"""The commands that drive a robot, or stop it: ``run`` and ``guard``."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import typer
from typer import Option

from lrp_jupyter.cli import complete
from lrp_jupyter.cli.subcommands.application import (
    BridgeOptions,
    File,
    NodeCommand,
    RosArguments,
    app,
    time_option,
)


class EditPolicy(StrEnum):
    """What an edit does that changes an active state."""

    restart = "restart"
    keep = "keep"


class OnIssue(StrEnum):
    """What happens at a fault of the running program."""

    record = "record"
    pause = "pause"


RUN_EPILOG = """
**Exit code**: 0 when the run ended normally, 1 when the text is not a valid program (or `--until` was not
reached, or the run paused, at an issue or a breakpoint, and nothing can resume it, or a block did not return
for 10 s in a run with `--for`), 2 when a file cannot be read, a robot cannot be opened or an option is wrong,
3 when the interpreter itself failed, 4 when the robot did not answer, nothing of it ever worked, or it was
lost at the end, 5 when ROS 1 has ended the node (another one took its name, or `rosnode kill`), 130 when
Ctrl-C stopped the robot and ended the run, 143 after SIGTERM, 154 when a run with `--for` was ended because
one call of C did not return: the stacks that are printed then show its line.

**Live programming**: with `--watch` every save of the file patches the running program. A text that is not a
valid program changes nothing: its errors are shown and the last valid program keeps running. A block that
does not return is interrupted by the next save, or by the key `i`.

**Editors**: with `--socket` the editors that have the file open, of the same user on the same machine, show
what is active and the values of variables at the ends of the lines: see `lrp language-server`.

**A page**: `--serve 8080` prints a link, once. Whoever opens it has the lab of this run, without Jupyter, and
can change the program, which is then written to the file. The link holds a token: keep it to yourself, for a
program can do all that you can on this computer. `--serve 0.0.0.0:8080` serves other computers, too,
encrypted with `--certificate`; `--read-only` only shows.

**Breakpoints**: `--break looking` completes the tick in which the state `looking` is entered, then pauses;
space resumes, `s` steps. `--break tlooking` waits for a transition, `--break 'left moving'` for the end of a
state, `--break 'event outofline'` for an event, `--break 'when robot.light.data < 50'` for a condition over
the global variables and the robot to become True. Without a keyboard or `--watch` the run ends there, with
exit code 1.

**By hand**: `--fire tlooking@2.5` fires the transition `tlooking` after the tick at 2.5 s, whatever its
condition, if a state that it leaves is active. Recordings, `lrp replay` and `lrp why` know it.

**Traces**: `--trace` writes JSON Lines, one object per event, with `tick` (the first is 1), `time` (seconds)
and `event`: `started`, `paused`, `resumed`, `ended` (`onend` has run); `entered`, `left` (`state`); `fired`
(`machine`, `transition`, `source`, `destination`); `spawned`, `discarded` (`machine`); `changed` (`variable`,
`value`); `issue` (`code`, `element`, `line`, `message`); `patched` (`applied`, `restarted`, `reason`);
`restarted` (`reason`); `forced` (`state`, `how`); `commanded` (`command`, `arguments`, `sent`, and `block`
and `line` of its origin); `printed` (`text`). `changed` is also written where a list, dict or set was changed
in place, but not where an attribute of an object was. The same program, world and seed produce the same
trace, unless the program walks over a set of texts, which Python orders otherwise in every process:
`PYTHONHASHSEED=0 lrp run …` fixes that.

**Recordings**: `--record run.lrplog` writes the trace and the inputs of the run: program and world, every
save of the file, every key. `lrp replay run.lrplog` reproduces a simulated run bit for bit (of a program that
walks over a set of texts, if `PYTHONHASHSEED` is the same number for both), and `lrp why
run.lrplog NAME --at 12.3` says why a transition did not fire there. A name that ends with `.gz` compresses
the file.

**Animations**: `--animate run.svg` draws how the simulated world moved, at its end, as an SVG that browsers
play; of a longer run the last ten minutes, or 10,000 ticks if they are more.
"""


@app.command(cls=NodeCommand, epilog=RUN_EPILOG)
def run(
    file: File,
    ros_arguments: RosArguments = None,
    bridge: Annotated[
        str | None,
        Option(
            autocompletion=complete.bridges,
            metavar="NAME|FILE",
            help="The robot: see `lrp bridges`, or a Python file with a bridge. Naming hardware arms it."
            " Default: the simulator.",
        ),
    ] = None,
    world: Annotated[
        str | None,
        Option(
            metavar="NAME|FILE",
            autocompletion=complete.worlds,
            help="The simulated world: see `lrp worlds`. Default: the one named in the text.",
        ),
    ] = None,
    rate: Annotated[float, Option(metavar="HZ", help="Ticks per second; 0 for as many as possible.")] = 10,
    seconds: Annotated[
        float | None, time_option("--for", help="End the run after this time of its own clock.")
    ] = None,
    until: Annotated[
        str | None,
        Option(
            metavar="STATE", autocompletion=complete.states, help="End the run when this state is entered."
        ),
    ] = None,
    start: Annotated[
        str | None,
        Option(
            metavar="PATH",
            autocompletion=complete.states,
            help="Start only this machine, such as `follower/looking/lookalgo`, or one of its states."
            " The machines around it do not run.",
        ),
    ] = None,
    speed: Annotated[
        str,
        Option(
            metavar="X|max",
            autocompletion=complete.speeds,
            help="Factor of real time; `max` never waits (simulator only).",
        ),
    ] = "1",
    seed: Annotated[int | None, Option(help="Seed of the simulator's noise.")] = None,
    noise: Annotated[
        list[str] | None,
        Option(
            metavar="NAME=NUMBER",
            autocompletion=complete.noises,
            help="Imperfections: `motor=0.1`, `light=10`, `distance`, `gyro`, `odom`; may be repeated.",
        ),
    ] = None,
    assignments: Annotated[
        list[str] | None,
        Option(
            "--set",
            metavar="NAME=EXPR",
            autocompletion=complete.variables,
            help="Start with another value of a variable; may be repeated.",
        ),
    ] = None,
    trace: Annotated[
        str | None, Option(metavar="FILE|-", help="Write what happens as JSON Lines; `-` writes to stdout.")
    ] = None,
    breakpoints: Annotated[
        list[str] | None,
        Option(
            "--break",
            metavar="WHAT",
            autocompletion=complete.states,
            help="Pause when a STATE is entered or a TRANSITION fires; or `left STATE`, `event NAME`, "
            "`when EXPRESSION`; may be repeated.",
        ),
    ] = None,
    fires: Annotated[
        list[str] | None,
        Option(
            "--fire",
            metavar="TRANSITION@SECONDS",
            autocompletion=complete.transitions,
            help="Fire a transition by hand at a time of the run's own clock; may be repeated.",
        ),
    ] = None,
    record: Annotated[
        str | None, Option(metavar="FILE", help="Write a recording, for `lrp replay` and `lrp why`.")
    ] = None,
    animate: Annotated[
        str | None, Option(metavar="FILE", help="Draw the simulated run as a moving picture (SVG).")
    ] = None,
    watch: Annotated[
        bool, Option("--watch", help="Patch the running program at every save of the file.")
    ] = False,
    socket: Annotated[
        bool,
        Option("--socket", help="Tell your editors what runs: they show values at the ends of lines."),
    ] = False,
    serve: Annotated[
        str | None,
        Option(
            metavar="[HOST:]PORT",
            help="Serve the lab of this run to browsers, at the link that is printed; without HOST to those"
            " on this computer. Port 0: a free one.",
        ),
    ] = None,
    certificate: Annotated[
        str | None, Option(metavar="FILE", help="Encrypt the page, with this certificate (PEM).")
    ] = None,
    key: Annotated[
        str | None, Option(metavar="FILE", help="The key of the certificate, if it is in another file.")
    ] = None,
    read_only: Annotated[bool, Option("--read-only", help="Pages look and ask, and change nothing.")] = False,
    on_active_edit: Annotated[
        EditPolicy,
        Option(
            help="What a save does that changes an active state: `restart` the program, or `keep` it"
            " in that state, with the new actions."
        ),
    ] = EditPolicy.restart,
    on_issue: Annotated[
        OnIssue, Option(help="What to do whenever a fault of the program occurs.")
    ] = OnIssue.record,
    host: Annotated[str | None, Option(help="Address of the robot; short for `--option host=…`.")] = None,
    options: BridgeOptions = None,
) -> None:
    """Run a program and show what it does; with `--watch`, it can be changed meanwhile."""
    from lrp_jupyter.cli.run_command import run_file
    from lrp_jupyter.cli.run_options import parse_options

    wanted = parse_options(
        bridge=bridge,
        world=world,
        rate=rate,
        seconds=seconds,
        until=until,
        start=start,
        speed=speed,
        seed=seed,
        noise=noise or [],
        assignments=assignments or [],
        trace=trace,
        record=record,
        animate=animate,
        breakpoints=tuple(breakpoints or ()),
        fires=fires or [],
        watch=watch,
        socket=socket,
        serve=serve,
        certificate=certificate,
        key=key,
        read_only=read_only,
        on_active_edit=on_active_edit.value,
        on_issue=on_issue.value,
        answers=[*([f"host={host}"] if host else []), *(options or [])],
        ros_arguments=tuple(ros_arguments or ()),
    )
    raise typer.Exit(run_file(file, wanted))


GUARD_EPILOG = """
Run it on the robot, or beside it: it works when the computer with the program sleeps or dies, and when the
network between the two is cut. It says on stdout when it stops the robot, and goes on.

**ROS**: `lrp guard --topic /cmd_vel` subscribes to the topic, and publishes a velocity of zero on it. A robot
whose driver stops by itself when commands cease needs none.

**Goals** go on without commands. `lrp guard --action /move_base --alive /lrp/alive` cancels them when the
program has published on that topic, and does no more. Its set-up has it do so in every tick:
`"publishers": {"alive": {"topic": "/lrp/alive", "type": "std_msgs/Empty"}}, "tick": {"alive": {}}`.

**MQTT**: `lrp guard --backend mqtt --topic robot/cmd_vel`. Commands are JSON, such as `{"linear": 0.2}`; the
zero has the form of the last one.

**Exit code**: 130 after Ctrl-C; 2 when an argument is wrong, or the robot or the broker cannot be reached at
the beginning. Later it waits for them.
"""


@app.command(cls=NodeCommand, epilog=GUARD_EPILOG)
def guard(
    backend: Annotated[
        str,
        Option(
            autocompletion=complete.backends,
            help="A back end of ROS, such as `rosbridge`, or `mqtt`. Default: that of ROS which is set up "
            "or answers.",
        ),
    ] = "auto",
    host: Annotated[
        str | None,
        Option(
            metavar="HOST[:PORT]",
            help="Of the rosbridge server, the ROS master or the broker. Default: this machine.",
        ),
    ] = None,
    topic: Annotated[
        str | None, Option(help="Of the velocities. Default: `cmd_vel`, or `robot/cmd_vel` for MQTT.")
    ] = None,
    type_: Annotated[
        str, Option("--type", metavar="TYPE", help="Of its messages. Default: that of the live topic.")
    ] = "",
    after: Annotated[
        float,
        Option(
            metavar="SECONDS",
            min=0.1,
            max=3600,
            help="How long the last command holds: more than a tick of the program.",
        ),
    ] = 0.5,
    action: Annotated[
        list[str] | None, Option(metavar="NAME", help="Cancel the goals of this action; may be repeated.")
    ] = None,
    alive: Annotated[
        str,
        Option(
            metavar="TOPIC", help="With --action: where the program publishes in every tick that it is there."
        ),
    ] = "",
    ros_arguments: RosArguments = None,
) -> None:
    """Stop a robot, on its own side, when its program sends no more commands."""
    from lrp_jupyter.cli.guard_command import guard_robot

    raise typer.Exit(
        guard_robot(backend, host, topic, type_, after, alive, action or (), ros_arguments or ())
    )
