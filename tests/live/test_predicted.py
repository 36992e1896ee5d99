"""A fault that the checks have found is told once, though it also occurs in a run."""

from support.tables import every

from lrp_jupyter import Session
from lrp_jupyter.codes import CODES
from lrp_jupyter.live import predicted

ELSEWHERE = {"LRP312"}  # the recursion ends in any of the events
LATER = {"LRP303", "LRP306", "LRP307", "LRP527", "LRP533"}  # their examples do not get there in six ticks
PREDICTING = sorted({code for codes in predicted.CODES.values() for code in codes} - ELSEWHERE - LATER)


@every("code", PREDICTING)
def test_the_issues_of_the_example_of_a_finding_are_its_own(code):
    with Session(CODES[code].example, bridge="sim") as session:
        findings = session.check(session.program)
        for _ in range(6):
            session.step()
        told = {getattr(predicted.finding_of(issue, findings), "code", issue) for issue in session.issues}
    assert told == {code}


def test_of_two_findings_in_a_line_an_issue_is_about_the_nearer_one():
    text = "(machine m (state a) (on one a -> a) (on [True] a -> b)) (machine n (state a) (on two a -> a))"
    with Session(f"{text} (spawn n a)") as session:
        session.step()
        session.step()
        (issue,) = session.issues
        found = predicted.finding_of(issue, session.check(session.program))
        assert "`two`" in found.message
