"""Which keyword is meant by a word after `(`, or by a form that has none."""

from __future__ import annotations

from lrp_jupyter.errors import Edit
from lrp_jupyter.language.draft import LONGEST, OpenForm, TextDraft
from lrp_jupyter.language.forms import Mistake, Shape, shape_of
from lrp_jupyter.language.spellings import FOLLOWERS, OTHERS, closest
from lrp_jupyter.language.tokens import KEYWORDS, LEGAL, keyword_of
from lrp_jupyter.language.triggers import FORMS


class Keywords(TextDraft):
    """The part of the corrections that is about keywords."""

    def _keyword(self, start: int, end: int, meant: str, opened: int, certain: bool = True) -> None:
        word = self.text[start:end]
        message = f"`{word}` is not a keyword. Did you mean `{meant}`?"
        if word.lower() == meant:
            message = f"Keywords are written in lowercase. Write `{meant}`."
        self._add(start, end, "LRP106", message, Edit(start, end, meant), certain=certain)
        if any(keyword.startswith(word) for keyword in KEYWORDS):
            self.found[-1] = self.found[-1]._replace(prefix=True)
        self.frames.append(OpenForm(meant, opened))

    def _follower(self, index: int, word: str) -> tuple[str, int] | None:
        """Return the keyword meant by two words, as in ``(on entry […])``, and the offset after them."""
        if word.lower() not in ("on", "state"):
            return None
        joined = self._word(self.tokens[index + 1]) in ("-", ".") if self._kind(index + 1) else False
        second = index + 1 + joined
        if self._kind(second) != "NAME" or self._word(self.tokens[second]) in self.events:
            return None
        name, after = self._word(self.tokens[second]).lower(), self._kind(second + 1)
        if word == "state":
            meant = "machine" if name == "machine" and after == "NAME" else ""
        else:
            meant = next((meant for meant, words in FOLLOWERS.items() if name in words), "")
            timed = after == "INTEGER" or (joined and after == "NAME")
            if not (timed if meant == "ontime" else after in ("BLOCK", "OPEN", "UNCLOSED")):
                meant = ""
        return (meant, self.tokens[second][2]) if meant else None

    def _meant(self, index: int, word: str, around: str) -> tuple[str, bool]:
        """Return the keyword that a word probably stands for, and whether that is certain."""
        if not word:
            return "", False
        legal = sorted(LEGAL.get(around, KEYWORDS))
        plain = word.lower().replace("_", "")
        if plain in KEYWORDS:
            return plain, True
        meant = [keyword for keyword in OTHERS.get(plain, ()) if keyword in legal]
        if len(meant) > 1 or (meant and meant[0] in FORMS):
            meant = [self._kind_of_transition(index, meant)]
        inferred = self._inferred(index, word, around)
        close = closest(plain, legal, 0.6) or closest(plain, KEYWORDS, 0.8)
        if close in ("on", "eps") and self._kind(index + 1) == "INTEGER":
            close = "ontime"
        for keyword in (*meant[:1], close):
            if keyword and not (inferred and isinstance(self._shape(keyword, index), Mistake)):
                return keyword, True
        if inferred:
            return "", False
        other = next(iter(OTHERS.get(plain, ())), "")
        return other, False

    def _kind_of_transition(self, index: int, meant: list[str]) -> str:
        """Return which of several keywords fits the rest of a form."""
        rest = self._rest(index + 1)
        if meant[0] not in FORMS or not rest:
            return meant[0]
        if rest[0][0] == "INTEGER":
            return "ontime"
        arrow = next((at for at, token in enumerate(rest) if token[0] == "ARROW"), None)
        return "eps" if arrow == 1 or rest[0][0] == "LBRACE" else meant[0]

    def _types(self, index: int) -> tuple[str, ...]:
        """Return the types of the parts from a token on, up to the `)` of their form."""
        types = []
        depth = 0
        for at in range(index, len(self.tokens)):
            kind = self.tokens[at][0]
            if kind == "CLOSE":
                if not depth:
                    break
                depth -= 1
            elif kind == "OPEN":
                if not depth:
                    types.append(f"{keyword_of(self.text, self.tokens[at]).upper()}_FORM")
                depth += 1
            elif not depth:
                types.append(kind)
            if len(types) > LONGEST:
                break
        return tuple(types)

    def _shape(self, keyword: str, index: int) -> Shape | Mistake | None:
        """Return the shape of the form that begins with a token, with another keyword."""
        return shape_of((keyword.upper(), *self._types(index + 1)))

    def _inferred(self, index: int, word: str, around: str) -> str:
        """Return the only keyword with which a form without one would be right; else an empty text."""
        types = (*(["NAME"] if word else []), *self._types(index + 1))
        if len(types) < (1 if around == "machine" else 2):
            return ""
        found = [
            keyword
            for keyword in sorted(LEGAL.get(around, ()))
            if not isinstance(shape_of((keyword.upper(), *types)), Mistake)
        ]
        if "machine" in found and "STATE_FORM" not in types:
            found.remove("machine")
        if "on" in found and types[0] != "INTEGER":
            return "on"
        return found[0] if len(found) == 1 else ""
