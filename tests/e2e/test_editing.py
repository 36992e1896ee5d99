"""What is typed becomes what runs."""

from e2e.programs import COUNTER, FOLLOWER


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
