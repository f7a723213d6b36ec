"""Unbalanced forces that are nothing but rounding are not told; others are."""

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    DistributedLoad,
    Fabric,
    Mast,
    Membrane,
    Newton,
    PrescribedDisplacement,
    Stage,
    Structure,
    Support,
    UnbalancedStateWarning,
    boundary_edges,
    polyline,
    rectangle,
)

POINTS, TRIANGLES = rectangle(8, 6, 8, 8)
POINTS[:, 2] = POINTS[:, 0] * POINTS[:, 1] / 12
RIM = np.unique(boundary_edges(TRIANGLES))
COUNT = len(POINTS)
UNITS = pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3], ids=["kN", "N", "mN"])
strict = pytest.mark.filterwarnings("error::fx_membrane.UnbalancedStateWarning")


def hypar(unit=1.0, prestress=2e3, ridge=None, held=RIM):
    fabric = Membrane(TRIANGLES, Fabric(5e5 * unit, 0.3), prestress * unit)
    cable = {"ridge": Cable(polyline(36 + np.arange(9)), ridge * unit, prestress=2e4 * unit)} if ridge else {}
    parts = {"fabric": fabric, **cable}
    return Structure(POINTS, parts, [Support(held)] if len(held) else [])


def snow(weight, after=None):
    return Stage("snow", [DistributedLoad((0, 0, -weight), "fabric")], after=after)


@strict
@UNITS
@pytest.mark.parametrize("weight", [1e-13, 1e-9, 1e-6, 1.0])
@pytest.mark.parametrize("ridge", [None, 1e7], ids=["in balance", "moved by its prestress"])
def test_small_loads_on_a_prestressed_roof_are_silent(unit, weight, ridge):
    results = Analysis(hypar(unit, ridge=ridge)).run([Stage("prestress"), snow(weight * unit, after="prestress")])
    assert results["snow"].remarks == ()


@pytest.mark.mpi
@strict
@UNITS
@pytest.mark.filterwarnings("ignore::fx_membrane.LostPrestressWarning")
def test_lost_prestress_is_not_out_of_balance(unit):
    """All forces are rounding: in N, 2e-13 are left beside reactions of 2e-13."""
    angle = np.arange(2) * 2 * np.pi / 3
    feet = np.column_stack([3 * np.cos(angle), 3 * np.sin(angle), 0 * angle])
    parts = {"mast": Mast([[0, 1]], 200e6 * unit), "guys": Cable([[1, 2], [1, 3]], 12e6 * unit, prestress=1e3 * unit)}
    structure = Structure(np.vstack([[[0, 0, 0], [0, 0, 4]], feet]), parts, [Support([0, 2, 3])])
    result = Analysis(structure).run([Stage("prestress")])["prestress"]
    assert np.abs(result.reactions).max() < 1e-6 * unit


def lift(points):
    return np.add(points, [0.3, 0.7, 1.1])


def turn(points):
    c, s = np.cos(0.3), np.sin(0.3)
    return points @ [[c, s, 0], [-s, c, 0], [0, 0, 1]]


@strict
@UNITS
@pytest.mark.parametrize("prestress", [0.0, 2e3])
@pytest.mark.parametrize("motion", [lift, turn])
def test_rigid_motion_is_not_out_of_balance(motion, prestress, unit):
    moves = PrescribedDisplacement(RIM, motion(POINTS[RIM]) - POINTS[RIM])
    Analysis(hypar(unit, prestress, held=[])).run([Stage("move", displacements=[moves])])


def test_a_stiff_cable_without_digits_is_told():
    with pytest.warns(UnbalancedStateWarning, match="^Stage 'snow'.*unbalanced force"):
        Analysis(hypar(ridge=1e18)).run([snow(600.0)])


def test_a_strong_prestress_elsewhere_hides_nothing():
    """Its own rounding is 1e-3 N, far above what is out of balance in the roof."""
    points = np.vstack([POINTS, [[9, 0, 0], [9, 0, 3.0], [9, 0, 6.0]]])
    cable = Cable([[COUNT, COUNT + 1], [COUNT + 1, COUNT + 2]], 1e18, prestress=1e13)
    parts = {"fabric": Membrane(TRIANGLES, Fabric(5e5, 0.3), 2e3), "other": cable}
    structure = Structure(points, parts, [Support([*RIM, COUNT, COUNT + 2])])
    with pytest.warns(UnbalancedStateWarning, match="beside loads of"):
        result = Analysis(structure, Newton(rtol=1e-2)).run([snow(600.0)])["snow"]
    assert result.equilibrium.residual == result.equilibrium.unbalanced.max()
