"""A wheel of the package as it is installed here, for a Python in a browser."""

from __future__ import annotations

import hashlib
import zipfile
from base64 import urlsafe_b64encode
from importlib.metadata import distribution
from pathlib import Path

_LEFT_OUT = ("cli/", "notebooks/", "site/", "static/site/")
"""What a browser has no use for: the command line, the notebooks, and what a site is built from."""


def pack(folder: Path) -> Path:
    """Write the wheel to a folder, and return its path; the same package gives the same bytes."""
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
