"""Certificates of this computer, for encrypted connections."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest


def own_certificate(folder: Path) -> tuple[Path, Path]:
    """Make a self-signed certificate, and its key."""
    names = (folder / "robot.pem", folder / "robot.key")
    key = ("-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-keyout", str(names[1]))
    command = ["openssl", "req", "-x509", *key, "-days", "2", "-subj", "/CN=robot", "-out", str(names[0])]
    command += ["-addext", "subjectAltName=IP:127.0.0.1"]
    try:
        subprocess.run(command, check=True, capture_output=True)
    except FileNotFoundError:
        pytest.skip("There is no openssl to make a certificate with.")
    return names
