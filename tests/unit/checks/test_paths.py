"""Output files: impossible names are refused before anything is computed or drawn."""

from pathlib import Path

import numpy as np
import pytest

from fx_membrane import Analysis, PointLoad, Stage, plot
from models import arch

PUSH = Stage("push", [PointLoad(1, (0, 0, -1.0))])


@pytest.mark.parametrize(
    ("name", "message"),
    [
        (5, "is 5.*text.*Path"),
        (b"a.npz", r"is b'a\.npz'.*text.*Path"),
        ("", "is ''.*name.*file"),
        ("folder/", "is '.*folder/'; give the name"),
        (".", "folder.*name.*file"),
        ("a\0b", "without zero bytes"),
        ("n" * 300, "300 bytes.*one name 300.*too long.*names.*245"),
        ("missing/" + "n" * 300, "too long"),
        ("ab/" * 2000 + "c", "too long.*4086"),
        ("\udc41\ud800", "letters.*no file name"),
        ("file.txt/a", r"file\.txt.*no folder"),
        ("/dev/null/a", "/dev/null.*no folder"),
        ("/dev/null/b/c", "/dev/null.*no folder"),
    ],
)
def test_name_that_no_file_can_have(tmp_path, monkeypatch, name, message):
    monkeypatch.chdir(tmp_path)
    Path("file.txt").write_text("")

    class Never:
        def __call__(self, *_):
            raise AssertionError("something was computed")

    analysis = Analysis(arch())
    analysis._solve = Never()
    calls = {
        "checkpoint_file": lambda: analysis.run([PUSH], name),
        "path": lambda: plot.wireframe(np.eye(3), {"a": [[0, 1, 2]]}, name),
    }
    for argument, call in calls.items():
        with pytest.raises(ValueError, match=f"^{argument} .*{message}"):
            call()
    assert [entry.name for entry in tmp_path.iterdir()] == ["file.txt"]


def test_folders_are_made(tmp_path):
    Analysis(arch()).run([PUSH], tmp_path / "a" / "b" / ("n" * 245))
    plot.wireframe(np.eye(3), {"a": [[0, 1, 2]]}, str(tmp_path / "c" / "d" / "lines.png"))
    assert len([entry for entry in tmp_path.rglob("*") if entry.is_file()]) == 2
