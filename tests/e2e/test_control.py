"""The program is told what to do: by buttons, menus, keys, fields and the hand."""

from e2e.programs import COUNTER


def test_pause_step_step_back_and_reset(open_lab):
    lab = open_lab(COUNTER)
    lab.goes_on()
    lab.pause()
    tick, n = lab.tick, int(lab.value("m/n"))
    lab.do("step")
    lab.has_value("m/n", str(n + 1))
    assert lab.tick == tick + 1
    lab.do("step-back")
    lab.has_value("m/n", str(n))
    assert lab.tick == tick
    lab.do("reset")
    lab.has_value("m/n", "—")
    lab.do("step")
    lab.has_value("m/n", "0")
    lab.do("run")
    lab.ready("running")
    lab.goes_on()
