"""A real kernel without a browser: sending from a thread, and hearing while a cell runs."""

import json
import time
from queue import Empty

import pytest
from jupyter_client.manager import KernelManager

from lrp_jupyter.widgets.wire.changes import difference

pytestmark = pytest.mark.slow  # each starts processes of its own

PROGRAM = "(var n := [0]) (machine m (state a (running [n = n + 1]))) (spawn m a)"
SECONDS = 120


class Kernel:
    """A kernel and what a page would do with it."""

    def __init__(self, client, end):
        self.client, self.end = client, end  # a file that ends a cell
        self.comms, self.streams, self.idle = [], [], set()
        self.page("")

    def page(self, comm):
        """Show the widget of a comm, as its only view."""
        self.comm, self.messages, self.fields, self.kinds, self.subshell = comm, [], {}, {}, None

    def run(self, code):
        """Run a cell to its end."""
        message = self.client.execute(code)
        self.until(lambda: message in self.idle)

    def until(self, condition, seconds=SECONDS):
        """Receive until a condition holds; return credit as a page does."""
        end = time.monotonic() + seconds
        while not condition():
            try:
                self.process(self.client.get_iopub_msg(timeout=max(0.01, end - time.monotonic())))
            except Empty:
                raise AssertionError(
                    f"the condition was not met; the last message was {self.messages[-1:]}"
                ) from None

    def process(self, message):
        kind, content = message["msg_type"], message["content"]
        assert kind != "error", "\n".join(content["traceback"])
        if kind == "status" and content["execution_state"] == "idle":
            self.idle.add(message["parent_header"].get("msg_id"))
        elif kind == "comm_open":
            self.comms.append(content["comm_id"])
        elif kind == "stream":
            self.streams.append(content["text"])
        elif kind == "comm_msg" and content["comm_id"] == self.comm and content["data"].get("content"):
            self.receive(json.loads(content["data"]["content"]["json"]))

    def receive(self, message):
        self.messages.append(message)
        self.kinds[message["type"]] = message
        frame = message["frame"] if message["type"] == "snapshot" else message
        if "frame" in frame:
            self.fields.update(frame)
            self.send({"type": "credit", "view": "v", "frame": frame["frame"]})

    def send(self, content):
        content = {
            "comm_id": self.comm,
            "data": {"method": "custom", "content": {"json": json.dumps(content)}},
        }
        message = self.client.session.msg("comm_msg", content)
        message["header"]["subshell_id"] = self.subshell
        self.client.shell_channel.send(message)

    def type(self, text):
        """Replace the program by another text."""
        changes = difference(PROGRAM + "\n", text + "\n").json()
        self.send({"type": "text", "view": "v", "seq": 1, "base": 1, "updates": [changes]})

    def busy(self):
        """Run a cell until it is ended; messages sent meanwhile go to a subshell, as in JupyterLab."""
        message = self.client.session.msg("create_subshell_request", {})
        self.client.control_channel.send(message)
        self.subshell = self.client.get_control_msg(timeout=SECONDS)["content"]["subshell_id"]
        self.end.unlink(missing_ok=True)
        self.cell = self.client.execute(
            f"import os, time\nwhile not os.path.exists({str(self.end)!r}): time.sleep(0.01)"
        )


@pytest.fixture(scope="module")
def kernel(tmp_path_factory):
    manager = KernelManager(kernel_name="python3")
    manager.start_kernel(cwd=str(tmp_path_factory.mktemp("kernel")))
    client = manager.client()
    client.start_channels()
    try:
        client.wait_for_ready(timeout=SECONDS)
        kernel = Kernel(client, tmp_path_factory.mktemp("end") / "end")
        kernel.run("%load_ext lrp_jupyter")
        yield kernel
    finally:
        client.stop_channels()
        manager.shutdown_kernel(now=True)


@pytest.fixture
def lab(kernel):
    """A kernel with a lab, whose view has said hello."""
    before = len(kernel.comms)
    kernel.run(f"%%lrp mine\n{PROGRAM}")
    kernel.page(kernel.comms[before:][-1])  # that of the widget's layout was opened before
    kernel.send({"type": "hello", "view": "v", "part": "lab"})
    kernel.until(lambda: "snapshot" in kernel.kinds)
    yield kernel
    kernel.end.touch()
    kernel.run("import lrp_jupyter; lrp_jupyter.Lab('mine').close()")


