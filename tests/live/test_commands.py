import pytest

from lrp_jupyter.errors import LRPError
from lrp_jupyter.language.program import Program
from lrp_jupyter.live.running.commands import Pause, ReplaceProgram, Reset, Resume, SetRate, Step
from lrp_jupyter.live.running.inbox import Inbox


def commands(inbox):
    entries = []
    while (entry := inbox.get()) is not None:
        entries.append(entry[0])
    return entries


def test_commands_are_applied_in_the_order_in_which_they_were_queued():
    inbox = Inbox()
    for command in (Reset(), Step(), Reset(), SetRate(5)):
        inbox.put(command)
    assert commands(inbox) == [Reset(), Step(), Reset(), SetRate(5)]


@pytest.mark.slow
def test_a_pause_overtakes_what_waits_and_cancels_what_would_move_the_robot():
    inbox = Inbox()
    answers = [inbox.put(command) for command in (Reset(), Resume(), *[Step()] * 10_000, SetRate(5))]
    inbox.put(Pause("Stop."))
    assert commands(inbox) == [Pause("Stop."), Reset(), SetRate(5)]
    for answer in answers[1:-1]:
        with pytest.raises(LRPError, match="paused before"):
            answer.result(0)
    assert [answer.done() for answer in answers[:2]] == [False, True]
    assert not answers[-1].done()


def test_of_edits_in_a_row_the_newest_wins():
    inbox, programs = Inbox(), [Program(text=str(number)) for number in range(3)]
    answers = [inbox.put(ReplaceProgram(program)) for program in programs]
    (last,) = commands(inbox)
    assert last.program is programs[2]
    assert [answer.cancelled() for answer in answers] == [True, True, False]


def test_an_edit_does_not_overtake_what_came_between():
    inbox, (one, two) = Inbox(), [Program(text=str(number)) for number in range(2)]
    for command in (ReplaceProgram(one), Step(), ReplaceProgram(two)):
        inbox.put(command)
    assert [type(command) for command in commands(inbox)] == [ReplaceProgram, Step, ReplaceProgram]


def test_every_command_wakes_the_loop():
    inbox = Inbox()
    inbox.put(Step())
    assert inbox.wake.is_set()
    assert len(inbox) == 1
