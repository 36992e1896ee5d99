"""4xx: what never happens, and what never stops happening, by the graph of states alone.

Every condition is assumed to be satisfiable and every misspelt reference to be repaired: a state is
unreachable only if no transition and no spawn leads there, whatever the robot senses.

Paper: §9.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Hashable, Iterator

from lrp_jupyter.language.checks.block_facts import facts_of
from lrp_jupyter.language.checks.creations import new_spawn
from lrp_jupyter.language.checks.defined_names import starts
from lrp_jupyter.language.checks.references import Links, MeantArrow, MeantSpawn
from lrp_jupyter.language.checks.report import Reporter, replace
from lrp_jupyter.language.program import Span, Transition
from lrp_jupyter.language.resolution import Resolution, Scope
from lrp_jupyter.language.triggers import Delay, InState, Occurrence


def check_reachability(report: Reporter, names: Resolution, links: Links) -> None:
    """Report states, machines, events and transitions that the program never reaches."""
    unspawned = _unspawned(report, names, links)
    _spawned_again(report, links)
    _spawned_inside(report, names, links)
    _unwatched(report, names, links)
    _unreached(report, names, links, unspawned)
    _unused_events(report, names, links)
    for scope, arrows in links.arrows.items():
        _untested(report, scope, arrows)
        for transition in scope.transitions:
            _livelock(report, transition)


def _unspawned(report: Reporter, names: Resolution, links: Links) -> list[Scope]:
    """Report the machines that are never spawned, and return them."""
    found = []
    spawned = {spawned.machine for spawned in links.spawned}
    for scope in names.scopes:
        # That the program spawns nothing is one finding; a spawn of an unknown machine may mean any.
        is_other_finding = links.guess or not (scope.state or report.program.spawns)
        if scope.name is None or scope in spawned or is_other_finding:
            continue
        begun = starts(scope.noun) if scope.noun else []
        start = begun[0] if begun else next(iter(scope.states), "state")
        place = f"the `onentry` of `{scope.state}`" if scope.state else "the top level"
        message = f"`{scope.name}` is never spawned. Put `(spawn {scope.name} {start})` into {place}."
        around = scope.outer.states[scope.state] if scope.outer and scope.state else None
        fix = new_spawn(report, around, scope.name, start)
        certain = around is not None and len(begun) == 1
        creates = None if certain else fix
        report.add("LRP402", scope.name.span, message, fix if certain else None, creates=creates)
        found.append(scope)
    return found


def _spawned_again(report: Reporter, links: Links) -> None:
    """Report second spawns of a machine by one state, or at the top level."""
    first: dict[tuple[Scope, Scope, str], MeantSpawn] = {}
    for spawned in links.spawned:
        machine, key = spawned.machine, (spawned.machine, spawned.scope, spawned.state)
        if key in first:
            line = report.line(first[key].noun.span)
            where = f"in `{spawned.state}`" if spawned.state else "at the top level"
            message = f"`{machine.name}` is already spawned in line {line}, and runs only once {where}."
            report.add("LRP407", spawned.noun.span, f"{message} Remove one of the spawns.")
        elif spawned.start:
            first[key] = spawned


def _spawned_inside(report: Reporter, names: Resolution, links: Links) -> None:
    """Report spawns of machines inside which they are executed."""
    spawned: dict[Scope, list[MeantSpawn]] = defaultdict(list)
    for spawn in links.spawned:
        spawned[spawn.scope].append(spawn)
    done: set[Scope] = set()
    for scope in names.scopes:
        inside = {scope}
        waiting = [(scope, iter(spawned[scope]))] if scope not in done else []
        while waiting:
            around, spawns = waiting[-1]
            inner = next(spawns, None)
            if inner is None:
                waiting.pop()
                inside.discard(around)
                done.add(around)
            elif inner.machine in inside:
                name = inner.machine.name
                message = f"`{name}` runs already, because this is inside it. Remove this spawn."
                report.add("LRP408", inner.noun.span, message)
            elif inner.machine not in done:
                inside.add(inner.machine)
                waiting.append((inner.machine, iter(spawned[inner.machine])))


def _unwatched(report: Reporter, names: Resolution, links: Links) -> None:
    """Report conditions on states of machines that no source spawns."""
    if links.guess:
        return  # a spawn of an unknown machine may mean any
    spawned = {(spawn.scope, spawn.state, spawn.machine) for spawn in links.spawned}
    spawners = {(spawn.scope, spawn.machine) for spawn in links.spawned}
    for arrow in (arrow for arrows in names.arrows.values() for arrow in arrows):
        trigger, scope, watched = arrow.noun.trigger, arrow.scope, arrow.watched
        if not isinstance(trigger, InState) or not watched or arrow.unresolved_trigger is not None:
            continue
        if any((scope, source, machine) in spawned for source, machine in watched.items()):
            continue
        source, machine = next(iter(watched.items()))
        begun = starts(machine.noun) if machine.noun else []
        start = begun[0] if begun else next(iter(machine.states))
        span = Span(trigger.machine.span.start, trigger.state.span.end)
        if len(watched) > 1:
            problem = f"None of the states that this leaves spawns `{machine.name}`"
        else:
            problem = f"`{source}` does not spawn `{machine.name}`"
        problem += ", so this never occurs"
        if any((outer, machine) in spawners for outer in scope.outwards() if outer is not scope):
            text = f'[{trigger.machine}.state == "{trigger.state}"]'
            message = f"{problem}. For the one that runs elsewhere, write `{text}`."
            report.add("LRP409", span, message, creates=replace(span, text))
        else:
            remedy = f"Put `(spawn {machine.name} {start})` into its `onentry`"
            creates = new_spawn(report, scope.states[source], str(machine.name), str(start))
            report.add("LRP409", span, f"{problem}. {remedy}.", creates=creates)


def _unreached(report: Reporter, names: Resolution, links: Links, unspawned: list[Scope]) -> None:
    reached = _reach(names, links, unspawned)
    uncertain = _uncertain(links)
    for scope, states in reached.items():
        if scope in uncertain:
            continue
        for name, state in scope.states.items():
            if name not in states:
                message = f"`{scope.name}` never enters `{name}`. Add a transition that leads there."
                report.add("LRP401", state.name.span, message)


def _uncertain(links: Links) -> set[Scope]:
    """Return the machines of which a reference that cannot even be guessed may mean any state."""
    found = set()
    for scope, arrows in links.arrows.items():
        for arrow in arrows:
            if not arrow.sound:
                named = [(scope, source) for source in arrow.sources] + arrow.targets
                found |= {machine for machine, name in named if name not in machine.states}
    return found


def _reach(names: Resolution, links: Links, unspawned: list[Scope]) -> dict[Scope, set[str]]:
    """Return the states that can become active, by machine, starting from the top-level spawns.

    Nested machines that are never spawned, which are findings themselves, are assumed to be spawned.
    """
    forgotten: dict[tuple[Scope | None, str], list[Scope]] = defaultdict(list)
    for machine in unspawned:
        forgotten[machine.outer, machine.state].append(machine)
    spawned: dict[tuple[Scope, str], list[MeantSpawn]] = defaultdict(list)
    for spawn in links.spawned:
        spawned[spawn.scope, spawn.state].append(spawn)
    outgoing = {scope: _Outgoing(scope, arrows) for scope, arrows in links.arrows.items()}

    def following(scope: Scope, state: str) -> Iterator[tuple[Scope, str]]:
        for spawn in spawned[scope, state]:
            # An unknown start state, which is a finding itself, may mean any state.
            for start in [spawn.start] if spawn.start else spawn.machine.states:
                yield spawn.machine, start
        for machine in forgotten[scope, state] if state else ():
            for start in machine.states:
                yield machine, start
        for arrow in outgoing[scope].of(state):
            yield from arrow.targets

    reached: dict[Scope, set[str]] = defaultdict(set)
    waiting = [following(names.top, "")]
    while waiting:
        for scope, state in waiting.pop():
            if state not in reached[scope]:
                reached[scope].add(state)
                waiting.append(following(scope, state))
    return reached


class _Outgoing:
    """The transitions of a machine by the state that they leave."""

    def __init__(self, scope: Scope, arrows: list[MeantArrow]) -> None:
        self._wild = [arrow for arrow in arrows if arrow.noun.wildcard]
        self._named: dict[str, list[MeantArrow]] = {}
        for arrow in arrows:
            if not arrow.noun.wildcard:
                for source in arrow.sources:
                    self._named.setdefault(source, []).append(arrow)

    def of(self, state: str) -> Iterator[MeantArrow]:
        """Yield those that leave a state, in no particular order."""
        yield from self._named.get(state, ())
        yield from (arrow for arrow in self._wild if arrow.noun.leaves(state))


def _unused_events(report: Reporter, names: Resolution, links: Links) -> None:
    arrows = [arrow for arrows in links.arrows.values() for arrow in arrows]
    if any(arrow.event is None and isinstance(arrow.noun.trigger, Occurrence) for arrow in arrows):
        return  # an unknown event that cannot even be guessed may mean any
    used = {id(arrow.event) for arrow in arrows}
    events, _ = names.computed
    for place in names.all_blocks:
        for name, *_ in facts_of(place.block.text).reads:
            if name in events and (owner := place.event(name)) is not None:
                used.add(id(owner.events[name]))
    for scope in names.scopes:
        for name, event in scope.events.items():
            if id(event) not in used:
                remedy = f"Write `(on {name} source -> destination)`, or remove it"
                message = f"No transition uses the event `{name}`. {remedy}."
                report.add("LRP403", event.name.span, message)


def _untested(report: Reporter, scope: Scope, arrows: list[MeantArrow]) -> None:
    """Report transitions that come after one which always fires before them. Paper: §5.1.1."""
    earlier: dict[str, _Earlier] = defaultdict(_Earlier)
    at_once: dict[tuple[str, Hashable], Transition] = {}
    held: list[tuple[MeantArrow, list[str]]] = []
    for arrow in arrows:
        transition = arrow.noun
        sources = arrow.sources
        if transition.wildcard:
            sources = [state for state in scope.states if transition.leaves(state)]
        key, hold = _key(arrow), transition.hold
        found = [earlier[state].found(key, hold) for state in sources]
        if transition.wildcard and not sources and transition.destination in scope.states:
            problem = f"`{transition.source_text}` matches no state here, so this transition is never tested"
            message = f"{problem}. Add a state that it can leave, or remove it."
            report.add("LRP406", transition.span, message)
        elif found and all(found) and found[0]:
            reason, first = found[0]
            message = (
                f"This transition is never tested, because the one in line {report.line(first.span)} leaves "
                f"`{sources[0]}` first {reason}. Move this one up, or remove one of them."
            )
            report.add("LRP404", transition.span, message)
        elif arrow.sound:
            for state in sources:
                earlier[state].note(key, transition)
            if hold is None:
                at_once |= {(state, key): transition for state in sources}
            elif hold.due == 0:
                message = "This does not wait. Write the milliseconds after `for`, or remove it."
                report.add("LRP410", transition.span, message)
            else:
                held.append((arrow, sources))
    for arrow, sources in held:
        key = _key(arrow)
        if sources and all((state, key) in at_once for state in sources):
            first = at_once[sources[0], key]
            message = (
                f"This transition never fires, because the one in line {report.line(first.span)} leaves "
                f"`{sources[0]}` on the same condition, without waiting. Remove one of them."
            )
            report.add("LRP404", arrow.noun.span, message)


def _key(arrow: MeantArrow) -> Hashable:
    """Return a key shared by transitions that are enabled together: milliseconds, if they are known."""
    trigger = arrow.noun.trigger
    if trigger.due is not None:
        return trigger.due
    return trigger if arrow.sound or trigger.reference is None else None


class _Earlier:
    """The transitions from one state that precede another, by what enables them."""

    def __init__(self) -> None:
        self._same: dict[Hashable, list[Transition]] = {}
        self._soonest: tuple[int, Transition] | None = None

    def note(self, key: Hashable, transition: Transition) -> None:
        """Register a transition."""
        if not isinstance(key, int):
            self._same.setdefault(key, []).append(transition)
        elif self._soonest is None or key < self._soonest[0]:
            self._soonest = key, transition

    def found(self, key: Hashable, hold: Delay | None) -> tuple[str, Transition] | None:
        """Return a transition that is enabled whenever one with this key is, and why."""
        if key is not None and self._soonest:
            delay, transition = self._soonest
            due = key if isinstance(key, int) else hold.due if hold else None
            if delay == 0:
                return "in any case", transition
            if due is not None and delay <= due:
                return "after the same or a shorter time", transition
        for transition in self._same.get(key, ()):
            if _is_shorter(transition.hold, hold):
                return "on the same condition", transition
        return None


def _is_shorter(first: Delay | None, second: Delay | None) -> bool:
    """Return whether a condition has certainly held long enough for `first` if it has for `second`."""
    if first is None or first == second:
        return True
    return second is not None and first.due is not None and second.due is not None and first.due <= second.due


def _livelock(report: Reporter, transition: Transition) -> None:
    destination = transition.destination
    if transition.trigger.due == 0 and not transition.wildcard and destination in transition.sources:
        message = (
            f"`{destination}` is left and entered again at every tick, so nothing in it ever runs. "
            "Give this transition a condition, a delay or another destination."
        )
        report.add("LRP405", transition.span, message)
