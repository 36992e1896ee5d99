"""What was typed or kept survives reruns, ends of kernels and other programs; nothing hidden runs."""

from e2e.programs import COUNTER

RERUNS = 30
GROWTH = 5e6  # bytes


def heap(page):
    """Return the bytes that the page's scripts hold."""
    session = page.context.new_cdp_session(page)
    for _ in range(3):
        session.send("HeapProfiler.collectGarbage")
    used = session.send("Runtime.getHeapUsage")["usedSize"]
    session.detach()
    return used


def test_a_cell_that_is_run_again_thirty_times_costs_the_page_no_memory(open_lab):
    lab = open_lab(COUNTER)
    for _ in range(3):
        lab.notebook.run_cell(1)
        lab.ready()
    before = heap(lab.page)
    for _ in range(RERUNS):
        lab.notebook.run_cell(1)
        lab.ready()
    grown = heap(lab.page) - before
    assert grown < GROWTH
