"""Files that are written whole: devices and pipes in place, links to their targets, names that no encoding has."""

import json
import os
import threading
from pathlib import Path

import pytest
from click.testing import CliRunner

from fx_membrane import Analysis, Cable, PointLoad, Stage, Structure, Support, plot, polyline, write_tables
from fx_membrane.checks.paths import check_writable
from fx_membrane.cli import main
from fx_membrane.files.whole_file import writing


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no full device")
def test_full_device_stays_a_device():
    words = r"'/dev/full' cannot be written \(No space left on device\)"
    with pytest.raises(ValueError, match=words), writing(Path("/dev/full")) as stream:
        stream.write("words")
    assert Path("/dev/full").is_char_device()
    assert not Path("/dev/full.part").exists()


def test_pipe_is_written_in_place(tmp_path):
    pipe, heard = tmp_path / "pipe", []
    os.mkfifo(pipe)
    reader = threading.Thread(target=lambda: heard.append(pipe.read_text()))
    reader.start()
    with writing(pipe) as stream:
        stream.write("words")
    reader.join()
    assert heard == ["words"]
    assert pipe.is_fifo()


def test_link_keeps_its_target(tmp_path):
    (tmp_path / "store").mkdir()
    for name in ("latest.txt", "latest.png"):
        (tmp_path / name).symlink_to(tmp_path / "store" / name)
    for words in ("first", "second"):  # the first makes the target
        with writing(tmp_path / "latest.txt") as stream:
            stream.write(words)
        assert (tmp_path / "store" / "latest.txt").read_text() == words
    plot.wireframe([(0, 0, 0), (1, 0, 0)], {"rope": [(0, 1)]}, tmp_path / "latest.png")
    assert (tmp_path / "store" / "latest.png").stat().st_size > 1000
    assert (tmp_path / "latest.txt").is_symlink()
    assert (tmp_path / "latest.png").is_symlink()


def test_device_in_a_folder_without_write_permission_is_allowed(monkeypatch):
    monkeypatch.setattr(os, "access", lambda path, mode: str(path) != "/dev")
    check_writable("path", Path("/dev/null"))


def test_interrupted_files_of_the_command_leave_no_piece(tmp_path, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    for name in ("init", "demo"):
        monkeypatch.chdir(tmp_path)
        done = CliRunner().invoke(main, [name, *(["cone"] if name == "demo" else [])])
        assert done.exit_code == 2
        assert "No space left on device" in done.output
    assert list(tmp_path.iterdir()) == []


def test_names_that_spreadsheets_compute_and_no_encoding_has(tmp_path):
    names = ["\uff1d1+1", "\n=1+1", "rope \udc80"]
    points = [(0, 0, 0), (3, 0, 0), (6, 0, 0)]
    parts = {name: Cable(polyline([0, 1, 2]), 1e6, prestress=1e3) for name in names}
    pull = Stage("pull", [PointLoad(1, (0, 0, -10.0))])
    write_tables(Analysis(Structure(points, parts, [Support([0, 2])])).run([pull]), tmp_path, force_unit="=kN")
    text = (tmp_path / "cables.csv").read_text(encoding="utf-8-sig")
    assert "pull,'\uff1d1+1,0," in text
    assert 'pull,"\'\n=1+1",0,' in text
    assert r"pull,rope \udc80,0," in text
    assert list(json.loads((tmp_path / "summary.json").read_text())["stages"]["pull"]["parts"]) == names
    heads = text.splitlines()[0].split(",")
    assert heads[-1] == "force [=kN]"
    assert all(head[0].isalpha() for head in heads)
