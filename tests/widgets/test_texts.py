"""Texts: answers to views, the running text, held texts, saved files."""

import pytest

A = "(machine m (state a)) (spawn m a)"
B = "(machine m (state a) (state b)) (spawn m a)"
C = "(machine m (state a) (state c) (eps a -> c)) (spawn m a)"
BROKEN = "(machine m (state a) (spawn m a)"


def test_a_text_is_answered_with_its_number_and_runs(bench):
    lab = bench(A)
    page = lab.page()
    page.seq = 6
    answer = page.type(B)
    assert answer["seq"] == 7
    assert page.text == B
    assert (answer["accepted"], answer["applied"], answer["reason"]) == (True, True, "")
    assert [state["path"] for state in page.latest("program")["machines"][0]["states"]] == ["m/a", "m/b"]
    assert page.last("frame")["layouts"].keys() == {"m"}
    assert lab.session.program.text == B


def test_other_views_get_the_changes_and_number_nought(bench):
    lab = bench(A)
    writer, reader = lab.page("writer"), lab.page("reader")
    answer = writer.type(B)
    heard = reader.last("answer")
    assert (heard["seq"], heard["revision"]) == (0, answer["revision"])
    assert (
        heard["updates"] == answer["updates"] == [{"view": "writer", "changes": [20, [0, " (state b)"], 13]}]
    )
    assert reader.text == B


def test_a_text_that_is_not_a_program_is_answered_with_its_errors_and_changes_nothing(bench):
    lab = bench(A)
    page = lab.page()
    answer = page.type(BROKEN)
    assert not answer["accepted"]
    assert not answer["applied"]
    assert answer["findings"][0]["code"].startswith("LRP1")
    assert lab.session.program.text == A
    lab.publish()
    assert not [frame for frame in page.all("frame") if "program" in frame]
    assert page.latest("revision") < answer["revision"]


def test_white_space_changes_neither_program_nor_layouts(bench):
    lab = bench(A)
    page = lab.page()
    answer = page.type(A.replace(" ", "\n  "))
    assert answer["applied"]
    lab.publish()
    assert not [frame for frame in page.all("frame") if frame.keys() & {"program", "layouts"}]


def test_a_block_that_hangs_holds_up_no_answer(bench):
    lab = bench("(var go := [False])" + A)
    page = lab.page()
    lab.session.start()
    lab.session.submit(hanging := Hang())
    hanging.reached.wait(60)
    try:
        page.sends(B)
        lab.publish()
        answer = page.last("answer")
        assert (answer["accepted"], answer["applied"]) == (True, False)
        assert answer["reason"]
    finally:
        hanging.go.set()
    lab.session.call(lambda: None)
    lab.publish()
    assert page.last("answer")["applied"]
    assert len(page.latest("program")["machines"][0]["states"]) == 2


def Hang():
    from threading import Event

    from lrp_jupyter.live.running.commands import Call

    class Hanging(Call):
        pass

    reached, go = Event(), Event()

    def hang():
        reached.set()
        go.wait(60)

    command = Hanging(hang)
    object.__setattr__(command, "reached", reached)
    object.__setattr__(command, "go", go)
    return command


def test_an_edit_by_another_cell_reaches_the_views(bench):
    lab = bench(A)
    page = lab.page()
    lab.session.edit(B)
    lab.publish()
    answer = page.last("answer")
    assert (answer["seq"], page.text, answer["applied"]) == (0, B, True)
    assert len(page.latest("program")["machines"][0]["states"]) == 2


def test_a_rename_reaches_all_views_and_what_is_drawn_keeps_its_place(bench):
    lab = bench(C)
    page = lab.page()
    before = page.messages[0]["frame"]["layouts"]["m"]["places"]["c"]
    other = lab.page("other")
    assert page.rename("state", "m/c", "far")["applied"]
    assert other.text == page.text == lab.session.program.text == C.replace(" c)", " far)")
    assert page.latest("layouts")["m"]["places"]["far"] == before


NESTED = """(machine m
  (state a (onentry (spawn inner x)) (machine inner (state x) (state y) (on [False] x -> y)))
  (state b)
  (ontime 100 a -> b)
  (ontime 500 b -> a back))
(spawn m a)"""


def moved(page):
    """Return all elements sent to the page with another path, as (kind, old path, new path)."""
    every = [element for each in page.merged("moved").values() for element in each]
    return [(element["kind"], element["old"], element["new"]) for element in every]


