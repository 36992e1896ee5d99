"""``%%lrp`` and ``%lrp`` in a real IPython shell."""

import sys
from io import StringIO
from types import SimpleNamespace

import pytest
from IPython.core.completer import provisionalcompleter
from IPython.core.error import UsageError
from IPython.core.interactiveshell import InteractiveShell
from traitlets.config import Config

from lrp_jupyter import Session
from lrp_jupyter.codes import CODES
from lrp_jupyter.grading.challenges import challenge
from lrp_jupyter.live.recording import read_recording
from lrp_jupyter.live.reproduction import reproduce
from lrp_jupyter.widgets import registry
from lrp_jupyter.widgets.hosts import by_hand, debugger
from lrp_jupyter.widgets.lab import Lab
from lrp_jupyter.widgets.magics import WORDS
from lrp_jupyter.widgets.text.conditions import Conditions

A = "(machine m (state a)) (spawn m a)\n"
B = "(machine m (state a) (state b)) (spawn m a)\n"


class Page:
    """A view in a page."""

    def __init__(self, connection):
        self.connection = connection
        self.send("hello", part="lab")

    def send(self, kind, /, **fields):
        self.connection.receive(lambda *_: None, {"type": kind, "view": "page", **fields})


@pytest.fixture(scope="module")
def one_shell(tmp_path_factory):
    config = Config()
    config.HistoryManager.enabled = False
    config.InteractiveShell.colors = "nocolor"
    shell = InteractiveShell(config=config, ipython_dir=str(tmp_path_factory.mktemp("ipython")))
    shell.extension_manager.load_extension("lrp_jupyter")
    yield shell
    shell.history_manager.end_session()


