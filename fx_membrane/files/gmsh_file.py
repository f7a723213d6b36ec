"""Mesh file read by gmsh in a separate process.

gmsh runs commands in any file that is a script, and in `x.msh.opt` beside `x.msh`; damaged files abort it or never end.
So it gets copies of files that begin as meshes do, and a child process limits the damage.
"""

from __future__ import annotations

import os
import shutil
import signal
import stat
import tempfile
from contextlib import ExitStack
from pathlib import Path

from ..runtime.child_process import run_script
from ..runtime.gmsh_process import FAILED, NO_GMSH, not_started
from . import gmsh_reader
from .gmsh_reader import GmshMesh

BEGIN = b"$MeshFormat"
SECONDS, SECONDS_PER_MEGABYTE = 60, 1  # ten times the time of gmsh
BUSY = 20  # seconds by the clock for one of work, on a machine with many other processes
NO_SCRIPT = 2  # exit code of Python


def read(source: str | Path) -> GmshMesh:
    """Read the mesh of a file of gmsh's formats 2 and 4.

    Raises:
        ValueError: The file cannot be opened, is not a mesh, or gmsh ends or does not end on it.
        ImportError: gmsh is not installed.
    """
    with tempfile.TemporaryDirectory(prefix="fx_membrane-") as folder:
        mesh, arrays = Path(folder, "mesh.msh"), Path(folder, "arrays.npz")
        _copy(source, mesh)
        seconds = SECONDS + SECONDS_PER_MEGABYTE * mesh.stat().st_size // 2**20
        arguments = [mesh.name, arrays.name, str(seconds)]
        code, words = run_script(
            gmsh_reader.__file__, arguments, Path(folder), BUSY * seconds, lambda: f"gmsh has read {source}"
        )
        if code:
            _refuse(source, code, words.replace("mesh.msh", Path(source).name), seconds)
        found = gmsh_reader.load(arrays)
    if not len(found.tags):
        raise ValueError(
            f"{source} begins as a mesh, but has no nodes: it is damaged, or its model was not meshed; write it again "
            "with gmsh.write."
        )
    return found


def _copy(source: str | Path, target: Path) -> None:
    unreadable = f"{source} cannot be read ({{}}); make it readable, as by chmod +r."
    try:
        kind = os.stat(source).st_mode
    except (FileNotFoundError, NotADirectoryError):
        raise ValueError(f"There is no file {source}; give the name of a gmsh mesh.") from None
    except OSError as error:
        raise ValueError(unreadable.format(error.strerror)) from None
    if stat.S_ISDIR(kind):
        raise ValueError(f"{source} is a folder; give the name of a gmsh mesh in it.")
    if not stat.S_ISREG(kind):
        raise ValueError(f"{source} is no ordinary file; give the name of a gmsh mesh.")
    with ExitStack() as opened:
        try:
            file = opened.enter_context(open(source, "rb"))
            begin = file.read(len(BEGIN))
        except OSError as error:
            raise ValueError(unreadable.format(error.strerror)) from None
        if begin != BEGIN:
            raise ValueError(
                f"{source} does not begin with {BEGIN.decode()}, as meshes of gmsh's formats 2 and 4 do, but with "
                f"{begin!r}; `gmsh -2` makes a mesh of a geometry, and gmsh.write of a meshed model."
            )
        with open(target, "wb") as copy:  # of the checked content, from the same open file
            copy.write(begin)
            shutil.copyfileobj(file, copy)


def _refuse(source: str | Path, code: int, words: str, seconds: int) -> None:
    if code == NO_GMSH:
        raise not_started(words)
    if code == FAILED:
        raise ValueError(f"{source} is not a file that gmsh can read ({words}); write it again with gmsh.write.")
    if code == NO_SCRIPT:
        raise RuntimeError(f"The process that reads {source} failed ({words}).")
    if -code in {signal.SIGKILL, signal.SIGXCPU}:
        words = f"gmsh was stopped, after {seconds} s of work, {BUSY * seconds} s by the clock, or where memory ended"
    elif code < 0:
        words = f"gmsh ended by {signal.Signals(-code).name}"
    raise ValueError(f"{source} is damaged, and no file that gmsh can read ({words}); write it again with gmsh.write.")
