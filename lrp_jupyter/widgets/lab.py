"""The lab and its parts as widgets: one class, whose `view` trait says which part a page shows.

Page and kernel communicate by custom messages; traits hold only what a page needs to begin. The session's
:class:`~lrp_jupyter.widgets.connection.PageConnection` handles the messages.
"""

from __future__ import annotations

import os
import re
import sys
import threading
from collections.abc import Callable, Sequence
from pathlib import Path as FilePath
from types import NoneType
from typing import Any, ClassVar, get_args
from weakref import WeakValueDictionary

import anywidget
import traitlets
from comm.base_comm import BaseComm
from traitlets.utils.bunch import Bunch

from lrp_jupyter import programs
from lrp_jupyter.arguments import check_choice, check_type
from lrp_jupyter.grading.challenges import Challenge
from lrp_jupyter.grading.challenges import load as load_challenge
from lrp_jupyter.interpreter.issues import Issue
from lrp_jupyter.language.parser import scan
from lrp_jupyter.language.program import Path, Program
from lrp_jupyter.live.running.frame import Frame
from lrp_jupyter.live.running.live_variables import LiveVariables
from lrp_jupyter.live.session import Session
from lrp_jupyter.widgets import registry
from lrp_jupyter.widgets.connection import PageConnection
from lrp_jupyter.widgets.hosts import is_static, is_voila
from lrp_jupyter.widgets.text.conditions import Conditions, given
from lrp_jupyter.widgets.text.kept import Version
from lrp_jupyter.widgets.views.program_picture import bitmap, still
from lrp_jupyter.widgets.wire.own_comm import OwnComm
from lrp_jupyter.widgets.wire.packing import packed, unpacked
from lrp_jupyter.widgets.wire.protocol import Edits, GraphMode, Hints, OnActiveEdit

_NAME = re.compile(r"[\w-]+")
"""The name of a program: no text is one word, because a program has parentheses."""
_OURS = "lrp_jupyter"
"""The key of the metadata of an output, which the page and `lrp grade` read."""
_STATIC = FilePath(__file__).parents[1] / "static"


