"""The page of a run: ``lrp run --serve`` as a process of its own, and a client that knows WebSockets only."""

import http.client
import itertools
import json
import re
import signal
import socket
import ssl
from contextlib import ExitStack, closing, suppress
from threading import Thread
from types import SimpleNamespace
from urllib.parse import urlsplit

import pytest
from support.certificates import own_certificate
from support.served import ServedRun, closed
from support.waiting import no_thread_left, until
from websockets.exceptions import InvalidStatus

from lrp_jupyter import files
from lrp_jupyter.bridges.bridge import NullBridge
from lrp_jupyter.live.session import Session
from lrp_jupyter.served import page_server
from lrp_jupyter.served.page_server import PageServer
from lrp_jupyter.served.served_program import ServedProgram
from lrp_jupyter.widgets import registry  # noqa: F401 (all acts and questions are known then)
from lrp_jupyter.widgets.acts.messages import ACTS, QUESTIONS

pytestmark = pytest.mark.slow  # each starts processes of its own

COUNT = "; world: none\n(var n := [0])\n(machine m (state a (running [n = n + 1]))) (spawn m a)\n"
CARRIER = """\
from lrp_jupyter.bridges.bridge import Bridge


class Carrier(Bridge):
    name, hardware = "carrier", True

    def open_interface(self):
        self.add_method("move", lambda linear=0.0: print("moved", linear))

    def stop(self):
        print("stood")
"""
FORGED = [
    *({"type": kind} for kind in (None, 7, [], "no such", "snapshot", "hello", "text", "command", "save")),
    {"type": "hello", "part": "engine"},
    {"type": "hello", "part": "lab", "revision": -1, "seq": -(2**70)},
    {"type": "text", "seq": 10**30, "base": 10**30, "updates": [[[0, "evil"]]]},
    {"type": "text", "seq": 1, "base": 0, "updates": [[-5], [1e300], ["x"], [[0, {}]]]},
    {"type": "text", "seq": 1, "base": 0, "updates": [[10**9, [0, "far"]]]},
    {"type": "text", "seq": 1, "base": 0, "updates": [[[0, "\ud800 (machine"]]]},
    {"type": "cursor", "seq": 0, "revision": 99, "selection": [-1, 10**40], "meant": "no"},
    {"type": "credit", "frame": 10**40},
    {"type": "command", "id": -1, "do": "run"},
    {"type": "command", "id": 1.5, "do": "__class__"},
    {"type": "command", "id": 1, "do": "step", "value": 10**9},
    {"type": "command", "id": 1, "do": "rate", "value": "fast"},
    {"type": "command", "id": 1, "do": "set_variable", "path": "n/../..", "expression": "lambda: 0"},
    {"type": "inspect", "id": 1, "kind": "variable", "path": "n", "into": ["__globals__"] * 500},
    {"type": "plots", "id": 1, "names": ["robot." * 5000], "event": "", "seconds": 1},
    {"type": "complete", "id": 1, "prefix": "().__class__.__base__.__subclasses__()", "scope": "../../x"},
]


@pytest.fixture
def serve(process, program, tmp_path):
    """Run a program, and serve its page."""

    def start(*options, text=COUNT, file=None, at="0"):
        output = tmp_path / "output"
        command = "run", file or program(text), "--serve", at, *options
        with output.open("w") as out:
            return ServedRun(process(*command, stdout=out, stderr=out, cwd=tmp_path), output)

    return start


def asked(run, path="/", method="GET", **headers):
    """What the server answers to a request: its status, headers and content."""
    place = urlsplit(run.address)
    with closing(http.client.HTTPConnection(place.hostname, place.port, timeout=120)) as connection:
        connection.putrequest(method, path, skip_host=True, skip_accept_encoding=True)
        for name, values in ({"Host": run.place} | headers).items():
            for value in [values] if isinstance(values, str) else values:
                connection.putheader(name.replace("_", "-"), value)
        connection.endheaders()
        answer = connection.getresponse()
        return answer.status, answer.headers, answer.read()


# -- who is answered ----------------------------------------------------------------------------------


