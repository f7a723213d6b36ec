"""Fixtures of several unit tests."""

import os

import pytest
from mpi4py import MPI

from fx_membrane import Analysis
from models import sheet


@pytest.fixture(scope="module")
def analysis():
    """Analysis of the square sheet."""
    return Analysis(sheet())


@pytest.fixture(scope="session")
def own_cache(tmp_path_factory):
    """Environment with a cache that begins cold; scripts that count compiled forms share it and compile new ones.

    They ask for no speed: the compiler takes a third of its time without optimization.
    """
    folder = tmp_path_factory.mktemp("cache")
    compiler = folder / "cc"
    compiler.write_text('#!/bin/sh\nexec gcc "$@" -O0\n')
    compiler.chmod(0o755)
    return os.environ | {"XDG_CACHE_HOME": str(folder), "CC": str(compiler)}


@pytest.fixture
def path(tmp_path):
    """Path of one file for all processes."""
    return MPI.COMM_WORLD.bcast(tmp_path / "results" / "state.npz")
