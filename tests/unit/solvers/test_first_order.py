"""Steepest descent and conjugate gradients: their solutions and messages."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    ConjugateGradient,
    ConvergenceError,
    Newton,
    PointLoad,
    Pressure,
    Stage,
    SteepestDescent,
    Structure,
    Support,
)
from fx_membrane.assembly.problem import Problem
from fx_membrane.solvers import preconditioners
from models import CENTRE, INCLINED, LIFT, SNOW, WIND, arch, inclined_sheet, sheet

KINDS = [None, "jacobi", "tangent"]
DESCENTS = ["SD jacobi", "SD tangent"]
TANGENT = 'preconditioner="tangent"'
ALL = [
    *(ConjugateGradient(beta, kind) for beta in ("FR", "PR") for kind in KINDS),
    *(SteepestDescent(kind, rtol=1e-6, max_iterations=100_000) for kind in KINDS),
]


def name(solver):
    return f"{getattr(solver, 'beta', 'SD')} {solver.preconditioner}"


def slack_net():
    """Square of cables with a diagonal that goes slack."""
    points = [[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [-1, -1, 0], [2, -1, 0], [2, 2, 0], [-1, 2, 0]]
    lines = [[0, 1], [1, 2], [2, 3], [3, 0], [0, 4], [1, 5], [2, 6], [3, 7], [0, 2]]
    prestress = [100.0] * 4 + [100 * 2**0.5] * 4 + [1.0]
    return Structure(points, {"net": Cable(lines, 2e4, prestress)}, [Support(range(4, 8))])


CASES = {
    "snow": (inclined_sheet(), [Stage("end", [SNOW, WIND], increments=2)]),
    "prescribed displacements": (inclined_sheet(), [Stage("end", [WIND], [LIFT])]),
    "pressure": (inclined_sheet(), [Stage("end", [Pressure(300.0, "fabric")])]),
    "slack": (slack_net(), [Stage("end", [PointLoad(2, (-20.0, -20, -5))])]),
    "no stiffness at the start": (sheet(prestress=0.0), [Stage("end", [PointLoad(CENTRE, (3.0, 2, -200))])]),
    "nothing to do": (sheet(), [Stage("end")]),
}


def choose(case, solver):
    """On several processes: a case of a membrane and one of cables, both with few steps.

    Steepest descent without a preconditioner, of hundreds of steps, runs there in `demos/solvers.py`.
    """
    kinds = {*(f"PR {kind}" for kind in KINDS), *DESCENTS}
    again = name(solver) in {"prescribed displacements": kinds, "slack": {"PR jacobi"}}.get(case, ())
    return pytest.param(case, solver, id=f"{case}, {name(solver)}", marks=[pytest.mark.mpi] if again else [])


@cache
def newton(case):
    structure, stages = CASES[case]
    return Analysis(structure).run(stages)["end"]


@pytest.mark.parametrize(("case", "solver"), [choose(case, solver) for case in CASES for solver in ALL])
def test_same_state_as_newton(case, solver):
    structure, stages = CASES[case]
    expected = newton(case)
    found = Analysis(structure, solver).run(stages)["end"]
    # The lowest mode has about a thousandth of the stiffness of the highest.
    limit = 1e3 * solver.rtol * np.abs(expected.displacement).max()
    np.testing.assert_allclose(found.displacement, expected.displacement, rtol=0, atol=limit)
    assert found.equilibrium.residual <= 10 * solver.rtol * max(np.abs(expected.reactions).max(), 1.0)
    for increment in found.increments:
        assert increment.iterations[0].step == 0
        assert all(0 < entry.step <= 1 for entry in increment.iterations[1:])
        if case != "pressure":  # its work is not in the energy
            energies = np.array([entry.energy for entry in increment.iterations])
            assert (np.diff(energies) <= 1e-12 * np.abs(energies).max()).all()


@pytest.mark.mpi
@pytest.mark.parametrize("case", ["snow", "no stiffness at the start"])
def test_preconditioners_save_iterations(case):
    structure, stages = CASES[case]
    runs = [Analysis(structure, ConjugateGradient("PR", kind)).run(stages)["end"] for kind in KINDS]
    counts = [[len(increment.iterations) for increment in run.increments] for run in runs]
    if case == "snow":  # two increments, and a tangent for each
        assert (np.array(counts[0]) > 3 * np.array(counts[2])).all()
        assert (np.array(counts[0]) > np.array(counts[1])).all()
    else:  # a tangent that is no better than tension alone
        assert len({tuple(count) for count in counts}) == 3


@pytest.mark.mpi
def test_start_from_which_no_preconditioner_can_be_made(monkeypatch):
    monkeypatch.setattr(preconditioners, "SHIFTS", (0.0,))
    structure, stages = CASES["no stiffness at the start"]
    for kind in ("jacobi", "tangent"):
        with pytest.raises(ConvergenceError, match=r"positive definite.*preconditioner=None"):
            Analysis(structure, ConjugateGradient("PR", kind)).run(stages)


@pytest.mark.mpi
def test_prescribed_displacements_are_there_from_the_first_iterate():
    stage = Stage("lift", displacements=[LIFT])
    first = Analysis(inclined_sheet(), ConjugateGradient()).run([stage])["lift"].history[0][1]
    there = Problem(inclined_sheet()).under()
    moved = np.zeros(INCLINED.shape)
    moved[CENTRE] = (0.01, 0, 0.1)
    assert first.energy == pytest.approx(there.energy(there.discretization.to_petsc(moved)), rel=1e-12)


def test_steepest_descent_is_the_slowest():
    stage = Stage("push", [PointLoad(CENTRE, (0, 0, -300.0))])
    counts = [
        len(Analysis(sheet(), solver).run([stage])["push"].history)
        for solver in (Newton(1e-5), ConjugateGradient(rtol=1e-5), SteepestDescent(rtol=1e-5, max_iterations=100_000))
    ]
    assert counts[0] < counts[1] < counts[2]


@pytest.mark.mpi
@pytest.mark.parametrize(
    ("solver", "helpful"),
    [
        (ConjugateGradient(max_iterations=3), [TANGENT]),
        (ConjugateGradient(preconditioner="tangent", max_iterations=3), []),
        (SteepestDescent(max_iterations=3), ["ConjugateGradient()", TANGENT]),
        (SteepestDescent("tangent", max_iterations=3), ["ConjugateGradient()"]),
    ],
    ids=["CG", "CG tangent", "SD", "SD tangent"],
)
def test_too_few_iterations(solver, helpful):
    with pytest.raises(ConvergenceError, match=r"after 3 iterations.*First-order methods.*slow") as error:
        Analysis(sheet(), solver).run([Stage("snow", [SNOW])])
    assert f"{type(solver).__name__}(max_iterations=...)" in str(error.value)
    assert "Newton() needs fewer iterations" in str(error.value)
    assert [word for word in ("ConjugateGradient()", TANGENT) if word in str(error.value)] == helpful
    assert len(error.value.failed.iterations) == 4
    assert error.value.failed.load_factor == 1  # smaller increments would not be faster


@pytest.mark.parametrize(
    "solver", [ConjugateGradient("PR", max_iterations=500), SteepestDescent("tangent", max_iterations=500)], ids=name
)
def test_iterations_that_stand_still_at_rounding_are_not_called_slow(solver):
    """A sagging cable whose prestress is far above all loads, and far from balance at the start."""
    x = np.linspace(0, 1, 17)
    points = np.column_stack([x, 0 * x, -0.1 * np.sin(np.pi * x)])
    cable = Cable(np.column_stack([np.arange(16), np.arange(1, 17)]), 1e8, prestress=1e6)
    structure = Structure(points, {"cable": cable}, [Support([0, 16]), Support(range(17), "y")])
    with pytest.raises(ConvergenceError, match=r"small.*not fall below.*tolerance") as error:
        Analysis(structure, replace(solver, rtol=1e-14)).run([Stage("rest")])
    assert "Newton() may get closer" in str(error.value)
    assert "slow" not in str(error.value)


@pytest.mark.mpi
def test_tolerance_below_rounding_ends_at_rounding():
    solver = ConjugateGradient(preconditioner="tangent", rtol=1e-30)
    result = Analysis(inclined_sheet(), solver).run([Stage("snow", [SNOW])])["snow"]
    assert result.equilibrium.residual < 1e-14 * 1e5


@pytest.mark.mpi
def test_snapping_through_goes_downhill():
    """Beyond the limit load Newton's method fails with full steps; descent leads to the hanging shape."""
    load = PointLoad(1, (0, 0, -1.2e4))
    found = Analysis(arch(), ConjugateGradient()).run([Stage("push", [load])])["push"]
    assert found.displacement[1, 2] < -0.6
    assert found.mast("arch").force.min() > 0


@pytest.mark.parametrize("kind", [ConjugateGradient, SteepestDescent])
@pytest.mark.parametrize(
    ("data", "message"),
    [
        ({"preconditioner": "lu"}, "preconditioner is 'lu'; give None, \"jacobi\""),
        ({"preconditioner": False}, "preconditioner is False"),
        ({"rtol": 0.0}, r"rtol is 0\.0"),
        ({"rtol": float("nan")}, "rtol is nan"),
        ({"max_iterations": 0}, "max_iterations is 0"),
        ({"max_iterations": 2.5}, r"max_iterations is 2\.5"),
    ],
)
def test_settings_out_of_range(kind, data, message):
    with pytest.raises(ValueError, match=f"{kind.__name__} {message}"):
        kind(**data)


@pytest.mark.parametrize("beta", ["HS", "pr", None, 1.0])
def test_only_the_two_formulas_of_the_paper(beta):
    with pytest.raises(ValueError, match=r"ConjugateGradient beta is .*Fletcher-Reeves.*Polak-Ribiere"):
        ConjugateGradient(beta)


def test_analysis_names_the_solvers_it_takes():
    with pytest.raises(ValueError, match=r"solver is .*Newton\(\)"):
        Analysis(sheet(), "CG")