def test_without_the_token_there_is_no_answer_and_wrong_ones_keep_no_page_out(serve):
    run = serve()
    for token in ("", "wrong", run.token[:-1], run.token.encode() + b"x", "x" * 900_000, *"abc"):
        with run.connect() as page:
            page.send(token)
            assert closed(page) == 4401
    with run.visitor() as page:
        assert page.about["name"] == "my"
    run.process.send_signal(signal.SIGINT)
    assert run.process.wait() == 130
    assert run.output.read_text().count(run.token) == 1


def test_only_the_page_of_this_run_is_answered_by_a_name_of_this_computer(serve):
    run = serve()
    port = run.place.partition(":")[2]
    for host in (run.place, f"localhost:{port}", f"[::1]:{port}", f"{socket.gethostname()}:1"):
        assert asked(run, Host=host)[0] == 200, host
    for host in ("evil.example", f"127.0.0.1.evil.example:{port}", "", [run.place, run.place], [], "a@b"):
        assert asked(run, Host=host)[0] in (400, 421), host
    for origin in (
        *("http://evil.example", "null", "http://[evil", f"http://127.0.0.1:{int(port) - 1}"),
        f"{run.address}.evil",
    ):
        with pytest.raises(InvalidStatus) as refused, run.connect(origin=origin):
            pass
        assert refused.value.response.status_code == 403
    upgrade = {"Connection": "Upgrade", "Upgrade": "websocket", "Sec_WebSocket_Version": "13"}
    assert asked(run, "/socket", Sec_WebSocket_Key="x" * 22 + "==", **upgrade)[0] == 403, "without an origin"


def test_there_are_a_few_files_and_a_browser_runs_no_other_script(serve):
    run = serve()
    status, headers, content = asked(run, Accept_Encoding="gzip, br")
    assert (status, headers["Content-Encoding"], content[:2]) == (200, "gzip", b"\x1f\x8b")
    status, headers, content = asked(run)
    assert run.token.encode() not in content
    files = set(re.findall(r'(?:href|src)="([^":]+)"', content.decode()))
    assert {"served.js", "lab.js"} < files
    for file in files:
        status, headers, content = asked(run, f"/{file}")
        assert (status, headers["X-Content-Type-Options"]) == (200, "nosniff")
        assert asked(run, f"/{file}", If_None_Match=headers["ETag"])[::2] == (304, b"")
    assert "script-src 'self';" in headers["Content-Security-Policy"]
    assert f"connect-src 'self' ws://{run.place} wss://{run.place};" in headers["Content-Security-Policy"]
    assert "frame-ancestors 'none'" in headers["Content-Security-Policy"]
    assert headers["Referrer-Policy"] == "no-referrer"
    for path in ("/my.lrp", "/../my.lrp", "/served/../my.lrp", "//my.lrp", "/%2e%2e/my.lrp", "/.lrp/x"):
        status, headers, _ = asked(run, path)
        assert (status, headers["X-Frame-Options"]) == (404, "DENY"), path


def test_a_page_that_sends_too_much_is_closed_and_the_run_goes_on(serve):
    run = serve()
    with run.visitor() as page:
        page.socket.send("x" * 1_000_001)
        assert closed(page.socket) == 1009
    with run.visitor() as page:
        for _ in range(3):
            page.say("complete", id=1, prefix="x" * 900_000, scope="")
        assert closed(page.socket) == 4408
    with run.visitor() as page:
        for _ in range(1300):
            page.say("credit", frame=0)
        assert closed(page.socket) == 4408
    for strange in (
        "",
        "null",
        "[]",
        "{}",
        '{"view": 1}',
        "[" * 100_000,
        b"\x00",
        '{"view": "%s"}' % ("x" * 200),
    ):
        with run.visitor() as page:
            page.socket.send(strange)
            assert closed(page.socket) == 4400
    with run.visitor() as page:
        assert page.replace("n + 1", "n + 2")["accepted"]


def test_forged_messages_change_nothing(serve, tmp_path):
    run = serve()
    with run.visitor("good") as good, run.visitor("evil") as evil:
        for each in FORGED:
            evil.socket.send(json.dumps({"view": "evil"} | each))
            evil.socket.send(json.dumps({"view": "good"} | each | {"type": each["type"] or "bye"}))
        evil.number = 10
        assert evil.ask("versions")["error"] is None, "it is still answered"
        assert good.replace("n + 1", "n + 2")["accepted"], "the other view is not its"
        good.get("frame", lambda frame: frame.get("status", "running") == "running")
    assert until(lambda: "n + 2" in (tmp_path / "my.lrp").read_text())


