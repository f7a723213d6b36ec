"""Test of rounding: node by node, and by the nodes that parts use."""

import warnings

import numpy as np
import pytest
from mpi4py import MPI

from fx_membrane import (
    Analysis,
    Cable,
    ConjugateGradient,
    ConvergenceError,
    DistributedLoad,
    Fabric,
    Mast,
    Membrane,
    Newton,
    PointLoad,
    PrescribedDisplacement,
    Pressure,
    Stage,
    SteepestDescent,
    Structure,
    Support,
    UnbalancedStateWarning,
    UnstableStateWarning,
    boundary_edges,
    equilibrium_path,
    rectangle,
    updated_reference,
)

POINTS, TRIANGLES = rectangle(8, 6, 8, 8)
POINTS[:, 2] = POINTS[:, 0] * POINTS[:, 1] / 12
EDGE = np.unique(boundary_edges(TRIANGLES))
COUNT = len(POINTS)
MIDDLE = COUNT // 2


def fabric(unit=1.0, prestress=2e3):
    return Membrane(TRIANGLES, Fabric(5e5 * unit, 0.3), prestress * unit)


def roof(unit=1.0, prestress=2e3):
    return Structure(POINTS, {"fabric": fabric(unit, prestress)}, [Support(EDGE)])


def beside(part, unit=1.0, prestress=2e3):
    """Roof beside an independent part of two nodes."""
    points = np.vstack([POINTS, [[9, 0, 0], [9, 0, 3.0]]])
    supports = [Support([*EDGE, COUNT]), Support(COUNT + 1, "xy")]
    return Structure(points, {"fabric": fabric(unit, prestress), "other": part}, supports)


def snow(unit=1.0):
    return Stage("snow", [DistributedLoad((0, 0, -600.0 * unit), "fabric")])


def final(structure, stage, solver=Newton()):
    return Analysis(structure, solver).run([stage])[stage.name]


STAGES = {
    "snow": snow(),
    "wind": Stage("wind", [Pressure(600.0, "fabric")]),
    "prestress": Stage("prestress"),
    "moved": Stage("moved", displacements=[PrescribedDisplacement(int(EDGE[0]), (0, 0, 0.1))]),
    "point load": Stage("point load", [PointLoad(MIDDLE, (0, 0, -1e-3))]),
}


@pytest.mark.parametrize("stiffness", [1e7, 1e12, 1e15, 1e18, 1e24, 1e30])
@pytest.mark.parametrize("kind", [Mast, Cable])
def test_stiff_part_beside_changes_nothing(kind, stiffness):
    supported = Structure(POINTS, {"fabric": fabric()}, [Support(EDGE)])
    alone, both = final(supported, snow()), final(beside(kind([[COUNT, COUNT + 1]], stiffness)), snow())
    assert both.displacement[:COUNT] == pytest.approx(alone.displacement, abs=1e-12)
    assert both.equilibrium.residual < 1e-10 * 600


@pytest.mark.mpi_once
@pytest.mark.parametrize("name", STAGES)
def test_stiff_mast_beside_changes_nothing_under_any_load(name):
    structure = beside(Mast([[COUNT, COUNT + 1]], 1e20))
    supports = [Support(EDGE[1:]), *structure.supports[1:], Support(COUNT)] if name == "moved" else structure.supports
    alone = [Support(EDGE[1:])] if name == "moved" else [Support(EDGE)]
    both = final(Structure(structure.points, structure.parts, supports), STAGES[name])
    expected = final(Structure(POINTS, {"fabric": fabric()}, alone), STAGES[name])
    assert both.displacement[:COUNT] == pytest.approx(expected.displacement, abs=1e-12)


@pytest.mark.parametrize("stiffness", [1e12, 1e18, 1e30])
def test_stiff_fabric_beside_changes_nothing(stiffness):
    points, triangles = rectangle(2, 2, 2, 2)
    parts = {"fabric": fabric(), "other": Membrane(triangles + COUNT, Fabric(stiffness, 0.3))}
    edge = np.unique(boundary_edges(triangles)) + COUNT
    state = final(
        Structure(np.vstack([POINTS, points + np.array([20, 0, 0])]), parts, [Support([*EDGE, *edge])]), snow()
    )
    assert state.displacement[:COUNT] == pytest.approx(final(roof(), snow()).displacement, abs=1e-10)


@pytest.mark.parametrize("prestress", [1e9, 1e15])
def test_strong_prestress_beside_changes_nothing(prestress):
    points = np.vstack([POINTS, [[9, 0, 0], [9, 0, 3.0]]])
    parts = {"fabric": fabric(), "other": Cable([[COUNT, COUNT + 1]], 1e3 * prestress, prestress)}
    state = final(Structure(points, parts, [Support([*EDGE, COUNT, COUNT + 1])]), snow())
    assert state.displacement[:COUNT] == pytest.approx(final(roof(), snow()).displacement, abs=1e-9)


@pytest.mark.parametrize("stiffness", [1e7, 1e20])
@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3], ids=["kN", "N", "mN"])
def test_units_of_force_do_not_matter_beside_a_stiff_part(unit, stiffness):
    state = final(beside(Mast([[COUNT, COUNT + 1]], stiffness * unit), unit), snow(unit))
    assert state.displacement[:COUNT] == pytest.approx(final(roof(), snow()).displacement, abs=1e-12)


