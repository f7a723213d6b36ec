"""Natural frequencies of a drum: a circular membrane under uniform tension with a held edge.

Reference: f = j / (2 pi a) sqrt(N / m), j the zeros of Bessel functions: 2.40482556 of J0, 3.83170597 of J1 and
5.13562230 of J2, the last two double, then 5.52007811 of J0 (P. M. Morse, Vibration and Sound, 2nd ed. (1948), section
19). The first shape is J0(j r / a), of modal mass one when divided by sqrt(pi m) a J1(j).
Claim: the frequencies converge from above with second order (the mass matrix is consistent and the polygon lies
within the circle), double ones stay double on a mesh with sixfold symmetry, and the first shape converges alike.
Tolerance: the error is e = 3e-3 to 2e-2 with 8 rings, and the next term as large a share of it: 1.44 e = 0.03 in the
orders. The extrapolation leaves that term, e^2 = 2e-5 on 16 rings over four: 5e-6. Double frequencies and zeros of
shapes: the solver's 1e-12, for shapes over the relative distance of frequencies, 0.03.
"""

import numpy as np
import pytest
from scipy.spatial import Delaunay
from scipy.special import j0, j1, jn_zeros

from fx_membrane import Analysis, Fabric, Membrane, Stage, Structure, Support, natural_frequencies, stability

SOURCE = "P. M. Morse, Vibration and Sound, 1948, section 19"

A, N, MASS = 2.0, 3e3, 1.2  # radius, tension [N/m], mass [kg/m2]
ZEROS = np.array([jn_zeros(0, 1)[0], *2 * [jn_zeros(1, 1)[0]], *2 * [jn_zeros(2, 1)[0]], jn_zeros(0, 2)[1]])
EXACT = ZEROS / (2 * np.pi * A) * np.sqrt(N / MASS)
MESHES = (8, 16, 32)


def disc(n):
    """Disc of radius one and n rings: equilateral triangles at the centre, node 0, that become circular outwards."""
    points = [np.zeros((1, 2))]
    angle = np.pi / 3 * np.arange(7)
    for k in range(1, n + 1):
        share = np.arange(6 * k) / k
        hexagon = np.stack([np.interp(share, np.arange(7), corners) for corners in (np.cos(angle), np.sin(angle))], -1)
        circle = np.stack([np.cos(np.pi / 3 * share), np.sin(np.pi / 3 * share)], axis=-1)
        points.append(k / n * (hexagon + (k / n) ** 3 * (circle - hexagon)))
    flat = np.concatenate(points)
    return np.column_stack([flat, np.zeros(len(flat))]), Delaunay(flat).simplices


def drum(n):
    points, triangles = disc(n)
    edge = np.arange(len(points) - 6 * n, len(points))
    structure = Structure(
        A * points, {"skin": Membrane(triangles, Fabric(Et=1e6, nu=0.3), N, mass=MASS)}, [Support(edge)]
    )
    return Analysis(structure).run([Stage("tension")])["tension"]


@pytest.fixture(scope="module")
def states():
    return [drum(n) for n in MESHES]


@pytest.fixture(scope="module")
def modes(states):
    return [natural_frequencies(state) for state in states]


def test_frequencies_converge_from_above_with_second_order(modes, verified):
    frequencies = np.array([entry.frequencies for entry in modes])
    error = frequencies / EXACT - 1
    assert (error > 0).all()
    np.testing.assert_allclose(np.log2(error[:-1] / error[1:]), 2, rtol=0, atol=0.03)
    np.testing.assert_allclose((4 * frequencies[-1] - frequencies[-2]) / 3, EXACT, rtol=5e-6)
    verified("lowest frequency [Hz]", EXACT[0], frequencies[-1, 0], np.log2(error[-2, 0] / error[-1, 0]))


def test_double_frequencies_are_double(modes):
    for entry in modes:
        np.testing.assert_allclose(entry.frequencies[[1, 3]], entry.frequencies[[2, 4]], rtol=1e-11)
        assert not entry.growth.any()


@pytest.mark.mpi
def test_first_shape(states, modes):
    error = []
    for state, entry in zip(states, modes, strict=True):
        radius = np.linalg.norm(state.structure.points, axis=1)
        exact = j0(ZEROS[0] * radius / A) / (np.sqrt(np.pi * MASS) * A * j1(ZEROS[0]))
        assert entry.shapes[0, :, 2].max() == entry.shapes[0, 0, 2]
        assert np.abs(entry.shapes[0, :, :2]).max() < 1e-10 * exact[0]
        error.append(np.abs(entry.shapes[0, :, 2] - exact).max() / exact[0])
    np.testing.assert_allclose(np.log2(np.divide(error[:-1], error[1:])), 2, rtol=0, atol=0.03)


def test_what_modes_do_not_move(states, modes):
    """J1 and J2 are zero at the centre; no mode moves the edge."""
    for state, entry in zip(states, modes, strict=True):
        assert np.abs(entry.shapes[1:5, 0]).max() < 1e-10 * np.abs(entry.shapes).max()
        assert not entry.shapes[:, state.actions.held].any()


def test_a_stable_state(states):
    result = stability(states[0], 3)
    assert result.negative == 0
    assert (result.stiffnesses > 0).all()
