"""The bundled follower, unchanged, drives a ROS robot: there and back on the course of the paper."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from bridges.ros.follower import LOOSE, SETUP, TOLD, go_there_and_back

from lrp_jupyter.bridges.ros import RosBridge


@pytest.mark.ros
def test_the_follower_goes_there_and_back(real: Any, connect: Callable[..., RosBridge]) -> None:
    real.start_robot(TOLD, "line")
    go_there_and_back(connect(setup=LOOSE))


def test_the_setup_of_the_follower_survives_saving(tmp_path: Path) -> None:
    ros = RosBridge(setup=SETUP)
    ros.save(tmp_path / "again.json")
    assert json.loads((tmp_path / "again.json").read_text()) == json.loads(SETUP.read_text())