def test_not_more_pages_than_a_robot_has_time_for(serve):
    run = serve()
    with ExitStack() as pages:
        for _ in range(16):
            page = pages.enter_context(run.connect())
            page.send(run.token)
            assert json.loads(page.recv(120))["name"] == "my"
        with run.connect() as page:
            page.send(run.token)
            assert closed(page) == 4503


def test_a_page_that_reads_nothing_is_not_waited_for(serve):
    run = serve(text=f"{COUNT}; {'x' * 500_000}\n")
    with run.visitor("slow") as slow, run.visitor("quick") as quick:
        for _ in range(100):
            slow.say("hello", part="lab")  # which is answered with the whole text
        assert quick.replace("n + 1", "n + 2")["accepted"]
        assert closed(slow.socket) in (None, 1006)


# -- what a page can do -------------------------------------------------------------------------------


def test_what_is_typed_changes_the_running_program_and_its_file(serve, tmp_path):
    run = serve()
    file = tmp_path / "my.lrp"
    with run.visitor() as page:
        assert page.about == {"name": "my", "file": "my.lrp", "read_only": False}
        assert page.snapshot["text"] == COUNT
        assert page.replace("n + 1", "n + 2")["accepted"]
        until(lambda: "n + 2" in file.read_text())
        valid = file.read_text()
        assert not page.type([len(valid), [0, "(mach"]])["accepted"]
        until(lambda: "(mach" in (tmp_path / ".lrp" / "my.versions").read_text())
    run.process.send_signal(signal.SIGINT)
    assert run.process.wait() == 130
    assert file.read_text() == valid
    with serve(file=file).visitor() as page:
        conflict = page.snapshot["frame"]["conflict"]
        assert conflict["sentence"].startswith("The lab's last text of `my` differs from the file's")
        assert conflict["text"] == f"{valid}(mach"
        assert page.do("take", number=conflict["number"]) is None
        assert page.revision > page.snapshot["revision"]


def test_two_pages_see_what_the_other_types_and_one_that_goes_is_forgotten(serve):
    run = serve()
    with run.visitor("one") as one:
        with run.visitor("other") as other:
            other.replace("n + 1", "n + 2")
            assert one.get("answer", lambda answer: answer["updates"])["updates"][0]["view"] == "other"
            one.get("frame", lambda frame: "other" in frame.get("hands", {}))
            other.socket.socket.shutdown(socket.SHUT_RDWR)  # as a browser that is killed
        one.get("frame", lambda frame: frame.get("hands", {}).get("other", "there") is None)
        tick = one.get("frame", lambda frame: "tick" in frame)["tick"]
        one.get("frame", lambda frame: frame.get("tick", 0) > tick)


def test_a_view_that_comes_back_over_another_connection_is_the_same_one(serve):
    run = serve()
    with run.visitor("me") as before:
        before.replace("n + 1", "n + 2")
        with run.connect() as again:
            again.send(run.token)
            again.recv(120)
            known = {name: before.snapshot[name] for name in ("document", "revision")} | {"seq": before.seq}
            hello = json.dumps({"type": "hello", "view": "me", "part": "lab", **known})
            again.send(hello)
            with pytest.raises(TimeoutError):
                again.recv(1)  # the other one may be there still: it was heard just before
            snapshot = until(lambda: again.send(hello) or came(again))
            assert [each["view"] for each in snapshot["updates"]] == ["me"]
            before.socket.close()
            again.send(json.dumps({"type": "credit", "view": "me", "frame": snapshot["frame"]["frame"]}))
            assert until(lambda: came(again))["type"] == "frame"


def came(page):
    """The next message of a page, if it comes soon."""
    with suppress(TimeoutError):
        data = page.recv(0.5)
        return json.loads(data) if isinstance(data, str) else None


