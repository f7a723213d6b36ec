"""Pictures are written whole or not at all: an earlier one stays where the disk is full."""

import errno
import os

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
