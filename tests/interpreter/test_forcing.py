"""Forced states, in combination with timers, exits, spawns that dangle and edits."""

import pytest
from support.story import active, started
from support.tables import every

from lrp_jupyter.errors import UnknownElementError
from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.language.parser import parse

BOTH = pytest.mark.parametrize("force", [Interpreter.transition_to, Interpreter.teleport_to])
DEEP = """(machine m (state z)
  (state a (onentry (spawn other o)) (machine k (var n := [1]) (state s (machine j (state t)))))
  (ontime 100 a -> z))
(machine other (state o))
(spawn m z)"""


@BOTH
def test_timers_of_all_states_on_the_way_start_now(force):
    i = started(DEEP)
    force(i, "m/a/k/s/j/t", now=5.0)
    assert [i.entered(path) for path in ("m/a", "m/a/k/s", "m/a/k/s/j/t")] == [5.0] * 3
    i.step(5.05)
    assert active(i) == ["m/a/other/o", "m/a/k/s/j/t"]
    i.step(5.1)
    assert active(i) == ["m/z"]


@BOTH
def test_a_timer_of_an_enclosing_state_that_stays_continues(force):
    i = started(DEEP)
    force(i, "m/a", now=1.0)
    force(i, "m/a/k/s", now=1.09)
    assert active(i) == ["m/a/other/o", "m/a/k/s"]
    i.step(1.1)
    assert active(i) == ["m/z"]


@BOTH
def test_a_machine_made_on_the_way_can_exit(force):
    i = started(
        "(machine m (state z) (state a (machine k (state s) (exit [True] s -> z))))(spawn m z)",
    )
    force(i, "m/a/k/s")
    i.step(0.1)
    assert active(i) == ["m/z"]


@BOTH
def test_a_machine_that_only_one_state_spawns_is_forced_to_run_there(force):
    i = started("(machine h (state p))(machine m (state z) (state y (onentry (spawn h p))))(spawn m z)")
    force(i, "h/p")
    assert active(i) == ["m/y/h/p"]
    assert not i.issues


@BOTH
def test_a_spawn_of_the_target_that_dangles_is_an_issue(force):
    i = started("(machine m (state z) (state a (onentry [1 / 0] (spawn nope x))))(spawn m z)")
    force(i, "m/a")
    codes = [issue.code for issue in i.issues]
    assert codes == (["LRP605"] if force is Interpreter.teleport_to else ["LRP601", "LRP605"])
    assert active(i) == ["m/a"]


@BOTH
def test_a_target_in_a_helper_stays_in_the_helper(force):
    i = started(
        """(machine h (state p) (state q (onentry (spawn k s)) (machine k (state s) (state t))))
        (machine m (state a (onentry (spawn h p) (spawn n x)) (machine n (state x))))
        (spawn m a)"""
    )
    force(i, "h/q/k/t")
    assert active(i) == ["m/a/h/q/k/t", "m/a/n/x"]
    force(i, "m/a/h/q")
    assert active(i) == ["m/a/h/q/k/s", "m/a/n/x"]
    force(i, "m/a")
    assert active(i) == ["m/a/h/p", "m/a/n/x"]


@BOTH
def test_leaving_by_force_discards_in_reverse_order_of_spawning_and_is_reported(force):
    i, seen = started(DEEP), []
    force(i, "m/a/k/s/j/t")
    i.observe(lambda event: seen.append(f"{event.kind} {'/'.join(event.path)}"))
    force(i, "m/z")
    assert seen == [
        "forced m/z",
        "left m/a/k/s/j/t",
        "discarded m/a/k/s/j",
        "left m/a/k/s",
        "discarded m/a/k",
        "left m/a/other/o",
        "discarded m/a/other",
        "left m/a",
        "entered m/z",
    ]


@BOTH
def test_a_forced_state_is_as_active_as_any_for_an_edit(force):
    i = started(DEEP)
    force(i, "m/a/k/s")
    assert i.patch(parse(DEEP.replace("(var n := [1])", "(var n := [2])"))).reason is None
    assert i.variables["m/a/k/n"] == 2
    patch = i.patch(parse(DEEP.replace("(state s ", "(state s (running [1]) ")))
    assert (patch.restarted, patch.reason) == (True, "`s` is active and its `running` changed.")


