"""What is half typed at the cursor waits, and everything else of the same text is applied."""

from support.tables import every

from lrp_jupyter.language.checks import check
from lrp_jupyter.language.half_typed import Cursor, judge, without_change
from lrp_jupyter.language.parser import scan
from lrp_jupyter.language.program import Span

BASE = """\
(var forward := [0.2])
(machine m
  (event far [forward > 1])
  (state left (running [forward]))
  (state right
    (machine inner (state x) (state y)))
  (on far left -> right)
  (ontime 500 right -> left))
(spawn m left)
"""


def judged(marked, running=BASE, meant=False):
    """Return the judgement of a text in which each `|` is a cursor."""
    *before, last = marked.split("|")
    text = "".join([*before, last])
    offsets = [len("".join(before[: n + 1])) for n in range(len(before))]
    program, findings = scan(text)
    if program is not None:
        findings = check(program)
    return judge(text, program, findings, [Cursor(each, meant) for each in offsets], scan(running)[0], check)


def codes(found):
    return [finding.code for finding in found.findings]


def edited(old, new):
    assert BASE.count(old) == 1
    return BASE.replace(old, new)


@every(
    ("old", "new", "reason"),
    [
        ("-> right", "-> righ|", "waits: `m` has no state `righ`"),
        ("(on far left", "(on fa| left", "waits: there is no event `fa` here"),
        ("(on far left", "(on far lef|", "waits: `m` has no state `lef`"),
        ("(spawn m left)", "(spawn m lef|)", "waits: `m` has no state `lef`"),
        ("(spawn m left)", "(spawn mm| left)", "waits: there is no machine `mm` that can be spawned here"),
        ("(running [forward])", "(running [forwa|])", "waits: `forwa` is not defined"),
        ("(var forward", "(var forwar|", "waits: `forward` is not defined"),
        ("(state left", "(state lef|", "waits: `m` has no state `left`"),
        ("(event far", "(event fa|", "waits: there is no event `far` here"),
        ("0.2", "0.|", "waits: `0.` is being typed"),
        ("500", "5000|", "waits: `5000` is being typed"),
    ],
)
def test_a_word_that_breaks_something_waits_and_what_was_there_goes_on(old, new, reason):
    found = judged(edited(old, new))
    assert found.unmeant.always
    assert found.unmeant.instead == scan(BASE)[0]
    assert found.unmeant.reason.startswith(reason)
    assert set(codes(found)) <= set(codes(judged(BASE + "|")))


def test_a_word_that_is_meant_does_not_wait_but_its_faults_do():
    found = judged(edited("-> right", "-> righ|"), meant=True)
    assert not found.unmeant.always
    assert found.unmeant.element == ("transition", ("m", "on:left->righ"))
    assert "LRP303" in codes(found)


def test_a_word_that_resolves_does_not_wait():
    assert judged(edited("left -> right", "left -> left|")).unmeant is None


def test_a_word_that_the_cursor_does_not_touch_is_meant():
    found = judged(edited("(on far left -> right)", "(on far left -> righ )|"))
    assert found.unmeant is None
    assert "LRP303" in codes(found)


def test_everything_else_of_the_same_text_is_applied():
    text = edited("0.2", "0.7").replace("-> right", "-> righ|") + "(machine other (state z))(spawn other z)"
    instead = judged(text).unmeant.instead
    expected = BASE.replace("0.2", "0.7") + "(machine other (state z))(spawn other z)"
    assert instead == scan(expected)[0]


def test_a_new_state_is_there_with_its_first_letter_and_without_a_mark():
    found = judged(edited("(on far", "(state r|) (on far"))
    assert found.hides
    assert not found.unmeant.always
    assert "LRP401" not in codes(found)


def test_a_new_transition_is_there_with_the_first_letter_of_its_destination():
    found = judged(edited("(ontime", "(on far left -> r|) (ontime"))
    assert not found.unmeant.always
    assert found.unmeant.element.kind == "transition"
    assert "LRP303" not in codes(found)
    again = judged(
        edited("(ontime", "(on far left -> re|) (ontime"), edited("(ontime", "(on far left -> r) (ontime")
    )
    assert not again.unmeant.always
    assert again.unmeant.element == ("transition", ("m", "on:left->re"))


def test_an_error_in_the_state_around_the_cursor_waits_for_what_is_active():
    found = judged(edited("(running [forward])", "(running [forwa * 2] |)"), meant=True)
    assert not found.unmeant.always
    assert found.unmeant.instead == scan(BASE)[0]
    assert "LRP502" in codes(found)


