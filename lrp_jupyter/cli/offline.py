"""``lrp check | format | graph``: commands that read a program, print a result and end."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

import typer
from rich.text import Text

from lrp_jupyter import programs
from lrp_jupyter.bridges.discovery import choose_bridge, make_bridge
from lrp_jupyter.cli.console import plain_console
from lrp_jupyter.cli.excerpt import finding_text, print_findings, summary
from lrp_jupyter.cli.program_source import Source, read_source
from lrp_jupyter.cli.run_options import check_outputs, pairs_of
from lrp_jupyter.codes import address_of
from lrp_jupyter.editors.certain_fixes import apply_fixes
from lrp_jupyter.editors.checked_robot import members_for
from lrp_jupyter.errors import FileError, LRPError, LRPSyntaxError
from lrp_jupyter.files import write_file
from lrp_jupyter.language.checks import check
from lrp_jupyter.language.edits.format import formatted
from lrp_jupyter.language.lookup import find
from lrp_jupyter.language.parser import scan
from lrp_jupyter.language.program import Finding, Program
from lrp_jupyter.language.robot_members import RobotMembers
from lrp_jupyter.live.running.checking import DEFAULT_WORLD, members_of

Format = Literal["svg", "dot", "mermaid", "json"]
ABOUT_ROBOTS = frozenset({"LRP520", "LRP521", "LRP522", "LRP523", "LRP524", "LRP525", "LRP526", "LRP537"})
_SUFFIXES: dict[str, Format] = {
    ".svg": "svg",
    ".dot": "dot",
    ".gv": "dot",
    ".mmd": "mermaid",
    ".json": "json",
}


def check_files(
    files: Sequence[str],
    as_json: bool,
    fix: bool = False,
    bridge: str | None = None,
    options: Sequence[str] = (),
) -> int:
    """Print the findings of files, with `fix` after applying the certain fixes; return the exit code.

    `options`: of the bridge, ``KEY=VALUE``.
    """
    if options and bridge is None:
        raise typer.BadParameter("--option is for a robot. Name it, as in `--bridge ros`.")
    robot = None
    if bridge is not None:
        made = make_bridge(choose_bridge(bridge), **dict(pairs_of(options, "--option")))
        made.alone = True
        robot = members_of(made)
    console, complaints = plain_console(), plain_console(stderr=True)
    found: list[Finding] = []
    assumed: list[Finding] = []  # for a robot that was not named
    lines: list[dict[str, Any]] = []
    unreadable = False
    for file in files:
        try:
            source = read_source(file)
            if fix:
                source, done = _fixed(source, robot)
                (complaints if as_json else console).print(done, end="")
            findings = _check(source, robot)
        except LRPError as error:  # it cannot be read, or its heading names what it may not
            complaints.print(f"lrp: {error}")
            unreadable = True
            continue
        found += findings
        if robot is None and not (source.world or programs.heading(source.text).challenge):
            assumed += findings
        for finding in findings:
            lines.append(_as_dict(source.name, finding))
            if not as_json:
                console.print(finding_text(source.name, source.text, finding))
        if not (findings or as_json):
            console.print(f"{source.name}: no findings")
    if as_json:
        json.dump(lines, sys.stdout, ensure_ascii=False, indent=2)
        sys.stdout.write("\n")
    elif found:
        console.print(f"{summary(found)}. More about a code: lrp explain {found[0].code}")
        if assumed and any(finding.code in ABOUT_ROBOTS for finding in assumed):
            console.print(
                f"Checked for the simulated robot of the world `{DEFAULT_WORLD}`. For another one, write its "
                "world into the first line, as in `; world: maze`, or choose a robot with `--bridge`."
            )
    return 2 if unreadable else int(any(finding.severity == "error" for finding in found))


def _check(source: Source, robot: RobotMembers | None) -> tuple[Finding, ...]:
    """Return the findings of a file, for a robot or, by default, the one with which `lrp run` runs it."""
    return check(source.text, robot=robot or members_for(source.text, source.path and source.path.parent))


def _fixed(source: Source, robot: RobotMembers | None) -> tuple[Source, Text]:
    """Apply the certain fixes of a file, one after the other; return it, and what was done."""
    path, done = _writable(source), Text()
    steps = list(apply_fixes(source.text, lambda text: _check(source._replace(text=text), robot)))
    for _, finding in steps:
        done.append(f"{source.name}:{finding.line}:{finding.column}: ", "bold")
        done.append("fixed", "green")
        title = finding.fix.title if finding.fix else ""
        done.append(f" {finding.code}: {finding.message} ({title})\n")
    if steps:
        source = source._replace(text=steps[-1][0])
        write_file(path, source.text)
    return source, done


def _writable(source: Source) -> Path:
    """Return the file of a source, or raise: a bundled program and standard input have none."""
    if source.path is not None:
        return source.path.resolve()
    if source.name in programs.names():
        remedy = f"`lrp programs --show {source.name} > mine.lrp` makes a file of it."
        raise FileError(f"`{source.name}` is a bundled program, which cannot be changed. {remedy}")
    raise FileError("Standard input cannot be changed. Name a file.")


def _as_dict(name: str, finding: Finding) -> dict[str, Any]:
    fix = finding.fix
    return {
        "file": name,
        "code": finding.code,
        "address": address_of(finding.code),
        "severity": finding.severity,
        "message": finding.message,
        "line": finding.line,
        "column": finding.column,
        "end_line": finding.end_line,
        "end_column": finding.end_column,
        "fix": fix and {"title": fix.title, "edits": [edit._asdict() for edit in fix.edits]},
    }


def format_files(files: Sequence[str], only_check: bool = False) -> int:
    """Format files, or list those that would change; return the exit code."""
    console, complaints = plain_console(), plain_console(stderr=True)
    code = 0
    for file in files:
        try:
            source = read_source(file)
            text = formatted(source.text)
            changes = text != source.text
            if file == "-" and not only_check:
                sys.stdout.write(text)
            elif changes:
                if not only_check:
                    write_file(_writable(source), text)
                code = max(code, int(only_check))
                console.print(f"{source.name}: {'would be formatted' if only_check else 'formatted'}")
        except LRPSyntaxError as error:
            print_findings(source.name, source.text, error.findings)
            code = max(code, 1)
        except FileError as error:
            complaints.print(f"lrp: {error}")
            code = 2
    return code


def draw_graph(file: str, machine: str | None, kind: Format | None, output: Path | None) -> int:
    """Write the graph of a file; return the exit code."""
    if kind is None:
        kind = _kind_of(output)
    elif output is not None:
        check_outputs([output], [*(suffix for suffix, each in _SUFFIXES.items() if each == kind), ".txt", ""])
    source = read_source(file)
    program, findings = scan(source.text, source.name)
    if program is None:
        print_findings(source.name, source.text, findings)
        return 1
    picture = _rendered(program, machine, kind)
    if output is None:
        sys.stdout.write(picture)
    else:
        write_file(output, picture)
    return 0


def _kind_of(output: Path | None) -> Format:
    """Return the format of a file to write, by its suffix; without one, SVG."""
    if output is None or not output.suffix:
        return "svg"
    kind = _SUFFIXES.get(output.suffix.lower())
    if kind is None:
        raise LRPError(
            f"A graph cannot be written as `{output.suffix}`. Name the file `{output.stem}.svg`, `.dot`, "
            "`.mmd` or `.json`, or choose a `--format`."
        )
    return kind


def _rendered(program: Program, machine: str | None, kind: Format) -> str:
    path = None if machine is None else find(program, "machine", machine).path
    from lrp_jupyter.graph.state_graph import find_machine

    if kind == "svg":
        from lrp_jupyter.graph.still import svg

        return svg(program, machine_path=path)
    if kind == "json":
        from lrp_jupyter.graph.layout import layout

        paths = [path] if path else dict.fromkeys(path for path, _ in program.walk())
        drawings = [layout(find_machine(program, each), program=program, path=each) for each in paths]
        return json.dumps(drawings[0] if path else drawings, ensure_ascii=False, indent=2) + "\n"
    from lrp_jupyter.graph.exports import dot, mermaid

    write = dot if kind == "dot" else mermaid
    return write(program, path or ())