def test_pages_that_only_look_change_nothing(serve, tmp_path):
    looking = {name for name, handler in {**ACTS, **QUESTIONS}.items() if handler.only_looks}
    assert looking == {"look", "fit"} | set(QUESTIONS) - {"save", "save_world", "try_programs"}
    run = serve("--read-only")
    with run.visitor() as page:
        assert page.about["read_only"]
        for name in sorted(ACTS.keys() - looking):
            page.number += 1
            page.say("command", id=page.number, do=name, **some(ACTS[name]))
            error = page.get("reply", lambda reply: reply["id"] == page.number)["error"]
            assert error.startswith("This page is read-only"), name
        for name in ("save", "save_world"):
            assert page.ask(name, name=str(tmp_path / "stolen"), replace=True)["error"].startswith(
                "This page is read-only"
            )
        assert page.ask("try_programs", programs=[COUNT], seconds=1)["error"].startswith(
            "This page is read-only"
        )
        page.seq += 1
        page.say("text", seq=1, base=page.snapshot["revision"], updates=[[[0, "evil"], len(COUNT)]])
        assert page.get("snapshot")["text"] == COUNT
        assert page.ask("why", kind="state", path="m/a")["error"] is None
        assert page.do("look", tick=1) is None
        ago = page.get("frame", lambda frame: frame.get("looking"))["looking"]["ago"]
        page.get("frame", lambda frame: frame.get("looking", {}).get("ago", 0) > ago)  # so the run goes on
        assert page.do("look") is None
    assert (tmp_path / "my.lrp").read_text() == COUNT
    assert not (tmp_path / "stolen").exists()


def test_pages_that_only_look_are_asked_nothing_and_hold_nothing_up(serve, tmp_path):
    file, broken = tmp_path / "my.lrp", COUNT.replace("n + 1", "n +")
    run = serve(text=broken)
    with run.visitor() as page:
        page.type([len(broken), [0, "(mach"]])
        until(lambda: "(mach" in (tmp_path / ".lrp" / "my.versions").read_text())
    run.process.kill()
    run.process.wait()
    before = (tmp_path / ".lrp" / "my.versions").read_text()
    file.write_text(COUNT)
    with serve("--read-only", file=file).visitor() as page:
        file.write_text(COUNT.replace("n + 1", "n + 3"))
        assert page.snapshot["frame"]["conflict"] is None
        frame = page.get("frame", lambda frame: frame.get("conflict") or frame.get("tick", 0) > 25)
        assert frame.get("conflict") is None, "the file would have been looked at every second"
    with serve("--read-only", "--watch", file=file).visitor() as page:
        at = COUNT.index(" + 1")
        page.say("cursor", seq=0, revision=page.revision, selection=[at + 1, at + 1], meant=False)
        assert page.ask("versions")["error"] is None
        file.write_text(file.read_text().replace("n + 3", "nn + 3"))
        assert page.get("answer", lambda answer: answer["updates"])["half_typed"] is False
    assert (tmp_path / ".lrp" / "my.versions").read_text() == before


VALUES = {"bool": True, "str": "a", "list": [[0.0, 0.0]], "tuple": [0.0, 0.0, 0.0], "float": 1.0, "int": 1}


def some(handler):
    """The fields that a message must have, each with a value of its type."""
    fields = {}
    for name, (kind, is_required) in handler.fields.items():
        if is_required:
            choice = re.search(r"Literal\['(\w+)'", str(kind))
            fields[name] = choice[1] if choice else next(VALUES[key] for key in VALUES if key in str(kind))
    return fields


def test_a_page_disarms_a_robot_and_arms_it_again_and_the_terminal_says_so(serve, tmp_path):
    (tmp_path / "carrier.py").write_text(CARRIER)
    text = "(machine m (state a (running [robot.move(linear=0.1)]))) (spawn m a)"
    run = serve("--bridge", tmp_path / "carrier.py", text=text)
    run.says("moved 0.1")
    with run.visitor() as page, run.visitor("other") as other:
        for count in (1, 2):
            assert page.do("armed", on=False) is None
            other.get("frame", lambda frame: frame.get("bridge", {}).get("armed") is False)
            until(
                lambda n=count: run.output.read_text().count("`carrier` is disarmed") == n,
                run.output.read_text,
            )
            assert page.do("armed", on=True) is None
            other.get("frame", lambda frame: frame.get("bridge", {}).get("armed") is True)
        assert page.do("bridge", name="none").startswith("The robot was chosen with `lrp run --bridge`")
        assert page.do("load", name="follower").startswith("`lrp run` runs `my`.")
    moves = run.output.read_text().count("moved")
    until(lambda: run.output.read_text().count("moved") > moves)


