"""Structures whose first equilibrium plain Newton does not find: slack, flat without prestress, far from their form."""

import re
import runpy
import sys
from pathlib import Path

import numpy as np
import pytest
from petsc4py import PETSc

import hard_structures as hard
from fx_membrane import Analysis, ConvergenceError, Newton, Outcome, Pressure, Stage, report
from fx_membrane.assembly.problem import Problem
from fx_membrane.solvers import newton, newton_loop
from fx_membrane.solvers.convergence import Patience
from fx_membrane.solvers.inertia_correction import ShiftControl
from models import SNOW, end, sheet

PLAIN = Newton(line_search=False)
TABLE = runpy.run_path(str(Path(__file__).parents[2] / "benchmarks" / "hard_cases.py"))


def solved(structure, stages):
    """Results of all stages, each in equilibrium and reached without halving."""
    results = Analysis(structure).run(stages)
    for stage, result in zip(stages, results.values(), strict=True):
        largest = max(np.abs(result.reactions).max(), np.abs(result.loads).max())
        assert result.equilibrium.residual <= 1e-8 * largest
        total = np.abs(result.reactions).sum()
        assert result.equilibrium.loads + result.equilibrium.reactions == pytest.approx(np.zeros(3), abs=1e-9 * total)
        assert len(result.increments) == stage.increments
    return list(results.values())


def plain_fails(structure, stages):
    with pytest.raises(ConvergenceError):
        Analysis(structure, PLAIN).run(stages)


@pytest.mark.parametrize("sag", [0.0, 0.5])
@pytest.mark.parametrize("load", [1.0, 1e3])
def test_slack_cable_hangs(sag, load):
    structure, stages = hard.hanging(sag, load)
    plain_fails(structure, stages)
    (result,) = solved(structure, stages)
    length = np.linalg.norm(np.diff(structure.points, axis=0), axis=1).sum()
    assert result.reactions[[0, -1], 2] == pytest.approx(2 * [load * length / 2], rel=1e-7)
    # The horizontal force is the same everywhere, and the cable is taut.
    direction = np.diff(result.position, axis=0)
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    force = result.cable("cable").force
    assert (force > 0).all()
    assert force * direction[:, 0] == pytest.approx(np.full(20, result.reactions[-1, 0]), rel=1e-6)


@pytest.mark.mpi_once
@pytest.mark.parametrize("times", [1, 100])
def test_flat_sheet_without_prestress_carries_snow(times):
    structure, stages = hard.sheet(0.0, times * 1e3)
    plain_fails(structure, stages)
    (snow,) = solved(structure, stages)
    assert snow.reactions[:, 2].sum() == pytest.approx(times * 36e3, rel=1e-9)
    # Small strains, shallow: the deflection grows with the cube root of the load.
    if times == 1:
        (double,) = solved(*hard.sheet(0.0, 1e-3))
        (eightfold,) = solved(*hard.sheet(0.0, 8e-3))
        assert eightfold.displacement[:, 2].min() == pytest.approx(2 * double.displacement[:, 2].min(), rel=1e-3)


@pytest.mark.mpi
def test_flat_cushion_without_prestress_is_blown_up():
    structure, stages = hard.cushion(0.0, 1e3)
    plain_fails(structure, stages)
    (air,) = solved(structure, stages)
    assert air.displacement[:, 2].max() > 0.3
    # The vector area of a surface depends on its rim alone.
    assert air.loads.sum(axis=0) == pytest.approx([0, 0, 36e3], abs=1e-9 * 36e3)


@pytest.mark.mpi
def test_ordinary_sail_finds_its_form_and_carries_snow_and_wind():
    structure, stages = hard.hypar(2e3, 20e3, 1.5, hard.service(300.0))
    prestress, snow, wind = solved(structure, stages)
    assert (prestress.cable("edge cables").force > 10e3).all()
    # Half a turn about z changes nothing.
    here, there = (np.lexsort(np.round(structure.points * sign, 9).T) for sign in ([1, 1, 1], [-1, -1, 1]))
    turned = prestress.displacement[there] * [-1, -1, 1]
    largest = np.abs(prestress.displacement).max()
    assert turned == pytest.approx(prestress.displacement[here], abs=1e-6 * largest)
    assert snow.displacement[:, 2].mean() < prestress.displacement[:, 2].mean() < wind.displacement[:, 2].mean()
    # Full steps converge here, too.
    plain = Analysis(structure, PLAIN).run(stages[:1])["prestress"]
    assert prestress.displacement == pytest.approx(plain.displacement, abs=1e-6 * largest)
    assert prestress.energy == pytest.approx(plain.energy, rel=1e-12)


@pytest.mark.mpi_once
@pytest.mark.parametrize("move", [0.05, 0.2])
def test_slack_roof_hangs_by_its_own_weight(move):
    structure, stages = hard.slack_roof(move, 10.0)
    (weight,) = solved(structure, stages)
    assert not (weight.membrane("fabric").state == "taut").all()
    assert (weight.cable("cables").force > 0).all()
    # Full steps fall into the same shape.
    plain = Analysis(structure, PLAIN).run(stages)["weight"]
    assert weight.displacement == pytest.approx(plain.displacement, abs=1e-6 * np.abs(plain.displacement).max())
    assert weight.energy == pytest.approx(plain.energy, rel=1e-10)


def test_sail_that_crumples_is_given_more_iterations_once_it_was_stabilized(monkeypatch):
    monkeypatch.setattr(newton._Globalized, "patience", Patience(share=0.0, least=30))
    structure, stages = hard.hypar(2e3, 1e4, 2.0, [Stage("prestress")], 24)
    prestress = Analysis(structure).run(stages)["prestress"]
    (increment,) = prestress.increments
    assert increment.outcome is Outcome.STABILIZED
    assert len(increment.iterations) > 1 + 30
    assert prestress.equilibrium.residual <= 1e-8 * np.abs(prestress.reactions).max()
    assert (prestress.membrane("fabric").state == "slack").any()


