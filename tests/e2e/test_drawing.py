"""Programs are drawn in the state graph with the mouse, and are the ones that were written."""

import time
from itertools import pairwise

import pytest

from e2e.axe import finds_nothing_serious
from e2e.drawer import Drawer
from e2e.programs import FOLLOWER
from lrp_jupyter import parse, programs

EMPTY = "; drawn\n"
PLAIN = """\
(machine m
  (var n := [0])
  (state a (running [n = n + 1]))   ; counts
  (state b)
  (state c)
  (on [n < 0] a -> b))
(spawn m a)
"""


def kept(lab):
    """The program's text as it is kept beside the notebook."""
    return (lab.notebook.path.parent / ".lrp" / "m.lrp").read_text()


def becomes(lab, text):
    """Wait until the kept text is a program equal to another one."""
    end = time.monotonic() + 20
    while parse(kept(lab)) != parse(text) and time.monotonic() < end:
        lab.page.wait_for_timeout(100)
    assert parse(kept(lab)) == parse(text), kept(lab)


@pytest.fixture
def drawer(open_lab):
    return Drawer(open_lab(EMPTY))


def test_the_stopwatch_is_drawn_from_nothing(drawer):
    free = 0.04, 0.1
    drawer.choose_free(*free, "draw-var", "button", '""')
    drawer.choose_free(*free, "draw-var", "tenths", "0")
    drawer.choose_free(*free, "draw-var", "shown", '"0.0"')
    drawer.choose_free(*free, "draw-form", 'onpause [print("paused at", shown)]')
    drawer.choose_free(*free, "draw-form", 'onresume [print("running on")]')

    drawer.machine(*free, "finger")
    script = '[(1000, "start"), (5000, "lap"), (2000, "lap"), (4300, "stop"), (3000, "reset")]'
    drawer.state("waiting", 0.25, 0.4)
    drawer.state("pressing", 0.7, 0.4)
    drawer.choose_free(*free, "draw-var", "script", script)
    drawer.choose("finger/pressing", "draw-onentry", "button = script[0][1]")
    drawer.choose("finger/pressing", "draw-onexit", '[button = ""] [script = script[1:] + script[:1]]')
    drawer.transition("finger/waiting", "finger/pressing", "ontime [script[0][0]]")
    drawer.transition("finger/pressing", "finger/waiting", "")

    drawer.machine(*free, "watch")
    drawer.state("zero", 0.2, 0.35)
    drawer.state("running", 0.7, 0.35)
    drawer.state("stopped", 0.5, 0.75)
    for name, button in {"start": "start", "lap": "lap", "stop": "stop", "clear": "reset"}.items():
        drawer.choose_free(*free, "draw-event", name, f'button == "{button}"')
    drawer.choose("watch/zero", "draw-onentry", '[tenths = 0] [shown = "0.0"]')
    drawer.choose(
        "watch/stopped", "draw-onentry", '[shown = f"{tenths / 10:.1f}"] [print("stopped at", shown)]'
    )
    drawer.transition("watch/zero", "watch/running", "start")
    drawer.edit("watch:on:zero->running", "on start {zero stopped} -> running")
    drawer.transition("watch/running", "watch/stopped", "stop")
    drawer.transition("watch/stopped", "watch/zero", "clear", check=True)

    drawer.machine_inside("watch/running", "counter")
    drawer.state("counting", 0.5, 0.5)
    drawer.choose("watch/running/counter/counting", "draw-running", "tenths += 1")
    drawer.show("watch")
    drawer.machine_inside("watch/running", "display")
    drawer.state("live", 0.25, 0.5)
    drawer.state("frozen", 0.7, 0.5)
    inner = "watch/running/display"
    drawer.choose(f"{inner}/live", "draw-running", 'shown = f"{tenths / 10:.1f}"')
    drawer.choose(f"{inner}/frozen", "draw-onentry", '[shown = f"{tenths / 10:.1f}"] [print("lap", shown)]')
    drawer.transition(f"{inner}/live", f"{inner}/frozen", "lap")
    drawer.edit(f"{inner}:on:live->frozen", "on lap {live frozen} -> frozen")
    drawer.transition(f"{inner}/frozen", f"{inner}/live", "3 s")

    becomes(drawer.lab, programs.load("stopwatch"))
    assert kept(drawer.lab).startswith(EMPTY)


