"""Forms as a whole: signs that are wrong or missing, and parts in the wrong order."""

from __future__ import annotations

import re

from lrp_jupyter.errors import Edit
from lrp_jupyter.language.draft import OpenForm, Piece, TextDraft
from lrp_jupyter.language.forms import USAGE
from lrp_jupyter.language.spellings import ARROW_WORDS, ASSIGN_WORDS
from lrp_jupyter.language.tokens import keyword_of


class Parts(TextDraft):
    """The part of the corrections that is about the parts of a form."""

    def _transition(self, frame: OpenForm) -> None:
        """Correct the arrow of a transition and the order of its parts."""
        if "ARROW" not in frame.types:
            frame.items = self._arrow(frame)
        self._source(frame)
        items = frame.items
        types = tuple([item.kind for item in items])
        arrow = _source_length(types)
        if frame.keyword != "eps" and arrow and types[arrow:-1] == ("ARROW", "NAME"):
            self._trigger_last(frame, items[0], items[arrow + 1], items[-1])
        if types[:1] == ("INTEGER",) and frame.keyword == "on" and len(types) > 3:
            self._change_keyword(frame, "ontime", "A delay belongs in `ontime`")
        elif frame.keyword == "eps" and "ARROW" in types[2:3] and types[0] in ("NAME", "BLOCK", "INTEGER"):
            meant = "ontime" if types[0] == "INTEGER" else "on"
            if types[1] in ("NAME", "STAR"):
                self._change_keyword(frame, meant, "An `eps` has neither an event nor a delay")

    def _source(self, frame: OpenForm) -> None:
        """Put several sources into braces."""
        first = 0 if frame.keyword == "eps" else 1
        types = frame.types
        if "ARROW" not in types[first:]:
            return
        arrow = types.index("ARROW", first)
        items = frame.items[first:arrow]
        inside = [item for item in items if item.kind == "NAME"]
        kinds = {item.kind for item in items}
        braces = len({"LBRACE", "RBRACE"} & kinds)
        starred = types[first : first + 2] == ("STAR", "MINUS")
        known = all(self._word(item) in self.states for item in inside)
        lone = braces == 0 and (len(inside) > 1 or starred)
        if frame.keyword == "exit" or not inside or not known or not (lone or braces == 1):
            return
        if kinds - {"NAME", "LBRACE", "RBRACE"} - ({"STAR", "MINUS"} if starred else set()):
            return
        start, end = inside[0].start, inside[-1].end
        before = Edit(start, start, "{") if "LBRACE" not in kinds else None
        after = Edit(end, end, "}") if "RBRACE" not in kinds else None
        names = " ".join(map(self._word, inside))
        message = f"Several sources are written in braces. Write `{{{names}}}`."
        self._add(start, end, "LRP108", message, *filter(None, (before, after)))

    def _trigger_last(self, frame: OpenForm, first: Piece, destination: Piece, trigger: Piece) -> None:
        """Move the event or delay of a transition from its end to its beginning."""
        word = self._word(trigger)
        known = self.variables if frame.keyword == "ontime" else self.events
        if trigger.kind == "NAME" and (word in self.states or word not in known):
            return
        what = "The delay" if frame.keyword == "ontime" else "The event"
        message = f"{what} comes before the states. Write `{USAGE[frame.keyword]}`."
        edits = Edit(first.start, first.start, f"{word} "), Edit(destination.end, trigger.end, "")
        self._add(trigger.start, trigger.end, "LRP108", message, *edits)

    def _change_keyword(self, frame: OpenForm, meant: str, reason: str) -> None:
        token = self.tokens[self._after(frame.start)]
        if keyword_of(self.text, token) == frame.keyword:  # else it is misspelt, which is reported already
            start, end = token[2] - len(frame.keyword), token[2]
            self._add(start, end, "LRP108", f"{reason}. Write `{meant}`.", Edit(start, end, meant))
            frame.keyword = meant

    def _arrow(self, frame: OpenForm) -> list[Piece]:
        """Correct or insert the arrow of a transition; return the items with it."""
        items = frame.items
        first = 0 if frame.keyword == "eps" else 1
        for at, item in enumerate(items):
            wrong = item.kind in ("SIGN", "ASSIGN", "MINUS") or (
                at > 0
                and item.kind == "NAME"
                and self._word(item).lower() in ARROW_WORDS
                and self._word(item) not in self.states
                and at + 1 < len(items)
            )
            if wrong and not (item.kind == "MINUS" and items[at - 1].kind == "STAR"):
                message = f"The arrow to the destination is `->`, not `{self._word(item)}`. Write `->`."
                tight = self.text[item.start - 1 : item.start] + self.text[item.end : item.end + 1]
                arrow = "->" if tight.isspace() or item.kind != "NAME" else " -> "
                certain = "<" not in self._word(item)
                self._add(
                    item.start,
                    item.end,
                    "LRP104",
                    message,
                    Edit(item.start, item.end, arrow),
                    certain=certain,
                )
                return [*items[:at], item._replace(kind="ARROW"), *items[at + 1 :]]
        source = _source_length(frame.types[first:])
        at = first + source
        if source and len(items) > at and items[at].kind == "NAME" and len(items) <= at + 2:
            if frame.keyword == "eps" and len(items) > at + 1:
                return items
            before, after = items[at - 1].end, items[at].start
            message = "The arrow `->` is missing before the destination. Insert it."
            self._add(after, items[at].end, "LRP108", message, Edit(before, before, " ->"))
            return [*items[:at], Piece("ARROW", before, before), *items[at:]]
        return items

    def _definition(self, frame: OpenForm) -> None:
        """Correct signs and the order of parts in `var`, `event` and `spawn`."""
        items, types, keyword = frame.items, frame.types, frame.keyword
        usage = f"Write `{USAGE[keyword]}`."
        if keyword == "var" and types == ("NAME", "BLOCK"):
            at = items[0].end
            message = f"`:=` is missing between the name and its value. {usage}"
            edit = Edit(at, at, " :=" if self.text[at].isspace() else " := ")
            self._add(*items[1][1:3], "LRP108", message, edit)
        elif keyword == "var" and len(types) == 3 and types[0] == "NAME" and types[2] == "BLOCK":
            sign = items[1]
            word = self._word(sign)
            if sign.kind in ("SIGN", "ARROW", "MINUS") or word in ASSIGN_WORDS:
                message = f"A variable gets its value with `:=`, not with `{word}`. Write `:=`."
                self._add(sign.start, sign.end, "LRP104", message, Edit(sign.start, sign.end, ":="))
        elif keyword != "var" and len(types) == 3 and types[1] in ("SIGN", "ASSIGN", "ARROW", "MINUS"):
            sign = items[1]
            message = f"There is no `{self._word(sign)}` in `{keyword}`. {usage}"
            self._add(sign.start, sign.end, "LRP104", message, Edit(sign.start, sign.end, " "))
        elif types in (("BLOCK", "NAME"), ("BLOCK", "ASSIGN", "NAME")) and keyword != "spawn":
            block, name = items[0], items[-1]
            message = f"The name comes before the block. {usage}"
            edits = Edit(*block[1:3], self._word(name)), Edit(*name[1:3], self._word(block))
            self._add(block.start, block.end, "LRP108", message, *edits)
        elif types[:2] == ("NAME", "NAME") and keyword != "spawn":
            self._two_words(frame)

    def _two_words(self, frame: OpenForm) -> None:
        names = []
        for item in frame.items:
            if item.kind != "NAME":
                break
            names.append(item)
        name = "_".join(map(self._word, names))
        start, end = names[0].start, names[-1].end
        if name in self._known():
            message = f"A name is one word. Write `{name}`."
            self._add(start, end, "LRP110", message, Edit(start, end, name))

    def _container(self, frame: OpenForm) -> None:
        """Correct a name of several words, and report an action straight in a state."""
        if frame.types[:2] == ("NAME", "NAME"):
            self._two_words(frame)
        if frame.keyword != "state":
            return
        for item in frame.items:
            if item.kind == "BLOCK":
                repeats = _REPEATED.search(self.text, item.start, item.end)
                has_running = "RUNNING_FORM" in frame.types
                form, other = ("onentry", "running")[:: -1 if repeats and not has_running else 1]
                message = (
                    f"An action needs a form that says when it runs. Write `({form} […])` or `({other} […])`."
                )
                edits = Edit(item.start, item.start, f"({form} "), Edit(item.end, item.end, ")")
                self._add(item.start, item.end, "LRP117", message, *edits)


_REPEATED = re.compile(r"\brobot\.(?!stop\b|pen\b|lamp\b)\w+(?:\s*\(|\s+as\b)|[+\-*/]=")
"""What is probably meant to be repeated: a robot that gets no command for a while stops."""


def _source_length(types: tuple[str, ...]) -> int:
    """Return the number of items in the source at the beginning of some types; 0 if there is none."""
    if types[:1] == ("NAME",):
        return 1
    if types[:1] == ("STAR",) and types[1:2] != ("MINUS",):
        return 1
    if "RBRACE" in types and types[0] in ("LBRACE", "STAR"):
        return types.index("RBRACE") + 1
    return 0
