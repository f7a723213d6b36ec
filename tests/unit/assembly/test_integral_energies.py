"""Energies of one integral: derivatives, bordered solves, given values, eigenvalues."""

from dataclasses import dataclass

import numpy as np
import pytest
from mpi4py import MPI
from petsc4py import PETSc

from cushions import cushion, outward
from fx_membrane import Newton, Pressure, Stage
from fx_membrane.assembly.one_integral import EnergyOfIntegral, GivenIntegral
from fx_membrane.assembly.problem import Problem
from fx_membrane.assembly.volume import Volume
from fx_membrane.solvers import eigenvalues
from fx_membrane.solvers.augmented_matrix import augmented
from fx_membrane.solvers.bordered_system import BorderedSystem
from fx_membrane.solvers.curvature import lowest_mode

NO_RIMS = np.empty((0, 2), dtype=np.int64), np.empty((0, 3))


@dataclass(frozen=True)
class Spring:
    """Energy k (V - V0)^2 / 2 - p V."""

    k: float
    rest: float
    p: float = 0.0

    def energy(self, value):
        return self.k * (value - self.rest) ** 2 / 2 - self.p * value

    def force(self, value):
        return self.k * (value - self.rest) - self.p

    def stiffness(self, value):
        return self.k

    def size(self, value):
        return abs(self.energy(value))

    def force_size(self, value):
        return self.k * (abs(value) + abs(self.rest)) + abs(self.p)


def volume(problem):
    return Volume(problem.discretization, outward(problem.structure), *NO_RIMS)


def loaded(problem, law, **stage):
    energy = EnergyOfIntegral("gas", problem.discretization, volume(problem), law)
    return problem.under(problem.actions_of(Stage("load", **stage))).with_integrals([energy])


def random(problem, size=0.02, seed=0):
    return problem.to_petsc(np.random.default_rng(seed).normal(scale=size, size=problem.structure.points.shape))


def times(view, x, dx, given=True):
    """Tangent with its borders times a vector."""
    A, y, borders = view.tangent(x), dx.duplicate(), view.borders(x)
    BorderedSystem(borders).multiply(A, dx, y)
    for row, (column, compliance) in enumerate(zip(borders.vectors, borders.compliances, strict=True)):
        held = view.comm.allreduce(borders.held[row] @ dx.array_r[view.constraints.rows])
        y.axpy(held / compliance, column)
    return y


@pytest.mark.mpi
def test_volume_is_that_of_the_pressure():
    problem = Problem(cushion())
    x, b = random(problem), problem.create_vector()
    inside = volume(problem)
    inside.gradient(x, b)
    blown = [Pressure(1.0, "top"), Pressure(-1.0, "bottom")]
    forces = problem.under(problem.actions_of(Stage("p", blown))).pressure_loads(x)
    assert np.allclose(problem.to_numpy(b), forces, atol=1e-14)
    points, cells = problem.structure.points + problem.to_numpy(x), outward(problem.structure)
    assert inside.value(x) == pytest.approx(np.linalg.det(points[cells]).sum() / 6, rel=1e-12)


@pytest.mark.mpi
def test_derivatives():
    """Remainders of Taylor's series of energy (order 3) and residual (order 2), off and on the constrained nodes."""
    problem = Problem(cushion())
    view = loaded(problem, Spring(3e4, 0.2, 400.0))
    x, way = random(problem), random(problem, 1.0, 1)
    view.constraints.zero_constrained(way)
    b = view.residual(x)
    slope, K = float(b.dot(way)), times(view, x, way)
    curvature, energies, forces = float(K.dot(way)), [], []
    lengths = 1e-2 / 2.0 ** np.arange(5)
    for length in lengths:
        at = x.duplicate()
        at.waxpy(length, way, x)
        energies.append(view.energy(at) - view.energy(x) - length * slope - length**2 * curvature / 2)
        rest = view.residual(at)
        rest.axpy(-1.0, b)
        rest.axpy(-length, K)
        view.constraints.zero_constrained(rest)
        forces.append(rest.norm())
    orders = [np.log2(np.abs(np.divide(values[:-1], values[1:]))) for values in (energies, forces)]
    assert orders[0][-1] == pytest.approx(3, abs=0.1)
    assert orders[1][-1] == pytest.approx(2, abs=0.1)


def solve(problem, view, x=None):
    x = problem.create_vector() if x is None else x
    return Newton(rtol=1e-11).prepare(problem)(view, x, lambda *_: None, True), x