def test_an_edit_of_what_a_machine_spawns_is_drawn_in_it(bench):
    text = """(machine m (state a (onentry (spawn n x))) (state b))
        (machine n (state x) (exit [1 > 2] x -> b)) (machine k (state y)) (spawn m a)"""
    page = bench(text).page()
    page.type(text.replace("1 > 2", "3 > 4"))
    arrow = page.merged("layouts")["m"]["transitions"][0]
    assert (arrow["label"]["text"], arrow["broken"]) == ("[3 > 4]\n(from x)", None)
    page.type(text.replace("(spawn n x)", "(spawn k y)"))
    (state, _), arrows = page.merged("layouts")["m"]["states"], page.merged("layouts")["m"]["transitions"]
    assert ([line["machine"] for line in state["spawns"]], arrows) == (["k"], [])


def test_an_edited_effect_is_in_the_card_of_its_arrow(bench):
    text = "(machine m (state a) (eps a -> a (effect [x = 1])) (var x := [0])) (spawn m a)"
    page = bench(text).page()
    page.type(text.replace("x = 1", "x = 2"))
    assert page.merged("layouts")["m"]["transitions"][0]["title"] == "(eps a -> a)\n/ [x = 2]"


def test_an_edited_delay_leaves_the_transition_what_it_was(bench):
    lab = bench(NESTED)
    page = lab.page()
    before = [shape["id"] for shape in page.latest("layouts")["m"]["transitions"]]
    lab.session.run(seconds=1)
    page.type(NESTED.replace("100", "300"))
    after = page.latest("layouts")["m"]["transitions"]
    assert [shape["id"] for shape in after] == before
    assert "300" in after[0]["label"]["text"]
    assert page.merged("fired")[before[0]][0] == 2
    assert moved(page) == []


def test_a_page_learns_which_paths_a_rename_has_changed(bench):
    lab = bench(NESTED)
    page = lab.page()
    assert page.rename("state", "m/a", "z")["applied"]
    assert {
        ("machine", "m/a/inner", "m/z/inner"),
        ("state", "m/a", "m/z"),
        ("state", "m/a/inner/x", "m/z/inner/x"),
        ("transition", "m:ontime:a->b", "m:ontime:z->b"),
        ("transition", "m/a/inner:on:x->y", "m/z/inner:on:x->y"),
    } <= set(moved(page))
    assert not any(old in ("m:back", "m", "m/b") for _, old, _ in moved(page))
    late = lab.page("late")
    assert moved(late) == moved(page)


def test_stepping_back_over_a_rename_restores_paths_and_places(bench):
    lab = bench(NESTED)
    page = lab.page()
    lab.session.run(seconds=0.2)
    page.do("pin", path="m", name="a", x=321, y=123)
    page.rename("state", "m/a", "z")
    page.do("step")
    page.do("pin", path="m", name="z", x=12, y=34)
    page.do("step_back")
    assert {("machine", "m/z/inner", "m/a/inner"), ("state", "m/z", "m/a")} <= set(moved(page))
    assert page.merged("layouts")["m"]["places"]["a"] == {"x": 12.0, "y": 34.0}


def test_what_moved_comes_with_the_layouts_that_it_belongs_to(bench):
    lab = bench(NESTED)
    page = lab.page()
    lab.session.rename("state", "m/a", "z")
    lab.publish()
    frame = next(frame for frame in page.frames() if frame.get("moved"))
    assert "m/z/inner" in frame["layouts"]


def test_a_dragged_state_stays_in_its_place_when_the_state_around_its_machine_is_renamed(bench):
    lab = bench(NESTED)
    page = lab.page()
    page.do("pin", path="m/a/inner", name="y", x=321, y=123)
    lab.session.rename("state", "m/a", "z")  # by a cell, not by the page
    lab.publish()
    assert page.merged("layouts")["m/z/inner"]["places"]["y"] == {"x": 321.0, "y": 123.0}


def test_places_are_kept_over_several_edits_that_come_at_once(bench):
    lab = bench(NESTED)
    page = lab.page()
    page.do("pin", path="m", name="a", x=321, y=123)
    lab.session.rename("state", "m/a", "y")
    lab.session.edit(lab.session.text.replace("(state b)", "(state c) (state b)"))
    lab.session.rename("state", "m/y", "z")
    lab.publish()
    assert page.merged("layouts")["m"]["places"]["z"] == {"x": 321.0, "y": 123.0}


