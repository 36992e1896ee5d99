"""Typing into a running session, letter by letter, with the cursor."""

import pytest
from support.tables import every

from lrp_jupyter import Session
from lrp_jupyter.language.half_typed import Cursor
from lrp_jupyter.live.clock import VirtualClock

START = """\
(var speed := [1])
(machine follower
  (event off [True])
  (state moving)
  (state looking (running [speed])
    (machine lookalgo (state lookleft)))
  (on off moving -> looking))
(spawn follower moving)
"""
HALF_TYPED = [
    ("(on off moving -> looking)", " (on off looking -> lookdown", ")"),
    ("(on off moving -> looking)", " (on off * -> lookdown", ")"),
    ("(on off moving -> looking)", " (eps looking -> lookdown", ")"),
    ("(state lookleft)", " (exit off lookleft -> lookdown", ")"),
    ("(state moving)", " (state other (onentry (spawn lookalgo lookdown", ")))"),
    ("(on off moving -> looking)", " (on [unknown", "] looking -> moving)"),
    ("(running [speed", "; unknown", ""),
]
CONDITIONS = [
    ("(on off moving -> looking)", " (on [speed == 2", "] looking -> moving)"),
    ("(on off moving -> looking)", " (on [off and elapsed", " and dt] looking -> moving)"),
    ("(on off moving -> looking)", " (on off for [speed > 1.5", "] looking -> moving)"),
    ("(event off [True])", " (event slow [lookalgo.state == 'x'", "]) (on slow looking -> moving)"),
]
UNKNOWN_MACHINE = ("(spawn follower moving)", " (spawn other lookdown", ")")  # an error away from the cursor


class Typist:
    """A session and its text, which changes letter by letter."""

    def __init__(self, text=START, types_slowly=False, **options):
        self.types_slowly = types_slowly
        self.session = Session(text, clock=VirtualClock(), **options)
        self.text = text
        self.session.step()
        self.session.step()

    def types(self, before, letters, brackets="", meant=False):
        """Type after a piece of the text, brackets closed at once; return the last patch."""
        at = self.text.index(before) + len(before)
        self.text = self.text[:at] + brackets + self.text[at:]
        for letter in letters:
            self.text = self.text[:at] + letter + self.text[at:]
            at += 1
            patch = self.offers(at)
            self.session.step()
            if self.types_slowly:
                self.offers(at, True)
                self.session.step()
        if meant:
            patch = self.offers(at, True)
            self.session.step()
        return patch

    def replaces(self, old, new, meant=False):
        at = self.text.index(old)
        self.text = self.text.replace(old, new)
        patch = self.offers(at + len(new), meant)
        self.session.step()
        return patch

    def offers(self, at, meant=False):
        _, answer = self.session.offer(self.text, Cursor(at, meant))
        return answer.result()

    @property
    def restarts(self):
        return self.session.interpreter.restarts


def test_a_spawn_typed_into_the_active_state_restarts_once():
    typist = Typist()
    patch = typist.types("(state lookleft))", " (onentry (spawn lookalgo lookleft", "))")
    assert patch.applied
    assert patch.restarted
    assert typist.restarts == 1
    assert typist.session.issues == ()


def test_while_the_cursor_is_in_the_active_state_an_error_in_it_waits_even_if_it_is_meant():
    typist = Typist()
    patch = typist.types("(state lookleft))", " (onentry (spawn lookalgo loo", "))", meant=True)
    assert (patch.applied, patch.restarted, typist.restarts) == (False, False, 0)
    assert patch.reason == "waits: `lookalgo` has no state `loo`"
    assert "LRP305" in [finding.code for finding in typist.session.findings]
    assert typist.offers(0, True).restarted


@pytest.mark.slow
@every(("before", "letters", "brackets"), [*HALF_TYPED, *CONDITIONS, UNKNOWN_MACHINE])
def test_what_is_half_typed_is_no_fault_in_the_timeline_either(before, letters, brackets):
    for mode in ("restart", "keep"):
        typist = Typist(on_active_edit=mode)
        typist.types(before, letters, brackets)
        assert typist.session.issues == ()
        assert [each for each in typist.session.timeline().happenings if each.kind == "issue"] == []


