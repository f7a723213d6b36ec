"""TOML of a case file: lines that are none are told together, and the others still read."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

HEAD = re.compile(r"\s*(\[\[?)\s*([\w.-]+)")
MOST = 20  # unreadable lines that are passed over; more make no case file


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
    for _ in range(MOST):
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
        lines[number - 1], passed = "", number
    return {}, "", faults[:1]


def _head(line: str) -> str:
    """Head of a table with the brackets that it lacks; empty if its name is not plain."""
    found = HEAD.match(line)
    return f"{found[1]}{found[2]}{']' * len(found[1])}" if found else ""


def _place(error: tomllib.TOMLDecodeError) -> tuple[int | None, str]:
    """Line of an error, None at the end of the file, and its words."""
    words, _, place = str(error).rpartition(" (at ")
    words = f"{words[0].lower()}{words[1:]}"
    return (int(place.removeprefix("line ").split(",")[0]) if place.startswith("line ") else None), words
