"""Files of moving pictures: GIF by Pillow, MP4 by imageio-ffmpeg."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..checks import paths
from .figures import whole
from .scene import INK

ENDINGS = (".gif", ".mp4")

EXACT = np.array([(255, 255, 255), (0, 0, 0), tuple(bytes.fromhex(INK[1:]))])

Image = NDArray[np.uint8]


def checked_movie(path: str | Path) -> Path:
    """Check the name, the ending and the place of a moving picture, and its library, before anything is drawn.

    Raises:
        ValueError: The path ends in neither .gif nor .mp4, or cannot be written.
        ImportError: imageio-ffmpeg is not installed, for an MP4.
    """
    file = paths.path("path", path)
    if file.suffix.lower() not in ENDINGS:
        raise ValueError(f"path is {str(path)!r}; give a name that ends in .gif or .mp4.")
    if file.suffix.lower() == ".mp4":
        try:
            import imageio_ffmpeg  # noqa: F401, PLC0415  (optional)
        except ImportError:
            raise ImportError(
                "An MP4 needs the package imageio-ffmpeg: pip install 'fx-membrane[video]'; or give a path that ends "
                "in .gif."
            ) from None
    paths.check_writable("path", file)
    return file


def write(file: Path, frames: Iterable[Image], seconds: float) -> None:
    """Write frames of equal size, shape (height, width, 3), each shown for some seconds; make the folder."""
    with whole(file) as part:
        (_write_gif if file.suffix.lower() == ".gif" else _write_mp4)(part, iter(frames), seconds)


def _write_gif(file: Path, frames: Iterator[Image], seconds: float) -> None:
    import PIL.Image  # noqa: PLC0415

    images = [PIL.Image.fromarray(frame) for frame in frames]
    # One palette for all frames, of all: colours do not flicker. Paper and ink are in it as they are.
    table = PIL.Image.fromarray(np.concatenate([frame[::3, ::3] for frame in map(np.asarray, images)]))
    found = table.quantize(256 - len(EXACT), dither=PIL.Image.Dither.NONE).getpalette() or []
    shades = np.reshape(found[: 3 * (256 - len(EXACT))], (-1, 3))
    apart = np.abs(shades[:, None] - EXACT).max(axis=2).min(axis=1) > 9  # Pillow does not tell nearer ones apart
    palette = PIL.Image.new("P", (1, 1))
    palette.putpalette(np.concatenate([shades[apart], EXACT]).ravel().tolist())
    first, *rest = [image.quantize(palette=palette, dither=PIL.Image.Dither.NONE) for image in images]
    duration = max(round(1000 * seconds / 10) * 10, 20)  # [ms], whole hundredths of a second; less is slowed down
    first.save(file, format="GIF", save_all=True, append_images=rest, duration=duration, loop=0, optimize=False)


def _write_mp4(file: Path, frames: Iterator[Image], seconds: float) -> None:
    import imageio_ffmpeg  # noqa: PLC0415

    first = next(frames)
    height, width, _ = first.shape
    # A player needs several pictures a second: each frame is written as often as it takes.
    times = max(1, round(seconds * 10))
    writer = imageio_ffmpeg.write_frames(
        str(file), (width, height), fps=times / seconds, macro_block_size=2, quality=7, ffmpeg_log_level="error"
    )
    writer.send(None)
    try:
        for frame in (first, *frames):
            for _ in range(times):
                writer.send(np.ascontiguousarray(frame))
    finally:
        writer.close()
