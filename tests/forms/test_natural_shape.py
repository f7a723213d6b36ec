"""Natural shapes: derivatives of their energies, the reference shape as one of them, and another reference shape.

Reference: Taylor's theorem; and a structure whose reference shape is the natural shape of the other, in the same place.
"""

import numpy as np
import pytest

from fx_membrane import (
    Cable,
    Fabric,
    Mast,
    Membrane,
    NeoHooke,
    OrthotropicFabric,
    Structure,
    Support,
    boundary_edges,
    polyline,
    rectangle,
)
from fx_membrane.assembly.problem import Problem
from own_laws import Foil, Stiffening
from taylor import remainders

POINTS, TRIANGLES = rectangle(2.0, 1.0, 3, 2)
STEPS = 2e-4 / 2.0 ** np.arange(4)
A = np.array([[0.97, 0.012], [0.012, 1.02]])
SHEETS = {
    "isotropic": Fabric(1e3, 0.3),
    "woven": OrthotropicFabric(1e3, 6e2, 0.2, 3e2),
    "neo-Hooke": NeoHooke(360.0),
    "own": Foil(1e3),
}
BARS = {
    "cable": lambda **data: Cable(polyline([0, 1, 2, 3]), 1e3, **data),
    "rubber cable": lambda **data: Cable(polyline([0, 1, 2, 3]), material=Stiffening(1e3, 1e4), **data),
    "mast": lambda **data: Mast(polyline([0, 1, 2, 3]), 1e3, **data),
}


def sheet(law, stretch=1.0, points=POINTS, **data):
    part = Membrane(
        TRIANGLES, SHEETS[law], **{"prestress": (20.0, 30.0), "warp": (1, 0, 0), "natural_stretch": stretch} | data
    )
    return Structure(points, {"part": part}, [Support(np.unique(boundary_edges(TRIANGLES)))])


def bars(law, stretch=1.0, points=POINTS[:4], **data):
    part = BARS[law](**{"prestress": 20.0 if law != "mast" else -20.0, "natural_stretch": stretch} | data)
    return Structure(points, {"part": part}, [Support([0, 3])])


def structure(law, stretch=1.0, **data):
    """Sheet or bars of a law; of bars the stretch is the first number of A."""
    if law in SHEETS:
        return sheet(law, stretch, **data)
    return bars(law, stretch if np.ndim(stretch) == 0 else np.array([0.97, 1.02, 1.01]), **data)


def numbers(problem, x):
    """Energy, residual, and tangent times a vector, of all processes."""
    matrix, residual, product, d = problem.discretization.create_matrix(), *(x.duplicate() for _ in range(3))
    problem.residual(x, residual)
    problem.tangent(x, matrix)
    d.array[:] = np.cos(np.arange(len(d.array)))
    matrix.mult(d, product)
    return np.concatenate([[problem.energy(x)], residual.array, product.array])


def moved(problem, seed, size, squeezed=0.0):
    """Random displacements; those of a squeezed sheet shorten it along x."""
    points = problem.structure.points
    u = size * np.random.default_rng(seed).normal(size=points.shape)
    u[:, 0] -= squeezed * points[:, 0]
    return problem.discretization.to_petsc(u)


@pytest.mark.mpi_once
@pytest.mark.parametrize("squeezed", [0.0, 0.15], ids=["taut", "wrinkled"])
@pytest.mark.parametrize("law", [*SHEETS, *BARS])
def test_reference_shape_as_natural_shape_changes_nothing(law, squeezed):
    without, with_forms = Problem(structure(law)), Problem(structure(law))
    with_forms.allow_natural_shapes(["part"])
    assert with_forms.parts["part"].natural is not None
    assert without.parts["part"].natural is None
    x = moved(without, 1, 0.02, squeezed)
    expected = numbers(without.under(), x)
    np.testing.assert_allclose(numbers(with_forms.under(), x), expected, rtol=0, atol=1e-13 * np.abs(expected).max())


