"""Files are written as a whole or not at all, and never through a link."""

import os

import pytest

from lrp_jupyter import files
from lrp_jupyter.errors import FileError
from lrp_jupyter.files import append_line, read_file, read_text, write_file


def test_a_file_is_written_with_its_line_ends_and_nothing_stays_beside_it(tmp_path):
    write_file(tmp_path / "a.lrp", "é\r\n")
    assert (tmp_path / "a.lrp").read_bytes() == "é\r\n".encode()
    write_file(tmp_path / "a.lrp", "b")
    assert [file.name for file in tmp_path.iterdir()] == ["a.lrp"]
    assert read_file(tmp_path / "a.lrp") == "b"


def test_a_replaced_file_keeps_its_permissions(tmp_path):
    file = tmp_path / "a.lrp"
    file.write_text("a")
    file.chmod(0o640)
    write_file(file, "b")
    assert file.stat().st_mode & 0o777 == 0o640


def test_a_link_is_replaced_and_what_it_leads_to_stays(tmp_path):
    (tmp_path / "secret").write_text("secret")
    (tmp_path / "a.lrp").symlink_to(tmp_path / "secret")
    assert read_file(tmp_path / "a.lrp") is None
    write_file(tmp_path / "a.lrp", "b")
    assert (tmp_path / "secret").read_text() == "secret"
    assert not (tmp_path / "a.lrp").is_symlink()
    assert read_file(tmp_path / "a.lrp") == "b"


def test_a_file_that_was_prepared_under_the_new_name_is_not_written(tmp_path, monkeypatch):
    (tmp_path / "secret").write_text("secret")
    monkeypatch.setattr("secrets.token_hex", lambda size: "guessed")
    os.link(tmp_path / "secret", tmp_path / ".guessed.lrp~")
    with pytest.raises(FileError, match="File exists"):
        write_file(tmp_path / "a.lrp", "b")
    assert (tmp_path / "secret").read_text() == "secret"
    assert not (tmp_path / "a.lrp").exists()


def test_a_disk_that_is_full_leaves_the_old_file_as_it_was(tmp_path, monkeypatch):
    write_file(tmp_path / "a.lrp", "old")

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    with pytest.raises(FileError, match="cannot be written: No space left on device"):
        write_file(tmp_path / "a.lrp", "new")
    assert [file.name for file in tmp_path.iterdir()] == ["a.lrp"]
    assert read_file(tmp_path / "a.lrp") == "old"


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("no/a.lrp", "cannot be written: No such file or directory."),
        ("x" * 300, "cannot be written: File name too long."),
        ("a\0b", "cannot be the name of a file"),
        ("\ud800", "cannot be the name of a file"),
        ("folder", "exists and is not a file"),
        ("", "exists and is not a file"),
        ("pipe", "exists and is not a file"),
        ("null", "exists and is not a file"),
        ("protected", "is write-protected"),
    ],
)
def test_a_name_that_is_not_one_of_a_file_is_explained(tmp_path, name, words):
    (tmp_path / "folder").mkdir()
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "null").symlink_to("/dev/null")
    (tmp_path / "protected").touch(0o444)
    with pytest.raises(FileError, match=words):
        write_file(tmp_path / name, "text")
    assert not read_file(tmp_path / name)  # and does not wait for a writer
    assert len(list(tmp_path.iterdir())) == 4


def test_half_a_character_is_explained_by_its_line(tmp_path):
    with pytest.raises(FileError, match=r"Line 2 contains half a character \(`U\+D800`\)"):
        write_file(tmp_path / "a.lrp", "a\nb\ud800")
    assert list(tmp_path.iterdir()) == []


def test_lines_are_appended_for_this_user_alone_and_not_through_a_link(tmp_path):
    for line in ("a", "b"):
        append_line(tmp_path / "notes", line)
    assert read_file(tmp_path / "notes") == "a\nb\n"
    assert (tmp_path / "notes").stat().st_mode & 0o077 == 0
    (tmp_path / "link").symlink_to(tmp_path / "notes")
    with pytest.raises(OSError, match="link"):
        append_line(tmp_path / "link", "c")


def test_what_has_no_end_is_no_file_to_read(tmp_path, monkeypatch):
    os.mkfifo(tmp_path / "pipe")
    for name in ("/dev/null", "/dev/zero", "/dev/full", tmp_path / "pipe"):
        with pytest.raises(FileError, match="cannot be read: It is a device or a pipe, not a file"):
            read_text(name)
    monkeypatch.setattr(files, "LARGEST", 10)
    (tmp_path / "long").write_text("." * 11)
    assert read_file(tmp_path / "long") is None
    with pytest.raises(FileError, match="It contains more than"):
        read_text(tmp_path / "long")
    (tmp_path / "long").write_text("." * 10)
    assert read_text(tmp_path / "long") == read_file(tmp_path / "long") == "." * 10


def test_a_file_that_is_open_elsewhere_for_a_moment_is_replaced_on_windows_too(tmp_path, monkeypatch):
    refusals = [32, 5]
    replace = os.replace

    def refused(*paths):
        if refusals:
            error = PermissionError(13, "Permission denied")
            error.winerror = refusals.pop()
            raise error
        replace(*paths)

    monkeypatch.setattr(os, "replace", refused)
    write_file(tmp_path / "a.lrp", "a")
    assert (read_file(tmp_path / "a.lrp"), refusals) == ("a", [])