@pytest.fixture
def shell(one_shell, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    yield one_shell
    for connection in list(registry.running()):
        registry.forget(connection)


@pytest.fixture
def run(shell, capsys):
    """Run a line; return what it prints."""

    def run(line):
        shell.run_line_magic("lrp", line)
        return capsys.readouterr().out

    return run


def cell(shell, line, text):
    return shell.run_cell_magic("lrp", line, text)


def test_a_cell_is_a_program_and_its_output_the_lab(shell):
    lab = cell(shell, "mine --world oval --rate 25", A)
    assert isinstance(lab, Lab)
    assert lab.text == A
    assert lab.session.rate == 25
    assert lab.session.bridge.world.name == "oval"
    assert cell(shell, "mine", B).session is lab.session
    assert lab.text == B


def test_a_cell_says_what_an_edit_of_an_active_state_does_also_with_another_robot(shell, run):
    lab = cell(shell, "mine --on-active-edit keep", A)
    session = lab.session
    session.on_issue = "pause"
    assert session.on_active_edit == "keep"
    run("bridge none")
    assert lab.session is not session
    lab.session.call(int)  # when it is done, what the new session was asked for before is done, too
    assert (lab.session.on_active_edit, lab.session.on_issue) == ("keep", "pause")
    cell(shell, "mine --on-active-edit restart", A)
    assert lab.session.on_active_edit == "restart"


def test_blocks_see_the_notebooks_names_and_write_none(shell):
    shell.run_cell("def double(x): return 2 * x")
    lab = cell(shell, "mine --rate 100", "(var x := [double(21)])" + A)
    lab.session.wait_for("a", 60)
    assert lab.variables["x"] == 42
    assert "x" not in shell.user_ns
    assert not lab.session.findings


def test_a_cell_that_is_not_a_program_opens_the_lab_anyway(shell):
    lab = cell(shell, "mine", "(machine m")
    assert lab._connection.texts.judgement.findings


def test_an_empty_cell_opens_an_empty_lab(shell):
    result = shell.run_cell("%%lrp empty")
    assert result.result.text == ""
    assert not result.result._connection.texts.judgement.findings


def test_programs_are_listed_and_shown_again(shell, run):
    assert "No program is open" in run("")
    lab = cell(shell, "mine", A)
    assert run("").startswith("mine: running")
    assert shell.run_line_magic("lrp", "mine").session is lab.session
    assert shell.run_line_magic("lrp", "show mine").session is lab.session
    assert shell.run_line_magic("lrp", "show").session is lab.session


def test_bundled_programs_are_listed_and_opened_in_their_world(shell, run):
    listed = run("examples")
    assert "follower" in listed
    assert "Follows a line" in listed
    assert "maze" in listed
    lab = shell.run_line_magic("lrp", "new follower")
    assert lab.session.bridge.world.name == "line"


def test_words_control_the_program(shell, run):
    session = cell(shell, "mine", A).session
    run("pause")
    assert session.status == "paused"
    tick = session.frame.tick
    run("step mine")
    assert session.frame.tick == tick + 1
    run("resume")
    assert session.status == "running"
    run("rate 40")
    assert session.rate == 40
    run("reset mine")
    assert session.frame.restarts == 1
    run("stop")
    session.wait_for(lambda frame: frame.status == "paused", 60)
    assert "no findings" in run("check")


def test_why_is_answered_about_now_and_about_a_time(shell, run):
    lab = cell(shell, "mine", "(machine m (state a) (state b) (ontime 60000 a -> b later)) (spawn m a)\n")
    lab.session.wait_for(lambda frame: frame.time > 0.5, timeout=120)
    assert "`later` (line 1) did not fire at 0.2 s: only 200 of 60000 ms" in run("why later at 0.2")
    assert "`a` was entered at 0 s" in run("why a mine")
    assert run("why not later at 0.2") == run("why later at 0.2")
    assert "`robot.move` has not been called" in run("why robot.move")


def test_a_code_is_explained_and_all_are_listed(shell, run):
    assert run("explain LRP301").startswith("LRP301: Unknown event (error)\n")
    assert run("explain 301") == run("explain LRP301")
    assert len(run("explain").splitlines()) == len(CODES)


@pytest.mark.slow
def test_a_block_that_does_not_return_is_interrupted_by_its_word(shell, run):
    cell(shell, "mine", A)
    assert "nothing to interrupt" in run("interrupt mine")
    session = cell(shell, "endless", A.replace("(state a)", "(state a (running [while True: pass]))")).session
    session.wait_for(lambda frame: frame.status == "hung", 60)
    assert run("interrupt endless") == ""
    assert session.wait_for(lambda frame: frame.issues, 60).issues[0].code == "LRP611"


@pytest.mark.parametrize(("name", "bridge"), [("stopwatch", "none"), ("follower", "sim")])
def test_a_bundled_program_has_a_robot_if_it_needs_one(run, name, bridge):
    run(f"new {name}")
    assert registry.find(name).session.bridge.name == bridge


@pytest.mark.parametrize(
    "line", ["mine", "mine --world oval --rate 5", 'mine --challenge "there and back" --edits=hold']
)
def test_the_text_is_written_into_a_new_cell_with_the_options_of_the_old_one(shell, run, line):
    cell(shell, line, A)
    run("save")
    assert shell.rl_next_input == f"%%lrp {line}\n{A}"


@pytest.mark.parametrize(
    ("options", "line"),
    [
        ({"challenge": "there and back", "seed": 3}, "there-and-back --challenge 'there and back' --seed 3"),
        ({"name": "my robot", "world": "oval"}, "'my robot' --world oval"),
    ],
)
def test_the_text_of_a_lab_without_such_a_cell_is_written_with_its_options(shell, run, options, line):
    lab = Lab(**options)
    lab.text += "; more"
    assert not is_saved(lab)
    run("save")
    assert shell.rl_next_input == f"%%lrp {line}\n{lab.text}"
    assert is_saved(lab)


def test_the_text_is_written_to_a_file(shell, tmp_path):
    lab = cell(shell, "mine", A)
    lab.text = B
    assert not is_saved(lab)
    lab.save(tmp_path / "mine.lrp")
    assert (tmp_path / "mine.lrp").read_text() == B
    assert is_saved(lab)


def is_saved(lab):
    return registry.connection_of(lab.session).texts.in_cell["is_saved"]


def test_earlier_texts_are_listed_and_written_into_a_new_cell(shell, run):
    lab = cell(shell, "mine", A)
    assert "no earlier texts of `mine`" in run("versions")
    with pytest.raises(UsageError, match="no earlier texts of `mine`"):
        run("version 1")
    lab.text = B
    lab.text = "(machine"
    assert [version.text for version in lab.versions] == [B, A]
    first, second = run("versions").splitlines()
    assert first.startswith("1: 20")
    assert first.endswith(", 1 line: " + B.strip())
    assert second.endswith(A.strip())
    run("version 2 mine")
    assert shell.rl_next_input == f"%%lrp mine\n{A}"
    with pytest.raises(UsageError, match="no version 3, only 1 to 2"):
        run("version 3")
    with pytest.raises(UsageError, match="Write the number of a version"):
        run("version mine")


def test_a_program_is_shown_in_the_same_lab_by_every_cell(shell):
    lab = cell(shell, "mine", A)
    assert cell(shell, "mine", A) is lab
    assert shell.run_line_magic("lrp", "mine") is lab
    assert shell.run_line_magic("lrp", "show mine") is lab


def test_another_bridge_is_chosen_by_its_name(shell, run):
    lab = cell(shell, "mine", A)
    assert "sim: lrp-jupyter" in run("bridge")
    run("bridge none")
    assert lab.session.bridge.name == "none"


FAULTY = """(var p := [6]) (var q := [0])
(machine m (var k := [[1, 2]])
  (state a (running [x = 5
                     helper(x / q)]))
  (on [k] a -> a))
(spawn m a)
"""


def test_a_debugger_at_an_issue_sees_and_assigns_everything_in_scope(shell, run, monkeypatch):
    monkeypatch.setitem(shell.user_ns, "helper", print)
    session = cell(shell, "mine --bridge none", FAULTY).session
    session.run(0.2)
    session.start()
    typed = "p p, q, k, x, robot is not None, state\n!q = 2\n!x = 1\np x / q\n!robot = 1\nq\n"
    monkeypatch.setattr("sys.stdin", StringIO(typed))
    shown = run("debug 4 mine")
    assert session.status == "paused"
    assert shown.startswith("4:29: LRP601 ZeroDivisionError: division by zero")
    assert "(6, 0, [1, 2], 5, True, 'm/a')\n" in shown
    assert "ipdb> 0.5\n" in shown
    assert "`robot` is not a variable that exists now" in shown
    assert session.variables["q"] == 2
    session.step()
    assert session.variables["q"] == 2
    monkeypatch.setattr("sys.stdin", StringIO("p p, k, state\nq\n"))
    assert "(6, [1, 2], 'm/a')\n" in run("debug 5:3")  # no exception of Python


def test_of_sessions_with_one_name_each_is_debugged_by_the_name_that_its_page_has(shell, run, monkeypatch):
    with Session(A, name="own") as one, Session(FAULTY, name="own") as other:
        for session in (one, other):
            Lab(session)
            session.run(0.2)
        sent = []
        page = registry.connection_of(other)
        page.receive(lambda message, *_: sent.append(message), {"type": "hello", "view": "p", "part": "lab"})
        (name,) = (message["name"] for message in sent if message["type"] == "snapshot")
        monkeypatch.setattr("sys.stdin", StringIO("q\n"))
        assert run(f"debug 4 {name}").startswith("4:")


def test_there_is_nothing_to_debug_where_no_issue_is(shell, run):
    session = cell(shell, "mine --bridge none", A).session
    session.start()
    assert "`mine` has no issue to debug." in run("debug")
    session.edit(FAULTY)
    session.wait_for(lambda frame: len(frame.issues) == 2, 60)
    assert "no issue at `9` to debug. Issues are listed at 5:3, 4:22." in run("debug 9")
    assert session.status == "running"


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        (
            "folower",
            "There is no command or program `folower`. Did you mean `follower`? Open programs: `follower`.",
        ),
        ("follower now", "%lrp: Unexpected `now`. `%lrp follower` shows the lab of `follower`."),
        ("pause other", "No program `other` is open. Open programs: `follower`."),
        ("pause a b", "Expected one name, not 2"),
        ("new folower", "There is no bundled program `folower`. Did you mean `follower`? Choose one of"),
        ("new mine", "`wall-follower`, or begin an empty program with `%%lrp mine`."),
        ("new", "Expected one name, not 0. Write `%lrp new NAME`."),
        ("explain LPR301", "There is no code `LPR301`. Did you mean `LRP301`?"),
        ("why", "Write the name of a transition, a state or a command"),
        ("why a at", "Write the seconds of the run after `at`"),
        ("why a at noon", "`noon` is not a number of seconds."),
        ("why a 2.5", "Write `at` before the seconds, as in `%lrp why a at 2.5`."),
        ("rate", "Write the number of ticks per second"),
        ("rate fast", "The rate is a number of ticks per second, not `fast`."),
        ("rate -1", "A rate is between 0.01 and 1,000,000 ticks"),
        ("bridge wings", "There is no bridge `wings`"),
    ],
)
def test_mistakes_are_reported_in_a_sentence(shell, line, sentence):
    cell(shell, "follower", A)
    with pytest.raises(UsageError) as error:
        shell.run_line_magic("lrp", line)
    assert sentence in str(error.value)


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("mine --world paradise", "There is no world `paradise`"),
        ("mine --bridge wings", "There is no bridge `wings`"),
        (
            "mine --on-active-edit kep",
            "`--on-active-edit` must be `restart` or `keep`, not `kep`. Did you mean `keep`?",
        ),
        ("mine --rate fast", "`--rate` is a number of ticks per second, not `fast`."),
        ("mine --wings", "`--wings` needs a value"),
        ("mine --world", "`--world` needs a value, as in `--world line`."),
        ("mine --world --rate 5", "`--world` needs a value, as in `--world line`."),
        ("mine --seed many", "`seed` takes a whole number, not `many`."),
        ("mine --wings 2", "has no option `wings`"),
        ("mine more", "Unexpected `more`"),
        ("../mine", "not a valid name for a program"),
        ("mine 'half", "A quotation mark is not closed in `mine 'half`."),
        ("mine --bridge none --world line", "`--world` is for the simulator, and the bridge is `none`."),
        ("mine --edits later", "%%lrp: `--edits` must be `live` or `hold`, not `later`."),
        ("mine --graph hiden", "`--graph` must be `live` or `static` or `hidden`, not `hiden`. Did you mean"),
        ("mine --graph --quiet", "`--graph` needs a value, as in `--graph static`."),
        ("mine --quiet=no", "`--quiet` takes no value. Leave out `=no`."),
        ("mine --lock on", "Unexpected `on`"),
    ],
)
def test_mistakes_in_the_head_of_a_cell_are_reported_in_a_sentence(shell, line, sentence):
    with pytest.raises(UsageError) as error:
        cell(shell, line, A)
    assert sentence in str(error.value)
    assert registry.names() == []