def test_the_nested_machine_of_the_follower_is_drawn_from_nothing(drawer):
    names = "lookleft", "returnleft", "lookright", "returnright"
    drawer.state("looking", 0.3, 0.3)
    drawer.choose_free(0.04, 0.1, "draw-rename", "follower")
    drawer.lab.state("follower/looking")
    drawer.choose_free(0.04, 0.1, "draw-var", "search", "1.0", check=True)
    drawer.choose_free(0.04, 0.1, "draw-var", "maxlook", "200", check=True)
    drawer.choose("follower/looking", "draw-onentry", "robot.stop()")
    drawer.state("lookleft", 0.75, 0.7)
    drawer.drag(drawer.middle("follower/lookleft"), drawer.middle("follower/looking"))
    drawer.show("follower/looking/in_looking")
    drawer.choose_free(0.04, 0.1, "draw-rename", "lookalgo")
    inner = "follower/looking/lookalgo"
    drawer.lab.state(f"{inner}/lookleft")
    drawer.choose_free(0.04, 0.1, "draw-var", "time", "maxlook")
    for source, target in pairwise(names):
        box = drawer.box(f"{inner}/{source}")
        x, y = {"returnleft": (0.8, 0.2), "lookright": (0.8, 0.85), "returnright": (0.2, 0.85)}[target]
        drawer.drag((box["x"] + 2, box["y"] + box["height"] / 2), drawer.at(x, y))
        drawer.fill(target, "ontime time")
    drawer.transition(f"{inner}/returnright", f"{inner}/lookleft", "time")
    for name, action in {
        "lookleft": "search",
        "returnleft": "-search",
        "lookright": "-search",
        "returnright": "search",
    }.items():
        drawer.choose(f"{inner}/{name}", "draw-running", f"robot.move(angular={action})")
    drawer.choose(f"{inner}/returnright", "draw-onexit", "time = time * 2")

    written = next(state for state in parse(FOLLOWER).machines[0].states if state.name == "looking")
    state = FOLLOWER[slice(*written.span)]
    variables = "(var search := [1.0]) (var maxlook := [200])"
    becomes(drawer.lab, f"{variables} (machine follower {state}) (spawn follower looking)")


def test_a_state_renamed_in_place_stays_active_also_when_that_is_undone_and_redone(open_lab):
    lab = open_lab(PLAIN)
    drawer = Drawer(lab)
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


def test_the_end_of_a_selected_transition_is_dragged_to_another_state(open_lab):
    lab = open_lab(PLAIN)
    drawer = Drawer(lab)
    lab.sees('.lrp-layer-labels [data-of="m:on:a->b"]').click()
    handle = lab.box('.lrp-handle[data-end="destination"]')
    drawer.drag((handle["x"] + 6, handle["y"] + 6), drawer.middle("m/c"))
    lab.sees('[data-of="m:on:a->c"]')
    assert "(on [n < 0] a -> c))" in lab.text
    assert "; counts" in lab.text


def test_everything_is_drawn_by_keyboard_too(open_lab):
    lab = open_lab(PLAIN)
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
    lab.sees(".lrp-field input")
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


def test_what_cannot_be_drawn_is_refused_in_a_sentence_and_leaves_no_trace(open_lab):
    lab = open_lab(PLAIN)
    drawer = Drawer(lab)
    drawer.drag(drawer.middle("m/b"), drawer.middle("m/a"))
    lab.reads(".lrp-toast", "into itself")
    drawer.mouse.dblclick(*drawer.middle("m/c"))
    lab.sees(".lrp-field input").fill("b")
    lab.find(".lrp-field-apply").click()
    lab.reads(".lrp-field .lrp-error", "is taken")
    lab.page.keyboard.press("Escape")
    lab.misses(".lrp-field")
    assert lab.text.strip() == PLAIN.strip()
