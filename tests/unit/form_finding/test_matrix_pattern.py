"""Matrices of nodes from blocks of cells: places that are sorted once give the same as those that are not."""

import numpy as np

from fx_membrane import rectangle
from fx_membrane.form_finding.nearest_stress.assembly import Pattern, assembled


def test_pattern_sums_the_blocks_of_all_cells():
    points, triangles = rectangle(2.0, 2.0, 3, 3)
    blocks = np.random.default_rng(0).normal(size=(len(triangles), 3, 3, 3, 3))
    n = len(points) + 2  # the last nodes have no cell
    expected = np.zeros((n, 3, n, 3))
    for cell, block in zip(triangles, blocks, strict=True):
        expected[np.ix_(cell, range(3), cell, range(3))] += block
    pattern = Pattern(n, triangles)
    for factor in (1.0, -2.0):
        for found in (pattern.summed(factor * blocks), assembled(n, [(triangles, factor * blocks)])):
            assert np.allclose(found.toarray(), factor * expected.reshape(3 * n, 3 * n), rtol=0, atol=1e-14)


def test_pattern_of_no_cells_is_empty():
    found = Pattern(4, np.zeros((0, 3), dtype=np.int64)).summed(np.zeros((0, 9, 9)))
    assert (found.shape, found.nnz) == ((12, 12), 0)
