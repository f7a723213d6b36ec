"""Newton's method converges quadratically.

Reference: Taylor's theorem: near a solution with a regular tangent the error of a Newton step is of the order of the
square of the last one.
Claim: the order 2 on a saddle of fabric with edge cables and a mast; also with a pressure that follows the fabric, and
with wrinkles as long as no cell changes its state.
Under a pressure the whole run to equilibrium shows the order, and the effect of the load stiffness.
Tolerance: with r' = c r^2 from step to step, the ratio of logarithms of three residuals is
2 + log(c'/c) / log(r'/r); for a factor c that changes by 3 while the residual falls by 40 that is 2 within 0.3. One
step from a disturbed equilibrium: the disturbance, 2e-7, is far below the size of the structure, and leaves 1e-9 to
1e-10 N, of which rounding is 1e-13: 0.05.
"""

from dataclasses import replace

import numpy as np
import pytest
from petsc4py import PETSc

from fx_membrane import (
    Analysis,
    Mast,
    Newton,
    Pressure,
    Stage,
    Structure,
)
from fx_membrane.assembly.actions import Actions
from fx_membrane.assembly.problem import Problem
from fx_membrane.solvers.curvature import lowest_mode
from saddles import CENTRE, LOADS, SADDLES

SOURCE = "Taylor's theorem"

DISTURBANCES = 2e-7 / 2.0 ** np.arange(4)  # so small that no cell changes its state


@pytest.mark.mpi_once
@pytest.mark.parametrize("name", SADDLES)
@pytest.mark.parametrize("load", ["point", "dead"])
def test_newton_is_quadratic(name, load, verified):
    stages = [Stage("prestress"), Stage("load", loads=[LOADS[load]], after="prestress")]
    state = Analysis(SADDLES[name], Newton(line_search=False)).run(stages)["load"]
    residuals = np.array([iteration.residual for _, iteration in state.history])
    residuals = residuals[residuals > 1e-12 * np.abs(state.reactions).max()]  # below is rounding
    orders = np.log(residuals[2:] / residuals[1:-1]) / np.log(residuals[1:-1] / residuals[:-2])
    assert residuals[-1] < 1e-6
    assert residuals[-1] < residuals[-2] / 40 < residuals[-3] / 40**2
    assert orders[-1] == pytest.approx(2, abs=0.3)
    verified("order of Newton's method", 2.0, orders[-1])


@pytest.mark.parametrize("name", SADDLES)
def test_line_search_and_inertia_correction_leave_a_fast_end(name):
    """Ten times the load, with short first steps: at the end each step gains more digits than the previous one."""
    structure = SADDLES[name]
    problem, zero = Problem(structure), np.zeros(structure.points.shape)
    solve, x = Newton(rtol=1e-12).prepare(problem), problem.create_vector()
    assert solve(problem.under(), x).converged  # under the prestress
    load = zero.copy()
    load[CENTRE] = (40.0, 20.0, -150.0)
    steps = solve(problem.under(Actions(load, structure.supported, zero)), x).iterations
    assert any(iteration.step < 1 for iteration in steps[1:])
    assert (steps[-1].step, steps[-1].shift) == (1, 0)
    residuals = np.array([iteration.residual for iteration in steps])
    residuals = residuals[residuals > 1e-12 * np.abs(load).max()]  # below is rounding
    digits = -np.diff(np.log10(residuals))
    assert digits[-1] > max(3, 1.3 * digits[-2])


# Follower pressure, whose load has a stiffness; wrinkling, whose tangent is exact within one pattern of states


def after_one_step(problem, equilibrium, step, direction, stiffness=None):
    """Largest unbalanced force after one Newton step from a disturbed equilibrium; the tangent may be another's."""
    stiffness = stiffness or problem
    x, dx = equilibrium.copy(), equilibrium.duplicate()
    b, A = problem.discretization.create_vector(), problem.discretization.create_matrix()
    x.axpy(step, direction)
    problem.residual(x, b)
    problem.constraints.constrain_residual(x, b)
    stiffness.tangent(x, A)
    stiffness.constraints.constrain_tangent(x, A, b)
    solver = PETSc.KSP().create(A.comm)
    solver.setOperators(A)
    solver.setType("preonly")
    solver.getPC().setType("lu")
    solver.getPC().setFactorSolverType("mumps")
    solver.solve(b, dx)
    x.axpy(-1.0, dx)
    problem.residual(x, b)
    problem.constraints.constrain_residual(x, b)
    return b.norm(PETSc.NormType.NORM_INFINITY)


