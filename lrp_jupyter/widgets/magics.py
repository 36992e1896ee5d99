"""The magics: ``%%lrp``, a cell whose text is a program, and ``%lrp`` with its commands.

Errors are printed as one sentence, as IPython does for its own magics.
"""

from __future__ import annotations

import shlex
from collections.abc import Callable, Mapping
from inspect import isfunction
from typing import Any

from IPython.core.error import UsageError
from IPython.core.interactiveshell import InteractiveShell
from IPython.core.magic import Magics, line_cell_magic, magics_class

from lrp_jupyter import programs
from lrp_jupyter.arguments import check_choice
from lrp_jupyter.bridges.discovery import find_bridges
from lrp_jupyter.codes import CODES, explain
from lrp_jupyter.errors import LRPError, did_you_mean
from lrp_jupyter.grading.challenges import challenges, load
from lrp_jupyter.graph.still import svg
from lrp_jupyter.language.resolution import resolve
from lrp_jupyter.sim.worlds import BUNDLED, DESCRIPTIONS
from lrp_jupyter.widgets import registry
from lrp_jupyter.widgets.connection import PageConnection
from lrp_jupyter.widgets.lab import Lab, lab_of
from lrp_jupyter.widgets.text.conditions import CHOICES, NAMES, given
from lrp_jupyter.widgets.text.texts import Texts
from lrp_jupyter.widgets.views.view_state import last_fired

_HELP = """\
%%lrp NAME [--world WORLD] [--bridge BRIDGE] [--rate HZ] [--challenge CHALLENGE]
                      run the cell's text as a program and show its lab; running the cell again
                      changes the running program; other options are the bridge's: --seed 5;
                      a challenge may be a file of your own: --challenge exam.py
       [--on-active-edit restart|keep]
                      what an edit does that changes an active state: it restarts the program, or
                      leaves it in that state, with the new actions
       [--edits live|hold] [--graph live|static|hidden] [--quiet] [--lock]
                      the conditions of a study: edits wait for Apply; the graph is drawn on request,
                      or not shown; nothing of the run is shown outside of it; the page cannot
                      change that. Naming one resets the others; naming none changes nothing
       [--hints sentences|changes]
                      in a challenge: whether the lab also finds the smallest changes with which the
                      program passes, which gives answers away
       [--runs FOLDER]
                      recordings of that folder are run again after every edit, beside those in NAME.runs
       [--log FILE]   record the session, and what its user looks at, in a file of this computer
%lrp                  list the programs that are open
%lrp NAME             show the lab of a program again
%lrp new NAME         open a bundled program
%lrp examples         list the bundled programs and worlds
%lrp pause|resume|step|reset|stop|check|graph [NAME]
%lrp debug [LINE[:COLUMN]] [NAME]
                      debug the issue at a place of the text, or the last one, post mortem
%lrp why WHAT [at SECONDS] [NAME]
                      why a transition did not fire, a state is active, or the robot moves
%lrp explain [CODE]   explain a code, such as LRP301, or list the codes
%lrp interrupt [NAME] interrupt the block that does not return
%lrp save [NAME]      write the lab's text into a new cell
%lrp versions [NAME]  list the earlier texts, the newest first
%lrp version N [NAME] write an earlier text into a new cell
%lrp rate HZ [NAME]   ticks per second, 0 for as many as possible
%lrp bridge BRIDGE [NAME]
                      switch to another bridge
NAME may be left out while only one program is open.\
"""


def _options(line: str) -> tuple[str, dict[str, Any]]:
    """Return the name and the options of a cell; unknown options are the bridge's (``--host …``)."""
    try:
        words = shlex.split(line)
    except ValueError:
        raise UsageError(f"%%lrp: A quotation mark is not closed in `{line}`. Write its partner.") from None
    name: str = ""
    options: dict[str, Any] = {}
    while words:
        word = words.pop(0)
        key, equals, value = word[2:].partition("=")
        if not word.startswith("-") and not name:
            name = word
            continue
        if not (word.startswith("--") and key):
            hint = did_you_mean(word, _OPTIONS)
            raise UsageError(f"%%lrp: Unexpected `{word}`. Options begin with `--`.{hint}")
        if key in _SWITCHES:
            if equals:
                raise UsageError(f"%%lrp: `--{key}` takes no value. Leave out `={value}`.")
            options[key] = True
            continue
        if not equals:
            if not words or words[0].startswith("--"):
                raise UsageError(f"%%lrp: `--{key}` needs a value, as in `--{key} {_VALUES.get(key, '…')}`.")
            value = words.pop(0)
        options[key.replace("-", "_")] = _value(key, value)
    return name or "program", options


