"""What is kept in files: nothing is lost or overwritten, and nothing that came with the folder runs."""

import errno
import gc
import json
import os
import random
import tracemalloc
from types import SimpleNamespace

import pytest
from support.seeds import seeds

from lrp_jupyter import files
from lrp_jupyter.errors import LRPError
from lrp_jupyter.widgets import registry
from lrp_jupyter.widgets.lab import Lab
from lrp_jupyter.widgets.text.kept import Kept, checked_name

A = "(machine m (state a)) (spawn m a)"
B = "(machine m (state a) (state b)) (spawn m a)"
C = "(machine m (state a) (state c)) (spawn m a)"
EVIL = '(machine m (state a (onentry [open("owned", "w").close()]))) (spawn m a)'
BROKEN = "(machine m (state a)"


@pytest.fixture
def cell(tmp_path):
    """Run a cell with a text in a new kernel, as often as wanted."""

    def close():
        for connection in list(registry.running()):
            registry.forget(connection)

    def run(text, name="mine"):
        close()
        connection = registry.open_program(name, text, namespace={}, folder=tmp_path)
        connection.publish()
        return connection

    yield run
    close()


def given(tmp_path, text, name="mine"):
    """Put a text into the folder, as a stranger does who passes it on."""
    (tmp_path / ".lrp").mkdir(exist_ok=True)
    file = tmp_path / ".lrp" / f"{name}.lrp"
    file.write_text(text)
    return file


# -- texts that this user did not write ------------------------------------------------------------


@pytest.mark.parametrize("visible", [A, "", None])
def test_a_text_that_came_with_the_folder_does_not_run_before_it_is_chosen(
    cell, tmp_path, monkeypatch, visible
):
    monkeypatch.chdir(tmp_path)
    file = given(tmp_path, EVIL)
    connection = cell(visible)
    connection.session.wait_for(lambda frame: frame.tick > 2, 60)
    assert connection.session.program.text == connection.texts.text == (visible or "")
    assert "that you have not written here" in connection.texts.conflict["sentence"]
    assert connection.texts.conflict["text"] == EVIL
    assert file.read_text() == EVIL
    assert not (tmp_path / "owned").exists()
    connection.texts.end_conflict(None, use=True)
    connection.session.wait_for(lambda frame: frame.program.text == EVIL, 60)


def test_forged_files_beside_a_strangers_text_do_not_make_it_run(cell, tmp_path):
    given(tmp_path, EVIL)
    forged = json.dumps({"typed": EVIL, "cell": EVIL, "versions": []})
    (tmp_path / ".lrp" / "mine.versions").write_text(forged)
    connection = cell("")
    assert connection.session.program.text == ""
    assert [version.text for version in connection.texts.versions] == [EVIL]
    assert cell(A).session.program.text == A
    assert cell("").session.program.text == A


def test_another_user_is_not_asked_about_the_text_that_the_cell_had_before(cell, tmp_path, monkeypatch):
    cell(A)
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "other"))
    connection = cell(B)
    assert connection.texts.conflict is None
    assert connection.session.program.text == B


def test_a_text_that_was_replaced_while_no_kernel_ran_is_not_this_users(cell, tmp_path):
    cell(A).texts.write(B)
    cell(None)
    given(tmp_path, EVIL)
    assert cell(None).session.program.text == ""


def test_without_a_cells_text_a_program_continues_with_what_this_user_wrote(cell):
    cell(A).texts.write(B)
    assert cell("").session.program.text == B
    connection = cell(None)
    connection.texts.write(BROKEN)
    connection = cell(None)
    assert connection.session.program.text == B
    assert connection.texts.text == BROKEN
    assert connection.texts.conflict is None


def test_in_a_browser_whose_python_has_a_new_home_kept_texts_are_still_this_users(
    cell, tmp_path, monkeypatch
):
    given(tmp_path, B)  # and no note of it, which was in the old home
    monkeypatch.setattr("lrp_jupyter.own.sys", SimpleNamespace(platform="emscripten"))
    assert cell(None).session.program.text == B


@pytest.mark.slow
def test_the_notes_about_own_texts_are_bounded(cell, monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    connection = cell(A)
    for number in range(1200):
        connection.saver.kept.write(".lrp", text(number))
    files = (tmp_path / "state" / "lrp-jupyter" / "kept").iterdir()
    (notes,) = (each for each in files if each.stat().st_size > 1000)
    assert notes.stat().st_size < 70_000
    assert connection.saver.kept.is_own(".lrp", text(1199))
    assert not connection.saver.kept.is_own(".lrp", EVIL)


def test_a_folder_that_is_a_link_is_neither_read_nor_written(cell, tmp_path):
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / "mine.lrp").write_text(EVIL)
    (tmp_path / ".lrp").symlink_to(elsewhere)
    connection = cell(A)
    connection.texts.write(B)
    connection.publish()
    assert connection.texts.conflict is None
    assert "is a link" in connection.saver.problem
    assert (elsewhere / "mine.lrp").read_text() == EVIL
    assert len(list(elsewhere.iterdir())) == 1


