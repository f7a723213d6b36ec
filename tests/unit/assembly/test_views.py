"""Views of a problem under actions: each stays as it is, whatever else is asked of the problem."""

import copy
import pickle

import numpy as np
import pytest
from mpi4py import MPI
from petsc4py import PETSc

from fx_membrane import Actions, Fabric, Membrane, Pressure, Problem, Stage, Structure, Support
from fx_membrane.solvers.bordered_newton import BorderedNewton
from models import MIXED, POINTS, TRIANGLES, end, inclined_sheet

SLACK = Structure(POINTS, {"fabric": Membrane(TRIANGLES, Fabric(1e5, 0.3), -10.0)}, [Support([0, 4])])


def state(structure, seed=1):
    return 0.05 * np.random.default_rng(seed).normal(size=structure.points.shape)


def answers(view, displacement):
    """Energy, residual and product of the tangent, in the user's order."""
    discretization = view.discretization
    x, d = discretization.to_petsc(displacement), discretization.to_petsc(state(view.structure, 2))
    product = view.tangent(x) * d
    return np.array([view.energy(x), *discretization.to_numpy(view.residual(x)).ravel(), *product.array_r[:0]]), (
        discretization.to_numpy(product)
    )


def same(one, other):
    # On three processes sums arrive in an order of their own.
    return all(
        np.abs(np.subtract(a, b)).max() <= 1e-12 * max(np.abs(a).max(), np.abs(b).max())
        for a, b in zip(one, other, strict=True)
    )


@pytest.fixture
def problem():
    return Problem(inclined_sheet())


def test_view_does_not_depend_on_other_views(problem):
    at = state(problem.structure)
    calm, wind = problem.under(), problem.under(end(problem, Pressure(3e3, "fabric")))
    views = [
        calm,
        wind,
        wind.with_stabilization(1e-3),
        calm.without_compression_stiffness(),
        wind.without_compression_stiffness(0.01),
        wind.under(calm.actions),
    ]
    alone = [answers(view, at) for view in views]
    for first in range(len(views)):
        for second in range(len(views)):
            answers(views[first], at)
            assert same(answers(views[second], at), alone[second]), (first, second)
    assert same(alone[5], alone[0])
    assert not same(alone[1], alone[0])


@pytest.mark.mpi
def test_view_keeps_the_actions_that_it_got(problem):
    actions = end(problem, Pressure(3e3, "fabric"))
    given = actions.loads.copy(), actions.held.copy(), actions.displacement.copy(), actions.pressures["fabric"].copy()
    actions = Actions(*given[:3], {"fabric": given[3]})
    view, at = problem.under(actions), state(problem.structure)
    before = answers(view, at)
    for array, value in zip(given, (1e3, True, 5.0, 1e6), strict=True):
        array[:] = value
    assert same(answers(view, at), before)
    assert not view.constraints.moved()


def test_view_is_frozen(problem):
    with pytest.raises(AttributeError):
        problem.under().shift = 1e-3


@pytest.mark.mpi
def test_compression_stiffness_set_aside_leaves_that_of_others():
    problem, at = Problem(SLACK), -0.01 * POINTS
    full = problem.under()
    none = full.without_compression_stiffness()
    half = full.without_compression_stiffness(0.5)
    energies = [
        view.energy(problem.to_petsc(at)) for view in (full, none, half, half.without_compression_stiffness(0.5))
    ]
    rest = energies[1]
    assert energies[0] != rest
    # The energy is linear in the compression stiffness.
    assert [(energy - rest) / (energies[0] - rest) for energy in energies[2:]] == pytest.approx([0.5, 0.25], rel=1e-6)


def test_arc_length_leaves_other_views_alone(problem):
    wind = end(problem, Pressure(3e3, "fabric"))
    view, at = problem.under(wind), state(problem.structure)
    before = answers(view, at)
    x = problem.to_petsc(at)
    newton = BorderedNewton(problem, problem.under().actions, wind, x, 1e-10)
    newton.residual(x, 0.5)
    newton.linearize(x, 0.5)
    assert same(answers(view, at), before)
    newton.free()


