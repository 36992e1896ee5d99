"""Sessions of a machine started alone: recorded, reproduced, forked and asked about."""

import pytest

from lrp_jupyter import Session
from lrp_jupyter.errors import FileError
from lrp_jupyter.live.recording import read_recording
from lrp_jupyter.live.reproduction import reproduce

SEARCH = """
(var turn := [1.0])
(machine follower
  (var width := [200])
  (event seen [robot.light.data < 128])
  (state moving (running [robot.move(linear=0.2)]))
  (state looking
    (onentry [robot.stop()] (spawn lookalgo left))
    (machine lookalgo
      (var time := [width])
      (state left (running [robot.move(angular=turn)]))
      (state right (running [robot.move(angular=-turn)]) (onexit [time *= 2]))
      (ontime time left -> right)
      (ontime time right -> left)
      (exit [robot.gyro.data > 0.5] left -> moving found)))
  (on seen looking -> moving))
(spawn follower moving)
"""
START = "follower/looking/lookalgo"


def test_a_recording_of_it_is_reproduced(tmp_path):
    path = tmp_path / "run.lrplog"
    with Session(SEARCH, "sim", world="line", start=START) as session, session.record(path):
        session.run(1)
        session.rename("state", "looking", "searching")
        session.edit(session.text.replace("[1.0]", "[1.5]"))
        session.run(10, until="moving")
        active, time = session.frame.active, session.frame.time
    assert active == (("follower", "moving"),)
    recording = read_recording(path)
    assert recording.start.start == START
    again = reproduce(recording)
    assert again.difference is None
    assert (again.session.frame.active, again.session.frame.time) == (active, time)
    again.session.close()


def test_a_recording_of_a_machine_that_is_missing_cannot_be_read(tmp_path):
    path = tmp_path / "run.lrplog"
    with Session(SEARCH, start=START) as session, session.record(path):
        session.run(1)
    path.write_text(path.read_text().replace(f'"{START}"', '"follower/looking/lookalgos"'))
    with pytest.raises(
        FileError, match="line 1: A field is wrong: There is no machine or state `follower/looking/lookalgos`"
    ):
        read_recording(path)


def test_a_fork_goes_on_with_it_and_starts_it_again():
    with Session(SEARCH, "sim", world="line", start=START) as session:
        session.run(0.6)
        for at in (None, 0, 5):
            with session.fork(at) as fork:
                fork.run(0.1)
                assert all(path[:3] == ("follower", "looking", "lookalgo") for path in fork.frame.active)
                fork.reset()
                fork.step()
                assert fork.frame.active == (("follower", "looking", "lookalgo", "left"),)
        assert all(each.reached for each in session.try_values("turn", [1, 2], 20, until="moving"))


def test_answers_know_what_does_not_run_and_why():
    with Session(SEARCH, "sim", world="line", start=START) as session:
        session.run(0.1)
        assert str(session.why("left")) == (
            "`left` was entered at 0 s when the program started: `lookalgo` is started alone."
        )
        around = (
            "`follower` was not running. Only `follower/looking/lookalgo`, which is inside it, was started."
        )
        asked = "seen:looking->moving"
        assert str(session.why_not(asked)) == f"`{asked}` (line 16) did not fire at 0 s: {around}"
        assert str(session.why("looking")) == f"`looking` has not been entered: {around}"
        assert {each.lane for each in session.timeline().happenings} == {(), tuple(START.split("/"))}
        session.reset()
        session.run(0.2)
        assert str(session.why("left")) == (
            "`left` was entered at 0.1 s because the program restarted (it was reset): "
            "`lookalgo` is started alone."
        )
