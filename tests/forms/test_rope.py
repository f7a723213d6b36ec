"""Ropes: energy, residual and tangent are derivatives of each other, taut and slack, of given force and elastic.

Reference: Taylor's theorem.
"""

import numpy as np
import pytest

from fx_membrane import Fabric, GivenForce, LengthChange, Membrane, Rope, Stage, Structure, Support, rectangle
from fx_membrane.assembly.actions import between, unloaded
from fx_membrane.assembly.problem import Problem

POINTS, TRIANGLES = rectangle(2.0, 1.0, 4, 2)


def remainders(view, x, d, steps):
    """Norms of R(x + h d) - R(x) - h (K + border) d at free components."""
    A, borders = view.tangent(x), view.borders(x)
    Kd, R = A.createVecLeft(), view.residual(x)
    A.mult(d, Kd)
    for vector, compliance in zip(borders.vectors, borders.compliances, strict=True):
        Kd.axpy(vector.dot(d) / compliance, vector)
    norms = []
    for h in steps:
        y = x.copy()
        y.axpy(h, d)
        r = view.residual(y)
        r.axpy(-1.0, R)
        r.axpy(-h, Kd)
        view.constraints.zero_constrained(r)
        norms.append(r.norm())
    return np.array(norms)


STEPS = 1e-3 / 2.0 ** np.arange(4)
PATH = [0, 6, 12, 8, 4]


def problem(**data):
    parts = {"roof": Membrane(TRIANGLES, Fabric(1e3, 0.3), 50.0), "rope": Rope(PATH, 2e3, **data)}
    return Problem(Structure(POINTS, parts, [Support([0, 14])]))


def moved(made, size, seed):
    return made.discretization.to_petsc(size * np.random.default_rng(seed).normal(size=POINTS.shape))


@pytest.mark.mpi
@pytest.mark.parametrize(
    "data",
    [{"prestress": 30.0}, {"unstressed_length": 2.4}, {"unstressed_length": 4.0}, {"force": 40.0}],
    ids=["prestress", "length", "slack", "force"],
)
def test_energy_residual_and_tangent_are_derivatives(data):
    made = problem(**data)
    view, x, d = made.under(), moved(made, 0.02, 1), moved(made, 1.0, 2)
    view.constraints.zero_constrained(d)
    first, R = view.energy(x), view.residual(x)
    errors = []
    for step in STEPS:
        y = x.copy()
        y.axpy(step, d)
        errors.append(abs(view.energy(y) - first - step * R.dot(d)))
    np.testing.assert_allclose(np.log2(np.divide(errors[:-1], errors[1:])), 2, atol=0.1)
    left = remainders(view, x, d, STEPS)
    np.testing.assert_allclose(np.log2(left[:-1] / left[1:]), 2, atol=0.1)


@pytest.mark.mpi
@pytest.mark.parametrize("change", [GivenForce(80.0, "rope"), LengthChange(-0.1, "rope")], ids=["force", "length"])
def test_load_derivative_is_that_of_the_residual(change):
    made = problem(prestress=30.0)
    start, x = unloaded(made.structure), moved(made, 0.02, 1)
    end = made.actions_of(Stage("change", changes=[change]), start)
    residuals = [made.under(between(start, end, s)).residual(x) for s in (0.5 - 1e-4, 0.5 + 1e-4)]
    difference = residuals[1].copy()
    difference.axpy(-1.0, residuals[0])
    difference.scale(1 / 2e-4)
    found = made.under(between(start, end, 0.5))
    rate = found.load_derivative(x, start)
    error = rate.copy()
    error.axpy(-1.0, difference)
    # The derivative is by the load factor from the middle to the end of these actions.
    exact = made.create_vector()
    found.add_stress_rate(x, start, end, exact)
    error = exact.copy()
    error.axpy(-1.0, difference)
    assert error.norm() < 1e-6 * difference.norm()


@pytest.mark.mpi
@pytest.mark.parametrize("parameter", ["prestress", "axial_stiffness", "natural_stretch"])
def test_derivative_by_a_parameter(parameter):
    made, step = (
        problem(prestress=30.0),
        {"prestress": 0.01, "axial_stiffness": 0.1, "natural_stretch": 1e-5}[parameter],
    )
    x = moved(made, 0.02, 1)
    found = made.under().derivative(x, "rope", parameter)
    ends = []
    for sign in (-1, 1):
        data = {"prestress": 30.0, "axial_stiffness": 2e3, "natural_stretch": 1.0}
        data[parameter] += sign * step
        parts = {"roof": made.structure.parts["roof"], "rope": Rope(PATH, **data)}
        ends.append(Problem(Structure(POINTS, parts, made.structure.supports)).under().residual(x))
    ends[1].axpy(-1.0, ends[0])
    ends[1].scale(1 / (2 * step))
    found.axpy(-1.0, ends[1])
    assert found.norm() < 1e-6 * ends[1].norm()
