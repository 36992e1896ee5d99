"""One law for every command that takes an element: which spellings it accepts, and how it refuses others."""

import re

import pytest
from support.bench import Bench
from support.tables import every
from typer.testing import CliRunner

from lrp_jupyter.cli import app
from lrp_jupyter.errors import UnknownElementError
from lrp_jupyter.graph.still import svg
from lrp_jupyter.language.edits import drawing
from lrp_jupyter.language.edits.initials import with_initial
from lrp_jupyter.language.edits.rename import rename
from lrp_jupyter.language.lookup import find
from lrp_jupyter.language.parser import parse
from lrp_jupyter.live.session import Session

TWIN = """
(machine {0} (var vera := [1]) (event eric [False])
  (state sally (machine mia (state inside))) (on [False] sally -> sally tom))
(spawn {0} sally)"""
TEXT = (
    """(machine kernel (var volume := [1]) (event eclipse [False])
  (state xray) (state yard) (on eclipse xray -> yard going) (on eclipse yard -> xray))
(machine main (state alone (onentry (spawn kernel xray))))
(spawn main alone)"""
    + TWIN.format("peter")
    + TWIN.format("quentin")
)
SPELLINGS = {
    "state": ["kernel/xray", "xray", ("kernel", "xray"), ("xray",), "main/alone/kernel/xray", "/kernel/xray"],
    "transition": ["kernel/going", "going", ("kernel", "going"), "main/alone/kernel/going", "kernel:going"],
    "event": ["kernel/eclipse", "eclipse", ("eclipse",), "main/alone/kernel/eclipse"],
    "variable": ["kernel/volume", "volume", ("volume",), "main/alone/kernel/volume"],
    "machine": ["kernel", ("kernel",), "main/alone/kernel", "kernel/"],
}
TYPOS = {
    "state": ("xrax", "xray"),
    "transition": ("goink", "going"),
    "event": ("eclipze", "eclipse"),
    "variable": ("volumme", "volume"),
    "machine": ("kernle", "kernel"),
}
TWINS = {"state": "sally", "transition": "tom", "event": "eric", "variable": "vera", "machine": "sally/mia"}


def in_session(ask):
    """Make a command from what a session does: its answer, and what has become of the session."""

    def command(wanted):
        with Session(TEXT) as session:
            session.run(0.3)
            answer = ask(session, wanted)
            frame = session.frame
            return answer, frame.active, dict(frame.values), [each.message for each in session.issues]

    return command


def drawn(act, *more):
    return lambda wanted: act(TEXT, wanted, *more)


def on_page(act, kind, **more):
    """Make a command from what a page sends: always texts."""

    def command(wanted):
        bench = Bench(TEXT)
        try:
            bench.session.step()
            text = wanted if isinstance(wanted, str) else "/".join(wanted)
            answer = bench.page().ask(act, kind=kind, path=text, **more)
            if answer["error"]:
                raise UnknownElementError(answer["error"])
            return answer
        finally:
            bench.connection.close()

    return command


def on_command_line(*arguments):
    """Make a command from the arguments of `lrp`, in which `{}` is the element: always a text."""

    def command(wanted):
        text = wanted if isinstance(wanted, str) else "/".join(wanted)
        written = [each.format(text) for each in arguments]
        done = CliRunner().invoke(app, written, prog_name="lrp", input=TEXT)
        if isinstance(done.exception, Exception):
            raise done.exception
        if done.exit_code == 2:
            raise UnknownElementError(" ".join(done.stderr.replace("│", " ").split()))
        return re.sub(r"--fire \S+|[0-9.]+ times real time", "", done.stdout)

    return command


