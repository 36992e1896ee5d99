"""The page that `lrp run --serve` serves, in a browser: the lab of a run, without Jupyter."""

import subprocess
import sys
from contextlib import ExitStack
from urllib.parse import urlsplit

import psutil
import pytest
from support.proxy import Network
from support.served import ServedRun
from support.waiting import until

from e2e.conftest import WAIT, WINDOW
from e2e.jupyter import FLAGS, chromium
from e2e.pages import LabPage

DRIVE = """\
; world: empty
(var n := [0])
(machine m
  (state drive (running [robot.move(angular=0.5)] [n = n + 1])))
(spawn m drive)
"""
AWAY = "The robot's computer does not answer. The program may be running there. Trying again …"


@pytest.fixture
def serve(tmp_path):
    """Run a program, and serve its page."""
    with ExitStack() as ends:

        def start(*options, text=DRIVE, at="0"):
            (tmp_path / "my.lrp").write_text(text)
            command = [sys.executable, "-m", "lrp_jupyter", "run", "my.lrp", "--serve", at, *options]
            output = tmp_path / "output"
            with output.open("w") as out:
                process = subprocess.Popen(command, cwd=tmp_path, stdout=out, stderr=out)
            ends.callback(process.wait)
            ends.callback(process.terminate)
            return ServedRun(process, output)

        yield start


@pytest.fixture
def browser(playwright):
    browser = playwright.chromium.launch(executable_path=chromium(), args=FLAGS)
    yield browser
    browser.close()


@pytest.fixture
def visit(browser):
    """Open a link in a window of its own; what its console says is empty in the end."""
    said = []

    def visit(link):
        context = browser.new_context(viewport=WINDOW)
        context.set_default_timeout(WAIT)
        page = context.new_page()
        page.on("console", lambda message: said.append(message.text))
        page.on("pageerror", lambda error: said.append(str(error)))
        page.goto(link)
        return RunPage(page)

    yield visit
    assert [text for text in said if "WebSocket connection" not in text] == []


class RunPage(LabPage):
    """The page of a run."""

    def says(self, words):
        """Wait until the line below the title says this."""
        self.page.locator("#status", has_text=words).wait_for()

    def says_nothing(self):
        self.page.locator("#status").wait_for(state="hidden")


def test_a_person_types_while_the_robot_drives_and_another_one_sees_it(serve, visit, tmp_path):
    run = serve()
    lab, other = visit(run.link).ready(), visit(run.link).ready()
    assert lab.page.url == f"{run.address}/"
    assert lab.page.title() == "my on 127.0.0.1"
    lab.goes_on()
    lab.type_after("[n = n + 1]))", "\n(state rest)\n(on [n > 1e6] drive -> rest)")
    other.sees('[data-lrp-state="m/rest"]')
    until(lambda: "drive -> rest" in (tmp_path / "my.lrp").read_text())
    other.replace("angular=0.5", "angular=0.6")
    until(lambda: "angular=0.6" in lab.text and "angular=0.6" in (tmp_path / "my.lrp").read_text())
    lab.pause()
    other.ready("paused")
    lab.page.reload()
    lab.ready("paused")
    assert lab.text == other.text == (tmp_path / "my.lrp").read_text()
    lab.do("run")
    other.ready()


def test_one_page_too_many_says_so_and_goes_on_once_another_one_is_closed(serve, visit):
    run = serve()
    with ExitStack() as pages:
        for number in range(16):
            pages.enter_context(run.visitor(f"page {number}"))
        lab = visit(run.link)
        lab.says("Too many pages are open. Close one of them, and this one goes on.")
    lab.ready()
    lab.says_nothing()


