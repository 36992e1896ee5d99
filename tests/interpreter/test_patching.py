"""Edits of a running program beyond the rows of the table: events, issues, pauses, roots, what is refused."""

from support.story import active, started
from support.tables import every

from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Element

TEXT = """(var log := [[]])
(machine m
  (state a (onentry [log.append("A")]) (running [1 / 0]) (onexit [log.append("a")]))
  (state b)
  (on [robot.bumper] a -> b))
(machine other (state x) (state y))
(spawn m a)"""


def edited(i, old, new, **options):
    assert old in i.program.text
    return i.patch(parse(i.program.text.replace(old, new)), **options)


def test_a_restart_runs_no_onexit_has_a_reason_and_keeps_issues_and_the_pause():
    i, seen = started(TEXT, 2), []
    i.observe(lambda event: seen.append((event.kind, event.data)))
    log = i.variables["log"]
    i.pause()
    patch = edited(i, "1 / 0", "2 / 0", now=0.15)
    assert patch.restarted
    assert patch.changes.changed == (Element("running", ("m", "a")),)
    assert (log, i.active, dict(i.variables), i.paused, i.now) == (["A"], (), {}, True, 0.15)
    assert seen == [
        ("paused", None),
        ("restarted", "`a` is active and its `running` changed."),
        ("patched", patch),
    ]
    assert [(issue.count, issue.resolved) for issue in i.issues] == [(2, True)]
    i.step(0.2)
    assert [(issue.count, issue.resolved) for issue in i.issues] == [(3, False)]
    assert (i.paused, i.variables["log"]) == (True, ["A"])


def test_an_edit_while_paused_is_applied_at_once():
    i = started(TEXT)
    i.pause()
    edited(i, "(state b)", "(state b) (state c)")
    edited(i, "(var log", "(var k := [len(log)])(var log")
    edited(i, "(machine other", "(var late := [len(log)])(machine other")
    assert i.variables["late"] == 1
    i.transition_to("m/c")
    assert active(i) == ["m/c"]


@every("before", [lambda i: None, Interpreter.reset])
def test_an_edit_while_nothing_runs_does_not_restart(before):
    i = started(TEXT, 0)
    before(i)
    patch = edited(i, "(state a", "(state begin")
    assert (patch.applied, patch.restarted, patch.reason) == (True, False, None)
    edited(i, "(spawn m a)", "(spawn other x)")
    i.step(0.0)
    assert active(i) == ["other/x"]


def test_an_edit_that_is_not_applied_changes_nothing_and_the_next_is_compared_with_what_runs():
    i, seen = started(TEXT, 2), []
    i.observe(lambda event: seen.append(event.kind))
    program, issues = i.program, list(i.issues)
    patch = edited(i, "(state a", "(state aa")
    assert not patch.applied
    assert "The old program keeps running." in patch.reason
    assert i.program is program
    assert (list(i.issues), seen) == (issues, ["patched"])
    assert edited(i, "(state b)", "(state b) (state c)").applied
    assert active(i) == ["m/a"]


def test_a_transition_of_the_active_state_gets_another_destination_and_keeps_its_timer():
    i = started("(machine m (state a) (state b) (state c) (ontime 300 a -> b))(spawn m a)", 2)
    edited(i, "a -> b", "a -> c")
    i.step(0.2)
    assert active(i) == ["m/a"]
    i.step(0.3)
    assert active(i) == ["m/c"]


def test_a_delay_in_a_variable_counts_at_once_when_it_is_set_or_edited():
    i = started("(var wait := [9000])(machine m (state a) (state b) (ontime wait *-> b))(spawn m a)", 2)
    i.set_variable("wait", "100")
    i.step(0.2)
    assert active(i) == ["m/b"]
    i.transition_to("m/a")
    edited(i, "100" if "100" in i.program.text else "9000", "5")
    i.step(0.21)
    assert active(i) == ["m/b"]


def test_a_machine_moved_elsewhere_is_another_one():
    text = "(machine m (state a (onentry (spawn k s)) (machine k (state s))))(spawn m a)"
    i = started(text)
    patch = i.patch(parse("(machine k (state s))(machine m (state a (onentry (spawn k s))))(spawn m a)"))
    assert (patch.restarted, patch.reason) == (True, "The machine `k` is active and was removed or renamed.")


def test_a_root_that_was_forced_runs_on_whatever_is_spawned():
    i = started(TEXT, 2)
    i.teleport_to("other/y")
    assert not edited(i, "(state b)", "(state b) (state c)").restarted
    assert edited(i, "(spawn m a)", "(spawn m a)(spawn other x)").applied
    assert active(i) == ["m/a", "other/y"]
    assert [issue.code for issue in i.issues if not issue.resolved] == ["LRP601", "LRP608"]
    edited(i, "(spawn other x)", "")
    assert active(i) == ["m/a", "other/y"]
    assert edited(i, "(state y)", "(state z)").restarted


