"""Texts as a terminal may show them."""

from __future__ import annotations

import unicodedata

CONTROLS = ("Cc", "Cf", "Cs")  # characters without a picture: controls, turns of direction, lone surrogates


def printable(text: str) -> str:
    """Write control characters, but ends of lines and tabs, as escapes: names in files could steer a terminal."""
    if text.isprintable():
        return text
    return "".join(
        repr(letter)[1:-1] if letter not in "\n\t" and unicodedata.category(letter) in CONTROLS else letter
        for letter in text
    )