def test_a_command_without_an_open_program_is_reported_in_a_sentence(shell):
    with pytest.raises(UsageError, match=r"No program is open\. `%lrp examples` lists bundled ones\."):
        shell.run_line_magic("lrp", "pause")


def test_a_seed_of_a_cell_is_a_number_and_may_come_before_the_name(shell):
    seeded = cell(shell, "--seed=7 --world line mine", A).session
    assert (seeded.name, seeded.bridge.simulation.world.seed) == ("mine", 7)


def test_a_mistake_shows_no_traceback(shell, capsys):
    shell.run_cell("%lrp nothing")
    output = capsys.readouterr()
    assert "Traceback" not in output.out + output.err
    assert "UsageError: %lrp: There is no command or program `nothing`" in output.out + output.err


@pytest.mark.slow
def test_words_names_and_options_complete(shell):
    cell(shell, "mine", A)

    def complete(line):
        with provisionalcompleter():
            return {found.text for found in shell.Completer.completions(line, len(line))}

    assert {"pause", "new", "mine"} <= complete("%lrp ")
    assert complete("%lrp pa") == {"pause"}
    assert "mine" in complete("%lrp pause ")  # beside what Python would complete
    assert "pause" not in complete("%lrp pause ")
    assert "follower" in complete("%lrp new ")
    assert "maze" in complete("%%lrp mine --world ")
    assert "sim" in complete("%%lrp mine --bridge s")
    assert {"--rate", "--graph", "--quiet"} <= complete("%%lrp mine ")
    assert {"static", "hidden"} <= complete("%%lrp mine --graph ")


