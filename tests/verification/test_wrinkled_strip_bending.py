"""Stretched strip that is bent in its plane until it wrinkles along one edge.

Reference: M. Stein and J. M. Hedgepeth, Analysis of Partly Wrinkled Membranes, NASA TN D-813 (1961). A membrane of the
height H is stretched by s0 in both directions, P = s0 H, and bent by a moment M to the curvature k. Where the strain
along it would need compression it wrinkles and carries nothing along, over the height b at one edge; the force is
linear over the rest:

    b/H = 0 up to M/(P H) = 1/6, then 3 M/(P H) - 1/2,
    2 M/(P H) = k E h H^2/(6 P) up to 1/3, then 1 - 2/3 sqrt(2 P/(E h H^2 k)).

Here the ends turn as planes and move along as the wanted k and P ask for; the long edges are pulled by s0, so that the
wrinkled part is in tension across, Poisson's ratio has no effect, and the state is the same all along.
Claim: P, M and b, with second order in the size of the cells; nothing before the first wrinkle depends on wrinkling;
the share of the compressed stiffness changes P and M by its part of the compression that the full law has.
Tolerance: strains are 1e-6, and so is the effect of large rotations. The switch lies anywhere within a row of cells,
which moves the coefficient of h^2 from mesh to mesh, in M by 5 % and in P, whose error is smaller, by 15 %: orders
within 0.05 of M, 0.15 of P on the average of the meshes; extrapolation leaves 4/3 of it, 0.1 and 0.25. b: the height of
a row.
"""

from functools import cache

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Fabric,
    Membrane,
    PointLoad,
    PrescribedDisplacement,
    Stage,
    Structure,
    Support,
    rectangle,
)

SOURCE = "M. Stein, J. M. Hedgepeth, NASA TN D-813, 1961"

H, EH, NU, S0 = 1.0, 1e6, 0.3, 1.0
P = S0 * H
FIRST = 2 * P / (EH * H**2)  # curvature at the first wrinkle
MESHES = (8, 16, 32)


def height(moment):
    """b/H for M/(P H)."""
    return max(3 * moment - 0.5, 0.0)


def moment(curvature):
    """M/(P H)."""
    linear = curvature * EH * H**2 / (6 * P)
    return linear / 2 if linear <= 1 / 3 else 0.5 - np.sqrt(2 * P / (EH * H**2 * curvature)) / 3


@cache
def bend(curvature, n, share=1e-7):
    """P and M of the reactions over P and P H, and the wrinkled share of the cells."""
    points, triangles = rectangle(H, H, n, n, "right")
    x, y, _ = points.T
    ends, middle = np.flatnonzero(np.abs(x) == H / 2), np.flatnonzero((x == 0) & (y == 0))
    # The force along is zero at the edge of the wrinkled part, or outside the strip.
    b = height(moment(curvature)) * H
    axis = b - H / 2 if b > 0 else -S0 / (EH * curvature)
    turn = np.zeros((len(ends), 3))
    turn[:, 0] = x[ends] * (curvature * (y[ends] - axis) - S0 / EH)
    pull = []
    for sign in (-1, 1):
        edge = np.flatnonzero(y == sign * H / 2)
        for nodes, length in ((np.setdiff1d(edge, ends), H / n), (np.intersect1d(edge, ends), H / n / 2)):
            pull.append(PointLoad(nodes, (0.0, sign * S0 * length, 0.0)))
    strip = Membrane(triangles, Fabric(EH, NU), S0, compression_stiffness=share)
    structure = Structure(points, {"strip": strip}, [Support(np.arange(len(points)), "z"), Support(middle, "y")])
    stage = Stage("bend", loads=pull, displacements=[PrescribedDisplacement(ends, turn, "x")])
    state = Analysis(structure).run([stage])["bend"]
    right = ends[x[ends] > 0]
    force = state.reactions[right, 0]
    wrinkled = np.mean(state.membrane("strip").state == "wrinkled")
    assert not np.any(state.membrane("strip").state == "slack")
    return np.array([force.sum() / P, force @ y[right] / (P * H), wrinkled])


def test_formulas_agree():
    """The moment of the linear force over H - b is the one that the curvature gives."""
    for factor in (1.0, 2.0, 4.0):
        b = height(moment(factor * FIRST)) * H
        assert EH * factor * FIRST * (H - b) ** 2 / 2 == pytest.approx(P, rel=1e-12)
        assert P * (H / 2 - (H - b) / 3) == pytest.approx(moment(factor * FIRST) * P * H, rel=1e-12)


@pytest.mark.parametrize("factor", [0.5, 0.9])
def test_without_wrinkles(factor):
    values = np.array([bend(factor * FIRST, n) for n in MESHES])
    assert not values[:, 2].any()
    np.testing.assert_allclose(values[:, 0], 1, rtol=0, atol=1e-6)
    error = values[:, 1] - moment(factor * FIRST)
    np.testing.assert_allclose(np.log2(error[:-1] / error[1:]), 2, rtol=0, atol=0.05)
    np.testing.assert_allclose(bend(factor * FIRST, 8, share=1.0), values[0], rtol=1e-9)


@pytest.mark.mpi_once
@pytest.mark.parametrize("factor", [1.0, 2.0, 4.0])
def test_with_wrinkles(factor, verified):
    values = np.array([bend(factor * FIRST, n) for n in MESHES])
    error = values[:, :2] - [1, moment(factor * FIRST)]
    order = np.log2(error[:-1] / error[1:])
    np.testing.assert_allclose(order[:, 1], 2, rtol=0, atol=0.05)
    verified("moment over P H", moment(factor * FIRST), values[-1, 1], order[-1, 1])
    assert order[:, 0].mean() == pytest.approx(2, abs=0.15)
    left = (4 * error[-1] - error[-2]) / 3
    assert (np.abs(left) < np.abs(error[-1]) * [0.25, 0.1]).all()
    assert (np.abs(values[:, 2] - height(moment(factor * FIRST))) < 1 / np.array(MESHES)).all()


def test_share_of_the_compressed_stiffness():
    """Over b the full law has E'/E times the linear force that goes on below zero, for the wrinkled part does not widen
    with it: in sum P/(1 - nu^2) (b/(H-b))^2, at b/3 from the edge."""
    none, b = bend(4 * FIRST, 32), 0.5
    compression = (b / (1 - b)) ** 2 / (1 - NU**2)
    for share in (1e-4, 1e-3):
        change = bend(4 * FIRST, 32, share) - none
        # The row of cells at the switch is 1/16 of the compressed part.
        np.testing.assert_allclose(change[:2] / share, [-compression, -compression * (b / 3 - 1 / 2)], rtol=1 / 16)
