"""A program is controlled, and asked why, by buttons, menus, keys, fields and the mouse."""

from e2e.programs import COUNTER, EYE, FOLLOWER, LONG, VISITS

LONG_NAME = "a_name_that_is_much_too_long_to_be_read_at_a_glance_" * 2
LONG_NAMES = COUNTER.replace(" tfull", "").replace("rest", LONG_NAME)


def test_a_run_is_stepped_asked_and_stopped_while_a_cell_runs_for_long(open_lab):
    lab = open_lab(COUNTER, "m", LONG, "1")
    lab.goes_on()
    ask_about_a_transition(lab)
    step(lab)
    count_an_issue(lab)
    obey_beside_a_cell(lab)


def test_states_values_and_the_robot_are_changed_and_asked_about(open_lab):
    lab = open_lab(VISITS)
    enter_states_by_menu(lab)
    enter_states_by_keys(lab)
    change_a_variable(lab)
    drag_the_robot(lab.notebook.open(EYE, "eye --world line"))
    ask_a_state_and_the_robot(lab.notebook.open(FOLLOWER, "follower --world line"))
    ask_where_there_is_little_room(lab.notebook.open(LONG_NAMES, "long"))


def card(lab):
    """The open card."""
    lab.sees(".lrp-why .lrp-why-sentence code")
    return lab.find(".lrp-why")


def step(lab):
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
    lab.has_value("m/n", "1")
    lab.do("run")
    lab.ready("running")
    lab.goes_on()


def enter_states_by_menu(lab):
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


def enter_states_by_keys(lab):
    press = lab.page.keyboard.press
    lab.sees('[data-lrp-state="m/here"]').focus()
    press("ArrowDown")
    lab.until("svg => svg.dataset.focus === 'm:tgo' || svg.dataset.focus === 'm/there'", ".lrp-graph")
    lab.sees('[data-lrp-state="m/there"]').focus()
    press("m")
    lab.sees('[role="menu"]')
    press("Enter")  # the first entry: transition here
    lab.has_value("visits", "2")
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
    lab.has_value("visits", "3")


def change_a_variable(lab):
    lab.state("m/here").click(button="right")
    lab.choose("teleport")
    changing = lab.sees('[data-lrp-variable="steps"]')
    changing.locator(".lrp-spark").wait_for()
    changing.locator(".lrp-value").dblclick()
    field = changing.locator("input")
    field.fill("-9")
    lab.goes_on()
    field.press("Enter")
    lab.is_active("m/there")
    lab.has_value("visits", "4")
    row = lab.sees('[data-lrp-variable="visits"]')
    row.locator(".lrp-value").click()
    field = row.locator("input")
    field.fill("steps +")
    field.press("Enter")
    lab.until("error => error.textContent !== ''", '[data-lrp-variable="visits"] .lrp-error')
    field.fill("6 * 7")
    field.press("Enter")
    lab.has_value("visits", "42")
    row.locator(".lrp-value").click()
    field.fill("[1] * 99")
    field.press("Enter")
    row.locator(".lrp-spark").wait_for(state="hidden")
    ends = [each.bounding_box() for each in (row, row.locator(".lrp-value"))]
    whole, value = (end["x"] + end["width"] for end in ends)
    assert whole - value < 60, "it has all the room but that of the button"


def drag_the_robot(lab):
    lab.is_active("m/on")  # it begins on the line
    lab.drag_robot((0.7, 0.5), (0.7, 0.9))
    lab.page.mouse.move(0, 0)
    lab.do("reset")
    lab.goes_on()
    lab.is_active("m/off")
    lab.drag_robot((0.7, 0.9), (0.6, 0.5))
    lab.is_active("m/on")


def obey_beside_a_cell(lab):
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


def count_an_issue(lab):
    lab.replace("n = n + 1", "n = n + 1 / (n < 0)")
    lab.sees('[data-lrp-issue^="LRP6"]')
    lab.reads('[data-lrp-issue^="LRP6"]', "×")
    lab.goes_on()
    lab.replace("n = n + 1 / (n < 0)", "n = n + 1")
    lab.sees('[data-lrp-issue^="LRP6"][data-resolved]')
    lab.do("clear")
    lab.misses('[data-lrp-issue^="LRP6"]')


def ask_about_a_transition(lab):
    lab.find('[data-lrp-transition="m:tfull"]').first.focus()
    lab.page.keyboard.press("?")
    answer = card(lab)
    assert "tfull (line 7) did not fire at" in answer.inner_text()
    assert "n > limit (line 4) was False" in answer.inner_text()
    before = answer.locator(".lrp-why-sentence").inner_text()
    lab.until("(element, text) => element.textContent !== text", ".lrp-why-sentence", before)
    answer.locator(".lrp-why-line", has_text="event full").click()
    lab.sees(".cm-activeLine:has-text('event full')")
    lab.find(".lrp-why").focus()
    lab.page.keyboard.press("Escape")
    lab.misses(".lrp-why")


def ask_a_state_and_the_robot(lab):
    lab.is_active("follower/moving")
    lab.pause()
    lab.state("follower/moving").click(button="right")
    lab.choose("why")
    assert "moving was entered at" in card(lab).inner_text()
    lab.page.keyboard.press("Escape")
    lab.do("menu")
    lab.choose("why-robot")
    assert "The last command was robot." in card(lab).inner_text()
    assert "(line " in lab.find(".lrp-why-sentence").inner_text()
    lab.page.keyboard.press("Escape")


def ask_where_there_is_little_room(lab):
    lab.find("[data-lrp-transition]").first.focus()
    lab.page.keyboard.press("?")
    lab.reads(".lrp-why .lrp-title", "Why not full:count->")  # called as in the sentence
    lab.page.keyboard.press("Escape")
    lab.page.set_viewport_size({"width": 700, "height": 900})
    lab.find(f'[data-lrp-state="m/{LONG_NAME}"]').first.focus()
    lab.page.keyboard.press("?")
    card(lab)
    answer, button = lab.box(".lrp-why"), lab.box('[data-lrp-action="close-why"]')
    assert answer["x"] <= button["x"]
    assert button["x"] + button["width"] <= answer["x"] + answer["width"]
    title = lab.box(".lrp-why .lrp-title")
    assert title["x"] + title["width"] <= button["x"]
    assert lab.find(".lrp-why .lrp-title").inner_text().endswith(" s")  # of which moment
    lab.do("close-why")
    lab.misses(".lrp-why")
