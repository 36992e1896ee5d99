"""``lrp graph``: the state machines of a program as a picture or as text for other tools."""

from __future__ import annotations

import json
import sys
from difflib import get_close_matches
from pathlib import Path
from typing import Literal

from lrp_jupyter.cli.excerpt import finding_text, plain_console
from lrp_jupyter.cli.source import read_source
from lrp_jupyter.errors import UnknownElementError
from lrp_jupyter.graph.state_graph import find_machine
from lrp_jupyter.language.parser import scan
from lrp_jupyter.language.program import Program, path_text

__all__ = ["Format", "draw_graph"]

Format = Literal["svg", "dot", "mermaid", "json"]
_SUFFIXES: dict[str, Format] = {".dot": "dot", ".gv": "dot", ".mmd": "mermaid", ".json": "json"}


def draw_graph(file: str, machine: str | None, kind: Format | None, output: Path | None) -> int:
    """Write the graph of a file; return the exit code: 1 if it is not a program."""
    source = read_source(file)
    program, findings = scan(source.text, source.name)
    if program is None:
        for finding in findings:
            plain_console(stderr=True).print(finding_text(source.name, source.text, finding))
        return 1
    if kind is None:
        kind = _SUFFIXES.get(output.suffix.lower(), "svg") if output is not None else "svg"
    known = [path_text(path) for path, _ in program.walk()]
    if machine is not None and machine.strip("/") not in known:
        close = get_close_matches(machine, known, n=1)
        hint = f"did you mean `{close[0]}`?" if close else f"there are {', '.join(known) or 'none'}."
        raise UnknownElementError(f"there is no machine `{machine}`; {hint}")
    picture = _drawn(program, machine, kind)
    if output is None:
        sys.stdout.write(picture)
    else:
        output.write_text(picture, encoding="utf-8")
    return 0


def _drawn(program: Program, machine: str | None, kind: Format) -> str:
    path = tuple(machine.strip("/").split("/")) if machine else None
    if kind == "svg":
        from lrp_jupyter.graph.still import svg

        return svg(program, machine_path=path)
    if kind == "json":
        from lrp_jupyter.graph.layout import layout

        paths = [path] if path else dict.fromkeys(path for path, _ in program.walk())
        drawings = [layout(find_machine(program, each), program=program, path=each) for each in paths]
        return json.dumps(drawings[0] if path else drawings, ensure_ascii=False, indent=2) + "\n"
    from lrp_jupyter.graph.still import dot, mermaid

    write = dot if kind == "dot" else mermaid
    return write(find_machine(program, path) if path else program)