def test_help_lists_every_word(shell, run):
    output = run("help")
    assert all(word in output for word in WORDS.keys() - {"show"})
    assert "%lrp rate HZ" in shell.find_line_magic("lrp").__doc__


def test_a_cell_sets_up_a_study_which_stays_until_a_cell_sets_another(shell):
    lab = cell(shell, "mine --edits hold --graph hidden --quiet --lock", A)
    study = Conditions("hold", "hidden", quiet=True, lock=True)
    assert lab.conditions == study
    cell(shell, "mine", B)  # which a participant may run
    assert lab.conditions == study
    assert (lab.text, lab.session.program.text) == (B, A)  # it is held
    with pytest.raises(UsageError):
        cell(shell, "mine --graph statc", A)
    assert lab.conditions == study
    lab.close()  # as when the kernel is restarted
    lab = cell(shell, "mine --edits hold --graph hidden --quiet --lock", B)
    assert lab.conditions == study
    assert lab.session.program.text == B
    cell(shell, "mine --graph static", B)
    assert lab.conditions == Conditions(graph="static")


def test_a_session_is_recorded_with_what_its_user_looks_at_and_no_recording_is_overwritten(shell, tmp_path):
    for name in ("p.lrplog", "p (2).lrplog"):
        lab = cell(shell, "mine --log p.lrplog", A)
        view = Page(lab._connection)
        view.send("looked", what="hover", about="state m/a", on=True)
        view.send("command", id=1, do="look", tick=0)
        view.send("command", id=2, do="fit", width=300, height=200)
        view.send("command", id=3, do="pause")
        assert cell(shell, "mine --log p.lrplog", A) is lab
        assert lab._connection.view_state()["settings"]["log"] == str(tmp_path / name)
        with pytest.raises(
            UsageError, match=r"`mine` is open, and a recording begins before its first tick\."
        ):
            cell(shell, "mine --log other.lrplog", A)
        lab.close()
        recording = read_recording(tmp_path / name)
        assert [each[3:] for each in recording.looks if each.what != "input"] == [
            ("hover", "state m/a", True),
            ("playhead", "tick 0", True),
            ("command", "pause", True),
        ]
        assert reproduce(recording).difference is None
    assert sorted(file.name for file in tmp_path.glob("*.lrplog")) == ["p (2).lrplog", "p.lrplog"]


