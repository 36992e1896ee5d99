"""The language reference, literally: slow, plain, and written apart from the interpreter.

Production and this page are run on the same programs and must agree. It knows ticks, variables and
which states are active; no issues, no observers, no patching. Blocks run by ``exec`` with the
variables as globals of a throwaway dict, where production binds cells.
"""

from __future__ import annotations

import ast
import builtins
import math
from contextlib import suppress
from numbers import Real

from lrp_jupyter.language.program import Block, Machine, Program, Spawn, State
from lrp_jupyter.language.python.block_suite import parse_block
from lrp_jupyter.language.triggers import Condition, Delay, Epsilon, InState

MISSING = object()


class Skip(Exception):  # noqa: N818
    """A fault: the entity is ignored for this tick."""


class Scope:
    def __init__(self, outer=None):
        self.outer, self.values = outer, {}

    def find(self, name):
        scope = self
        while scope is not None and name not in scope.values:
            scope = scope.outer
        return scope


class Running:
    """A machine that runs."""

    def __init__(self, machine, home, parent, scope):
        self.machine, self.home, self.parent, self.scope = machine, home, parent, scope
        self.state, self.entered, self.inside = None, 0.0, []
        self.held = {}  # since when the conditions with `for` hold


class Place:
    """Where a block stands: the machine (None: the top level), and the event that it is the block of.

    `since`: when the state was entered from which `elapsed` counts.
    """

    def __init__(self, m, since, event=""):
        self.m, self.since, self.event = m, since, event


