"""Foils in simple states, against the closed forms of incompressible neo-Hooke and Mooney-Rivlin membranes.

Nominal forces per reference width, for stretches l1, l2 along the axes, from W = C10 (I1 - 3) + C01 (I2 - 3) with
l1 l2 l3 = 1 (L. R. G. Treloar, The Physics of Rubber Elasticity, 3rd ed. (1975), (5.17), (10.8)):

    T1 = 2 (l1 - 1 / (l1^3 l2^2)) (C10 + C01 l2^2),    T2 alike.

Simple tension leaves the width l^(-1/2). With shear the stress is 2 dW/dC, by the derivatives of tr(C) and det(C).
Tolerance: rounding; beside the natural width, the compression stiffness 1e-12 and the step from it, squared.
"""

import numpy as np
import pytest

from fx_membrane import Analysis, Membrane, MooneyRivlin, NeoHooke, PrescribedDisplacement, Stage, Structure

C10, C01 = 300.0, 70.0
LAWS = [(NeoHooke(2 * C10), C10, 0.0), (MooneyRivlin(C10, C01), C10, C01)]
# Two triangles, one of them turned in space.
POINTS = np.array([[0.0, 0, 0], [1, 0, 0], [0.2, 0.9, 0], [1.1, 1.3, 0]])
CELLS = np.array([[0, 1, 2], [1, 3, 2]])


def deformed(material, F, prestress=0.0, **data):
    """State of a sheet under a homogeneous deformation F (2, 2) in its plane, and its sigma0 . E."""
    motion = np.zeros_like(POINTS)
    motion[:, :2] = POINTS[:, :2] @ (np.asarray(F) - np.eye(2)).T
    part = Membrane(CELLS, material, prestress, warp=(1, 0, 0), **data)
    moves = PrescribedDisplacement(range(4), motion)
    return Analysis(Structure(POINTS, {"foil": part}), progress=False).run([Stage("a", displacements=[moves])])["a"]


def area():
    a, b = POINTS[CELLS[:, 1]] - POINTS[CELLS[:, 0]], POINTS[CELLS[:, 2]] - POINTS[CELLS[:, 0]]
    return np.linalg.norm(np.cross(a, b), axis=1).sum() / 2


def nominal(l1, l2, c10, c01):
    return 2 * (l1 - 1 / (l1**3 * l2**2)) * (c10 + c01 * l2**2)


@pytest.mark.parametrize(("material", "c10", "c01"), LAWS)
@pytest.mark.parametrize(("l1", "l2"), [(1.3, 1.3), (2.0, 1.1), (0.9, 1.6), (3.0, 3.0), (1.0001, 1.0002)])
def test_biaxial(material, c10, c01, l1, l2):
    state = deformed(material, np.diag([l1, l2]))
    foil = state.membrane("foil")
    expected = [nominal(l1, l2, c10, c01) / l2, nominal(l2, l1, c10, c01) / l1]
    scale = max(expected)
    np.testing.assert_allclose(foil.cauchy[:, [0, 1], [0, 1]], [expected] * 2, rtol=0, atol=1e-11 * scale + 1e-12 * C10)
    np.testing.assert_allclose(foil.cauchy[:, 0, 1], 0, atol=1e-11 * scale)
    assert set(foil.state) == {"taut"}
    I1, I2 = l1**2 + l2**2 + (l1 * l2) ** -2, l1**-2 + l2**-2 + (l1 * l2) ** 2
    assert state.energy == pytest.approx(area() * (c10 * (I1 - 3) + c01 * (I2 - 3)), rel=1e-11, abs=1e-12 * C10)


@pytest.mark.parametrize(("material", "c10", "c01"), LAWS)
@pytest.mark.parametrize("k", [0.05, 0.4])
def test_shear_between_prestretched_yarns(material, c10, c01, k):
    length = 1.4
    F = np.array([[length, k], [0, length]])
    C, d = F.T @ F, np.linalg.det(F) ** 2
    inverse = np.linalg.inv(C)
    # dI1/dC = I - C^-1 / d, dI2/dC = (I - tr(C) C^-1) / d + d C^-1
    S = 2 * (c10 * (np.eye(2) - inverse / d) + c01 * ((np.eye(2) - np.trace(C) * inverse) / d + d * inverse))
    foil = deformed(material, F).membrane("foil")
    np.testing.assert_allclose(foil.second_piola_kirchhoff, [S] * 2, rtol=0, atol=1e-11 * np.abs(S).max())


@pytest.mark.parametrize(("material", "c10", "c01"), LAWS)
@pytest.mark.parametrize("l1", [1.05, 1.5, 3.0])
@pytest.mark.parametrize("side", [0.98, 1 - 1e-6, 1 + 1e-6, 1.02])
def test_simple_tension_beside_the_natural_width(material, c10, c01, l1, side):
    """Natural width l^(-1/2): wider is taut, narrower wrinkled, with the energy W(l, l^(-1/2))."""
    l2 = side * l1**-0.5
    state = deformed(material, np.diag([l1, l2]), compression_stiffness=1e-12)
    foil = state.membrane("foil")
    assert set(foil.state) == {"taut" if side > 1 else "wrinkled"}
    kept = l2 if side > 1 else l1**-0.5
    expected = nominal(l1, kept, c10, c01)
    np.testing.assert_allclose(foil.principal[:, 0] * l2, expected, rtol=1e-9)
    np.testing.assert_allclose(foil.principal[:, 1] * l1, max(nominal(l2, l1, c10, c01), 0), atol=1e-8 * expected)
    I1, I2 = l1**2 + kept**2 + (l1 * kept) ** -2, l1**-2 + kept**-2 + (l1 * kept) ** 2
    assert state.energy == pytest.approx(area() * (c10 * (I1 - 3) + c01 * (I2 - 3)), rel=1e-9)


@pytest.mark.parametrize(("material", "c10", "c01"), LAWS)
def test_slack(material, c10, c01):
    state = deformed(material, [[0.9, 0.05], [0.0, 0.95]], compression_stiffness=1e-6)
    foil = state.membrane("foil")
    assert set(foil.state) == {"slack"}
    assert np.abs(foil.principal).max() < 1e-6 * 10 * (c10 + c01)


@pytest.mark.parametrize("prestress", [40.0, (50.0, 20.0), [[40.0, 15.0], [15.0, 20.0]]])
@pytest.mark.parametrize(("material", "c10", "c01"), LAWS)
def test_prestress_is_added(material, c10, c01, prestress):
    """S(E) = sigma0 + dW/dE while taut, and sigma0 in the reference shape."""
    sigma0 = np.asarray(prestress) * np.eye(2) if np.ndim(prestress) < 2 else np.array(prestress)
    rest = deformed(material, np.eye(2), prestress).membrane("foil")
    np.testing.assert_allclose(rest.second_piola_kirchhoff, [sigma0] * 2, rtol=0, atol=1e-10)
    F = [[1.3, 0.1], [0.0, 1.2]]
    plain, stressed = deformed(material, F), deformed(material, F, prestress)
    added = stressed.membrane("foil").second_piola_kirchhoff - plain.membrane("foil").second_piola_kirchhoff
    np.testing.assert_allclose(added, [sigma0] * 2, rtol=0, atol=1e-10)
    assert set(stressed.membrane("foil").state) == {"taut"}
