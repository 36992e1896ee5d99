"""The state graph in the language of Graphviz."""

from __future__ import annotations

from lrp_jupyter.graph.state_graph import PROGRAM, state_graph
from lrp_jupyter.language.program import Machine, Path, Program, path_text

__all__ = ["dot"]

_STYLE = {
    "on": 'color="#1F78B4"',
    "exit": 'color="#1F78B4", style="bold"',
    "eps": 'color="#33A02C", style="dotted"',
    "ontime": 'color="#FF7F00", style="dashed"',
    "wildcard": 'color="#6A3D9A", style="dashed"',
    "spawn": 'color="#6b7280", style="dotted", arrowhead="odot"',
}


def dot(subject: Program | Machine) -> str:
    """Write a program or a machine as a directed graph, each machine a cluster inside its state's.

    Returns
    -------
    str
        Text for ``dot``; the nodes are called by their paths.
    """
    program = Program(machines=(subject,)) if isinstance(subject, Machine) else subject
    graph = state_graph(program, expand=False)
    nodes: dict[Path, list[Path]] = {}
    for path, data in graph.nodes(data=True):
        nodes.setdefault(data["machine"], []).append(path)
    lines = [
        "digraph lrp {",
        "  compound=true;",
        '  node [shape=box, style="rounded", fontname="Helvetica"];',
        '  edge [fontname="Helvetica", fontsize=11];',
    ]

    def cluster(path: Path, indent: str) -> None:
        lines.append(f"{indent}subgraph {_quoted('cluster ' + path_text(path))} {{")
        lines.append(f"{indent}  label={_quoted(path[-1])};")
        for node in nodes.get(path, ()):
            lines.append(f"{indent}  {_node(graph.nodes[node], node)};")
            for inner in dict.fromkeys(graph.nodes[node]["machines"]):
                cluster(inner, indent + "  ")
        lines.append(f"{indent}}}")

    roots = dict.fromkeys((str(machine.name),) for machine in program.machines)
    for root in roots:
        cluster(root, "  ")
    known = {path for path, _ in program.walk()}
    for machine, paths in nodes.items():  # missing states of machines that do not exist either
        if machine not in known:
            lines += [f"  {_node(graph.nodes[path], path)};" for path in paths if path != PROGRAM]
    if program.spawns:
        lines.append(f"  {_quoted('')} [shape=point, width=0.12];")
    for source, target, data in graph.edges(data=True):
        style = _STYLE[data["style"]]
        text = data["text"]
        if data["dangling"]:
            text, style = f"{text} ✗".strip(), style + ', arrowhead="none"'
        label = f"label={_quoted(text)}, " if text else ""
        lines.append(f"  {_quoted(path_text(source))} -> {_quoted(path_text(target))} [{label}{style}];")
    return "\n".join([*lines, "}", ""])


def _node(data: dict[str, object], path: Path) -> str:
    extra = {
        "missing": ', style="rounded,dashed", color="#6b7280"',
        "any": ', shape=circle, style=dashed, color="#6A3D9A"',
    }.get(str(data["kind"]), "")
    if data["machines"]:
        extra += ", peripheries=2"
    return f"{_quoted(path_text(path))} [label={_quoted(str(data['name']))}{extra}]"


def _quoted(text: str) -> str:
    """Quote a string: only the quotation mark and, for labels, the backslash mean something."""
    line = " ".join(text.split())
    return '"' + line.replace("\\", "\\\\").replace('"', '\\"') + '"'
