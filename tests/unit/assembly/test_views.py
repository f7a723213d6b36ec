"""Views of a problem under actions: each stays as it is, whatever else is asked of the problem."""

import copy
import pickle

import numpy as np
import pytest
from mpi4py import MPI

from fx_membrane import Actions, Fabric, Membrane, Pressure, Problem, Structure, Support
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
    return all(np.array_equal(a, b) for a, b in zip(one, other, strict=True))


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


def test_view_keeps_the_actions_that_it_got(problem):
    actions = end(problem, Pressure(3e3, "fabric"))
    actions = Actions(actions.loads.copy(), actions.held.copy(), actions.displacement.copy(), actions.pressures)
    view, at = problem.under(actions), state(problem.structure)
    before = answers(view, at)
    actions.loads[:], actions.pressures["fabric"][:], actions.held[:], actions.displacement[:] = 1e3, 1e6, True, 5.0
    assert same(answers(view, at), before)
    assert not view.constraints.moved()


def test_view_is_frozen(problem):
    with pytest.raises(AttributeError):
        problem.under().shift = 1e-3


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


def test_linearization_of_the_arc_length_does_not_depend_on_the_last_residual(problem):
    wind, x = end(problem, Pressure(3e3, "fabric")), problem.to_petsc(state(problem.structure))
    newton = BorderedNewton(problem, problem.under().actions, wind, x, 1e-10)
    found = []
    for last in (1.0, 0.2):
        newton.residual(x, last)
        assert newton.linearize(x, 1.0)
        found.append(problem.to_numpy(newton.du_load))
    assert np.array_equal(*found)
    newton.free()


def test_vectors_and_matrices_given_are_filled_and_returned(problem):
    view, x = problem.under(), problem.to_petsc(state(problem.structure))
    b, A = problem.create_vector(), problem.create_matrix()
    assert view.residual(x, b) is b
    assert view.tangent(x, A) is A
    assert problem.mass(A) is A
    assert np.array_equal(b.array_r, view.residual(x).array_r)


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


def test_problem_is_shared_by_copies_and_never_pickled(problem):
    assert copy.deepcopy(problem) is problem
    with pytest.raises(TypeError, match="cannot be pickled"):
        pickle.dumps(problem)


def test_number_is_that_of_all_processes():
    alone = Problem(MIXED, MPI.COMM_SELF) if MPI.COMM_WORLD.rank == 0 else None
    both = Problem(MIXED), Problem(MIXED)
    numbers = MPI.COMM_WORLD.allgather([problem.number for problem in both])
    assert len({tuple(entry) for entry in numbers}) == 1
    assert numbers[0][0] != numbers[0][1]
    assert alone is None or alone.number not in numbers[0]
