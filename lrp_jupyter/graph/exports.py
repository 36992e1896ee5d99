"""The state graph as text: for Graphviz, for Mermaid (which many Markdown viewers draw), and as a tree."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING

from lrp_jupyter.graph.spawned import landings, spawned_machines
from lrp_jupyter.graph.state_graph import PROGRAM, distinct_states, state_graph
from lrp_jupyter.language.program import Machine, Path, Program, path_text
from lrp_jupyter.language.resolution import resolve

if TYPE_CHECKING:
    import networkx as nx

_STYLE = {
    "on": 'color="#1F78B4"',
    "exit": 'color="#1F78B4", style="bold"',
    "eps": 'color="#33A02C", style="dotted"',
    "ontime": 'color="#FF7F00", style="dashed"',
    "wildcard": 'color="#6A3D9A", style="dashed"',
    "spawn": 'color="#6b7280", style="dotted", arrowhead="odot"',
}


def _picture(program: Program, only: Path) -> nx.MultiDiGraph[Path]:
    """Return the graph of a picture, of one machine with those inside or, with an empty path, of all.

    An ``exit`` leads to a node of the kind ``port`` in its machine, and has another edge wherever it lands.
    """
    graph = state_graph(program, expand=False)
    for source, target, key, data in list(graph.edges(keys=True, data=True)):
        if data["kind"] == "exit":
            graph.remove_edge(source, target, key)
            port = (*source[:-1], f"exit {target[-1]}")
            graph.add_node(port, kind="port", name=target[-1], machine=source[:-1], machines=())
            if key not in graph.get_edge_data(source, port, default={}) or data["dangling"] is None:
                graph.add_edge(source, port, key, **data)
    names = resolve(program)
    for scope in names.scopes:
        for each in landings(names, scope.path):
            source, target = ((*scope.path, str(name)) for name in (each.state, each.arrow.noun.destination))
            style = {"kind": "exit", "style": "exit"}
            graph.add_edge(source, target, **style, text=each.text, dangling=each.broken)
    lost = [
        node for node, data in graph.nodes(data=True) if data["kind"] == "missing" and not graph.degree(node)
    ]
    graph.remove_nodes_from([*lost, *(node for node in graph if node[: len(only)] != only)])
    return graph


def _named(program: Program) -> dict[Path, str]:
    """Return the names of states with what they spawn that is defined elsewhere or gets values, as text."""
    names = resolve(program)
    found: dict[Path, str] = {}
    for scope in names.scopes:
        for each in spawned_machines(names, scope.path):
            if each.elsewhere or each.settings:
                state = (*scope.path, each.state)
                found[state] = f"{found.get(state, each.state)} {'⧉ ' * each.elsewhere}{each.text}"
    return found


def dot(subject: Program | Machine, machine_path: Path = ()) -> str:
    """Return a program or a machine as a Graphviz graph, each machine a cluster inside that of its state.

    `machine_path`: of the one machine of the program to draw, with those inside; by default, all of them.
    Input for ``dot``; the names of the nodes are paths.
    """
    program = Program(machines=(subject,)) if isinstance(subject, Machine) else subject
    graph, named = _picture(program, machine_path), _named(program)
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
            lines.append(f"{indent}  {_node(graph.nodes[node], node, named)};")
            for inner in dict.fromkeys(graph.nodes[node]["machines"]):
                cluster(inner, indent + "  ")
        lines.append(f"{indent}}}")

    for root in _roots(program, machine_path):
        cluster(root, "  ")
    known = {path for path, _ in program.walk()}
    for machine, paths in nodes.items():  # missing states of machines that do not exist either
        if machine not in known:
            lines += [f"  {_node(graph.nodes[path], path, named)};" for path in paths if path != PROGRAM]
    if program.spawns and PROGRAM in graph:
        lines.append(f"  {_quoted('')} [shape=point, width=0.12];")
    for source, target, data in graph.edges(data=True):
        style = _STYLE[data["style"]]
        text = data["text"]
        if data["dangling"]:
            text, style = f"{text} ✗".strip(), style + ', arrowhead="none"'
        label = f"label={_quoted(text)}, " if text else ""
        lines.append(f"  {_quoted(path_text(source))} -> {_quoted(path_text(target))} [{label}{style}];")
    return "\n".join([*lines, "}", ""])


def _roots(program: Program, only: Path) -> Iterable[Path]:
    return [only] if only else dict.fromkeys((str(machine.name),) for machine in program.machines)


def _node(data: dict[str, object], path: Path, named: dict[Path, str]) -> str:
    extra = {
        "port": ", shape=plain",
        "missing": ', style="rounded,dashed", color="#6b7280"',
        "any": ', shape=circle, style=dashed, color="#6A3D9A"',
    }.get(str(data["kind"]), "")
    if data["machines"]:
        extra += ", peripheries=2"
    return f"{_quoted(path_text(path))} [label={_quoted(named.get(path, str(data['name'])))}{extra}]"


def _quoted(text: str) -> str:
    """Return a quoted string; only the quotation mark and, in labels, the backslash need escaping."""
    line = " ".join(text.split())
    return '"' + line.replace("\\", "\\\\").replace('"', '\\"') + '"'


def mermaid(subject: Program | Machine, machine_path: Path = ()) -> str:
    """Return a program or a machine as a ``stateDiagram-v2``, machines nested inside their states.

    `machine_path`: as in :func:`dot`.
    The states get generated ids, because names such as ``end`` and ``state`` are keywords of Mermaid.
    """
    program = Program(machines=(subject,)) if isinstance(subject, Machine) else subject
    graph, named = _picture(program, machine_path), _named(program)
    ids = {path: f"s{index}" for index, path in enumerate(graph.nodes)}
    inside: dict[Path, list[Path]] = {}
    for path, data in graph.nodes(data=True):
        if data["kind"] != "port":
            inside.setdefault(data["machine"], []).append(path)
    arrows: dict[Path, list[str]] = {}
    for source, target, data in graph.edges(data=True):
        text = data["text"] + (" ✗" if data["dangling"] else "")
        home = source[:-1]
        if data["kind"] == "spawn":
            line, home = f"[*] --> {ids[target]}", target[:-1]
        elif graph.nodes[target]["kind"] == "port":  # no arrow may lead from inside one state into another
            line = f"{ids[source]} --> [*] : {_escaped(text + ' → ' + graph.nodes[target]['name'])}"
        else:
            line = f"{ids[source]} --> {ids[target]} : {_escaped(text)}"
        if line not in arrows.setdefault(home, []):
            arrows[home].append(line)
    machines = {path for path, _ in program.walk()}
    lines = ["stateDiagram-v2"]
    count = len(ids)

    def block(path: Path, indent: str) -> None:
        nonlocal count
        lines.append(f'{indent}state "{_escaped(path[-1])}" as m{count} {{')
        count += 1
        for node in inside.get(path, ()):
            data = graph.nodes[node]
            missing = f"{data['name']} (missing)"
            name = _escaped(missing if data["kind"] == "missing" else named.get(node, data["name"]))
            nested = dict.fromkeys(data["machines"])
            lines.append(f'{indent}  state "{name}" as {ids[node]}' + (" {" if nested else ""))
            for inner in nested:
                block(inner, indent + "    ")
            if nested:
                lines.append(f"{indent}  }}")
        lines.extend(f"{indent}  {arrow}" for arrow in arrows.pop(path, ()))
        lines.append(f"{indent}}}")

    for path in _roots(program, machine_path):
        block(path, "  ")
    for home, paths in inside.items():
        if home not in machines:
            lines += [f'  state "{_escaped(path[-1])} (missing)" as {ids[path]}' for path in paths if path]
    lines.extend(f"  {arrow}" for rest in arrows.values() for arrow in rest)
    return "\n".join([*lines, ""])


def _escaped(text: str) -> str:
    """Return a text with entity codes for all characters that might have a meaning in Mermaid."""
    return "".join(
        character if character.isalnum() or character in " _.,*()-+/→" else f"#{ord(character)};"
        for character in " ".join(text.split())
    )


def tree(subject: Program | Machine, active: Iterable[Sequence[str]] = ()) -> str:
    """Return the machines, their states and the machines nested in them, one per line.

    `active`: paths of the innermost active states; they and the states around them are marked ``●``.
    """
    program = Program(machines=(subject,)) if isinstance(subject, Machine) else subject
    on = {tuple(path[:end]) for path in active for end in range(1, len(path) + 1)}
    named = _named(program)
    lines = [line for machine in program.machines for line in _machine((), machine, "", "", on, named)]
    return "\n".join(lines) or "(no machine)"


def _machine(
    outer: Path, machine: Machine, first: str, rest: str, on: set[Path], named: dict[Path, str]
) -> Iterator[str]:
    path = (*outer, str(machine.name))
    yield f"{first}machine {machine.name}" + (" ●" if path in on else "")
    states = list(distinct_states(machine).values())
    for state in states:
        last = state is states[-1]
        here = (*path, str(state.name))
        name = named.get(here, str(state.name))
        yield f"{rest}{'└─ ' if last else '├─ '}{name}" + (" ●" if here in on else "")
        deeper = rest + ("   " if last else "│  ")
        for inner in state.machines:
            end = inner is state.machines[-1]
            yield from _machine(
                here, inner, deeper + ("└─ " if end else "├─ "), deeper + ("   " if end else "│  "), on, named
            )
