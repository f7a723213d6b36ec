"""Mesh file read by gmsh in a separate process.

gmsh runs commands in any file that is a script, and in `x.msh.opt` beside `x.msh`; damaged files abort it or never end.
So it gets copies of files that begin as meshes do, and a child process limits the damage.
"""

import os
import shutil
import signal
import stat
import subprocess
import sys
import tempfile
from contextlib import ExitStack
from pathlib import Path

from ..runtime.messages import say
from . import gmsh_reader
from .gmsh_reader import GmshMesh

BEGIN = b"$MeshFormat"
SECONDS, SECONDS_PER_MEGABYTE = 60, 1  # ten times the time of gmsh
NO_SCRIPT = 2  # exit code of Python
PERIOD = 10  # between messages to the user [s]
MPI_VARIABLES = ("OMPI_", "PMIX_", "PRTE_", "PMI_", "MPICH_", "HYDRA_")  # the child is no process of the parent's MPI


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
        _run_reader(source, [mesh.name, arrays.name, str(seconds)], Path(folder), seconds)
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


def _run_reader(source: str | Path, arguments: list[str], folder: Path, seconds: int) -> None:
    environment = {name: value for name, value in os.environ.items() if not name.startswith(MPI_VARIABLES)}
    environment |= {"PYTHONPATH": os.pathsep.join(map(os.path.abspath, sys.path)), "OMP_NUM_THREADS": "1"}
    command = [sys.executable, "-P", "-W", "ignore", gmsh_reader.__file__, *arguments]
    pipe = subprocess.PIPE
    with subprocess.Popen(
        command, cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=pipe
    ) as child:
        try:
            words = _wait(child, source, seconds)
        finally:
            child.kill()  # also where the user interrupts
    if child.returncode:
        last = (words.strip().splitlines() or [f"exit code {child.returncode}"])[-1]
        _refuse(source, child.returncode, last.replace("mesh.msh", Path(source).name), seconds)


def _wait(child: subprocess.Popen[bytes], source: str | Path, seconds: int) -> str:
    """Error output of a child, once it has ended or its time is up."""
    for passed in range(0, seconds, PERIOD):
        if passed:
            say(f"gmsh has read {source} for {passed} s")
        try:
            return child.communicate(timeout=min(PERIOD, seconds - passed))[1].decode(errors="replace")
        except subprocess.TimeoutExpired:
            continue
    child.kill()
    return child.communicate()[1].decode(errors="replace")


def _refuse(source: str | Path, code: int, words: str, seconds: int) -> None:
    if code == gmsh_reader.NO_GMSH:
        raise ImportError(f"gmsh does not start ({words}); install it: apt install python3-gmsh, or pip install gmsh.")
    if code == gmsh_reader.NOT_READ:
        raise ValueError(f"{source} is not a file that gmsh can read ({words}); write it again with gmsh.write.")
    if code == NO_SCRIPT:
        raise RuntimeError(f"The process that reads {source} failed ({words}).")
    if -code in {signal.SIGKILL, signal.SIGXCPU}:
        words = f"gmsh was stopped, after {seconds} s or where memory ended"
    elif code < 0:
        words = f"gmsh ended by {signal.Signals(-code).name}"
    raise ValueError(f"{source} is damaged, and no file that gmsh can read ({words}); write it again with gmsh.write.")
