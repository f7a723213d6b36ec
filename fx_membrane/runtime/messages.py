"""Messages to the user during a run."""

import sys

from mpi4py import MPI
from tqdm import tqdm


def say(text: str) -> None:
    """Print a line to stderr, beside any progress bar; only one process prints."""
    if MPI.COMM_WORLD.rank == 0 and sys.stderr is not None:
        tqdm.write(text, file=sys.stderr)
