"""Finding bridges: packages offer them, notebooks define them, users choose."""

from __future__ import annotations

import subprocess
import sys
from abc import abstractmethod
from collections.abc import Iterator
from pathlib import Path

import cloudpickle
import pytest

from lrp_jupyter.bridges import discovery
from lrp_jupyter.bridges.bridge import Bridge, NullBridge
from lrp_jupyter.bridges.discovery import choose_bridge, find_bridges, make_bridge, open_bridge
from lrp_jupyter.errors import BridgeError, LRPError


@pytest.fixture
def registry() -> Iterator[dict[str, type[Bridge]]]:
    """What is defined in a test is forgotten after it."""
    before = dict(Bridge.registry)
    yield Bridge.registry
    Bridge.registry.clear()
    Bridge.registry.update(before)


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An installed package with three bridges: a good one, one that cannot be imported, one that is none."""
    info = tmp_path / "robots_for_all-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: robots-for-all\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(
        "[lrp.bridges]\n"
        "test-good = robots_for_all:Good\n"
        "test-bad = robots_for_all_bad:Bad\n"
        "test-none = robots_for_all:nothing\n"
    )
    (tmp_path / "robots_for_all.py").write_text(
        "from lrp_jupyter.bridges import Bridge\n"
        "class Good(Bridge):\n"
        "    name = 'test-good'\n"
        "    def open_interface(self): self.add_variable('depth', lambda: 3, 'below the surface')\n"
        "nothing = 3\n"
    )
    (tmp_path / "robots_for_all_bad.py").write_text("import a_library_that_is_not_installed\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.delitem(sys.modules, "robots_for_all", raising=False)
    return tmp_path


def test_the_bridges_of_this_package_are_found_by_name() -> None:
    known = find_bridges()
    assert {"none", "sim"} <= set(known)
    assert known["sim"].origin == "lrp-jupyter"
    assert known["none"].load() is NullBridge


@pytest.mark.slow
def test_they_are_found_though_a_library_has_replaced_the_finder_of_packages() -> None:
    """As the backport `importlib_metadata` does when it is imported, for example by Dask."""
    pytest.importorskip("importlib_metadata")
    program = (
        "import importlib_metadata, sys; from lrp_jupyter.bridges import discovery, sim; "
        "sys.exit(discovery.find_bridges()['sim'].origin)"
    )
    found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert found.stderr == "lrp-jupyter\n"


def test_looking_at_the_list_imports_no_bridge() -> None:
    code = (
        "import sys, lrp_jupyter.bridges as b\n"
        "assert 'sim' in b.find_bridges()\n"
        "bad = {'pymunk', 'lrp_jupyter.bridges.sim', 'lrp_jupyter.bridges.ros', 'lrp_jupyter.bridges.ev3'}\n"
        "assert not bad & set(sys.modules), bad & set(sys.modules)\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=180)


def test_a_class_is_found_as_soon_as_it_is_defined(registry: dict[str, type[Bridge]]) -> None:
    class MyBot(Bridge):
        def open_interface(self) -> None:
            """Nothing."""

    assert MyBot.name == "mybot"
    assert find_bridges()["mybot"].load() is MyBot
    assert find_bridges()["mybot"].origin == "defined here"


def test_a_cell_that_is_run_again_redefines_the_bridge(registry: dict[str, type[Bridge]]) -> None:
    def cell() -> type[Bridge]:
        class MyBot(Bridge):
            name = "mybot"

            def open_interface(self) -> None:
                """Nothing."""

        return MyBot

    first, second = cell(), cell()
    assert find_bridges()["mybot"].load() is second is not first


def test_a_subclass_has_a_name_of_its_own(registry: dict[str, type[Bridge]]) -> None:
    class Cart(Bridge):
        name = "cart"

        def open_interface(self) -> None:
            """Nothing."""

    class BigCartBridge(Cart):
        pass

    assert BigCartBridge.name == "bigcart"
    assert find_bridges()["cart"].load() is Cart


def test_what_is_abstract_is_not_listed(registry: dict[str, type[Bridge]]) -> None:
    class Family(Bridge):
        @abstractmethod
        def connect(self) -> None:
            """Each in its own way."""

    assert "family" in Bridge.registry
    assert "family" not in find_bridges()
    with pytest.raises(BridgeError, match="`Family` lacks `connect`, `open_interface`"):
        make_bridge(Family)


@pytest.mark.parametrize("taken", ["none", "sim"])
def test_the_names_of_the_defaults_cannot_be_taken(registry: dict[str, type[Bridge]], taken: str) -> None:
    with pytest.raises(BridgeError, match=f"The name `{taken}` is taken. Give `Mine` another"):
        type("Mine", (NullBridge,), {"name": taken, "__module__": "__main__"})
    assert find_bridges()[taken].origin == "lrp-jupyter"


def test_the_default_is_chosen_unless_another_is_named(registry: dict[str, type[Bridge]]) -> None:
    class MyBot(Bridge):
        def open_interface(self) -> None:
            """Nothing."""

    assert choose_bridge() == "sim", "hardware is never chosen by itself"
    assert choose_bridge(default="none") == "none"
    assert choose_bridge("mybot") == "mybot"


def test_an_unknown_name_is_answered_with_the_known_ones() -> None:
    with pytest.raises(
        BridgeError, match=r"There is no bridge `simm`; there are .*`sim`.* Did you mean `sim`\?"
    ):
        choose_bridge("simm")


def test_a_packages_bridge_is_found_and_opened(registry: dict[str, type[Bridge]], package: Path) -> None:
    assert find_bridges()["test-good"].origin == "robots-for-all"
    bridge = open_bridge("test-good")
    assert bridge.robot.depth == 3
    assert find_bridges()["test-good"].origin == "robots-for-all", "also once it is imported"


def test_a_package_that_is_installed_while_a_notebook_runs_is_found(package: Path) -> None:
    assert "test-late" not in find_bridges()
    info = package / "late_robots-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: late-robots\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("[lrp.bridges]\ntest-late = late_robots:Late\n")
    assert find_bridges()["test-late"].origin == "late-robots"


def test_a_list_of_packages_that_did_not_change_is_not_read_again(monkeypatch: pytest.MonkeyPatch) -> None:
    known = find_bridges()
    monkeypatch.delattr(discovery, "entry_points")
    assert find_bridges() == known


def test_a_bridge_that_cannot_be_imported_disturbs_no_other(
    registry: dict[str, type[Bridge]], package: Path
) -> None:
    with pytest.raises(BridgeError) as error:
        open_bridge("test-bad")
    assert str(error.value) == (
        "The bridge `test-bad` of the package robots-for-all cannot be loaded:"
        " ModuleNotFoundError: No module named 'a_library_that_is_not_installed'"
    )
    with pytest.raises(BridgeError, match=r"`robots_for_all:nothing` .* is not a subclass of Bridge"):
        open_bridge("test-none")
    assert open_bridge("test-good").is_open


def test_a_definition_in_the_notebook_wins_over_a_packages(
    registry: dict[str, type[Bridge]], package: Path
) -> None:
    class Better(Bridge):
        name = "test-good"

        def open_interface(self) -> None:
            """Nothing."""

    assert find_bridges()["test-good"].load() is Better


def test_options_go_to_the_bridge_and_unknown_ones_are_refused() -> None:
    bridge = open_bridge("sim", world="empty", seed=3)
    assert bridge.robot.light.data == 255
    with pytest.raises(BridgeError, match=r"`sim` has no option `wrold`; it takes .* Did you mean `world`\?"):
        make_bridge("sim", wrold="line")
    with pytest.raises(BridgeError, match="`none` has no option `host`; it takes no options"):
        make_bridge("none", host="10.0.0.7")


def test_a_class_an_object_and_nothing_are_used_as_they_are() -> None:
    assert isinstance(make_bridge(), NullBridge)
    assert isinstance(make_bridge(NullBridge), NullBridge)
    bridge = NullBridge()
    assert make_bridge(bridge) is bridge
    with pytest.raises(BridgeError, match="exists already"):
        make_bridge(bridge, world="line")


# -- a bridge in a Python file --------------------------------------------------------------------

MINE = """
from __future__ import annotations
from dataclasses import dataclass
from typing import ClassVar
from lrp_jupyter import Bridge

