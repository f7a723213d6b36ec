"""Gas in chambers through stages: fan, given volume, given amount, sealed; their limits, records and refusals."""

import re
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from cushions import AIR, FABRIC, INFLATE, SEAL, airbag, cushion, double_cushion, run
from fx_membrane import (
    Ambient,
    Chamber,
    ConjugateGradient,
    DistributedLoad,
    GasAmount,
    GasPressure,
    GasVolume,
    Membrane,
    Newton,
    Pressure,
    Seal,
    Stage,
    Structure,
    Support,
    boundary_edges,
    equilibrium_path,
    natural_frequencies,
    stability,
)
from fx_membrane.assembly.actions import between
from fx_membrane.assembly.problem import Problem

SNOW = DistributedLoad((0, 0, -150.0), "top")
GROW = Stage("grow", changes=[GasVolume(0.9, "gas")], after="inflate")


@pytest.mark.mpi
def test_fan_is_a_pressure():
    """An open chamber is a `Pressure` on its films, and its forces are loads."""
    fan = run(INFLATE)["inflate"]
    pressed = run(Stage("p", [Pressure(300.0, "top"), Pressure(-300.0, "bottom")]), structure=cushion())["p"]
    assert np.allclose(fan.displacement, pressed.displacement, atol=1e-10)
    assert np.allclose(fan.loads, pressed.loads, atol=1e-8)
    assert np.allclose(fan.reactions, pressed.reactions, atol=1e-6)
    gas = fan.chambers["gas"]
    assert (gas.pressure, gas.dp_dV, gas.state) == (300.0, 0.0, "open")


@pytest.mark.mpi
@pytest.mark.parametrize("exponent", [1.0, 1.4])
def test_sealed_gas_keeps_its_law(exponent):
    snow = Stage("snow", [SNOW], after="seal", increments=2)
    states = run(INFLATE, SEAL, snow, structure=airbag(exponent=exponent))
    before, after = (states[name].chambers["gas"] for name in ("seal", "snow"))
    assert before.pressure == pytest.approx(300.0, rel=1e-9)
    constants = [(gas.pressure + AIR) * gas.volume**exponent for gas in (before, after)]
    assert constants[1] == pytest.approx(constants[0], rel=1e-12)
    assert after.dp_dV == pytest.approx(-exponent * (after.pressure + AIR) / after.volume)
    assert after.pressure > before.pressure + 10
    assert [entry.chambers["gas"].pressure for entry in states["snow"].increments][-1] == after.pressure
    assert len(states["snow"].increments) == 2


@pytest.mark.mpi
def test_air_around():
    """Warmer, and lighter air around: p V / T of the gas stays."""
    warm = Stage("warm", changes=[Ambient(temperature=313.15)], after="seal")
    high = Stage("high", changes=[Ambient(90_000.0)], after="seal")
    states = run(INFLATE, SEAL, warm, high)
    gas = {name: state.chambers["gas"] for name, state in states.items()}
    amount = (gas["seal"].pressure + AIR) * gas["seal"].volume / 293.15
    assert (gas["warm"].pressure + AIR) * gas["warm"].volume / 313.15 == pytest.approx(amount, rel=1e-12)
    assert (gas["high"].pressure + 90_000) * gas["high"].volume / 293.15 == pytest.approx(amount, rel=1e-12)
    assert gas["warm"].volume > gas["seal"].volume < gas["high"].volume


@pytest.mark.mpi
def test_given_volume_and_its_pressure():
    """A volume is kept under snow; an open chamber at the pressure found has the same shape."""
    filled = run(Stage("fill", changes=[GasVolume(0.8, "gas")]), Stage("snow", [SNOW], after="fill"))
    gas = filled["snow"].chambers["gas"]
    assert gas.volume == pytest.approx(0.8, rel=1e-10)
    assert gas.state == "given volume"
    assert gas.dp_dV == -np.inf
    open_ = run(Stage("snow", [SNOW], changes=[GasPressure(gas.pressure, "gas")]))["snow"]
    assert np.allclose(open_.displacement, filled["snow"].displacement, atol=1e-7)
    assert stability(filled["snow"]).stable


@pytest.mark.mpi
def test_large_amount_is_a_given_volume():
    """Gas of a high absolute pressure, in air of it, is as stiff as a liquid."""
    volume = run(INFLATE)["inflate"].chambers["gas"].volume
    kept = run(INFLATE, Stage("keep", [SNOW], changes=[GasVolume(volume, "gas")], after="inflate"))["keep"]
    errors = []
    for around in (1e7, 1e8, 1e9):
        seal = Stage("seal", changes=[Ambient(around), Seal("gas")], after="inflate")
        closed = run(INFLATE, seal, Stage("snow", [SNOW], after="seal"))["snow"]
        errors.append(np.abs(closed.displacement - kept.displacement).max())
    assert np.allclose(np.divide(errors[:-1], errors[1:]), 10, rtol=0.05)


