"""A block that does not return, in a page: it is named, and there are ways out."""

from e2e.programs import COUNTER

HUNG = ':scope[data-lrp-status="hung"]'
NOTE = ".lrp-note:not([hidden])"


def test_a_loop_is_typed_named_and_edited_away(open_lab):
    lab = open_lab(COUNTER)
    lab.goes_on()
    lab.replace("n = n + 1", "while True: n = n + 1")
    lab.sees(HUNG)
    lab.until("note => /`?count.running`? has run for \\d+ s \\(line \\d+\\)/.test(note.textContent)", NOTE)
    lab.until("note => note.textContent.includes('ontime')", NOTE)
    lab.replace("while True: n = n + 1", "n = n + 1")
    lab.sees(':scope[data-lrp-status="running"]')
    lab.goes_on()
    lab.misses(NOTE)


def test_the_button_interrupts_the_block_which_becomes_an_issue(open_lab):
    lab = open_lab(COUNTER)
    lab.replace("n = n + 1", "while True: n = n + 1")
    lab.sees(HUNG)
    lab.do("interrupt")
    lab.sees('[data-lrp-issue^="LRP611"]')


def test_pause_gets_through_to_a_program_that_hangs(open_lab):
    lab = open_lab(COUNTER)
    lab.replace("n = n + 1", "while True: n = n + 1")
    lab.sees(HUNG)
    lab.do("pause")
    lab.sees(':scope[data-lrp-status="paused"]')
    lab.misses(NOTE)


def test_running_the_repaired_cell_gets_through_to_a_program_that_hangs(open_lab):
    notebook = open_lab(COUNTER).notebook
    notebook.write_cell(1, "%%lrp m\n" + COUNTER.replace("n = n + 1", "while True: n = n + 1"))
    notebook.run_cell(1)
    lab = notebook.lab()
    lab.sees(HUNG)
    notebook.write_cell(1, f"%%lrp m\n{COUNTER}")
    notebook.run_cell(1)
    notebook.lab().ready("running").goes_on()


def test_a_cell_whose_program_hung_opens_paused_after_a_restart_of_the_kernel(open_lab):
    notebook = open_lab(COUNTER).notebook
    notebook.write_cell(1, "%%lrp m\n" + COUNTER.replace("n = n + 1", "while True: n = n + 1"))
    notebook.run_cell(1)
    notebook.lab().sees(HUNG)
    notebook.restart_kernel()
    notebook.run_cell(0)
    notebook.run_cell(1)
    lab = notebook.lab().ready("paused")
    lab.until("note => note.textContent.includes('did not return when it last ran')", NOTE)
    lab.replace("while True: n = n + 1", "n = n + 1")
    lab.do("run")
    lab.goes_on()