@pytest.mark.mpi
@pytest.mark.parametrize("k", [1e3, 1e5, 1e6])
def test_rate_is_quadratic(k):
    problem = Problem(cushion())
    view = loaded(problem, Spring(k, 0.9))
    solution, x = solve(problem, view)
    assert solution.converged
    residuals = np.array([entry.residual for entry in solution.iterations])
    assert len(residuals) < 20
    close = residuals[(residuals < 1e-1 * residuals.max()) & (residuals > 1e-9 * residuals.max())]
    assert (close[1:] < 50 * close[:-1] ** 2 / residuals.max()).all() or len(close) < 2
    assert np.abs(problem.to_numpy(view.residual(x))[~view.actions.held]).max() < 1e-6


@pytest.mark.mpi
def test_given_volume():
    """A given volume is that of a very stiff spring, and its multiplier the pressure that holds it."""
    problem = Problem(cushion())
    inside, base = volume(problem), problem.under()
    given = GivenIntegral("gas", problem.discretization, inside, target=0.9)
    view = base.with_integrals([given])
    solution, x = solve(problem, view)
    assert solution.converged
    assert len(solution.iterations) < 15
    assert inside.value(x) == pytest.approx(0.9, rel=1e-12)
    pressure = -view.settled(x).integrals.given[0].multiplier
    _, stiff = solve(problem, loaded(problem, Spring(1e9, 0.9)), x.copy())
    stiff.axpy(-1.0, x)
    assert stiff.norm() < 1e-5
    blown = [Pressure(pressure, "top"), Pressure(-pressure, "bottom")]
    open_ = problem.under(problem.actions_of(Stage("p", blown)))
    assert np.abs(problem.to_numpy(open_.residual(x))[~view.actions.held]).max() < 1e-6 * pressure


@pytest.mark.mpi
@pytest.mark.parametrize("k", [-1e3, 5e4, 1e7, None])
def test_inertia_and_eigenvalues(k):
    """Negative eigenvalues by the capacitance and by the joined matrix are those of the full one."""
    structure = cushion(3, prestress=-2e4)
    problem = Problem(structure)
    x = random(problem)
    integral = volume(problem)
    energy: EnergyOfIntegral
    if k is None:
        energy = GivenIntegral("gas", problem.discretization, integral, target=0.3)
    else:
        energy = EnergyOfIntegral("gas", problem.discretization, integral, Spring(k, 0.3))
    view = problem.under().with_integrals([energy])
    free = np.flatnonzero(~view.actions.held)
    full = dense(problem, view.tangent(x))[np.ix_(free, free)]
    gradient = problem.create_vector()
    integral.gradient(x, gradient)
    B = problem.to_numpy(gradient).ravel()[free]
    if k is None:
        kept = np.linalg.svd(B[None])[2][1:]
        full = kept @ full @ kept.T
    else:
        full = full + k * np.outer(B, B)
    exact = np.linalg.eigvalsh(full)
    mode = lowest_mode(view, x, 0.0)
    assert mode.negative == (exact < 0).sum() > 0
    rows = problem.discretization.dofs(~view.actions.held)
    chosen = PETSc.IS().createGeneral(rows, comm=MPI.COMM_WORLD)
    K = view.tangent(x).createSubMatrix(chosen, chosen)
    joined = augmented(K, None, view.borders(x), rows - 3 * problem.discretization.first_block)
    pairs, negative = eigenvalues.lowest(joined.K, joined.M, 3, borders=joined.negative)
    assert negative == (exact < 0).sum()
    assert np.allclose([pair.value.real for pair in pairs], exact[:3], rtol=1e-8)


@pytest.mark.parametrize("given", [False, True], ids=["law", "given volume"])
def test_border_costs_one_more_solve(given):
    """The factorization serves all borders: one solve each, none for the correction of a step or a new right side."""
    problem = Problem(cushion())
    x, count = random(problem), 3
    integral = volume(problem)
    target = GivenIntegral("gas", problem.discretization, integral, target=0.3)
    energies = [EnergyOfIntegral("gas", problem.discretization, integral, Spring(k, 0.3)) for k in (1e3, 2e3)]
    view = problem.under().with_integrals([*energies, target if given else energies[0]])
    solves = []

    class Counted:
        def solve(self, b, y):
            solves.append(b)
            b.copy(y)

    bordered = BorderedSystem(view.borders(x))
    bordered.factor(Counted())
    assert len(bordered.borders.vectors) == len(solves) == count
    bordered.correct(problem.create_vector())
    assert len(solves) == count
    bordered.free()


def dense(problem, A):
    """Dense matrix in the user's order."""
    columns = []
    for column in np.eye(3 * len(problem.structure.points)):
        x = problem.to_petsc(column.reshape(-1, 3))
        y = x.duplicate()
        A.mult(x, y)
        columns.append(problem.to_numpy(y).ravel())
    return np.array(columns).T