def test_the_board_says_that_a_page_has_disarmed_the_robot(terminal, program, tmp_path):
    (tmp_path / "carrier.py").write_text(CARRIER)
    text = "(machine m (state a (running [robot.move(linear=0.1)]))) (spawn m a)"
    shown = terminal("run", program(text), "--bridge", tmp_path / "carrier.py", "--serve", "0")
    run = ServedRun(shown.process, SimpleNamespace(read_text=shown.read))
    with run.visitor() as page:
        assert page.do("armed", on=False) is None
        shown.wait_for("The robot is disarmed.")
        shown.press("q")
        assert closed(page.socket) == 4410
    assert shown.end() == 0


@pytest.mark.parametrize("options", [["--watch"], []])
def test_the_board_says_no_more_that_a_file_does_not_run_once_a_page_has_corrected_it(
    terminal, program, options
):
    shown = terminal("run", program(COUNT.replace("n + 1", "n +")), "--serve", "0", *options)
    run = ServedRun(shown.process, SimpleNamespace(read_text=shown.read))
    with run.visitor() as page:
        assert page.replace("n +]", "n + 1]")["accepted"]
        until(lambda: "does not run" not in next_board(shown), lambda: shown.text)
    shown.press("q")
    assert shown.end() == 0


def next_board(shown):
    """What is drawn from the end of one board to that of another."""
    shown.text = ""
    until(lambda: shown.read().count("space: pause") > 1)
    return shown.text.split("space: pause")[1]


# -- the file -----------------------------------------------------------------------------------------


def test_with_watch_a_save_comes_to_the_pages_also_one_that_is_no_program(serve, tmp_path):
    file = tmp_path / "my.lrp"
    run = serve("--watch")
    with run.visitor() as page:
        file.write_text(COUNT.replace("n + 1", "n + 3"))
        assert page.get("answer", lambda answer: answer["updates"])["accepted"]
        broken = COUNT.replace("n + 1", "n +")
        file.write_text(broken)
        answer = page.get("answer", lambda answer: answer["updates"])
        assert not answer["accepted"]
        run.says("saved: not a valid program; the last one keeps running")
        page.snapshot["text"] = broken
        assert file.read_text() == broken, "it is not replaced by what runs"
        assert page.replace("n +]", "n + 4]")["accepted"]
        until(lambda: "n + 4" in file.read_text())
    assert run.output.read_text().count("saved: ") == 1, "what a page writes does not count as a save"


@pytest.mark.parametrize("after", ["changed", "_mode_of", "_replace"])
def test_a_save_that_comes_while_the_run_writes_the_file_is_an_edit_like_others(tmp_path, monkeypatch, after):
    file, typed, broken = tmp_path / "my.lrp", COUNT.replace("n + 1", "n + 3"), COUNT.replace("n + 1", "n +")
    file.write_text(COUNT)
    program = ServedProgram(Session(COUNT, NullBridge()), COUNT, file, follows=True)
    program.texts.write(typed)
    owner = program.file if after == "changed" else files
    at_first = getattr(owner, after)

    def and_another_saves(*arguments):
        monkeypatch.undo()
        found = at_first(*arguments)
        file.write_text(broken)
        return found

    monkeypatch.setattr(owner, after, and_another_saves)
    program.publish()
    assert file.read_text() == broken
    program.publish()
    assert [program.look(broken), program.look(broken)] == [True, False], "which is told once"
    assert (program.texts.text, file.read_text()) == (broken, broken)


def test_a_text_is_written_also_where_the_times_of_files_change_by_themselves(tmp_path, monkeypatch):
    """As they do on some shared folders."""
    file, typed, number = tmp_path / "my.lrp", COUNT.replace("n + 1", "n + 3"), itertools.count()
    file.write_text(COUNT)
    program = ServedProgram(Session(COUNT, NullBridge()), COUNT, file)
    monkeypatch.setattr(program.file, "_signature", lambda ending: (next(number), 0, 0))
    program.texts.write(typed)
    program.publish()
    assert file.read_text() == typed


