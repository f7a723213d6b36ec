"""TOML of a case file: lines that are none are told together, and the others still read."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

HEAD = re.compile(r"\s*(\[\[?)\s*([\w.-]+)")
WHOLE_HEAD = re.compile(r"\s*\[\[?[^\[\],]+\]\]?\s*(?:#.*)?")
MARK = re.compile(r"""(?P<passed>"(?:[^"\\]|\\.)*"|'[^']*'|#.*)|(?P<opened>[\[{])|[\]}]""")
MAX_UNREADABLE_LINES = 20  # unreadable lines that are passed over; more make no case file


def parsed(file: Path, text: str) -> tuple[dict[str, Any], str, list[str]]:
    """Read TOML.

    Args:
        file: The file, for messages.
        text: Its content.

    Returns:
        The data of all lines that can be read, empty if they cannot be told from the others; these lines, with empty
        ones for the others, so that their numbers stay; and the faults, a line of text each.
    """
    lines, faults, passed = text.splitlines(), list[str](), -1
    for _ in range(MAX_UNREADABLE_LINES):
        readable = "\n".join(lines)
        try:
            return tomllib.loads(readable), readable, faults
        except tomllib.TOMLDecodeError as error:
            number, words = _place(error)
        except RecursionError:
            return {}, "", [f"{file}:1: file: its tables are nested too deeply; write them apart"]
        if number is None or not lines[number - 1].strip():
            last = f"{file}:{max(len(lines), 1)}: file: it is no TOML: {words}; correct that line"
            return {}, "", faults or [last]
        if number != passed + 1:  # the next line goes on with the statement that has been passed over
            faults.append(f"{file}:{number}: file: it is no TOML: {words}; correct that line")
        if lines[number - 1].lstrip().startswith("["):
            head = _head(lines[number - 1])
            if head in ("", lines[number - 1].strip()):  # keys below it have no table now
                return {}, "", faults
            lines[number - 1], passed = head, number - 1
            continue
        passed = _without_statement(lines, number - 1)
    return {}, "", faults[:1]


def _head(line: str) -> str:
    """Head of a table with the brackets that it lacks; empty if its name is not plain."""
    found = HEAD.match(line)
    return f"{found[1]}{found[2]}{']' * len(found[1])}" if found else ""


def _without_statement(lines: list[str], row: int) -> int:
    """Empty a line, and those below it up to the bracket that closes one of its own; return the number of the last.

    Inline tables over several lines are no TOML, and the lines in them look like keys of the table around.
    """
    depth = 0
    for last in range(row, len(lines)):
        if last > row and WHOLE_HEAD.fullmatch(lines[last]):
            break
        for mark in MARK.finditer(lines[last]):
            if mark["passed"] is None:
                depth += 1 if mark["opened"] else -1
            if depth == 0 and last > row and mark[0] in ("]", "}"):
                lines[row : last + 1] = [""] * (last - row) + [lines[last][mark.end() :]]
                return last + 1
        if depth <= 0:
            break
    lines[row] = ""
    return row + 1


def _place(error: tomllib.TOMLDecodeError) -> tuple[int | None, str]:
    """Line of an error, None at the end of the file, and its words."""
    words, _, place = str(error).rpartition(" (at ")
    words = f"{words[0].lower()}{words[1:]}"
    return (int(place.removeprefix("line ").split(",")[0]) if place.startswith("line ") else None), words
