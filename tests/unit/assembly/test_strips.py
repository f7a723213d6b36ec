"""A large mesh is made of strips; energies, forces, tangents and results are those of one mesh."""

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    DistributedLoad,
    Fabric,
    Membrane,
    Pressure,
    Stage,
    Structure,
    Support,
    boundary_edges,
    rectangle,
)
from fx_membrane.assembly import discretization
from fx_membrane.assembly.problem import Problem

pytestmark = pytest.mark.mpi

CELLS = 7  # of a strip


def sheet(order: int) -> Structure:
    """Membrane of 60 cells in random order."""
    points, triangles = rectangle(2.0, 1.0, 6, 5)
    points[:, 2] = 0.1 * points[:, 0] ** 2
    fixed = np.unique(boundary_edges(triangles))
    triangles = np.random.default_rng(order).permutation(triangles)
    return Structure(points, {"fabric": Membrane(triangles, Fabric(1e5, 0.3), prestress=1e3)}, [Support(fixed)])


@pytest.mark.parametrize("order", [0, 1])
def test_strips_change_no_sum_and_no_result(order, monkeypatch):
    found = []
    for cells in (65536, CELLS):
        monkeypatch.setattr(discretization, "STRIP", cells)
        structure = sheet(order)
        problem = Problem(structure)
        view = problem.under(problem.actions_of(Stage("wind", [Pressure(200.0, "fabric")])))
        rng = np.random.default_rng(3)
        x, v = (problem.to_petsc(0.01 * rng.normal(size=structure.points.shape)) for _ in range(2))
        product = problem.create_vector()
        view.tangent(x).mult(v, product)
        state = Analysis(structure, progress=False).run(
            [Stage("load", [DistributedLoad((0, 0, -500.0), "fabric"), Pressure(100.0, "fabric")])]
        )["load"]
        meshes = problem.discretization.parts.values()
        seams = sum(len(mesh.seam) for mesh in meshes)
        if cells == CELLS:
            assert all(len(mesh.seam) for mesh in meshes)
        else:
            assert seams == 0
        found.append(
            [
                np.array(view.energy(x)),
                problem.to_numpy(view.residual(x)),
                problem.to_numpy(product),
                state.displacement,
                state.reactions,
                state.membrane("fabric").cauchy,
            ]
        )
    for whole, cut in zip(*found, strict=True):
        assert np.allclose(cut, whole, rtol=0, atol=1e-12 * np.abs(whole).max())
