"""One report under MPI: processes other than the first test in silence; their exit codes count all the same."""

import os
import sys

import pytest
from mpi4py import MPI

pytest.register_assert_rewrite("interrupted", "models", "wrinkled")


@pytest.hookimpl(trylast=True)
def pytest_configure(config):
    reporter = config.pluginmanager.getplugin("terminalreporter")
    if MPI.COMM_WORLD.rank > 0 and reporter is not None:
        reporter._tw._file = open(os.devnull, "w")  # noqa: SIM115  (open until pytest ends)


@pytest.hookimpl(trylast=True)
def pytest_unconfigure():
    # The first process to end in failure ends them all: not before the report is out.
    sys.stdout.flush()
    MPI.COMM_WORLD.Barrier()
