"""`lrp editor`: what an editor of one's own needs."""

import json
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree
from zipfile import ZipFile

import pytest
from typer.testing import CliRunner

from lrp_jupyter.cli.command_line import app
from lrp_jupyter.editors.setting_up import EDITORS


def lrp(*arguments):
    return CliRunner().invoke(app, list(map(str, arguments)))


@pytest.mark.slow
def test_the_package_for_vscode_holds_all_that_it_names_and_starts_this_lrp(tmp_path):
    done = lrp("editor", "vscode", tmp_path / "new")
    assert done.exit_code == 0
    assert f"code --install-extension {tmp_path}/new/lrp.vsix" in done.stdout
    with ZipFile(tmp_path / "new/lrp.vsix") as archive:
        names = archive.namelist()
        about = json.loads(archive.read("extension/package.json"))
        manifest = ElementTree.fromstring(archive.read("extension.vsixmanifest"))
        types = ElementTree.fromstring(archive.read("[Content_Types].xml"))
    (language,), (grammar,) = about["contributes"]["languages"], about["contributes"]["grammars"]
    wanted = [about["main"], language["configuration"], language["icon"]["light"], grammar["path"]]
    assert {f"extension/{each.removeprefix('./')}" for each in wanted} <= set(names)
    identity = manifest.find(".//{*}Identity").attrib
    assert (identity["Id"], identity["Version"]) == (about["name"], about["version"])
    assert {each.attrib["Extension"] for each in types} >= {Path(each).suffix for each in names} - {".xml"}
    (command,) = about["contributes"]["configuration"]["properties"]["lrp.command"]["default"]
    assert "Usage: lrp" in subprocess.run([command, "--help"], capture_output=True, text=True).stdout


def test_a_package_is_written_again_and_the_same(tmp_path):
    lrp("editor", "vscode", tmp_path)
    before = (tmp_path / "lrp.vsix").read_bytes()
    assert lrp("editor", "vscode", tmp_path).exit_code == 0
    assert (tmp_path / "lrp.vsix").read_bytes() == before


@pytest.mark.parametrize(("name", "file"), [("neovim", "lrp.lua"), ("helix", "languages.toml")])
def test_settings_start_this_lrp_and_never_replace_others(tmp_path, name, file):
    assert lrp("editor", name, tmp_path).exit_code == 0
    command = Path(sys.executable).with_name("lrp")
    assert json.dumps(str(command)) in (tmp_path / file).read_text()
    (tmp_path / file).write_text("mine")
    refused = lrp("editor", name, tmp_path)
    assert (refused.exit_code, (tmp_path / file).read_text()) == (2, "mine")
    assert "exists" in refused.stderr
    EDITORS[name].write(tmp_path / "other", "/home/zoë/🤖/lrp")  # which JSON may escape, but not Lua
    assert '"/home/zoë/🤖/lrp"' in (tmp_path / "other").read_text("utf-8")
