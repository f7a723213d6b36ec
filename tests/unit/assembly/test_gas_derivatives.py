"""Derivatives of the residual by parameters of gas."""

from dataclasses import replace

import numpy as np
import pytest

from cushions import AIR, airbag
from fx_membrane import Ambient, GasAmount, GasPressure, GasVolume, Problem, Stage
from fx_membrane.assembly.gas_laws import Enclosed

SHAPE = 0.01 * np.random.default_rng(0).normal(size=(34, 3))


def actions(change, temperature=290.0):
    problem = Problem(airbag(exponent=1.3))
    stage = Stage("fill", changes=[Ambient(AIR, temperature), change])
    start = problem.actions_of(Stage("air", changes=[Ambient(AIR, temperature)]))
    return problem, problem.with_gas_of_start(start, problem.actions_of(stage, start), SHAPE, "fill")[1]


def changed(given, parameter, step):
    """Actions with another value of a parameter."""
    gas, air = given.gas["gas"], given.air
    if parameter in ("pressure", "amount"):
        return replace(given, gas={"gas": replace(gas, value=gas.value + step)})
    field = parameter.removeprefix("air ")
    return replace(given, air=replace(air, **{field: getattr(air, field) + step}))


@pytest.mark.mpi
@pytest.mark.parametrize(
    ("change", "parameter", "step"),
    [
        (GasPressure(300.0, "gas"), "pressure", 1.0),
        (GasAmount(AIR + 300.0, 0.5, "gas"), "amount", 0.01),
        (GasAmount(AIR + 300.0, 0.5, "gas"), "air pressure", 1.0),
        (GasAmount(AIR + 300.0, 0.5, "gas"), "air temperature", 0.1),
    ],
)
def test_derivative_is_that_of_the_residual(change, parameter, step):
    problem, given = actions(change)
    x = problem.to_petsc(SHAPE)
    found = problem.to_numpy(problem.under(given).derivative(x, "gas", parameter, 2.0))
    ahead, behind = (problem.under(changed(given, parameter, side)).residual(x) for side in (step, -step))
    expected = (problem.to_numpy(ahead) - problem.to_numpy(behind)) / step
    assert np.abs(expected).max() > 0
    assert np.allclose(found, expected, rtol=1e-6, atol=1e-6 * np.abs(expected).max())


@pytest.mark.parametrize("volume", [0.9, 0.5, 0.004, -0.1])
def test_derivatives_of_the_law(volume):
    """The last two volumes are those of crushed gas."""
    law = Enclosed(1e5, 0.9, 1.4, 1e5)
    ends = [replaced.force(volume) for replaced in (law._replace(amount=1e5 + 1), law._replace(amount=1e5 - 1))]
    assert law.by_amount(volume) == pytest.approx((ends[0] - ends[1]) / 2, rel=1e-6)
    ends = [replaced.force(volume) for replaced in (law._replace(around=1e5 + 1), law._replace(around=1e5 - 1))]
    assert law.by_air_pressure(volume) == pytest.approx((ends[0] - ends[1]) / 2, rel=1e-6)


@pytest.mark.parametrize(
    ("change", "parameter", "message"),
    [
        (GasPressure(300.0, "gas"), "amount", r"is open and has no parameter 'amount'; those .* are \['pressure'\]"),
        (GasVolume(0.5, "gas"), "volume", r"of a given volume and has no parameter"),
        (GasAmount(AIR, 0.5, "gas"), "pressure", r"is closed .* \['amount', 'air pressure', 'air temperature'\]"),
        (GasAmount(AIR, 0.5, "gas"), 3, r"is closed and has no parameter 3"),
    ],
)
def test_refusals(change, parameter, message):
    problem, given = actions(change)
    with pytest.raises(ValueError, match=message):
        problem.under(given).derivative(problem.to_petsc(SHAPE), "gas", parameter)
