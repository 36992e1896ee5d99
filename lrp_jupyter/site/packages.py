"""The packages of a site: wheels for a Python in a browser, this package's among them, and Pyodide's list.

What Pyodide itself publishes keeps the version that it has there: pure Python comes from the package index,
compiled packages from Pyodide's distribution. Of everything else, the package index has the newest version.
"""

from __future__ import annotations

import hashlib
import json
import shutil
import subprocess
import zipfile
from base64 import urlsafe_b64encode
from collections.abc import Iterable, Mapping
from email.parser import Parser
from importlib.metadata import distribution
from pathlib import Path
from typing import Any

from lrp_jupyter.errors import LRPError
from lrp_jupyter.process import python_of
from lrp_jupyter.site.runtime import LOCK, Pyodide

_LEFT_OUT = ("cli/", "notebooks/", "served/", "site/", "static/served/", "static/site/")
"""What a browser has no use for: the command line, the notebooks, and what a site is built from."""
_PURE = "-none-any.whl"
_TAGS = ("--platform", "pyemscripten_2026_0_wasm32", "--python-version", "3.14", "--implementation", "cp")


def collect(
    pyodide: Pyodide, wheels: Iterable[Path], names: Iterable[str], folder: Path, offline: bool
) -> None:
    """Put wheels, the packages of these names, and all that they need, into a folder with the list of them.

    `wheels`: wheels that no package index has.
    `offline`: whether the packages that Pyodide publishes are copied, too; otherwise browsers load them from
        there.
    Raises LRPError: a package cannot be downloaded.
    """
    from packaging.utils import canonicalize_name as canonical

    known: dict[str, Any] = json.loads(pyodide.read(LOCK))
    published: dict[str, Any] = {canonical(name): package for name, package in known["packages"].items()}
    environment = _environment(known["info"])
    found: dict[str, dict[str, Any]] = {}
    needed: dict[str, str] = {canonical(name): "" for name in names}
    arrived = [Path(shutil.copyfile(wheel, folder / wheel.name)) for wheel in wheels]
    while True:
        for wheel in arrived:
            package, requirements = _described(wheel, environment)
            found[canonical(package["name"])] = package
            needed |= requirements
        missing = [name for name in needed if name not in found]
        if not missing:
            break
        arrived, on_index = [], list[str]()
        for name in missing:
            known_one = published.get(name)
            if known_one is None:
                on_index.append(name + needed[name])
            elif not offline:
                found[name] = {**known_one, "file_name": pyodide.url + known_one["file_name"]}
                for other in known_one["depends"]:
                    needed.setdefault(canonical(other), "")
            elif known_one["file_name"].endswith(_PURE):
                on_index.append(f"{name}=={known_one['version']}")
            else:
                arrived.append(folder / known_one["file_name"])
                arrived[-1].write_bytes(pyodide.read(known_one["file_name"], known_one["sha256"]))
        arrived += _download(on_index, folder)
    text = json.dumps({"info": known["info"], "packages": dict(sorted(found.items()))}, indent=1)
    (folder / LOCK).write_text(text, encoding="utf-8")


def _environment(info: Mapping[str, str]) -> dict[str, str]:
    """Return what the markers of requirements are compared with."""
    return {
        "implementation_name": "cpython",
        "implementation_version": info["python"],
        "os_name": "posix",
        "platform_machine": info["arch"],
        "platform_python_implementation": "CPython",
        "platform_release": "",
        "platform_system": "Emscripten",
        "platform_version": "",
        "python_full_version": info["python"],
        "python_version": info["python"].rpartition(".")[0],
        "sys_platform": "emscripten",
        "extra": "",
    }


def _described(wheel: Path, environment: dict[str, str]) -> tuple[dict[str, Any], dict[str, str]]:
    """Return the entry of a wheel in the list, and the versions of what it needs, by name."""
    from packaging.requirements import Requirement
    from packaging.utils import canonicalize_name as canonical

    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
        metadata = next(name for name in names if name.endswith(".dist-info/METADATA"))
        about = Parser().parsestr(archive.read(metadata).decode())
    modules = {name.partition("/")[0].partition(".")[0] for name in names if ".dist-info/" not in name}
    needed: dict[str, str] = {
        canonical(each.name): str(each.specifier)
        for each in map(Requirement, about.get_all("Requires-Dist", []))
        if each.marker is None or each.marker.evaluate(environment)
    }
    return {
        "name": about["Name"],
        "version": about["Version"],
        "file_name": wheel.name,
        "install_dir": "site",
        "sha256": hashlib.sha256(wheel.read_bytes()).hexdigest(),
        "package_type": "package",
        "imports": sorted(name for name in modules if name.isidentifier()),
        "depends": sorted(needed),
        "unvendored_tests": False,
    }, needed


def _download(requirements: list[str], folder: Path) -> list[Path]:
    """Download packages of the package index that a browser can run; return their wheels."""
    if not requirements:
        return []
    before = set(folder.glob("*.whl"))
    options = ["--quiet", "--no-deps", "--only-binary", ":all:", "--disable-pip-version-check", *_TAGS]
    pip = python_of("pip", "download", *options, "--dest", str(folder), *requirements)
    done = subprocess.run(**pip, capture_output=True, text=True, check=False)
    if done.returncode:
        errors = [line for line in done.stderr.splitlines() if "ERROR" in line or "No module" in line]
        why = (errors or done.stderr.splitlines() or ["pip failed."])[-1]
        raise LRPError(f"{', '.join(requirements)}: the packages cannot be downloaded. {why}")
    return sorted(set(folder.glob("*.whl")) - before)


def pack(folder: Path) -> Path:
    """Pack this package, as it is installed here, into a wheel; the same package gives the same bytes."""
    installed = distribution("lrp-jupyter")
    package = Path(__file__).parents[1]
    files = {
        f"lrp_jupyter/{name}": file.read_bytes()
        for file in sorted(package.rglob("*"))
        if file.is_file()
        and not (name := file.relative_to(package).as_posix()).startswith(_LEFT_OUT)
        and "__pycache__" not in file.parts
    }
    info = f"lrp_jupyter-{installed.version}.dist-info"
    for name in ("METADATA", "entry_points.txt"):
        files[f"{info}/{name}"] = (installed.read_text(name) or "").encode()
    files[f"{info}/WHEEL"] = (
        b"Wheel-Version: 1.0\nGenerator: lrp site\nRoot-Is-Purelib: true\nTag: py3-none-any\n"
    )
    record = "".join(f"{name},{_digest(content)},{len(content)}\n" for name, content in files.items())
    files[f"{info}/RECORD"] = f"{record}{info}/RECORD,,\n".encode()
    wheel = folder / f"lrp_jupyter-{installed.version}-py3-none-any.whl"
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name), content, zipfile.ZIP_DEFLATED)
    return wheel


def _digest(content: bytes) -> str:
    return "sha256=" + urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
