"""The text of one version of an open file, and all that is known about it, read when it is asked for."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from pathlib import Path

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.editors.checked_robot import bridge_for
from lrp_jupyter.editors.text_positions import TextPositions
from lrp_jupyter.errors import Finding, LRPError
from lrp_jupyter.language.checks import check
from lrp_jupyter.language.edits.form_places import Sheet, WrittenForm
from lrp_jupyter.language.edits.rename import Mention, Symbol, symbols
from lrp_jupyter.language.parser import scan, sketch
from lrp_jupyter.language.program import Program
from lrp_jupyter.language.reading.matching import matched
from lrp_jupyter.language.reading.tokens import Token, coloured_parts
from lrp_jupyter.language.resolution import Resolution, resolve
from lrp_jupyter.language.robot_members import RobotMembers
from lrp_jupyter.live.running.checking import members_of
from lrp_jupyter.programs import Heading, heading, world_of


class AssumedRobot:
    """The robot for which a file is checked: the one that was named, or that of its heading."""

    def __init__(self, named: Bridge | None, folder: Path | None) -> None:
        self._named, self._folder = named, folder
        self._heading: Heading | None = None
        self.bridge: Bridge | None = named
        self.problem = ""  # why the heading names a world that no program may name
        self.members: RobotMembers | None = None if named is None else members_of(named)

    def read(self, text: str) -> AssumedRobot:
        """Look for the robot again, if it may be another one."""
        found = heading(text)
        if self._named is None and found != self._heading:
            self._heading, self.problem = found, ""
            try:
                world_of(text, self._folder)
            except LRPError as error:
                self.problem = str(error)
            self.bridge = bridge_for(text, self._folder)
            self.members = None if self.bridge is None else members_of(self.bridge)
        return self


class ProgramText:
    """One version of a text."""

    def __init__(self, text: str, version: int | None, encoding: str, robot: AssumedRobot) -> None:
        self.text = text
        self.version = version
        self.at = TextPositions(text, encoding)
        self.robot = robot

    @cached_property
    def scanned(self) -> tuple[Program | None, tuple[Finding, ...]]:
        """The program, or its errors."""
        return scan(self.text)

    @property
    def program(self) -> Program | None:
        """The program; None while the text has errors."""
        return self.scanned[0]

    @cached_property
    def sketched(self) -> Program:
        """The program, or as much of it as there is."""
        return self.program or sketch(self.text)

    @property
    def names(self) -> Resolution:
        """Its names."""
        return resolve(self.sketched)

    @cached_property
    def tokens(self) -> list[Token]:
        """Its tokens, with brackets that match."""
        return matched(self.text)

    @property
    def parts(self) -> Iterator[Token]:
        """Its tokens as they are coloured."""
        return coloured_parts(self.text, self.tokens)

    @cached_property
    def root(self) -> WrittenForm:
        """The forms of the text; those that are not closed end where they probably do."""
        return Sheet(self.text, self.tokens).root

    @cached_property
    def symbols(self) -> tuple[list[Symbol], list[Mention]]:
        """Every element with a name, and every place that names one."""
        return symbols(self.sketched)

    def symbol(self, offset: int) -> Symbol | None:
        """Return the element that is named at an offset."""
        for symbol in self.symbols[0]:
            if any(start <= offset <= end for start, end in (symbol.definition, *symbol.references)):
                return symbol
        return None

    def span(self, symbol: Symbol, offset: int) -> tuple[int, int]:
        """Return where the name of an element stands that includes an offset."""
        spans = (symbol.definition, *symbol.references)
        return next(span for span in spans if span.start <= offset <= span.end)

    @cached_property
    def findings(self) -> tuple[Finding, ...]:
        """What `lrp check` says about it."""
        program, errors = self.scanned
        return errors if program is None else check(program, robot=self.robot.read(self.text).members)

    def check(self, text: str) -> tuple[Finding, ...]:
        """Return what it says about another text."""
        return check(text, robot=self.robot.read(text).members)
