"""Cells with their nodes in random order, and results that it must not change."""

import dataclasses

import numpy as np


def shuffled(cells, seed):
    """Give each cell its nodes in a random order; the first keeps its sense."""
    random = np.random.default_rng(seed)
    mixed = random.permuted(cells, axis=1)
    mixed[0] = np.roll(cells[0], 1)
    assert (mixed != cells).any()
    return mixed


def assert_same(found, expected, what="result", size=None):
    """Two results or plain data, entry by entry, to rounding beside the largest number of each array."""
    if dataclasses.is_dataclass(expected):
        for entry in dataclasses.fields(expected):
            if entry.name not in ("structure", "owner", "iterations", "increments"):
                a, b = getattr(found, entry.name), getattr(expected, entry.name)
                # sums of forces and moments are rounding where they balance
                assert_same(a, b, entry.name, 1e3 if what == "equilibrium" else None)
    elif isinstance(expected, dict):
        assert found.keys() == expected.keys()
        for name in expected:
            assert_same(found[name], expected[name], what)
    elif expected is None or isinstance(expected, tuple) or np.asarray(expected).dtype.kind in "Ub":
        assert np.array_equal(found, expected), what
    else:
        bound = 1e-9 * (size or np.abs(expected).max())
        np.testing.assert_allclose(found, expected, rtol=0, atol=bound + 1e-15, err_msg=what)
