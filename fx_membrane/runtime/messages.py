"""Words to whoever watches a run."""

import sys

from mpi4py import MPI
from tqdm import tqdm


def say(text: str) -> None:
    """Prints a line to stderr, beside any progress bar; one process of all speaks."""
    if MPI.COMM_WORLD.rank == 0 and sys.stderr is not None:
        tqdm.write(text, file=sys.stderr)