def test_a_renamed_state_keeps_its_place_though_one_is_reserved_for_its_new_name(bench):
    lab = bench(NESTED.replace("(state b)", "(state b) (state far)"))
    page = lab.page()
    places = page.latest("layouts")["m"]["places"]
    page.type(NESTED)
    assert page.rename("state", "m/b", "far")["applied"]
    assert page.merged("layouts")["m"]["places"]["far"] == places["b"] != places["far"]


def test_changes_that_are_not_the_rename_that_they_are_said_to_be_are_an_edit(bench):
    lab = bench(A)
    page = lab.page()
    assert page.type(B, rename=["state", "m/a", "q"])["applied"]
    assert lab.session.program.text == B
    assert page.type(B + ";", rename=["state", "m/zz", "q"])["applied"]


def test_going_back_over_an_edit_brings_the_old_text_back(bench):
    lab = bench(A)
    page = lab.page()
    lab.session.step()
    lab.session.step()
    page.type(B)
    lab.session.step()
    assert page.do("step_back", value=2) is None
    assert page.text == A
    assert "only 1 can be undone" in page.do("step_back", value=9)


def test_held_texts_wait_and_the_difference_is_shown(bench):
    lab = bench(A)
    page = lab.page()
    assert page.do("hold", on=True) is None
    assert page.latest("settings")["edits"] == "hold"
    answer = page.type(B)
    assert (answer["accepted"], answer["applied"]) == (True, False)
    assert answer["pending"] == {"added": ["state `m/b`"], "removed": [], "changed": [], "moved": []}
    assert lab.session.program.text == A
    assert lab.page("second").messages[0]["pending"] == answer["pending"]
    assert page.do("apply") is None
    assert page.last("answer")["pending"] is None
    assert page.text == B
    assert lab.session.program.text == B


def test_held_texts_can_be_reverted(bench):
    lab = bench(A)
    page = lab.page()
    page.do("hold", on=True)
    page.type(B)
    page.do("revert")
    assert page.text == A
    assert page.last("answer")["pending"] is None


def test_what_was_held_runs_when_holding_ends(bench):
    lab = bench(A)
    page = lab.page()
    page.do("hold", on=True)
    page.type(B)
    page.do("hold", on=False)
    assert lab.session.program.text == B


def test_every_accepted_text_is_saved_at_once_and_no_other(bench, tmp_path):
    lab = bench(A, tmp_path / ".lrp", name="mine")
    page = lab.page()
    lab.publish()
    file = tmp_path / ".lrp" / "mine.lrp"
    assert file.read_text() == A
    page.type(BROKEN)
    assert file.read_text() == A
    page.type(B)
    assert file.read_text() == B


def test_line_ends_are_saved_as_they_are(bench, tmp_path):
    text = B.replace(" ", "\r\n")
    lab = bench(text, tmp_path, name="mine")
    page = lab.page()
    assert "\r" not in page.text
    page.type(page.text + "; \U0001f916\n")
    page.type(page.text + "; more")
    assert (tmp_path / "mine.lrp").read_bytes() == (text + "; \U0001f916\r\n; more").encode()


def test_saving_under_another_name_writes_the_text_in_the_editor(bench, tmp_path):
    lab = bench(A)
    page = lab.page()
    page.type(BROKEN)
    assert save_as(page, tmp_path / "x.lrp")["exists"] is False
    assert (tmp_path / "x.lrp").read_text() == BROKEN
    assert "No such file" in save_as(page, tmp_path / "no" / "x.lrp")["error"]
    assert "Enter a name" in save_as(page, " ")["error"]


def test_saving_asks_before_it_replaces_what_this_lab_did_not_write(bench, tmp_path):
    page = bench(A).page()
    mine, other = tmp_path / "mine.lrp", tmp_path / "other.lrp"
    other.write_text("precious")
    link = tmp_path / "link.lrp"
    link.symlink_to(other)
    for file in (other, link):
        assert save_as(page, file)["exists"] is True
        assert other.read_text() == "precious"
    assert save_as(page, mine)["exists"] is False
    page.type(B)
    assert save_as(page, mine)["exists"] is False
    assert mine.read_text() == B
    mine.write_text("changed outside")
    assert save_as(page, mine)["exists"] is True
    assert save_as(page, other, replace=True)["exists"] is False
    assert other.read_text() == B


