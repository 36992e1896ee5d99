"""Replies to what a page asks: when they come, and the sentences of those that fail."""

from threading import Event

import pytest

from lrp_jupyter.live.running.commands import Call

NAMED = "(var limit := [5]) (machine m (state a)) (spawn m a)"
HANGS = "(machine m (state a (running [inside.set() or gate.wait(60)]))) (spawn m a)"


@pytest.fixture
def gate():
    """What hangs waits for it; it is opened at the end."""
    gate = Event()
    yield gate
    gate.set()


@pytest.fixture
def inside():
    return Event()


def test_a_command_that_a_block_holds_up_is_answered_after_a_second_with_what_it_waits_for(
    bench, gate, inside
):
    lab = bench(HANGS, namespace={"gate": gate, "inside": inside}, hung_after=0.01)
    page = lab.page()
    lab.session.start()
    lab.session.wait_for(lambda frame: frame.status == "hung", 60)
    page.send("command", id=1, do="rate", value=25)
    lab.publish(after=0.9)
    assert not page.all("reply")
    lab.publish(after=0.2)
    assert page.last("reply")["error"].startswith("This waits: `a.running` has run for ")


@pytest.mark.slow
def test_a_pause_waits_until_the_block_is_interrupted_and_is_no_error(bench, inside):
    lab = bench(
        "(machine m (state a (running [inside.set()] [while True: pass]))) (spawn m a)",
        namespace={"inside": inside},
        hung_after=0.2,
    )
    page = lab.page()
    lab.session.start()
    lab.session.wait_for(lambda frame: frame.status == "hung", 60)
    page.send("command", id=1, do="pause")
    lab.publish(after=1.5)
    lab.session.wait_for(lambda frame: frame.status == "paused", 60)
    lab.publish()
    assert page.last("reply")["error"] is None


def test_a_command_that_another_one_holds_up_is_not_explained_by_an_old_pause(bench, gate, inside):
    lab = bench(NAMED)
    page = lab.page()
    lab.session.start()
    lab.session.stop_robot()
    assert lab.session.wait_for(lambda frame: frame.status == "paused", 60).reason
    lab.session.submit(Call(lambda: inside.set() or gate.wait(60)))
    assert inside.wait(60)
    page.send("command", id=1, do="rate", value=25)
    lab.publish(after=1.1)
    assert page.last("reply")["error"] == "This waits: the session is busy."


def test_a_question_about_another_course_has_time_for_the_run_that_it_repeats(bench, gate):
    lab = bench(NAMED)
    page = lab.page()
    lab.session.run(2)
    lab.connection.work(lambda: gate.wait(60))  # as long as the repetition takes
    page.send("what_if", id=1, seconds=1)
    lab.publish(after=20)
    assert not page.all("reply")
    gate.set()
    lab.connection.work(lambda: None).result(60)
    lab.publish()
    assert page.last("reply")["what_if"]["end"] > 0


def test_an_answer_for_a_view_that_is_gone_keeps_none_from_others(bench):
    lab = bench(NAMED)
    gone, page = lab.page("gone"), lab.page()
    gone.send("command", id=1, do="rate", value=20)
    page.send("command", id=2, do="rate", value=25)
    gone.send("bye")
    lab.publish()
    assert page.last("reply")["id"] == 2
    assert not gone.all("reply")


def test_a_file_that_cannot_be_written_is_an_error_in_a_sentence(bench, tmp_path):
    page = bench(NAMED).page()
    error = page.ask("save", name=str(tmp_path / "no folder" / "mine.lrp"), replace=False)["error"]
    assert "No such file or directory" in error
    assert "FileNotFoundError" not in error


def test_an_error_without_words_is_named(bench):
    page = bench(NAMED).page()
    page.do("step")
    silent = "(_ for _ in ()).throw(ValueError())"
    assert page.do("set_variable", path="limit", expression=silent) == "ValueError."