@pytest.mark.mpi
def test_linearization_of_the_arc_length_does_not_depend_on_the_last_residual(problem):
    wind, x = end(problem, Pressure(3e3, "fabric")), problem.to_petsc(state(problem.structure))
    newton = BorderedNewton(problem, problem.under().actions, wind, x, 1e-10)
    found = []
    for last in (1.0, 0.2):
        newton.residual(x, last)
        assert newton.linearize(x, 1.0)
        found.append(problem.to_numpy(newton.du_load))
    assert found[1] == pytest.approx(found[0], rel=0, abs=1e-11 * np.abs(found[0]).max())  # sums in any order
    newton.free()


@pytest.mark.mpi
def test_vectors_and_matrices_given_are_filled_and_returned(problem):
    view, x = problem.under(), problem.to_petsc(state(problem.structure))
    b, A = problem.create_vector(), problem.create_matrix()
    assert view.residual(x, b) is b
    assert view.tangent(x, A) is A
    assert problem.mass(A) is A
    assert b.array_r == pytest.approx(view.residual(x).array_r, rel=1e-12, abs=1e-9)


@pytest.mark.mpi
def test_numbering_is_the_documented_one():
    """Rows 3 block + component: each row of the vector holds the value of the user's node and component."""
    problem = Problem(MIXED)
    values = np.arange(MIXED.points.size, dtype=float).reshape(MIXED.points.shape)
    first, last = (vector := problem.to_petsc(values)).getOwnershipRange()
    rows = (3 * problem.block_of_node[:, None] + np.arange(3)).ravel()
    here = (first <= rows) & (rows < last)
    assert vector.getValues(rows[here].astype(np.int32)).tolist() == values.ravel()[here].tolist()
    assert problem.comm.allreduce(int(here.sum())) == values.size
    assert np.array_equal(problem.to_numpy(vector), values)


@pytest.mark.mpi_once
@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"loads": np.zeros((3, 3))}, r"^Actions loads has shape \(3, 3\); this structure takes \(25, 3\)"),
        ({"held": np.zeros(25, bool)}, r"^Actions held has shape \(25,\)"),
        ({"pressures": {"fabric": np.zeros(3)}}, r"^Actions pressures of 'fabric' has shape \(3,\); .* \(32,\)"),
        ({"pressures": {"sail": np.zeros(32)}}, r"^No Membrane is named 'sail'"),
    ],
    ids=["loads", "held", "pressures", "part"],
)
def test_actions_that_do_not_fit_are_refused(problem, change, message):
    zero = np.zeros((25, 3))
    given = {"loads": zero, "held": zero.astype(bool), "displacement": zero} | change
    with pytest.raises(ValueError, match=message):
        problem.under(Actions(**given))


def test_bad_arguments_are_refused(problem):
    with pytest.raises(ValueError, match=r"^Problem structure is 'sheet'"):
        Problem("sheet")
    with pytest.raises(ValueError, match=r"^Problem comm"):
        Problem(MIXED, 3)
    with pytest.raises(ValueError, match=r"^actions is 3"):
        problem.under(3)
    with pytest.raises(ValueError, match=r"names part 'sail'|'sail'"):
        end(problem, Pressure(1.0, "sail"))


def _of_rows(count):
    return PETSc.Vec().createMPI(count, comm=MPI.COMM_WORLD)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda p: Problem(p.structure, elastic="no"), "Problem elastic is 'no'; give"),
        (lambda p: p.actions_of("a"), "actions_of stage is 'a'; give a Stage"),
        (lambda p: p.actions_of(Stage("a"), "x"), "actions_of start is 'x'; give an Actions"),
        (lambda p: p.under().under("x"), "actions is 'x'; give an Actions"),
        (lambda p: p.to_petsc(None), "to_petsc values must be an array of numbers .*, not None"),
        (lambda p: p.to_petsc(np.zeros((26, 3))), r"to_petsc values has shape \(26, 3\); give \(25, 3\)"),
        (lambda p: p.to_petsc(np.zeros(75)), r"to_petsc values has shape \(75,\); give \(25, 3\)"),
        (lambda p: p.to_petsc(np.full((25, 3), np.nan)), r"to_petsc values has a value .* not finite \(nan\)"),
        (lambda p: p.to_numpy(_of_rows(78)), "to_numpy vector is a PETSc vector with 78 rows; the problem has 75"),
        (lambda p: p.mass(p.create_vector()), "A is a PETSc Vec; give a PETSc matrix: make one with create_matrix"),
    ],
)
def test_wrong_objects_are_refused_by_the_problem(problem, call, message):
    with pytest.raises(ValueError, match=f"^{message}"):
        call(problem)


