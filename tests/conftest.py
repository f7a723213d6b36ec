"""Marks of tests that run again on several processes, and one report under MPI.

Only the first process reports tests; the exit codes of the others count, too.
"""

import ctypes
import os
import sys

import pytest

pytest.register_assert_rewrite("bad_values", "interrupted", "models", "pictures", "wrinkled")


def pytest_ignore_collect(collection_path, config):
    """Leave files without collective tests unread where only those are asked for; three processes read each file."""
    alone = config.option.markexpr in ("mpi", "mpi and first") and collection_path.suffix == ".py"
    return True if alone and "mark.mpi" not in collection_path.read_text(encoding="utf-8") else None


def pytest_collection_modifyitems(items):
    """Mark `mpi` one case of each `mpi_once`, `further` all but one of a `study`, `first` as pyproject.toml says."""
    begun = set()
    for item in items:
        if item.get_closest_marker("mpi_once") and first_of(item, begun, "mpi_once"):
            item.add_marker(pytest.mark.mpi)
        subjects = {item.path} | ({(item.path, "mpi")} if item.get_closest_marker("mpi") else set())
        if not subjects <= begun:
            item.add_marker(pytest.mark.first)
        begun |= subjects
        if item.get_closest_marker("study") and not first_of(item, begun, "study"):
            item.add_marker(pytest.mark.further)


def first_of(item, begun, mark):
    """Return True for the first of the cases that differ in the named arguments only, or of all without names."""
    varied = item.get_closest_marker(mark).args
    kept = [(name, id(value)) for name, value in item.callspec.params.items() if name not in varied] if varied else []
    case = mark, item.nodeid.split("[")[0], *kept  # cases share the objects of their arguments, which can be arrays
    first = case not in begun
    begun.add(case)
    return first


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