def test_links_in_the_folder_lead_nowhere(cell, tmp_path):
    secret = tmp_path / "secret"
    secret.write_text("secret")
    (tmp_path / ".lrp").mkdir()
    for name in ("mine.lrp", "mine.lrp~", "mine.versions", "mine.versions~"):
        (tmp_path / ".lrp" / name).symlink_to(secret)
    connection = cell(A)
    for text in (B, BROKEN, C):
        connection.texts.write(text)
        connection.publish()
    assert secret.read_text() == "secret"
    assert (tmp_path / ".lrp" / "mine.lrp").read_text() == C
    assert "secret" not in [version.text for version in connection.texts.versions]


def test_a_text_is_kept_at_once_though_no_page_is_open(tmp_path, monkeypatch, cell):
    monkeypatch.chdir(tmp_path)
    lab = Lab(A, name="mine", namespace={})
    assert (tmp_path / ".lrp" / "mine.lrp").read_text() == A
    lab.text = B
    assert (tmp_path / ".lrp" / "mine.lrp").read_text() == B
    lab.text = BROKEN
    assert Kept(tmp_path / ".lrp", "mine").remembered().typed == BROKEN


# -- conflicts -------------------------------------------------------------------------------------


def test_a_file_that_was_changed_outside_is_not_overwritten_by_the_next_key(bench, tmp_path):
    lab = bench(A, tmp_path, name="mine")
    page = lab.page()
    page.type(B)
    file = tmp_path / "mine.lrp"
    file.write_text(C)
    page.type(A)
    assert file.read_text() == C
    lab.publish()
    conflict = page.latest("conflict")
    assert conflict["text"] == C
    assert "was changed outside this lab" in conflict["sentence"]
    page.do("keep", number=conflict["number"])
    lab.publish()
    assert file.read_text() == A
    assert page.latest("conflict") is None
    file.write_text(C)
    lab.publish(2)  # seen without a key, too
    lab.publish()
    page.do("take", number=page.latest("conflict")["number"])
    assert page.text == C
    assert lab.session.program.text == C


def test_a_file_that_was_changed_into_something_else_than_a_text_is_not_overwritten(bench, tmp_path):
    lab = bench(A, tmp_path, name="mine")
    page = lab.page()
    page.type(B)
    (tmp_path / "mine.lrp").write_bytes(b"; Gr\xfc\xdfe")
    page.type(C)
    assert (tmp_path / "mine.lrp").read_bytes() == b"; Gr\xfc\xdfe"
    lab.publish()
    assert "is not valid UTF-8, or too large" in page.latest("unkept")


def test_two_kernels_with_the_same_file_ask_instead_of_overwriting_each_other(bench, tmp_path):
    one, other = bench(A, tmp_path, name="mine"), bench(A, tmp_path, name="mine")
    first, second = one.page(), other.page()
    for page, text in ((first, A), (second, A), (first, B), (second, C)):
        page.type(text)
    assert (tmp_path / "mine.lrp").read_text() == B
    other.publish()
    assert second.latest("conflict")["text"] == B
    second.do("keep")
    other.publish()
    one.publish(2)
    one.publish()
    assert first.latest("conflict")["text"] == C


def test_what_is_typed_while_a_choice_is_open_is_kept(cell, tmp_path):
    given(tmp_path, EVIL)
    cell(A).texts.write(B)
    connection = cell(A)
    assert connection.texts.conflict["text"] == EVIL
    connection.texts.end_conflict(None, use=False)
    assert connection.texts.conflict["text"] == B


def test_the_text_of_a_view_that_lost_its_kernel_continues_what_was_kept(cell):
    cell(A).texts.write(B)
    connection = cell(A)
    assert connection.texts.conflict["text"] == B
    connection.texts.recover(BROKEN)
    assert connection.texts.conflict["text"] == BROKEN
    assert [conflict.text for conflict in connection.texts.conflicts] == [BROKEN]
    connection.publish()
    assert {B, BROKEN} <= {version.text for version in connection.saver.kept.remembered().versions}
    connection.texts.recover(BROKEN)
    connection.texts.recover(A)  # what the lab has already
    connection.texts.recover("  ")
    assert len(connection.texts.conflicts) == 1


