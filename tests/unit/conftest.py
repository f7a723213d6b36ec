"""Fixtures of several unit tests."""

import pytest
from mpi4py import MPI

from fx_membrane import Analysis
from models import sheet


@pytest.fixture(scope="module")
def analysis():
    """Analysis of the square sheet."""
    return Analysis(sheet())


@pytest.fixture
def path(tmp_path):
    """Path of one file for all processes."""
    return MPI.COMM_WORLD.bcast(tmp_path / "results" / "state.npz")
