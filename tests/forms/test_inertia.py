"""The consistent mass matrix against the closed form of linear elements, on random single elements.

Source: with linear shape functions, int N_I N_J = A (1 + delta_IJ) / 12 on a triangle and L (1 + delta_IJ) / 6 on a
segment (O. C. Zienkiewicz, R. L. Taylor, The Finite Element Method). Rounding: 1e-14 of the largest entry.
"""

import numpy as np
import pytest

from fx_membrane import Cable, Fabric, Mast, Membrane, Structure
from fx_membrane.assembly.problem import Problem
from fx_membrane.geometry.sizes import measures

COUNT, MASS = 20, 1.7


def part(kind, cells):
    if kind == "membrane":
        return Membrane(cells, Fabric(1e3, 0.3), mass=MASS)
    return {"cable": Cable, "mast": Mast}[kind](cells, 1e3, mass=MASS)


def assembled(structure):
    """Rows of the mass matrix that this process owns, in the user's numbering, shape (n, 3, n, 3); others are zero."""
    problem = Problem(structure)
    A = problem.discretization.create_matrix()
    problem.mass(A)
    first, last = A.getOwnershipRange()
    user = np.argsort(problem.discretization.block_of_node)
    result = np.zeros((len(user), 3, len(user), 3))
    for row in range(first, last):
        columns, values = A.getRow(row)
        result[user[row // 3], row % 3, user[columns // 3], columns % 3] = values
    return problem.discretization.comm.allreduce(result)


@pytest.mark.parametrize(("kind", "nodes", "factor"), [("membrane", 3, 12), ("cable", 2, 6), ("mast", 2, 6)])
def test_single_elements(kind, nodes, factor):
    rng = np.random.default_rng(nodes)
    points = rng.normal(size=(COUNT * nodes, 3))
    cells = np.arange(COUNT * nodes).reshape(COUNT, nodes)
    mass = assembled(Structure(points, {"part": part(kind, cells)}))
    expected = np.zeros_like(mass)
    for cell, size in zip(cells, measures(points, cells), strict=True):
        for i in range(3):
            expected[np.ix_(cell, [i], cell, [i])] = (
                MASS * size / factor * (1 + np.eye(nodes)).reshape(nodes, 1, nodes, 1)
            )
    np.testing.assert_allclose(mass, expected, rtol=0, atol=1e-14 * expected.max())


@pytest.mark.mpi
def test_parts_add_up():
    points = np.array([[0.0, 0, 0], [3, 0, 0], [0, 4, 0], [0, 4, 2]])
    parts = {"fabric": part("membrane", [[0, 1, 2]]), "edge": part("cable", [[1, 2]]), "mast": part("mast", [[3, 2]])}
    mass = assembled(Structure(points, parts))
    assert np.einsum("niji->i", mass.reshape(4, 3, 4, 3)) == pytest.approx([MASS * (6 + 5 + 2)] * 3, rel=1e-14)
    massless = {**parts, "edge": Cable([[1, 2]], 1e3)}
    assert assembled(Structure(points, massless)).sum() == pytest.approx(3 * MASS * (6 + 2), rel=1e-14)
