"""Numbers and flags of all processes, on one and on several."""

import math

import pytest
from mpi4py import MPI

from fx_membrane.runtime.processes import everywhere, somewhere, summed

COMM = MPI.COMM_WORLD


@pytest.mark.mpi
@pytest.mark.parametrize("first", [True, False])
@pytest.mark.parametrize("others", [True, False])
def test_flags(first, others):
    mine = first if COMM.rank == 0 else others
    flags = [first, *[others] * (COMM.size - 1)]
    assert everywhere(COMM, mine) is all(flags)
    assert somewhere(COMM, mine) is any(flags)


@pytest.mark.mpi
def test_sum():
    assert summed(COMM, 1.5 + COMM.rank) == 1.5 * COMM.size + COMM.size * (COMM.size - 1) / 2
    assert math.isnan(summed(COMM, math.nan if COMM.rank == 0 else 1.0))
