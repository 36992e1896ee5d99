"""The state graph in the language of Mermaid, which many Markdown viewers draw."""

from __future__ import annotations

from lrp_jupyter.graph.state_graph import state_graph
from lrp_jupyter.language.program import Machine, Path, Program

__all__ = ["mermaid"]


def mermaid(subject: Program | Machine) -> str:
    """Write a program or a machine as a ``stateDiagram-v2``, machines nested inside their states.

    The states have ids of their own, for names such as ``end`` and ``state`` mean something there.
    """
    program = Program(machines=(subject,)) if isinstance(subject, Machine) else subject
    graph = state_graph(program, expand=False)
    ids = {path: f"s{index}" for index, path in enumerate(graph.nodes)}
    inside: dict[Path, list[Path]] = {}
    for path, data in graph.nodes(data=True):
        inside.setdefault(data["machine"], []).append(path)
    arrows: dict[Path, list[str]] = {}
    for source, target, data in graph.edges(data=True):
        text = data["text"] + (" ✗" if data["dangling"] else "")
        home = source[:-1]
        if data["kind"] == "spawn":
            line, home = f"[*] --> {ids[target]}", target[:-1]
        elif data["kind"] == "exit":  # no arrow may lead from inside one state into another
            line = f"{ids[source]} --> [*] : {_escaped(f'{text} → {target[-1]}')}"
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
            name = _escaped(f"{data['name']} (missing)" if data["kind"] == "missing" else data["name"])
            nested = dict.fromkeys(data["machines"])
            lines.append(f'{indent}  state "{name}" as {ids[node]}' + (" {" if nested else ""))
            for inner in nested:
                block(inner, indent + "    ")
            if nested:
                lines.append(f"{indent}  }}")
        lines.extend(f"{indent}  {arrow}" for arrow in arrows.pop(path, ()))
        lines.append(f"{indent}}}")

    for path in dict.fromkeys((str(machine.name),) for machine in program.machines):
        block(path, "  ")
    for home, paths in inside.items():
        if home not in machines:
            lines += [f'  state "{_escaped(path[-1])} (missing)" as {ids[path]}' for path in paths if path]
    lines.extend(f"  {arrow}" for rest in arrows.values() for arrow in rest)
    return "\n".join([*lines, ""])


def _escaped(text: str) -> str:
    """Write a text so that nothing in it means something: entity codes for all but plain characters."""
    return "".join(
        character if character.isalnum() or character in " _.,*()-+/→" else f"#{ord(character)};"
        for character in " ".join(text.split())
    )
