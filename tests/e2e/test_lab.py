from pathlib import Path

import lrp_jupyter

FOLLOWER = (Path(lrp_jupyter.__file__).parent / "programs" / "follower.lrp").read_text()


def test_a_lab_shows_a_robot_that_moves(open_lab):
    page = open_lab(FOLLOWER)
    first = int(page.get_attribute('[data-lrp="lab"]', "data-lrp-tick"))
    page.wait_for_function(
        "first => Number(document.querySelector('[data-lrp=lab]').dataset.lrpTick) > first + 5", arg=first
    )
