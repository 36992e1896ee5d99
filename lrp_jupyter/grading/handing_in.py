"""What is handed in without a file: a code of the text, to be written on paper or read aloud."""

from __future__ import annotations

import hashlib
from functools import lru_cache

_SYMBOLS = "0123456789ABCDEFGHJKMNPQRSTVWXYZ"  # without those that are easily taken for others
_LENGTH = 8
_ROUNDS = 2000  # so that trying millions of texts until one has a given code takes too long


@lru_cache(64)
def code_of(text: str) -> str:
    """Return the hand-in code of a text, such as ``K7M2-QX9D``; white space does not matter."""
    digest = "".join(text.split()).encode("utf-8", "surrogatepass")
    for _ in range(_ROUNDS):
        digest = hashlib.sha256(digest).digest()
    number = int.from_bytes(digest[:_LENGTH])
    code = "".join(_SYMBOLS[number >> 5 * place & 31] for place in range(_LENGTH))
    return f"{code[:4]}-{code[4:]}"
