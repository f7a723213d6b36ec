"""Newton's method: its outcome, and its history."""

import numpy as np
import pytest

from fx_membrane import Cable, Fabric, Mast, Membrane, Newton, Outcome, Structure, Support
from fx_membrane.assembly.actions import Actions
from fx_membrane.assembly.problem import Problem
from models import EDGE, POINTS, TRIANGLES, rotation, sheet

PLAIN = Newton(line_search=False)


def sheet_under(force, prestress=1e3):
    problem = Problem(sheet(prestress=prestress))
    loads = np.zeros(POINTS.shape)
    loads[12] = force
    return problem, problem.under(Actions(loads, problem.structure.supported, np.zeros(POINTS.shape)))


def solve(given, solver=Newton()):
    problem, loaded = given
    x = problem.create_vector()
    return solver.prepare(problem)(loaded, x), problem.to_numpy(x)


@pytest.mark.mpi_once
@pytest.mark.parametrize("solver", [Newton(), PLAIN], ids=["line search", "plain"])
def test_newton_converges_quadratically(solver):
    solution, displacement = solve(sheet_under((0, 0, -300.0)), solver)
    assert solution.converged
    assert displacement[12, 2] < -0.01
    residuals = np.array([entry.residual for entry in solution.iterations])
    assert residuals[0] == pytest.approx(300)
    assert residuals[-1] <= 1e-8 * 300
    last = residuals[residuals > 1e-9][-3:]
    order = np.log(last[2] / last[1]) / np.log(last[1] / last[0])
    assert order > 1.7


def test_history_starts_with_the_start_and_ends_with_the_solution():
    problem, loaded = sheet_under((0, 0, -300.0))
    solution, displacement = solve((problem, loaded))
    energies = [entry.energy for entry in solution.iterations]
    assert energies[0] == 0
    assert energies[-1] == loaded.energy(problem.to_petsc(displacement))
    assert energies[-1] == pytest.approx(min(energies), rel=1e-14)
    steps = [entry.step for entry in solution.iterations]
    assert steps[0] == 0
    assert 0 < steps[1] < 1  # a full step would overshoot
    assert steps[-3:] == [1.0] * 3


def test_plain_newton_takes_full_steps():
    solution, _ = solve(sheet_under((0, 0, -300.0)), PLAIN)
    assert solution.converged
    assert [entry.step for entry in solution.iterations] == [0.0] + [1.0] * (len(solution.iterations) - 1)
    assert {entry.shift for entry in solution.iterations} == {0.0}
    assert solution.iterations[1].residual > solution.iterations[0].residual  # the first step overshoots


def test_start_in_equilibrium_takes_no_step():
    # Without prestress a step would find the tangent singular.
    solution, displacement = solve(sheet_under((0, 0, 0), prestress=0.0))
    assert solution.converged
    assert len(solution.iterations) == 1
    assert not displacement.any()


@pytest.mark.parametrize("force", [1e-4, 1e-9])
def test_load_far_below_the_prestress_moves_the_sheet_in_proportion(force):
    _, expected = solve(sheet_under((0, 0, -1e-2)))
    solution, displacement = solve(sheet_under((0, 0, -force)))
    assert solution.converged
    assert displacement == pytest.approx(force / 1e-2 * expected, abs=1e-5 * force / 1e-2 * np.abs(expected).max())


@pytest.mark.mpi
def test_solver_can_be_used_again():
    problem, loaded = sheet_under((0, 0, -300.0))
    again = Newton().prepare(problem)
    x, y = problem.create_vector(), problem.create_vector()
    first, second = again(loaded, x), again(loaded, y)
    # Not to the last digit: processes add at shared nodes in any order.
    energies = [entry.energy for entry in first.iterations]
    assert [entry.energy for entry in second.iterations] == pytest.approx(energies, rel=1e-12)
    assert second.iterations[0].step == 0
    assert again(loaded, x).iterations[0].energy == pytest.approx(energies[-1], rel=1e-12)


@pytest.mark.mpi_once
@pytest.mark.parametrize("most", [1, 2, 3])
def test_number_of_iterations_is_limited(most):
    solution, _ = solve(sheet_under((0, 0, -300.0)), Newton(max_iterations=most, line_search=False))
    assert not solution.converged
    assert len(solution.iterations) == most + 1
    assert "more increments" in solution.reason
    assert "Newton(max_iterations=...)" in solution.reason


@pytest.mark.mpi
def test_tolerance_is_relative_to_the_nodal_forces():
    coarse, _ = solve(sheet_under((0, 0, -300.0)), Newton(rtol=1e-2))
    fine, _ = solve(sheet_under((0, 0, -300.0)), Newton(rtol=1e-10))
    assert coarse.converged
    assert coarse.iterations[-1].residual > 1e-10 * 300
    assert len(coarse.iterations) < len(fine.iterations)


