"""Derivatives of the residual by natural stretches, and by the prestress under their changes of a stage."""

from dataclasses import replace

import numpy as np
import pytest

from fx_membrane import (
    LengthChange,
    NaturalStretch,
    PrestressFactor,
    Problem,
    Stage,
)
from fx_membrane.model.cell_tensors import of_bar, of_membrane
from models import MIXED
from observed_orders import rates

STEPS = 1e-3 / 2.0 ** np.arange(3)  # fractions of a parameter
SHAPE = 0.1 * np.random.default_rng(6).normal(size=MIXED.points.shape)
STRETCHES = [
    ("fabric", 1.0, []),
    ("woven", (1.0, -0.5), [NaturalStretch((0.99, 1.02), "woven")]),
    ("woven", [[0.5, 0.3], [-0.1, 1.0]], []),  # a tensor need not be symmetric
    ("edge", [1.0, -2.0], [LengthChange(0.02, "edge")]),
    ("mast", 1.0, []),
]


@pytest.mark.mpi_once
@pytest.mark.parametrize(("part", "direction", "changes"), STRETCHES)
def test_derivative_by_a_natural_stretch(part, direction, changes):
    """Remainders in the natural shape in effect, with the changes of a stage."""
    problem = Problem(MIXED)
    x, actions = problem.to_petsc(SHAPE), problem.actions_of(Stage("cut", changes=changes))
    exact = problem.under(actions).derivative(x, part, "natural_stretch", direction)
    before = problem.under(actions).residual(x)
    tensors = of_membrane if MIXED.parts[part].dimension == 2 else of_bar
    step = tensors("step", direction, len(MIXED.parts[part].cells))
    remainders = []
    for h in STEPS:
        natural = dict(actions.natural) | {part: actions.natural.get(part, 0.0) + h * step}
        other = problem.under(replace(actions, natural=natural)).residual(x)
        other.axpy(-1.0, before)
        other.axpy(-h, exact)
        remainders.append(other.norm())
    assert exact.norm() > 1e-3
    np.testing.assert_allclose(rates(np.array(remainders), before.norm()), 2, rtol=0, atol=0.1)


def test_derivative_by_a_prestress_has_its_factor():
    problem = Problem(MIXED)
    x, actions = (
        problem.to_petsc(SHAPE),
        problem.actions_of(Stage("loss", changes=[PrestressFactor(0.7, "woven", [1])])),
    )
    with_factor = problem.under(actions).derivative(x, "woven", "prestress", (30.0, -20.0))
    assert problem.under().derivative(x, "woven", "prestress", (30.0, -20.0)).norm() != with_factor.norm()
    h, found = 1e-5, problem.to_numpy(with_factor)
    step = replace(
        MIXED.parts["woven"], prestress=MIXED.parts["woven"].prestress_tensors() + h * np.diag([30.0, -20.0])
    )
    other = Problem(replace(MIXED, parts=dict(MIXED.parts) | {"woven": step}))
    loss = other.actions_of(Stage("loss", changes=[PrestressFactor(0.7, "woven", [1])]))
    change = other.to_numpy(other.under(loss).residual(x)) - problem.to_numpy(problem.under(actions).residual(x))
    assert np.abs(change / h - found).max() < 1e-4 * np.abs(found).max()


def test_derivative_by_a_natural_stretch_is_zero_without_elasticity():
    problem = Problem(MIXED, elastic=False)
    assert problem.under().derivative(problem.to_petsc(SHAPE), "woven", "natural_stretch").norm() == 0
