"""Strip of a sphere flattened by least energy: ratio of lengths, and strains along its middle and its edge.

Reference: exact in one dimension. A long strip of half width R beta about a great circle is flattened with free edges:
across there is no stress, along it the Green-Lagrange strain is (c^2 / cos^2 - 1) / 2. Least energy gives
c^2 = 2 L / (tan beta sec beta + L), L = ln(sec beta + tan beta), for any Poisson's ratio.
Discrete: linear triangles on the sphere; the middle of a strip of eight times its width, free of its ends.
Claim: second order in the mesh size.
"""

import numpy as np
import pytest

from fx_membrane import Fabric
from fx_membrane.patterns.flat_shapes import flatten
from gores import gores

SOURCE = "least energy of a strip in one dimension"
R = 10.0


def exact(beta):
    """Ratio of lengths, and strains along the middle and the edge [-]."""
    L = np.log(1 / np.cos(beta) + np.tan(beta))
    c2 = 2 * L / (np.tan(beta) / np.cos(beta) + L)
    return np.array([np.sqrt(c2), (c2 - 1) / 2, (c2 / np.cos(beta) ** 2 - 1) / 2])


def found(beta, across, nu):
    """Return the same of a flattened mesh, between a third and two thirds of its length."""
    sweep, cells = 16 * beta, 8 * across
    strips = gores(
        lambda t: R * np.cos(beta * (2 * t - 1)),
        lambda t: R * np.sin(beta * (2 * t - 1)),
        1,
        cells,
        across,
        law=Fabric(5e5, nu),
        sweep=sweep,
    )
    (flat,) = flatten(strips).values()
    points = np.empty((cells + 1, across + 1, 2))
    points.reshape(-1, 2)[flat.nodes] = flat.points
    first, last = cells // 3, cells - cells // 3
    flat_length = np.linalg.norm(points[last] - points[first], axis=1)
    arc = sweep * (last - first) / cells * R
    middle, edge = flat_length[across // 2] / arc, flat_length[0] / arc / np.cos(beta)
    return np.array([middle, (middle**2 - 1) / 2, (edge**2 - 1) / 2])


def test_exact_values():
    np.testing.assert_allclose(exact(0.125), [0.9973842622, -0.0026123167, 0.0052410435], atol=1e-10)
    np.testing.assert_allclose(exact(0.25), [0.9893961420, -0.0105476371, 0.0213644106], atol=1e-10)


@pytest.mark.parametrize(("beta", "nu"), [(0.125, 0.3), (0.25, 0.3), (0.25, 0.0)])
def test_strip_of_a_sphere(beta, nu, verified):
    wanted = exact(beta)
    coarse, fine = (found(beta, across, nu) for across in (8, 16))
    orders = np.log2(np.abs(coarse - wanted) / np.abs(fine - wanted))
    assert (orders > 1.85).all()
    assert (orders < 2.3).all()
    for name, value, here, order in zip(
        ("ratio", "strain in the middle", "strain at the edge"), wanted, fine, orders, strict=True
    ):
        verified(f"{name}, beta {beta}, nu {nu} [-]", value, here, order)