class Reference:
    def __init__(self, program: Program, robot=None, namespace=None):
        self.program, self.robot, self.namespace = program, robot, namespace or {}
        self.now, self.dt, self.roots, self.globals = None, 0.0, [], None
        self.events: list[tuple[str, tuple[str, ...]]] = []

    # -- the tick
    def step(self, now):
        self.dt = now - self.now if self.now is not None else 0.0
        self.now = now
        if not self.roots:
            if self.globals is None:
                self.globals, self.began = Scope(), now
                self.initialise(None, self.globals, self.program.variables)
            for spawn in self.program.spawns:
                m = self.spawn(spawn, None)
                if m:
                    self.tick(m, fires=False)
        else:
            for root in self.roots:
                self.tick(root)

    def tick(self, m, fires=True):
        for t in m.machine.transitions:
            if t.leaves(m.state.name) and self.enabled(t, m):
                home = m.parent if t.kind == "exit" else m
                target = home and find(home.machine.states, t.destination)
                if target and not fires:
                    return False
                if target:
                    for block in t.effect:
                        self.attempt(block, m)
                    self.leave(home)
                    self.events.append(("fired", (*self.path(m), t.name or "")))
                    self.enter(home, target)
                    self.tick(home, fires=False)
                    return t.kind == "exit"
        for block in m.state.running:
            self.attempt(block, m)
        for n in list(m.inside):
            if self.tick(n, fires):
                break
        return False

    def enter(self, m, state: State):
        m.state, m.entered = state, self.now
        self.events.append(("entered", (*self.path(m), state.name)))
        for item in state.onentry:
            if isinstance(item, Spawn):
                self.spawn(item, m)
            else:
                self.attempt(item, m)

    def leave(self, m):
        for n in reversed(m.inside):
            self.leave(n)
            self.events.append(("discarded", self.path(n)))
        m.inside, m.held = [], {}
        for block in m.state.onexit:
            self.attempt(block, m)
        self.events.append(("left", (*self.path(m), m.state.name)))

    def spawn(self, spawn, spawner):
        found = self.spawnable(spawn.machine, spawner, spawner and spawner.state)
        start = found and find(found[0].states, spawn.state)
        beside, around = (spawner.inside if spawner else self.roots), spawner
        while start and around is not None:
            start, around = start if around.machine is not found[0] else None, around.parent
        if not start or any(m.machine is found[0] for m in beside):
            return None
        machine, home = found
        m = Running(machine, home, spawner, Scope(home.scope if home else self.globals))
        m.state, m.entered = start, self.now
        beside.append(m)
        self.events.append(("spawned", self.path(m)))
        self.initialise(m, m.scope, machine.variables, spawn.settings)
        self.enter(m, start)
        return m

    def spawnable(self, name, m, state):
        """The machine and the running machine around it: the state's own, then outward, then the top."""
        enclosing = []
        while m is not None:
            enclosing.append(m.machine)
            machine = state and find(state.machines, name)
            if machine and machine not in enclosing:
                return machine, m
            m, state = m.home, m.home and self.state_around(m)
        machine = find(self.program.machines, name)
        return (machine, None) if machine and not any(machine is e for e in enclosing) else None

    @staticmethod
    def state_around(m):
        return next(s for s in m.home.machine.states if any(x is m.machine for x in s.machines))

    def everything(self):
        def inside(m):
            yield m
            for n in m.inside:
                yield from inside(n)

        for root in self.roots:
            yield from inside(root)

    # -- conditions
    def enabled(self, t, m):
        key = m.machine.transitions.index(t), m.state.name
        try:
            holds = self.occurs(t, m)
        except Skip:
            holds = False
        if t.hold is None:
            return holds
        if not holds:
            m.held.pop(key, None)
            return False
        try:
            return self.is_over(t.hold, m, m.held.setdefault(key, self.now))
        except Skip:
            return False

    def occurs(self, t, m):
        trigger = t.trigger
        if isinstance(trigger, Epsilon):
            return True
        if isinstance(trigger, Delay):
            return self.is_over(trigger, m, m.entered)
        if isinstance(trigger, Condition):
            return self.run(trigger.condition, m) is True
        if isinstance(trigger, InState):
            found = self.spawnable(trigger.machine, m, m.state)
            return any(found and n.machine is found[0] and n.state.name == trigger.state for n in m.inside)
        event = self.event(trigger.event, m)
        return event is not None and self.run(*event, Place(event[1], m.entered, trigger.event)) is True

    def is_over(self, delay, m, since):
        amount = delay.amount
        if isinstance(amount, Block):
            amount = self.run(amount, m)
        elif isinstance(amount, str):
            amount = self.read(amount, m.scope)
        if isinstance(amount, bool) or not isinstance(amount, Real) or amount != amount:
            return False
        return (self.now - since) * 1000 + 1e-6 >= amount

    def event(self, name, m):
        """The block of an event, and the machine that defines it."""
        while m is not None:
            event = find(m.machine.events, name)
            if event:
                return event.condition, m
            m = m.home
        event = find(self.program.events, name)
        return (event.condition, None) if event else None

    # -- variables and blocks
    def initialise(self, m, scope, variables, settings=()):
        for v in variables:
            if v.name not in scope.values:
                setting = find(settings, v.name)
                home = m.parent if setting else m
                try:
                    value = self.run((setting or v).initial, home)
                except Skip:
                    value = MISSING
                scope.values[str(v.name)] = value

    def read(self, name, scope):
        found = scope.find(name)
        if found is None or found.values[name] is MISSING:
            raise Skip
        return found.values[name]

    def attempt(self, block, m):
        with suppress(Skip):
            self.run(block, m)

    def run(self, block, m, place=None):
        tree = parse_block(block.text)
        body = GlobalNames(set().union(*map(names_bound_by, ast.walk(tree)))).visit(tree).body
        if body and isinstance(body[-1], ast.Expr):
            body[-1] = ast.copy_location(ast.Return(body[-1].value), body[-1])
        space = Space(self, m, place or Place(m, m.entered if m else self.began))
        function = ast.FunctionDef(
            "block",
            ast.arguments([], [], None, [], [], None, []),
            [*([ast.Global(list(space.owners))] if space.owners else []), *(body or [ast.Pass()])],
            [],
            type_params=[],
        )
        try:
            exec(compile(ast.fix_missing_locations(ast.Module([function], [])), "<reference>", "exec"), space)
            return space["block"]()
        except (Exception, SystemExit) as error:
            raise Skip from error
        finally:
            space.write()

    def meaning(self, name, place):
        """What a name in a block means that is no variable: an event, a time or a machine."""
        m, event = place.m, self.event(name, place.m)
        if event and name != place.event:
            return self.run(*event, Place(event[1], place.since, name))
        if name == "dt":
            return round(self.dt, 9)
        if name == "elapsed":
            return round(self.now - place.since, 9)
        return self.machine(name, m)

    def machine(self, name, m):
        """The machine that a name means, in the nearest of the places where it runs."""
        states = [None, *(find(m.machine.states, s.name) for s in m.machine.states)] if m else [None]
        found = [f[0] for f in (self.spawnable(name, m, state) for state in states) if f]
        if not found:
            raise KeyError(name)
        near = []
        while m is not None:
            near, m = near + m.inside, m.parent
        return Seen(next((n for n in near + self.roots if any(n.machine is f for f in found)), None))

    # -- what can be seen
    def path(self, m):
        return (*((*self.path(m.parent), m.parent.state.name) if m.parent else ()), str(m.machine.name))

    @property
    def active(self):
        return tuple((*self.path(m), str(m.state.name)) for m in self.everything() if not m.inside)

    @property
    def variables(self):
        found = {(n,): v for n, v in (self.globals.values if self.globals else {}).items()}
        for m in self.everything():
            found.update({(*self.path(m), n): v for n, v in m.scope.values.items()})
        return {path: value for path, value in found.items() if value is not MISSING}


