"""Changes of a program other than numbers: orders, sources, moments, comparisons, and what is left out."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator
from itertools import chain, combinations

from lrp_jupyter.errors import Edit, Finding
from lrp_jupyter.language.checks.scanned import ScannedBlock
from lrp_jupyter.language.parser import scan
from lrp_jupyter.language.program import Block, State
from lrp_jupyter.language.resolution import Arrow, PlacedBlock
from lrp_jupyter.repairs.change import Change, Topic
from lrp_jupyter.repairs.numbers import Numbers, called
from lrp_jupyter.repairs.witness import Evidence

_SIZES = {
    "fix": 0.3,
    "order": 0.5,
    "moment": 0.9,
    "source": 1.1,
    "comparison": 3.0,
    "part": 3.2,
    "transition": 4.2,
}
"""How far each kind of change is, in doublings of a number."""

KINDS = {
    "number": "other numbers",
    "fix": "what the checks propose",
    "order": "another order of transitions",
    "moment": "actions in `onentry`, `running` or `onexit`",
    "source": "other sources of transitions",
    "comparison": "other comparisons",
    "part": "parts of conditions left out",
    "transition": "transitions left out",
}
"""The kinds of changes, in words."""

_LOOSE = (ast.BoolOp, ast.IfExp, ast.Lambda, ast.NamedExpr)  # operands of `and` and `or` in brackets
_OTHERS: dict[type[ast.cmpop], tuple[str, ...]] = {
    ast.Lt: ("<", ">"),
    ast.LtE: ("<=", ">="),
    ast.Gt: (">", "<"),
    ast.GtE: (">=", "<="),
    ast.Eq: ("==", "<=", ">="),
    ast.NotEq: ("!=", "=="),
}
"""How each comparison is written, and what may be meant instead."""


class Structure:
    """The changes of the structure of a program that has failed a run."""

    def __init__(self, numbers: Numbers, evidence: Evidence, findings: Iterable[Finding]) -> None:
        self._numbers, self._drawn, self._text = numbers, numbers.drawn, numbers.text
        self._evidence, self._findings = evidence, findings
        self._count = 0

    def changes(self) -> Iterator[Change]:
        """Yield the changes that leave a valid program."""
        known = {self._text}
        for change in chain(
            *(self._fixes(), self._orders(), self._moments(), self._sources()),
            *(self._comparisons(), self._parts(), self._removals()),
        ):
            text = change.apply(self._text)
            if text not in known and scan(text)[0] is not None:
                known.add(text)
                yield change

    def _change(
        self, kind: str, phrase: str, edits: Iterable[Edit], more: float = 0.0, line: int = 0
    ) -> Change:
        self._count += 1
        lines = (line,) if line else tuple(self._line(edit.start) for edit in edits)
        return Change(Topic(kind, self._count), tuple(edits), lines, phrase, _SIZES[kind] + more)

    def _line(self, offset: int) -> int:
        return self._drawn.program.place(offset)[0]

    def _fixes(self) -> Iterator[Change]:
        for finding in self._findings:
            for fix in filter(None, (finding.fix, finding.creates)):
                phrase = f"The proposal to {fix.title[:1].lower()}{fix.title[1:]}"
                yield self._change("fix", phrase, fix.edits, line=finding.line)

    def _orders(self) -> Iterator[Change]:
        """Yield transitions that fired, each swapped with a later one that leaves a common state."""
        for arrows in self._drawn.names.arrows.values():
            for (place, first), (later, second) in combinations(enumerate(arrows), 2):
                one, other = first.noun.span, second.noun.span
                if first.element.path in self._evidence.fired and _share_a_source(first, second):
                    edits = [Edit(*one, self._text[slice(*other)]), Edit(*other, self._text[slice(*one)])]
                    phrase = f"Swapping {_called(first)} and {_called(second)}"
                    yield self._change("order", phrase, edits, 0.2 * (later - place - 1))

    def _moments(self) -> Iterator[Change]:
        """Yield each action of a state at another moment: a command in `running`, others also elsewhere."""
        for scope in self._drawn.names.scopes:
            for name, state in scope.states.items():
                if (*scope.path, name) not in self._evidence.stayed:
                    continue
                for kind, items in state.actions.items():
                    for item in items:
                        if isinstance(item, Block):
                            yield from self._moved(state, kind, item)

    def _moved(self, state: State, kind: str, block: Block) -> Iterator[Change]:
        sheet = self._drawn.sheet
        form = sheet.at(state.span.start)
        home = next(each for each in form.forms if each.start < block.span.start < each.end)
        text = self._text[slice(*block.span)]
        is_alone = len(home.items) == 1
        for other in ("running", "onentry", "onexit"):
            if other == kind or (other != "running" and "robot." in text):
                continue
            into = next((each for each in form.forms if each.keyword == other), None)
            if is_alone and into is None:
                edits = [Edit(home.head - len(kind), home.head, other)]
            else:
                new = sheet.appended(into, text) if into else sheet.added(form, f"({other} {text})")
                start = len(self._text[: block.span.start].rstrip(" \t"))
                gone = sheet.removed([home])[0] if is_alone else Edit(start, block.span.end, "")
                edits = sorted([gone, new])
            shown = f"`{text}`" if len(text) <= 60 and "\n" not in text else "the action"
            phrase = f"{shown} in `{other}` instead of `{kind}` of `{state.name}`"
            yield self._change("moment", phrase, edits, 0.2 * (other != "running"))

    def _sources(self) -> Iterator[Change]:
        """Yield transitions that leave one state more, one less, or another one."""
        for scope, arrows in self._drawn.names.arrows.items():
            for name in scope.states:
                if (*scope.path, name) in self._evidence.stayed:
                    for arrow in arrows:
                        lacks = sum(_are_alike(each, arrow) for each in arrows) > 1
                        for phrase, source, more in self._other_sources(arrow, name, -0.3 * lacks):
                            edit = Edit(*self._drawn.written(arrow).source, source)
                            yield self._change("source", phrase, [edit], more)

    def _other_sources(self, arrow: Arrow, name: str, more: float) -> Iterator[tuple[str, str, float]]:
        """Yield words for another source of a transition, its text, and how much further it is."""
        noun, called = arrow.noun, _called(arrow)
        others = " ".join([*noun.sources, name])
        if noun.wildcard:
            if noun.leaves(name) and arrow.element.path in self._evidence.fired:
                yield f"Not letting {called} leave `{name}`", f"*-{{{others}}}", 0.0
        elif name not in (*noun.sources, noun.destination):
            yield f"Letting {called} also leave `{name}`", f"{{{others}}}", more
            if len(noun.sources) == 1:
                yield f"Letting {called} leave `{name}` instead of `{noun.sources[0]}`", name, 0.1

    def _comparisons(self) -> Iterator[Change]:
        """Yield comparisons that were made, each the other way round."""
        for index, (left, right, kind) in enumerate(self._numbers.comparisons):
            old, *others = _OTHERS.get(kind, ("",))
            between = self._text[left.end : right.start]
            if old not in between or (self._evidence.used and index not in self._evidence.compared):
                continue
            one, two = self._text[slice(*left)], self._text[slice(*right)]
            for new in others:
                changed = between.replace(old, new)
                phrase = f"`{one}{changed}{two}` instead of `{one}{between}{two}`"
                edit = Edit(left.end, right.start, changed)
                yield self._change("comparison", phrase, [edit])

    def _parts(self) -> Iterator[Change]:
        """Yield conditions without one operand of `and` or `or`."""
        for place in self._drawn.names.all_blocks:
            if place.purpose == "condition":
                yield from self._operands(place)

    def _operands(self, place: PlacedBlock) -> Iterator[Change]:
        block = ScannedBlock(place.block.text)
        for node in block.nodes:
            if not isinstance(node, ast.BoolOp):
                continue
            sign = " and " if isinstance(node.op, ast.And) else " or "
            parts = [self._text[slice(*place.block.at(block.span(each)))] for each in node.values]
            whole = [
                f"({part})" if isinstance(each, _LOOSE) else part
                for part, each in zip(parts, node.values, strict=True)
            ]
            for index, part in enumerate(parts):
                rest = sign.join([*whole[:index], *whole[index + 1 :]])
                edit = Edit(*place.block.at(block.span(node)), rest)
                yield self._change("part", f"Leaving out `{part}`", [edit])

    def _removals(self) -> Iterator[Change]:
        for arrow in chain.from_iterable(self._drawn.names.arrows.values()):
            if arrow.element.path in self._evidence.fired:
                form, phrase = self._drawn.written(arrow).form, f"Leaving out {_called(arrow)}"
                edits, line = self._drawn.sheet.removed([form]), self._line(form.start)
                yield self._change("transition", phrase, edits, line=line)


def _share_a_source(first: Arrow, second: Arrow) -> bool:
    return any(first.noun.leaves(name) and second.noun.leaves(name) for name in first.scope.states)


def _are_alike(first: Arrow, second: Arrow) -> bool:
    """Return whether two transitions differ in their sources only."""
    one, other = first.noun, second.noun
    return (one.content, one.destination, one.outward) == (other.content, other.destination, other.outward)


def _called(arrow: Arrow) -> str:
    return f"`{called(arrow)}`"
