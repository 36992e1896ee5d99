"""The text of a file in a tab of JupyterLab, as the kernel reconciles it with that of the lab."""

import pytest

from lrp_jupyter.widgets import documents, registry

TEXT = "; world: none\n(machine m (state a)) (spawn m a)\n"


@pytest.mark.parametrize("use", [False, True])
def test_a_file_is_not_replaced_while_its_user_is_asked_which_text_to_keep(tmp_path, monkeypatch, use):
    monkeypatch.chdir(tmp_path)
    documents.open_program("my", TEXT, again=False)
    connection = registry.find("my")
    texts, saver = connection.texts, connection.saver
    try:
        with texts.lock:  # at the same moment
            texts.write(f"{TEXT}; lab\n")
            documents.reconcile(f"{TEXT}; file\n")
        saver.save(at_once=True)
        assert (len(texts.conflicts), texts.cell) == (1, TEXT), "the page has what it had"
        texts.end_conflict(None, use)
        saver.save(at_once=True)
        assert (texts.text, texts.cell) == (f"{TEXT}; {'file' if use else 'lab'}\n",) * 2
    finally:
        connection.close()
