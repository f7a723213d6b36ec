"""Lines that fit on a screen."""

from __future__ import annotations

import textwrap

WIDTH = 80  # [columns]


def wrapped(text: str, first: int = 0, rest: int | None = None) -> str:
    """Break a text into lines with a margin, of the first line and of the rest; long words, as names, stay whole."""
    return textwrap.fill(
        text,
        WIDTH,
        initial_indent=" " * first,
        subsequent_indent=" " * (first if rest is None else rest),
        break_long_words=False,
        break_on_hyphens=False,
    )


def fitted(text: str) -> str:
    """Break the lines of a text that are too long; their rest is indented further."""
    lines = []
    for line in text.splitlines():
        margin = len(line) - len(line.lstrip())
        lines.append(line if len(line) <= WIDTH else wrapped(line.lstrip(), margin, margin + 4))
    return "\n".join(lines)
