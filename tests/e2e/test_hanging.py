"""A block that does not return, in a page: it is named, and there are ways out."""

from e2e.programs import COUNTER

HUNG = ':scope[data-lrp-status="hung"]'
NOTE = ".lrp-note:not([hidden])"
HANGING = COUNTER.replace("n = n + 1", "while True: n = n + 1")


def hang(lab):
    lab.replace("n = n + 1", "while True: n = n + 1")
    lab.sees(HUNG)


def test_there_are_five_ways_out_of_a_block_that_does_not_return(open_lab):
    lab = open_lab(COUNTER)
    lab.goes_on()
    notebook = lab.notebook

    hang(lab)  # the first way: an edit
    lab.until("note => /`?count.running`? has run for \\d+ s \\(line \\d+\\)/.test(note.textContent)", NOTE)
    lab.until("note => note.textContent.includes('ontime')", NOTE)
    lab.replace("while True: n = n + 1", "n = n + 1")
    lab.ready("running").goes_on()
    lab.misses(NOTE)

    hang(lab)
    lab.do("interrupt")
    lab.sees('[data-lrp-issue^="LRP611"]')

    lab.do("pause")  # it ran on, and into it again
    lab.ready("paused")
    lab.misses(NOTE)

    notebook.write_cell(1, f"%%lrp cell\n{HANGING}")
    notebook.run_cell(1)
    lab.sees(HUNG)
    notebook.write_cell(1, f"%%lrp cell\n{COUNTER}")
    notebook.run_cell(1)
    lab.ready("running").goes_on()

    notebook.write_cell(1, f"%%lrp cell\n{HANGING}")
    notebook.run_cell(1)
    lab.sees(HUNG)
    notebook.restart_kernel()
    notebook.run_cell(0)
    notebook.run_cell(1)
    lab.ready("paused")  # or the cell would hang at once
    lab.until("note => note.textContent.includes('did not return when it last ran')", NOTE)
    lab.replace("while True: n = n + 1", "n = n + 1")
    lab.do("run")
    lab.goes_on()
