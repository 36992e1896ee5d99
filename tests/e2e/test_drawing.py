"""Programs are drawn in the state graph with the mouse and by keys, and are the ones that were written."""

from support.waiting import until

from e2e.axe import finds_nothing_serious
from e2e.drawer import Drawer, middle
from lrp_jupyter import parse

DRAWN = """\
(var button := [""])
(var tenths := [0])
(onpause [print("paused at", tenths)])
(machine finger
  (var script := [[(1000, "start"), (5000, "reset")]])
  (state waiting)
  (state pressing
    (onentry [button = script[0][1]])
    (onexit [button = ""] [script = script[1:] + script[:1]]))
  (ontime [script[0][0]] waiting -> pressing)
  (eps pressing -> waiting))
(machine watch
  (event start [button == "start"])
  (event clear [button == "reset"])
  (state zero (onentry [tenths = 0]))
  (state running
    (onentry (spawn counter counting))
    (machine counter
      (state counting (running [tenths += 1]))
      (state frozen)
      (ontime 3000 frozen -> counting)))
  (on start {zero running} -> running)
  (on clear *-> zero))
(spawn finger waiting)
(spawn watch zero)
"""
PLAIN = """\
(machine m
  (var n := [0])
  (state a (running [n = n + 1]))   ; counts
  (state b)
  (state c)
  (on [n < 0] a -> b))
(spawn m a)
"""
MOVED = """\
(machine m
  (var n := [0])
  (state counting (running [n = n + 1]))
  (state b (onentry (spawn inner e)) (machine inner (var left := [n]) (state e)))
  (state c)
  (on [n < 0] counting -> c)
  (ontime 5000 c -> b))
(spawn m counting)
(var all := [0])
"""
COURIER = """\
(machine move
  (var tries := [3])
  (state send)
  (state reached)
  (ontime 900000 send -> reached))
(machine m
  (var n := [0])
  (event near [n >= 0])
  (state carrying (onentry (spawn move send)) (running [n = n + 1]))
  (state look)
  (state climb)
  (on near for 800000 carrying -> climb))
(spawn m carrying)
"""
DELIVERED = COURIER.replace("(spawn move send)", "(spawn move send (var tries := [5]))").replace(
    "  (on near for 800000 carrying -> climb))",
    """\
  (on move.reached for 90000 carrying -> climb (effect [n = 0]))
  (on move.reached carrying -> look))""",
)


def becomes(lab, text, name):
    """Wait until the text that is kept beside the notebook is a program equal to another one."""
    kept = lab.notebook.path.parent / ".lrp" / f"{name}.lrp"
    until(lambda: parse(kept.read_text()) == parse(text), kept.read_text)


def test_a_program_is_drawn_from_nothing(open_lab):
    drawer = Drawer(open_lab("; drawn\n"))
    free = 0.04, 0.1
    drawer.choose_free(*free, "draw-var", "button", '""')
    drawer.choose_free(*free, "draw-var", "tenths", "0")
    drawer.choose_free(*free, "draw-form", 'onpause [print("paused at", tenths)]')

    drawer.machine(*free, "finger")
    drawer.state("waiting", 0.25, 0.4)
    drawer.state("pressing", 0.7, 0.4)
    drawer.choose_free(*free, "draw-var", "script", '[(1000, "start"), (5000, "reset")]')
    drawer.choose("finger/pressing", "draw-onentry", "button = script[0][1]")
    drawer.choose("finger/pressing", "draw-onexit", '[button = ""] [script = script[1:] + script[:1]]')
    drawer.transition("finger/waiting", "finger/pressing", "ontime [script[0][0]]")
    drawer.transition("finger/pressing", "finger/waiting", "")

    drawer.machine(*free, "watch")
    drawer.state("zero", 0.2, 0.35)
    drawer.state("running", 0.7, 0.35)
    for name, button in {"start": "start", "clear": "reset"}.items():
        drawer.choose_free(*free, "draw-event", name, f'button == "{button}"')
    drawer.choose("watch/zero", "draw-onentry", "tenths = 0")
    drawer.transition("watch/zero", "watch/running", "start")
    drawer.edit("watch:on:zero->running", "on start {zero running} -> running")
    drawer.transition("watch/running", "watch/zero", "clear", check=True)

    drawer.machine_inside("watch/running", "counter")
    drawer.state("counting", 0.25, 0.5)
    drawer.state("frozen", 0.7, 0.5)
    drawer.choose("watch/running/counter/counting", "draw-running", "tenths += 1")
    drawer.transition("watch/running/counter/frozen", "watch/running/counter/counting", "3 s")
    becomes(drawer.lab, DRAWN, "m")
    assert drawer.lab.text.startswith("; drawn\n")