def test_frames_come_from_the_thread_while_no_cell_runs(lab):
    first = lab.fields["tick"]
    lab.until(lambda: lab.fields["tick"] > first + 5)


def test_pause_acts_and_is_answered_while_a_cell_runs(lab):
    lab.busy()
    tick = lab.fields["tick"]
    lab.until(lambda: lab.fields["tick"] > tick)  # the thread has published since the cell began
    lab.send({"type": "command", "view": "v", "id": 1, "do": "pause"})
    lab.until(lambda: "reply" in lab.kinds and lab.fields["status"] == "paused")
    assert lab.kinds["reply"]["error"] is None
    assert lab.cell not in lab.idle


def test_the_lab_knows_whether_a_cell_that_runs_holds_up_what_the_page_sends(lab):
    lab.until(lambda: "While a cell runs" in lab.fields["late"])  # JupyterLab without subshells
    lab.busy()
    lab.send({"type": "command", "view": "v", "id": 1, "do": "pause"})
    lab.until(lambda: lab.fields["late"] == "")
    assert lab.cell not in lab.idle


def test_what_the_page_sends_is_no_cell(lab):
    """After a cell matplotlib shows and closes all figures, also those that another cell is drawing."""
    lab.run("ran = []\ndef note(): ran.append(1)\nget_ipython().events.register('post_execute', note)")
    lab.busy()
    lab.send({"type": "command", "view": "v", "id": 1, "do": "pause"})
    lab.until(lambda: "reply" in lab.kinds)
    lab.end.touch()
    lab.until(lambda: lab.cell in lab.idle)
    lab.send({"type": "command", "view": "v", "id": 2, "do": "run"})
    lab.until(lambda: lab.kinds["reply"]["id"] == 2)
    lab.run("get_ipython().events.unregister('post_execute', note); print(f'{len(ran)} cells')")
    lab.until(lambda: "cells" in "".join(lab.streams))
    assert "2 cells" in "".join(lab.streams), "the one that registered it, and the busy one"


def test_a_text_is_answered_while_a_cell_runs(lab):
    lab.busy()
    text = PROGRAM.replace("n + 1", "n + 2")
    lab.type(text)
    lab.until(lambda: "answer" in lab.kinds)
    assert lab.kinds["answer"]["applied"]
    assert lab.cell not in lab.idle


def test_half_a_character_comes_back_as_it_was_sent(lab):
    text = PROGRAM + " ; \ud800"
    lab.type(text)
    lab.until(lambda: "answer" in lab.kinds)
    del lab.kinds["snapshot"]
    lab.send({"type": "hello", "view": "v", "part": "lab"})
    lab.until(lambda: "snapshot" in lab.kinds)
    assert lab.kinds["snapshot"]["text"] == text + "\n"


def test_what_blocks_print_goes_to_the_lab_and_not_to_a_cell(lab):
    text = PROGRAM.replace("n = n + 1", "print('from a block')")
    lab.type(text)
    lab.until(lambda: "from a block" in lab.fields.get("printed", {}).values())
    lab.run("print('from a cell')")
    lab.until(lambda: "from a cell\n" in lab.streams)
    assert "from a block" not in "".join(lab.streams)


def test_running_the_cell_again_leaves_one_thread_of_each_kind(lab):
    lab.run(f"%%lrp mine\n{PROGRAM}")
    lab.run(f"%%lrp mine\n{PROGRAM}")
    lab.run(
        "import threading, collections\n"
        "found = collections.Counter(t.name for t in threading.enumerate() if t.name.startswith('lrp'))\n"
        "assert set(found.values()) == {1}, found"
    )


def test_closing_notifies_the_page_and_leaves_no_thread(lab):
    lab.run("import threading, lrp_jupyter; lrp_jupyter.Lab('mine').close()")
    lab.until(lambda: lab.fields["status"] == "closed")
    lab.run("assert not [t for t in threading.enumerate() if t.name.startswith('lrp mine')]")
    lab.run(f"%%lrp mine\n{PROGRAM}")