@pytest.mark.mpi
def test_rounding_of_very_large_pressures_is_no_unbalanced_force():
    """The least change of the volume that numbers can tell changes the pressure by 1e-5 Pa here."""
    seal = Stage("seal", changes=[Ambient(1e11), Seal("gas")], after="inflate")
    snow = run(INFLATE, seal, Stage("snow", [SNOW], after="seal", increments=8))["snow"]
    volume = run(INFLATE)["inflate"].chambers["gas"].volume
    kept = run(INFLATE, Stage("keep", [SNOW], changes=[GasVolume(volume, "gas")], after="inflate"))["keep"]
    np.testing.assert_allclose(snow.displacement, kept.displacement, atol=1e-8)
    assert sum(entry.total_iterations for entry in snow.increments) < 100


@pytest.mark.mpi
def test_very_large_chamber_is_a_given_pressure():
    """A film over a deep rigid pit: the difference to a fan falls with the depth."""
    film = cushion()
    top = film.parts["top"].cells
    rim = np.flatnonzero(film.supported.all(axis=1))
    errors = []
    for depth in (1e3, 1e4):
        points = np.vstack([film.points, [0, 0, -depth]])
        edges = boundary_edges(top)
        pit = np.column_stack([edges, np.full(len(edges), len(points) - 1)])
        parts = {"top": film.parts["top"], "pit": Membrane(pit, FABRIC)}
        supports = [Support([*rim, len(points) - 1])]
        hall = Structure(points, parts, supports, chambers={"gas": Chamber(["top", "pit"])})
        fan = Stage("fan", [SNOW], after="inflate")
        states = run(INFLATE, SEAL, replace(fan, name="snow", after="seal"), fan, structure=hall)
        errors.append(np.abs(states["snow"].displacement - states["fan"].displacement).max())
    assert errors[0] / errors[1] == pytest.approx(10, rel=0.05)
    assert errors[0] > 1e-5


@pytest.mark.mpi
def test_amount_from_a_flat_cushion():
    """A flat cushion, filled with an amount of gas, is that sealed with as much."""
    flat = cushion(height=0.0, separate=[("top", "bottom")], chambers={"gas": Chamber({"top": 1, "bottom": -1})})
    sealed = run(INFLATE, SEAL, structure=flat)["seal"]
    volume = sealed.chambers["gas"].volume
    fill = Stage("fill", changes=[Ambient(AIR, 293.15), GasAmount(AIR + 300.0, volume, "gas")])
    filled = run(fill, structure=flat)["fill"]
    assert filled.chambers["gas"].pressure == pytest.approx(300.0, rel=1e-7)
    assert np.allclose(filled.displacement, sealed.displacement, atol=1e-8)


@pytest.mark.mpi
@pytest.mark.parametrize("solver", [Newton(line_search=False), ConjugateGradient(rtol=1e-9)])
def test_solvers(solver):
    snow = Stage("snow", [SNOW], after="seal")
    reference = run(INFLATE, SEAL, snow)["snow"]
    found = run(INFLATE, SEAL, snow, solver=solver)["snow"]
    assert np.allclose(found.displacement, reference.displacement, atol=1e-6)


@pytest.mark.mpi
def test_two_chambers_share_a_wall():
    """Each sealed chamber keeps its own gas; the wall bulges to the weaker one."""
    structure = double_cushion({"upper": Chamber(["top", "wall"]), "lower": Chamber(["wall", "low"])})
    blow = Stage("blow", changes=[GasPressure(300.0, "upper"), GasPressure(200.0, "lower")])
    close = Stage("close", changes=[Ambient(AIR), Seal("upper"), Seal("lower")], after="blow")
    states = run(blow, close, Stage("snow", [SNOW], after="close"), structure=structure)
    for name in ("upper", "lower"):
        before, after = (states[stage].chambers[name] for stage in ("close", "snow"))
        assert (after.pressure + AIR) * after.volume == pytest.approx(
            (before.pressure + AIR) * before.volume, rel=1e-12
        )
        assert after.pressure > before.pressure + 10
    residuals = [entry.residual for entry in states["snow"].increments[-1].iterations]
    assert len(residuals) <= 7
    assert stability(states["snow"]).stable
    mixed = Stage("mixed", changes=[GasVolume(0.5, "upper"), GasPressure(250.0, "lower")], after="close")
    found = run(blow, close, mixed, structure=structure)["mixed"].chambers
    assert found["upper"].volume == pytest.approx(0.5, rel=1e-10)
    assert found["lower"].pressure == 250.0