def test_a_program_that_runs_is_drawn_on_by_mouse_and_keys(open_lab):
    lab = open_lab(PLAIN)
    drawer = Drawer(lab)
    draw_by_keys(lab)
    be_refused(lab, drawer)
    rename_in_place(lab, drawer)
    move_what_is_there(lab, drawer)
    becomes(lab, MOVED, "m")
    assert "; counts" in lab.text


def draw_by_keys(lab):
    keyboard = lab.page.keyboard
    lab.sees('[data-lrp-state="m/c"]').focus()
    keyboard.press("n")
    lab.sees(".lrp-field input")
    finds_nothing_serious(lab)
    keyboard.type("d")
    keyboard.press("Enter")
    lab.sees('[data-lrp-state="m/d"]')
    lab.misses(".lrp-field")
    lab.sees('[data-lrp-state="m/c"]').focus()
    keyboard.press("t")
    inputs = lab.sees(".lrp-field").locator("input[type=text]")
    assert inputs.nth(0).bounding_box()["x"] == inputs.nth(1).bounding_box()["x"]
    keyboard.type("d")
    keyboard.press("Tab")
    keyboard.type("90 s")
    keyboard.press("Enter")
    arrow = lab.sees('.lrp-transition[data-of="m:ontime:c->d"]')
    lab.misses(".lrp-field")
    arrow.focus()
    keyboard.press("m")
    lab.choose("draw-reverse")
    lab.sees('.lrp-transition[data-of="m:ontime:d->c"]').focus()
    keyboard.press("Delete")
    lab.misses('.lrp-transition[data-of="m:ontime:d->c"]')
    lab.sees('[data-lrp-state="m/d"]').focus()
    keyboard.press("Delete")
    lab.misses('[data-lrp-state="m/d"]')
    assert lab.text.strip() == PLAIN.strip()
    lab.is_active("m/a")
    assert lab.root.evaluate("root => root.contains(document.activeElement)")  # or keys would edit cells


def be_refused(lab, drawer):
    """What cannot be drawn is refused in a sentence, and leaves no trace."""
    drawer.drag(drawer.middle("m/b"), drawer.middle("m/a"))
    lab.reads(".lrp-toast", "into itself")
    drawer.mouse.dblclick(*drawer.middle("m/c"))
    lab.sees(".lrp-field input").fill("b")
    lab.find(".lrp-field-apply").click()
    lab.reads(".lrp-field .lrp-error", "is taken")
    lab.page.keyboard.press("Escape")
    lab.misses(".lrp-field")
    assert lab.text.strip() == PLAIN.strip()


def rename_in_place(lab, drawer):
    """The state stays active, also when the rename is undone and redone."""
    lab.goes_on()
    counted = int(lab.value("m/n"))
    drawer.mouse.dblclick(*drawer.middle("m/a"))
    drawer.fill("counting")
    lab.is_active("m/counting")
    assert lab.root.evaluate("root => root.contains(document.activeElement)")
    assert "(on [n < 0] counting -> b)" in lab.text
    for key, name in {"Control+z": "a", "Control+y": "counting"}.items():
        lab.find(".cm-content").focus()
        lab.page.keyboard.press(key)
        lab.is_active(f"m/{name}")
        assert f"(state {name} (running" in lab.text
    assert int(lab.value("m/n")) >= counted
    assert lab.find(".lrp-notice:visible").count() == 0