def test_a_text_is_saved_until_it_differs_from_what_its_cell_or_file_has(bench, tmp_path):
    lab = bench(A)
    page = lab.page()

    def is_saved():
        lab.publish()
        return page.latest("cell")["is_saved"]

    lab.connection.texts.reconcile(A)
    assert is_saved()
    page.type(B)
    assert not is_saved()
    save_as(page, tmp_path / "mine.lrp")
    assert is_saved()
    page.type(BROKEN)
    assert not is_saved()
    page.type(A)
    assert is_saved()


def save_as(page, name, replace=False):
    return page.ask("save", name=str(name), replace=replace)


def test_a_bundled_program_becomes_the_text(bench):
    lab = bench(A)
    page = lab.page()
    assert page.do("load", name="follower") is None
    assert "(machine follower" in page.text
    assert "no bundled program" in page.do("load", name="nothing")


@pytest.mark.parametrize("text", ["", "(machine m (state a))", A, B, BROKEN])
def test_a_snapshot_repeats_the_last_answer(bench, text):
    lab = bench(A)
    page = lab.page()
    answer = page.type(text)
    snapshot = lab.page("late").messages[0]
    assert snapshot["text"] == text
    assert snapshot["revision"] == answer["revision"]
    assert (snapshot["findings"], snapshot["accepted"]) == (answer["findings"], answer["accepted"])
    assert snapshot["running"] == lab.session.program.text


def test_a_word_that_is_not_meant_waits_and_is_marked_when_it_is_sent_again(bench):
    lab = bench(C)
    page = lab.page()
    text = C.replace("a -> c", "a -> cc")
    answer = page.type(text, at=text.index("cc") + 2, meant=False)
    assert (answer["accepted"], answer["applied"], answer["half_typed"]) == (True, False, True)
    assert answer["reason"] == "waits: `m` has no state `cc`"
    assert [finding["code"] for finding in answer["findings"]] == []
    assert lab.session.program.text == C
    answer = page.moves(text.index("cc") + 2)
    assert (answer["applied"], answer["reason"], answer["half_typed"]) == (True, "", True)
    assert "LRP303" in [finding["code"] for finding in answer["findings"]]
    assert not page.moves(0)["half_typed"]  # from now on its faults are told


def test_the_running_text_is_sent_while_only_a_part_of_a_text_runs(bench):
    lab = bench(C)
    page = lab.page()
    text = C.replace("(state a)", "(state a) (state b)").replace("a -> c", "a -> cc")
    page.type(text, at=text.index("cc") + 2, meant=False)
    lab.publish()
    assert page.last("answer")["running"] == C.replace("(state a)", "(state a) (state b)")
    assert page.last("answer")["reason"] == "waits: `m` has no state `cc`"
    assert page.latest("revision") == page.last("answer")["revision"]
    page.moves(None)
    assert page.last("answer")["running"] is None


def test_a_held_text_is_not_marked_where_it_is_half_typed(bench):
    lab = bench(C)
    page = lab.page()
    assert page.do("hold", on=True) is None
    text = C.replace("a -> c", "a -> cc")
    answer = page.type(text, at=text.index("cc") + 2, meant=False)
    assert (answer["findings"], answer["half_typed"]) == ([], True)
    answer = page.moves(0)
    assert [finding["code"] for finding in answer["findings"]][-1] == "LRP303"


def test_what_waits_is_applied_when_the_view_closes(bench):
    lab = bench(C)
    page, other = lab.page(), lab.page("other")
    text = C.replace("a -> c", "a -> cc")
    page.type(text, at=text.index("cc") + 2, meant=False)
    other.send("bye")
    assert lab.session.program.text == C
    page.send("bye")
    assert lab.session.program.text == text


def test_what_waits_is_applied_when_the_view_can_no_longer_be_reached(bench):
    lab = bench(C)
    lab.page("other")
    page = lab.page(pays=False)
    text = C.replace("a -> c", "a -> cc")
    page.type(text, at=text.index("cc") + 2, meant=False)
    for _ in range(40):
        lab.session.step()
        lab.wall.now += 1.0
        lab.publish()
    assert lab.session.program.text == text


def test_a_view_that_opens_learns_that_something_waits(bench):
    lab = bench(C)
    text = C.replace("a -> c", "a -> cc")
    lab.page().type(text, at=text.index("cc") + 2, meant=False)
    assert lab.page("other").last("snapshot")["half_typed"]
