"""jupyter-lsp lists the server, by the entry point of the package as it was installed."""

import sys

import pytest


@pytest.mark.slow
def test_jupyter_finds_the_server():
    jupyter_lsp = pytest.importorskip("jupyter_lsp")
    manager = jupyter_lsp.LanguageServerManager()
    manager.init_language_servers()
    found = manager.language_servers["lrp"]
    assert found["argv"] == [sys.executable, "-P", "-m", "lrp_jupyter", "language-server"]
    assert found["languages"] == ["lrp"]
