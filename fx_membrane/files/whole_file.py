"""Files that are written whole or not at all: aside first, then renamed."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

from ..checks.paths import is_stream, linked


@contextmanager
def writing(file: Path, mode: str = "w", **settings: Any) -> Iterator[IO[Any]]:
    """Open a file to write; make its folder, and replace an earlier file when the block ends without an exception.

    A device or a pipe, as /dev/stdout, is written in place. A link stays, and its target is replaced.

    Args:
        file: The file.
        mode: As of `open`.
        settings: As of `open`.

    Raises:
        ValueError: The file cannot be written; an earlier one stays as it was.
    """
    try:
        if is_stream(file):
            with file.open(mode, **settings) as stream:
                yield stream
            return
        target = linked(file)
        part = target.with_name(target.name + ".part")
        target.parent.mkdir(parents=True, exist_ok=True)
        try:
            with part.open(mode, **settings) as stream:
                yield stream
                stream.flush()
                os.fsync(stream.fileno())
            part.replace(target)
        finally:
            part.unlink(missing_ok=True)
    except OSError as error:
        reason = error.strerror or error
        raise ValueError(f"{str(file)!r} cannot be written ({reason}); make room, or give another place.") from None
