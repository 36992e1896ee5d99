"""Options of bridges: texts of the command line, read as the constructor's annotations say."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import pytest

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.discovery import make_bridge
from lrp_jupyter.bridges.options import options_of
from lrp_jupyter.errors import BridgeError

if TYPE_CHECKING:
    from decimal import Decimal


class Gear(Enum):
    """How fast."""

    LOW = 1
    HIGH = "high"


class Typed(Bridge):
    """A bridge with an option of every type.

    More about it.

    Parameters
    ----------
    port : int
        Of the robot. It is printed on it.
    gain, trim : float
        Factor of all speeds,
        and the offset.
    log : Path, optional

    Attributes
    ----------
    taken : dict
        Everything.
    """

    name = "test-typed"

    def __init__(
        self,
        port: int,
        gain: float = 1.0,
        trim: float | None = None,
        loud: bool = False,
        log: Path | None = None,
        side: Literal["left", "right"] = "left",
        gear: Gear = Gear.LOW,
        sensor: int | str | None = None,
        table: Mapping[str, float] | None = None,
        name: str = "",
        speed=3,  # type: ignore[no-untyped-def]
    ) -> None:
        self.taken = {key: value for key, value in locals().items() if key not in ("self", "__class__")}

    def open_interface(self) -> None:
        """Connect nothing."""


@pytest.fixture(autouse=True)
def registry() -> Iterator[None]:
    known = dict(Bridge.registry)
    yield
    Bridge.registry.clear()
    Bridge.registry.update(known)


def taken(**options: object) -> dict[str, Any]:
    return make_bridge(Typed, **{"port": 1, **options}).taken  # type: ignore[attr-defined, no-any-return]


@pytest.mark.parametrize(
    ("name", "text", "value"),
    [
        ("port", "7", 7),
        ("gain", "0.5", 0.5),
        ("gain", "2", 2.0),
        ("trim", "-1e-3", -0.001),
        ("trim", "None", None),
        ("loud", "yes", True),
        ("loud", "False", False),
        ("log", "run/a.log", Path("run/a.log")),
        ("side", "right", "right"),
        ("gear", "high", Gear.HIGH),
        ("gear", "LOW", Gear.LOW),
        ("gear", "1", Gear.LOW),
        ("sensor", "3", 3),
        ("sensor", "none", "none"),
        ("sensor", "front", "front"),
        ("table", "{}", "{}"),
        ("name", "8", "8"),
        ("speed", "4", 4),
        ("speed", "0.5", 0.5),
    ],
)
def test_a_text_is_read_as_the_annotation_says(name: str, text: str, value: object) -> None:
    read = taken(**{name: text})[name]
    assert (read, type(read)) == (value, type(value))


def test_a_value_that_is_no_text_is_not_touched() -> None:
    table = {"a": 1.0}
    assert taken(port=2.5, table=table, log=None)["table"] is table


@pytest.mark.parametrize(
    ("name", "text", "sentence"),
    [
        ("port", "fast", "`port` takes a whole number, not `fast`."),
        ("port", "1.5", "`port` takes a whole number, not `1.5`."),
        ("gain", "nan", "`gain` takes a number, not `nan`."),
        ("trim", "", "`trim` takes a number, not ``."),
        ("loud", "maybe", "`loud` takes `true` or `false`, not `maybe`."),
        ("side", "rihgt", "`side` takes `left` or `right`, not `rihgt`. Did you mean `right`?"),
        ("gear", "hihg", "`gear` takes `1`, `high`, `LOW` or `HIGH`, not `hihg`. Did you mean `high`?"),
        ("speed", "quick", "`speed` takes a number, not `quick`."),
    ],
)
def test_a_wrong_text_is_refused_with_its_option_and_type(name: str, text: str, sentence: str) -> None:
    with pytest.raises(BridgeError) as error:
        taken(**{name: text})
    assert str(error.value) == f"The bridge `test-typed`: {sentence}"


def test_an_unknown_and_a_missing_option_are_named() -> None:
    with pytest.raises(BridgeError, match=r"has no option `gian`; it takes `port`, .*Did you mean `gain`\?"):
        taken(gian="1")
    with pytest.raises(
        BridgeError, match=r"^The bridge `test-typed` needs the option `port`: a whole number\.$"
    ):
        make_bridge(Typed)


def test_options_are_described_by_annotation_default_and_docstring() -> None:
    options = options_of(Typed)
    assert options is not None
    assert options["port"].is_needed
    assert (options["port"].words, options["port"].doc) == ("a whole number", "Of the robot.")
    assert (options["trim"].words, options["trim"].default) == ("a number", None)
    assert options["trim"].doc == "Factor of all speeds, and the offset."
    assert (options["log"].words, options["log"].doc) == ("a path", "")
    assert options["sensor"].words == "a whole number or a text"
    assert "taken" not in options


def test_an_annotation_that_only_a_type_checker_can_read_leaves_the_default_value_to_say_it() -> None:
    class Checked(Bridge):
        name = "test-checked"

        def __init__(self, amount: Decimal | None = None, port: int = 1) -> None:
            self.taken = (amount, port)

        def open_interface(self) -> None:
            """Connect nothing."""

    assert make_bridge(Checked, amount="1", port="2").taken == ("1", 2)  # type: ignore[attr-defined]


def test_a_bridge_without_a_constructor_takes_none_and_one_may_take_any() -> None:
    class Plain(Bridge):
        name = "test-plain"

        def open_interface(self) -> None:
            """Connect nothing."""

    class Free(Plain):
        name = "test-free"

        def __init__(self, *parts: object, **options: object) -> None:
            self.taken = options

    assert options_of(Plain) == {}
    assert options_of(Free) is None
    assert make_bridge(Free, port="7").taken == {"port": "7"}  # type: ignore[attr-defined]
