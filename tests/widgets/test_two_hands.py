"""Two hands on one text: whatever their links do, they and the kernel end with one text and every letter."""

from contextlib import contextmanager
from dataclasses import dataclass, field

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.bench import Bench

from lrp_jupyter.widgets.wire.changes import TextChanges, to_units

BEGIN = "(machine m (state a)) ; \U0001f916 one\n(spawn m a) ; two\n"
LETTERS = {"left": "ABCDEFGHIJKLM", "right": "NOPQRSTUVWXYZ"}  # no other text has them


@dataclass
class Link:
    """What is on its way in one direction: it may be delayed, overtaken, and arrive twice."""

    on_its_way: list = field(default_factory=list)

    def put(self, message):
        self.on_its_way.append(message)

    def take(self, which, again):
        """Return the message that arrives now; `again`: it will arrive once more."""
        index = which % len(self.on_its_way)
        return self.on_its_way[index] if again else self.on_its_way.pop(index)


class Typist:
    """An editor: it types ahead of the kernel, and maps what comes over what it has typed."""

    def __init__(self, lab, name):
        self.lab, self.name = lab, name
        self.out, self.back = Link(), Link()
        self.units, self.revision, self.document = "", 0, ""
        self.ahead, self.early = [], {}
        self.seq = self.in_flight = self.number = 0
        self.hello()
        self.deliver()
        self.deliver()

    def __call__(self, message, _):
        """Hear the kernel."""
        if message["view"] == self.name and message["type"] in ("answer", "snapshot"):
            self.back.put(message)

    # -- out ---------------------------------------------------------------------------------------

    def send(self, kind, **fields):
        self.out.put({"type": kind, "view": self.name, **fields})

    def hello(self):
        known = {"document": self.document, "revision": self.revision, "seq": self.seq}
        self.send("hello", part="editor", **known)

    def type(self, place, deleted, text):
        """Replace something by letters."""
        start = place % (len(self.units) + 1)
        end = min(len(self.units), start + deleted)
        for at in (start, end):  # an editor does not split characters
            if self.units[at - 1 : at] > "\ud7ff" and self.units[at : at + 1] > "\udbff":
                return
        changes = TextChanges.of([(start, None), (end - start, text), (len(self.units) - end, None)])
        self.units = changes.apply(self.units)
        self.ahead.append(changes)
        self.flush()

    def flush(self):
        if self.ahead and not self.in_flight:
            self.seq += 1
            self.in_flight = self.seq
            updates = [each.json() for each in self.ahead]
            self.send("text", seq=self.seq, base=self.revision, updates=updates, selection=None)

    # -- in ----------------------------------------------------------------------------------------

    def deliver(self, which=0, again=False, back=None):
        """Let a message arrive: at the kernel, or here."""
        back = not self.out.on_its_way if back is None else back
        link = self.back if back else self.out
        if link.on_its_way:
            message = link.take(which, again)
            if back:
                self.hear(message)
            else:
                self.lab.connection.receive(self, message)

    def hear(self, message):
        if message["type"] == "snapshot":
            self.begin(message)
        elif message["number"] > self.number:
            self.early[message["number"]] = message
        while answer := self.early.pop(self.number + 1, None):
            self.number += 1
            self.merge(answer)
            if answer["seq"] == self.in_flight:
                self.in_flight = 0
        self.flush()

    def begin(self, snapshot):
        is_known = snapshot["document"] == self.document
        self.number = max(self.number, snapshot["number"]) if is_known else snapshot["number"]
        self.early = {number: each for number, each in self.early.items() if number > self.number}
        if is_known:
            assert snapshot["updates"] is not None
            self.merge(snapshot)
        else:
            self.units, self.revision = to_units(snapshot["text"]), snapshot["revision"]
            self.document = snapshot["document"]
        if self.in_flight <= snapshot["seq"]:
            self.in_flight = 0

    def merge(self, message):
        first = message["revision"] - len(message["updates"])
        for update in message["updates"][max(0, self.revision - first) :]:
            changes = TextChanges.from_json(update["changes"])
            self.revision += 1
            if update["view"] == self.name:
                self.ahead.pop(0)
                continue
            for index, own in enumerate(self.ahead):
                self.ahead[index], changes = own.map(changes), changes.map(own, first=True)
            self.units = changes.apply(self.units)

    @property
    def is_quiet(self):
        return not (self.out.on_its_way or self.back.on_its_way or self.ahead)


def settle(lab, typists):
    """Let everything arrive, and lost answers be asked for."""
    for turn in range(100):
        lab.publish()
        for typist in typists.values():
            if turn % 10 == 9 and (typist.early or typist.in_flight):
                typist.hello()
            while typist.out.on_its_way or typist.back.on_its_way:
                typist.deliver()
        if all(typist.is_quiet for typist in typists.values()):
            lab.publish()
            if all(typist.is_quiet for typist in typists.values()):
                return
    raise AssertionError("the typists do not come to rest")


