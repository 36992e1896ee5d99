"""A transition or a state in the wrong form is moved to where it belongs."""

from __future__ import annotations

from checking import fixed, found
from support.tables import every

from lrp_jupyter.language.checks import check

TEXT = """\
(machine m
  (state a)
  (state b)
  (state c)
  (on [robot.x] a -> b)
  (on [robot.y] b -> c)
  (on [robot.z] c -> a))
(machine other
  (state d)
  (state e (onexit [robot.stop()]))
  (eps d -> e))
(spawn m a)
(spawn other d)
"""
LINES = ["  (on [robot.x] a -> b)\n", "  (on [robot.y] b -> c)\n", "  (eps d -> e)"]


@every("line", LINES)
@every("home", ["(state a)", "(state c)", "(spawn m a)"])
def test_a_transition_is_moved_to_its_machine_in_the_order_of_the_states(line: str, home: str) -> None:
    form = line.strip()
    inside = f"{home[:-1]} {form})" if "state" in home else f"{home} {form}"
    wrong = TEXT.replace(line, "").replace(home, inside)
    ((code, _),) = found(wrong)
    assert code == "LRP107"
    assert "".join(fixed(wrong).split()) == "".join(TEXT.split())


def test_lines_of_a_moved_transition_end_like_the_others() -> None:
    wrong = TEXT.replace(LINES[1], "").replace("(state c)", f"(state c {LINES[1].strip()})")
    windows = wrong.replace("\n", "\r\n")
    assert fixed(windows) == TEXT.replace("\n", "\r\n")


def test_a_state_is_moved_to_the_machine_whose_transitions_need_it() -> None:
    wrong = TEXT.replace("  (state b)\n", "").replace("(spawn m a)", "(state b)\n(spawn m a)")
    assert found(wrong) == [("LRP107", "state")]
    assert "c -> a) (state b))" in fixed(wrong)


@every("form", ["(on [robot.x] f -> g)", "(on [robot.x] *-> b)", "(state f)"])
def test_a_form_that_may_belong_to_several_machines_is_not_moved(form: str) -> None:
    wrong = TEXT.replace("(spawn m a)", f"{form}\n(spawn m a)")
    (finding,) = check(wrong)
    assert (finding.code, finding.fix) == ("LRP107", None)