def find(things: tuple, name: str) -> Machine | State | None:
    """The first definition of a name counts."""
    return next((thing for thing in things if thing.name == name), None)


def names_bound_by(node):
    if isinstance(node, ast.Name):
        return {node.id} if not isinstance(node.ctx, ast.Load) else ()
    if isinstance(node, ast.alias):
        return {(node.asname or node.name).partition(".")[0]}
    return (
        {getattr(node, "name", None), getattr(node, "arg", None)} if not isinstance(node, ast.keyword) else ()
    )


class Seen:
    """A machine as blocks see it."""

    def __init__(self, m):
        self.m = m
        self.state = m and str(m.state.name)

    def __getattr__(self, name):
        if self.m is None or self.m.scope.values.get(name, MISSING) is MISSING:
            raise AttributeError(name)
        return self.m.scope.values[name]


CALLED, OWNER = " called", " as owner"
"""Put after a name that is called, and one before a dot: they do not mean an event."""


def provided(name):
    if not hasattr(builtins, name):
        raise KeyError(name)
    return getattr(builtins, name)


class Space(dict):
    """The names of one block while it runs; what is no variable is computed when it is read."""

    def __init__(self, reference, m, place):
        super().__init__(**reference.namespace)
        self.update(robot=reference.robot, print=lambda *a: None)
        self.setdefault("degrees", math.radians)
        self.reference, self.m, self.place, self.owners = reference, m, place, {}
        scope = m.scope if m else reference.globals
        while scope is not None:
            self.owners = {**dict.fromkeys(scope.values, scope), **self.owners}
            scope = scope.outer
        self.load()

    def load(self):
        for name, scope in self.owners.items():
            self.pop(name, None)
            if scope.values[name] is not MISSING:
                self[name] = scope.values[name]

    def write(self):
        for name, scope in self.owners.items():
            scope.values[name] = self.get(name, MISSING)

    def __missing__(self, key):
        name = key.partition(" ")[0]
        if name in self or name in self.owners:
            return dict.__getitem__(self, name)
        if key.endswith(CALLED):
            return provided(name)
        self.write()
        try:
            if key.endswith(OWNER):
                with suppress(KeyError):
                    return self.reference.machine(name, self.place.m)
            return self.reference.meaning(name, self.place)
        except KeyError:
            return provided(name)
        finally:
            self.load()


class GlobalNames(ast.NodeTransformer):
    """Uses a throwaway dict of globals where production code uses nonlocal."""

    def __init__(self, bound):
        self.bound = bound

    def marked(self, node, mark):
        if isinstance(node, ast.Name) and node.id not in self.bound:
            node.id += mark

    def visit_Call(self, node):
        self.generic_visit(node)
        self.marked(node.func, CALLED)
        return node

    def visit_Attribute(self, node):
        self.generic_visit(node)
        self.marked(node.value, OWNER)
        return node

    def visit_Nonlocal(self, node):
        return ast.copy_location(ast.Global(node.names), node)

    def visit_AnnAssign(self, node):
        self.generic_visit(node)
        if isinstance(node.target, ast.Name) and node.value is not None:
            return ast.copy_location(ast.Assign([node.target], node.value), node)
        return node
