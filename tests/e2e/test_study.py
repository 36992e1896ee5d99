"""A study: one cell sets it up, the page obeys it, also after it was loaded again, and cannot change it."""

import json

from e2e.programs import FOLLOWER

MARKS = (".lrp-line-active", ".lrp-text-fired", ".lrp-inline-value", "[data-lrp-machine][data-active]")
RUN = ", ".join((*MARKS, ".lrp-graph [data-active]"))
WITHHELD = ("timeline", "variables")
NEW = "(state moving2)"


def test_a_cell_sets_up_a_study_that_a_reload_keeps_and_its_participant_cannot_change(open_lab):
    lab = open_lab(FOLLOWER, "study --world line --edits hold --graph static --quiet --lock --log p.lrplog")
    notebook = lab.notebook
    shows_nothing_of_the_run(lab)
    cannot_be_changed(lab)
    hold_an_edit(lab)
    notebook.write_cell(1, f"%%lrp study\n{FOLLOWER}")  # as a participant may: it unlocks nothing
    notebook.save()
    lab.page.reload()
    notebook.ready()
    notebook.begin_cell(1)
    lab.ready()
    shows_nothing_of_the_run(lab)
    cannot_be_changed(lab)
    apply_and_redraw(lab)
    hide_the_graph(lab)
    end_the_study(lab)
    tell_what_was_looked_at(notebook)


def shows_nothing_of_the_run(lab):
    lab.goes_on()
    lab.sees('[data-lrp="tree"]')
    lab.sees('[data-lrp-state="follower/moving"]')
    assert lab.find(RUN).count() == 0
    for part in WITHHELD:
        assert not lab.find(f'[data-lrp="{part}"]').is_visible()
    assert lab.find(".lrp-canvas").is_visible()


def cannot_be_changed(lab):
    for action in ("hold", "graph-mode"):
        control = lab.find(f'[data-lrp-action="{action}"]')
        assert control.is_disabled()
        assert "set for a study" in control.get_attribute("title")
    assert lab.find('[data-lrp-action="hold"]').get_attribute("aria-checked") == "true"
    lab.do("menu")
    lab.sees('[data-lrp-action="panel-graph"]')
    assert lab.find('[data-lrp-action="panel-variables"]').count() == 0
    lab.page.keyboard.press("Escape")
    lab.misses('[role="menu"]')
    assert lab.find(".lrp-recorded").is_visible()


def hold_an_edit(lab):
    revision = lab.revision
    lab.type_after("(on ending *-> end tend)", f"\n  {NEW}")
    lab.sees('[data-lrp-action="apply"]')
    lab.goes_on()
    assert lab.revision == revision


def apply_and_redraw(lab):
    revision = lab.revision
    lab.do("apply")
    lab.until("(root, before) => Number(root.dataset.lrpRevision) > before", argument=revision)
    lab.goes_on()
    # a page that was loaded again has drawn the program that ran, and the participant asks for the new one
    assert lab.find('[data-lrp-state="follower/moving2"]').count() == 0
    lab.do("redraw")
    lab.sees('[data-lrp-state="follower/moving2"]')
    assert lab.find(RUN).count() == 0


def hide_the_graph(lab):
    lab.notebook.kernel("import lrp_jupyter as l; l.Lab('study', graph='hidden', lock=True)")
    lab.until("graph => !graph.checkVisibility()", '[data-lrp="graph"]')
    lab.until("tree => !tree.checkVisibility()", '[data-lrp="tree"]')
    lab.do("menu")
    lab.sees('[data-lrp-action="panel-world"]')
    assert lab.find('[data-lrp-action="panel-graph"]').count() == 0
    lab.page.keyboard.press("Escape")
    lab.misses('[role="menu"]')


def end_the_study(lab):
    lab.notebook.kernel("l.Lab('study').set_conditions()")
    lab.sees(".lrp-graph [data-active]")
    lab.sees(".lrp-line-active")
    lab.until("part => part.checkVisibility()", '[data-lrp="timeline"]')
    assert not lab.find('[data-lrp-action="hold"]').is_disabled()
    lab.do("hold")
    lab.sees('[data-lrp-action="hold"][aria-checked="true"]')
    lab.sees('[data-lrp-state="follower/moving"]').focus()
    lab.page.keyboard.press("?")
    lab.sees(".lrp-why-sentence code")
    lab.do("close-why")


def tell_what_was_looked_at(notebook):
    notebook.kernel("l.Lab('study').close()")
    read = "import json; from lrp_jupyter.live.recording import read_recording as r"
    looks = json.loads(
        notebook.kernel(f"{read}; print(json.dumps([[e.what, e.about] for e in r('p.lrplog').looks]))")
    )
    kinds = [(what, about) for what, about in looks if what != "hover"]
    for each in (
        ("command", "apply"),
        ("input", "edit"),
        ("redraw", "follower"),
        ("command", "hold"),
        ("why", "state follower/moving"),
    ):
        assert each in kinds
