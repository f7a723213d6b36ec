"""Actions between a start and an end, and their differences: nothing that acts at one of them is dropped."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from fx_membrane import Pressure, Problem, Stage
from fx_membrane.assembly.actions import between, unloaded
from models import SNOW, inclined_sheet
from own_terms import ElasticBed, Water

PROBLEM = Problem(inclined_sheet(), MPI.COMM_SELF)
BED, WATER = ElasticBed("fabric", 40.0), Water("fabric", 2e3, 0.3)
START = PROBLEM.actions_of(Stage("start", [SNOW, Pressure(30.0, "fabric"), BED]))
END = unloaded(PROBLEM.structure)  # made by hand: it names neither pressure nor term


def residual(actions):
    shape = 0.05 * np.random.default_rng(2).normal(size=PROBLEM.structure.points.shape)
    return PROBLEM.to_numpy(PROBLEM.under(actions).residual(PROBLEM.to_petsc(shape)))


@pytest.mark.mpi_once
@pytest.mark.parametrize("factor", [0.0, 0.25, 1.0])
@pytest.mark.parametrize("ends", [(START, END), (END, START), (START, replace(END, terms=START.terms[:0]))])
def test_residual_between_is_linear_in_the_load_factor(ends, factor):
    start, end = ends
    expected = (1 - factor) * residual(start) + factor * residual(end)
    assert np.abs(residual(start) - residual(end)).max() > 1.0
    np.testing.assert_allclose(residual(between(start, end, factor)), expected, rtol=0, atol=1e-10)


@pytest.mark.mpi_once
@pytest.mark.parametrize("ends", [(START, END), (END, START)])
def test_differences_are_rates(ends):
    start, end = ends
    rest = residual(unloaded(PROBLEM.structure))
    np.testing.assert_allclose(residual(end.less(start)) - rest, residual(end) - residual(start), rtol=0, atol=1e-10)
    x = PROBLEM.create_vector()
    rate = PROBLEM.to_numpy(PROBLEM.under(end).load_derivative(x, start))
    change = PROBLEM.under(end).residual(x)
    change.axpy(-1.0, PROBLEM.under(start).residual(x))
    np.testing.assert_allclose(rate, PROBLEM.to_numpy(change), rtol=0, atol=1e-10)


@pytest.mark.mpi
def test_terms_of_both_ends_act_once():
    end = PROBLEM.actions_of(Stage("end", [BED, WATER]))
    here = between(START, end, 0.25)
    assert [(acting.term, acting.factor) for acting in here.terms] == [(BED, 1.0), (WATER, 0.25)]
    assert [(acting.term, acting.factor) for acting in end.less(START).terms] == [(BED, 0.0), (WATER, 1.0)]
