"""Whatever is done to a session: its run is kept and is the same again, or it is refused in words."""

from pathlib import Path
from tempfile import TemporaryDirectory

from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import rule
from live.test_anything import Anything
from support import wild
from support.sessions import values

from lrp_jupyter.errors import LRPError
from lrp_jupyter.language.parser import scan
from lrp_jupyter.live.past.replay import without_edits
from lrp_jupyter.live.recording import read_recording
from lrp_jupyter.live.reproduction import reproduce
from lrp_jupyter.runs.again import begin_run
from lrp_jupyter.runs.rerun import Rerun


class AnythingKept(Anything):
    """A session whose run is kept at its end."""

    @rule(seconds=st.sampled_from([0, 0.1, 0.7]))
    def begin_again(self, seconds):
        begin_run(self.session)
        self.begin_reference()
        self.go_on(seconds)

    def judge(self):
        with self.session as session, TemporaryDirectory() as folder:
            self.go_on(0.5)
            session.call(lambda: None)  # what waits to be done to the world
            self.lab.connection.close()
            file, refusal = None, ""
            try:
                file = session.keep(folder=folder)
            except (LRPError, ValueError) as error:
                refusal = str(error)
            assert [*Path(folder).iterdir()] == ([] if file is None else [file])
            if file is None:
                assert refusal.endswith(".")
                return
            self.same_again(session, file)
            self.same_with_other_programs(session.program.text, file)

    def same_again(self, session, file):
        with (again := reproduce(read_recording(file))).session:
            if again.difference is not None:  # what a block reads between two ticks is not recorded
                assert "was not read in this tick" in str(again.difference)
                return
            mine, other = session.frame, again.session.frame
            assert (mine.active, mine.program.text) == (other.active, other.program.text)
            assert values(session.interpreter) == values(again.session.interpreter)
            if session.bridge.name == "sim":
                assert session.bridge.pose == again.session.bridge.pose

    def same_with_other_programs(self, text, file):
        recording = read_recording(file)
        begun, entries = recording.start.text, recording.entries
        if len(entries) == len([*without_edits(entries)]):
            assert Rerun((begun,), str(file)).outcome().passed
        for other in (text, wild.changed(begun, len(entries), "n > 1")):
            if scan(other)[0] is None:
                continue
            seen = []

            def see(event):
                if event.kind in ("entered", "discarded"):
                    seen.append((round(event.now, 9), *event.path))  # noqa: B023

            reproduce(recording, program=other, observer=see).session.close()
            now = Rerun((other,), str(file)).outcome().now
            paths = [(each.lane, *([each.state] if each.state else [])) for each in now]
            assert [(each.time, "/".join(path)) for each, path in zip(now, paths, strict=True)] == [
                (time, "/".join(path)) for time, *path in seen
            ]


TestAnythingKept = AnythingKept.TestCase
TestAnythingKept.settings = settings(max_examples=settings().max_examples // 2, stateful_step_count=20)