class Part(anywidget.AnyWidget):
    """A part of the lab of one session.

    Parameters
    ----------
    session : Session, str or Lab
        The session, the name of an open program, or another part of the same lab.
    """

    _esm = _STATIC / "lab.js"
    _css = _STATIC / "lab.css"
    view = traitlets.Unicode("lab").tag(sync=True)
    part: ClassVar[str] = "lab"
    """The part of the lab that a page shows."""
    comm: Any
    reports = traitlets.Bool(False).tag(sync=True)
    """Whether the page sets `reported` when the run has changed, at most four times a second."""
    reported = traitlets.Float(0.0).tag(sync=True)

    def __init_subclass__(cls, part: str = "", **options: Any) -> None:
        super().__init_subclass__(**options)
        cls.part = part or cls.part

    def __init__(self, session: Session | Part | str) -> None:
        check_type("session", session, (Session, Part, str), "a Session, a Lab or the name of a program")
        if isinstance(session, str):
            session = registry.named(session).session
        if isinstance(session, Part):
            session = session.session
        self._connect(registry.connection_of(session))

    def _connect(self, connection: PageConnection) -> None:
        super().__init__(view=self.part, reports=_runs_cells_again())
        self._connection = connection
        self._cells = None if is_voila() else threading.get_ident()  # under Voila, all of them have run
        self._noticed = connection.session.frame
        self.on_msg(self._receive)

    def open(self) -> None:
        """Open the connection to pages, unless the notebook is executed without one."""
        if is_static():
            return
        super().open()
        if isinstance(self.comm, BaseComm):  # that of a kernel
            self.comm = OwnComm(self.comm)

    def __del__(self) -> None:
        """Do nothing: a widget that is garbage collected does not stop a robot."""

    def _receive(self, _widget: object, content: Any, _buffers: object) -> None:
        waits = threading.get_ident() == self._cells  # like the cell that created this widget
        self._connection.receive(self._publish, unpacked(content), waits)

    def _publish(self, message: Any, buffers: list[bytes] | None) -> None:
        self.send({"json": packed(message)}, buffers)

    @property
    def session(self) -> Session:
        """The session that is shown; a change of bridge opens a new one."""
        return self._connection.session

    @property
    def frame(self) -> Frame:
        """What runs now, frozen: `status`, `tick`, `time`, `active`, `variables` and more.

        In marimo, cells that use a lab run again when its active states, variables, issues, status or
        revision change; everywhere a function that observes ``"frame"`` is called then. Both happen at most
        four times a second, and while a page shows the lab.
        """
        return self.session.frame

    def observe(
        self,
        handler: Callable[..., Any],
        names: Any = traitlets.All,
        type: str = "change",  # noqa: A002 (its name in traitlets)
    ) -> None:
        """Call a function when a trait changes, or `frame`."""
        super().observe(handler, names, type)
        if names == "frame" or (isinstance(names, (list, tuple)) and "frame" in names):
            self.reports = True

    @traitlets.observe("reported")
    def _notice(self, _change: object) -> None:
        frame = self.frame
        self.notify_change(Bunch(name="frame", type="change", owner=self, old=self._noticed, new=frame))
        self._noticed = frame

    def _repr_mimebundle_(self, **options: Any) -> tuple[dict[str, Any], dict[str, Any]] | None:
        pictures, about = _pictures(self._connection), {_OURS: _about(self._connection)}
        if self.comm is None:
            return {**pictures, **bitmap(pictures["image/svg+xml"])}, about
        shown = super()._repr_mimebundle_(**options)
        if shown is None:
            return None
        bundle, metadata = shown if isinstance(shown, tuple) else (shown, {})
        about[_OURS]["widget"] = self.model_id
        return {**bundle, **pictures}, {**metadata, **about}

    def snapshot(self) -> None:
        """Store a picture of the present state as the output, to be viewed without a kernel."""
        from IPython.display import display

        self._connection.publish()  # an edit made a moment ago is in the picture
        display(_pictures(self._connection), raw=True)  # type: ignore[no-untyped-call]


