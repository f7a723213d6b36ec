"""Lines that fit on a screen."""

from __future__ import annotations

import re
import textwrap

WIDTH = 80  # [columns]
TOGETHER = re.compile(  # names in quotes, numbers with their units, and kinds with their numbers
    r"'[^']{1,24}'|\d (?:%|[^\W\d_]{1,2}\d?(?:/[^\W\d_]{1,2}\d?)?)(?![\w/])|\b(?:cell|node|strip) \d+"
)


def wrapped(text: str, first: int = 0, rest: int | None = None, width: int = WIDTH) -> str:
    """Break a text into lines with a margin; long words, names in quotes, and numbers with their units stay whole.

    Args:
        text: The text; a null character is a space at which no line ends.
        first: Margin of the first line.
        rest: Margin of the others; that of the first one if it is None.
        width: Columns of a line.
    """
    kept = TOGETHER.sub(lambda found: found[0].replace(" ", "\0"), text)
    lines = textwrap.fill(
        kept,
        width,
        initial_indent=" " * first,
        subsequent_indent=" " * (first if rest is None else rest),
        break_long_words=False,
        break_on_hyphens=False,
    )
    return lines.replace("\0", " ")


def fitted(text: str) -> str:
    """Break the lines of a text that are too long; their rest is indented further."""
    lines = []
    for line in text.splitlines():
        margin = len(line) - len(line.lstrip())
        lines.append(line if len(line) <= WIDTH else wrapped(line.lstrip(), margin, margin + 4))
    return "\n".join(lines)