def test_without_watch_the_pages_ask_before_they_replace_what_another_program_has_written(serve, tmp_path):
    file, other = tmp_path / "my.lrp", COUNT.replace("n + 1", "n + 3")
    with serve().visitor() as page:
        file.write_text(other)
        conflict = page.get("frame", lambda frame: frame.get("conflict"))["conflict"]
        assert conflict["sentence"] == "`my.lrp` was changed outside this lab. Which text should be kept?"
        page.replace("n + 1", "n + 2")
        assert page.ask("versions")["error"] is None
        assert file.read_text() == other
        assert page.do("keep", number=conflict["number"]) is None
        until(lambda: "n + 2" in file.read_text())


def test_a_link_to_the_file_stays_one_and_a_file_that_is_not_edited_is_not_written(serve, tmp_path):
    (tmp_path / "real.lrp").write_text(COUNT.replace("\n", "\r\n"), newline="")
    (tmp_path / "my.lrp").symlink_to("real.lrp")
    before = (tmp_path / "real.lrp").stat()
    run = serve(file=tmp_path / "my.lrp")
    with run.visitor() as page:
        page.get("frame", lambda frame: frame.get("tick", 0) > 12)  # the file is looked at every second
        assert (tmp_path / "real.lrp").stat().st_mtime_ns == before.st_mtime_ns
        page.replace("n + 1", "n + 2")
        until(lambda: b"n + 2" in (tmp_path / "real.lrp").read_bytes())
    assert (tmp_path / "my.lrp").is_symlink()
    assert (tmp_path / "real.lrp").read_bytes().count(b"\r\n") == COUNT.count("\n")


def test_a_file_that_is_no_program_yet_is_corrected_in_the_page(serve):
    run = serve(text=COUNT.replace("n + 1", "n +"))
    run.says("Nothing runs yet. Correct the text.")
    with run.visitor() as page:
        assert page.snapshot["accepted"] is False
        assert page.replace("n +]", "n + 1]")["accepted"]
        page.get("frame", lambda frame: frame.get("active") == ["m/a"])


def test_a_bundled_program_is_kept_nowhere(serve, tmp_path):
    run = serve(file="stopwatch")
    run.says("The program is not in a file, so what is typed there ends with the run. Save… writes one.")
    with run.visitor() as page:
        assert page.about["file"] == ""
        page.type([[0, "; mine", ""], len(page.snapshot["text"])])
    assert [file.name for file in tmp_path.iterdir()] == ["output"]


# -- the end, and the beginning -----------------------------------------------------------------------


def test_pages_are_told_that_the_run_has_ended(serve):
    run = serve()
    with run.visitor() as page:
        run.process.send_signal(signal.SIGINT)
        page.get("frame", lambda frame: frame.get("status") == "closed")
        assert closed(page.socket) == 4410
    assert run.process.wait() == 130
    assert run.output.read_text().splitlines()[-1].startswith("my: ")


def test_a_run_that_served_its_page_leaves_no_thread(lrp, program):
    with no_thread_left():
        result = lrp("run", program(COUNT), "--serve", "0", "--for", "0.3")
    assert (result.exit_code, result.stderr) == (0, "")


def test_a_connection_on_which_nothing_is_said_does_not_hold_up_the_end(monkeypatch):
    monkeypatch.setattr(page_server, "_FIRST_WORDS", 600)
    server = PageServer(ServedProgram(Session(COUNT, NullBridge()), COUNT, None), "127.0.0.1:0")
    place = "127.0.0.1", urlsplit(server.link).port
    server.__enter__()
    with no_thread_left(), ExitStack() as stack:
        idle, asks = (stack.enter_context(socket.create_connection(place, 60)) for _ in range(2))
        asks.sendall(b"GET / HTTP/1.1\r\n\r\n")
        assert asks.recv(8) == b"HTTP/1.1", "so the other one was accepted, too"
        Thread(target=server.__exit__, daemon=True).start()
        with suppress(ConnectionResetError):
            assert idle.recv(1) == b""


