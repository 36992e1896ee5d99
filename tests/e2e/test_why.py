"""Asking why, where the question arises: in the graph, in the text, at the robot."""

from e2e.programs import COUNTER, FOLLOWER

LONG = "a_name_that_is_much_too_long_to_be_read_at_a_glance_" * 2


def card(lab):
    """The open card."""
    lab.sees(".lrp-why .lrp-why-sentence code")
    return lab.find(".lrp-why")


def test_a_transition_is_asked_why_it_did_not_fire(open_lab):
    lab = open_lab(COUNTER)
    lab.goes_on()
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


def test_a_state_is_asked_by_its_menu_and_the_robot_by_that_of_the_lab(open_lab):
    lab = open_lab(FOLLOWER, "follower --world line")
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


def test_a_card_about_a_long_name_can_be_closed_where_there_is_little_room(page, open_lab):
    page.set_viewport_size({"width": 700, "height": 900})
    lab = open_lab(COUNTER.replace("rest", LONG))
    lab.goes_on()
    lab.find(f'[data-lrp-state="m/{LONG}"]').first.focus()
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


def test_a_transition_without_a_name_is_called_as_in_the_sentence(open_lab):
    lab = open_lab(COUNTER.replace(" tfull)", ")"))
    lab.goes_on()
    lab.find("[data-lrp-transition]").first.focus()
    lab.page.keyboard.press("?")
    card(lab)
    lab.reads(".lrp-why .lrp-title", "Why not full:count->rest?")


def test_a_code_is_explained_where_it_is_shown(open_lab):
    lab = open_lab(COUNTER.replace("-> rest tfull", "-> rset tfull"))
    lab.find('[data-lrp-issue="LRP303"] [data-lrp-action="explain"]').click()
    answer = card(lab)
    assert answer.get_attribute("aria-label") == "Unknown destination"
    assert "(ontime 1000 a -> moving)" in answer.inner_text()
    assert answer.locator("a").count() == 0, "the documentation is published nowhere"
    lab.page.keyboard.press("Escape")
    lab.misses(".lrp-why")
    lab.find(".cm-content").focus()
    lab.page.keyboard.press("F8")  # to the next finding, its card open
    lab.sees(".cm-tooltip [data-lrp-action='explain']").click()
    assert card(lab).get_attribute("aria-label") == "Unknown destination"
