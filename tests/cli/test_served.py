"""The page of a run: ``lrp run --serve`` as a process of its own, and a client that knows WebSockets only."""

import signal

import pytest
from support.served import ServedRun, closed
from support.waiting import until

pytestmark = pytest.mark.slow  # each starts processes of its own

DRIVE = "; @world none\n(var n := [0])\n(machine m (state a (running [n = n + 1]))) (spawn m a)\n"


@pytest.fixture
def serve(process, program, tmp_path):
    """Run a program, and serve its page."""

    def start(*options, text=DRIVE, file=None):
        output = tmp_path / "output"
        with output.open("w") as out:
            run = process(
                "run", file or program(text), "--serve", "0", *options, stdout=out, stderr=out, cwd=tmp_path
            )
        return ServedRun(run, output)

    return start


def test_without_the_token_there_is_no_answer(serve):
    run = serve()
    for token in ("", "wrong", run.token[:-1], b"\xff" * 43):
        with run.connect() as socket:
            socket.send(token)
            assert closed(socket) == 4401
    with run.visitor() as page:
        assert page.about == {"name": "my", "file": "my.lrp", "read_only": False}
        assert page.snapshot["text"] == DRIVE


def test_what_is_typed_changes_the_running_program_and_its_file(serve, program, tmp_path):
    run = serve()
    with run.visitor() as page:
        answer = page.replace("n + 1", "n + 2")
        assert answer["accepted"]
        until(lambda: "n + 2" in (tmp_path / "my.lrp").read_text())
    run.process.send_signal(signal.SIGINT)
    assert run.process.wait() == 130
    assert run.output.read_text().count(run.token) == 1