RUN = ("run", "-", "--speed", "max", "--for", "1")
ANY = {  # several states of a name can be waited for
    "until": ("state", in_session(lambda s, wanted: s.run(1, until=wanted))),
    "lrp run --until": ("state", on_command_line(*RUN, "--until", "{}")),
}
COMMANDS = ANY | {
    "pause_when entered": ("state", in_session(lambda s, wanted: s.pause_when(wanted))),
    "pause_when left": ("state", in_session(lambda s, wanted: s.pause_when(left=wanted))),
    "pause_when fires": ("transition", in_session(lambda s, wanted: s.pause_when(fires=wanted))),
    "pause_when event": ("event", in_session(lambda s, wanted: s.pause_when(event=wanted))),
    "pause_when machine": (
        "machine",
        in_session(lambda s, wanted: s.pause_when(condition="volume > 1", machine=wanted)),
    ),
    "why": ("state", in_session(lambda s, wanted: str(s.why(wanted)))),
    "why_not": ("transition", in_session(lambda s, wanted: str(s.why_not(wanted)))),
    "explain a state": ("state", in_session(lambda s, wanted: str(s.explain(wanted)))),
    "explain a transition": ("transition", in_session(lambda s, wanted: str(s.explain(wanted)))),
    "transition_to": ("state", in_session(lambda s, wanted: s.transition_to(wanted))),
    "teleport_to": ("state", in_session(lambda s, wanted: s.teleport_to(wanted))),
    "fire": ("transition", in_session(lambda s, wanted: s.fire(wanted))),
    "set_variable": ("variable", in_session(lambda s, wanted: s.set_variable(wanted, 5))),
    "variables": ("variable", in_session(lambda s, wanted: s.variables.__setitem__(wanted, 6))),
    "the value of a variable": ("variable", in_session(lambda s, wanted: s.variables[wanted])),
    "a variable of a frame": ("variable", in_session(lambda s, wanted: s.at(0.2).variables[wanted])),
    "plots": (
        "variable",
        in_session(lambda s, wanted: s.plots([wanted if isinstance(wanted, str) else "/".join(wanted)])),
    ),
    "plots of an event": ("event", in_session(lambda s, wanted: s.plots(event=wanted))),
    "svg": ("machine", lambda wanted: svg(parse(TEXT), machine_path=wanted)),
    "with_initial": ("variable", lambda wanted: with_initial(TEXT, wanted, "7")),
    "new_state": ("machine", drawn(drawing.new_state, "fresh")),
    "delete_state": ("state", drawn(drawing.delete_state)),
    "start_in": ("state", drawn(drawing.start_in)),
    "new_form": ("state", drawn(drawing.new_form, "onexit [pass]")),
    "reverse": ("transition", drawn(drawing.reverse)),
    "delete_transition": ("transition", drawn(drawing.delete_transition)),
    "delete_machine": ("machine", drawn(drawing.delete_machine)),
    "lrp graph": ("machine", on_command_line("graph", "-", "--machine", "{}")),
    "lrp run --break": ("state", on_command_line(*RUN, "--break", "{}")),
    "lrp run --break of a transition": ("transition", on_command_line(*RUN, "--break", "{}")),
    "lrp run --break left": ("state", on_command_line(*RUN, "--break", "left {}")),
    "lrp run --break event": ("event", on_command_line(*RUN, "--break", "event {}")),
    "lrp run --fire": ("transition", on_command_line(*RUN, "--fire", "{}@0.5")),
    "lrp run --set": ("variable", on_command_line(*RUN, "--set", "{}=8")),
    **{
        f"rename {kind}": (kind, lambda wanted, kind=kind: rename(parse(TEXT), kind, wanted, "renamed"))
        for kind in SPELLINGS
    },
    **{f"inspect {kind}": (kind, on_page("inspect", kind, into=[])) for kind in SPELLINGS},
}


def told(command, wanted):
    """Return the refusal of a command."""
    try:
        _, _, _, issues = command(wanted)
    except UnknownElementError as error:
        return str(error)
    return issues[0]


@pytest.mark.slow
@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_accepts_the_same_spellings(name):
    kind, command = COMMANDS[name]
    first, *others = SPELLINGS[kind]
    expected = command(first)
    for other in others:
        assert command(other) == expected, other


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_says_in_the_same_words_that_there_is_no_such_element(name):
    kind, command = COMMANDS[name]
    typo, meant = TYPOS[kind]
    words = rf"There is no ([a-z, ]*\b)?{kind}\b[a-z, ]* `{typo}`.* Did you mean `{meant}`\?"
    assert re.search(words, told(command, typo)), told(command, typo)


@pytest.mark.parametrize("name", [name for name in COMMANDS if name not in ANY])
def test_every_command_says_in_the_same_words_that_there_are_several(name):
    kind, command = COMMANDS[name]
    name, ways = TWINS[kind].split("/")[-1], [f"{each}/{TWINS[kind]}" for each in ("peter", "quentin")]
    words = f"Several {kind}s are called `{name}`. Use one of `{ways[0]}`, `{ways[1]}`."
    assert words in told(command, name)


def test_an_exact_path_is_meant_though_others_have_the_same_name():
    program = parse("(event odd [True]) (machine m (event odd [False]) (state a)) (spawn m a)")
    assert find(program, "event", ("odd",)).path == ("odd",)
    assert find(program, "event", "m/odd").path == ("m", "odd")


@every("spelling", ["[n / 2 > 1]:a->b", "m/[n / 2 > 1]:a->b", "on:a->b", "m/on:a->b", "m:on:a->b"])
def test_a_transition_without_a_name_is_called_by_its_label_or_id(spelling):
    program = parse("(machine m (state a) (state b) (on [n / 2 > 1] a -> b)) (spawn m a)")
    assert find(program, "transition", spelling).path == ("m", "on:a->b")


@every("path", ["main/xray/kernel/xray", "peter/sally/kernel/xray", "main/alone/xray", "kernel/xray/xray"])
def test_a_path_that_nothing_spawns_is_no_path(path):
    with pytest.raises(UnknownElementError, match="There is no state"):
        find(parse(TEXT), "state", path)
