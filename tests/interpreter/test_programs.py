"""Every program of tests/programs does what its comments expect, in production and in the reference."""

from support.reference import Reference
from support.story import HERE, ORDINARY, PERIOD, no_label, read, robot, run_until
from support.tables import every

from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.language.parser import parse

PROGRAMS = sorted((HERE / "programs").glob("*.lrp"))


of_every_program = every("story", [read(path.read_text(encoding="utf-8")) for path in PROGRAMS])


def words(paths):
    return tuple("/".join(path) for path in paths)


@of_every_program
def test_a_program_does_what_its_comments_expect(story):
    bot, seen = robot(), []
    i = Interpreter(parse(story.text), bot)
    i.observe(lambda e: seen.append((e.tick, f"{e.kind} {'/'.join(e.path)}")) if e.kind in ORDINARY else None)
    run_until(i.step, story, bot, lambda: (words(i.active), i.variables))
    for tick, expected in story.events.items():
        assert [event for at, event in seen if at == tick] == expected, f"tick {tick}"
    assert {(issue.code, issue.line) for issue in i.issues} == story.issues


@of_every_program
def test_a_program_does_the_same_without_observers(story):
    bot = robot()
    i = Interpreter(parse(story.text), bot, journal=0)
    run_until(i.step, story, bot, lambda: (words(i.active), i.variables))


@of_every_program
def test_the_reference_interpreter_meets_the_expectations(story):
    bot = robot()
    i = Reference(parse(story.text), bot)
    run_until(i.step, story, bot, lambda: (words(i.active), i.variables))


@of_every_program
def test_production_and_reference_agree_at_every_tick(story):
    bots = robot(), robot()
    program = parse(story.text)
    production, reference, events = Interpreter(program, bots[0]), Reference(program, bots[1]), []
    production.observe(lambda e: events.append((e.kind, e.path)) if e.kind in ORDINARY else None)
    for tick in range(1, story.last_tick + 20):
        for bot in bots:
            for name, value in story.inputs.get(tick, ()):
                setattr(bot, name, value)
        for i in (production, reference):
            i.step((tick - 1) * PERIOD)
        assert production.active == reference.active, f"after tick {tick}"
        assert plain(production.variables) == plain(reference.variables), f"after tick {tick}"
        assert [no_label(e) for e in events] == [no_label(e) for e in reference.events], f"in tick {tick}"
        events.clear()
        reference.events.clear()


@of_every_program
def test_going_back_restores_every_moment(story):
    bot = robot()
    i = Interpreter(parse(story.text), bot)
    moments = [(i.active, dict(i.variables), 0.0)]
    for tick in range(1, story.last_tick + 1):
        for name, value in story.inputs.get(tick, ()):
            setattr(bot, name, value)
        i.step((tick - 1) * PERIOD)
        moments.append((i.active, dict(i.variables), i.now))
    for back in range(1, story.last_tick + 1):
        i.rewind(1)
        assert (i.active, dict(i.variables), i.now) == moments[-1 - back], f"{back} ticks back"
    assert i.tick == 0


def plain(variables):
    return {path: value for path, value in variables.items() if not callable(value)}
