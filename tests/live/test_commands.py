from lrp_jupyter.language.program import Program
from lrp_jupyter.live.commands import Pause, ReplaceProgram, Step
from lrp_jupyter.live.loop import Inbox


def commands(inbox):
    entries = []
    while (entry := inbox.get()) is not None:
        entries.append(entry[0])
    return entries


def test_commands_are_applied_in_the_order_in_which_they_were_queued():
    inbox = Inbox()
    for command in (Pause(), Step(), Pause("again")):
        inbox.put(command)
    assert commands(inbox) == [Pause(), Step(), Pause("again")]


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