@pytest.mark.parametrize("share", [1e-4, 1.0], ids=["wrinkling", "full"])
@pytest.mark.parametrize("load", LOADS)
@pytest.mark.parametrize("name", SADDLES)
def test_one_step_squares_the_error(name, load, share):
    """Disturbed by h, a Newton step leaves h^2; without the stiffness of a pressure it leaves h, and so it would with
    the tangent of another pattern of wrinkles."""
    structure = SADDLES[name]
    parts = {
        key: part if isinstance(part, Mast) else replace(part, compression_stiffness=share)
        for key, part in structure.parts.items()
    }
    structure = Structure(structure.points, parts, structure.supports)
    stages = [Stage("prestress"), Stage("load", loads=[LOADS[load]], after="prestress")]
    state = Analysis(structure, Newton(rtol=1e-13)).run(stages)["load"]
    sail = state.membrane("sail")
    shortened = sail.principal[:, 1] < 0
    assert 5 < np.count_nonzero(shortened) < len(shortened) - 5
    assert np.array_equal(sail.state == "wrinkled", shortened & (share < 1))

    pressures = {}
    if isinstance(pressure := LOADS[load], Pressure):
        pressures["sail"] = pressure.pressure * np.ones(len(parts["sail"].cells))
    zero = np.zeros(structure.points.shape)
    forces = zero if pressures else state.loads
    owner = Problem(structure)
    problem = owner.under(Actions(forces, structure.supported, zero, pressures))
    distribute = problem.discretization.to_petsc
    direction = np.where(structure.supported, 0, np.random.default_rng(6).normal(size=zero.shape))
    left = [after_one_step(problem, distribute(state.displacement), h, distribute(direction)) for h in DISTURBANCES]
    np.testing.assert_allclose(np.log2(np.divide(left[:-1], left[1:])), 2, rtol=0, atol=0.05)
    if pressures:
        without = owner.under()
        start, d = distribute(state.displacement), distribute(direction)
        left = [after_one_step(problem, start, h, d, without) for h in DISTURBANCES]
        np.testing.assert_allclose(np.log2(np.divide(left[:-1], left[1:])), 1, rtol=0, atol=0.05)


def disturbed(problem, equilibrium, step, direction):
    """Largest unbalanced force where an equilibrium is disturbed."""
    x, b = equilibrium.copy(), equilibrium.duplicate()
    x.axpy(step, direction)
    problem.residual(x, b)
    problem.constraints.constrain_residual(x, b)
    return b.norm(PETSc.NormType.NORM_INFINITY)


@pytest.mark.mpi_once
@pytest.mark.parametrize("pressure", [20.0, 60.0, -20.0, -60.0])
@pytest.mark.parametrize("name", SADDLES)
def test_newton_under_pressure_is_quadratic(name, pressure):
    """Below 1e-4 of the largest reaction a residual r is followed by less than c r^2.

    c is the remainder of a disturbance along the lowest mode, in which a force moves the structure most: 200 to 6500
    here. Steps without the stiffness of the pressure leave 1e-2 r to 8e-1 r, down to the smallest r judged, where c r
    is 3e-5 at most. Rounding leaves 1e-15.
    """
    structure = SADDLES[name]
    stages = [Stage("prestress"), Stage("load", loads=[Pressure(pressure, "sail")], after="prestress")]
    state = Analysis(structure).run(stages)["load"]
    unit = np.abs(state.reactions).max()

    zero = np.zeros(structure.points.shape)
    pressures = {"sail": pressure * np.ones(len(structure.parts["sail"].cells))}
    problem = Problem(structure).under(Actions(zero, structure.supported, zero, pressures))
    equilibrium = problem.discretization.to_petsc(state.displacement)
    motion = lowest_mode(problem, equilibrium, 0.0).motion
    h = 1e-5  # [m]
    left = after_one_step(problem, equilibrium, h, motion)
    constant = left * unit / disturbed(problem, equilibrium, h, motion) ** 2

    residuals = np.array([iteration.residual for _, iteration in state.history]) / unit
    before, after = residuals[:-1], residuals[1:]
    judged = (before < 1e-4) & (constant * before**2 > 1e-13)
    assert judged.any()
    assert (after[judged] < constant * before[judged] ** 2).all()