def test_more_connections_than_pages_need_are_refused_and_a_page_is_answered_after_that(serve):
    run = serve()
    place = urlsplit(run.address)
    with ExitStack() as idle:
        for _ in range(60):
            idle.enter_context(socket.create_connection((place.hostname, place.port)))
        with pytest.raises((OSError, http.client.HTTPException)):
            asked(run)
    assert until(lambda: answers(run)) == 200


def answers(run):
    """The status of an answer, if there is one."""
    with suppress(OSError, http.client.HTTPException):
        return asked(run)[0]


def test_an_encrypted_page(serve, tmp_path):
    certificate, key = own_certificate(tmp_path)
    run = serve("--certificate", certificate, "--key", key, at="127.0.0.1:0")
    assert run.address.startswith("https://127.0.0.1:")
    context = ssl.create_default_context(cafile=certificate)
    with run.connect(ssl=context) as page:
        page.send(run.token)
        assert json.loads(page.recv(120))["name"] == "my"


def test_a_token_of_ones_own_is_neither_printed_nor_known_to_the_program_and_outlives_a_run(
    serve, monkeypatch
):
    own = "0123456789abcdef" * 2
    monkeypatch.setenv("LRP_TOKEN", own)
    text = COUNT.replace("n + 1", "(__import__('os').environ.get('LRP_TOKEN', 'hidden'), elapsed)")
    for _ in range(2):
        run = serve(text=text)
        assert (run.token, run.process.poll()) == ("$LRP_TOKEN", None)
        run.token = own
        with run.visitor() as page:
            page.get("frame", lambda frame: "'hidden'" in frame.get("variables", {}).get("n", [""])[0])
        run.process.terminate()
        run.process.wait()
        assert own not in run.output.read_text()


@pytest.mark.parametrize("at", ["0.0.0.0:0", "[::]:0"])
def test_a_page_for_others_that_is_not_encrypted_says_so(serve, at):
    run = serve(at=at)
    run.says("Others on the network can read this link when it is opened, and then do whatever you can do")
    with socket.create_connection(("127.0.0.1", int(run.place.rpartition(":")[2]))):
        pass


def test_the_link_is_printed_above_the_board_and_not_broken(terminal, program):
    run = terminal("run", program(COUNT), "--serve", "0", columns=60)
    run.wait_for("The page of this run: http://127.0.0.1:")
    run.wait_for("space: pause")
    assert run.text.count("#token=") == 0, "once"
    run.press("q")
    assert run.end() == 0


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--serve", "what"], "--serve takes a port, or an address and a port, not `what`"),
        (["--serve", "99999"], "not `99999`"),
        (["--serve", "robot..lab:0"], "at `robot..lab`, port 0: It is not the name of a computer."),
        (["--serve", "192.0.2.1:0"], "The page cannot be served at `192.0.2.1`, port 0: "),
        (["--read-only"], "are for a page: add `--serve PORT`."),
        (["--serve", "0", "--key", "x.pem"], "--key is that of a certificate"),
        (["--serve", "0", "--certificate", "no.pem"], "`no.pem` cannot be read: There is no such file."),
        (["--serve", "0", "--certificate", __file__], "cannot be used as a certificate"),
        (["--serve", "0", "--set", "n=1"], "--set runs another program than the text"),
    ],
    ids=lambda each: " ".join(map(str, each))[:40] if isinstance(each, list) else "",
)
def test_what_cannot_be_served_is_said_before_anything_moves(lrp, program, options, words):
    result = lrp("run", program(COUNT), "--bridge", "none", *options)
    assert result.exit_code == 2
    assert words in re.sub(r"[│\s]+", " ", result.stderr)


def test_a_token_that_can_be_guessed_protects_nothing(lrp, program, monkeypatch):
    monkeypatch.setenv("LRP_TOKEN", "robot")
    result = lrp("run", program(COUNT), "--bridge", "none", "--serve", "0")
    assert result.exit_code == 2
    assert "`LRP_TOKEN` is all that protects the page" in result.stderr


def test_a_port_that_is_taken_is_named(lrp, program):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        result = lrp("run", program(COUNT), "--bridge", "none", "--serve", port)
    assert result.exit_code == 2
    assert f"The page cannot be served at port {port}: another program listens there." in result.stderr
