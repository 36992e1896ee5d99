"""The difference of two programs, by meaning: what an edit changes.

An edit adds some elements, removes some, and changes the content of others; white space, comments and moved
lines do not count. A name defined twice counts once: the first definition is the one that runs. Only the
outermost element of an addition or a removal is listed, as a person would describe the edit.

Paper: §6.1.
"""

from __future__ import annotations

from bisect import bisect_left
from collections import Counter
from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Literal, TypeVar

from lrp_jupyter.arguments import A_PROGRAM, check_type
from lrp_jupyter.language.program import (
    Action,
    Block,
    Element,
    Event,
    Machine,
    Path,
    Program,
    Spawn,
    State,
    Transition,
    Variable,
    effect_of,
    path_text,
)
from lrp_jupyter.language.reading.tokens import ACTIONS
from lrp_jupyter.language.successors import Successors

_Change = (
    tuple[Literal["added", "removed", "changed", "moved"], Element]
    | tuple[Literal["became"], tuple[Element, Element]]
)
_Named = TypeVar("_Named", Variable, Event, State, Machine)
_Key = TypeVar("_Key", bound=Hashable)


@dataclass(frozen=True, slots=True)
class ChangeSet:
    """The elements that differ between two programs; false when there are none.

    As text it is a sentence: ``running of `follower/moving` changed; state `follower/x` added``.

    `added`, `removed`: only the outermost elements: an added one by its path in the new program, a removed
        one by its path in the old program.
    `changed`: variables and settings (the initialiser), events (the condition), transitions (when they fire),
        and the actions ``onentry``, ``running``, ``onexit``, ``effect``, ``onpause``, ``onresume``,
        ``onend``, of which every state (every transition, every program) has one of each, possibly empty:
        they are never added or removed. By their paths in the new program.
    `moved`: transitions and variables whose order has changed: the fewest that explain the new order.
    `successors`: the new element for each element of the old program.
    """

    added: tuple[Element, ...] = ()
    removed: tuple[Element, ...] = ()
    changed: tuple[Element, ...] = ()
    moved: tuple[Element, ...] = ()
    successors: Successors = field(default=Successors(), compare=False, repr=False)

    def __bool__(self) -> bool:
        return bool(self.added or self.removed or self.changed or self.moved)

    def __str__(self) -> str:
        groups = {"changed": self.changed, "added": self.added, "removed": self.removed, "moved": self.moved}
        parts = [f"{_words(element)} {what}" for what, elements in groups.items() for element in elements]
        return "; ".join(parts) or "nothing changed"


def diff(old: Program, new: Program) -> ChangeSet:
    """Return the difference of two programs, by meaning.

    Transitions are the same if their :attr:`~lrp_jupyter.language.program.Transition.identity` is, and
    their number among those with equal identity; the condition or delay is their content. All other
    elements are the same if their paths are: a new name, or another machine, is a removal and an
    addition.

    Paper: §6.1, footnote 5.

    Parameters
    ----------
    old, new : Program

    Returns
    -------
    ChangeSet
        Empty if the two mean the same: ``not diff(p, p)``.

    Examples
    --------
    >>> from lrp_jupyter import parse
    >>> print(diff(parse("(var n := [1])"), parse("(var n := [2]) (var m := [3])")))
    variable `n` changed; variable `m` added
    """
    check_type("old", old, Program, A_PROGRAM)
    check_type("new", new, Program, A_PROGRAM)
    groups: dict[str, list[Element]] = {"added": [], "removed": [], "changed": [], "moved": []}
    became: dict[Element, Element] = {}
    for change in _program(old, new):
        if change[0] == "became":
            before, after = change[1]
            became[before] = after
        else:
            groups[change[0]].append(change[1])
    added, removed, changed, moved = map(tuple, groups.values())
    return ChangeSet(added, removed, changed, moved, Successors(became, removed))


def _words(element: Element) -> str:
    if element.kind not in ACTIONS:
        return str(element)
    return f"`{element.kind}`" + (f" of `{path_text(element.shown)}`" if element.path else "")


def _program(old: Program, new: Program) -> Iterator[_Change]:
    yield from _variables((), old.variables, new.variables)
    yield from _named("event", (), old.events, new.events, _content("event"))
    yield from _named("machine", (), old.machines, new.machines, _machine)
    # What is spawned is a set: a machine is not spawned twice, and the order does not matter.
    before, after = ({spawn.identity: None for spawn in p.spawns} for p in (old, new))
    yield from (("removed", Element("spawn", path)) for path in before if path not in after)
    yield from (("added", Element("spawn", path)) for path in after if path not in before)
    yield from _settings((), old.spawns, new.spawns)
    for kind, blocks in old.hooks.items():
        if blocks != new.hooks[kind]:
            yield "changed", Element(kind, ())


