"""The Dockerfile: what it copies and runs, run here in a clean environment instead of a container."""

import json
import os
import re
import shutil
import subprocess
import venv
from pathlib import Path
from string import Template
from urllib.request import urlopen

import pytest
from support.ports import free_port
from support.waiting import until

from lrp_jupyter.cli.lab_command import FIRST

ROOT = Path(__file__).parents[2]
DOCKERFILE = ROOT / ".binder" / "Dockerfile"
pytestmark = pytest.mark.skipif(os.name == "nt", reason="the image is one of Linux")


def instructions():
    """Return the instructions of the Dockerfile: each a word and its arguments."""
    lines = [line for line in DOCKERFILE.read_text().splitlines() if line and not line.startswith("#")]
    assert not [line for line in lines if line.endswith("\\")], "this test reads one line at a time"
    return [tuple(line.split(maxsplit=1)) for line in lines]


class Container:
    """What an image would be, in a folder: its own environment, directories and Python."""

    def __init__(self, folder):
        self.root, self.here = folder / "root", folder / "root"
        self.variables, self.values = dict(os.environ), {}
        venv.create(folder / "python", with_pip=True)
        self.variables["PATH"] = f"{folder / 'python' / 'bin'}{os.pathsep}{os.defpath}"
        for name in [name for name in self.variables if name.startswith(("JUPYTER", "PYTHON", "XDG", "LRP"))]:
            del self.variables[name]
        self.variables["PIP_NO_COMPILE"] = "1"  # most of it is never imported

    def inside(self, path):
        """Return where an absolute path of the image, or one from the working directory, is."""
        return self.root / path.lstrip("/") if path.startswith("/") else self.here / path

    def expanded(self, text):
        return Template(text).substitute(self.values)

    def do(self, word, arguments):
        match word:
            case "ARG" | "ENV":
                name, value = self.expanded(arguments).split("=")
                self.values[name] = value
                if word == "ENV":
                    self.variables[name] = str(self.inside(value)) if value.startswith("/") else value
            case "WORKDIR":
                self.here = self.inside(self.expanded(arguments))
                self.here.mkdir(parents=True, exist_ok=True)
            case "COPY":
                *sources, target = self.expanded(arguments).split()
                for source in sources:
                    if (ROOT / source).is_dir():
                        shutil.copytree(ROOT / source, self.inside(target))
                    else:
                        shutil.copy(ROOT / source, self.inside(target))
            case "RUN" if arguments.startswith("useradd"):
                assert "--uid ${NB_UID} ${NB_USER}" in arguments  # only root can
            case "RUN":
                subprocess.run(arguments, shell=True, cwd=self.here, env=self.variables, check=True)
            case "CMD":
                self.command = json.loads(arguments)
            case _:
                assert word in ("FROM", "USER", "EXPOSE"), f"this test does not know {word}"


def test_the_base_is_pinned_and_binders_user_runs_it():
    words = instructions()
    [base] = [arguments for word, arguments in words if word == "FROM"]
    assert re.fullmatch(r"docker\.io/library/python:3\.\d+-slim-\w+", base)
    arguments = dict(rest.split("=") for word, rest in words if word == "ARG")
    assert arguments == {"NB_USER": "jovyan", "NB_UID": "1000"}
    assert [rest for word, rest in words if word == "USER"] == ["${NB_USER}"]
    assert "ENTRYPOINT" not in dict(words), "Binder starts a command of its own"


@pytest.mark.slow
def test_what_the_image_is_made_of_opens_the_first_notebook(tmp_path):
    container = Container(tmp_path)
    for word, arguments in instructions():
        container.do(word, arguments)
    assert (container.here / FIRST).is_file()
    run = {"cwd": container.here, "env": container.variables}
    subprocess.run(["jupyter", "notebook", "--version"], check=True, stdout=subprocess.DEVNULL, **run)

    port = free_port()
    command = [
        each.replace("0.0.0.0", "127.0.0.1") for each in container.command
    ]  # this machine's, not a container's
    container.variables |= {"JUPYTER_PORT": str(port), "JUPYTER_TOKEN": "t"}
    with (tmp_path / "log").open("w") as log:
        server = subprocess.Popen(command, stdout=log, stderr=log, **run)
        try:
            url = f"http://127.0.0.1:{port}/?token=t"
            there = until(lambda: opened(url) or server.poll() is not None, "the server does not answer")
            assert str(there).endswith(f"/tree/{FIRST}?token=t"), "the server has ended"
            with urlopen(f"http://127.0.0.1:{port}/api/contents/{FIRST}?token=t", timeout=120) as answer:
                assert json.load(answer)["type"] == "notebook"
        finally:
            server.terminate()
            server.wait(120)


def opened(url):
    """Return the address that a server redirects to, or an empty text while there is none."""
    try:
        with urlopen(url, timeout=30) as answer:
            return answer.url
    except OSError:
        return ""
