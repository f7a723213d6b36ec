"""Rows of largest values, the same however sums were rounded."""

import numpy as np
import pytest

from fx_membrane.geometry.extremes import first_largest


@pytest.mark.parametrize(
    ("values", "row"),
    [
        ([1.0, 3.0, 2.0, 3.0], 1),
        ([1.0, 3.0, 2.0, 3.0 * (1 + 1e-12)], 1),
        ([1.0, 3.0, 2.0, 3.0 * (1 + 1e-5)], 3),
        ([-3.0 * (1 + 1e-12), -3.0, -4.0], 0),
        ([1e-15, -1e-15, 1e-14, -5.0], 0),
        ([0.0, 0.0], 0),
        ([-np.inf, 2.0, 2.0], 1),
        ([1.0, np.nan], 1),
    ],
)
def test_first_of_the_largest(values, row):
    assert first_largest(np.array(values)) == row