def test_what_was_saved_with_the_notebook_is_asked_about_neither_by_the_cell_nor_by_its_view(bench, cell):
    lab = bench(A)
    page = lab.page()
    texts = lab.connection.texts
    texts.reconcile(A)
    page.type(B)
    page.do("put_into_cell", text=B)
    lab.publish()
    assert page.latest("cell")["text"] == B
    page.type(C)
    texts.reconcile(B)  # the cell runs again
    assert (texts.text, texts.conflict) == (C, None)

    cell(A).texts.write(B)
    connection = cell(C)  # typed after the kernel's end, and saved
    assert connection.texts.conflict["text"] == B
    connection.texts.recover(C)
    assert connection.texts.conflict is None


@pytest.mark.parametrize("answer", ["take", "keep"])
def test_an_answer_ends_only_the_conflict_that_it_is_about(bench, answer):
    lab = bench(A)
    page = lab.page()
    page.do("recover", text=B)
    number = page.latest("conflict")["number"]
    lab.connection.texts.recover(C)
    lab.publish()
    assert page.latest("conflict")["text"] == C
    page.do(answer, number=number)
    assert lab.connection.texts.text == A
    assert lab.connection.texts.conflict["text"] == C
    page.do(answer, number=page.latest("conflict")["number"])
    assert lab.connection.texts.text == {"take": C, "keep": A}[answer]
    assert lab.connection.texts.conflict is None


# -- versions --------------------------------------------------------------------------------------


def versions(lab):
    return [version.text for version in lab.connection.texts.versions]


def text(number):
    return f"(machine m (state s{number})) (spawn m s{number})"


def test_the_last_ten_texts_that_were_not_empty_are_kept(cell):
    connection = cell(A)
    for number in range(12):
        connection.texts.write(text(number))
        connection.texts.write("")
    expected = [text(number) for number in range(11, 1, -1)]
    assert [version.text for version in connection.texts.versions] == expected
    connection = cell(None)
    assert [version.text for version in connection.texts.versions] == expected


def test_typing_makes_a_version_after_a_pause_and_before_a_deletion(bench):
    lab = bench("")
    page = lab.page()
    for end in range(1, len(A) + 1):
        page.sends(A[:end])
        lab.publish(0.1)
    assert versions(lab) == []
    lab.publish(10)
    page.type(A + " ")
    assert versions(lab) == [A]
    page.type("(machine")
    assert versions(lab) == [A + " ", A]


def test_a_version_is_listed_and_returned_to(bench):
    lab = bench(A)
    page = lab.page()
    page.do("load", name="follower")
    (version,) = page.ask("versions")["versions"]
    assert version["text"] == A
    assert page.do("version", key=version["key"]) is None
    assert page.text == A
    assert [each["text"][:1] for each in page.ask("versions")["versions"]] == [";", "("]
    assert "no longer kept" in page.do("version", key="x")


def test_versions_that_another_program_wrote_are_left_out(cell, tmp_path):
    (tmp_path / ".lrp").mkdir()
    for text in ('[{"when": 1e999, "text": "x"}, 3]', '[{"when": NaN, "text": "x"}]', "[" * 9999, "{}", "\0"):
        (tmp_path / ".lrp" / "mine.versions").write_text(text)
        assert cell(A).texts.versions == ()
    old = '[{"when": 1, "text": "as they were kept before"}]'
    (tmp_path / ".lrp" / "mine.versions").write_text(old)
    assert [version.text for version in cell(A).texts.versions] == ["as they were kept before"]


@pytest.mark.slow
def test_revisions_of_a_long_text_cost_no_memory(bench):
    lab = bench(A)
    long = f"{A} ; {'x' * 1_000_000}"
    tracemalloc.start()
    try:
        before = tracemalloc.get_traced_memory()[0]
        for number in range(20):
            lab.connection.texts.write(f"{long}{number}")
            lab.publish()
        gc.collect()
        grown = tracemalloc.get_traced_memory()[0] - before
    finally:
        tracemalloc.stop()
    assert grown < 10_000_000


# -- failures --------------------------------------------------------------------------------------


def printed(lab):
    return list(lab.session.output.since(0)[1])


