"""Edge cables of a plane film: arcs of radius force over stress.

Reference: equilibrium of a cable of force T in a plane film of stress n, T / R = n.
Claim: form finding of prescribed stress from straight edges converges to these arcs, with second order, with the forces
    and the stress prescribed.
Tolerance: orders within 0.15 of 2 over the last refinement.
"""

import numpy as np
import pytest

from fx_membrane import (
    Cable,
    Fabric,
    Membrane,
    Structure,
    Support,
    boundary_edges,
    natural_force_density,
    rectangle,
    updated_reference,
)

SOURCE = "arc of an edge cable, R = T / n"

HALF, STRESS = 6.0, 2.0


def canopy(n, radius):
    points, triangles = rectangle(2 * HALF, 2 * HALF, n, n)
    parts = {
        "film": Membrane(triangles, Fabric(Et=600.0, nu=0.3), STRESS),
        "edge": Cable(boundary_edges(triangles), 2e4, STRESS * radius),
    }
    corners = [0, n, n * (n + 1), (n + 1) ** 2 - 1]
    return Structure(points, parts, [Support(corners)])


METHODS = {
    "updated reference": lambda structure: updated_reference(structure, tolerance=1e-9, max_iterations=60),
    "natural force density": lambda structure: natural_force_density(structure, iterations=60, tolerance=1e-9),
}


@pytest.mark.study("radius")
@pytest.mark.parametrize("radius", [10.0, 20.0])
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.filterwarnings("ignore::fx_membrane.UnsettledFormWarning")
def test_edges_are_arcs(method, radius, verified):
    centre = HALF + np.sqrt(radius**2 - HALF**2)  # of the edge at the smallest y, at (0, -centre)
    errors = []
    for n in (4, 8, 16):
        form = METHODS[method](canopy(n, radius))
        edge = form.points[: n + 1]
        errors.append(np.abs(np.hypot(edge[:, 0], edge[:, 1] + centre) - radius).max())
        assert form.steps[-1].stress_error < 0.05
    assert errors[-1] < 0.01 * radius
    order = np.log2(errors[1] / errors[2])
    assert order == pytest.approx(2, abs=0.15)
    verified("radius of an edge [m]", radius, radius + errors[-1], order)
