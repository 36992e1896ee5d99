"""The arguments of a node, as roslaunch and ``ros2 launch`` append them, read as options of the bridge.

ROS 1 has ``__name:=behaviour __log:=/a/file cmd_vel:=/base/cmd_vel``, and ROS 2, from ``--ros-args`` up to
``--``, ``-r __node:=behaviour -r cmd_vel:=/base/cmd_vel -p use_sim_time:=true --params-file /a/file``. A
parameter of the node is an option of the bridge: ``_setup:=robot.json``, or ``-p setup:=robot.json``, is
``-o setup=robot.json``.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

from lrp_jupyter.errors import BridgeError, did_you_mean

_BEGIN, _END = "--ros-args", "--"
_RULE = re.compile(r"(?:(?P<node>[\w/*]+):)?(?P<name>[\w~/]+):=(?P<value>.*)", re.ASCII | re.DOTALL)
_NAMES: Mapping[str, str] = {"__name": "node", "__node": "node", "__ns": "namespace", "__master": "host"}
_TAKERS: Mapping[str, str] = {  # arguments that another one follows, and what that is
    **dict.fromkeys(("-r", "--remap"), "a rule `from:=to`"),
    **dict.fromkeys(("-p", "--param"), "a parameter `name:=value`"),
    "--params-file": "a file",
    "--log-level": "a level",
    "--log-config-file": "a file",
}
_FLAGS = {
    f"--{how}-{log}-logs" for how in ("enable", "disable") for log in ("rosout", "stdout", "external-lib")
}


class _Given(NamedTuple):
    """An option, where it was given, and for which node; a remapping rule has no name."""

    place: str
    node: str
    option: str
    value: str


def split_arguments(arguments: Sequence[str]) -> tuple[list[str], list[str]]:
    """Return the arguments that are not for ROS, and those that are."""
    own: list[str] = []
    ros: list[str] = []
    inside = False
    for argument in arguments:
        begins = argument == _BEGIN
        (ros if inside or begins or _RULE.fullmatch(argument) else own).append(argument)
        inside = begins or (inside and argument != _END)
    return own, ros


def bridge_options(arguments: Sequence[str], known: Collection[str]) -> dict[str, str]:
    """Return the options of the bridge that arguments for ROS are; what is for another node is left out.

    Raises BridgeError: an option is none of the `known` ones, or an argument is malformed.
    """
    given = [*_read(arguments)]
    found = {each.option: each.value for each in given if each.option == "node"}
    rules = []
    for place, node, option, value in given:
        if node not in ("", "/**", "**") and node.rpartition("/")[2] != found.get("node"):
            continue
        if not option:
            rules.append(value)
        elif option not in known:
            raise BridgeError(
                f"`{place}`: The bridge `ros` has no option `{option}`.{did_you_mean(option, known)}"
            )
        else:
            found[option] = value
    return found | ({"remap": " ".join(rules)} if rules else {})


def _read(arguments: Sequence[str]) -> Iterator[_Given]:
    remaining, inside = iter(arguments), False
    for argument in remaining:
        if argument in (_BEGIN, _END):
            inside = argument == _BEGIN
        elif not inside:
            yield from _rule(argument, argument)
        elif what := _TAKERS.get(argument):
            value = next(remaining, "")
            place = f"{argument} {value}".strip()
            if not value:
                raise BridgeError(f"`{place}`: After it comes {what}.")
            if what.startswith("a rule"):
                yield from _rule(value, place)
            elif what.startswith("a parameter"):
                yield _parameter(_parsed(value, place, what))
            elif argument == "--params-file":
                yield from _file(Path(value), place)
        elif argument not in _FLAGS:
            hint = did_you_mean(argument, (*_TAKERS, *_FLAGS))
            raise BridgeError(f"`{_BEGIN} {argument}`: There is no such argument.{hint}")


def _parsed(text: str, place: str, what: str) -> _Given:
    match = _RULE.fullmatch(text)
    if match is None:
        raise BridgeError(f"`{place}`: Write {what}.")
    return _Given(place, match["node"] or "", match["name"], match["value"])


def _rule(text: str, place: str) -> Iterator[_Given]:
    given = _parsed(text, place, _TAKERS["-r"])
    name = given.option
    if name in _NAMES:
        yield given._replace(option=_NAMES[name])
    elif name.startswith("__"):
        if name != "__log":
            hint = did_you_mean(name, _NAMES)
            raise BridgeError(f"`{place}`: A node of this package has no `{name}`.{hint}")
    elif name.startswith("_"):
        yield _parameter(given._replace(option=name[1:]))
    else:
        yield given._replace(option="", value=f"{name}:={given.value}")


def _parameter(given: _Given) -> _Given:
    name = "sim_time" if given.option == "use_sim_time" else given.option
    return given._replace(option=name, value=given.value.removesuffix("\n...\n").strip())  # as YAML writes it


def _file(path: Path, place: str) -> Iterator[_Given]:
    """Read a file of parameters."""
    try:
        yaml: Any = import_module("yaml")
    except ImportError:
        raise BridgeError(
            f"`{place}`: Reading it needs PyYAML. Install it with `pip install pyyaml`."
        ) from None
    try:
        read = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, yaml.YAMLError) as error:
        why = " ".join((getattr(error, "strerror", "") or str(error)).split())
        raise BridgeError(f"`{place}`: The file cannot be read: {why}.") from None
    for node, name, value in _leaves(read, place):
        if not isinstance(value, (str, int, float)):
            raise BridgeError(f"`{place}`: `{name}` is not a text, a number or a truth value.")
        text = str(value).lower() if isinstance(value, bool) else str(value)
        yield _parameter(_Given(f"{place}, {name}", node, name, text))


def _leaves(tree: object, place: str, node: str = "") -> Iterator[tuple[str, str, object]]:
    """Find the parameters in a file, each with its node, its name and its value."""
    if not isinstance(tree, Mapping):
        raise BridgeError(
            f"`{place}`: Below the name of a node comes `ros__parameters`, then names and values."
        )
    for key, below in tree.items():
        if key == "ros__parameters" and isinstance(below, Mapping):
            yield from ((node, str(name), value) for name, value in below.items())
        else:
            yield from _leaves(below, place, f"{node}/{str(key).strip('/')}")