def test_what_is_typed_while_the_network_is_cut_is_merged_when_it_is_back(serve, visit):
    run = serve()
    with Network(urlsplit(run.address).port) as network:
        lab = visit(f"http://127.0.0.1:{network.port}/#token={run.token}").ready()
        other = visit(run.link).ready()
        lab.goes_on()
        lab.root.evaluate("root => { root.dataset.same = '' }")
        lab.page.clock.install()
        network.cut()
        lab.page.clock.fast_forward(30_000)
        lab.page.clock.resume()
        lab.says(AWAY)
        lab.type_after("[n = n + 1])", " (onexit [n = 0])")
        lab.do("pause")
        lab.says("What you have just done has not reached it.")
        other.replace("angular=0.5", "angular=0.6")
        other.goes_on()
        assert "onexit" not in other.text
        network.mend()
        lab.page.clock.fast_forward(10_000)
        lab.says_nothing()
        for each in (lab, other):
            each.until("editor => /0\\.6.*onexit/s.test(editor.textContent)", ".cm-content")
        lab.goes_on()
        assert lab.root.get_attribute("data-same") == ""
        lab.do("pause")
        other.ready("paused")


def test_a_wrong_link_is_told_from_the_right_one(serve, visit):
    run = serve()
    lab = visit(run.address)
    lab.says("Open the link that lrp run has printed: it ends with a token")
    lab = visit(f"{run.address}/#token={'x' * 43}")
    lab.says("This link is not the one of the present run.")
    lab.page.evaluate("hash => { location.hash = hash; }", f"token={run.token}")
    lab.ready()


def test_a_robot_drives_on_when_the_browser_is_killed(serve, playwright, tmp_path, visit):
    run = serve()
    profile = str(tmp_path / "profile")
    context = playwright.chromium.launch_persistent_context(profile, executable_path=chromium(), args=FLAGS)
    page = context.new_page()
    page.goto(run.link)
    RunPage(page).ready()
    other = visit(run.link).ready()
    with run.visitor() as watching:
        assert len(watching.snapshot["frame"]["hands"]) >= 2
        killed = [each for each in psutil.process_iter(["cmdline"]) if is_of(each, profile)]
        for each in killed:
            each.kill()
        assert killed
        watching.get("frame", lambda frame: None in frame.get("hands", {}).values())
    other.goes_on()
    other.replace("angular=0.5", "angular=0.6")
    until(lambda: "angular=0.6" in (tmp_path / "my.lrp").read_text())


def is_of(process, profile):
    """Whether a process is a browser with this profile."""
    return f"--user-data-dir={profile}" in (process.info["cmdline"] or ())


def test_a_page_says_that_the_run_has_ended_and_that_another_one_is_not_its(serve, visit):
    run = serve()
    lab = visit(run.link).ready()
    run.process.terminate()
    lab.says("The run has ended. This is how it was at the end.")
    assert "n = n + 1" in lab.text
    port = urlsplit(run.address).port
    other = serve(at=str(port))
    assert other.token != run.token
    lab.page.reload()
    lab.says("This link is not the one of the present run.")


def test_a_page_goes_on_with_the_next_run_of_the_same_token(serve, visit, monkeypatch):
    token = "0123456789abcdef" * 2
    monkeypatch.setenv("LRP_TOKEN", token)
    run = serve()
    lab = visit(f"{run.address}/#token={token}").ready()
    run.process.terminate()
    lab.says("The run has ended.")
    assert run.process.wait() == 143
    serve(at=run.place.partition(":")[2], text=DRIVE.replace("0.5", "0.7"))
    lab.says_nothing()
    lab.ready().reads(".cm-content", "angular=0.7")
    lab.goes_on()


def test_a_page_that_only_looks_shows_why_and_the_past_and_keeps_its_text(serve, visit, tmp_path):
    run = serve("--read-only")
    lab = visit(run.link).ready()
    assert lab.page.locator("#about").inner_text().endswith("read only")
    lab.goes_on()
    lab.find(".cm-content").click()
    lab.page.keyboard.type("evil")
    lab.do("pause")
    lab.page.locator(".lrp-toast", has_text="This page is read-only").wait_for()
    lab.goes_on()
    assert lab.text == (tmp_path / "my.lrp").read_text() == DRIVE
