"""Lines of the keys of a TOML file, which no reader of TOML tells."""

import tomllib
from collections.abc import Sequence
from typing import Any

Path = Sequence[str | int]


def line_of(text: str, path: Path) -> int:
    """Find the line, from 1, where the statement begins that brings a key, or its table if the key is missing.

    Statements are found by reading ever more whole lines: the first prefix that has the key ends its statement. It is
    slow for large files, and asked for errors only.

    Args:
        text: The content of the file.
        path: Keys and rows from the top.
    """
    whole = tomllib.loads(text)
    known: list[str | int] = []
    for key in path:
        if not _has(whole, [*known, key]):
            break
        known.append(key)
    lines, start = text.splitlines(), 1
    for count in range(1, len(lines) + 1):
        try:
            found = tomllib.loads("\n".join(lines[:count]))
        except tomllib.TOMLDecodeError:
            continue
        if _has(found, known):
            return _first_with_content(lines, start)
        start = count + 1
    return 1


def _has(data: Any, path: Path) -> bool:
    for key in path:
        try:
            data = data[key]
        except (KeyError, IndexError, TypeError):
            return False
    return True


def _first_with_content(lines: list[str], start: int) -> int:
    """Skip empty lines and comments before a statement."""
    for number in range(start, len(lines) + 1):
        line = lines[number - 1].strip()
        if line and not line.startswith("#"):
            return number
    return start