_VALUES = {
    "world": "line",
    "bridge": "sim",
    "rate": "20",
    "on-active-edit": "keep",
    "challenge": "square",
    "edits": "hold",
    "graph": "static",
    "hints": "changes",
    "runs": "accidents",
    "log": "participant-07.lrplog",
}
_CHOICES = {**CHOICES, "on-active-edit": ("restart", "keep"), "hints": ("sentences", "changes")}
_SWITCHES = ("quiet", "lock")
_OPTIONS = [f"--{name}" for name in (*_VALUES, *_SWITCHES)]


def _value(key: str, value: str) -> object:
    if key == "rate":
        return _hertz(value, "%%lrp: `--rate`")
    if key in _CHOICES:
        try:
            check_choice(f"--{key}", value, _CHOICES[key])
        except ValueError as error:
            raise UsageError(f"%%lrp: {error}") from None
    return value


def _hertz(text: str, what: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise UsageError(f"{what} is a number of ticks per second, not `{text}`.") from None


def _seconds(text: str) -> float:
    try:
        return float(text.removesuffix("s"))
    except ValueError:
        raise UsageError(f"%lrp why: `{text}` is not a number of seconds.") from None


@magics_class
class LRPMagics(Magics):
    """The magics of the package."""

    @line_cell_magic
    def lrp(self, line: str, cell: str | None = None) -> object:
        """Live programming of robot behaviour; see the commands below."""
        try:
            return self._line(line) if cell is None else self._cell(line, cell)
        except (LRPError, OSError, ValueError) as error:
            raise UsageError(str(error)) from None

    lrp.__doc__ = f"Live programming of robot behaviour.\n\n{_HELP}"

    @property
    def _names(self) -> dict[str, Any]:
        shell = self.shell
        return shell.user_ns if shell is not None else {}

    def _cell(self, line: str, cell: str) -> Lab:
        cell = cell if cell.strip() else ""
        name, options = _options(line)
        bridge = options.pop("bridge", None)
        if "challenge" in options:
            options["task"] = load(options.pop("challenge"))
        options["conditions"] = given(**{each: options.pop(each, None) for each in NAMES})
        if options.get("world") and bridge not in (None, "sim"):
            raise UsageError(f"%%lrp: `--world` is for the simulator, and the bridge is `{bridge}`.")
        return lab_of(
            registry.open_program(name, cell, bridge, namespace=self._names, line=line.strip(), **options)
        )

    def _line(self, line: str) -> object:
        word, *rest = line.split() or [""]
        if not word:
            self._list()
            return None
        if word in ("help", "-h", "--help", "?"):
            print(_HELP)
            return None
        action = WORDS.get(word)
        if action is not None:
            return action(self, rest)
        found = registry.find(word)
        if found is not None and rest:
            raise UsageError(f"%lrp: Unexpected `{rest[0]}`. `%lrp {word}` shows the lab of `{word}`.")
        if found is not None:
            return lab_of(found)
        listed = ", ".join(f"`{name}`" for name in registry.names()) or "none"
        hint = did_you_mean(word, [*WORDS, *registry.names()])
        raise UsageError(
            f"%lrp: There is no command or program `{word}`.{hint} Open programs: {listed}. "
            "`%lrp help` lists the commands."
        )

    def _list(self) -> None:
        lines = []
        for connection in registry.running():
            frame = connection.session.frame
            active = ", ".join("/".join(path) for path in frame.active) or "nothing"
            lines.append(f"{connection.name}: {frame.status}, tick {frame.tick}, {active} active")
        print("\n".join(lines) or "No program is open. `%lrp examples` lists bundled ones.")

    # -- the words -------------------------------------------------------------------------------

    def show(self, rest: list[str]) -> Lab:
        """Show the lab of a program again."""
        return lab_of(_the(rest))

    def new(self, rest: list[str]) -> Lab:
        """Open a bundled program."""
        if len(rest) != 1:
            raise UsageError(f"%lrp: Expected one name, not {len(rest)}. Write `%lrp new NAME`.")
        (name,) = rest
        if name not in programs.names():
            listed = ", ".join(f"`{known}`" for known in programs.names())
            hint = did_you_mean(name, programs.names())
            raise UsageError(
                f"There is no bundled program `{name}`.{hint} Choose one of {listed}, "
                f"or begin an empty program with `%%lrp {name}`."
            )
        text = programs.load(name)
        world = programs.heading(text).world
        return lab_of(registry.open_program(name, text, namespace=self._names, **registry.robot_for(world)))

    def examples(self, rest: list[str]) -> None:
        """List the bundled programs and worlds."""
        lines = ["Programs (`%lrp new NAME`):"]
        lines += [
            f"  {name:<18} {programs.heading(programs.load(name)).description}" for name in programs.names()
        ]
        lines += ["Worlds (`%%lrp NAME --world WORLD`):"]
        lines += [f"  {name:<18} {about}" for name, about in DESCRIPTIONS.items()]
        print("\n".join(lines))

    def pause(self, rest: list[str]) -> None:
        """Pause the program and its robot."""
        _the(rest).session.pause()

    def resume(self, rest: list[str]) -> None:
        """Start or resume the program."""
        _the(rest).session.start()

    def step(self, rest: list[str]) -> None:
        """Run one tick."""
        _the(rest).session.step()

    def reset(self, rest: list[str]) -> None:
        """Restart the program."""
        _the(rest).session.reset()

    def stop(self, rest: list[str]) -> None:
        """Stop the robot, then pause."""
        _the(rest).session.stop_robot()

    def interrupt(self, rest: list[str]) -> None:
        """Interrupt the block that does not return."""
        connection = _the(rest)
        if not connection.session.interrupt():
            print(f"No block of `{connection.name}` is running now, so there is nothing to interrupt.")

    def rate(self, rest: list[str]) -> None:
        """Set the ticks per second."""
        if not rest:
            raise UsageError("%lrp rate: Write the number of ticks per second, as in `%lrp rate 20`.")
        _the(rest[1:]).session.rate = _hertz(rest[0], "%lrp rate: The rate")

    def why(self, rest: list[str]) -> None:
        """Say why a transition did not fire, why a state is active, or why the robot does what it does."""
        if not rest:
            raise UsageError(
                "%lrp why: Write the name of a transition, a state or a command of the robot, as in "
                "`%lrp why looking` or `%lrp why robot.move at 12.3`."
            )
        if rest[0] == "not" and len(rest) > 1:  # the same question
            rest = rest[1:]
        what, *rest = rest
        at = None
        if rest[:1] == ["at"]:
            if len(rest) < 2:
                raise UsageError("%lrp why: Write the seconds of the run after `at`, as in `at 12.3`.")
            at, rest = _seconds(rest[1]), rest[2:]
        elif rest and rest[0].removesuffix("s").replace(".", "", 1).isdecimal():
            raise UsageError(
                f"%lrp why: Write `at` before the seconds, as in `%lrp why {what} at {rest[0]}`."
            )
        print(_the(rest).session.explain(what, at))

    def explain(self, rest: list[str]) -> None:
        """Explain a code; without one, list the codes."""
        every = [f"{each.code:<30} {each.title}" for each in CODES.values()]
        print("\n\n\n".join(map(str, explain(" ".join(rest)))) if rest else "\n".join(every))

    def check(self, rest: list[str]) -> None:
        """Print the findings of the checks."""
        connection = _the(rest)
        found = connection.session.check(connection.texts.text)
        print("\n".join(str(finding) for finding in found) or f"`{connection.name}` has no findings.")

    def graph(self, rest: list[str]) -> None:
        """Show the state graph as it is now, as a picture that is stored."""
        connection = _the(rest)
        session = connection.session
        picture = svg(session.program, session.frame.active, last_fired(connection.view_state()))
        if self.shell is not None:
            self.shell.display_pub.publish({"image/svg+xml": picture})

    def save(self, rest: list[str]) -> None:
        """Write the lab's text into a new cell."""
        texts = _the(rest).texts
        text = texts.text
        self._write_cell(texts, text)
        texts.note_saved(text)

    def versions(self, rest: list[str]) -> None:
        """List the earlier texts, the newest first."""
        connection = _the(rest)
        lines = [f"{n}: {version}" for n, version in enumerate(connection.texts.versions, 1)]
        print("\n".join(lines) or f"There are no earlier texts of `{connection.name}`.")

    def version(self, rest: list[str]) -> None:
        """Write an earlier text into a new cell."""
        if not rest or not rest[0].isdecimal():
            raise UsageError("%lrp version: Write the number of a version, as in `%lrp version 1`.")
        connection = _the(rest[1:])
        known = dict(enumerate(connection.texts.versions, 1))
        found = known.get(int(rest[0]))
        if not known:
            raise UsageError(f"%lrp version: There are no earlier texts of `{connection.name}`.")
        if found is None:
            raise UsageError(
                f"%lrp version: There is no version {rest[0]}, only 1 to {len(known)}. "
                "`%lrp versions` lists them."
            )
        self._write_cell(connection.texts, found.text)

    def _write_cell(self, texts: Texts, text: str) -> None:
        if self.shell is not None:
            self.shell.set_next_input(f"{texts.in_cell['line']}\n{text}")

    def debug(self, rest: list[str]) -> None:
        """Debug an issue, post mortem: the one at a place of the text, or the one that occurred last."""
        place = rest[0] if rest and rest[0].replace(":", "").isdecimal() else ""
        connection = _the(rest[1:] if place else rest)
        session, name = connection.session, connection.name
        listed = {f"{issue.line}:{issue.column}": issue for issue in session.issues}
        issue = session.interpreter.issues.newest
        if place:
            found = [at for at in listed if place in (at, at.partition(":")[0])]
            issue = listed[found[-1]] if found else None
        if issue and session.status == "running":
            session.pause("Paused to debug.")
        trace = session.traceback_of(issue) if issue else None
        if issue is None or trace is None or self.shell is None:
            known = f" Issues are listed at {', '.join(listed)}." if listed else ""
            print(f"`{name}` has no issue {f'at `{place}` ' if place else ''}to debug.{known}")
            return
        print(
            f"{issue}\n`{name}` is paused. `p x` prints the variable `x` as it is now; `!x = 1` assigns it; "
            "`p robot` and `p state` work, too. `u` and `d` move through the calls, and `q` ends."
        )
        debugger = self.shell.debugger_cls()
        debugger.reset()
        debugger.interaction(None, trace)

    def bridge(self, rest: list[str]) -> None:
        """Switch to another bridge; without a name, list the bridges."""
        if not rest:
            lines = [f"{name}: {offer.origin}" for name, offer in find_bridges().items()]
            print("\n".join(lines))
            return
        _the(rest[1:]).change_bridge(rest[0])


def _the(rest: list[str]) -> PageConnection:
    """Return the program that is named, or the only one that is open."""
    name = " ".join(rest)  # `own (2)`
    if len(rest) > 1 and registry.find(name) is None:
        raise UsageError(f"%lrp: Expected one name, not {len(rest)}.")
    return registry.named(name)


WORDS: Mapping[str, Callable[[LRPMagics, list[str]], object]] = {
    name: member
    for name, member in vars(LRPMagics).items()
    if isfunction(member) and not name.startswith("_") and name != "lrp"
}
"""The commands of ``%lrp``, by name: the public methods apart from the magic itself."""


def completions(shell: InteractiveShell, event: Any) -> list[str]:
    """Complete what follows ``%lrp`` or ``%%lrp``."""
    words = event.line.split()
    before = words[1:] if event.line.endswith(" ") else words[1:-1]
    names = registry.names()
    if event.line.lstrip().startswith("%%"):
        last = before[-1] if before else ""
        if last == "--world":
            return list(BUNDLED)
        if last == "--bridge":
            return list(find_bridges())
        if last == "--challenge":
            return [shlex.quote(each.name) for each in challenges()]
        if last[2:] in CHOICES:
            return list(CHOICES[last[2:]])
        return [*(() if before else names), *_OPTIONS]
    if not before:
        return [*WORDS, *names]
    if before[0] == "why":
        return _asked() if len(before) == 1 else ["at", *names]
    if before[0] == "explain":
        return list(CODES)
    return {"new": list(programs.names()), "bridge": list(find_bridges())}.get(before[0], names)


def _asked() -> list[str]:
    """Return what can be asked about: the transitions and states of the open programs, and the robot."""
    elements = [
        element
        for connection in registry.running()
        for element in resolve(connection.session.program).elements()
        if element.kind in ("transition", "state")
    ]
    return [*dict.fromkeys(element.shown[-1] for element in elements), "robot.move"]


def open_body(lines: list[str]) -> list[str]:
    """Add a body to a cell that is only ``%%lrp NAME``, which IPython refuses; it opens an empty lab."""
    if lines and lines[0].startswith("%%lrp") and not "".join(lines[1:]):
        return [lines[0].rstrip("\n") + "\n", "\n"]
    return lines