@contextmanager
def opened(text):
    """Open a lab with two typists; let everything settle at the end."""
    lab = Bench(text)
    try:
        typists = {name: Typist(lab, name) for name in LETTERS}
        yield lab, typists
        settle(lab, typists)
        document = lab.connection.texts.document
        assert {typist.units for typist in typists.values()} == {document.units}
        assert {typist.revision for typist in typists.values()} == {document.revision}
        assert lab.session.text == document.text
        assert lab.connection.fault == ""
    finally:
        lab.connection.close()


NAMES = st.sampled_from(sorted(LETTERS))
PLACES = st.integers(0, 3) | st.integers(0, 99)  # often the same one
TYPE = st.tuples(st.just("type"), NAMES, PLACES)
ARRIVE = st.tuples(st.just("arrive"), NAMES, st.booleans(), st.just(0), st.just(False))
STRAY = st.tuples(st.just("arrive"), NAMES, st.booleans(), st.integers(0, 3), st.booleans())
STEPS = st.one_of(
    *(TYPE, TYPE, ARRIVE, ARRIVE, STRAY),
    st.tuples(st.just("delete"), NAMES, PLACES, st.integers(1, 9)),
    st.tuples(st.just("publish")),
    st.tuples(st.just("cell"), st.sampled_from(["(state b)", "\r\n", "; \U0001d11e", ""])),
    st.tuples(st.just("edit"), st.sampled_from(["; edited\n", "(", ""])),
    st.tuples(st.just("lose"), NAMES),
)
MANY = settings(deadline=None, max_examples=max(60, settings.default.max_examples))


def perform(lab, typists, step):
    """Take a step."""
    match step:
        case "type", name, place:
            typists[name].type(place, 0, LETTERS[name][place % 13])
        case "delete", name, place, length:
            typists[name].type(place, length, "")
        case "arrive", name, back, which, again:
            typists[name].deliver(which, again, back)
        case ("publish",):
            lab.publish(after=0.1)
        case "cell", text:
            lab.connection.texts.write(lab.connection.texts.text.replace("(state a)", f"(state a){text}"))
        case "edit", text:
            lab.session.edit(text + lab.session.text)
        case "lose", name:  # what is on its way is lost, and the page notices
            typists[name].out.on_its_way.clear()
            typists[name].back.on_its_way.clear()
            typists[name].hello()


@pytest.mark.slow
@MANY
@given(st.lists(STEPS, max_size=60))
def test_two_typists_end_with_the_kernels_text_whatever_their_links_do(steps):
    with opened(BEGIN) as (lab, typists):
        for step in steps:
            perform(lab, typists, step)


@MANY
@given(st.lists(STEPS.filter(lambda step: step[0] != "delete"), max_size=60))
def test_every_letter_that_either_has_typed_is_in_the_text_once_and_in_order(steps):
    typed = dict.fromkeys(LETTERS, "")
    with opened("") as (lab, typists):
        for step in steps:
            if step[0] != "type":
                perform(lab, typists, step)
                continue
            _, name, _ = step
            last, letter = typed[name][-1:], LETTERS[name][len(typed[name]) % 13]
            typists[name].type(typists[name].units.rfind(last) + 1 if last else 0, 0, letter)
            typed[name] += letter
    text = lab.connection.texts.text
    for name, letters in typed.items():
        assert "".join(each for each in text if each in LETTERS[name]) == letters


def test_a_text_that_arrives_twice_counts_once():
    with opened(BEGIN) as (lab, typists):
        left = typists["left"]
        left.type(0, 0, "A")
        left.deliver(again=True, back=False)
        left.deliver(back=False)
        lab.publish()
        assert lab.connection.texts.text == f"A{BEGIN}"
        assert len(left.back.on_its_way) == 1


def test_an_edit_by_a_cell_that_no_view_knows_yet_is_merged_with_what_is_typed():
    with opened(BEGIN) as (lab, typists):
        typists["left"].type(0, 0, "; A\n")
        lab.session.edit(f"{BEGIN}; edited")
        typists["left"].deliver(back=False)
        assert lab.session.text == f"; A\n{BEGIN}; edited"


def test_texts_of_several_changes_at_one_place_merge():
    with opened(BEGIN) as (lab, typists):
        left, right = typists.values()
        for typist, letters in ((left, "AB"), (right, "NO")):
            for letter in letters:
                typist.type(0, 0, letter)
            typist.out.on_its_way.clear()
            typist.in_flight = 0
            typist.flush()
        left.deliver(back=False)
        right.deliver(back=False)
    assert lab.connection.texts.text == f"BAON{BEGIN}"


