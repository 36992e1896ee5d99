"""The members of `robot` that an editor offers where no lab runs: those of the simulated robot.

``UPDATE=1`` writes them for the extension of JupyterLab.
"""

import json
import os
from pathlib import Path

from lrp_jupyter import Session, VirtualClock
from lrp_jupyter.widgets.views.view_state import listed_members, member_view

FILE = Path(__file__).parents[2] / "js/src/jupyter/members.json"


def test_an_editor_without_a_lab_knows_the_members_of_the_simulated_robot() -> None:
    with Session("", "sim", VirtualClock()) as session:
        session.start()
        members = [member_view(member) for member in listed_members(session.bridge)]
    text = json.dumps(members, indent=2, ensure_ascii=False) + "\n"
    if os.environ.get("UPDATE"):
        FILE.write_text(text, "utf-8")
    assert FILE.read_text("utf-8") == text