class Lab(Part):
    """A program, alive in a notebook cell: editor, graphs, robot, variables, issues, controls.

    It runs at once; on hardware it opens disarmed. A second lab of the same name shows, and patches, the
    same running program.

    What is typed is kept in the folder ``.lrp`` beside the notebook; if the kept text differs from the given
    one, the given one runs and the lab asks which to keep. The environment variable ``LRP_KEEP`` says where
    texts are kept: ``notebook`` (there), ``user`` (in the user's state folder, where several people share the
    folder) or ``nothing``. Nothing is kept by default under Voila, nor in a folder on a JupyterHub outside of
    the user's home, in which texts are kept as with ``user``.

    In a notebook that is executed by nbconvert, papermill or the like, the output is a picture and the
    program's text; ``LRP_STATIC`` set to ``1`` or ``0`` decides otherwise.

    Parameters
    ----------
    program : str, Program or Session
        A text, the name of a bundled or open program, or an existing session. A text that is not a valid
        program is shown with its errors.
    bridge : str, optional
        Default: the simulator.
    name : str, optional
        The name of the program; default: that of its first machine.
    rate : float, optional
        Ticks per second.
    on_active_edit : {"restart", "keep"}, optional
        What an edit does that changes an active state.
    namespace : dict, optional
        Names that blocks can read; default: those of a Jupyter notebook. Elsewhere pass ``globals()``.
    challenge : str or Challenge, optional
        Its name, or a Python file that registers one. The lab opens the challenge's world and shows its
        goal; without a text it begins with that of the challenge.
    edits, graph, quiet, lock : optional
        The conditions of a study, as in `set_conditions`; if none is given, they stay as they are.
    hints : {"sentences", "changes"}
        For a challenge: whether the lab only says what went wrong, or also finds the smallest changes with
        which the program passes. That gives answers away; without a challenge it is always offered.
    runs : str or path, optional
        A folder of recordings that are run again after every edit, beside those in ``NAME.runs``.
    log : str or path, optional
        A file, such as ``"participant-07.lrplog"``: the session is recorded in it until it is closed, and
        also what a person looks at in the pages that show it, which say so. If it exists, the name gets a
        number.
    **options
        For the bridge: ``world="line"``.

    Raises
    ------
    BridgeError
        There is no such bridge, or its robot cannot be reached.
    LRPError
        There is no such program or challenge.

    Notes
    -----
    In marimo, have two names: one for the lab, and one for what other cells depend on::

        program = lrp_jupyter.Lab("follower", namespace=globals())
        lab = mo.ui.anywidget(program)
        lab

    A cell that uses ``lab.frame.active`` runs again whenever the active states change; a cell that uses
    ``program``, for example ``lrp_jupyter.StateGraph(program)``, does not. ``program.text`` is the text in
    the editor; ``lab.text`` is what marimo draws. The folder ``hosts`` of the notebooks has an example.
    """

    def __init__(
        self,
        program: str | Program | Session = "",
        bridge: str | None = None,
        *,
        name: str | None = None,
        rate: float | None = None,
        on_active_edit: OnActiveEdit | None = None,
        namespace: dict[str, Any] | None = None,
        challenge: str | Challenge | None = None,
        edits: Edits | None = None,
        graph: GraphMode | None = None,
        quiet: bool | None = None,
        lock: bool | None = None,
        hints: Hints = "sentences",
        runs: str | os.PathLike[str] | None = None,
        log: str | os.PathLike[str] | None = None,
        **options: Any,
    ) -> None:
        check_type("program", program, (str, Program, Session), "a text, a Program or a Session")
        task = load_challenge(challenge) if isinstance(challenge, str) else challenge
        check_type("challenge", task, (Challenge, NoneType), "a Challenge or its name")
        check_choice("hints", hints, get_args(Hints))
        conditions = given(edits=edits, graph=graph, quiet=quiet, lock=lock)
        if isinstance(program, Session):
            if log is not None:
                program.record_until_closed(log)
            connection = registry.connection_of(program)
            if runs is not None:
                connection.runs.attach_folder(runs)
            if conditions is not None:
                connection.texts.set_conditions(conditions)
                connection.wake()
            self._connect(connection)
            return
        text: str | None = program.text if isinstance(program, Program) else program
        if isinstance(program, str) and registry.find(program) is not None:
            name, text = name or program, None
        elif isinstance(program, str) and _NAME.fullmatch(program):
            name, text = name or program, programs.load(program)
        names = _notebook() if namespace is None else namespace
        if task is not None and not text:
            name = name or task.name.replace(" ", "-")
        connection = registry.open_program(
            name or _name_of(text or ""),
            text,
            bridge,
            namespace=names,
            rate=rate,
            on_active_edit=on_active_edit,
            task=task,
            conditions=conditions,
            hints=hints,
            runs=runs,
            log=log,
            **options,
        )
        self._connect(connection)

    @property
    def program(self) -> Program:
        """The running program."""
        return self.session.program

    @property
    def text(self) -> str:
        """The text in the editor, whether it runs or not."""
        return self._connection.texts.text

    @text.setter
    def text(self, text: str) -> None:
        self._connection.texts.write(text)
        self._connection.saver.save()

    @property
    def versions(self) -> list[Version]:
        """The last ten texts that were replaced and not empty, the newest first; see `text`.

        ``lab.text = lab.versions[0].text`` returns to the newest of them.
        """
        return list(self._connection.texts.versions)

    @property
    def active(self) -> tuple[Path, ...]:
        """The paths of the innermost active states."""
        return self.session.frame.active

    @property
    def issues(self) -> Sequence[Issue]:
        """The faults of the program so far."""
        return self.session.issues

    @property
    def variables(self) -> LiveVariables:
        """The existing variables, by path (``"follower/nobump"``) or by an unambiguous name.

        Assigning sets the value between two ticks: ``lab.variables["nobump"] = True``.
        """
        return self.session.variables

    @property
    def conditions(self) -> Conditions:
        """The conditions of a study: `edits`, `graph`, `quiet` and `lock`; see `set_conditions`."""
        return self._connection.texts.conditions

    def set_conditions(
        self, *, edits: Edits = "live", graph: GraphMode = "live", quiet: bool = False, lock: bool = False
    ) -> None:
        """Set all conditions of a study; those that are left out get their defaults.

        Every page that shows the program obeys them, even after a reload.

        Parameters
        ----------
        edits : str
            ``"live"``: edits take effect as they are typed; ``"hold"``: when **Apply** is chosen.
        graph : str
            ``"live"``: the state graph follows the program and its run; ``"static"``: it is drawn when
            **Redraw** is chosen, and shows nothing of the run; ``"hidden"``: neither the graph nor the tree
            of machines is shown.
        quiet : bool
            Whether nothing of the run is shown outside of the graph by itself: no active line, fired
            transition or value in the text, no active state in the tree, no variables, no timeline.
        lock : bool
            Whether the page refuses to change this. A cell can still do so.
        """
        self._connection.texts.set_conditions(Conditions(edits, graph, quiet, lock))
        self._connection.wake()

    @property
    def fault(self) -> str:
        """The last traceback of the lab itself, or an empty text."""
        return self._connection.fault or self.session.fault

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the text to a file, as a whole or not at all.

        Raises
        ------
        FileError
            It cannot be written.
        """
        self._connection.saver.save_as(path, replace=True)

    def close(self) -> None:
        """Stop robot, program and threads, and close the page's connection. A second call does nothing."""
        registry.forget(self._connection)
        super().close()

    def __repr__(self) -> str:
        return f"<Lab of {self.session!r}>"


