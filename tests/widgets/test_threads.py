"""Two threads at the same work: nothing is done twice, and nothing is left behind."""

from threading import Thread

from lrp_jupyter.live.session import Session
from lrp_jupyter.widgets.texts import Texts

A = "(machine m (state a)) (spawn m a)"


def test_a_text_is_saved_once_though_two_threads_save(tmp_path):
    written = []

    class Interrupted(Texts):
        def _write(self, text, ending):
            written.append(text)
            other.start()
            other.join(0.05)  # it does not get further
            super()._write(text, ending)

    texts = Interrupted(tmp_path)
    other = Thread(target=texts.save)
    with Session(A, name="mine") as session:
        texts.follow(session)
        texts.save()
        other.join()
    assert written == [A]
    assert [file.name for file in tmp_path.iterdir()] == ["mine.lrp"]
