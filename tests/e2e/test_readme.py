"""The first behaviour of the README, typed into a lab by keys."""

import re
from pathlib import Path

README = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")


def test_the_first_behaviour_is_typed_while_the_robot_drives(open_lab):
    head, program = re.search(r"```lrp\n%%lrp (.*)\n((?:.*\n)*?)```", README).groups()
    rows = re.findall(r"^\| `(.*)` \| [A-Z].* \|$", README, re.MULTILINE)[:5]
    event, state, arrow, delay, number = rows
    lab = open_lab(program, head)
    lab.select("driving (running")
    lab.page.keyboard.press("ArrowRight")
    lab.page.keyboard.press("ArrowDown")  # into the empty line

    def typed(line):
        lab.page.keyboard.type(line)
        lab.page.keyboard.press("Enter")

    typed(event)
    lab.sees('[data-lrp-issue="LRP403"]')
    typed(state)
    lab.sees('[data-lrp-issue="LRP401"]')
    lab.state("rover/turning")
    typed(arrow)
    lab.misses("[data-lrp-issue]")
    lab.is_active("rover/turning")  # at the wall
    typed(delay)
    lab.is_active("rover/driving")
    new, old = number.split("` instead of `")
    lab.replace(old, new)
    lab.has_value("pace", new)
    lab.find('[data-lrp-transition="rover:bump:driving->turning"]').first.focus()
    lab.page.keyboard.press("?")
    lab.reads(".lrp-why-sentence", "did not fire")
    lab.misses(".lrp-note:visible")