@pytest.fixture
def steps(monkeypatch):
    """List with one entry for each step, rejected ones included."""
    found = []
    step = newton_loop.NewtonLoop.step
    monkeypatch.setattr(newton_loop.NewtonLoop, "step", lambda *args: found.append(1) or step(*args))
    return found


def test_increment_tells_that_the_structure_was_stabilized(steps):
    structure, stages = hard.pulled(-0.1, 0.6, 0.0, hard.FABRIC, 8)
    (twisted,) = solved(structure, stages)
    (increment,) = twisted.increments
    assert increment.outcome is Outcome.STABILIZED
    assert increment.extra_iterations > Patience().usual(Newton().max_iterations)  # of the first attempt
    assert increment.total_iterations == len(steps)
    assert f"stabilized first ({increment.extra_iterations} iterations more)" in report(twisted)
    steps.clear()
    (sheared,) = solved(*hard.pulled(0.01, 0.0, 0.15, hard.FABRIC, 8))
    (increment,) = sheared.increments
    assert (increment.outcome, increment.extra_iterations) == (Outcome.CONVERGED, 0)
    assert increment.total_iterations == len(steps)
    assert "stabilized" not in report(sheared)


def test_failure_counts_the_steps_that_drew_the_structure_smooth(steps, monkeypatch):
    monkeypatch.setattr(newton._Globalized, "patience", Patience(share=0.0, least=1))
    structure, stages = hard.hypar(2e3, 20e3, 1.5, [Stage("prestress")])
    with pytest.raises(ConvergenceError) as error:
        Analysis(structure, Newton(rtol=1e-14, max_iterations=16)).run(stages)
    failed = error.value.failed
    assert len(failed.iterations) == 2
    told = re.search(
        r"first attempt, of (1) iteration; the homotopy took (\d+) more, .* second attempt (\d+), .*force of",
        str(error.value),
    )
    assert sum(map(int, told.groups())) == 16
    assert failed.extra_iterations == 15
    assert failed.total_iterations == len(steps) == 16


def test_plain_newton_draws_nothing_smooth():
    structure, stages = hard.sheet(0.0, 1e3)
    with pytest.raises(ConvergenceError) as error:
        Analysis(structure, PLAIN).run(stages)
    assert error.value.failed.outcome is Outcome.SINGULAR_START


ENERGY_CASES = {
    "sail": lambda: hard.hypar(2e3, 20e3, 1.5, hard.service(300.0)),
    "slack cable": lambda: hard.hanging(2.0, 1e3),
    "unstressed sheet": lambda: hard.sheet(0.0, 1e3),
    "sheet": lambda: (sheet(), [Stage("snow", [SNOW])]),
}


@pytest.mark.mpi_once
@pytest.mark.filterwarnings("ignore:.* moved by")  # the slack cable drops
@pytest.mark.parametrize("name", ENERGY_CASES)
def test_energy_falls_in_every_step(name):
    # Without pressure: the energies of the history do not include it.
    structure, stages = ENERGY_CASES[name]()
    stages = [stage for stage in stages if not any(isinstance(load, Pressure) for load in stage.loads)]
    for result in solved(structure, stages):
        for increment in result.increments:
            energies = np.array([entry.energy for entry in increment.iterations])
            assert (np.diff(energies) <= 1e-12 * np.abs(energies).max()).all()
            steps = [entry.step for entry in increment.iterations[1:]]
            assert all(0 < step <= 1 for step in steps)
            assert steps[-1] == 1


@pytest.mark.mpi
def test_tension_in_the_tangent_goes_with_the_residual():
    (snow,) = solved(*hard.sheet(0.0, 1e3))
    entries = [entry for _, entry in snow.history]
    assert entries[0].shift == 0
    assert entries[1].shift >= ShiftControl().first
    after_full_steps = [i for i in range(1, len(entries) - 1) if entries[i].step == 1]
    assert len(after_full_steps) > 2
    for i in after_full_steps:
        shrinkage = entries[i].residual / entries[i - 1].residual
        assert entries[i + 1].shift <= min(ShiftControl().decay, shrinkage) * entries[i].shift
    assert entries[-1].residual < entries[-2].residual ** 1.5  # faster than in proportion, and both are below 1 N


@pytest.mark.mpi
def test_tension_in_the_structure_is_gone_after_the_solve(monkeypatch):
    monkeypatch.setattr(newton._Globalized, "patience", Patience(share=0.0, least=1))
    structure = sheet(prestress=0.0)
    problem = Problem(structure)
    loaded = problem.under(end(problem, SNOW))
    solve = Newton().prepare(problem)
    solution = solve(loaded, problem.create_vector())
    assert solution.converged
    assert solution.outcome is Outcome.STABILIZED  # impossible in one step
    assert solve.loop.problem is loaded


@pytest.mark.parametrize("name", ["cable net, prestress 0, load 100", "cone, prestress 0, lift 0.5"])
def test_line_of_the_table_of_hard_cases(name):
    PETSc.Log.begin()
    make = dict(TABLE["cases"]())[name]
    yes, balance, increments, *_ = TABLE["measure"](make, Newton()).split()
    assert yes == "yes"
    assert float(balance) < 1e-8
    assert int(increments) == len(make()[1])


def test_name_that_no_hard_case_has(monkeypatch):
    monkeypatch.setattr(sys, "argv", ["hard_cases.py", "nonsense"])
    with pytest.raises(SystemExit, match=r"^No case.*'nonsense'.*name; .*; cable net; hanging cable"):
        TABLE["main"]()
