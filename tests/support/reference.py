"""The language reference, literally: slow, plain, and written apart from the interpreter.

Production and this page are run on the same programs and must agree. It knows ticks, variables and
which states are active; no issues, no observers, no patching. Blocks run by ``exec`` with the
variables as globals of a throwaway dict, where production binds cells.
"""

from __future__ import annotations

import ast
import math
from contextlib import suppress
from numbers import Real

from lrp_jupyter.language.program import Block, Machine, Program, Spawn, State
from lrp_jupyter.language.python.block_suite import parse_block
from lrp_jupyter.language.triggers import Condition, Delay, Epsilon

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


class Reference:
    def __init__(self, program: Program, robot=None, namespace=None):
        self.program, self.robot, self.namespace = program, robot, namespace or {}
        self.now, self.roots, self.globals = 0.0, [], None
        self.events: list[tuple[str, tuple[str, ...]]] = []

    # -- the tick
    def step(self, now):
        self.now = now
        if not self.roots:
            if self.globals is None:
                self.globals = Scope()
                self.initialise(self.globals, self.program.variables)
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
                    self.leave(home)
                    self.events.append(("fired", (*self.path(m), t.name or "")))
                    self.enter(home, target)
                    self.tick(home, fires=False)
                    return t.kind == "exit"
        for block in m.state.running:
            self.attempt(block, m.scope)
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
                self.attempt(item, m.scope)

    def leave(self, m):
        for n in reversed(m.inside):
            self.leave(n)
            self.events.append(("discarded", self.path(n)))
        m.inside = []
        for block in m.state.onexit:
            self.attempt(block, m.scope)
        self.events.append(("left", (*self.path(m), m.state.name)))

    def spawn(self, spawn, spawner):
        found = self.spawnable(spawn.machine, spawner)
        start = found and find(found[0].states, spawn.state)
        if not start or any(r.machine is found[0] for r in self.everything()):
            return None
        machine, home = found
        m = Running(machine, home, spawner, Scope(self.scope_around(home, spawner)))
        (spawner.inside if spawner else self.roots).append(m)
        self.events.append(("spawned", self.path(m)))
        self.initialise(m.scope, machine.variables)
        self.enter(m, start)
        return m

    def spawnable(self, name, spawner):
        """The machine and the running machine around it: the state's own, then outward, then the top."""
        enclosing, state, around = [], spawner and spawner.state, spawner
        while around is not None:
            enclosing.append(around.machine)
            machine = find(state.machines, name)
            if machine and machine not in enclosing:
                return machine, around
            if around.home is None:
                break
            around, state = around.home, self.state_around(around)
        machine = find(self.program.machines, name)
        return (machine, None) if machine and not any(machine is e for e in enclosing) else None

    @staticmethod
    def state_around(m):
        return next(s for s in m.home.machine.states if any(x is m.machine for x in s.machines))

    def scope_around(self, home, spawner):
        return home.scope if home else self.globals

    def everything(self):
        def inside(m):
            yield m
            for n in m.inside:
                yield from inside(n)

        for root in self.roots:
            yield from inside(root)

    # -- conditions
    def enabled(self, t, m):
        try:
            if isinstance(t.trigger, Epsilon):
                return True
            if isinstance(t.trigger, Delay):
                delay = t.trigger.amount
                if isinstance(delay, Block):
                    delay = self.run(delay, m.scope)
                elif isinstance(delay, str):
                    delay = self.read(delay, m.scope)
                if isinstance(delay, bool) or not isinstance(delay, Real) or delay != delay:
                    return False
                return (self.now - m.entered) * 1000 + 1e-6 >= delay
            if isinstance(t.trigger, Condition):
                return self.run(t.trigger.condition, m.scope) is True
            while m is not None:
                event = find(m.machine.events, t.trigger.event)
                if event:
                    return self.run(event.condition, m.scope) is True
                m = m.home
            event = find(self.program.events, t.trigger.event)
            return bool(event) and self.run(event.condition, self.globals) is True
        except Skip:
            return False

    # -- variables and blocks
    def initialise(self, scope, variables):
        for v in variables:
            if v.name not in scope.values:
                try:
                    value = self.run(v.initial, scope)
                except Skip:
                    value = MISSING
                scope.values[str(v.name)] = value

    def read(self, name, scope):
        found = scope.find(name)
        if found is None or found.values[name] is MISSING:
            raise Skip
        return found.values[name]

    def attempt(self, block, scope):
        with suppress(Skip):
            self.run(block, scope)

    def run(self, block, scope):
        names, s = {}, scope
        while s is not None:
            for name, value in s.values.items():
                names.setdefault(name, (s, value))
            s = s.outer
        tree = GlobalNames().visit(parse_block(block.text))
        body = tree.body
        if body and isinstance(body[-1], ast.Expr):
            body[-1] = ast.copy_location(ast.Return(body[-1].value), body[-1])
        function = ast.FunctionDef(
            "block",
            ast.arguments([], [], None, [], [], None, []),
            [*([ast.Global(list(names))] if names else []), *(body or [ast.Pass()])],
            [],
            type_params=[],
        )
        space = {"degrees": math.radians, **self.namespace, "robot": self.robot, "print": lambda *a: None}
        space.update({name: value for name, (_, value) in names.items() if value is not MISSING})
        exec(compile(ast.fix_missing_locations(ast.Module([function], [])), "<reference>", "exec"), space)
        try:
            return space["block"]()
        except (Exception, SystemExit) as error:
            raise Skip from error
        finally:
            for name, (owner, _) in names.items():
                owner.values[name] = space.get(name, MISSING)

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


class GlobalNames(ast.NodeTransformer):
    """Uses a throwaway dict of globals where production code uses nonlocal."""

    def visit_Nonlocal(self, node):
        return ast.copy_location(ast.Global(node.names), node)

    def visit_AnnAssign(self, node):
        if isinstance(node.target, ast.Name) and node.value is not None:
            return ast.copy_location(ast.Assign([node.target], node.value), node)
        return node
