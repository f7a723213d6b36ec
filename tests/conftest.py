"""Marks of tests that run again on several processes, and one report under MPI.

Only the first process reports tests; the exit codes of the others count, too.
"""

import os
import sys

import pytest
from mpi4py import MPI

pytest.register_assert_rewrite("interrupted", "models", "wrinkled")

# Files whose tests are the same on every process: plain NumPy, or single elements on COMM_SELF; and files of remarks,
# which follow from a result, after long searches for one. Tests in them that are collective are marked `mpi` there.
ONE_PROCESS = {
    "forms/test_dccf.py",
    "forms/test_equations.py",
    "forms/test_tension_direction.py",
    "forms/test_wrinkled_cells.py",
    "forms/test_wrinkling.py",
    "unit/test_bad_values.py",
    "unit/test_balance.py",
    "unit/test_derived_classes.py",
    "unit/test_fallen_masts.py",
    "unit/test_form_finding.py",
    "unit/test_forms_of_masts.py",
    "unit/test_geometry.py",
    "unit/test_line_search.py",
    "unit/test_loads.py",
    "unit/test_material.py",
    "unit/test_partition.py",
    "unit/test_parts.py",
    "unit/test_reasons.py",
    "unit/test_remarks.py",
    "unit/test_rigid_motion.py",
    "unit/test_slivers.py",
    "unit/test_structure.py",
    "unit/test_validation.py",
    "unit/test_work.py",
}


def pytest_collection_modifyitems(items):
    """Mark `mpi` every test of the other files, unless it says `serial`: a new test counts as collective."""
    for item in items:
        file = f"{item.path.parent.name}/{item.path.name}"
        if file not in ONE_PROCESS and not item.get_closest_marker("serial"):
            item.add_marker(pytest.mark.mpi)


@pytest.hookimpl(trylast=True)
def pytest_configure(config):
    reporter = config.pluginmanager.getplugin("terminalreporter")
    if MPI.COMM_WORLD.rank > 0 and reporter is not None:
        reporter._tw._file = open(os.devnull, "w")  # noqa: SIM115  (open until pytest ends)


@pytest.hookimpl(trylast=True)
def pytest_unconfigure():
    # The first process that ends with a failure ends all others: wait until the report is out.
    sys.stdout.flush()
    MPI.COMM_WORLD.Barrier()
