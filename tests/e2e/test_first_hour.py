"""The first hour in the editor: what is typed looks right, and what is unknown is explained."""

from e2e.programs import COUNTER, FOLLOWER

PRINTED = """\
(var limit := [
  base = 5
  base * 2])

(machine m
  (var n := [0])
  (event full [n > limit])

  (state count
    (running [
      n += 1
      if n > 100:
          n = 0]))
  (state rest)   ; for a while
  (on full count -> rest)
  (ontime 500 rest -> count))

(spawn m count)"""
EMPTY = "; nothing yet"
VALUES = """\
(var short := [1])
(var list := [list(range(200))])
(var text := ["a text so long that its line of the program has no room left for what it is at the moment"])
(machine m
  (event waits [short > 1])
  (event idle [short > 0])
  (state a)
  (state b)
  (on waits a -> b)
  (on idle b -> a))
(spawn m a)
"""


def test_a_program_typed_without_any_indentation_looks_as_printed(open_lab):
    lab = open_lab(EMPTY)
    lab.find(".cm-content").focus()
    lab.page.keyboard.press("Control+End")
    for number, line in enumerate(PRINTED.split("\n")):
        if number:
            lab.page.keyboard.press("Enter")
        lab.page.keyboard.type(line.strip(), delay=5)
    assert lab.text == f"{EMPTY}\n{PRINTED}"
    lab.sees('.lrp-verdict[data-state="runs"]')
    lab.is_active("m/count")


def test_enter_after_a_complete_name_begins_a_line(open_lab):
    lab = open_lab(COUNTER.replace("(state rest)", "(state rest) (state restless)"))
    lab.replace("-> rest tfull", "-> res")
    lab.sees(".cm-tooltip-autocomplete [role=option]")
    lab.page.keyboard.type("t")
    lab.misses(".cm-tooltip-autocomplete")
    lab.page.keyboard.press("Enter")
    assert "-> rest\n" in lab.text


def test_a_keyword_is_explained_under_the_pointer(open_lab):
    lab = open_lab(FOLLOWER, "follower --world line")
    lab.select("ontime 1000")
    lab.find(".cm-line .tok-keyword").get_by_text("ontime").last.hover()
    card = lab.sees(".lrp-card")
    assert "(ontime milliseconds source -> destination)" in card.inner_text()


def test_values_keep_to_the_right_of_their_lines_and_need_none_of_their_own(open_lab):
    lab = open_lab(VALUES)
    lab.sees(".cm-line:has-text('(event waits') .lrp-inline-value")
    boxes = lab.find(".cm-line:has(.lrp-inline-value)").evaluate_all(
        "lines => lines.map(line => { const value = line.querySelector('.lrp-inline-value');"
        " const [outer, inner] = [line, value].map(node => node.getBoundingClientRect());"
        " value.remove(); const { height } = line.getBoundingClientRect();"
        " return { taller: outer.height - height, right: outer.right - inner.right,"
        " left: inner.left - outer.left, below: inner.bottom - outer.bottom }; })"
    )
    assert [box["taller"] for box in boxes] == [0] * 4
    assert all(0 <= box["right"] < 1 and box["left"] > 0 and box["below"] < 3 for box in boxes)


def test_a_value_is_left_out_where_less_than_a_word_of_it_could_be_read(open_lab):
    lab = open_lab("(var a := [10])")
    lab.sees(".lrp-values")
    lab.select("(var a := [10])")
    lab.page.keyboard.press("End")
    lab.page.keyboard.type("   ;")
    for _ in range(200):
        lab.page.keyboard.type("x")
        line, value, hidden = lab.find(".cm-line:has(.lrp-values)").evaluate(
            "line => { const box = node => node.getBoundingClientRect();"
            " const [around, value] = ['.lrp-inline-value', '.lrp-values']"
            ".map(name => box(line.querySelector(name)));"
            " return [box(line).height, value.width, value.top > around.bottom - 1]; }"
        )
        if hidden:
            break
        assert value > 30
    assert hidden
    assert line < 30


def test_the_value_of_an_event_that_is_not_tested_is_faded(open_lab):
    lab = open_lab(VALUES.replace("(state a)", "(state a (onexit [short = 0]))"))
    stale = "css=.cm-line:has-text('(event idle') [data-stale]"
    fresh = "css=.cm-line:has-text('(event waits') .lrp-values span:not([data-stale])"
    lab.sees(fresh)
    lab.replace("short := [1]", "short := [2]")
    lab.sees(stale.replace("idle", "waits"))
    lab.sees(fresh.replace("waits", "idle"))


def test_the_text_is_formatted_by_a_key_and_undone_by_another(open_lab):
    rough = COUNTER.replace("\n  ", " ")
    lab = open_lab(rough)
    lab.goes_on()
    lab.select("(state rest)")
    lab.page.keyboard.press("Shift+Alt+F")
    lab.until("editor => editor.querySelectorAll('.cm-line').length > 8", ".cm-editor")
    assert lab.text == COUNTER
    assert lab.page.evaluate("getSelection().toString()") == "(state rest)"
    assert lab.find(".lrp-notice:visible").count() == 0
    lab.page.keyboard.press("Control+z")
    lab.until("editor => editor.querySelectorAll('.cm-line').length < 6", ".cm-editor")
    assert lab.text == rough
    colours = lab.find("[class^=lrp-bracket-]").evaluate_all(
        "all => all.map(span => getComputedStyle(span.firstElementChild ?? span).color)"
    )
    assert len(set(colours)) == 4


def test_what_is_missing_is_created_by_keys_and_its_value_is_typed_at_once(open_lab):
    lab = open_lab(COUNTER)
    lab.goes_on()
    lab.type_after("(on full count -> rest tfull)", " (on begin rest -> count)")
    lab.sees('[data-lrp-issue="LRP301"]')
    lab.page.keyboard.press("ArrowLeft")
    lab.page.keyboard.press("Control+.")
    assert lab.sees('[role="menu"] [data-lrp-action="fix"]').inner_text() == "Create the event begin"
    lab.page.keyboard.press("Enter")
    lab.misses('[data-lrp-issue="LRP301"]')
    lab.page.keyboard.type("n < 0")
    assert "  (event full [n > limit])\n  (event begin [n < 0])\n" in lab.text


def test_a_missing_state_is_created_from_its_card(open_lab):
    lab = open_lab(COUNTER)
    lab.replace("-> rest tfull", "-> finished tfull")
    lab.sees('[data-lrp-issue="LRP303"]')
    lab.find(".cm-content").focus()
    lab.page.keyboard.press("F8")
    lab.sees(".cm-diagnosticAction:has-text('Create the state finished')").click()
    lab.misses('[data-lrp-issue="LRP303"]')
    lab.sees('[data-lrp-state="m/finished"]')
    assert "  (state rest)\n  (state finished)\n" in lab.text


def test_what_the_text_shows_is_chosen_in_the_menu_and_kept(open_lab):
    lab = open_lab(COUNTER)
    for action, shown in (("values", ".lrp-inline-value"), ("brackets", ".lrp-bracket-2")):
        lab.sees(shown)
        lab.do("menu")
        lab.choose(action)
        lab.misses(shown)
    lab.notebook.run_cell(1)
    again = lab.notebook.lab().ready()
    again.sees(".tok-keyword")
    assert again.find(".lrp-inline-value, .lrp-bracket-2").count() == 0
    again.do("menu")
    again.choose("brackets")
    again.sees(".lrp-bracket-2")