@pytest.mark.mpi_once
@pytest.mark.parametrize("squeezed", [0.0, 0.15], ids=["taut", "wrinkled"])
@pytest.mark.parametrize("law", [*SHEETS, *BARS])
def test_energy_residual_and_tangent_are_derivatives(law, squeezed):
    problem = Problem(structure(law, A)).under()
    # Of this seed no cell changes its state between the steps.
    x, d = moved(problem, 7, 0.01, squeezed), moved(problem, 3, 1.0)
    R, Kd, matrix = x.duplicate(), x.duplicate(), problem.discretization.create_matrix()
    energy = problem.energy(x)
    problem.residual(x, R)
    problem.tangent(x, matrix)
    matrix.mult(d, Kd)
    first, second = [], []
    for h in STEPS:
        y = x.copy()
        y.axpy(h, d)
        change = problem.energy(y) - energy
        first.append(abs(change - h * R.dot(d)))
        second.append(abs(change - h * R.dot(d) - h**2 / 2 * Kd.dot(d)))
    third = remainders(problem, x, d, STEPS)
    for remainder, order in ((first, 2), (second, 3), (third, 2)):
        np.testing.assert_allclose(np.log2(np.divide(remainder[:-1], remainder[1:])), order, rtol=0, atol=0.1)


@pytest.mark.mpi_once
@pytest.mark.parametrize("squeezed", [0.0, 0.15], ids=["taut", "wrinkled"])
@pytest.mark.parametrize("law", SHEETS)
def test_natural_shape_is_another_reference_shape(law, squeezed):
    """Energy and forces in one place do not depend on the reference shape that the natural one counts from."""
    flat = POINTS.copy()
    flat[:, :2] = POINTS[:, :2] @ A.T
    told, drawn = Problem(sheet(law, A)).under(), Problem(sheet(law, points=flat)).under()
    u = 0.02 * np.random.default_rng(4).normal(size=POINTS.shape)
    u[:, 0] -= squeezed * POINTS[:, 0]
    x, y = told.discretization.to_petsc(u), drawn.discretization.to_petsc(u + POINTS - flat)
    assert told.energy(x) == pytest.approx(drawn.energy(y), rel=1e-12)
    found, expected = (problem.discretization.create_vector() for problem in (told, drawn))
    told.residual(x, found)
    drawn.residual(y, expected)
    force, wanted = told.discretization.to_numpy(found), drawn.discretization.to_numpy(expected)
    np.testing.assert_allclose(force, wanted, rtol=0, atol=1e-11 * np.abs(wanted).max())


@pytest.mark.mpi_once
@pytest.mark.parametrize("law", BARS)
def test_unstressed_length_is_another_reference_length(law):
    told, drawn = Problem(bars(law, 1.02)).under(), Problem(bars(law, points=1.02 * POINTS[:4])).under()
    u = 0.05 * np.random.default_rng(5).normal(size=(4, 3))
    x, y = told.discretization.to_petsc(u), drawn.discretization.to_petsc(u - 0.02 * POINTS[:4])
    assert told.energy(x) == pytest.approx(drawn.energy(y), rel=1e-12)


@pytest.mark.mpi_once
def test_small_natural_strains_keep_their_digits():
    """Stress of a natural strain of 1e-12, in a shape that is not displaced: Et / (1 - nu) of it, to six digits."""
    strain = 1e-12
    problem = Problem(sheet("isotropic", 1 - strain, prestress=0.0)).under()
    found = problem.discretization.create_vector()
    problem.residual(problem.discretization.create_vector(), found)
    force = problem.discretization.to_numpy(found)
    edge = np.isclose(POINTS[:, 0], POINTS[:, 0].max())
    assert abs(force[edge, 0].sum()) == pytest.approx(1e3 / 0.7 * strain, rel=1e-3)
