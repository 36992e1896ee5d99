"""What is typed looks right, becomes what runs, and is explained and mended where it is wrong."""

from support.waiting import until

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
  (state a (onexit [short = 0]))
  (state b)
  (on waits a -> b)
  (on idle b -> a))
(spawn m a)
"""
ROUGH = COUNTER.replace("\n  ", " ")


def test_what_is_typed_runs_and_what_is_wrong_is_explained_and_mended(open_lab):
    lab = open_lab(COUNTER.replace("[1000]", "[9999]"))
    lab.goes_on()
    counted = int(lab.value("m/n"))
    break_a_bracket(lab)
    name_a_state_that_is_not_there(lab)
    create_what_is_missing(lab)
    rename_a_state(lab)
    hold_edits(lab)
    assert int(lab.value("m/n")) >= counted
    lab.type_after("(on begin rest -> work)", " (on [n > 0] work -> rest)")
    lab.sees('[data-lrp-transition$=":work->rest"][data-fired]')
    lab.is_active("m/rest")
    assert int(lab.value("m/n")) >= counted, "nothing has started again"
    take_away_what_fired_and_undo_it(lab)
    choose_what_the_text_shows(lab)


def test_a_text_looks_as_printed_and_shows_what_it_knows(open_lab):
    lab = open_lab(EMPTY)
    type_without_indentation(lab)
    format_the_text(lab.notebook.open(ROUGH, "rough"))
    see_values(lab.notebook.open(VALUES, "values"))
    ask_the_text_of_a_follower(lab.notebook.open(FOLLOWER, "follower --world line"))


def break_a_bracket(lab):
    """The program runs on, and the mark is gone when the bracket is there again."""
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


def take_away_what_fired_and_undo_it(lab):
    """What is drawn into the text is there again, though no bracket matched when its place was deleted."""
    lab.sees(".lrp-text-fired")
    before = lab.text
    for piece in ("(state rest", "(on begin rest -> work)", "(on [n > 0] work -> rest)"):
        lab.select(piece)
        lab.page.keyboard.press("Backspace")
    lab.misses(".lrp-text-fired")
    until(lambda: lab.page.keyboard.press("Control+z") or lab.text == before, "undone")
    for drawn in (".lrp-text-fired", ".lrp-line-active", ".lrp-inline-value"):
        lab.sees(drawn)


def next_finding(lab):
    """Go to the next finding by a key, which opens its card."""
    lab.find(".cm-content").focus()
    lab.page.keyboard.press("F8")


def name_a_state_that_is_not_there(lab):
    lab.replace("-> rest tfull", "-> rset tfull")
    lab.find('[data-lrp-issue="LRP303"] [data-lrp-action="explain"]').click()
    lab.sees(".lrp-why .lrp-why-sentence code")
    answer = lab.find(".lrp-why")
    assert answer.get_attribute("aria-label") == "Unknown destination"
    assert "(ontime 1000 a -> moving)" in answer.inner_text()
    assert answer.locator("a").count() == 0, "the documentation is published nowhere"
    lab.page.keyboard.press("Escape")
    lab.misses(".lrp-why")
    next_finding(lab)
    lab.sees(".cm-tooltip [data-lrp-action='explain']").click()
    lab.sees('.lrp-why[aria-label="Unknown destination"] .lrp-why-sentence code')
    lab.page.keyboard.press("Escape")
    lab.misses(".lrp-why")

    lab.sees('[data-lrp-transition="m:tfull"][data-broken]')
    next_finding(lab)
    one, other = lab.sees(".cm-diagnostic").evaluate(
        "card => [...card.querySelectorAll('.cm-diagnosticAction')].map(each => each.getBoundingClientRect())"
    )
    assert other["x"] > one["right"] or other["y"] > one["bottom"], "the two do not touch"
    lab.sees(".cm-diagnosticAction").click()  # the first one: another name
    lab.misses('[data-lrp-issue="LRP303"]')
    lab.misses('[data-lrp-transition="m:tfull"][data-broken]')
    assert "-> rest tfull" in lab.text

    lab.replace("-> rest tfull", "-> finished tfull")
    lab.sees('[data-lrp-issue="LRP303"]')
    next_finding(lab)
    lab.sees(".cm-diagnosticAction:has-text('Create the state finished')").click()
    lab.misses('[data-lrp-issue="LRP303"]')
    lab.sees('[data-lrp-state="m/finished"]')
    assert "  (state rest)\n  (state finished)\n" in lab.text


def create_what_is_missing(lab):
    """Create an event by keys, and type its condition at once; complete a name, and begin a line."""
    lab.type_after("finished tfull)", " (on begin rest -> count)")
    lab.sees('[data-lrp-issue="LRP301"]')
    lab.page.keyboard.press("ArrowLeft")
    lab.page.keyboard.press("Control+.")
    assert lab.sees('[role="menu"] [data-lrp-action="fix"]').inner_text() == "Create the event begin"
    lab.page.keyboard.press("Enter")
    lab.misses('[data-lrp-issue="LRP301"]')
    lab.page.keyboard.type("n < 0")
    assert "  (event full [n > limit])\n  (event begin [n < 0])\n" in lab.text
    lab.replace("(state finished)", "(state restless)")
    lab.replace("-> finished tfull", "-> res")
    lab.sees(".cm-tooltip-autocomplete [role=option]")
    lab.page.keyboard.type("t")
    lab.misses(".cm-tooltip-autocomplete")
    lab.page.keyboard.press("Enter")
    assert "-> rest\n" in lab.text
    lab.page.keyboard.type("tfull")
    lab.sees('.lrp-verdict[data-state="runs"]')


def rename_a_state(lab):
    lab.select("(state count")  # the cursor is at the end of the name
    lab.page.keyboard.press("F2")
    field = lab.sees(".lrp-rename input")
    field.fill("work")
    field.press("Enter")
    lab.is_active("m/work")
    assert "(on full work -> rest\n" in lab.text
    assert "(on begin rest -> work)" in lab.text


def hold_edits(lab):
    lab.do("hold")
    lab.sees('[data-lrp-action="hold"][aria-checked="true"]')
    revision = lab.revision
    lab.type_after("(state rest)", " (state third)")
    lab.reads(".lrp-difference [data-kind=added]", "third")
    assert lab.revision == revision
    assert lab.find('[data-lrp-state="m/third"]').count() == 0
    lab.do("apply")
    lab.sees('[data-lrp-state="m/third"]')
    lab.is_active("m/work")
    lab.select(" (state third)")
    lab.page.keyboard.press("Delete")
    lab.reads(".lrp-difference [data-kind=removed]", "third")
    lab.do("revert")
    lab.misses(".lrp-difference [data-kind=removed]:visible")
    assert "(state third)" in lab.text
    lab.do("hold")
    lab.sees('[data-lrp-action="hold"][aria-checked="false"]')


def choose_what_the_text_shows(lab):
    for action, shown in (("values", ".lrp-inline-value"), ("brackets", ".lrp-bracket-2")):
        lab.sees(shown)
        lab.do("menu")
        lab.choose(action)
        lab.misses(shown)
    again = lab.notebook.open(COUNTER, "again")
    again.sees(".tok-keyword")
    assert again.find(".lrp-inline-value, .lrp-bracket-2").count() == 0
    for action, shown in (("values", ".lrp-inline-value"), ("brackets", ".lrp-bracket-2")):
        again.do("menu")
        again.choose(action)
        again.sees(shown)


def type_without_indentation(lab):
    lab.find(".cm-content").focus()
    lab.page.keyboard.press("Control+End")
    for number, line in enumerate(PRINTED.split("\n")):
        if number:
            lab.page.keyboard.press("Enter")
        lab.page.keyboard.type(line.strip())
    assert lab.text == f"{EMPTY}\n{PRINTED}"
    lab.sees('.lrp-verdict[data-state="runs"]')
    lab.is_active("m/count")


def format_the_text(lab):
    lab.goes_on()
    lab.select("(state rest)")
    lab.page.keyboard.press("Shift+Alt+F")
    lab.until("editor => editor.querySelectorAll('.cm-line').length > 8", ".cm-editor")
    assert lab.text == COUNTER
    assert lab.page.evaluate("getSelection().toString()") == "(state rest)"
    assert lab.find(".lrp-notice:visible").count() == 0
    lab.page.keyboard.press("Control+z")
    lab.until("editor => editor.querySelectorAll('.cm-line').length < 6", ".cm-editor")
    assert lab.text == ROUGH
    colours = lab.find("[class^=lrp-bracket-]").evaluate_all(
        "all => all.map(span => getComputedStyle(span.firstElementChild ?? span).color)"
    )
    assert len(set(colours)) == 4


def see_values(lab):
    """They keep to the right of their lines, need none of their own, and fade where nothing tests them."""
    lab.until("lines => lines.querySelectorAll('.lrp-inline-value').length === 4", ".cm-content")
    boxes = lab.find(".cm-line:has(.lrp-inline-value)").evaluate_all(
        "lines => lines.map(line => { const value = line.querySelector('.lrp-inline-value');"
        " const [outer, inner] = [line, value].map(node => node.getBoundingClientRect());"
        " const shown = value.style.display; value.style.display = 'none';"
        " const { height } = line.getBoundingClientRect(); value.style.display = shown;"
        " return { taller: outer.height - height, right: outer.right - inner.right,"
        " left: inner.left - outer.left, below: inner.bottom - outer.bottom }; })"
    )
    assert [box["taller"] for box in boxes] == [0] * 4
    assert all(0 <= box["right"] < 1 and box["left"] > 0 and box["below"] < 3 for box in boxes)

    stale = "css=.cm-line:has-text('(event {}') [data-stale]"
    fresh = "css=.cm-line:has-text('(event {}') .lrp-values span:not([data-stale])"
    lab.sees(fresh.format("waits"))
    lab.replace("short := [1]", "short := [2]")
    lab.sees(stale.format("waits"))
    lab.sees(fresh.format("idle"))

    lab.select("short := [2])")  # its value is left out where less than a word of it could be read
    lab.page.keyboard.press("End")
    lab.page.keyboard.type(" ;")
    for _ in range(200):
        lab.page.keyboard.type("x")
        line, value, hidden = lab.find(".cm-line:has-text('short := [')").evaluate(
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


def ask_the_text_of_a_follower(lab):
    lab.goes_on()
    lab.is_active("follower/looking")
    lab.until("(element, text) => element.textContent !== text", ".lrp-world-time", "0.0 s")
    lab.replace("[200]", "[350]")
    lab.has_value("maxlook", "350")
    assert lab.value("lightlim") == "128"  # an initialiser changes only its variable
    lab.goes_on()
    assert lab.find(".lrp-notice:visible").count() == 0
    lab.select("ontime 1000")
    lab.find(".cm-line .tok-keyword").get_by_text("ontime").last.hover()
    card = lab.sees(".lrp-card")
    assert "(ontime milliseconds source -> destination)" in card.inner_text()
    lab.type_after("robot.light.data < lightlim - 10", " and robot.bump")
    lab.reads(".cm-tooltip-autocomplete [role=option]", "bumper")
    lab.page.keyboard.press("Escape")
