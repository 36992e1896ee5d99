# ruff: noqa: T201  (it is a command)
"""Take screenshots of the lab without a kernel, in all the cases that matter.

``python js/tests/page/look.py OUTDIR [CASE …]``
"""

from __future__ import annotations

import functools
import http.server
import shutil
import sys
import threading
from pathlib import Path

from playwright.sync_api import Page, sync_playwright

ROOT = Path(__file__).parents[3]
ARGUMENTS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
]
CASES = ("plain", "issues", "runs", "lost", "empty", "hold")


class _Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_: object) -> None: ...


def main(out: Path, cases: tuple[str, ...]) -> None:
    """Take a screenshot of each case, light and dark, narrow and wide."""
    out.mkdir(parents=True, exist_ok=True)
    handler = functools.partial(_Quiet, directory=str(ROOT))
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=shutil.which("chromium-headless-shell") or shutil.which("chromium"),
            args=ARGUMENTS,
        )
        for case in cases:
            for theme in ("light", "dark"):
                for width in (700, 1600):
                    page = browser.new_page(
                        viewport={"width": width, "height": 1000 if width > 1000 else 1500}
                    )
                    page.on("console", lambda message: print("console:", message.text))
                    page.on("pageerror", lambda error: print("ERROR:", error, (error.stack or "")[:600]))
                    page.goto(
                        f"http://127.0.0.1:{server.server_port}/js/tests/page/?theme={theme}&case={case}"
                    )
                    page.wait_for_timeout(4000 if case == "lost" else 2500)
                    prepare(page, case)
                    page.screenshot(path=out / f"{case}-{theme}-{width}.png")
                    page.close()
        browser.close()


def prepare(page: Page, case: str) -> None:
    """Prepare the page for the screenshot."""
    if case == "runs":
        page.locator('[data-lrp-tab="runs"]').click()
        page.locator('[data-lrp-action="coverage"]').click()
    if case == "hold":
        page.locator(".cm-content").click()
        page.keyboard.type(" ")
        page.wait_for_timeout(300)


if __name__ == "__main__":
    main(Path(sys.argv[1]), tuple(sys.argv[2:]) or CASES)
