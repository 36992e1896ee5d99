"""Three exercises, as a student does them: a wrong answer, a hint, the right one; the lab checks."""

STOPPER = """\
(machine stopper
  (event online [robot.light.data < 128])
  (state driving (running [robot.move(linear=0.2)]))
  (state stopped (onentry [robot.stop()]))
)
(spawn stopper driving)
"""


def checked(lab, passed):
    """Press Check, and wait for its result."""
    lab.do("check")
    lab.sees(f".lrp-result[data-state='{'met' if passed else 'failed'}']")
    return lab.find(".lrp-result").inner_text()


def test_the_line_is_stopped_at_after_a_hint_and_a_look_at_the_run(open_lab):
    lab = open_lab(STOPPER, 'stopper --challenge "stop at the line"')
    lab.sees(".lrp-criterion[data-state='open']")
    assert "Not yet" in checked(lab, False)
    lab.do("hint")
    lab.sees(".lrp-hint")
    lab.do("show-attempt")
    lab.sees('css=:scope[data-lrp-status="paused"]')
    lab.type_after("(onentry [robot.stop()]))", "\n(on online driving -> stopped)")
    assert "Passed: 10 of 10 points" in checked(lab, True)
