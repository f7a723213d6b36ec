"""Tube cut from compensated cloth, sewn together and pressed: it has the designed shape and stress.

Reference: closed form. A tube of radius R under the pressure p carries p R around, and n along, held at its ends. Its
cloth is flat and smaller by the stretches that belong to this stress by the law, n = lambda / lambda_other S(E).
Discrete: facets that touch the circle of radius R from outside carry p R between them exactly.
Claim: no displacement from the designed shape, and the stress that it was designed for; found also from another first
shape, a thinner tube of the same cloth.
Tolerance: rounding, and Newton's tolerance from the other shape.
"""

import numpy as np
import pytest
from scipy.optimize import fsolve

from fx_membrane import (
    Analysis,
    Fabric,
    Membrane,
    Newton,
    PrescribedDisplacement,
    Pressure,
    Stage,
    Structure,
    natural_stretch,
    rectangle,
)

SOURCE = "closed form, n = p R and the law of the cloth"

R, LENGTH, P, EH, NU = 5.0, 10.0, 400.0, 5e5, 0.3
HOOP, AXIAL = P * R, 1e3


def stretches():
    """Stretches along and around, of the stress."""

    def unbalanced(values):
        along, around = values
        E = np.array([(along**2 - 1) / 2, (around**2 - 1) / 2])
        S = EH / (1 - NU**2) * np.array([E[0] + NU * E[1], E[1] + NU * E[0]])
        return along / around * S[0] - AXIAL, around / along * S[1] - HOOP

    return fsolve(unbalanced, (1.0, 1.0), xtol=1e-14)


def tube(n, rows, thinner=1.0):
    """Tube of n facets: points, triangles, and the flat triangles of its cloth, warp along the tube."""
    side = 2 * R * np.tan(np.pi / n)
    flat, triangles = rectangle(n * side, LENGTH, n, rows, "right")
    row, column = np.divmod(np.arange(len(flat)), n + 1)
    angle, corner = 2 * np.pi * column / n, R / np.cos(np.pi / n) * thinner
    points = np.stack([corner * np.cos(angle), corner * np.sin(angle), flat[:, 1]], axis=-1)
    along, around = stretches()
    cloth = np.stack([flat[:, 1] / along, -flat[:, 0] / around], axis=-1)[triangles]  # the normal points outwards
    joined = row * n + column % n
    kept = column < n
    return points[kept], joined[triangles], cloth


def sewn(n, rows, thinner=1.0):
    """State of the tube with its ends held in the designed place, and the designed points."""
    points, cells, cloth = tube(n, rows, thinner)
    shape = natural_stretch(points, cells, cloth, warp=(0, 0, 1))
    part = Membrane(cells, Fabric(EH, NU), warp=(0, 0, 1), natural_stretch=shape)
    ends = np.flatnonzero(np.isclose(np.abs(points[:, 2]), LENGTH / 2))
    structure = Structure(points, {"tube": part}, [])
    designed = tube(n, rows)[0]
    place = PrescribedDisplacement(ends, designed[ends] - points[ends])
    stage = Stage("sew", [Pressure(P, "tube")], [place])
    return Analysis(structure, Newton(rtol=1e-13)).run([stage])["sew"], designed


def test_stretches_of_the_design():
    along, around = stretches()
    assert along == pytest.approx(1.0008078977, abs=1e-10)
    assert around == pytest.approx(1.0033824724, abs=1e-10)
    assert 2 * np.pi * R / around == pytest.approx(31.3100212544, abs=1e-9)
    assert LENGTH / along == pytest.approx(9.9919275445, abs=1e-9)


@pytest.mark.mpi_once
@pytest.mark.parametrize("n", [12, 24])
def test_tube_that_is_pressed_keeps_its_shape(n, verified):
    state, designed = sewn(n, 6)
    check(state, designed, n, 1e-10, verified)


@pytest.mark.mpi_once
def test_tube_is_found_from_a_thinner_one(verified):
    state, designed = sewn(16, 5, thinner=0.97)
    assert np.abs(state.displacement).max() > 0.1
    check(state, designed, 16, 1e-9, verified)


def check(state, designed, n, tolerance, verified):
    away = np.abs(state.position - designed).max()
    assert away < tolerance
    stress = state.membrane("tube").warp_weft_stress
    np.testing.assert_allclose(stress, np.tile([AXIAL, HOOP], (len(stress), 1)), rtol=1e-8)
    top = designed[:, 2] > LENGTH / 2 - 1e-9
    perimeter = n * 2 * R * np.tan(np.pi / n)
    assert state.reactions[top, 2].sum() == pytest.approx(AXIAL * perimeter, rel=1e-8)
    verified("shift from the design", 0.0, away / R)
    verified("stress along", AXIAL, stress[:, 0].max())
    verified("stress around", HOOP, stress[:, 1].max())
