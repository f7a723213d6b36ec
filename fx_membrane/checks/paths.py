"""Names of files to write, checked before anything is computed."""

from __future__ import annotations

import errno
import os
import stat
from pathlib import Path
from typing import Any

from .validation import instance, short_repr

MAX_PATH = 4096  # bytes of a path on Linux
SPARE = 10  # bytes for the suffix of a temporary name


def path(name: str, value: Any, spare: int = SPARE) -> Path:
    """Check that a file system allows a path by its characters and length, with some bytes to spare.

    Raises:
        ValueError: It is no path, is empty, or no file can have that name.
    """
    instance(name, value, str | Path)
    shown_name = f"{name} is {short_repr(str(value))}"
    try:
        encoded = os.fsencode(value)
    except UnicodeEncodeError:
        raise ValueError(f"{shown_name}, with letters that no file name can have; leave them out.") from None
    if not os.path.basename(encoded) or b"\0" in encoded:
        raise ValueError(f"{shown_name}; give the name of a file, without zero bytes.")
    longest = max(map(len, encoded.split(b"/")))
    if longest > 255 - spare or len(encoded) > MAX_PATH - spare:
        raise ValueError(
            f"{name} has {len(encoded)} bytes, in one name {longest}, which is too long; give names of at most "
            f"{255 - spare} bytes, and {MAX_PATH - spare} in all."
        )
    return Path(value)


def check_writable(name: str, file: Path) -> None:
    """Refuse a file that this process cannot write; missing folders are made later.

    Raises:
        ValueError: It is a folder, or lies under a file, or in a folder without write permission.
    """
    named = f"{name} is {short_repr(str(file))}"
    if is_stream(file):
        if not os.access(file, os.W_OK):
            raise ValueError(f"{named}, which may not be written; give another name.")
        return
    try:
        above = next(folder for folder in file.absolute().parents if _there(folder))
        if file.is_dir():
            raise ValueError(f"{named}, a folder; give the name of a file in it.")
    except OSError as error:
        raise ValueError(f"{named}, which cannot be reached ({error.strerror}); give another name.") from None
    if not above.is_dir():
        raise ValueError(f"{named}, but {above} is no folder; give another name.")
    if not os.access(above, os.W_OK | os.X_OK):
        raise ValueError(f"{named}, but nothing may be written in {above}; give another folder.")


def is_stream(file: Path) -> bool:
    """Tell devices and pipes, which are written in place, from files."""
    try:
        mode = file.stat().st_mode
    except OSError:  # none is there, or none can be reached
        return False
    return not (stat.S_ISREG(mode) or stat.S_ISDIR(mode))


def linked(file: Path) -> Path:
    """File that a link names, there or not; any other file as it is."""
    return Path(os.path.realpath(file)) if file.is_symlink() else file


def _there(folder: Path) -> bool:
    try:
        folder.lstat()
    except OSError as error:
        if error.errno in (errno.ENOENT, errno.ENOTDIR):  # the second under a file, which is checked next
            return False
        raise
    return True