def test_a_root_that_was_forced_first_belongs_to_its_spawn():
    i = started(TEXT, 0)
    i.transition_to("m/b")
    assert not edited(i, "(state x)", "(state x) (state z)").restarted
    assert edited(i, "(spawn m a)", "(spawn other x)").restarted


def test_with_the_policy_keep_an_added_spawn_is_done_now_at_any_depth():
    text = """(machine m
      (state a (onentry (spawn k s)) (machine k (state s)) (machine l (var v := [1]) (state t))))"""
    i = started(text + "(spawn m a)", 1, on_active_edit="keep")
    edited(i, "(state s)", "(state s (onentry (spawn l t) (spawn l t)))")
    assert active(i) == ["m/a/k/s/l/t"]
    assert i.variables["m/a/k/s/l/v"] == 1
    assert [issue.code for issue in i.issues] == ["LRP608"]
    kept = edited(i, "(spawn m a)", "(spawn m b)")
    assert kept.reason == "`(spawn m a)` was removed. What it started keeps running."
    assert edited(i, "(spawn m b)", "(spawn l t)(spawn m a)").applied


def test_a_changed_initialiser_reads_the_robot_and_what_is_computed_from_it_follows():
    i = started("(var n := [1])(var twice := [n * 2])(machine m (var k := [twice]) (state a))(spawn m a)")
    seen = []
    i.observe(lambda event: seen.append((event.kind, event.path)))
    edited(i, "(var n := [1])", "(var n := [robot.light + 7])")
    assert dict(i.variables) == {("n",): 7, ("twice",): 14, ("m", "k"): 14}
    assert seen == [("patched", ()), ("changed", ("n",)), ("changed", ("twice",)), ("changed", ("m", "k"))]
    edited(i, "[twice]", "[twice / robot.light]")
    assert i.variables["m/k"] == 14
    assert [(issue.code, issue.element.path) for issue in i.issues] == [("LRP601", ("m", "k"))]


def test_only_the_first_of_two_definitions_counts_in_an_edit_too():
    i = started("(var n := [1])(machine m (state a (running [n])))(spawn m a)", 2)
    patch = i.patch(
        parse("(var n := [1])(var n := [2])(machine m (state a (running [n])) (state a))(spawn m a)")
    )
    assert (patch.restarted, bool(patch.changes), i.variables["n"]) == (False, False, 1)
    patch = i.patch(parse("(var n := [2])(var n := [1])(machine m (state a (running [n])))(spawn m a)"))
    assert (patch.restarted, i.variables["n"]) == (False, 2)
    assert all(issue.resolved for issue in i.issues if issue.element.kind == "state")


BLINK = """(machine m (state on) (state off)
  (ontime 100 on -> off) (on [gone] off -> on))
(spawn m on)"""


def test_a_transition_is_the_same_after_an_edit_of_its_delay():
    i, fired = started(BLINK, 0), []
    i.observe(lambda event: fired.append((event.path, event.data)) if event.kind == "fired" else None)
    for tick in range(3):
        i.step(tick / 10)
    patch = edited(i, "100", "300")
    assert patch.successors.of(Element("transition", ("m", "ontime:on->off"))) is not None
    i.transition_to("m/on", now=0.3)
    for tick in range(3, 8):
        i.step(tick / 10)
    (first, before), (second, after) = fired
    assert first == second == ("m", "ontime:on->off")
    assert (before.label, after.label) == ("100:on->off", "300:on->off")
    assert (before.source, before.destination) == ("on", "off")


def test_an_issue_of_a_transition_shows_its_label_and_is_kept_by_its_identity():
    i = started(BLINK, 4)
    (issue,) = i.issues
    assert issue.element == Element("transition", ("m", "on:off->on"))
    assert str(issue.element) == "transition `m/[gone]:off->on`"
    i.rename("state", "m/off", "dark")
    (moved,) = i.issues
    assert str(moved.element) == "transition `m/[gone]:dark->on`"
    i.step(0.4)
    assert [(issue.count, issue.resolved) for issue in i.issues] == [(4, False)]


def test_issues_of_transitions_that_share_a_name_are_not_confused():
    i = started(
        "(machine m (state a) (state b)  (on [one] a -> b t)\n  (on [two] {a b} -> a t)) (spawn m a)",
        2,
    )
    assert [str(issue.element) for issue in i.issues] == ["transition `m/t`", "transition `m/t#2`"]
    edited(i, "  (on [one] a -> b t)\n", "")
    (issue,) = [issue for issue in i.issues if not issue.resolved]
    assert (str(issue.element), issue.count) == ("transition `m/t`", 2)


def test_a_rename_hands_on_what_became_of_every_element():
    i, patches = started(BLINK), []
    i.observe(lambda event: patches.append(event.data) if event.kind == "patched" else None)
    i.rename("state", "m/on", "lit")
    kept = patches[0].successors.carry(
        {Element("state", ("m", "on")): 2, Element("transition", ("m", "ontime:on->off")): 1}
    )
    assert kept == {Element("state", ("m", "lit")): 2, Element("transition", ("m", "ontime:lit->off")): 1}