def _machine(path: Path, old: Machine, new: Machine) -> Iterator[_Change]:
    yield from _variables(path, old.variables, new.variables)
    yield from _named("event", path, old.events, new.events, _content("event"))
    yield from _named("state", path, old.states, new.states, _state)
    if old.transitions != new.transitions:
        yield from _transitions(path, old, new)


def _state(path: Path, old: State, new: State) -> Iterator[_Change]:
    for kind, items in old.actions.items():
        if items != new.actions[kind]:
            if unset(items) != unset(new.actions[kind]):
                yield "changed", Element(kind, path)
            yield from _settings(path, items, new.actions[kind])
    yield from _named("machine", path, old.machines, new.machines, _machine)


def unset(items: Iterable[Action]) -> list[Block | tuple[str, str]]:
    """Return actions without the settings of the spawns among them, which are not part of the action."""
    return [item.identity if isinstance(item, Spawn) else item for item in items]


def _settings(path: Path, old: Iterable[Action], new: Iterable[Action]) -> Iterator[_Change]:
    """Yield the changes of the settings of machines that are spawned before and after."""
    before, after = (_by_machine(items) for items in (old, new))
    for name, spawn in after.items():
        if name in before:
            where = (*path, name)
            yield from _named("setting", where, before[name].settings, spawn.settings, _content("setting"))


def _by_machine(items: Iterable[Action]) -> dict[str, Spawn]:
    """Return spawns by the name of the machine; the first of two of the same machine."""
    return {str(item.machine): item for item in reversed([*items]) if isinstance(item, Spawn)}


def _variables(path: Path, old: Sequence[Variable], new: Sequence[Variable]) -> Iterator[_Change]:
    yield from _named("variable", path, old, new, _content("variable"))
    for name in _moved(_by_name(old), _by_name(new)):
        yield "moved", Element("variable", (*path, name))


def _transitions(path: Path, old: Machine, new: Machine) -> Iterator[_Change]:
    before, after = _by_identity(path, old), _by_identity(path, new)
    for key, (element, _) in before.items():
        if key not in after:
            yield "removed", element
    for key, (element, noun) in after.items():
        if key not in before:
            yield "added", element
            continue
        old_element, old_noun = before[key]
        if (old_element, old_element.label) != (element, element.label):
            yield "became", (old_element, element)
            yield "became", (effect_of(old_element), effect_of(element))
        if old_noun.content != noun.content:
            yield "changed", element
        if old_noun.effect != noun.effect:
            yield "changed", effect_of(element)
    for key in _moved(before, after):
        yield "moved", after[key][0]


def _named(
    kind: str,
    prefix: Path,
    old: Sequence[_Named],
    new: Sequence[_Named],
    inside: Callable[[Path, _Named, _Named], Iterable[_Change]],
) -> Iterator[_Change]:
    """Yield the changes of elements identified by name; `inside` compares two of the same name."""
    if old is new:
        return
    before, after = _by_name(old), _by_name(new)
    yield from (("removed", Element(kind, (*prefix, name))) for name in before if name not in after)
    for name, element in after.items():
        path = (*prefix, name)
        if name not in before:
            yield "added", Element(kind, path)
        elif before[name] != element:
            yield from inside(path, before[name], element)


def _content(kind: str) -> Callable[[Path, object, object], Iterable[_Change]]:
    return lambda path, _old, _new: [("changed", Element(kind, path))]


def _by_name(elements: Iterable[_Named]) -> dict[str, _Named]:
    """Return elements by name, in the order of the text; the first of two with the same name."""
    named: dict[str, _Named] = {}
    for element in elements:
        named.setdefault(str(element.name), element)
    return named


_Keyed = dict[tuple[Hashable, int], tuple[Element, Transition]]


def _by_identity(path: Path, machine: Machine) -> _Keyed:
    """Return transitions by kind, sources, destination, name and number among equals."""
    seen: Counter[Hashable] = Counter()
    keyed: _Keyed = {}
    for element, transition in zip(machine.elements(path), machine.transitions, strict=True):
        identity = transition.identity
        keyed[identity, seen[identity]] = element, transition
        seen[identity] += 1
    return keyed


def _moved(old: Iterable[_Key], new: Iterable[_Key]) -> list[_Key]:
    """Return the common keys that are not in a longest subsequence that kept its order."""
    place = {key: index for index, key in enumerate(old)}
    kept = [key for key in new if key in place]
    tails: list[int] = []  # tails[n]: the least place at which a rising run of n + 1 keys can end
    lengths = []
    for key in kept:
        length = bisect_left(tails, place[key])
        tails[length : length + 1] = [place[key]]
        lengths.append(length)
    moved, wanted = [], len(tails) - 1
    for key, length in zip(reversed(kept), reversed(lengths), strict=True):
        if length == wanted:
            wanted -= 1
        else:
            moved.append(key)
    return moved[::-1]
