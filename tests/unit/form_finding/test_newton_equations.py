"""Linear systems of Newton's equations, solved again with other values of one pattern."""

from pathlib import Path

import numpy as np
import pytest
from scipy import sparse

from fx_membrane.form_finding.nearest_stress import system


def test_tries_of_a_step_are_solved_with_their_own_values():
    random = np.random.default_rng(1)
    matrix = (sparse.random(40, 40, 0.2, random_state=1) + sparse.eye(40)).tocsr()
    solved = system._solver(matrix)
    right = random.random(40)
    for factor in (1.0, 1e-3, 1e3):  # orders of pivots that differ
        values = matrix.data * factor ** random.choice([-1, 0, 1], matrix.nnz)
        now = sparse.csr_matrix((values, matrix.indices, matrix.indptr))
        assert solved(values, right) == pytest.approx(np.linalg.solve(now.toarray(), right), rel=1e-6)


def test_values_without_a_solution_are_refused_and_the_next_ones_are_solved():
    matrix = sparse.csr_matrix([[2.0, 1.0], [1.0, 3.0]])
    solved = system._solver(matrix)
    assert solved(matrix.data, np.ones(2)) == pytest.approx([0.4, 0.2])
    with pytest.raises(RuntimeError, match="singular"):
        solved(np.full(4, np.nan), np.ones(2))
    assert solved(matrix.data, np.ones(2)) == pytest.approx([0.4, 0.2])


def test_block_gets_places_in_the_pattern():
    whole, block = sparse.random(7, 7, 0.3, random_state=2), sparse.random(3, 3, 0.5, random_state=3).tocsr()
    matrix, added = system._in_one_pattern(whole, block, 2)
    expected = whole.toarray()
    expected[2:5, 2:5] -= 0.5 * block.toarray()
    damped = sparse.csr_matrix((matrix.data - 0.5 * added, matrix.indices, matrix.indptr), shape=matrix.shape)
    assert damped.toarray() == pytest.approx(expected)


def resident():
    """Memory of this process [MB]."""
    return int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1]) * 4096 / 1e6


def test_factors_are_freed_with_their_equations():
    """PETSc 3.18 collects what is not destroyed as garbage: 20 MB for each of these."""
    matrix = (sparse.random(1500, 1500, 0.01, random_state=1) + sparse.eye(1500)).tocsr()
    for repeat in range(15):
        system._solver(matrix)(matrix.data, np.ones(1500))
        if repeat == 4:
            before = resident()
    assert resident() < before + 50
