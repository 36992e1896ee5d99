"""A machine that runs in two places: each is listed, selected, watched, changed and explained on its own."""

from e2e import axe
from e2e.programs import TWICE

TREE = '[data-lrp="tree"]'


def in_state(lab, instance, state):
    lab.sees(f"{TREE} [data-lrp-instance='{instance}'] .lrp-tree-state:has-text('{state}')")


def select(lab, instance):
    lab.find(f"{TREE} [data-lrp-instance='{instance}']").click()
    lab.sees(f"{TREE} [data-lrp-instance='{instance}'][aria-selected='true']")
    lab.sees("[data-lrp-state='follow/found']")


def lists(lab, *variables):
    """Wait until the list of variables has these."""
    lab.until(
        "(list, names) => [...list.querySelectorAll('[data-lrp-variable]')]"
        ".map((each) => each.dataset.lrpVariable).join() === names.join()",
        ".lrp-variables",
        list(variables),
    )


def test_two_instances_of_a_machine_are_watched_changed_and_explained_each_on_its_own(open_lab):
    lab = open_lab(TWICE)
    in_state(lab, "m/left/follow", "search")
    in_state(lab, "k/one/follow", "found")
    lab.sees(f"{TREE} [data-lrp-instance='m/left/follow'] .lrp-tree-settings:has-text('side 90000')")
    see_the_variables_of_one(lab)
    pause_in_one(lab)
    ask_why_in_one(lab)
    read_the_values_of_both(lab)
    force_one(lab)
    look_back_at_both(lab)
    axe.finds_nothing_serious(lab)


def see_the_variables_of_one(lab):
    lab.find(f"{TREE} [data-lrp-machine='follow']").first.click()
    lists(lab, "m/left/follow/side", "k/one/follow/side", "n")
    select(lab, "k/one/follow")
    lists(lab, "k/one/follow/side", "n")
    lab.has_value("k/one/follow/side", "1")
    select(lab, "m/left/follow")
    lists(lab, "m/left/follow/side", "n")


def pause_in_one(lab):
    lab.state("follow/found").click(button="right")
    assert lab.find('[role="menuitem"]').first.inner_text() == "Transition here in m/left"
    lab.choose("pause-entered-here")
    lab.pause()
    lab.do("reset")
    lab.has_value("n", "—")  # nothing runs
    lab.do("run")
    in_state(lab, "k/one/follow", "found")  # which does not pause
    lab.sees('.lrp-status .lrp-dot[data-status="running"]')
    lab.find("[data-lrp-variable='m/left/follow/side'] .lrp-value").click()
    lab.page.keyboard.type("0")
    lab.page.keyboard.press("Enter")
    lab.misses(".lrp-variables input")
    lab.sees(".lrp-paused-by:has-text('m/left/follow/found was entered (breakpoint 1, 1st time).')")


def ask_why_in_one(lab):
    lab.find("[data-lrp-state='follow/found']").first.focus()
    lab.page.keyboard.press("?")
    lab.sees(".lrp-why[aria-label='Why found in m/left?'] .lrp-why-sentence:has-text('side was 0')")
    lab.page.keyboard.press("Escape")
    select(lab, "k/one/follow")
    lab.select("lost")
    lab.page.keyboard.press("Alt+F8")
    lab.sees(".lrp-why[aria-label='Why not lost in k/one?'] .lrp-why-sentence:has-text('side was 1')")
    lab.page.keyboard.press("Escape")


def read_the_values_of_both(lab):
    names = lab.find(".cm-line").get_by_text("side", exact=True)
    for name in (names.first, names.nth(1)):  # where it is defined, and in a block
        name.hover()
        card = lab.sees(".cm-tooltip .lrp-card-value")
        assert card.inner_text() == "m/left: 0\nk/one: 1"
        lab.find(".cm-line").last.hover()
        lab.misses(".cm-tooltip")


def force_one(lab):
    lab.state("follow/search").click(button="right")
    lab.choose("teleport")
    in_state(lab, "k/one/follow", "search")
    in_state(lab, "m/left/follow", "found")


def look_back_at_both(lab):
    names = ".lrp-timeline-name"
    lab.sees(f"{names}:text-is('follow m')")
    lab.sees(f"{names}:text-is('follow k')")
    lab.find(".lrp-playhead").focus()
    lab.page.keyboard.press("Home")
    lab.sees("css=:scope[data-looking]")
    in_state(lab, "m/left/follow", "search")
    lab.find(".lrp-playhead").focus()
    lab.page.keyboard.press("Enter")
    lab.sees('[role="menuitem"]:has-text("Why search in m/left?")')
    lab.page.keyboard.press("Escape")
