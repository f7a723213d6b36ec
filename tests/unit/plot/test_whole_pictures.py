"""Pictures are written whole or not at all: an earlier one stays where the disk is full."""

import errno
import os

import numpy as np
import PIL.Image
import pytest

from fx_membrane.plot import movies
from fx_membrane.plot.figures import save


class Torn:
    """Figure whose file ends in the middle."""

    def savefig(self, file, **_):
        file.write_bytes(b"half")
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


@pytest.mark.parametrize("name", ["a.png", "a.svg", "a"])
def test_earlier_picture_stays_on_a_full_disk(name, tmp_path):
    (tmp_path / name).write_bytes(b"whole")
    with pytest.raises(ValueError, match="No space left"):
        save(Torn(), tmp_path / name)
    assert (tmp_path / name).read_bytes() == b"whole"
    assert [file.name for file in tmp_path.iterdir()] == [name]


def test_earlier_movie_stays_on_a_full_disk(tmp_path, monkeypatch):
    def torn(file, *_):
        Torn().savefig(file)

    monkeypatch.setattr(movies, "_write_gif", torn)
    (tmp_path / "a.gif").write_bytes(b"whole")
    with pytest.raises(ValueError, match="No space left"):
        movies.write(tmp_path / "a.gif", [], 1.0)
    assert [(file.name, file.read_bytes()) for file in tmp_path.iterdir()] == [("a.gif", b"whole")]


def test_paper_of_a_gif_stays_white_beside_pale_shades(tmp_path):
    """Pillow took white for the nearest of the fours below it: a pale shade at the borders of letters."""
    frame = np.full((60, 60, 3), 255, dtype=np.uint8)
    for row, shade in enumerate([(251, 248, 252), (247, 249, 252), (252, 249, 247)]):
        frame[20 * row : 20 * row + 15, :30] = shade
    movies.write(tmp_path / "a.gif", [frame, frame], 0.5)
    with PIL.Image.open(tmp_path / "a.gif") as image:
        assert image.convert("RGB").getpixel((50, 10)) == (255, 255, 255)
