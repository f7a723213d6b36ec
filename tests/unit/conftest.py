"""What several unit tests start from."""

import pytest
from mpi4py import MPI

from fx_membrane import Analysis
from models import sheet


@pytest.fixture(scope="module")
def analysis():
    """Of the square sheet."""
    return Analysis(sheet())


@pytest.fixture
def path(tmp_path):
    """A file that all processes mean."""
    return MPI.COMM_WORLD.bcast(tmp_path / "results" / "state.npz")
