"""``lrp language-server`` as a person types it; `tests/editors` has what editors do with it."""

import signal

import pytest


@pytest.mark.slow
def test_a_person_is_told_who_starts_it_and_can_end_it(terminal):
    typed = terminal("language-server")
    typed.wait_for("is started by an editor")
    typed.press("\x03")
    assert typed.end() == -signal.SIGINT


def test_an_option_of_a_robot_needs_a_robot(lrp):
    done = lrp("language-server", "-o", "setup=robot.json")
    assert done.exit_code == 2
    assert "Name it, as in `--bridge ros`" in done.output
