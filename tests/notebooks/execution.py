"""Executes notebooks as Restart & Run All does, and stores them with outputs that need no kernel.

Run as a script, ``python tests/notebooks/execution.py [NAME …]``, it executes the notebooks and stores
what came out: texts and pictures, no widgets.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from typing import Any

import nbformat
from nbclient import NotebookClient
from nbformat import NotebookNode
from stored import NOTEBOOKS, WIDGET, data_of, opened_program, paths

_LANGUAGE = {
    "name": "python",
    "file_extension": ".py",
    "mimetype": "text/x-python",
    "pygments_lexer": "ipython3",
}
_LATER = "import time, lrp_jupyter; time.sleep(4); lrp_jupyter.Lab({!r}).snapshot()"


class Execution(NotebookClient):
    """A kernel that runs the cells of a notebook, in a directory of its own."""

    def __init__(self, notebook: NotebookNode, here: str | Path) -> None:
        super().__init__(
            notebook,
            timeout=120,
            kernel_name="python3",
            record_timing=False,
            resources={"metadata": {"path": str(here)}},
        )

    def run_all(self) -> None:
        for index, cell in enumerate(list(self.nb.cells)):
            self.execute_cell(cell, index)

    def run_more(self, source: str) -> NotebookNode:
        """Run a cell that is not in the notebook."""
        cell = nbformat.v4.new_code_cell(source)
        self.nb.cells.append(cell)
        try:
            return self.execute_cell(cell, len(self.nb.cells) - 1, store_history=False)
        finally:
            self.nb.cells.remove(cell)


def store(path: Path) -> None:
    """Execute a notebook and store it with its outputs; a lab is shown after some seconds of driving."""
    notebook = nbformat.read(path, as_version=4)
    with tempfile.TemporaryDirectory() as here:
        execution = Execution(notebook, here)
        with execution.setup_kernel():
            for index, cell in enumerate(list(notebook.cells)):
                execution.execute_cell(cell, index)
                if cell.cell_type == "code":
                    cell.outputs = _plain(cell.outputs)
                    if (name := opened_program(cell.source)) is not None:
                        later = execution.run_more(_LATER.format(name))
                        cell.outputs[0].data["image/svg+xml"] = data_of(later, "image/svg+xml")[0]
    notebook.metadata.pop("widgets", None)
    notebook.metadata["language_info"] = _LANGUAGE
    nbformat.validate(notebook)
    path.write_text(nbformat.writes(notebook) + "\n", encoding="utf-8")


def _plain(outputs: list[Any]) -> list[Any]:
    """Outputs without widgets and without what only this run had; neighbouring prints are one."""
    kept: list[Any] = []
    for output in outputs:
        data = output.get("data", {})
        if (data.pop(WIDGET, None) and "image/svg+xml" not in data) or data.get("text/plain") == "":
            continue  # a progress bar, and what is left of it
        if "image/svg+xml" in data:
            data.pop("image/png", None)  # the same picture
        if output.output_type == "stream":
            if kept and kept[-1].output_type == "stream" and kept[-1].name == output.name:
                kept[-1].text += output.text
                continue
        elif output.output_type in ("display_data", "execute_result"):
            if not output.data:
                continue
            output.metadata = {}
        kept.append(output)
    return kept


if __name__ == "__main__":
    wanted = sys.argv[1:]
    for each in paths():
        if not wanted or each.stem in wanted:
            store(each)
            print(each.relative_to(NOTEBOOKS), f"{each.stat().st_size / 1000:.0f} kB")  # noqa: T201
