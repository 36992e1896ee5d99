"""Pyodide's files for ``lrp site --offline --pyodide FOLDER``, without Pyodide's own distribution.

npm has the runtime, the package index has all packages but one: the wheel of cffi for Pyodide is in the
distribution alone. So its compiled part is built here, from cffi's source, by the clang of PyPI's
``ziglang``, with the headers that Debian has of the same Python. Nothing is installed.

``python tests/static_site/pyodide.py FOLDER`` makes such a folder by hand.
"""

import os
import shutil
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path
from tempfile import TemporaryDirectory

HERE = Path(__file__).parent
RUNTIME = HERE.parents[1] / "js/node_modules/pyodide"
ZIG, CFFI = "0.17.1", "2.0.0"
WHEEL = f"cffi-{CFFI}-cp314-cp314-pyemscripten_2026_0_wasm32.whl"
EXTENSION = "_cffi_backend.cpython-314-wasm32-emscripten.so"
HEADERS = ("libpython3.14-dev", "libffi-dev")
KEYRING = "/usr/share/keyrings/debian-archive-keyring.gpg"
SOURCES = f"deb [signed-by={KEYRING}] http://deb.debian.org/debian sid main\n"


class CannotCompileError(Exception):
    """What this machine lacks."""


def lacking():
    """Return what this machine lacks for a site, or an empty text."""
    return "" if (RUNTIME / "pyodide.mjs").is_file() else f"{RUNTIME} (`npm install` in js)"


def make(folder):
    """Make the folder; return why the simulator cannot run with it, or an empty text."""
    shutil.copytree(RUNTIME, folder, dirs_exist_ok=True)
    with TemporaryDirectory(prefix="lrp-cffi-") as work:
        try:
            files, reason = _compiled(Path(work)), ""
        except CannotCompileError as error:
            files, reason = {}, f"cffi cannot be compiled: {error}"
        _pack(files, folder / WHEEL)
    return reason


def _compiled(work):
    """Compile cffi, and return the files of its wheel by name."""
    for tool in ("apt-get", "dpkg-deb"):
        if shutil.which(tool) is None:
            raise CannotCompileError(f"there is no {tool}")
    pip = (sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check")
    _run(work, *pip, "install", "--target", "zig", f"ziglang=={ZIG}")
    _run(work, *pip, "download", "--no-deps", "--no-binary", "cffi", f"cffi=={CFFI}")
    headers = _headers(work)
    source = work / f"cffi-{CFFI}"
    with tarfile.open(f"{source}.tar.gz") as archive:
        archive.extractall(work, filter="data")
    libc = work / "zig/ziglang/lib"
    zig = (sys.executable, "-m", "ziglang")
    _run(
        work,
        *(*zig, "clang", "-target", "wasm32-unknown-emscripten", "-D__EMSCRIPTEN__"),
        *("-O2", "-fPIC", "-fvisibility=default", "-Wno-everything", "-DFFI_BUILDING=1", "-DNDEBUG"),
        *(
            "-nostdinc",
            f"-I{HERE / 'wasm32'}",
            f"-I{headers}",
            f"-I{headers / 'python3.14'}",
            f"-I{source}/src/c",
        ),
        *(
            "-isystem",
            libc / "libc/include/riscv32-linux-musl",
            "-isystem",
            libc / "libc/include/generic-musl",
        ),
        *("-isystem", libc / "include"),
        *("-c", source / "src/c/_cffi_backend.c", "-o", "backend.o"),
    )
    _run(
        work,
        *(*zig, "wasm-ld", "-shared", "--experimental-pic", "--import-memory", "--no-entry"),
        *("--unresolved-symbols=import-dynamic", "--export=PyInit__cffi_backend"),
        *("--export-if-defined=__wasm_call_ctors", "-o", EXTENSION, "backend.o"),
    )
    files = {f"cffi/{file.name}": file for file in sorted((source / "src/cffi").iterdir())}
    return {EXTENSION: work / EXTENSION, **files}


def _headers(work):
    """Unpack the headers from Debian's packages, without those that are written here; return their folder."""
    apt, lists = work / "apt", work / "apt/lists"
    for folder in (lists / "partial", apt / "cache/archives/partial"):
        folder.mkdir(parents=True)
    (apt / "sources.list").write_text(SOURCES)
    get = ["apt-get", "-qq", "-o", f"Dir::Etc::SourceList={apt / 'sources.list'}"]
    get += ["-o", "Dir::Etc::SourceParts=-", "-o", f"Dir::State::Lists={lists}"]
    get += ["-o", f"Dir::Cache={apt / 'cache'}", "-o", "APT::Sandbox::User=root"]
    get += ["-o", "Acquire::Languages=none"]
    _run(work, *get, "update")
    _run(work, *get, "download", *HEADERS)
    for package in work.glob("*.deb"):
        _run(work, "dpkg-deb", "-x", package, "unpacked")
    headers = work / "unpacked/usr/include"
    (headers / "python3.14/pyconfig.h").unlink(missing_ok=True)
    for ffi in headers.glob("x86_64-linux-gnu/ffi.h"):
        shutil.copy(ffi, headers)
    return headers


def _pack(files, wheel):
    info = f"cffi-{CFFI}.dist-info"
    tag = wheel.stem.removeprefix(f"cffi-{CFFI}-")
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, file in files.items():
            archive.write(file, name)
        archive.writestr(f"{info}/METADATA", f"Metadata-Version: 2.1\nName: cffi\nVersion: {CFFI}\n")
        archive.writestr(f"{info}/WHEEL", f"Wheel-Version: 1.0\nTag: {tag}\n")
        archive.writestr(f"{info}/RECORD", "")


def _run(work, *command):
    settings = {"PYTHONPATH": str(work / "zig"), "ZIG_GLOBAL_CACHE_DIR": str(work / "cache")}
    done = subprocess.run(
        [str(each) for each in command],
        cwd=work,
        env=os.environ | settings,
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        words = (done.stderr or done.stdout).strip().splitlines()
        raise CannotCompileError(f"`{' '.join(map(str, command[:4]))} …` failed: {' '.join(words[-3:])}")


if __name__ == "__main__":
    if reason := lacking() or make(Path(sys.argv[1])):
        sys.exit(reason)
