"""Marks of tests that run again on several processes, and one report under MPI.

Only the first process reports tests; the exit codes of the others count, too.
"""

import ctypes
import os
import sys
from pathlib import Path

import pytest

pytest.register_assert_rewrite("bad_values", "interrupted", "models", "pictures", "wrinkled")

TESTS = Path(__file__).parent

# Files whose tests are the same on every process: plain NumPy, or single elements on COMM_SELF; files of remarks, which
# follow from a result, after long searches for one; and long studies of one kind of work, by many meshes, loads or
# numbers. Tests in them that are collective are marked `mpi` there: of a study, one or two of each kind of work.
ONE_PROCESS = {
    "forms/test_dccf.py",
    "forms/test_equations.py",
    "forms/test_hyperelasticity.py",
    "forms/test_tension_direction.py",
    "forms/test_tension_field.py",
    "forms/test_tension_field_of_cables.py",
    "forms/test_wrinkled_cells.py",
    "forms/test_wrinkling.py",
    "unit/analysis/test_mass_units.py",
    "unit/analysis/test_reasons.py",
    "unit/analysis/test_work.py",
    "unit/assembly/test_partition.py",
    "unit/assembly/test_rounding.py",
    "unit/checks/test_validation.py",
    "unit/files/test_archive.py",
    "unit/form_finding/test_bodies.py",
    "unit/form_finding/test_cable_lines.py",
    "unit/form_finding/test_constraints_of_all_methods.py",
    "unit/form_finding/test_constraints_of_cables.py",
    "unit/form_finding/test_constraints_of_cables_refusals.py",
    "unit/form_finding/test_constraints_of_nodes_refusals.py",
    "unit/form_finding/test_form_finding.py",
    "unit/form_finding/test_forms_of_masts.py",
    "unit/form_finding/test_mast_heads.py",
    "unit/form_finding/test_masts_and_stays.py",
    "unit/form_finding/test_masts_and_stays_refusals.py",
    "unit/form_finding/test_natural_force_density.py",
    "unit/form_finding/test_no_form.py",
    "unit/form_finding/test_projected_stress.py",
    "unit/form_finding/test_projected_stress_refusals.py",
    "unit/form_finding/test_rings.py",
    "unit/form_finding/test_slides.py",
    "unit/form_finding/test_told_by_methods.py",
    "unit/form_finding/test_unsettled_plans.py",
    "unit/geometry/test_extremes.py",
    "unit/geometry/test_geometry.py",
    "unit/model/test_coincidence.py",
    "unit/model/test_derived_classes.py",
    "unit/model/test_derived_laws.py",
    "unit/model/test_laws.py",
    "unit/model/test_loads.py",
    "unit/model/test_material.py",
    "unit/model/test_parts.py",
    "unit/model/test_rigid_motion.py",
    "unit/model/test_slivers.py",
    "unit/model/test_structure.py",
    "unit/results/test_balance.py",
    "unit/results/test_fallen_masts.py",
    "unit/results/test_large_strain.py",
    "unit/results/test_remarks.py",
    "unit/solvers/test_iteration_limit.py",
    "unit/solvers/test_line_search.py",
    "unit/surfaces/test_drainage.py",
    "unit/surfaces/test_surface_lines.py",
    "unit/test_bad_values.py",
    "unit/test_messages.py",
    "verification/test_constrained_forms.py",
    "verification/test_edge_arcs.py",
    "verification/test_hand_over.py",
    "verification/test_inflation.py",
    "verification/test_limit_points.py",
    "verification/test_minimal_surfaces.py",
    "verification/test_rubber_balloon.py",
    "verification/test_rubber_disc.py",
}


def pytest_collection_modifyitems(items):
    """Mark `mpi` every test of the other files, unless it says `serial`: a new test counts as collective."""
    for item in items:
        file = item.path.relative_to(TESTS).as_posix()
        if file not in ONE_PROCESS and not item.get_closest_marker("serial"):
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
