"""What axe-core has against a lab."""

import json
import os
from pathlib import Path

import pytest

AXE = Path(__file__).parents[2] / "js" / "node_modules" / "axe-core" / "axe.min.js"


def finds_nothing_serious(lab):
    """Assert it; skip on a person's machine that lacks axe-core."""
    if not AXE.exists() and not os.environ.get("CI"):
        pytest.skip("axe-core is not installed: `npm install` in js")
    if not lab.page.evaluate("'axe' in window"):
        lab.page.evaluate(AXE.read_text())
    found = lab.root.evaluate(
        "async root => (await axe.run(root, { resultTypes: ['violations'] })).violations"
        ".filter(({ impact }) => impact === 'serious' || impact === 'critical')"
        ".map(({ id, nodes }) => [id, nodes.map(({ target, failureSummary }) => [target, failureSummary])])"
    )
    assert found == [], json.dumps(found, indent=1)


def choose_theme(lab, theme):
    """Choose JupyterLab's light or dark theme, and wait until the lab has it."""
    lab.notebook.command("apputils:change-theme", theme=f"JupyterLab {theme.title()}")
    lab.sees(f':scope[data-theme="{theme}"]')
