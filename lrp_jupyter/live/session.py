"""A program that runs, and can be talked to.

The interpreter is a function of time: no clock, no thread, no robot. All of these are here, in
four parts that know little of each other:

* the :class:`~lrp_jupyter.live.loop.Loop` ticks, lets time pass, and carries out commands between
  two ticks;
* a driver turns the loop: a thread, asyncio, or the caller of :meth:`Session.run`; a second
  thread, the :class:`~lrp_jupyter.live.monitor.Monitor`, watches the first;
* :class:`~lrp_jupyter.live.turns.Turns` settles who may turn the loop, and waits for commands;
* the :class:`Session`, this file, is what everyone else holds. It may be called from any thread.

*In.* A call on a session becomes a command, a frozen value in a queue; the loop carries it out
between two ticks, as a whole. The caller waits for that, a second at most: then an error says
which block holds things up, and the command stays in the queue. ``submit`` does not wait. Who
calls from inside a block of the program itself does not wait either, for the block would wait for
its own end. With no driver at work the caller carries the command out itself.

*Out.* After a tick the loop makes a frozen frame and the session stores it by one assignment.
Whoever looks gets the newest; what must not be missed is counted in it. No view ever touches the
interpreter.

*Edits.* Checking a text is the caller's work, so that a keystroke costs the robot nothing. A text
that is no program is kept, and the last program runs on. What runs is :attr:`Session.program`,
what was typed is :attr:`Session.text`.

*Whose fault.* Faults of the program are issues, and nothing stops. A fault of this package stops
the robot and the session, which then is ``broken`` and keeps the traceback; it never looks like a
fault of the program. A bridge that fails is ``lost``, and the loop goes on.

*The end.* ``close`` stops the robot first, then ends and joins the threads; it may be called
twice. What is still open when Python exits is closed then.

Paper: §5.1 (the loop and its rate), §6 (live programming), §6.3 (pause), §6.4 (forcing states).
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import CancelledError, Future
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any, Literal

from lrp_jupyter.errors import LRPError
from lrp_jupyter.interpreter.linker import link
from lrp_jupyter.language.checks import check
from lrp_jupyter.language.parser import parse, scan
from lrp_jupyter.language.program import Finding, Path, Program
from lrp_jupyter.live import commands as do
from lrp_jupyter.live.running import Condition, Running

if TYPE_CHECKING:
    from lrp_jupyter.bridges.bridge import Bridge
    from lrp_jupyter.interpreter.events import Observer
    from lrp_jupyter.live.clock import Clock

__all__ = ["Condition", "Session"]


class Session(Running):
    """A running program with its loop, time, robot and thread.

    Parameters
    ----------
    program : Program or str
        A text that is no program raises; a session that shall begin with one starts empty and is
        given the text by :meth:`edit`.
    bridge : str or Bridge
        By name (``"none"``, ``"sim"``, …; `options` go to it), or one that was made.
    clock : Clock, optional
        A :class:`~lrp_jupyter.live.clock.VirtualClock` never waits; unless given, wall time.
    rate : float
        Ticks per second; 0 for as many as possible.
    namespace : dict, optional
        Names that blocks see (a notebook's ``user_ns``), used as it is, never written into.
    on_active_edit : {"restart", "keep"}
    on_issue : {"record", "pause"}
    name : str
        Appears in tracebacks and names the threads.
    journal : int
        Ticks that can be taken back.
    speed : float
        Seconds of the session per second of the wall; ``math.inf``: never wait.
    driver : {"thread", "asyncio"}
        Who turns the loop after :meth:`start`.
    hung_after : float
        Wall seconds after which a block that does not return is reported.
    dead_man : float, optional
        Wall seconds without :meth:`seen` after which the program pauses.
    **options
        For the bridge: ``world="line"``.

    Raises
    ------
    LRPSyntaxError
        The text is no program.
    BridgeError
        There is no such bridge.
    """

    def __init__(
        self,
        program: Program | str = "",
        bridge: str | Bridge = "none",
        clock: Clock | None = None,
        rate: float = 10,
        *,
        name: str = "lrp",
        **options: Any,
    ) -> None:
        first = parse(program, f"<lrp {name}>") if isinstance(program, str) else program
        self._text = first.text
        self.findings: tuple[Finding, ...] = ()
        """What the checks had to say about the last edit."""
        super().__init__(first, bridge, clock, rate, name=name, **options)

    @property
    def text(self) -> str:
        """The text as it was last given, whether it is a program or not."""
        return self._text

    # -- changing the program --------------------------------------------------------------------

    def edit(self, text: str) -> tuple[Finding, ...]:
        """Go on with another text; never raises on account of it. Paper: §6.1.

        Returns
        -------
        tuple of Finding
            What the checks have to say. If the text is no program, the last program runs on.
        """
        program = self._read(text)
        if program is not None:
            try:
                self._do(do.Edit(program))
            except CancelledError:  # a newer edit came before this one was looked at
                pass
            except LRPError as error:  # the text is kept, and applied when the block returns
                late = Finding("LRP690", "warning", str(error), 1, 1, 1, 1)
                self.findings = (*self.findings, late)
        return self.findings

    def offer(self, text: str) -> tuple[Program | None, Future[Any]]:
        """Go on with another text as :meth:`edit` does, without waiting until it is applied.

        Returns
        -------
        Program or None
            None if the text is no program; :attr:`findings` says why.
        Future
            Gives the :class:`~lrp_jupyter.interpreter.patching.Patch`, or None where there is no program.
        """
        program = self._read(text)
        if program is not None:
            return program, self.ask(do.Edit(program))
        nothing: Future[Any] = Future()
        nothing.set_result(None)
        return None, nothing

    def _read(self, text: str) -> Program | None:
        self._check_open()
        program, findings = scan(text, f"<lrp {self.name}>")
        self._text = text
        self.findings = findings if program is None else self._check(program)
        if program is not None:
            link(program)  # here and now, so that the loop stands still only for the swap of plans
        return program

    def _check(self, program: Program) -> tuple[Finding, ...]:
        try:
            return check(program, self.namespace)
        except Exception as error:  # a fault of the checks, told as such; it holds up no edit
            message = f"the checks themselves failed, not the program: {type(error).__name__}: {error}"
            return (Finding("LRP699", "warning", message, 1, 1, 1, 1),)

    def save(self, path: str | FilePath) -> None:
        """Write the text to a file, line ends as they are."""
        FilePath(path).write_bytes(self._text.encode())

    def rename(self, kind: str, path: str | Path, new_name: str) -> str:
        """Rename an element with all its references; nothing restarts. Return the new text.

        Raises
        ------
        UnknownElementError
            There is no such element.
        ValueError
            The name cannot be had, or the text is no program at the moment.
        """
        if self._text != self.program.text and any(f.severity == "error" for f in self.findings):
            raise ValueError("the text is not a program at the moment: nothing can be renamed in it")
        text: str = self._do(do.Rename(kind, _path(path), new_name))
        if text:
            self._text = text
        return text

    @property
    def on_active_edit(self) -> str:
        """``restart`` or ``keep``: what a change to an active state does; may be set at any time."""
        return self.interpreter.on_active_edit

    @on_active_edit.setter
    def on_active_edit(self, policy: Literal["restart", "keep"]) -> None:
        self._do(do.SetPolicy("on_active_edit", policy))

    @property
    def on_issue(self) -> str:
        """``record`` or ``pause``: what a new issue does; may be set at any time."""
        return self.interpreter.on_issue

    @on_issue.setter
    def on_issue(self, policy: Literal["record", "pause"]) -> None:
        self._do(do.SetPolicy("on_issue", policy))

    # -- forcing ---------------------------------------------------------------------------------

    def transition_to(self, state: str | Path) -> None:
        """Go to a state as if a transition led there. An unknown one is an issue. Paper: §6.4."""
        self._do(do.Force(_path(state)))

    def teleport_to(self, state: str | Path) -> None:
        """Be in a state; no action runs. An unknown one is an issue. Paper: §6.4."""
        self._do(do.Force(_path(state), teleport=True))

    def set_variable(self, variable: str | Path, expression: str) -> None:
        """Assign the value of a Python expression, evaluated in the variable's scope.

        Raises
        ------
        UnknownElementError
            The variable does not live now.
        """
        self._do(do.SetVariable(_path(variable), expression))

    def rewind(self, ticks: int = 1) -> None:
        """Go back by so many ticks: program, simulated world, time.

        Raises
        ------
        ValueError
            There are not so many.
        BridgeError
            A real robot is armed.
        """
        before = self.program
        self._do(do.Rewind(ticks))
        if self.program is not before:  # edits were taken back, too
            self._text = self.program.text

    def call(self, function: Callable[[], Any]) -> Any:
        """Call a function between two ticks, where the robot's world may be touched."""
        return self._do(do.Call(function))

    def observe(self, observer: Observer) -> Callable[[], None]:
        """Have every event told to a function, on the driver's thread; returns how to end it."""
        unsubscribe: Callable[[], None] = self._do(do.Call(lambda: self.interpreter.observe(observer)))
        return unsubscribe


def _path(path: str | Path) -> Path:
    return tuple(path.split("/")) if isinstance(path, str) else tuple(path)
