"""Runs as examples: kept in the lab, run again after an edit, looked at; what they reach of the program."""

from e2e import axe

WEAVER = """\
(machine m
  (state go (running [robot.move(linear=0.1)]))
  (state turn (running [robot.move(angular=1)]))
  (state home)
  (ontime 1000 go -> turn tturn)
  (ontime 1000 turn -> go tgo)
  (on [robot.bumper.data == 1] go -> home thome))
(spawn m go)
"""
LAP = '[data-lrp-run="lap"]'


def test_a_kept_run_shows_what_an_edit_would_have_changed(open_lab):
    lab = open_lab(WEAVER, "weaver --world empty")
    lab.open_tab("runs")
    lab.sees(".lrp-runs[data-empty]")
    lab.do("new-run")
    lab.until("root => Number(root.dataset.lrpTick) > 60")  # it has turned
    keep_it(lab)
    edit_what_it_does(lab)
    look_at_the_difference(lab)
    see_what_it_reaches(lab)
    expect_something_else(lab)
    accept_rename_and_remove_it(lab)


def keep_it(lab):
    lab.press('.lrp-timeline [data-lrp-action="keep-run"]')
    form = lab.find('[aria-label="Keep this run"]')
    form.get_by_label("Name of the run").fill("lap")
    assert form.get_by_label("What is expected of it").input_value() == "as recorded"
    lab.do("keep-run-now")
    lab.sees(f'{LAP}[data-state="passed"]:not([data-outdated])')
    assert form.is_hidden()
    assert lab.find('[data-lrp-tab="runs"]').inner_text() == "Runs"


def edit_what_it_does(lab):
    lab.replace("1000 go", "500 go")
    lab.sees(f'{LAP}[data-state="failed"]')
    lab.reads(f"{LAP} .lrp-run-reason", "Differs at 0.")
    assert lab.find('[data-lrp-tab="runs"]').inner_text() == "Runs (1)"
    lab.sees(f"{LAP} .lrp-strip-differs")


def look_at_the_difference(lab):
    lab.do("show-run")
    lab.sees("css=:scope[data-looking]")
    lab.is_active("m/turn")  # which it enters earlier now
    lab.do("back-to-now")
    lab.misses("css=:scope[data-looking]")


def see_what_it_reaches(lab):
    lab.do("coverage")
    lab.sees('[data-lrp-state="m/home"][data-reached="0"] .lrp-hatching')
    lab.sees('[data-lrp-state="m/turn"][data-reached="1"]')
    lab.sees('.lrp-transition[data-of="m:thome"][data-reached="0"]')
    figures = lab.find(".lrp-coverage-gutter .cm-gutterElement:not([style*=hidden]) .lrp-reached")
    lab.until("figure => figure", ".lrp-coverage-gutter .lrp-reached")
    assert figures.all_inner_texts() == ["1", "1", "0", "1", "1", "0"]
    axe.finds_nothing_serious(lab)
    lab.do("coverage")
    lab.misses(".lrp-reached")


def expect_something_else(lab):
    lab.press(f"{LAP} .lrp-run-expected")
    field = lab.sees(f"{LAP} .lrp-run-asked input")
    field.fill("reach m/turn")
    field.press("Enter")
    lab.reads(f"{LAP} .lrp-error", "reach m/turn is not something that can be expected of a run.")
    assert field.input_value() == "reach m/turn"
    field.fill("reaches m/turn within 2 s")
    field.press("Enter")
    lab.sees(f'{LAP}[data-state="passed"]')
    lab.reads(f"{LAP} .lrp-run-expected", "reaches m/turn within 2 s")


def accept_rename_and_remove_it(lab):
    lab.do("accept-run")
    lab.misses(f"{LAP} .lrp-strip-differs")
    lab.press(f'{LAP} [data-lrp-action="run-menu"]')
    lab.choose("rename-run")
    field = lab.sees(f"{LAP} .lrp-run-asked input")
    field.fill("loop")
    field.press("Enter")
    lab.sees('[data-lrp-run="loop"]')
    lab.misses(LAP)
    lab.do("run-menu")
    lab.choose("forget-run")
    lab.do("forget-run-now")
    lab.sees(".lrp-runs[data-empty]")


LATE = """\
(machine m
  (state go (running [robot.move(linear=0.1)]))
  (state turn (running [robot.move(angular=1)]))
  (ontime 8000 go -> turn tturn))
(spawn m go)
"""


def test_the_smallest_change_with_which_a_kept_run_passes_is_found_and_taken(open_lab):
    lab = open_lab(LATE, "late --world empty")
    lab.open_tab("runs")
    lab.do("new-run")
    lab.until("root => Number(root.dataset.lrpTick) > 100")
    lab.press('.lrp-timeline [data-lrp-action="keep-run"]')
    form = lab.find('[aria-label="Keep this run"]')
    form.get_by_label("Name of the run").fill("lap")
    form.get_by_label("What is expected of it").fill("reaches m/turn within 2 s")
    lab.do("keep-run-now")
    lab.sees(f'{LAP}[data-state="failed"]')
    lab.press('.lrp-search [data-lrp-action="find-change"]')
    lab.sees('[data-lrp-action="stop-search"]')
    lab.reads(".lrp-changes > li:first-child", "instead of 8000 ms (line 4) passes in 1 of 1 runs (now 0).")
    lab.reads(".lrp-found > p", "Changing linear=0.1")
    axe.finds_nothing_serious(lab)
    lab.do("line-of-change")
    lab.sees(".cm-activeLine:has-text('ontime 8000')")
    lab.do("take-change")
    lab.sees(f'{LAP}[data-state="passed"]')
    assert "ontime 8000" not in lab.text
    lab.sees(".lrp-found[data-stale]")
    assert lab.find('.lrp-search [data-lrp-action="take-change"]').first.is_hidden()
