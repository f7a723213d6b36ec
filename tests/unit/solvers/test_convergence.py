"""Residuals that fall or rest, and loads beyond the limit."""

from fractions import Fraction

import numpy as np
import pytest

from fx_membrane import Iteration
from fx_membrane.analysis.increments import LIMITS, Ceiling
from fx_membrane.analysis.reasons import _largest_load
from fx_membrane.solvers.convergence import TREND, at_rest, nearer, stagnant


def history(residuals):
    return [Iteration(0.0, float(residual), 1.0) for residual in residuals]


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("rate", "falls"), [(0.98, True), (0.99, True), (1.0, False), (1.01, False)])
def test_nearer_is_told_in_spite_of_noise(rate, falls, seed):
    noise = 10 ** np.random.default_rng(seed).uniform(-0.3, 0.3, 201)
    assert nearer(history(rate ** np.arange(201) * noise), 200, unknown=not falls) == falls


@pytest.mark.parametrize("unknown", [True, False])
def test_few_residuals_tell_nothing(unknown):
    assert nearer(history(np.ones(49)), 200, unknown) == unknown


@pytest.mark.parametrize("length", [TREND.rest + 1, 160])
def test_residuals_that_stand_still_are_at_rest(length):
    noise = np.random.default_rng(0).uniform(0.8, 1.2, length)
    assert at_rest(history(1e-8 * noise))
    assert not at_rest(history(1e-8 * noise)[: TREND.rest])
    assert not at_rest(history(0.9 ** np.arange(length)))


def test_nothing_near_a_load_that_took_long_is_overshot():
    ceiling = Ceiling()
    assert ceiling.next(Fraction(1, 4), Fraction(1, 4)) == Fraction(1, 2)
    ceiling.failed(Fraction(1, 2), 10)
    assert ceiling.next(Fraction(3, 8), Fraction(1, 4)) == Fraction(5, 8)
    ceiling.failed(Fraction(1, 2), LIMITS.long)
    assert ceiling.next(Fraction(3, 8), Fraction(1, 4)) == Fraction(1, 2)
    assert not ceiling.smooth
    assert not ceiling.reached(Fraction(3, 8))
    assert _largest_load(ceiling, Fraction(3, 8)) == ""
    assert ceiling.reached(Fraction(99, 200))
    assert "load factor 0.495 on no equilibrium" in _largest_load(ceiling, Fraction(99, 200))
    ceiling.found(Fraction(1, 2))
    assert ceiling == Ceiling()


@pytest.mark.parametrize(
    ("residuals", "expected"),
    [
        ([1.0, 9.9e-8, 1e-8], True),
        ([1.0, 1.01e-7, 1e-8], False),  # more than tenfold
        ([1.0, 2e-7, 0.99e-7], True),
        ([1.0, 2e-7, 1.01e-7], False),  # above a thousand tolerances
        ([1e-8, 1e-8], False),  # too few
    ],
)
def test_small_residual_that_falls_no_longer_is_stagnant(residuals, expected):
    assert stagnant(history(residuals), 1e-10) == expected