@every(("before", "letters", "brackets"), HALF_TYPED)
def test_who_types_slowly_makes_no_faults_either(before, letters, brackets):
    typist = Typist(types_slowly=True)
    typist.types(before, letters, brackets)
    assert [each for each in typist.session.timeline().happenings if each.kind == "issue"] == []


def test_the_transition_that_the_cursor_has_left_fails_and_that_is_told():
    typist = Typist()
    typist.types("(on off moving -> looking)", " (on off looking -> lookdown", ")", meant=True)
    assert "LRP303" in [finding.code for finding in typist.session.findings]
    typist.offers(0, True)
    typist.session.step()
    (told,) = [each for each in typist.session.timeline().happenings if each.kind == "issue"]
    assert told.text == "The machine `follower` has no state `lookdown`."
    assert "has no state `lookdown`" in str(typist.session.why_not("off:looking->lookdown"))


def test_a_condition_that_is_left_half_typed_fails_and_that_is_told():
    typist = Typist()
    typist.types("(on off moving -> looking)", " (on [speed ", "] looking -> moving)", meant=True)
    typist.session.step()
    (told,) = [each for each in typist.session.timeline().happenings if each.kind == "issue"]
    assert told.text.startswith("A condition must be True or False, not 1.")


WHOLE = """\
(event near [False])
(machine move
  (var side := [1])
  (state send)
  (state reached (running [side]))
  (eps send -> reached))
(machine m
  (state carrying (onentry (spawn move send)) (running [near]))
  (state look)
  (on near look -> carrying))
(spawn m carrying)
"""
NESTED = WHOLE.replace(
    "(running [near])",
    "(running [near])\n    (machine inner (state x (onentry (spawn move send))) (state y))",
).replace("(onentry (spawn move send)) (running", "(onentry (spawn inner x)) (running")
FORMS = [
    ("(on near look -> carrying)", " (on move.reached look -> carrying", ")"),
    ("(on near look -> carrying)", " (on move.reached", " look -> carrying)"),
    ("(on near look -> carrying)", " (on near for 2000 carrying -> look", ")"),
    ("(on near", " for [move.side * 2000", "]"),
    ("(on near look -> carrying", " (effect [move.side; near", "])"),
    ("(on near look -> carrying", " named (effect [near", "])"),
    ("(eps send -> reached)", " (on [near and elapsed > dt", "] reached -> send)"),
    ("(spawn move send", " (var side := [-1", "])"),
    ("(spawn move send", " (var side := [-1]) (var side := [near", "])"),
]


@pytest.mark.slow
@every(
    ("letters", "brackets"),
    [
        (" (on move.send for 90 y -> x", ")"),
        (" (on move.send", " y -> x)"),
        (" (on near for 90 x -> y", ")"),
        (" (exit near for [move.side * 20", "] x -> look)"),
        (" (on [near and move.state == 'send' and elapsed", "] x -> y)"),
        (" (on near x -> y (effect [move.side", "]))"),
    ],
)
def test_no_letter_of_a_form_inside_an_active_state_restarts_or_fails(letters, brackets):
    for types_slowly in (False, True):
        typist = Typist(NESTED, types_slowly)
        patch = typist.types("(state y)", letters, brackets, meant=True)
        assert (patch.applied, typist.restarts) == (True, 0)
        assert typist.session.program.text == typist.text
        assert [each for each in typist.session.timeline().happenings if each.kind == "issue"] == []


@pytest.mark.slow
@every(("before", "letters", "brackets"), FORMS)
def test_no_letter_of_a_form_beside_what_runs_restarts_or_fails(before, letters, brackets):
    for types_slowly in (False, True):
        typist = Typist(WHOLE, types_slowly)
        patch = typist.types(before, letters, brackets, meant=True)
        assert (patch.applied, typist.restarts) == (True, 0)
        assert typist.session.program.text == typist.text
        assert [each for each in typist.session.timeline().happenings if each.kind == "issue"] == []
        assert typist.session.frame.active == (("m", "carrying", "move", "reached"),)


