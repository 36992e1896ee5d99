"""What is typed becomes what runs."""

from e2e.programs import COUNTER, FOLLOWER, INNER


def test_a_lab_shows_a_robot_that_moves(open_lab):
    lab = open_lab(FOLLOWER, "follower --world line")
    lab.goes_on()
    lab.is_active("follower/looking")
    lab.until("(element, text) => element.textContent !== text", ".lrp-world-time", "0.0 s")
    assert lab.value("lightlim") == "128"


def test_a_typed_state_appears_in_the_graph(open_lab):
    lab = open_lab(COUNTER)
    lab.type_after("(state rest)", " (state third)")
    lab.sees('[data-lrp-state="m/third"]')
    lab.is_active("m/count")
    lab.goes_on()


def test_a_completed_transition_is_drawn_and_fires_without_a_restart(open_lab):
    lab = open_lab(COUNTER)
    lab.goes_on()
    counted = int(lab.value("m/n"))
    lab.type_after("rest tfull)", " (on [n > 0] count -> rest)")
    lab.sees('[data-lrp-transition$=":count->rest"][data-fired]')
    lab.is_active("m/rest")
    assert int(lab.value("m/n")) >= counted


def test_a_broken_bracket_is_marked_while_the_program_runs_on_and_gone_when_repaired(open_lab):
    lab = open_lab(COUNTER)
    revision = lab.revision
    lab.select("(state rest)")
    lab.page.keyboard.press("ArrowRight")
    lab.page.keyboard.press("Backspace")
    lab.sees('[data-lrp-issue^="LRP1"][data-severity="error"]')
    lab.sees(".cm-lintRange-error")
    lab.sees('.lrp-verdict[data-state="broken"]')
    lab.goes_on()
    assert lab.revision == revision
    lab.is_active("m/count")
    lab.page.keyboard.type(")")
    lab.misses('[data-lrp-issue^="LRP1"]')
    lab.misses(".cm-lintRange-error")
    lab.sees('.lrp-verdict[data-state="runs"]')


def test_an_edited_initialiser_changes_only_its_variable(open_lab):
    lab = open_lab(FOLLOWER, "follower --world line")
    lab.goes_on()
    lab.replace("[200]", "[350]")
    lab.has_value("maxlook", "350")
    assert lab.value("lightlim") == "128"
    lab.goes_on()
    assert lab.find(".lrp-notice:visible").count() == 0


def test_held_edits_wait_for_their_button(open_lab):
    lab = open_lab(COUNTER)
    lab.do("hold")
    lab.sees('[data-lrp-action="hold"][aria-checked="true"]')
    revision = lab.revision
    lab.type_after("(state rest)", " (state third)")
    lab.reads(".lrp-difference [data-kind=added]", "third")
    assert lab.revision == revision
    assert lab.find('[data-lrp-state="m/third"]').count() == 0
    lab.do("apply")
    lab.sees('[data-lrp-state="m/third"]')
    lab.select(" (state third)")
    lab.page.keyboard.press("Delete")
    lab.reads(".lrp-difference [data-kind=removed]", "third")
    lab.do("revert")
    lab.misses(".lrp-difference [data-kind=removed]:visible")
    assert "(state third)" in lab.text


def test_a_dangling_reference_is_marked_drawn_broken_and_mended_by_its_fix(open_lab):
    lab = open_lab(COUNTER)
    lab.replace("-> rest tfull", "-> rset tfull")
    lab.sees('[data-lrp-issue="LRP303"]')
    lab.sees('[data-lrp-transition="m:tfull"][data-broken]')
    lab.find(".cm-content").focus()
    lab.page.keyboard.press("F8")  # to the next finding, its card open
    lab.sees(".cm-diagnosticAction").click()
    lab.misses('[data-lrp-issue="LRP303"]')
    lab.misses('[data-lrp-transition="m:tfull"][data-broken]')
    assert "-> rest tfull" in lab.text


def test_a_selected_transition_stays_selected_when_it_is_edited_and_when_its_state_is_renamed(open_lab):
    lab = open_lab(INNER)
    lab.sees('[data-lrp-transition$="a->b"] .lrp-hit').dispatch_event("click")
    arrow = lab.sees(".lrp-transition[data-chosen]").element_handle()
    lab.replace("90000", "70000")
    lab.reads(".lrp-layer-labels", "70000")
    assert arrow.evaluate("arrow => arrow.isConnected && arrow.hasAttribute('data-chosen')")
    lab.state("m/a").click(button="right")
    lab.choose("rename")
    lab.sees(".lrp-rename input").fill("z")
    lab.page.keyboard.press("Enter")
    lab.sees('[data-lrp-transition$="z->b"][data-chosen]')


def test_the_machine_shown_stays_shown_when_the_state_around_it_is_renamed(open_lab):
    lab = open_lab(INNER)
    lab.sees('[data-lrp-machine="m/a/inner"]').click()
    lab.sees('[data-lrp-state="m/a/inner/x"]')
    lab.select("(state a")
    lab.page.keyboard.press("ArrowRight")
    lab.page.keyboard.press("F2")
    lab.sees(".lrp-rename input").fill("z")
    lab.page.keyboard.press("Enter")
    lab.sees('[data-lrp-machine="m/z/inner"][aria-selected="true"]')
    lab.sees('[data-lrp-state="m/z/inner/x"][data-active]')


def test_a_state_is_renamed_everywhere_and_stays_active(open_lab):
    lab = open_lab(COUNTER)
    lab.goes_on()
    counted = int(lab.value("m/n"))
    lab.select("(state count")  # the cursor is at the end of the name
    lab.page.keyboard.press("F2")
    field = lab.sees(".lrp-rename input")
    field.fill("work")
    field.press("Enter")
    lab.is_active("m/work")
    assert "(on full work -> rest tfull)" in lab.text
    assert int(lab.value("m/n")) >= counted


def test_members_of_the_robot_are_completed_with_their_values(open_lab):
    lab = open_lab(FOLLOWER, "follower --world line")
    lab.type_after("robot.light.data < lightlim - 10", " and robot.bump")
    lab.reads(".cm-tooltip-autocomplete [role=option]", "bumper")
    lab.page.keyboard.press("Escape")
