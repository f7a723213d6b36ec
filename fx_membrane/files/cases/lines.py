"""Lines of the keys and rows of a TOML file, which no reader of TOML tells."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Sequence

Path = tuple[str | int, ...]
BLANK = re.compile(r"(?:[ \t\r\n]|#[^\n]*)*")
KEY = re.compile(r"""[A-Za-z0-9_-]+|"(?:[^"\\\n]|\\.)*"|'[^'\n]*'""")
VALUE = re.compile(
    r'"""(?:[^"\\]|\\.|"{1,2}(?!"))*"{3,5}'
    r"|'''(?:[^']|'{1,2}(?!'))*'{3,5}"
    r'|"(?:[^"\\\n]|\\.)*"'
    r"|'[^'\n]*'"
    r"|[^\s,\]}#](?:[^,\]}#\n]*[^\s,\]}#])?",
    re.DOTALL,
)


def line_of(text: str, path: Sequence[str | int]) -> int:
    """Find the line, from 1, of a key or a row of a list; of the table that would have it if it is not there.

    Args:
        text: The content of the file, which is TOML.
        path: Keys and rows from the top.
    """
    places = _Places(text).found
    for count in range(len(path), 0, -1):
        if tuple(path[:count]) in places:
            return text.count("\n", 0, places[tuple(path[:count])]) + 1
    return 1


class _Places:
    """Places of all keys and rows of a text that is known to be TOML.

    Attributes:
        found: Place of the first character of each path; the first where several lines bring a table.
    """

    def __init__(self, text: str):
        self.found: dict[Path, int] = {}
        self._text, self._at, self._rows = text, 0, dict[Path, int]()
        table: Path = ()
        while self._next():
            if self._text[self._at] == "[":
                table = self._header()
            else:
                self._pair(table)

    def _next(self) -> str:
        """Go on to the next character that means something; return it, empty at the end."""
        self._at = BLANK.match(self._text, self._at).end()  # type: ignore[union-attr]  # an empty match at least
        return self._text[self._at : self._at + 1]

    def _header(self) -> Path:
        """Read the head of a table, or of a row of tables; return its path."""
        start = self._at
        rows = self._text.startswith("[[", start)
        self._at += 2 if rows else 1
        keys = self._keys()
        self._at += 2 if rows else 1
        path: Path = ()
        for number, key in enumerate(keys):
            path = (*path, key)
            self.found.setdefault(path, start)
            if rows and number == len(keys) - 1:
                self._rows[path] = self._rows.get(path, -1) + 1
            if path in self._rows:
                path = (*path, self._rows[path])
                self.found.setdefault(path, start)
        return path

    def _keys(self) -> list[str]:
        """Read a key with its dots."""
        keys = []
        while True:
            self._next()
            found = KEY.match(self._text, self._at)
            assert found is not None
            word, self._at = found[0], found.end()
            keys.append(tomllib.loads(f"key = {word}")["key"] if word[0] in "\"'" else word)
            if self._next() != ".":
                return keys
            self._at += 1

    def _pair(self, table: Path) -> None:
        start = self._at
        for key in self._keys():
            table = (*table, key)
            self.found.setdefault(table, start)
        self._at += 1  # the sign =
        self._value(table)

    def _value(self, path: Path) -> None:
        bracket = self._next()
        if bracket not in ("[", "{"):
            self._at = VALUE.match(self._text, self._at).end()  # type: ignore[union-attr]  # no value is empty
            return
        self._at += 1
        row = 0
        while self._next() not in ("]", "}"):
            if self._text[self._at] == ",":
                self._at += 1
                row += 1
            elif bracket == "{":
                self._pair(path)
            else:
                self.found.setdefault((*path, row), self._at)
                self._value((*path, row))
        self._at += 1