def test_a_lab_that_is_closed_keeps_at_once_what_could_not_be_kept(bench, tmp_path, monkeypatch):
    lab = bench(A, tmp_path, name="mine")
    page = lab.page()

    def fails(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(files.os, "replace", fails)
        page.type(B)
        lab.publish()
    assert "No space left" in page.latest("unkept")
    lab.connection.close()
    assert (tmp_path / "mine.lrp").read_text() == B


@pytest.mark.parametrize("reason", [errno.ENOSPC, errno.EROFS, errno.EACCES])
def test_a_disk_that_cannot_be_written_is_told_once_and_tried_again(bench, tmp_path, monkeypatch, reason):
    lab = bench(A, tmp_path, name="mine")
    page = lab.page()

    def fails(*_):
        tries.append(None)
        raise OSError(reason, os.strerror(reason))

    tries = []
    with monkeypatch.context() as patch:
        patch.setattr(files.os, "replace", fails)
        for number in range(30):
            page.type(text(number))  # half a second each
    assert len(printed(lab)) == 1
    assert os.strerror(reason) in printed(lab)[0]
    assert os.strerror(reason) in page.latest("unkept")
    assert 2 <= len(tries) < 10
    lab.publish(10)
    lab.publish()
    assert page.latest("unkept") == ""
    assert (tmp_path / "mine.lrp").read_text() == text(29)


def test_half_a_character_is_told_once(bench, tmp_path):
    lab = bench(A, tmp_path, name="mine")
    page = lab.page()
    for _ in range(20):
        page.type(A + " ; \ud800")
    assert len(printed(lab)) == 1
    assert "half a character" in page.latest("unkept")
    page.type(B)
    lab.publish(10)
    lab.publish()
    assert page.latest("unkept") == ""
    assert (tmp_path / "mine.lrp").read_text() == B


def test_a_file_in_place_of_the_folder_and_a_folder_in_place_of_the_file_are_named(cell, tmp_path):
    (tmp_path / ".lrp").write_text("a file")
    assert "is a file" in cell(A).saver.problem
    (tmp_path / ".lrp").unlink()
    (tmp_path / ".lrp" / "mine.lrp").mkdir(parents=True)
    connection = cell(A)
    assert connection.session.status == "running"
    assert "is not a file" in connection.saver.problem


@pytest.mark.parametrize(
    "name",
    [
        "",
        ".x",
        "a/b",
        "a\\b",
        "a\0b",
        "x" * 300,
        "a\nb",
        "a\u202eb",
        "a\u200bb",
        "CON",
        "lpt1.x",
        "a:b",
        "a. ",
    ],
)
def test_a_name_that_no_file_should_have_is_refused_in_a_sentence(cell, name):
    with pytest.raises(LRPError, match="is not a valid name for a program") as raised:
        cell(A, name)
    assert str(raised.value).isprintable()
    assert len(str(raised.value)) < 400


@pytest.mark.parametrize("name", ["mine", "Ä_1-b", "two words", "console", "ロボット", "x" * 100])
def test_other_names_are_usable(name):
    assert checked_name(name) == name


# -- anything in any order -------------------------------------------------------------------------


@pytest.mark.parametrize("seed", seeds(8, 60))
def test_whatever_happens_no_text_is_lost(cell, tmp_path, seed):
    """Each text is present, asked about, or a version; those of cells are in their cells."""
    chance = random.Random(seed)
    file = tmp_path / ".lrp" / "mine.lrp"
    connection = cell(A)
    done = []

    def everywhere():
        texts, versions = connection.texts, connection.texts.versions
        return [texts.text, *(each.text for each in texts.conflicts), *(each.text for each in versions)]

    for number in range(25):
        texts = connection.texts
        step = chance.choice(
            ["type", "break", "cell", "blank", "restart", "take", "keep", "outside", "recover"]
        )
        done.append(step)
        before = {texts.text, *(each.text for each in texts.conflicts)}
        if step in ("type", "break"):
            texts.write(text(number) if step == "type" else f"{BROKEN} {number}")
        elif step in ("cell", "restart"):
            source = chance.choice([A, B, texts.cell])
            if step == "restart":
                connection = cell(source)
            else:
                registry.open_program("mine", source, namespace={}, folder=tmp_path)
        elif step == "blank":
            connection = cell("")
        elif step in ("take", "keep"):
            texts.end_conflict(None, use=step == "take")
        elif step == "recover":
            texts.recover(f"(machine recovered{number}")
        else:
            file.write_text(outside := f"{A} ; outside {number}")
            texts.write(C)
            before.add(outside)
            connection.saver._looked = float("-inf")  # the next comparison is due
        connection.publish()
        lost = {each for each in before if each.strip() and each not in (A, B)} - set(everywhere())
        assert not lost, (done, lost, everywhere())