@pytest.mark.mpi
def test_energy_balance():
    """The work of the snow along the path is the gain of energy, that of the gas included: order 2 of increments."""
    errors = []
    for increments in (4, 8):
        snow = Stage("snow", [SNOW], after="seal", increments=increments)
        shown = []
        states = run(INFLATE, SEAL, snow, observe=shown.append)
        points = [states["seal"], *(state for state in shown if state.name == "snow")]
        stored = [state.energy + np.sum(state.actions.loads * state.displacement) for state in points]
        work = sum(
            np.sum((a.actions.loads + b.actions.loads) / 2 * (b.displacement - a.displacement))
            for a, b in pairwise(points)
        )
        errors.append(abs(stored[-1] - stored[0] - work))
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.1)


@pytest.mark.mpi
def test_derivative_by_the_load_factor():
    """Gas that changes with the load factor is in the derivative of the residual."""
    problem = Problem(airbag())
    fill = Stage("fill", changes=[Ambient(AIR), GasAmount(AIR + 500.0, 0.8, "gas")])
    start = problem.actions_of(Stage("air", changes=[Ambient(0.9 * AIR), GasAmount(AIR, 0.7, "gas")]))
    end = problem.actions_of(fill, start)
    shape = 0.01 * np.random.default_rng(0).normal(size=problem.structure.points.shape)
    start, end = problem.with_gas_of_start(start, end, shape, "fill")
    x = problem.to_petsc(shape)
    found = problem.to_numpy(problem.under(end).load_derivative(x, start))
    residuals = [problem.to_numpy(problem.under(between(start, end, 1 + h)).residual(x)) for h in (-1e-3, 1e-3)]
    expected = (residuals[1] - residuals[0]) / 2e-3
    assert np.allclose(found, expected, atol=1e-5 * np.abs(expected).max())


def test_sealed_gas_needs_its_start():
    problem = Problem(airbag())
    with pytest.raises(ValueError, match="Actions seal chamber 'gas' with the gas that is in it at the start"):
        problem.under(problem.actions_of(Stage("seal", changes=[Ambient(AIR), Seal("gas")])))


@pytest.mark.mpi
def test_path_and_modes():
    """The path of a stage ends where the stage does, and its pivots are those of the whole tangent."""
    states = run(INFLATE, SEAL, Stage("snow", [SNOW], after="seal"))
    path = equilibrium_path(states["seal"], Stage("snow", [SNOW], after="seal", increments=2))
    assert path.complete
    assert np.allclose(path.points[-1].displacement, states["snow"].displacement, atol=1e-8)
    assert (path.negative_pivots == 0).all()
    blown = equilibrium_path(airbag(), replace(INFLATE, increments=3))
    assert np.allclose(blown.points[-1].displacement, states["inflate"].displacement, atol=1e-8)
    kept = equilibrium_path(states["inflate"], replace(GROW, increments=3))
    stage = run(INFLATE, GROW)["grow"]
    assert np.allclose(kept.points[-1].displacement, stage.displacement, atol=1e-8)


@pytest.mark.mpi
def test_frequencies():
    """Closed gas stiffens the mode that changes the volume, and no other."""
    structure = airbag()
    parts = {name: replace(part, mass=0.3) for name, part in structure.parts.items()}
    states = run(INFLATE, SEAL, structure=replace(structure, parts=parts))
    open_, closed = (natural_frequencies(states[name], 6).frequencies for name in ("inflate", "seal"))
    assert (closed >= open_ * (1 - 1e-9)).all()
    assert closed[0] == pytest.approx(open_[0])  # both films swing alike: the volume stays
    assert np.any(closed > 1.05 * open_)


@pytest.mark.parametrize(
    ("stages", "message"),
    [
        ([Stage("s", changes=[Seal("gas")])], "but no pressure around it is given; add Ambient(101325.0)"),
        ([Stage("s", changes=[Ambient(AIR), GasAmount(300.0, 0.5, "gas")])], "gauge pressure; add that around: 101625"),
        (
            [Stage("a", changes=[Ambient(AIR)]), Stage("b", changes=[Ambient(300.0)], after="a")],
            "which looks like a gauge pressure",
        ),
        ([Stage("s", changes=[Ambient(temperature=293.0)])], "an Ambient temperature before a pressure"),
        (
            [
                INFLATE,
                replace(SEAL, changes=[Ambient(AIR), Seal("gas")]),
                Stage("warm", changes=[Ambient(temperature=300.0)], after="seal"),
            ],
            "chamber 'gas' was closed without one",
        ),
    ],
)
def test_refusals(stages, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        run(*stages)
