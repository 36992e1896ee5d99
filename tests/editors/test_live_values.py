"""What a run tells an editor: a real `lrp run --watch --socket`, and a real server."""

import signal
from multiprocessing import AuthenticationError
from multiprocessing.connection import Client, deliver_challenge
from pathlib import Path

import pytest
from support.waiting import until

from lrp_jupyter.editors.live_place import places_of

pytestmark = pytest.mark.slow  # starts both as processes

COUNT = """\
; world: none
(var step := [1])
(machine counter
  (var n := [0])
  (state counting (running [n = min(n + step, 40)]))
  (state done)
  (event over [n >= 40])
  (event early [n < 0])
  (on over counting -> done)
  (on early done -> counting))
(spawn counter counting)
"""


def shown(lrp):
    return {each.position.line + 1: each.label for each in lrp.hints()}


def test_values_and_active_states_are_shown_while_a_program_runs_and_no_longer(editor, run, runtime):
    lrp = editor()
    lrp.path.write_text(COUNT)
    lrp.open(COUNT)
    assert shown(lrp) == {}
    process = run(lrp.path)
    until(lambda: shown(lrp) == {2: "= 1", 4: "= 40", 6: "● active", 8: "= False"}, lambda: shown(lrp))
    assert lrp.refreshed > 1
    assert [path.stat().st_mode & 0o077 for path in (runtime, *runtime.glob("*.key"))] == [0, 0]

    lrp.replace("; world: none", "; world: none\n; a line more, not saved")
    assert shown(lrp) == {3: "= 1", 5: "= 40", 7: "● active", 9: "= False"}
    before = lrp.refreshed
    lrp.path.write_text(COUNT.replace("[1]", "[2]"))
    until(lambda: shown(lrp).get(3) == "= 2")
    until(lambda: lrp.refreshed > before)

    process.send_signal(signal.SIGINT)
    until(lambda: shown(lrp) == {})
    assert process.wait(60) == 130
    assert [*runtime.iterdir()] == []


def test_a_run_is_shown_under_every_name_of_its_file(editor, run, tmp_path):
    lrp = editor()
    lrp.path.write_text(COUNT)
    link = tmp_path / "link.lrp"
    link.symlink_to(lrp.path)
    names = [lrp.uri, "file:///no%00file.lrp", link.as_uri()]
    for lrp.uri in names:
        lrp.open(COUNT)
    run(lrp.path)
    for lrp.uri in (names[0], names[2]):
        until(lambda: shown(lrp))


TWICE = """\
; world: none
(machine blinker (var on := [0]) (state lit (running [on = on + 0])))
(machine m
  (state both
    (onentry (spawn left go) (spawn right go))
    (machine left (state go (onentry (spawn blinker lit (var on := [1])))))
    (machine right (state go (onentry (spawn blinker lit (var on := [2.00048])))))))
(spawn m both)
"""


def test_a_machine_that_runs_in_two_places_has_both_values(editor, run):
    lrp = editor()
    lrp.path.write_text(TWICE)
    lrp.open(TWICE)
    run(lrp.path)
    until(lambda: shown(lrp))
    hints = shown(lrp)
    assert hints[2] == "on = left: 1, right: 2.000, lit ● active (left, right)"
    assert hints[4] == "● active"


def test_what_a_killed_run_leaves_disturbs_neither_the_next_one_nor_the_editor(editor, run, runtime):
    lrp = editor()
    lrp.path.write_text(COUNT)
    lrp.open(COUNT)
    first = run(lrp.path)
    until(lambda: shown(lrp))
    first.kill()
    first.wait()
    until(lambda: not shown(lrp))
    assert len([*runtime.glob("*.key")]) == 1
    run(lrp.path, "--set", "step=3")
    until(lambda: shown(lrp).get(2) == "= 3")
    assert len([*runtime.glob("*.key")]) == 1


def test_of_two_runs_the_last_one_is_shown_and_then_the_other(editor, run):
    lrp = editor()
    lrp.path.write_text(COUNT)
    lrp.open(COUNT)
    run(lrp.path)
    until(lambda: shown(lrp))
    last = run(lrp.path, "--set", "step=3")
    until(lambda: shown(lrp).get(2) == "= 3")
    last.send_signal(signal.SIGINT)
    until(lambda: shown(lrp).get(2) == "= 1")


def test_a_run_that_is_paused_says_so(editor, run):
    lrp = editor()
    lrp.path.write_text(COUNT)
    lrp.open(COUNT)
    run(lrp.path, "--break", "done")
    until(lambda: shown(lrp).get(6) == "● active, paused", lambda: shown(lrp))
    assert 7 not in shown(lrp), "`over` is not tested in this state"


GROWING = """\
; world: none
(var words := [""])
(machine m (state s (running [words = words[1:] + "x" * 100])))
(spawn m s)
"""


def test_an_editor_that_does_not_read_or_knows_no_key_delays_nothing(tmp_path, run):
    path = tmp_path / "my.lrp"
    path.write_text(GROWING)
    process = run(path, "--for", "4", "--rate", "200")
    (place,) = until(lambda: [each for each in places_of(path) if Path(each.address).exists()])
    with Client(place.address, authkey=place.key) as silent, Client(place.address):
        with Client(place.address) as stranger:
            stranger.send_bytes(b"x" * 100)
            with pytest.raises((AuthenticationError, EOFError, OSError)):
                deliver_challenge(stranger, b"a guess")
        place.key_file.unlink()
        with pytest.raises((AuthenticationError, EOFError, OSError)):
            Client(place.address, authkey=b"")
        output, _ = process.communicate(timeout=120)
        assert silent.poll(0)
    assert process.returncode == 0
    assert "my: 4.0 s, " in output


def test_a_folder_that_others_can_read_is_not_used(tmp_path, run, runtime):
    runtime.mkdir(mode=0o755)
    path = tmp_path / "my.lrp"
    path.write_text(COUNT)
    process = run(path)
    output, _ = process.communicate(timeout=120)
    assert process.returncode == 2
    assert "is not a folder that only you can use" in output
