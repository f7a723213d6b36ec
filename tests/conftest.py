"""Marks of tests that run again on several processes, and one report under MPI.

Only the first process reports tests; the exit codes of the others count, too.
"""

import ctypes
import os
import sys

import pytest

pytest.register_assert_rewrite("bad_values", "interrupted", "models", "pictures", "wrinkled")


def pytest_collection_modifyitems(items):
    """Mark `mpi` the first case of each study that is marked `mpi_once`."""
    begun = set()
    for item in items:
        study = item.nodeid.split("[")[0]
        if item.get_closest_marker("mpi_once") and study not in begun:
            begun.add(study)
            item.add_marker(pytest.mark.mpi)


def starts_others(config):
    """Tell the process that only distributes tests (`pytest --numprocesses 2`)."""
    return bool(config.getoption("numprocesses", None))


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_setupnodes():
    """Remove what MPI wrote into the environment of C: processes that inherit it could start no others.

    MPI is started in the process that distributes tests, too, by the conftest.py of a folder named on its command line.
    """
    ctypes.CDLL(None).clearenv()
    for name, value in os.environ.items():
        os.putenv(name, value)


@pytest.hookimpl(trylast=True)
def pytest_configure(config):
    if starts_others(config):
        return  # MPI would write into the environment that the others inherit: they could start no processes
    from mpi4py import MPI  # noqa: PLC0415

    reporter = config.pluginmanager.getplugin("terminalreporter")
    if MPI.COMM_WORLD.rank > 0 and reporter is not None:
        reporter._tw._file = open(os.devnull, "w")  # noqa: SIM115  (open until pytest ends)


@pytest.hookimpl(trylast=True)
def pytest_unconfigure(config):
    if starts_others(config):
        return
    from mpi4py import MPI  # noqa: PLC0415

    # The first process that ends with a failure ends all others: wait until the report is out.
    sys.stdout.flush()
    MPI.COMM_WORLD.Barrier()