@every(
    "new",
    ["(sta|)", "(|)", "(state|)", "(on f|)", "(ontime 500|)", "(ontime 500 left ->|)", "(state a (o|))"],
)
def test_a_form_that_is_being_typed_has_no_mark(new):
    found = judged(edited("(on far", f"{new} (on far"))
    assert (found.program, codes(found), found.hides) == (None, [], True)
    assert codes(judged(edited("(on far", f"{new} (on far"), meant=True)) != []


def test_a_robots_member_that_is_being_typed_has_no_mark():
    found = judged(edited("[forward]", "[robot.|]"))
    assert (found.program, codes(found), found.hides) == (None, [], True)


def test_a_text_that_is_not_a_program_is_judged_as_soon_as_its_last_word_is_meant():
    text = edited("[forward])", "[forward]").replace("(on far", "(sta|) (on far")
    assert (codes(judged(text)), judged(text).half_typed) == ([], True)
    assert codes(judged(text, meant=True))[0] == "LRP101"


@every("end", ["\n", "\r\n", "\r"])
def test_only_the_change_at_the_cursor_is_undone(end):
    old = BASE.replace("\n", end)
    text = old.replace("0.2", "0.3").replace("far left", "fa left").replace("500", "700")
    at = text.index("fa left")
    without = without_change(scan(text)[0], scan(old)[0], Span(at, at + 2))
    assert without.text == old.replace("0.2", "0.3").replace("500", "700")


def test_changes_that_cannot_be_separated_wait_together():
    program = scan("(machine a (state b))")[0]
    assert (
        without_change(program, scan("(var x := [1])")[0], program.machines[0].span).text == "(var x := [1])"
    )


def test_changes_far_apart_are_separated():
    lines = "".join(f"  (state s{number} (running [forward]))\n" for number in range(600))
    old = BASE.replace("  (on far", f"{lines}  (on far")
    text = old.replace("0.2", "0.3").replace("far left", "fa left")
    program, before = scan(text)[0], scan(old)[0]
    assert program is not None
    assert before is not None
    at = text.index("fa left")
    assert without_change(program, before, Span(at, at + 2)).text == old.replace("0.2", "0.3")


@every(
    ("marked", "running"),
    [
        (BASE.replace("0.2", "0.2|"), BASE),
        (BASE.replace("0.2", "0.20|"), BASE),
        (BASE + "; about 25|", BASE),
    ],
)
def test_a_number_that_changes_nothing_does_not_wait(marked, running):
    assert judged(marked, running).unmeant is None


# -- two hands -------------------------------------------------------------------------------------


def test_two_half_typed_words_both_wait_and_everything_else_is_applied():
    text = (
        edited("0.2", "0.|").replace("-> right", "-> righ|").replace("(state left", "(state mid) (state left")
    )
    found = judged(text)
    assert found.unmeant.always
    assert found.unmeant.instead.text == BASE.replace("(state left", "(state mid) (state left")
    assert not [code for code in codes(found) if code.startswith("LRP3")]
    assert found.half_typed


def test_a_word_of_one_hand_waits_while_the_cursor_of_the_other_is_elsewhere():
    for text in (edited("-> right", "-> righ|") + "|", "|" + edited("-> right", "-> righ|")):
        found = judged(text)
        assert found.unmeant.instead == scan(BASE)[0]
        assert found.unmeant.reason == "waits: `m` has no state `righ`"


def test_a_word_that_is_typed_at_several_cursors_waits_where_it_would_restart_the_program():
    text = BASE.replace("(state left", "(state le|").replace("far left", "far le|").replace("m left", "m le|")
    found = judged(text.replace("-> left", "-> le|"))
    assert codes(found) == codes(judged(BASE + "|"))
    assert found.half_typed
    assert not found.unmeant.always
    assert found.unmeant.instead == scan(BASE)[0]
    assert judged(BASE.replace("left", "left|")).unmeant is None


def test_two_hands_in_one_word_wait_for_each_other():
    assert judged(edited("-> right", "-> ri|gh|")).unmeant.instead == scan(BASE)[0]


def test_a_word_inside_a_state_that_waits_waits_with_it():
    running = BASE.replace("(running [forward])", "(running [forward]) (onexit [forward])")
    marked = running.replace("(onexit [forward])", "(onexit [forwa]|)").replace(
        "(running [forward]", "(running [0.|]"
    )
    found = judged(marked, running)
    assert found.unmeant.instead.text == running


def test_forms_that_two_hands_are_typing_have_no_mark():
    both = edited("(spawn m left)", "(spawn m left) (mach|").replace("(event far", "(eve|\n  (event far")
    assert len(judged(both).findings) < len(judged(both, meant=True).findings)
