"""Scripts in a separate Python process, bounded in time: a library that aborts there leaves this process alone."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from .messages import say

PERIOD = 10  # between messages to the user [s]
MPI_VARIABLES = ("OMPI_", "PMIX_", "PRTE_", "PMI_", "MPICH_", "HYDRA_")  # the child is no process of the parent's MPI


def run_script(
    script: str, arguments: Sequence[str], folder: Path, seconds: int, work: Callable[[], str]
) -> tuple[int, str]:
    """Run a Python script in a folder; return its exit code, and the last line of its errors.

    Args:
        script: File of the script.
        arguments: Its arguments.
        folder: Its working directory.
        seconds: Time after which it is killed [s].
        work: Gives the begin of the message to the user every ten seconds, as "gmsh has read roof.msh".
    """
    environment = {name: value for name, value in os.environ.items() if not name.startswith(MPI_VARIABLES)}
    environment |= {"PYTHONPATH": os.pathsep.join(map(os.path.abspath, sys.path)), "OMP_NUM_THREADS": "1"}
    command = [sys.executable, "-P", "-W", "ignore", script, *arguments]
    pipe = subprocess.PIPE
    with subprocess.Popen(
        command, cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=pipe
    ) as child:
        try:
            words = _wait(child, seconds, work)
        finally:
            child.kill()  # also where the user interrupts
    return child.returncode, (words.strip().splitlines() or [f"exit code {child.returncode}"])[-1]


def _wait(child: subprocess.Popen[bytes], seconds: int, work: Callable[[], str]) -> str:
    """Error output of a child, once it has ended or its time is up."""
    for passed in range(0, seconds, PERIOD):
        if passed:
            say(f"{work()} for {passed} s")
        try:
            return child.communicate(timeout=min(PERIOD, seconds - passed))[1].decode(errors="replace")
        except subprocess.TimeoutExpired:
            continue
    child.kill()
    return child.communicate()[1].decode(errors="replace")
