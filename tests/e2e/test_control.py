"""The program is controlled by buttons, menus, keys, fields and the mouse."""

from e2e.programs import COUNTER, EYE, FOLLOWER, LONG, VISITS


def test_pause_step_step_back_and_reset(open_lab):
    lab = open_lab(COUNTER)
    lab.goes_on()
    lab.pause()
    tick, n = lab.tick, int(lab.value("m/n"))
    lab.do("step")
    lab.has_value("m/n", str(n + 1))
    assert lab.tick == tick + 1
    lab.do("step-back")
    lab.has_value("m/n", str(n))
    assert lab.tick == tick
    lab.do("reset")
    lab.has_value("m/n", "—")
    lab.do("step")
    lab.has_value("m/n", "0")
    lab.do("run")
    lab.ready("running")
    lab.goes_on()


def test_a_state_is_gone_to_and_teleported_to_by_its_menu(open_lab):
    lab = open_lab(VISITS)
    lab.state("m/there").click(button="right")
    lab.choose("transition")
    lab.is_active("m/there")
    lab.has_value("visits", "1")
    lab.state("m/here").click(button="right")
    lab.choose("teleport")
    lab.is_active("m/here")
    lab.state("m/there").click(button="right")
    lab.choose("teleport")
    lab.is_active("m/there")
    assert lab.value("visits") == "1", "a teleport runs no action"


def test_a_state_is_gone_to_and_a_transition_fired_by_keys_alone(open_lab):
    lab = open_lab(VISITS)
    press = lab.page.keyboard.press
    lab.sees('[data-lrp-state="m/here"]').focus()
    press("ArrowDown")
    lab.until("svg => svg.dataset.focus === 'm:tgo' || svg.dataset.focus === 'm/there'", ".lrp-graph")
    lab.sees('[data-lrp-state="m/there"]').focus()
    press("m")
    lab.sees('[role="menu"]')
    press("Enter")  # the first entry: transition here
    lab.has_value("visits", "1")
    press("Shift+F10")
    lab.sees('[role="menu"]')
    press("Escape")
    lab.misses('[role="menu"]')
    lab.until("node => node === document.activeElement", '[data-lrp-state="m/there"]')
    lab.sees('[data-lrp-state="m/here"]').focus()
    press("m")
    press("ArrowDown")
    press("Enter")  # teleport here
    lab.is_active("m/here")
    lab.sees('[data-lrp-transition="m:tgo"]').focus()
    press("m")
    press("Enter")  # fire now
    lab.is_active("m/there")
    lab.has_value("visits", "2")


def test_a_variable_is_changed_in_place_and_a_mistake_is_shown_at_its_field(open_lab):
    lab = open_lab(VISITS)
    row = lab.sees('[data-lrp-variable="visits"]')
    row.locator(".lrp-value").click()
    field = row.locator("input")
    field.fill("steps +")
    field.press("Enter")
    lab.until("error => error.textContent !== ''", '[data-lrp-variable="visits"] .lrp-error')
    field.fill("6 * 7")
    field.press("Enter")
    lab.has_value("visits", "42")


def test_the_robot_is_dragged_onto_the_line_and_sees_it(open_lab):
    lab = open_lab(EYE, "m --world line")
    lab.is_active("m/on")  # it begins on the line
    lab.drag_robot((0.7, 0.5), (0.7, 0.9))
    lab.page.mouse.move(0, 0)
    lab.do("reset")
    lab.goes_on()
    lab.is_active("m/off")
    lab.drag_robot((0.7, 0.9), (0.6, 0.5))
    lab.is_active("m/on")


def test_stop_pause_and_edits_are_obeyed_while_a_cell_runs_for_long(open_lab):
    lab = open_lab(COUNTER, "m", LONG, "1")
    notebook = lab.notebook
    folder = notebook.path.parent
    notebook.begin_cell(2)
    notebook.prints(2)
    lab.do("stop")
    lab.ready("paused")
    lab.do("run")
    lab.ready("running")
    lab.type_after("(state rest)", " (state third)")
    lab.sees('[data-lrp-state="m/third"]')
    assert not (folder / "over").exists(), "the cell still runs"
    (folder / "go").touch()
    notebook.run_cell(3)
    assert (folder / "over").exists()


def test_a_nested_machine_opens_on_double_click_and_the_tree_leads_back(open_lab):
    lab = open_lab(FOLLOWER, "follower --world line")
    lab.state("follower/looking").dblclick()
    lab.sees('[data-lrp-state="follower/looking/lookalgo/lookleft"]')
    lab.sees('[data-lrp-variable="follower/looking/lookalgo/time"]')
    lab.sees('[data-lrp-machine="follower"]').click()
    lab.sees('[data-lrp-state="follower/moving"]')
    lab.sees('[data-lrp-machine="follower"][aria-selected="true"][data-active]')


def test_an_issue_of_the_run_is_counted_at_its_place_and_resolved(open_lab):
    lab = open_lab(COUNTER)
    lab.replace("[n = n + 1]", "[n = n + 1 / (n < 0)]")
    lab.sees('[data-lrp-issue^="LRP6"]')
    lab.reads('[data-lrp-issue^="LRP6"]', "×")
    lab.goes_on()
    lab.replace("[n = n + 1 / (n < 0)]", "[n = n + 1]")
    lab.sees('[data-lrp-issue^="LRP6"][data-resolved]')
    lab.do("clear")
    lab.misses('[data-lrp-issue^="LRP6"]')
