"""Sessions: running programs that can be changed while they run.

The interpreter is a function of time: it has no clock, no thread and no robot. A session adds them, in
four parts:

* the :class:`~lrp_jupyter.live.running.loop.Loop` ticks, advances the time, and applies commands between
  two ticks;
* the :class:`~lrp_jupyter.live.running.driver.Driver` decides which thread may run the loop (a thread of its
  own, asyncio, the caller of :meth:`Session.run`), and a monitor watches it;
* the :class:`~lrp_jupyter.live.runner.Runner` is opened, runs, is waited for and closed;
* the :class:`Session`, this file, is a runner whose program can be changed, forced, recorded and asked about
  (`questions.py`), from any thread.

*In.* A call of a session becomes a command, a frozen value in a queue; the loop applies it between
two ticks, as a whole. A block that does not return is interrupted for an edit and for most commands.
The caller waits for that, a few seconds at most: then an error names the block that is in the way,
and the command stays in the queue. ``submit`` does not wait. A call from inside a
block of the program itself does not wait either, because the block would wait for its own end. If
no driver is active, the caller applies the command itself.

*Out.* After a tick the loop makes a frozen frame, and stores it by one assignment.
Readers get the newest one; what must not be missed is counted in it. No view ever touches the
interpreter.

*Edits.* The caller's thread checks a text, so that a keystroke costs the robot nothing. A text
that is not a valid program is kept, and the last program continues to run. :attr:`Session.program` is
the running program, :attr:`Session.text` the typed text.

*Faults.* Faults of the program are issues, and nothing stops. A fault of this package stops the robot
and the session, which then is ``broken`` and keeps the traceback; it never looks like a fault of the
program. ``reset`` or ``start`` make it whole again, with the last text. A bridge that fails is ``lost``,
and the loop continues. No exception ends the loop's thread.

*The end.* ``close`` stops the robot first, then has the ``onend`` actions run on the loop's thread, stops
the robot again, and joins the threads; it may be called twice. Sessions that are still open when Python exits
are closed then.

Paper: §5.1 (the loop and its rate), §6 (live programming), §6.3 (pause), §6.4 (forcing states).
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import CancelledError, Future
from contextlib import contextmanager, suppress
from pathlib import Path as FilePath
from typing import Any, Literal, Self

from lrp_jupyter.arguments import check_number, check_type
from lrp_jupyter.errors import LRPError, SessionClosedError, sentence_of
from lrp_jupyter.files import shown, write_file
from lrp_jupyter.interpreter.linker import link
from lrp_jupyter.language.blocks.names_in_blocks import as_path
from lrp_jupyter.language.checks import check
from lrp_jupyter.language.checks.delays import TICK
from lrp_jupyter.language.edits.rename import rename as renamed_text
from lrp_jupyter.language.half_typed import Cursor, Judgement, judge
from lrp_jupyter.language.lookup import find
from lrp_jupyter.language.parser import scan
from lrp_jupyter.language.program import Finding, Path, Program
from lrp_jupyter.language.robot_members import RobotMembers
from lrp_jupyter.live import questions
from lrp_jupyter.live.coverage import Coverage, coverage_of
from lrp_jupyter.live.past.plots import Plot
from lrp_jupyter.live.past.timeline import Timeline, TimelineCursor
from lrp_jupyter.live.past.trials import Trials
from lrp_jupyter.live.past.what_if import WhatIf
from lrp_jupyter.live.reason import Reason
from lrp_jupyter.live.recorder import Recorder, start_of
from lrp_jupyter.live.runner import Runner, Until
from lrp_jupyter.live.running import commands as do
from lrp_jupyter.live.running.breakpoint import Breakpoint, BreakpointKind
from lrp_jupyter.live.running.breakpoints import breakpoint_of
from lrp_jupyter.live.running.checking import members_of
from lrp_jupyter.live.running.checkpoints import names_of
from lrp_jupyter.live.running.frame import Frame
from lrp_jupyter.logs import open_log, unused

__all__ = ["Session", "Until"]

_ABSENT = object()


class Session(Runner):
    """A running program with its loop, time, robot and thread.

    Parameters
    ----------
    program : Program or str
        A text that is not a valid program raises; to start from one, create an empty session and pass the
        text to :meth:`edit`.
    bridge : str, Bridge or subclass of Bridge
        A name (``"none"``, ``"sim"``, …) or a class, to which `options` are passed, or an existing bridge.
    clock : Clock, optional
        A :class:`~lrp_jupyter.live.clock.VirtualClock` never waits; by default that of the robot's world,
        where it has one (ROS's ``/clock``), else wall time at this `speed`.
    rate : float
        Ticks per second; 0 for as many as possible.
    namespace : dict, optional
        Names that blocks can read (a notebook's ``user_ns``); never written, except for `__builtins__`, as by
        ``exec``.
    on_active_edit : {"restart", "keep"}
    on_issue : {"record", "pause"}
    name : str
        Appears in tracebacks and names the threads.
    journal : int, optional
        How many ticks are remembered, and can be rewound; by default 10,000 or those of 10 minutes, whichever
        are more, and fewer if they take more than about 100 MB.
    speed : float
        Seconds of the session per wall second; ``math.inf``: never wait.
    driver : {"thread", "asyncio"}, optional
        The kind of driver after :meth:`start`; default: a thread, and in a browser, where there are none, a
        task of the running event loop.
    hung_after : float
        Wall seconds after which a block that does not return is reported.
    dead_man : float, optional
        Wall seconds without :meth:`seen` after which the program pauses.
    start : str or path, optional
        A machine (``"follower/looking/lookalgo"``) that runs instead of those that the program spawns at the
        top level; or one of its states, by default that in which the program spawns it. The machines around
        it do not run, but their variables exist.
    **options
        For the bridge: ``world="line"``.

    Raises
    ------
    LRPSyntaxError
        The text is not a valid program.
    UnknownElementError, LRPError
        There is no such machine or state to `start`, or it is not known in which state to start it.
    BridgeError
        There is no such bridge, or it does not take these options.
    TypeError, ValueError
        Another argument has a wrong type or value.

    Examples
    --------
    >>> program = "(machine m (state a) (state b) (ontime 300 a -> b)) (spawn m a)"
    >>> with Session(program) as session:
    ...     session.run(until="b", seconds=5)
    True
    """

    # -- changing the program --------------------------------------------------------------------

    def edit(self, text: str) -> tuple[Finding, ...]:
        """Continue with another text; never raises because of the text. Paper: §6.1.

        Returns
        -------
        tuple of Finding
            The findings of the checks. If the text is not a valid program, the last program keeps running.
        """
        _, answer = self.offer(text)
        try:
            self._driver.wait(answer, do.ReplaceProgram)
        except CancelledError:  # a newer edit came before this one was applied
            pass
        except LRPError as error:  # the text is kept, and applied when the block returns
            late = Finding("LRP690", "warning", str(error), 1, 1, 1, 1)
            self.findings = (*self.findings, late)
        return self.findings

    def offer(self, text: str, *cursors: Cursor) -> tuple[Judgement, Future[Any]]:
        """Continue with another text as :meth:`edit` does, without waiting until it is applied.

        Parameters
        ----------
        text : str
        *cursors : Cursor
            Where the text is being edited: what is only half typed there waits.

        Returns
        -------
        Judgement
            Its program is None if the text is not a valid program.
        Future
            Its result is the :class:`~lrp_jupyter.interpreter.patching.Patch`, or None without a program.
        """
        check_type("text", text, str, "the text of a program")
        self._driver.check_open()
        judgement = self.judge(text, *cursors)
        program, self.findings, unmeant, _ = judgement
        self._text = text
        if program is None:
            nothing: Future[Any] = Future()
            nothing.set_result(None)
            return judgement, nothing
        names_of(link(program))  # here and now, so that the loop stands still only for the swap of plans
        if unmeant is not None:
            link(unmeant.instead)
        return judgement, self._driver.ask(do.ReplaceProgram(program, unmeant))

    def offer_rename(self, kind: str, path: Path, new_name: str) -> tuple[Judgement, Future[Any]]:
        """Rename as :meth:`rename` does, without waiting until it is applied.

        Returns
        -------
        Judgement
            Of the new text.
        Future
            Its result is the new text.

        Raises
        ------
        UnknownElementError
            There is no such element.
        ValueError
            The name cannot be used.
        """
        self._driver.check_open()
        judgement = self.judge(renamed_text(self.program, kind, path, new_name))
        assert judgement.program is not None
        self._text, self.findings = judgement.program.text, judgement.findings
        return judgement, self._driver.ask(do.Rename(kind, path, new_name))

    def judge(self, text: str, *cursors: Cursor) -> Judgement:
        """Return what a text means, for the robot and the namespace of this session; nothing changes."""
        program, findings = scan(text, f"<lrp {self.name}>")
        if program is not None:
            findings = self.check(program)
        return judge(text, program, findings, cursors, self.program, self._check_again)

    def _check_again(self, program: Program) -> tuple[Finding, ...]:
        """Return the findings about a program, which probably is the one checked before."""
        members = self._robot_members()
        checked, known, findings = self._checked
        if checked is not program or known is not members:
            findings = self.check(program)
            self._checked = program, members, findings
        return findings

    def check(self, program: Program | str) -> tuple[Finding, ...]:
        """Return the findings about a program, for the robot and the namespace of this session."""
        check_type("program", program, (str, Program), "a text or a Program")
        try:
            tick = min(TICK, 1000 / self.rate) if self.rate else 0
            return check(program, self.namespace, self._robot_members(), tick)
        except Exception as error:  # a fault of the checks is reported as such and does not block the edit
            message = f"The checks themselves failed, not the program: {sentence_of(error)}"
            return (Finding("LRP699", "warning", message, 1, 1, 1, 1),)

    def _robot_members(self) -> RobotMembers:
        table, members = self._members
        if self.bridge.is_open and table is not self.bridge.nodes.table:  # a new table after every change
            table = self.bridge.nodes.table
            members = members_of(self.bridge)
            self._members = table, members
        return members

    def save(self, path: str | FilePath) -> None:
        """Write the text to a file, with its own line ends: as a whole or not at all.

        Raises
        ------
        FileError
            It cannot be written.
        """
        write_file(path, self._text)

    def rename(self, kind: str, path: str | Path, new_name: str) -> str:
        """Rename an element with all its references; nothing restarts. Return the new text.

        Raises
        ------
        UnknownElementError
            There is no such element.
        ValueError
            The name cannot be used, or the text is not the running program.
        """
        check_type("kind", kind, str, "the kind of an element, such as `state`")
        check_type("new_name", new_name, str, "a name")
        if self._text != self.program.text:
            raise ValueError(
                "The text is not the running program, so nothing can be renamed now. Correct it first."
            )
        text: str = self._driver.do(do.Rename(kind, as_path(path), new_name))
        if text:
            self._text = text
        return text

    # -- settings --------------------------------------------------------------------------------

    @property
    def rate(self) -> float:
        """Ticks per second, 0 for as many as possible; may be set at any time. Paper: §5.1."""
        return self._loop.timing.rate

    @rate.setter
    def rate(self, rate: float) -> None:
        self._driver.do(do.SetRate(rate))

    @property
    def speed(self) -> float:
        """Seconds of the session per wall second; may be set at any time."""
        return self._loop.timing.clock.speed

    @speed.setter
    def speed(self, speed: float) -> None:
        self._driver.do(do.SetSpeed(speed))

    @property
    def on_active_edit(self) -> str:
        """The effect of a change to an active state, ``restart`` or ``keep``; may be set at any time."""
        return self.interpreter.on_active_edit

    @on_active_edit.setter
    def on_active_edit(self, policy: Literal["restart", "keep"]) -> None:
        self._driver.do(do.SetPolicy("on_active_edit", policy))

    @property
    def on_issue(self) -> str:
        """The effect of an issue, whenever it occurs: ``record`` or ``pause``; may be set at any time."""
        return self.interpreter.on_issue

    @on_issue.setter
    def on_issue(self, policy: Literal["record", "pause"]) -> None:
        self._driver.do(do.SetPolicy("on_issue", policy))

    # -- forcing ---------------------------------------------------------------------------------

    def transition_to(self, state: str | Path) -> None:
        """Go to a state as if a transition led there. An unknown one is an issue. Paper: §6.4."""
        self._driver.do(do.Force(as_path(state)))

    def teleport_to(self, state: str | Path) -> None:
        """Make a state active without any action. An unknown one is an issue. Paper: §6.4."""
        self._driver.do(do.Force(as_path(state), teleport=True))

    def fire(self, transition: str | Path) -> None:
        """Go where a transition leads, whatever its condition: one of its source states must be active.

        The actions of the states on the way run, as in :meth:`transition_to`. Paper: §6.4.

        Parameters
        ----------
        transition : str or path
            Its name, label or id if that is unambiguous, else its path: ``"follower/tlooking"``.

        Raises
        ------
        UnknownElementError
            There is no such transition, or there are several.
        ValueError
            No state that it leaves is active, or it leads nowhere.
        """
        self._driver.do(do.Fire(find(self.program, "transition", transition).path))

    def set_variable(self, variable: str | Path, value: object = _ABSENT, *, evaluate: str = "") -> None:
        """Assign a value to a variable, or the value of a Python expression.

        Parameters
        ----------
        variable : str or path
            Its name if that is unambiguous, else its path: ``"follower/nobump"``.
        value : object
            The value. A text is evaluated like `evaluate`; to assign a text itself, write
            ``session.variables["name"] = "text"``.
        evaluate : str
            A Python expression, evaluated in the variable's scope.

        Raises
        ------
        UnknownElementError
            There is no such variable now, or there are several.
        """
        check_type("evaluate", evaluate, str, "a text, a Python expression")
        if (value is _ABSENT) == (not evaluate):
            raise TypeError("Pass either a value or `evaluate`, an expression.")
        expression = evaluate or value
        if isinstance(expression, str):
            self._driver.do(do.SetVariable(as_path(variable), expression))
        else:
            self._driver.do(do.Assign(as_path(variable), value))

    def rewind(self, ticks: int = 1) -> None:
        """Go back by so many ticks: program, variables, simulated world, time. What came later is gone.

        Objects that were changed in place stay as they are, and so do issues, counts, settings and the state
        of the random numbers.

        Parameters
        ----------
        ticks : int
            0 or more; with 0, what came after the last tick is undone.

        Raises
        ------
        ValueError
            Fewer ticks can be undone.
        BridgeError
            A real robot is armed.
        """
        check_type("ticks", ticks, int, "a number of ticks")
        check_number("ticks", ticks, "a number of ticks", least=0)
        before = self.program
        self._driver.do(do.Rewind(ticks))
        if self.program is not before:  # edits were undone, too
            self._text = self.program.text

    # -- breakpoints -----------------------------------------------------------------------------

    @property
    def breakpoints(self) -> tuple[Breakpoint, ...]:
        """The breakpoints, by number."""
        known = self._loop.breakpoints
        return () if known is None else self._value("breakpoints", lambda _: known.all)

    def pause_when(
        self,
        entered: str | Path | None = None,
        *,
        left: str | Path | None = None,
        fires: str | Path | None = None,
        event: str | Path | None = None,
        condition: str = "",
        machine: str | Path = (),
        after: int = 1,
        once: bool = False,
    ) -> Breakpoint:
        """Pause the program, after the tick, whenever something happens.

        Parameters
        ----------
        entered, left : str or path, optional
            A state, by bare name or path.
        fires : str or path, optional
            A transition, by its name, label or path.
        event : str or path, optional
            An event that becomes True, whether a transition waits for it or not. Its block is run once more
            in each tick, so it should only read.
        condition : str, optional
            A Python expression over the variables and ``robot`` that becomes True.
        machine : str or path
            The machine in whose scope the condition is evaluated, while it runs; by default the top level.
        after : int
            The first hit at which it pauses: 1 or more.
        once : bool
            Whether it is switched off when it has paused.

        Returns
        -------
        Breakpoint

        Raises
        ------
        UnknownElementError
            There is no such element, or there are several.
        SyntaxError
            The condition is not an expression.
        TypeError
            None of these is given, or several are; `machine` is given without `condition`.
        ValueError
            `after` is less than 1.
        """
        check_type("after", after, int, "a number of hits")
        check_number("after", after, "a number of hits", least=1)
        check_type("condition", condition, str, "a text, a Python expression")
        given: dict[BreakpointKind, str | Path | None] = {
            "entered": entered,
            "left": left,
            "fired": fires,
            "event": event,
            "condition": condition or None,
        }
        chosen = [(kind, what) for kind, what in given.items() if what is not None]
        if len(chosen) != 1:
            raise TypeError("Pass one of a state, `left`, `fires`, `event` and `condition`.")
        if machine and not condition:
            raise TypeError("`machine` is the scope of a `condition`. To name an element, pass its path.")
        new = breakpoint_of(self.program, *chosen[0], machine or (), after=after, once=once)
        added: Breakpoint = self._driver.do(do.AddBreakpoint(new))
        return added

    def set_breakpoint(self, number: int, enabled: bool | None = None, after: int | None = None) -> None:
        """Switch a breakpoint on or off, or set the first hit at which it pauses; hits are always counted.

        Parameters
        ----------
        number : int
            As :attr:`breakpoints` lists it; the first is 1.
        enabled : bool, optional
            Whether it pauses; by default as before.
        after : int, optional
            The first hit at which it pauses: 1 or more; by default as before.

        Raises
        ------
        ValueError
            There is no such breakpoint.
        """
        if after is not None:
            check_type("after", after, int, "a number of hits")
            check_number("after", after, "a number of hits", least=1)
        self._driver.do(do.ChangeBreakpoint(number, enabled if enabled is None else bool(enabled), after))

    def remove_breakpoint(self, number: int) -> None:
        """Remove a breakpoint.

        Parameters
        ----------
        number : int
            As :attr:`breakpoints` lists it.

        Raises
        ------
        ValueError
            There is no such breakpoint.
        """
        self._driver.do(do.RemoveBreakpoint(number))

    # -- recording -------------------------------------------------------------------------------

    @contextmanager
    def record(self, path: str | os.PathLike[str], *, looking: bool = False) -> Iterator[None]:
        """Write a recording of this session into a file, as long as the ``with`` block lasts.

        The session can be reproduced from it in another process: see
        :func:`~lrp_jupyter.live.reproduction.reproduce` and ``lrp replay``.

        Parameters
        ----------
        path : str or path
            ``run.lrplog``; compressed as ``run.lrplog.gz``.
        looking : bool
            Whether the recording also has what a person looks at in the pages that show the session, and the
            wall time of that and of inputs.

        Raises
        ------
        ValueError
            The session has run already.
        FileError
            The file cannot be written.
        """
        self._driver.refuse_inside("record")
        self._refuse_late_recording()  # before it would overwrite the file
        with open_log(path) as stream:
            recorder: Recorder = self.call(lambda: self.recorder(stream.write, looking=looking))
            if looking:
                self._watched_by, self.log = recorder, shown(path)
            try:
                yield
            finally:
                self._watched_by, self.log = None, ""
                if self.status == "closed":
                    recorder.end()  # nothing ticks any more
                else:
                    self.call(recorder.end)

    def keep(self, name: str = "", folder: str | os.PathLike[str] | None = None) -> FilePath:
        """Write a recording of the present run, from its beginning until now, beside the program.

        A run begins where the program begins in a world that is at its start: when the session is started,
        and after a reset of both. Its recording is an example with which the program can be run again: see
        `lrp test`.

        Parameters
        ----------
        name : str
            Of the run; by default `run`. If there is one of that name, it gets a number.
        folder : str or path, optional
            By default ``NAME.runs`` in the current folder, after the name of the session.

        Returns
        -------
        Path
            The file.

        Raises
        ------
        ValueError
            The run did not begin at a start, or that is no longer remembered; or it cannot be repeated.
        FileError
            The file cannot be written.
        """
        return questions.keep(self, name, folder)

    def record_until_closed(self, path: str | os.PathLike[str]) -> None:
        """Write a recording, with what a person looks at, until the session is closed: see `record`.

        If the file exists, the name of the recording gets a number.
        """
        self._until_closed.enter_context(self.record(unused(path), looking=True))

    def looked(self, what: str, about: str = "", on: bool = True) -> None:
        """Write into the recording that a person looks at something, or does something, if that is wanted.

        Parameters
        ----------
        what, about : str
            Its kind and subject.
        on : bool
            Whether that begins.
        """
        recorder = self._watched_by
        if recorder is not None:
            recorder.look(what, about, on)
            with suppress(SessionClosedError):
                self.ask(do.Call(recorder.write_looks))

    def recorder(
        self,
        write: Callable[[str], object],
        seed: int | None = None,
        initials: Mapping[str, str] | None = None,
        looking: bool = False,
    ) -> Recorder:
        """Begin a recording; on the loop's thread, or before it is started.

        Parameters
        ----------
        write : callable
            Receives every line.
        seed : int, optional
            That of Python's random numbers, if the caller has seeded them.
        initials : mapping of str to str, optional
            The expressions that replace initial values of the text.
        looking : bool
            See `record`.
        """
        self._refuse_late_recording()
        self.bridge.open()
        return Recorder(self._loop, write, start_of(self._loop, seed, initials), looking)

    def _refuse_late_recording(self) -> None:
        if self._loop.interpreter.tick or self._loop.record.inputs:
            raise ValueError("The session has run already. A recording begins before the first tick.")

    # -- the past, and what if -------------------------------------------------------------------

    def at(self, tick: int | float) -> Frame:
        """Return the frame of an earlier moment: active states, variables, readings, counts, the robot.

        A value that was changed in place is shown as it is now.

        Parameters
        ----------
        tick : int or float
            A tick; or a time in seconds, as a float: then the last tick that was not after it.

        Raises
        ------
        ValueError
            The tick is not, or no longer, recorded; or the time is negative.
        """
        return questions.at(self, tick)

    def animation(self, begin: int | float | None = None, end: int | float | None = None) -> str:
        """Return how the simulated world moved, as an animated SVG that repeats by itself.

        Parameters
        ----------
        begin, end : int or float, optional
            Ticks; or times in seconds, as floats. By default all that is remembered of the run in this world.

        Returns
        -------
        str
            A text for a file ``NAME.svg``, which any browser plays. Positions are true within 2 mm.

        Raises
        ------
        BridgeError
            The robot is not a simulated one, or another world was loaded in between.
        ValueError
            A tick is not, or no longer, recorded; or the end is before the beginning.
        """
        return questions.animation(self, begin, end)

    @property
    def coverage(self) -> Coverage:
        """What the run has reached of the program: states, transitions, both outcomes of each condition."""
        return self._value("coverage", lambda loop: coverage_of(loop.interpreter))

    def timeline(
        self, since: TimelineCursor | None = None, plots: Mapping[str, int] | None = None
    ) -> Timeline:
        """Return what happened, in order: states entered, edits, issues, pauses, commands, interventions.

        Parameters
        ----------
        since : TimelineCursor, optional
            The `cursor` of an earlier answer: only what came after it is returned.
        plots : mapping of str to int, optional
            Names to plot, by their whole paths, each with the tick up to which its samples are known.

        Returns
        -------
        Timeline
            Its ``happenings`` are in order; times are in seconds of the run.
        """
        return questions.timeline(self, since, plots)

    def plots(
        self, names: Iterable[str] = (), event: str | Path | None = None, seconds: float = math.inf
    ) -> list[Plot]:
        """Return the recorded samples of variables and readings, with what conditions compare them with.

        Parameters
        ----------
        names : iterable of str
            Variables by path as spawned, or by name where only one has it now; ``robot.`` and the names of
            readings.
        event : str or path, optional
            An event: then only its condition counts; without names, what that reads is returned.
        seconds : float
            The samples of the last seconds only.

        Returns
        -------
        list of Plot
            One for each name.

        Raises
        ------
        UnknownElementError
            There is no such variable, reading or event, or several have that name.
        """
        return questions.plots(self, names, event, seconds)

    def why_not(self, transition: str | Path, at: int | float | None = None) -> Reason:
        """Return why a transition did not fire in a tick, or that it did.

        Parameters
        ----------
        transition : str or path
            Its name, its label (``condition:from->to``) or its path.
        at : int or float, optional
            A tick; or a time in seconds, as a float: then the last tick that was not after it. By default
            the last tick.

        Returns
        -------
        Reason
            Printed, it is a sentence or two.

        Raises
        ------
        UnknownElementError
            There is no such transition, or there are several.
        ValueError
            The tick is not, or no longer, recorded.
        """
        return questions.answer(self, "why_not", transition, at)

    def why(self, what: str | Path, at: int | float | None = None) -> Reason:
        """Return why a state is active, or why the robot got its last command.

        Parameters
        ----------
        what : str or path
            A state (``"looking"``) or a command of the robot (``"robot.move"``).
        at : int or float, optional
            As in :meth:`why_not`.

        Returns
        -------
        Reason
            How the state was entered last, or which block gave the command and what became of it.

        Raises
        ------
        UnknownElementError
            There is no such state or command, or there are several.
        ValueError
            The tick is not, or no longer, recorded.
        """
        return questions.answer(self, "why", what, at)

    def explain(self, name: str | Path, at: int | float | None = None) -> Reason:
        """Return :meth:`why_not` for a transition, :meth:`why` for a state or a command of the robot.

        Parameters
        ----------
        name : str or path
            A transition; if there is none of that name, a state or ``robot.`` and a command.
        at : int or float, optional
            As in :meth:`why_not`.

        Returns
        -------
        Reason

        Raises
        ------
        UnknownElementError, ValueError
            As in :meth:`why_not` and :meth:`why`.
        """
        return questions.answer(self, "explain", name, at)

    def fork(
        self, at: int | float | None = None, program: str | Program | None = None, *, inputs: bool = False
    ) -> Self:
        """Return an independent copy of this session, now or after an earlier tick.

        It is paused, runs in virtual time only (:meth:`run`, :meth:`step`), and nothing that it does is
        noticed here, except what its blocks do to objects of the namespace other than numbers, texts and
        collections. With a simulated robot, or none, it goes on exactly as this session did or will, as far
        as that follows from the program and what came from outside; with any other robot it is fed the
        recorded readings. What its blocks do by themselves, past `robot`, they do once more.

        Parameters
        ----------
        at : int or float, optional
            A tick, or 0 for the beginning, with what was done before the first tick; or a time in seconds, as
            a float. By default now.
        program : str or Program, optional
            Another program, applied at once as an edit is.
        inputs : bool
            Whether what came from outside later is repeated when it runs, at the same times, as far as that
            is possible there; edits only if there is no other program.

        Raises
        ------
        ValueError
            The tick is not, or no longer, recorded. :meth:`run` raises it where the session went back to a
            tick while something stayed as it was, such as a list that was changed in place.
        SessionTimeoutError
            A tick before it cannot be repeated, because a block does not return.
        LRPSyntaxError
            The other text is not a valid program.
        """
        return questions.fork(self, at, program, inputs)

    def what_if(
        self, at: int | float | None = None, program: str | Program | None = None, seconds: float = 60.0
    ) -> WhatIf:
        """Return how another program would go on from a moment, beside how it went; nothing changes here.

        What came from outside later is repeated in both, as far as that is possible there; edits only in the
        recorded course. What blocks do by themselves, past `robot`, they do again in each.

        Parameters
        ----------
        at : int or float, optional
            A tick; or a time in seconds, as a float. By default now.
        program : str or Program, optional
            By default the one that runs now.
        seconds : float
            How long, in seconds of the run; not infinite.

        Returns
        -------
        WhatIf
            Both courses and their first difference; ``str()`` is that difference in a sentence.

        Raises
        ------
        ValueError
            The tick is not, or no longer, recorded; or what came later cannot be repeated, see :meth:`fork`.
        LRPSyntaxError
            The text is not a valid program.
        """
        return questions.what_if(self, at, program, seconds)

    def try_programs(
        self, programs: Iterable[str | Program], seconds: float = 60.0, *, at: int | float | None = None
    ) -> list[WhatIf]:
        """Run on from one moment with each of some programs, each in a fork; nothing changes here.

        What came from outside later is repeated in all, but for edits, as far as that is possible there. What
        blocks do by themselves, past `robot`, they do again in each.

        Parameters
        ----------
        programs : iterable
            Texts or programs; each is applied at once, as an edit is.
        seconds : float
            How long, in seconds of the run; not infinite.
        at : int or float, optional
            A tick; or a time in seconds, as a float. By default now.

        Returns
        -------
        list of WhatIf
            One for each program: its course beside that of the first, and their first difference.

        Raises
        ------
        ValueError
            The tick is not, or no longer, recorded; or what came later cannot be repeated, see :meth:`fork`.
        LRPSyntaxError
            A text is not a valid program.
        """
        return questions.try_programs(self, programs, seconds, at)

    def try_values(
        self,
        variable: str | Path,
        values: Iterable[object],
        seconds: float = 60.0,
        until: Until | None = None,
        outcome: Callable[[Session], object] | None = None,
        *,
        at: int | float | None = None,
    ) -> Trials:
        """Run on from one moment with different values of a variable, each in a fork; nothing changes here.

        What blocks do by themselves, past `robot`, they do again in each fork.

        Parameters
        ----------
        variable : str or path
            A variable that exists at that moment.
        values : iterable
        seconds : float
            How long each run lasts at most, in seconds of the run; infinite only with `until`.
        until : str, path or callable, optional
            A state, or a condition on the frame, that ends a run; the time until then is part of the result.
        outcome : callable, optional
            Called with the fork at the end of its run; the result is shown.
        at : int or float, optional
            A tick; or a time in seconds, as a float. By default now.

        Returns
        -------
        Trials
            One :class:`~lrp_jupyter.live.past.trials.Trial` for each value; a notebook shows a table.

        Raises
        ------
        UnknownElementError
            There is no such variable, or the program has no such state.
        ValueError
            The tick is not, or no longer, recorded.
        """
        return questions.try_values(self, variable, values, seconds, until, outcome, at)