@BOTH
def test_reset_forgets_what_waits_for_the_next_tick(force):
    i = started("(machine m (state a) (state b))(machine k (state s))(spawn m a)(spawn k s)", 0)
    force(i, "m/b")
    i.reset()
    i.step(0.0)
    assert active(i) == ["m/a", "k/s"]


@BOTH
def test_force_with_nothing_active_initialises_the_globals_first(force):
    i, seen = started("(var n := [3])(machine m (var k := [n]) (state a))(spawn m a)", 0), []
    i.observe(lambda event: seen.append(event.kind))
    force(i, "m/a")
    assert dict(i.variables) == {("n",): 3, ("m", "k"): 3}
    assert seen == ["forced", "started", "spawned", "entered", "changed", "changed"]
    i.reset()
    force(i, "m/a", now=2.0)
    assert (i.variables["n"], i.entered("m/a"), i.tick) == (3, 2.0, 0)


@every(
    "act",
    [
        lambda i: i.transition_to("m/b"),
        lambda i: i.pause(),
        lambda i: i.patch(parse(i.program.text.replace("[0]", "[raise KeyboardInterrupt]"))),
    ],
)
def test_an_interruption_passes_when_the_command_is_whole(act):
    i = started(
        "(var n := [0])(machine m (state a) (state b (onentry [raise KeyboardInterrupt])))"
        "(spawn m a)(onpause [raise KeyboardInterrupt])"
    )
    with pytest.raises(KeyboardInterrupt):
        act(i)
    assert not i.issues
    i.step(0.1)
    assert i.variables["n"] == 0


LOGGED = """(var log := [""])
(machine helper (state p (onexit [log += "p"])) (state q)
  (on [False] p -> q go) (exit [False] p -> b out))
(machine m
  (state a (onentry (spawn helper p)) (onexit [log += "a"]))
  (state b (onentry [log += "b"]))
  (ontime 9000 *-{b} -> b late) (on [False] b -> nowhere lost))
(spawn m a)
"""


def test_a_transition_is_fired_by_hand_whatever_it_waits_for():
    i = started(LOGGED)
    seen = []
    i.observe(seen.append)
    i.fire("m/late", now=5.0)
    assert (active(i), i.variables["log"]) == (["m/b"], "pab")
    assert seen[0][:] == ("forced", ("m", "b"), i.tick, 5.0, "fire")
    assert not i.firings, "the program has fired nothing"


@pytest.mark.parametrize("path", ["helper/out", "m/a/helper/out"])
def test_an_exit_that_is_fired_by_hand_leads_out_of_where_its_machine_was_spawned(path):
    i = started(LOGGED)
    i.fire(path)
    assert (active(i), i.variables["log"]) == (["m/b"], "pab")


@pytest.mark.parametrize(
    ("path", "error", "told"),
    [
        ("m/lat", UnknownElementError, "There is no transition `m/lat`. Did you mean `m/late`?"),
        ("m/a", UnknownElementError, "`m/a` is a state, not a transition."),
        ("helper/go", ValueError, "None of the states that `go` leaves is active: p."),
        ("m/late", ValueError, "None of the states that `late` leaves is active: *-{b}."),
        ("m/lost", ValueError, "The machine `m` has no state `nowhere`."),
    ],
)
def test_a_transition_that_cannot_be_fired_is_refused_and_changes_nothing(path, error, told):
    i = started(LOGGED)
    i.teleport_to("m/b", now=0.5)
    with pytest.raises(error) as raised:
        i.fire(path, now=0.7)
    assert str(raised.value).startswith(told)
    assert (active(i), i.variables["log"], i.now) == (["m/b"], "", 0.5)


def test_nothing_can_be_fired_before_the_first_tick():
    with pytest.raises(ValueError, match="None of the states that `late` leaves is active"):
        Interpreter(parse(LOGGED)).fire("m/late")
