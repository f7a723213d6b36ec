"""Files that are written whole or not at all: aside first, then renamed."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any


@contextmanager
def writing(file: Path, mode: str = "w", **settings: Any) -> Iterator[IO[Any]]:
    """Open a file to write; make its folder, and replace an earlier file when the block ends without an exception.

    Args:
        file: The file.
        mode: As of `open`.
        settings: As of `open`.

    Raises:
        ValueError: The file cannot be written; an earlier one stays as it was.
    """
    part = file.with_name(file.name + ".part")
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        try:
            with part.open(mode, **settings) as stream:
                yield stream
                stream.flush()
                os.fsync(stream.fileno())
            part.replace(file)
        finally:
            part.unlink(missing_ok=True)
    except OSError as error:
        reason = error.strerror or error
        raise ValueError(f"{str(file)!r} cannot be written ({reason}); make room, or give another place.") from None
