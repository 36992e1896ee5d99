"""The wheel: JupyterLab's extension is where Jupyter looks for it, and is removed with the package."""

import csv
import io
import json
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "js/labextension"
INSTALLED = ".data/data/share/jupyter/labextensions/lrp-jupyter/"


@pytest.mark.parametrize("kind", ["standard", "editable"])
def test_the_extension_of_jupyterlab_is_installed_with_the_package(tmp_path: Path, kind: str) -> None:
    builder = pytest.importorskip("hatchling.builders.wheel").WheelBuilder(str(ROOT))
    (wheel,) = builder.build(directory=str(tmp_path), versions=[kind])
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
        shared = {name.partition(INSTALLED)[2]: name for name in names if INSTALLED in name}
        files = {file.relative_to(SOURCE).as_posix() for file in SOURCE.rglob("*") if file.is_file()}
        assert set(shared) == files
        about = json.loads(archive.read(shared["package.json"]))
        assert about["jupyterlab"]["_build"]["load"] in files
        assert (
            json.loads(archive.read(shared["install.json"]))["packageName"] == about["name"] == "lrp-jupyter"
        )
        record = archive.read(next(name for name in names if name.endswith("RECORD"))).decode()
        assert {*shared.values()} <= {row[0] for row in csv.reader(io.StringIO(record))}  # what pip removes
    assert not [name for name in names if name.startswith("js/")]
