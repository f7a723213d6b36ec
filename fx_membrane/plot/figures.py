"""Figures of matplotlib and their files: a PNG, or another format by its ending.

Each function of the package writes one picture and makes its folder. An unwritable path is refused before anything is
drawn. Under MPI call it on all processes. The first one draws its own arguments; the others wait for it, and raise its
exceptions.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ..checks import paths

DOTS = 160  # [1/inch]


def empty(width: float, height: float) -> Any:
    """Make a figure without axes, of a size in inches."""
    import matplotlib.figure  # noqa: PLC0415  (numbers alone must not wait for it)

    return matplotlib.figure.Figure(figsize=(width, height), layout="constrained")


def plain(name: str) -> str:
    """Write a name of a user, in which a dollar begins no formula."""
    return name.replace("$", r"\$")


def checked_path(path: str | Path) -> Path:
    """Check the name, the ending and the place of a picture, before anything is drawn."""
    import matplotlib.backend_bases  # noqa: PLC0415

    file = paths.path("path", path)
    formats = sorted(matplotlib.backend_bases.FigureCanvasBase.get_supported_filetypes())
    ending = file.suffix[1:]
    if ending and ending.lower() not in formats:
        raise ValueError(f"path is {str(path)!r}, which ends in no format of pictures; give .png, or one of {formats}.")
    paths.check_writable("path", file)
    return file


def save(figure: Any, file: Path, dots: int = DOTS) -> None:
    """Write a whole figure or none, in the format of the ending; make its folder."""
    with whole(file) as part:
        figure.savefig(part, dpi=dots, bbox_inches="tight")


@contextmanager
def whole(file: Path) -> Iterator[Path]:
    """Name to write a picture under, of the same ending; it takes the place of the file when the block ends.

    Raises:
        ValueError: It cannot be written; an earlier picture stays as it was.
    """
    if paths.is_stream(file):
        yield file
        return
    try:
        target = paths.linked(file)
        part = target.with_name(f"{target.stem}.part{target.suffix or '.png'}")
        target.parent.mkdir(parents=True, exist_ok=True)
        try:
            yield part
            part.replace(target if target.suffix else target.with_name(f"{target.name}.png"))
        finally:
            part.unlink(missing_ok=True)
    except OSError as error:
        reason = error.strerror or error
        raise ValueError(f"path is {str(file)!r}, which cannot be written ({reason}); give another place.") from None