@dataclass
class Pose:
    x: float
    count: ClassVar[int] = 0

class Mine(Bridge):
    name = "test-mine"

    def __init__(self, depth: int = 3):
        self.depth = depth

    def open_interface(self):
        self.add_variable("depth", lambda: self.depth, "below the surface", "m")
"""


def test_a_python_file_can_be_named_in_the_place_of_a_bridge(registry: object, tmp_path: Path) -> None:
    file = tmp_path / "mine.py"
    file.write_text(MINE)
    assert choose_bridge(str(file)) == "test-mine"
    bridge = open_bridge(str(file), depth=4)
    assert bridge.robot.depth == 4
    bridge.close()


def test_a_file_that_was_changed_is_run_again(registry: object, tmp_path: Path) -> None:
    file = tmp_path / "mine.py"
    file.write_text(MINE)
    assert make_bridge(str(file)).depth == 3  # type: ignore[attr-defined]
    file.write_text(MINE.replace("depth: int = 3", "depth: int = 5"))
    assert make_bridge(str(file)).depth == 5  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("x = 1", "defines no bridge. Write a subclass of `Bridge` in it."),
        (
            "from lrp_jupyter import Bridge\nclass Half(Bridge): pass",
            "`Half` lacks `open_interface`, which every bridge needs.",
        ),
        ("import sys\nsys.exit(0)", "line 2: SystemExit: 0."),
        ("import nothing_of_that_name", "line 1: ModuleNotFoundError: No module named"),
        ("x = 1\ny = (", "line 2: SyntaxError"),
    ],
)
def test_a_file_without_a_usable_bridge_is_told_in_a_sentence(
    registry: object, tmp_path: Path, text: str, sentence: str
) -> None:
    file = tmp_path / "mine.py"
    file.write_text(text)
    with pytest.raises(LRPError) as raised:
        choose_bridge(str(file))
    assert "mine.py" in str(raised.value)
    assert sentence in str(raised.value)


@pytest.mark.parametrize(
    ("text", "name"),
    [
        (MINE + "class Other(Mine): name = 'test-other'\n", "test-other"),
        (MINE + "class Half(Bridge): pass\n", "test-mine"),
        (
            MINE.replace("(Bridge)", "(Base)").replace("@dataclass", "class Base(Bridge): pass\n@dataclass"),
            "test-mine",
        ),
        ("from lrp_jupyter.bridges.sim import SimBridge\n", "sim"),
        (MINE + "from lrp_jupyter.bridges.sim import SimBridge\n", "test-mine"),
    ],
)
def test_of_several_bridges_the_last_that_is_defined_counts_and_else_an_imported_one_each_time(
    registry: object, tmp_path: Path, text: str, name: str
) -> None:
    file = tmp_path / "mine.py"
    file.write_text(text)
    assert [choose_bridge(str(file)), choose_bridge(str(file))] == [name, name]


def test_a_file_that_is_not_there_is_told_with_its_name(tmp_path: Path) -> None:
    with pytest.raises(LRPError, match=r"`.*other\.py` cannot be read: No such file"):
        choose_bridge(str(tmp_path / "other.py"))


@pytest.mark.slow
def test_what_a_file_defines_can_be_sent_to_another_process(registry: object, tmp_path: Path) -> None:
    file = tmp_path / "mine.py"
    file.write_text(MINE)
    sent = cloudpickle.dumps(type(make_bridge(str(file))))
    receive = "import pickle, sys; print(pickle.load(sys.stdin.buffer)(depth=8).depth)"
    received = subprocess.run([sys.executable, "-c", receive], input=sent, capture_output=True)
    assert received.stdout == b"8\n", received.stderr.decode()


def test_a_bridge_in_a_file_imports_what_is_beside_it(
    registry: object, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "path", [*sys.path])
    (tmp_path / "library_of_mine.py").write_text("DEPTH = 12\n")
    file = tmp_path / "mine.py"
    file.write_text(MINE.replace("depth: int = 3", "depth: int = library_of_mine.DEPTH"))
    file.write_text(file.read_text().replace("from lrp_jupyter", "import library_of_mine\nfrom lrp_jupyter"))
    assert make_bridge(str(file)).depth == 12  # type: ignore[attr-defined]
    del sys.modules["library_of_mine"]
