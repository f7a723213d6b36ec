"""Every warning on a state is one of its remarks, and the report begins with them."""

import pickle
import warnings

import numpy as np
import pytest
from mpi4py import MPI

from fx_membrane import (
    Analysis,
    Cable,
    ConvergenceError,
    DistributedLoad,
    Fabric,
    LargeStrainWarning,
    LostPrestressWarning,
    Membrane,
    Newton,
    PointLoad,
    PrescribedDisplacement,
    Stage,
    Structure,
    Support,
    UnbalancedStateWarning,
    UnstableStateWarning,
    WorkLimit,
    boundary_edges,
    equilibrium_path,
    polyline,
    rectangle,
    report,
)

POINTS, TRIANGLES = rectangle(8, 6, 8, 8)
POINTS[:, 2] = POINTS[:, 0] * POINTS[:, 1] / 12
RIM = np.unique(boundary_edges(TRIANGLES))
ON_STATES = (LargeStrainWarning, UnbalancedStateWarning, UnstableStateWarning, LostPrestressWarning)


def hypar(**parts):
    return Structure(POINTS, {"fabric": Membrane(TRIANGLES, Fabric(5e5, 0.3), 2e3), **parts}, [Support(RIM)])


def ridged(stiffness):
    """Make a hypar with a cable across its middle."""
    return hypar(ridge=Cable(polyline(36 + np.arange(9)), stiffness, prestress=2e4))


def snow(weight):
    return Stage("snow", [DistributedLoad((0, 0, -weight), "fabric")])


def guys():
    """Two guys in line."""
    points = [[0.0, 0, 0], [4, 0, 0], [2, 0, 0]]
    parts = {"guys": Cable([[0, 2], [2, 1]], 1e6, prestress=1e3)}
    return Structure(points, parts, [Support([0]), Support([1, 2], "yz")])


LET_IN = Stage("let in", displacements=[PrescribedDisplacement([1, 2], [[-0.1, 0, 0], [-0.05, 0, 0]], "x")])
CASES = {
    "strained": (hypar(), snow(8000.0), Newton(), LargeStrainWarning),
    "a stiff cable": (ridged(1e18), snow(600.0), Newton(), UnbalancedStateWarning),
    "a coarse solver": (hypar(), snow(600.0), Newton(rtol=1e-2), UnbalancedStateWarning),
    "let in": (guys(), LET_IN, Newton(), LostPrestressWarning),
}


@pytest.mark.mpi_once
@pytest.mark.parametrize("name", CASES)
def test_warnings_are_the_remarks_that_the_report_begins_with(name):
    structure, stage, solver, category = CASES[name]
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        result = Analysis(structure, solver, comm=MPI.COMM_SELF).run([stage])[stage.name]
    told = [entry for entry in caught if issubclass(entry.category, ON_STATES)]
    assert category in [entry.category for entry in told]
    assert [str(entry.message) for entry in told] == [f"Stage {stage.name!r}: {text}" for text in result.remarks]
    assert [entry.category for entry in told] == [remark.category for remark in result.remarks]
    assert {entry.filename for entry in told} == {__file__}  # where the user called
    lines = report(result).splitlines()
    assert lines[: len(result.remarks)] == [f"WARNING: {text}" for text in result.remarks]
    again = pickle.loads(pickle.dumps(result.remarks))
    assert [remark.category for remark in again] == [remark.category for remark in result.remarks]


@pytest.mark.mpi
def test_a_point_of_a_path_has_them_too():
    path = equilibrium_path(hypar(), snow(8000.0), comm=MPI.COMM_SELF)
    with pytest.warns(LargeStrainWarning, match="^Stage 'snow': cell") as caught:
        state = path.state(-1, MPI.COMM_SELF)
    assert {entry.filename for entry in caught} == {__file__}
    assert "is strained by" in " ".join(state.remarks)
    assert path.state(0, MPI.COMM_SELF).remarks == ()


@pytest.mark.mpi
def test_last_state_of_a_failed_stage_has_them_too():
    more = Stage("more", [PointLoad(40, (0, 0, -1e5))], after="snow", increments=100)
    with (
        pytest.warns(LargeStrainWarning, match="^Stage 'snow': cell"),
        pytest.raises(ConvergenceError) as caught,
    ):
        Analysis(hypar(), limit=WorkLimit(iterations=40), comm=MPI.COMM_SELF).run([snow(8000.0), more])
    assert caught.value.last.name == "more"
    assert "is strained by" in " ".join(caught.value.last.remarks)


@pytest.mark.filterwarnings("error::fx_membrane.UnbalancedStateWarning")
def test_a_start_that_no_solver_has_found_is_not_out_of_balance():
    """The prestress of the reference shape is not in balance, and nobody said that it is."""
    with pytest.raises(ConvergenceError) as caught:
        Analysis(ridged(1e7), comm=MPI.COMM_SELF, limit=WorkLimit(iterations=1)).run([snow(600.0)])
    assert caught.value.last.equilibrium.residual > 1.0
    assert caught.value.last.remarks == ()
