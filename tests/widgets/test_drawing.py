"""An act on the state graph is answered with edits of the text that the page sent."""

import pytest

TEXT = "; é 😀\r\n(machine m\r\n  (state a)   ; first\r\n  (state b)\r\n  (on go a -> b))\r\n(spawn m a)\r\n"


@pytest.fixture
def page(bench):
    return bench(TEXT).page()


def draw(page, act, kind, path, text=TEXT, **more):
    return page.ask("draw", text=text, act=act, kind=kind, path=path, **more)


def test_an_act_is_answered_with_edits_of_the_text_sent(page):
    answer = draw(page, "state", "machine", "m", text=TEXT.replace("(state b)", "(state c)"), to="b")
    assert answer["edits"] == [
        {"range": {"line": 4, "column": 12, "end_line": 4, "end_column": 12}, "text": "\r\n  (state b)"}
    ]


@pytest.mark.parametrize(
    ("act", "kind", "path", "more", "texts"),
    [
        ("transition", "state", "m/b", {"to": "a", "form": "2 s"}, ["\r\n  (ontime 2000 b -> a)"]),
        ("transition", "state", "m/*", {"to": "a", "form": "go"}, ["\r\n  (on go * -> a)"]),
        ("form", "state", "m/b", {"form": "running [x()]"}, ["\r\n    (running [x()])"]),
        ("form", "machine", "", {"form": "(spawn m b)"}, ["\r\n(spawn m b)"]),
        ("rename", "state", "m/a", {"to": "z"}, ["z", "z", "z"]),
        ("delete", "state", "m/a", {}, ["", "", "b"]),
        ("delete", "transition", "m:on:a->b", {}, [""]),
        ("delete", "machine", "m", {}, [""]),
        ("change", "transition", "m:on:a->b", {"form": "eps a -> b"}, ["(eps a -> b)"]),
        ("source", "transition", "m:on:a->b", {"to": "*", "old": "a"}, ["*"]),
        ("destination", "transition", "m:on:a->b", {"to": "a"}, ["a"]),
        ("reverse", "transition", "m:on:a->b", {}, ["b", "a"]),
        ("start", "state", "m/b", {}, ["b"]),
    ],
)
def test_every_act_has_its_edits(page, act, kind, path, more, texts):
    answer = draw(page, act, kind, path, **more)
    assert sorted(edit["text"] for edit in answer["edits"]) == sorted(texts)


def test_states_are_nested_and_unnested(page):
    text = "(machine m (state b (onentry (spawn n a)) (machine n (state a)))) (spawn m b)"
    assert draw(page, "unnest", "state", "m/b/n/a", text=text)["edits"]
    text = "(machine m (state a) (state b)) (spawn m b)"
    assert draw(page, "nest", "state", "m/a", text=text, to="b")["edits"]


@pytest.mark.parametrize(
    ("act", "kind", "path", "text", "sentence"),
    [
        ("state", "machine", "m", "(machine m", "is not a valid program at the moment"),
        ("rename", "state", "m/a", "(machine m (state a", "is not a valid program at the moment"),
        ("delete", "state", "m/q", TEXT, "There is no state `m/q`."),
        ("state", "machine", "m", TEXT, "is not a valid name"),
        ("delete", "event", "m/e", TEXT, "An event cannot be deleted in the graph"),
        ("start", "state", "", TEXT, "There is no state"),
    ],
)
def test_what_cannot_be_drawn_is_answered_with_a_sentence(page, act, kind, path, text, sentence):
    answer = draw(page, act, kind, path, text=text, to="a b")
    assert sentence in answer["error"]