@pytest.mark.mpi_once
@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_units_do_not_matter(scale):
    def iterations(unit):
        membrane = Membrane(TRIANGLES, Fabric(Et=1e5 * unit, nu=0.3), prestress=1e3 * unit)
        problem = Problem(Structure(POINTS, {"fabric": membrane}, [Support(EDGE)]))
        loads = np.zeros(POINTS.shape)
        loads[12, 2] = -300.0 * unit
        loaded = problem.under(Actions(loads, problem.structure.supported, np.zeros(POINTS.shape)))
        solution, displacement = solve((problem, loaded))
        assert solution.converged
        return displacement

    assert iterations(scale) == pytest.approx(iterations(1.0), abs=1e-12)


@pytest.mark.mpi_once
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("load", [0.0, 1e-3])
def test_prestress_in_balance_with_itself_is_in_equilibrium(seed, load):
    # The sum of forces of 1 kN is rounding, and no support or load gives a scale for it.
    R = rotation(seed)
    points = np.array([[0, 0, 0], [0.7, 0, 0], [2, 0, 0]]) @ R.T
    parts = {"cable": Cable([[0, 1], [1, 2]], 1e6, 1e3), "mast": Mast([[0, 2]], 1e8, -1e3)}
    problem = Problem(Structure(points, parts, [Support([0, 2])]))
    loads = np.outer([0, load, 0], R[:, 2])
    loaded = problem.under(Actions(loads, problem.structure.supported, np.zeros((3, 3))))
    solution, displacement = solve((problem, loaded))
    assert solution.converged, solution.reason
    # Energies show nothing here: the work of the prestress cancels, but for rounding above the work of the load.
    assert {entry.step for entry in solution.iterations[1:]} <= {1.0}
    assert len(solution.iterations) <= 4
    assert solution.outcome is Outcome.CONVERGED
    expected = load / (1e3 / 0.7 + 1e3 / 1.3)  # N0 / l on both sides
    assert displacement[1] @ R[:, 2] == pytest.approx(expected, rel=1e-5, abs=1e-15)


@pytest.mark.mpi
def test_singular_tangent_stops_with_a_reason():
    solution, displacement = solve(sheet_under((0, 0, -300.0), prestress=0.0), PLAIN)
    assert not solution.converged
    assert len(solution.iterations) == 1
    assert "singular" in solution.reason
    assert "prestress" in solution.reason
    assert not displacement.any()


@pytest.mark.mpi
def test_singular_tangent_at_the_start_is_so_for_any_increment():
    assert solve(sheet_under((0, 0, -300.0), prestress=0.0), PLAIN)[0].outcome is Outcome.SINGULAR_START


@pytest.mark.mpi_once
@pytest.mark.parametrize(
    ("force", "solver"), [(300.0, Newton(max_iterations=1, line_search=False)), (1e30, PLAIN), (1e30, Newton())]
)
def test_smaller_increment_may_help_where_the_iteration_fails(force, solver):
    solution, _ = solve(sheet_under((0, 0, -force)), solver)
    assert not solution.converged
    assert solution.outcome.retry


@pytest.mark.mpi
def test_monitor_is_told_each_iterate():
    (problem, loaded), told = sheet_under((0, 0, -300.0)), []
    solution = Newton().prepare(problem)(
        loaded, problem.create_vector(), lambda number, iterate: told.append((number, iterate))
    )
    assert told == list(enumerate(solution.iterations))
    assert len(told) > 2


def test_monitor_of_one_solve_is_not_told_of_the_next():
    (problem, loaded), told = sheet_under((0, 0, -300.0)), []
    again = Newton().prepare(problem)
    again(loaded, problem.create_vector(), lambda number, iterate: told.append(number))
    count = len(told)
    again(loaded, problem.create_vector())
    assert len(told) == count


@pytest.mark.mpi_once
@pytest.mark.parametrize("force", [1e30, 1e200])
def test_divergence_stops_with_a_reason(force):
    solution, _ = solve(sheet_under((0, 0, force)), PLAIN)
    assert not solution.converged
    assert "diverged" in solution.reason
    assert "units" in solution.reason


def test_load_whose_energies_overflow_fails_in_words():
    solution, _ = solve(sheet_under((0, 0, 1e60)))
    assert not solution.converged
    assert solution.reason.endswith(".")


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ({"rtol": 0.0}, r"rtol is 0\.0"),
        ({"rtol": -1e-8}, "rtol is -1e-08"),
        ({"rtol": float("nan")}, "rtol is nan"),
        ({"max_iterations": 0}, "max_iterations is 0"),
        ({"max_iterations": 2.5}, r"max_iterations is 2\.5"),
        ({"line_search": 1}, "line_search"),
    ],
)
def test_settings_out_of_range(data, message):
    with pytest.raises(ValueError, match=message):
        Newton(**data)