def move_what_is_there(lab, drawer):
    """Drag the end of a transition to another state, an arrow to free space, a state into another one."""
    lab.sees('.lrp-layer-labels [data-of="m:on:counting->b"]').click()
    end = drawer.middle("m/c")
    drawer.drag(middle(lab.at_rest('.lrp-handle[data-end="destination"]')), end)
    lab.sees('[data-of="m:on:counting->c"]')
    drawer.transition("m/c", "m/b", "5 s")
    box = drawer.box("m/c")
    drawer.drag((box["x"] + 2, box["y"] + box["height"] / 2), drawer.at(0.9, 0.9))
    drawer.fill("e", "eps")
    lab.sees('.lrp-transition[data-of="m:eps:c->e"]').focus()
    lab.page.keyboard.press("Delete")
    lab.misses('.lrp-transition[data-of="m:eps:c->e"]')
    drawer.drag(drawer.middle("m/e"), drawer.middle("m/b"))
    drawer.show("m/b/in_b")
    drawer.choose_in("m/b/in_b", "draw-rename", "inner")
    lab.state("m/b/inner/e")
    drawer.choose_in("m/b/inner", "draw-var", "left", "n")
    drawer.choose_in("m/b/inner", "draw-var", "all", "0", check=True)


def test_what_a_machine_reports_is_drawn_between_machines_while_it_runs(open_lab):
    """Its state is led out by its border and dropped on an arrow; nothing of that restarts."""
    lab = open_lab(COURIER)
    drawer = Drawer(lab)
    lab.press('[data-lrp="graph"] [data-lrp-action="enlarge"]')
    lab.goes_on()
    lab.sees(".lrp-count[data-fills]")
    lead_out(lab, drawer)
    for action, value in {"hold": "90 s", "effect": "n = 0"}.items():
        choose_of(lab, "m:on:carrying->climb", f"draw-{action}")
        drawer.fill(value)
    drawer.choose("m/carrying", "draw-settings", "5")
    drop_on_arrow(lab, drawer)
    becomes(lab, DELIVERED, "m")
    lab.is_active("m/carrying")
    assert lab.find(".lrp-notice:visible").count() == 0
    lab.pause()
    lab.sees(".lrp-count:not([data-fills])")


def lead_out(lab, drawer):
    box = drawer.box("move/reached")
    drawer.drag((box["x"] + box["width"] * 0.3, box["y"] + 1), drawer.middle("m/look"))
    assert lab.sees(".lrp-field input").input_value() == "move.reached"
    drawer.fill()
    lab.sees('.lrp-transition[data-of="m:on:carrying->look"]')


def drop_on_arrow(lab, drawer):
    """The arrow is marked while the state is over it, which goes home."""
    home = drawer.box("move/reached")
    arrow = middle(lab.at_rest('.lrp-layer-labels [data-of="m:on:carrying->climb"]'))
    revision = lab.revision
    mouse, start = drawer.mouse, middle(home)
    mouse.move(*start)
    mouse.down()
    mouse.move(start[0] + 6, start[1] + 6)
    mouse.move(*arrow, steps=6)
    lab.sees('.lrp-transition[data-drop="trigger"][data-of="m:on:carrying->climb"]')
    mouse.up()
    lab.until("(root, before) => Number(root.dataset.lrpRevision) > before", argument=revision)
    assert drawer.box("move/reached")["x"] == home["x"]


def choose_of(lab, transition, action):
    label = lab.at_rest(f'.lrp-layer-labels [data-of="{transition}"]')
    lab.page.mouse.click(*middle(label), button="right")
    lab.choose(action)