@pytest.mark.parametrize("stiffness", [1e12, 1e15, 1e17])
def test_stiff_fabric_alone_carries_its_load(stiffness):
    state = final(
        Structure(POINTS, {"fabric": Membrane(TRIANGLES, Fabric(stiffness, 0.3), 2e3)}, [Support(EDGE)]), snow()
    )
    assert state.equilibrium.reactions[2] == pytest.approx(-state.equilibrium.loads[2], rel=1e-9)
    assert 0 < np.abs(state.displacement).max() < 1e7 / stiffness


@pytest.mark.mpi_once
@pytest.mark.parametrize("stiffness", [1e9, 1e18, 1e24, 1e30])
def test_rounding_that_is_no_equilibrium_is_told(stiffness):
    """A mast carries a corner of the roof; the stiffest ones leave no digits of its force."""
    corner = EDGE[-1]
    points = np.vstack([POINTS, POINTS[corner] + [[1.0, 1, 0.3], [0, 0, -3]]])
    mast, guy = Mast([[corner, COUNT + 1]], stiffness), Cable([[corner, COUNT]], 1e6, 1e3)
    supports = [Support([*EDGE[:-1], COUNT, COUNT + 1])]
    structure = Structure(points, {"fabric": fabric(), "mast": mast, "guy": guy}, supports)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        state = final(structure, snow())
    told = [str(entry.message) for entry in caught if entry.category is UnbalancedStateWarning]
    off = state.equilibrium.residual > 1e-6 * np.abs(state.equilibrium.loads).max()
    assert off == (stiffness > 1e15)
    assert len(told) == int(off and not MPI.COMM_WORLD.rank)  # the first process warns for all
    for message in told:
        assert f"unbalanced force of {state.equilibrium.residual:.3g} " in message
        assert "a smaller rtol, or the test of a solver of your own" in message
        assert "far stiffer" in message


def test_coarse_tolerance_is_told():
    with pytest.warns(UnbalancedStateWarning, match=r"^Stage 'snow'.*unbalanced force.*beside loads.*2\.\d+e\+04"):
        final(roof(), snow(), Newton(rtol=1e-2))


@pytest.mark.parametrize("prestress", [1e6, 1e9])
def test_small_load_on_a_strong_prestress_is_carried(prestress):
    stage = Stage("load", [PointLoad(MIDDLE, (0, 0, -1.0))])
    flat = POINTS * [1, 1, 0]
    state = final(Structure(flat, {"fabric": Membrane(TRIANGLES, Fabric(5e5, 0.3), prestress)}, [Support(EDGE)]), stage)
    assert state.equilibrium.reactions[2] == pytest.approx(1.0, rel=1e-6)


@pytest.mark.mpi
def test_form_of_a_stiff_cable_is_found():
    """Form finding ignores the elasticity, which must not loosen its tolerance."""
    edges = [[i, i + 1] for i in range(4)]
    points = np.array([[i, 0, 0.3 * i * (4 - i)] for i in range(5)], dtype=float)
    form = updated_reference(Structure(points, {"cable": Cable(edges, 1e30, 1e3)}, [Support([0, 4])]))
    assert form.structure.points[:, 2] == pytest.approx(np.zeros(5), abs=1e-9)


@pytest.mark.mpi
@pytest.mark.parametrize(
    "solver", [ConjugateGradient(preconditioner="tangent"), SteepestDescent(preconditioner="tangent")]
)
def test_first_order_methods_mind_their_nodes_too(solver):
    state = final(beside(Mast([[COUNT, COUNT + 1]], 1e20)), snow(), solver)
    assert state.equilibrium.residual < 1e-5 * np.linalg.norm(state.loads)


@pytest.mark.mpi
def test_path_minds_its_nodes_too():
    points = equilibrium_path(beside(Mast([[COUNT, COUNT + 1]], 1e20)), snow()).points
    assert points[-1].displacement[:COUNT] == pytest.approx(final(roof(), snow()).displacement, abs=1e-9)


@pytest.mark.mpi
def test_loose_node_is_named_beside_a_stiff_part():
    flat = POINTS * [1, 1, 0]
    structure = beside(Mast([[COUNT, COUNT + 1]], 1e30), prestress=0.0)
    points = np.vstack([flat, structure.points[COUNT:]])
    held = Support(EDGE)
    middle = [node for node in range(COUNT) if node not in EDGE]
    with pytest.raises(ConvergenceError, match=rf"nothing holds node {middle[0]} \(and {len(middle) - 1} more nodes\)"):
        final(Structure(points, structure.parts, [held, *structure.supports]), snow(), Newton(line_search=False))


@pytest.mark.parametrize("far", [1e3, 1e6, 1e10, pytest.param(1e12, marks=pytest.mark.mpi), 1e20, -1e12])
def test_unused_node_changes_nothing(far):
    structure = Structure(np.vstack([POINTS, [[far, 0, far]]]), {"fabric": fabric()}, [Support(EDGE)])
    assert structure.size == 8
    assert final(structure, snow()).displacement[:COUNT] == pytest.approx(final(roof(), snow()).displacement, abs=1e-12)


def test_unused_node_hides_no_warning():
    points, triangles = rectangle(2, 2, 8, 8)
    banner = {"fabric": Membrane(triangles, Fabric(5e5, 0.3))}
    structure = Structure(np.vstack([points, [[100.0, 0, 0]]]), banner, [Support(range(9))])
    with pytest.warns(UnstableStateWarning, match=r"moved.*2\.83.*half.*size"):
        final(structure, Stage("weight", [DistributedLoad((0, 0, -10.0), "fabric")]))
