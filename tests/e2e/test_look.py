"""What a lab looks like: in the dark, to a screen reader, and on paper."""

import base64
import json
import os
import re
import subprocess
import sys
from xml.etree import ElementTree

import pytest

from e2e import axe
from e2e.axe import choose_theme
from e2e.programs import COUNTER, FOLLOWER


def test_the_lab_is_dark_where_jupyterlab_is(open_lab):
    lab = open_lab(COUNTER)
    choose_theme(lab, "light")
    choose_theme(lab, "dark")
    for part in ("editor", "graph", "variables"):
        red, green, blue = ink(lab, part)
        assert min(red, green, blue) > 128, part
    choose_theme(lab, "light")
    assert max(ink(lab, "editor")) < 128


def ink(lab, part):
    """Red, green and blue of a part's text."""
    color = lab.sees(f'[data-lrp="{part}"]').evaluate("part => getComputedStyle(part).color")
    return [float(number) for number in color[color.index("(") + 1 : -1].split(",")[:3]]


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_axe_finds_nothing_serious(open_lab, theme):
    lab = open_lab(FOLLOWER, "follower --world line")
    choose_theme(lab, theme)
    lab.type_after("(state end", "ing")  # a program with findings shows more
    lab.sees("[data-lrp-issue]")
    lab.pause()
    axe.finds_nothing_serious(lab)


def test_a_double_click_on_the_head_of_a_panel_selects_no_text(open_lab):
    lab = open_lab(COUNTER)
    lab.find('[data-lrp="graph"] .lrp-title').dblclick()
    lab.sees('[data-lrp="graph"][data-maximised]')
    assert lab.page.evaluate("getSelection().toString()") == ""


def test_a_long_menu_is_in_sight_in_a_low_window(open_lab):
    lab = open_lab(COUNTER)
    lab.page.set_viewport_size({"width": 1280, "height": 500})
    lab.until("lab => document.querySelector('.jp-WindowedPanel-outer').clientHeight < 400")
    lab.find('[data-lrp-action="menu"]').focus()  # no click: it would have to be scrolled to
    lab.root.evaluate("lab => lab.scrollIntoView({ block: 'start' })")
    inside = (
        "menu => { const around = document.querySelector('.jp-WindowedPanel-outer').getBoundingClientRect();"
        " const seen = menu.closest('[popover]') ? { top: 0, bottom: innerHeight } : around;"
        " const { top, bottom, height } = menu.getBoundingClientRect();"
        " return top >= seen.top && bottom <= seen.bottom && height > 300; }"
    )
    lab.page.keyboard.press("Enter")
    lab.until(inside, '[role="menu"]')
    lab.page.keyboard.press("Escape")
    lab.page.keyboard.press("Shift+F9")
    lab.page.keyboard.press("Enter")
    lab.until(inside, '[role="menu"]')


def test_the_counter_of_restarts_does_not_stick_out_below_the_notice_of_one(open_lab):
    lab = open_lab(COUNTER)
    lab.replace("n = n + 1", "n = n + 2")
    lab.sees(".lrp-notice:not([hidden])")
    assert lab.find(".lrp-restarts:visible").count() == 0
    lab.sees(".lrp-notice[hidden]")  # it fades
    lab.sees(".lrp-restarts:visible")


def test_the_entries_of_a_form_in_the_graph_begin_below_each_other(open_lab):
    lab = open_lab(COUNTER)
    lab.state("m/rest").click()
    lab.state("m/rest").press("t")
    lab.sees(".lrp-field")
    inputs = lab.find(".lrp-field input[type=text]")
    assert inputs.count() == 2
    assert len({inputs.nth(index).bounding_box()["x"] for index in range(2)}) == 1


def test_a_saved_notebook_shows_graph_and_text_where_no_kernel_runs(open_lab, tmp_path):
    lab = open_lab(FOLLOWER, "follower --world line")
    lab.goes_on()
    lab.notebook.save()
    bundle = json.loads(lab.notebook.path.read_text())["cells"][1]["outputs"][0]["data"]
    assert "".join(bundle["text/plain"]) == FOLLOWER
    command = [sys.executable, "-W", "ignore", "-m", "nbconvert", "--to", "html", lab.notebook.path.name]
    still = "--ClearMetadataPreprocessor.enabled=True"  # without the widget that shows the same picture
    env = {**os.environ, "JUPYTER_CONFIG_DIR": str(tmp_path), "IPYTHONDIR": str(tmp_path)}
    place = ["--output-dir", tmp_path]
    subprocess.run([*command, still, *place], cwd=lab.notebook.path.parent, env=env, check=True)
    html = (tmp_path / "notebook.html").read_text()
    (picture,) = re.findall(r'src="data:image/svg\+xml;base64,([^"]+)"', html)
    shown = "".join(ElementTree.fromstring(base64.b64decode(picture)).itertext())
    for word in ("follower", "moving", "looking", "tlooking"):
        assert word in shown