def test_without_a_log_nothing_is_written(shell, tmp_path):
    lab = cell(shell, "mine", A)
    Page(lab._connection).send("looked", what="hover", about="state m/a", on=True)
    assert lab.session.log == ""
    assert not [*tmp_path.glob("*.lrplog*")]
    assert lab.fault == ""


def test_a_log_that_cannot_be_written_opens_nothing(shell):
    with pytest.raises(UsageError, match="nowhere"):
        cell(shell, "mine --log nowhere/p.lrplog", A)
    assert registry.names() == []


def test_another_bridge_is_recorded_in_another_file(shell, tmp_path):
    lab = cell(shell, "mine --log p.lrplog", A)
    lab._connection.change_bridge("none")
    assert lab.session.log == str(tmp_path / "p (2).lrplog")
    lab.close()
    bridges = [read_recording(tmp_path / name).start.bridge for name in ("p.lrplog", "p (2).lrplog")]
    assert bridges == ["sim", "none"]


def test_a_cell_for_a_challenge_opens_its_world_and_shows_its_goal(shell):
    lab = cell(shell, 'mine --challenge "stop at the line"', A)
    task = challenge("stop at the line")
    assert lab.session.bridge.world.name == task.worlds[0].name
    assert lab._connection.goal.task == task
    goal = lab._connection.goal
    cell(shell, 'mine --challenge "stop at the line"', B)
    assert lab._connection.goal is goal
    assert lab.text == B
    assert not goal.offers_changes
    cell(shell, 'mine --challenge "stop at the line" --hints changes', B)
    assert lab._connection.goal.offers_changes


def test_an_empty_cell_for_a_challenge_begins_with_its_text(shell):
    result = shell.run_cell("%%lrp mine --challenge square")
    assert result.result.text == challenge("square").beginning


def test_a_challenge_that_does_not_exist_or_has_another_world_is_refused(shell):
    with pytest.raises(UsageError, match="Did you mean `square`"):
        cell(shell, "mine --challenge sqare", A)
    with pytest.raises(UsageError, match="The world is that of the challenge `square`"):
        cell(shell, "mine --challenge square --world line", A)


def test_the_picture_of_the_graph_shows_what_is_active_and_what_fired_last(shell, run, monkeypatch):
    lab = cell(shell, "mine --bridge none", "(machine m (state a) (state b) (ontime 300 a -> b)) (spawn m a)")
    lab.session.pause()
    lab.session.run(0.5)
    shown = []
    monkeypatch.setattr(shell.display_pub, "publish", shown.append)
    run("graph")
    picture = shown[0]["image/svg+xml"]
    assert "b is active." in picture
    assert "From a to b, 300 ms. It fired last." in picture


def test_no_debugger_is_offered_where_there_is_no_ipython(monkeypatch):
    monkeypatch.setitem(sys.modules, "IPython", None)  # as on the plain page of a site
    assert debugger() == ""
    assert by_hand("m") == ""


def test_where_a_page_cannot_write_into_the_notebook_it_says_what_can(monkeypatch):
    assert "`%lrp save m`" in by_hand("m")
    with monkeypatch.context() as here:
        here.setenv("VOILA_PREHEAT", "True")
        assert "Save…" in by_hand("m")
    monkeypatch.setitem(sys.modules, "marimo", SimpleNamespace(running_in_notebook=lambda: True))
    assert "Save…" in by_hand("m")