@pytest.mark.slow
@every(
    ("before", "letters", "brackets"),
    [
        ("(on near look -> carrying)", " (on move.sen", " carrying -> look)"),
        ("(on near look -> carrying)", " (on move.sen", "d carrying -> look)"),
        (
            "(on near look -> carrying)",
            " (on [near and move.state == 'send' and move.si",
            "] carrying -> look)",
        ),
        ("(on near look -> carrying)", " (eps look -> look (effect [move.si", "]))"),
    ],
)
def test_a_half_typed_name_of_what_is_in_a_machine_is_no_fault(before, letters, brackets):
    for types_slowly in (False, True):
        typist = Typist(WHOLE, types_slowly)
        typist.types(before, letters, brackets)
        assert [each for each in typist.session.timeline().happenings if each.kind == "issue"] == []
        assert typist.restarts == 0
        codes = {each.code for each in typist.session.findings if each.severity == "error"}
        assert types_slowly or not codes


def test_the_name_of_a_state_that_a_transition_waits_for_waits_until_it_is_whole():
    typist = Typist(WHOLE.replace("(on near look -> carrying)", "(on move.send carrying -> look)"))
    patch = typist.replaces("move.send", "move.sen")
    assert (patch.applied, patch.reason) == (False, "waits: `move` has no state `sen`")
    assert typist.session.findings == typist.session.check(typist.session.program)
    typist.replaces("move.sen", "move.send")
    patch = typist.replaces("(on move", "(on mov")
    assert (patch.applied, patch.reason[:32]) == (False, "waits: there is no machine `mov`")


def test_a_setting_typed_into_a_spawn_counts_when_it_is_meant_and_is_the_machines_own_again_without_it():
    typist = Typist(WHOLE)
    typist.types("(spawn move send", " (var side := [-1", "])")
    path = ("m", "carrying", "move", "side")
    assert typist.session.frame.values[path] == 1
    typist.offers(typist.text.index("-1") + 2, True)
    typist.session.step()
    assert typist.session.frame.values[path] == -1
    typist.replaces(" (var side := [-1])", "")
    assert (typist.session.frame.values[path], typist.restarts) == (1, 0)


def test_a_kept_program_does_not_run_an_error_in_its_active_state_either():
    typist = Typist(on_active_edit="keep")
    patch = typist.replaces("(running [speed])", "(running [spee])", meant=True)
    assert not patch.applied
    assert typist.session.issues == ()


def test_a_destination_typed_letter_by_letter_raises_no_issue_and_does_not_pause():
    typist = Typist(on_issue="pause")
    typist.types("(on off moving -> looking)", " (on off looking -> res", ")")
    machine = typist.session.program.machines[0]
    assert [str(each.destination) for each in machine.transitions] == ["looking", "res"]
    assert typist.session.issues == ()
    assert typist.session.status == "paused"  # by `step`, not for a reason
    assert typist.session.frame.reason == ""
    typist.types("looking -> res", "ting", meant=True)
    assert typist.session.issues == ()
    typist.offers(0, True)
    typist.session.step()
    (issue,) = typist.session.issues
    assert "resting" in issue.message


def test_a_number_takes_effect_when_it_is_meant():
    typist = Typist()
    assert not typist.replaces("[1", "[15").applied
    assert typist.session.variables["speed"] == 1
    assert typist.offers(typist.text.index("15") + 2, True).applied
    assert typist.session.variables["speed"] == 15


def test_renaming_the_active_state_letter_by_letter_restarts_when_it_is_meant():
    typist = Typist()
    for name in ("lookin", "looki", "looks", "looksy"):
        typist.text = START.replace("(state looking", f"(state {name}")
        assert not typist.offers(typist.text.index("(state look") + 7 + len(name)).restarted
    assert typist.session.frame.is_active("looking")
    assert typist.session.issues == ()
    patch = typist.offers(0, True)
    assert patch.restarted


def test_everything_else_of_a_text_is_applied_while_a_word_waits():
    typist = Typist()
    typist.text = START.replace("[1]", "[3]").replace("-> looking", "-> lookin")
    patch = typist.offers(typist.text.index("-> lookin") + 9)
    assert not patch.applied
    assert typist.session.variables["speed"] == 3
    assert typist.session.program.text == START.replace("[1]", "[3]")


def test_without_a_cursor_nothing_waits():
    typist = Typist()
    typist.session.edit(
        START.replace("(state lookleft))", "(state lookleft)) (onentry (spawn lookalgo loo))")
    )
    assert typist.restarts == 1