def test_a_view_whose_text_is_too_old_to_be_merged_begins_again(monkeypatch):
    monkeypatch.setattr("lrp_jupyter.widgets.text.document._MOST_UPDATES", 3)
    with opened(BEGIN) as (lab, typists):
        left, right = typists.values()
        left.type(0, 0, "A")
        for letter in "NOPQ":
            right.type(0, 0, letter)
            right.deliver(back=False)
            lab.publish()
            while right.back.on_its_way:
                right.deliver(back=True)
        left.deliver(back=False)
        snapshot = left.back.on_its_way[-1]
        assert (snapshot["type"], snapshot["updates"], snapshot["seq"]) == ("snapshot", None, 1)
        left.back.on_its_way.clear()
        left.ahead, left.in_flight, left.document = [], 0, ""  # the page offers it as another text
        left.hello()


def test_a_text_that_is_longer_than_all_that_is_remembered_reaches_every_view(bench):
    lab = bench(BEGIN)
    left, right = lab.page("left"), lab.page("right")
    long = f"{BEGIN}; {'x' * 3_000_000}"
    left.type(long)
    right.type(f"{long}y")
    assert left.text == right.text == lab.connection.texts.text == f"{long}y"
    assert not lab.connection.texts.document.knows(1)


# -- what is half typed, and where the hands are -----------------------------------------------------

PROGRAM = "(machine m (state a) (state c) (eps a -> c)) (spawn m a)"


def test_what_another_view_types_does_not_make_a_half_typed_word_meant(bench):
    lab = bench(PROGRAM)
    left, right = lab.page("left"), lab.page("right")
    half = PROGRAM.replace("a -> c", "a -> cc")
    left.type(half, at=half.index("cc") + 2, meant=False)
    text = half.replace("(state a)", "(state a) (state b)")
    answer = right.type(text, at=text.index("b)") + 1)
    assert answer["reason"] == "waits: `m` has no state `cc`"
    assert lab.session.program.text == PROGRAM.replace("(state a)", "(state a) (state b)")
    assert left.moves(text.index("cc") + 2)["applied"]
    assert lab.session.program.text == text


def test_the_cursor_of_a_view_that_closes_holds_nothing_back(bench):
    lab = bench(PROGRAM)
    left, right = lab.page("left"), lab.page("right")
    half = PROGRAM.replace("a -> c", "a -> cc")
    left.type(half, at=half.index("cc") + 2, meant=False)
    right.moves(0)
    assert lab.session.program.text == PROGRAM
    left.send("bye")
    assert lab.session.program.text == half


def test_what_is_typed_at_several_cursors_of_a_view_is_one_word(bench):
    lab = bench(PROGRAM)
    lab.session.step()
    page = lab.page()
    text = PROGRAM.replace("state a", "state aa").replace("a ->", "aa ->").replace("m a)", "m aa)")
    *cursors, last = [text.index(piece) + len(piece) for piece in ("state aa", "eps aa", "m aa")]
    page.type(text, at=last, cursors=cursors, meant=False)
    assert lab.session.program.text == PROGRAM
    lab.publish()
    answer = page.last("answer")
    assert (answer["applied"], answer["reason"]) == (False, "waits: `a` is active and was removed or renamed")
    page.moves(0)
    assert lab.session.program.text == text


def test_a_cursor_that_is_late_does_not_replace_that_of_a_newer_text(bench):
    lab = bench(PROGRAM)
    page, _ = lab.page(), lab.page("other")
    half = PROGRAM.replace("a -> c", "a -> cc")
    before = page.seq, page.revision
    page.type(half, at=half.index("cc") + 2, meant=False)
    page.send("cursor", seq=before[0], revision=before[1], selection=[0, 0], meant=True)
    lab.publish()
    assert lab.session.program.text == PROGRAM


def test_where_the_hands_are_is_shown_while_there_are_several(bench):
    lab = bench("; 1 \U0001f916 two")
    left = lab.page("left")
    left.moves(3)
    lab.publish()
    assert left.merged("hands") == {}
    right, graph = lab.page("right", part="editor"), lab.page("graph", part="graph")
    right.moves(9)
    lab.publish()
    revision = left.revision
    expected = {
        name: {"revision": revision, "selection": [at, at]} for name, at in (("left", 3), ("right", 9))
    }
    for page in (left, right, graph):
        assert page.merged("hands") == expected
    left.type("; 1 more \U0001f916 two", at=9)
    lab.publish()
    assert right.merged("hands")["right"] == {"revision": revision + 1, "selection": [14, 14]}
    right.moves(None)
    lab.publish()
    assert left.merged("hands")["right"]["selection"] is None
    right.send("bye")
    lab.publish()
    assert left.merged("hands") == {}