VECTORS = {
    "array": (lambda: np.zeros((25, 3)), "an array of float64, shape .*; give a PETSc vector: make one with create_v"),
    "larger": (lambda: _of_rows(78), "a PETSc vector with 78 rows; the problem has 75: make one with create_vector"),
    "smaller": (lambda: _of_rows(3), "a PETSc vector with 3 rows; the problem has 75"),
    "untouched": (PETSc.Vec, "a PETSc vector without rows; make one with create_vector"),
    "unset": (lambda: PETSc.Vec().create(), "a PETSc vector without rows; make one with create_vector"),
}
METHODS = {
    "energy": lambda view, x: view.energy(x),
    "residual": lambda view, x: view.residual(x),
    "tangent": lambda view, x: view.tangent(x),
    "derivative": lambda view, x: view.derivative(x, "fabric", "Et"),
    "derivative by a pressure": lambda view, x: view.derivative(x, "fabric", "pressure"),
    "load derivative": lambda view, x: view.load_derivative(x),
}
RESULTS = {
    "residual": lambda view, x, b: view.residual(x, b),
    "derivative": lambda view, x, b: view.derivative(x, "fabric", "Et", b=b),
    "load derivative": lambda view, x, b: view.load_derivative(x, b=b),
}


@pytest.mark.mpi_once
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("vector", VECTORS)
def test_vectors_of_another_problem_are_refused(problem, method, vector):
    make, message = VECTORS[vector]
    with pytest.raises(ValueError, match=f"^x is {message}"):
        METHODS[method](problem.under(), make())


@pytest.mark.mpi_once
@pytest.mark.parametrize("method", RESULTS)
@pytest.mark.parametrize("vector", VECTORS)
def test_vectors_for_results_of_another_problem_are_refused(problem, method, vector):
    make, message = VECTORS[vector]
    with pytest.raises(ValueError, match=f"^b is {message}"):
        RESULTS[method](problem.under(), problem.create_vector(), make())


@pytest.mark.mpi
def test_matrices_of_another_problem_are_refused(problem):
    x = problem.create_vector()
    other = PETSc.Mat().createAIJ((75, 78), comm=problem.comm)
    other.setUp()
    smaller = Problem(MIXED).create_matrix()
    for A, message in [
        (np.eye(75), "an array of float64"),
        (PETSc.Mat(), "a PETSc matrix without rows; make one with create_matrix"),
        (smaller, f"a PETSc matrix with {MIXED.points.size} rows; the problem has 75"),
        (other, "a PETSc matrix with 78 columns; the problem has 75|a PETSc matrix with the rows .* distributed"),
    ]:
        with pytest.raises(ValueError, match=f"^A is ({message})"):
            problem.under().tangent(x, A)


def test_lists_of_nodal_values_are_taken(problem):
    values = state(problem.structure)
    assert np.array_equal(problem.to_numpy(problem.to_petsc(values.tolist())), values)


def test_start_of_a_load_factor_that_does_not_fit_is_refused(problem):
    zero = np.zeros((3, 3))
    view, x = problem.under(), problem.create_vector()
    with pytest.raises(ValueError, match=r"^Actions loads has shape \(3, 3\); this structure takes \(25, 3\)"):
        view.load_derivative(x, Actions(zero, zero.astype(bool), zero))
    with pytest.raises(ValueError, match=r"^start is 3; give an Actions"):
        view.load_derivative(x, 3)


@pytest.mark.mpi
def test_problem_is_shared_by_copies_and_never_pickled(problem):
    assert copy.deepcopy(problem) is problem
    with pytest.raises(TypeError, match="cannot be pickled"):
        pickle.dumps(problem)


@pytest.mark.mpi
def test_number_is_that_of_all_processes():
    alone = Problem(MIXED, MPI.COMM_SELF) if MPI.COMM_WORLD.rank == 0 else None
    both = Problem(MIXED), Problem(MIXED)
    numbers = MPI.COMM_WORLD.allgather([problem.number for problem in both])
    assert len({tuple(entry) for entry in numbers}) == 1
    assert numbers[0][0] != numbers[0][1]
    assert alone is None or alone.number not in numbers[0]
