"""Where texts are kept: a person finds their own again, and a stranger never gets them."""

from pathlib import Path

import pytest

from lrp_jupyter.errors import LRPError
from lrp_jupyter.live.session import Session
from lrp_jupyter.widgets import registry
from lrp_jupyter.widgets.text.keeping import kept_texts

A = "(machine m (state a)) (spawn m a)"
B = "(machine m (state a) (state b)) (spawn m a)"
VOILA = ("SERVER_SOFTWARE", "voila/0.5.13")
PREHEATED = ("VOILA_PREHEAT", "True")
HUB = ("JUPYTERHUB_USER", "ada")


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    """Return the home of a user, in an environment that says nothing about the host."""
    for name in ("LRP_KEEP", "SERVER_SOFTWARE", "VOILA_PREHEAT", "JUPYTERHUB_USER"):
        monkeypatch.delenv(name, raising=False)
    home = tmp_path / "home"
    monkeypatch.setenv("HOME", str(home))
    monkeypatch.setenv("USERPROFILE", str(home))
    monkeypatch.setenv("XDG_STATE_HOME", str(home / "state"))
    return home


@pytest.fixture
def kernel(tmp_path):
    """Open a program in a new kernel, as often as wanted."""

    def end():
        for connection in list(registry.running()):
            registry.forget(connection)

    def start(text=None, folder=tmp_path / "shared"):
        end()
        folder.mkdir(parents=True, exist_ok=True)
        return registry.open_program("mine", text, "none", namespace={}, folder=folder)

    yield start
    end()


def type_into(connection, text):
    """Type a text and wait until it is kept, if it is kept."""
    connection.texts.write(text)
    connection.saver.save(at_once=True)


def snapshot_of(connection):
    """Return what a view gets when it opens."""
    messages = []
    connection.receive(
        lambda message, _: messages.append(message), {"type": "hello", "view": "v", "part": "lab"}
    )
    return messages[0]


def files_in(folder):
    return {file.name for file in folder.rglob("*") if file.is_file()}


@pytest.fixture
def use(monkeypatch):
    return lambda *names: [monkeypatch.setenv(*each) for each in names]


def test_a_persons_text_is_kept_beside_the_notebook(kernel, tmp_path):
    type_into(kernel(A), B)
    assert "mine.lrp" in files_in(tmp_path / "shared" / ".lrp")
    assert kernel().texts.text == B


def test_a_user_of_a_shared_folder_finds_their_own_text_again_and_no_one_elses(
    kernel, tmp_path, monkeypatch, use
):
    use(("LRP_KEEP", "user"))
    type_into(kernel(A), B)
    assert files_in(tmp_path / "shared") == set()
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "other"))
    other = kernel(A)
    assert other.texts.text == A
    assert other.texts.conflict is None
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "home" / "state"))
    assert kernel().texts.text == B


def test_a_users_texts_of_two_folders_are_two(kernel, tmp_path, use):
    use(("LRP_KEEP", "user"))
    type_into(kernel(A), B)
    assert kernel(folder=tmp_path / "elsewhere").texts.text == ""


@pytest.mark.parametrize("host", [VOILA, PREHEATED, ("LRP_KEEP", "nothing")], ids=lambda host: host[0])
def test_nothing_is_kept_for_visitors(kernel, tmp_path, home, use, host):
    use(host)
    connection = kernel(A)
    type_into(connection, B)
    snapshot = snapshot_of(connection)
    assert snapshot["tab_only"]
    assert snapshot["home"] == str(tmp_path.resolve() / "shared" / "mine")
    assert [version.text for version in connection.texts.versions] == [A]
    assert files_in(tmp_path) == set()
    again = kernel(A)
    assert again.texts.text == A
    assert again.texts.conflict is None


def test_a_page_learns_where_the_program_is_kept(kernel, tmp_path):
    snapshot = snapshot_of(kernel(A))
    assert not snapshot["tab_only"]
    assert snapshot["home"] == str(tmp_path.resolve() / "shared" / ".lrp" / "mine")


def test_a_program_that_is_in_no_folder_is_known_by_its_name(kernel):
    with Session(A, name="mine") as session:
        snapshot = snapshot_of(registry.connection_of(session))
    assert snapshot["tab_only"]
    assert snapshot["home"] == "mine"


@pytest.mark.parametrize("inside", [True, False])
def test_on_a_hub_texts_are_kept_for_the_user_and_only_in_their_home(kernel, tmp_path, home, use, inside):
    use(HUB)
    folder = home / "work" if inside else tmp_path / "shared"
    type_into(kernel(A, folder), B)
    assert files_in(folder) == set()
    assert kernel(folder=folder).texts.text == (B if inside else "")


def test_a_link_in_a_home_leads_to_a_shared_folder(kernel, tmp_path, home, use):
    use(HUB)
    home.mkdir()
    (tmp_path / "shared").mkdir()
    (home / "link").symlink_to(tmp_path / "shared")
    assert kept_texts(home / "link", "mine") is None


def test_what_is_set_comes_before_what_the_host_suggests(tmp_path, use):
    use(VOILA, ("LRP_KEEP", "notebook"))
    assert kept_texts(tmp_path, "mine").folder == tmp_path / ".lrp"


def test_a_wrong_value_is_told_with_the_right_ones(kernel, use):
    use(("LRP_KEEP", "always"))
    with pytest.raises(LRPError, match=r"`always` is not .*Set it to `notebook`, `user` or `nothing`\."):
        kernel(A)
    assert registry.names() == []


def test_a_user_without_a_home_is_told_what_to_set(tmp_path, monkeypatch, use):
    use(("LRP_KEEP", "user"))
    monkeypatch.delenv("XDG_STATE_HOME")

    def homeless():
        raise RuntimeError

    monkeypatch.setattr(Path, "home", homeless)
    with pytest.raises(LRPError, match=r"no home folder.*`notebook` or `nothing`\."):
        kept_texts(tmp_path, "mine")


def test_a_file_in_the_state_folder_is_named_in_full_when_it_was_changed_outside(kernel, use):
    use(("LRP_KEEP", "user"))
    connection = kernel(A)
    type_into(connection, B)
    file = connection.saver.kept.file(".lrp")
    file.write_text(A)
    connection.saver.save(at_once=True)
    connection.texts.write(B + " ")
    connection.saver.save(at_once=True)
    assert f"{str(file)[-50:]}` was changed outside" in connection.texts.conflict["sentence"]
