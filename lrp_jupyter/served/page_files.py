"""The few files of the page, and the headers that go with every answer.

The page runs no script but its own, speaks only to this server, and is shown in no frame.
"""

from __future__ import annotations

import gzip
import hashlib
import re
from functools import cache
from http import HTTPStatus
from pathlib import Path

from websockets.datastructures import Headers
from websockets.http11 import Request, Response

_STATIC = Path(__file__).parents[1] / "static"
_FILES = {
    "/": ("served/index.html", "text/html"),
    "/served.js": ("served/served.js", "text/javascript"),
    "/lab.js": ("lab.js", "text/javascript"),
    "/lab.css": ("lab.css", "text/css"),
    "/page.css": ("site/page.css", "text/css"),
    "/served.css": ("served/served.css", "text/css"),
}
_SECURE = {
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
}


def secure(request: Request) -> dict[str, str]:
    """Return the headers of an answer; styles are made by the editor, so they need not be in a file."""
    hosts = request.headers.get_all("Host")
    is_plain = len(hosts) == 1 and re.fullmatch(r"[\w.:\[\]-]+", hosts[0], re.ASCII)
    sockets = f" ws://{hosts[0]} wss://{hosts[0]}" if is_plain else ""  # not `'self'` in older browsers
    policy = (
        f"default-src 'none'; script-src 'self'; connect-src 'self'{sockets}; "
        "style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; font-src data:; "
        "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    )
    return {"Content-Security-Policy": policy, **_SECURE}


def answer(request: Request) -> Response:
    """Return a file, that it is known, or that there is none."""
    found = _FILES.get(request.path.partition("?")[0])
    if found is None:
        return plain_answer(HTTPStatus.NOT_FOUND, "There is no such file.")
    packed, tag = _packed(found[0])
    headers = Headers(
        {
            "Cache-Control": "no-cache",
            "Connection": "close",
            "Content-Type": f"{found[1]}; charset=utf-8",
            "ETag": tag,
            "Vary": "Accept-Encoding",
        }
    )
    if request.headers.get_all("If-None-Match") == [tag]:
        return Response(HTTPStatus.NOT_MODIFIED, "Not Modified", headers)
    if "gzip" in ",".join(request.headers.get_all("Accept-Encoding")):
        headers["Content-Encoding"] = "gzip"
    else:
        packed = gzip.decompress(packed)
    headers["Content-Length"] = str(len(packed))
    return Response(HTTPStatus.OK, "OK", headers, packed)


def plain_answer(status: HTTPStatus, sentence: str) -> Response:
    """Return an answer in words."""
    body = f"{sentence}\n".encode()
    headers = {"Content-Type": "text/plain; charset=utf-8", "Content-Length": str(len(body))}
    return Response(status, status.phrase, Headers(headers | {"Connection": "close"}), body)


@cache
def _packed(name: str) -> tuple[bytes, str]:
    """Return a file, compressed, and what is another one whenever it has changed."""
    data = (_STATIC / name).read_bytes()
    return gzip.compress(data, mtime=0), f'"{hashlib.sha256(data).hexdigest()[:20]}"'