_labs: WeakValueDictionary[PageConnection, Lab] = WeakValueDictionary()


def lab_of(connection: PageConnection) -> Lab:
    """Return the lab in which the cells of a program show it: the same one whenever they run again.

    Kernel and page keep every widget until it is closed, so one for each run would cost more and more memory.
    """
    lab = _labs.get(connection)
    if lab is None or lab.comm is None:
        lab = _labs[connection] = Lab(connection.session)
    return lab


class StateGraph(Part, part="graph"):
    """The state graph of a session."""


class SimView(Part, part="world"):
    """The world of a session's robot, or the panel of its bridge."""


class Editor(Part, part="editor"):
    """The program's text."""


class Variables(Part, part="variables"):
    """The variables, live."""


class Issues(Part, part="issues"):
    """Findings, issues and output."""


class Controls(Part, part="controls"):
    """Run, pause, step, reset, stop; rate, speed, bridge."""


class Tree(Part, part="tree"):
    """The machines, nested as in the program."""


def _runs_cells_again() -> bool:
    """Return whether the notebook runs cells again when a value that they use has changed."""
    marimo = sys.modules.get("marimo")
    return marimo is not None and bool(marimo.running_in_notebook())


def _notebook() -> dict[str, Any] | None:
    from IPython.core.getipython import get_ipython

    shell = get_ipython()
    return None if shell is None else shell.user_ns


def _name_of(text: str) -> str:
    program, _ = scan(text)
    return (program.main if program is not None else "") or "program"


def _pictures(connection: PageConnection) -> dict[str, str]:
    """Return what a saved notebook shows where no kernel runs: a picture; as plain text the program."""
    picture = still(connection.session, connection.view_state())
    return {"image/svg+xml": picture, "text/plain": connection.texts.text}


def _about(connection: PageConnection) -> dict[str, str]:
    """Return the metadata of an output: which program it shows, for graders its challenge, too."""
    goal = connection.goal
    return {"program": connection.name, **({} if goal is None else {"challenge": goal.task.name})}
